//! The file form of a fibre: what `hc monodromy` and `cargo xtask codegen` write and read.

use super::fibre::Fibre;
use super::group::MonodromyGroup;
use super::search::{Monodromy, Multiple, Stopped};
use num_complex::Complex64;
use poly::counted;
use serde::{Deserialize, Serialize};

/// A stored generic fibre. Numbers are written so that they are read back bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartFile {
    /// The parameter point, `[re, im]` each.
    pub parameters: Vec<[f64; 2]>,
    /// The solutions, one list of `[re, im]` each, in the order of the family's unknowns.
    pub solutions: Vec<Vec<[f64; 2]>>,
    /// Where one solution of each orbit under the family's symmetry is listed
    /// ([`Family::up_to_symmetry`](crate::Family::up_to_symmetry)): for how many each stands, itself among them. Empty
    /// if all are listed.
    #[serde(default)]
    pub represents: Vec<usize>,
    /// Deviation found by the [trace test](crate::Family::trace_test), if it was run. A deviation
    /// of the size of rounding error shows that the orbits of the solutions are whole.
    #[serde(default)]
    pub trace_test: Option<f64>,
    /// Why the search ended: [`Stopped`](crate::family::Stopped) in words; empty if not stated.
    #[serde(default)]
    pub stopped: String,
    /// The sizes of the [orbits](Monodromy::orbits); empty if not stated.
    #[serde(default)]
    pub orbits: Vec<usize>,
    /// How other orbits are excluded: [`Stopped::others`]; empty if not stated.
    #[serde(default)]
    pub others: String,
    /// Solutions that are multiple for all parameters, which are not among the others.
    #[serde(default)]
    pub multiple: Vec<Multiple>,
    /// What loops tell of the monodromy group, if it was asked for.
    #[serde(default)]
    pub monodromy_group: Option<MonodromyGroup>,
}

/// Why a start file cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartFileError {
    /// Not the expected JSON.
    #[error(
        "not a start file: {0}; expected {{\"parameters\": [[re, im], ...], \"solutions\": [[[re, im], ...], ...]}}"
    )]
    Format(String),
    /// A number is infinite or not a number.
    #[error("{place} holds a number that is not finite; write the start file anew")]
    NotFinite {
        /// The place of the number.
        place: String,
    },
    /// Not every solution has its number of solutions that it stands for.
    #[error("{} in `represents`, but {listed} in `solutions`; write the start file anew", counted(*.found, "number"))]
    Represents {
        /// Number of listed solutions.
        listed: usize,
        /// Number of numbers.
        found: usize,
    },
    /// The solutions do not all have the same number of coordinates.
    #[error("solution {index} (counted from 1) has {}, the first has {expected}", counted(*.found, "coordinate"))]
    Ragged {
        /// The solution, counted from 1.
        index: usize,
        /// Number of coordinates of the first solution.
        expected: usize,
        /// Number of coordinates of this solution.
        found: usize,
    },
}

impl StartFile {
    /// The file form of a fibre.
    pub fn new(fibre: &Fibre, trace_test: Option<f64>, stopped: &str) -> Self {
        let pair = |z: &Complex64| [z.re, z.im];
        StartFile {
            parameters: fibre.parameters.iter().map(pair).collect(),
            solutions: (0..fibre.len()).map(|k| fibre.solution(k).iter().map(pair).collect()).collect(),
            represents: Vec::new(),
            trace_test,
            stopped: stopped.to_owned(),
            orbits: Vec::new(),
            others: String::new(),
            multiple: Vec::new(),
            monodromy_group: None,
        }
    }

    /// Reads the JSON form.
    ///
    /// # Errors
    /// If the text is not JSON of this form.
    pub fn from_json(text: &str) -> Result<Self, StartFileError> {
        serde_json::from_str(text).map_err(|e| StartFileError::Format(e.to_string()))
    }

    /// The JSON form, one solution per line, ended by a newline.
    pub fn to_json(&self) -> String {
        let list = |pairs: &[[f64; 2]]| {
            let items: Vec<String> = pairs.iter().map(|[re, im]| format!("[{re:?}, {im:?}]")).collect();
            format!("[{}]", items.join(", "))
        };
        let solutions: Vec<String> = self.solutions.iter().map(|s| format!("    {}", list(s))).collect();
        let trace = self.trace_test.filter(|t| t.is_finite()).map_or("null".to_owned(), |t| format!("{t:?}"));
        let multiple = |m: &Multiple| {
            let value: Vec<[f64; 2]> = m.value.iter().map(|z| [z.re, z.im]).collect();
            format!("{{\"value\": {}, \"multiplicity\": {}}}", list(&value), m.multiplicity)
        };
        let multiple: Vec<String> = self.multiple.iter().map(multiple).collect();
        // Numbers alone, which are always written.
        let group = serde_json::to_string(&self.monodromy_group).unwrap_or_else(|_| "null".to_owned());
        format!(
            "{{\n  \"parameters\": {},\n  \"solutions\": [\n{}\n  ],\n  \"represents\": {:?},\n  \"trace_test\": {trace},\n  \"stopped\": {:?},\n  \
             \"orbits\": {:?},\n  \"others\": {:?},\n  \"multiple\": [{}],\n  \"monodromy_group\": {group}\n}}\n",
            list(&self.parameters),
            solutions.join(",\n"),
            self.represents,
            self.stopped,
            self.orbits,
            self.others,
            multiple.join(", ")
        )
    }

    /// The listed solutions as a fibre; partial unless [`stopped`](Self::stopped) says that it is complete.
    /// [`Family::stored`](crate::Family::stored) has those too for which they stand.
    ///
    /// # Errors
    /// If a number is not finite, the solutions differ in length, or it is not said of each for how many it stands.
    pub(super) fn listed(&self) -> Result<Fibre, StartFileError> {
        let number = |[re, im]: [f64; 2], place: &dyn Fn() -> String| {
            let finite = re.is_finite() && im.is_finite();
            if finite { Ok(Complex64::new(re, im)) } else { Err(StartFileError::NotFinite { place: place() }) }
        };
        let parameters = (self.parameters.iter().enumerate())
            .map(|(i, &p)| number(p, &|| format!("parameter {}", i + 1)))
            .collect::<Result<_, _>>()?;
        let (listed, found) = (self.solutions.len(), self.represents.len());
        if found != 0 && found != listed {
            return Err(StartFileError::Represents { listed, found });
        }
        let dimension = self.solutions.first().map_or(0, Vec::len);
        let mut solutions = Vec::new();
        for (k, solution) in self.solutions.iter().enumerate() {
            if solution.len() != dimension {
                return Err(StartFileError::Ragged { index: k + 1, expected: dimension, found: solution.len() });
            }
            for (j, &z) in solution.iter().enumerate() {
                solutions.push(number(z, &|| format!("solution {}, coordinate {}", k + 1, j + 1))?);
            }
        }
        let is_complete = Stopped::in_words(&self.stopped).is_some_and(Stopped::is_complete);
        Ok(Fibre { is_partial: !is_complete, ..Fibre::new(parameters, dimension, solutions) })
    }
}

impl Monodromy {
    /// The fibre in its file form.
    pub fn start_file(&self) -> StartFile {
        let count = self.fibre.len();
        let trace_test = self.trace.and_then(|test| test.result(count));
        StartFile {
            orbits: self.orbits.clone(),
            others: self.stopped.others().to_owned(),
            multiple: self.multiple.clone(),
            monodromy_group: self.group.clone(),
            ..StartFile::new(&self.fibre, trace_test, &self.stopped.to_string())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{StartFile, StartFileError};
    use crate::family::{Fibre, MonodromyGroup, Multiple};
    use crate::random::{Random, Stream};
    use proptest::prelude::proptest;

    #[test]
    fn is_read_back_bit_for_bit() {
        let mut random = Random::of(3, Stream::Member(0));
        let fibre = Fibre::new(random.normals(5), 2, random.normals(14));
        let multiple = Multiple { value: random.normals(2), multiplicity: 3 };
        let file = StartFile {
            represents: vec![1; 7],
            orbits: vec![5, 2],
            others: "roots".to_owned(),
            multiple: vec![multiple],
            monodromy_group: Some(MonodromyGroup::default()),
            ..StartFile::new(&fibre, Some(1.5e-13), "roots reached")
        };
        let again = StartFile::from_json(&file.to_json()).unwrap();
        assert_eq!(again, file);
        assert_eq!(again.listed().unwrap(), fibre);
    }

    #[test]
    fn only_what_says_so_is_complete() {
        let words = [("roots reached", true), ("trace", true), ("start system", true), ("orbits whole", false)];
        for (stopped, complete) in
            words.into_iter().chain([("component whole", false), ("no progress", false), ("", false)])
        {
            let file = StartFile::new(&Fibre::default(), None, stopped);
            assert_eq!(file.listed().unwrap().is_partial, !complete, "{stopped}");
        }
    }

    #[test]
    fn says_which_solution_is_ragged() {
        let text = r#"{"parameters": [], "solutions": [[[1, 0], [2, 0]], [[1, 0]]]}"#;
        let error = StartFile::from_json(text).unwrap().listed().unwrap_err();
        assert_eq!(error, StartFileError::Ragged { index: 2, expected: 2, found: 1 });
    }

    proptest! {
        #[test]
        fn no_text_panics(text in ".{0,200}") {
            if let Ok(file) = StartFile::from_json(&text) {
                let _ = file.listed();
            }
        }
    }
}

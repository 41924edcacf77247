//! Points of the unknowns of a system, read from JSON, PHCpack's lists of solutions, or plain text.

use crate::input::{self, Number};
use crate::numbers::{self, Named};
use cli::Failure;
use hc::poly::{System, counted};
use num_complex::Complex64;
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
struct Solved {
    variables: Option<Vec<String>>,
    solutions: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    value: Vec<Number>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Points {
    Solved(Solved),
    List(Vec<Vec<Number>>),
}

/// The line that begins a list of solutions in PHCpack's format.
const LIST: &str = "THE SOLUTIONS";

/// The points of a file, their coordinates in the order of the system's unknowns.
pub(crate) fn read(file: &Path, system: &System) -> Result<Vec<Vec<Complex64>>, Failure> {
    let text = input::text(file)?;
    let found = if text.trim_start().starts_with(['{', '[']) {
        json(&text)
    } else if text.contains(LIST) {
        phcpack(&text)
    } else {
        numbers::points(&text, system.variables())
    };
    found.and_then(|found| ordered(found, system.variables())).map_err(|message| Failure::in_file(file, message))
}

fn json(text: &str) -> Result<Named, String> {
    let expected = "expected the JSON of `hc solve` or [[number or [re, im], ...], ...]";
    let points: Points = serde_json::from_str(text).map_err(|e| format!("{e}; {expected}"))?;
    let (names, points) = match points {
        Points::List(points) => (None, points),
        Points::Solved(solved) => (solved.variables, solved.solutions.into_iter().map(|s| s.value).collect()),
    };
    Ok((names, points.into_iter().map(|point| point.into_iter().map(Complex64::from).collect()).collect()))
}

/// The last list of solutions in a file of PHCpack: after a line `THE SOLUTIONS`, for each solution
/// a line `the solution for t :`, lines `name : re im` and one that begins with `==`.
fn phcpack(text: &str) -> Result<Named, String> {
    let start = text.rfind(LIST).unwrap_or(text.len());
    // The line, from 1, on which the list begins.
    let first = text[..start].matches('\n').count() + 1;
    let mut names: Option<Vec<String>> = None;
    let mut points = Vec::new();
    // The solution that is being read.
    let mut open: Option<(Vec<String>, Vec<Complex64>)> = None;
    for (k, line) in text[start..].lines().enumerate() {
        let at = |message: &str| format!("line {}: {message}", first + k);
        let line = line.trim();
        if line.starts_with("the solution for t") {
            open = Some((Vec::new(), Vec::new()));
            continue;
        }
        let Some((read, point)) = &mut open else { continue };
        if line.starts_with("==") {
            if names.as_ref().is_some_and(|names| names != read) {
                return Err(at("this solution has other unknowns than the first"));
            }
            names.get_or_insert_with(|| std::mem::take(read));
            points.push(std::mem::take(point));
            open = None;
            continue;
        }
        let (name, value) = line.split_once(':').ok_or_else(|| at("expected `name : re im`"))?;
        let parts: Option<Vec<f64>> = value.split_whitespace().map(|part| part.parse().ok()).collect();
        let Some(&[re, im]) = parts.as_deref() else { return Err(at("expected two numbers after the colon")) };
        read.push(name.trim().to_owned());
        point.push(Complex64::new(re, im));
    }
    if open.is_some() {
        return Err("the last solution is cut off".to_owned());
    }
    Ok((names, points))
}

fn ordered((names, points): Named, unknowns: &[String]) -> Result<Vec<Vec<Complex64>>, String> {
    let names = names.unwrap_or_else(|| unknowns.to_vec());
    // Where the coordinate of each unknown stands in the file.
    let places: Option<Vec<usize>> = unknowns.iter().map(|u| names.iter().position(|n| n == u)).collect();
    let Some(places) = places.filter(|_| names.len() == unknowns.len()) else {
        return Err(format!("its variables are {}, those of the system {}", names.join(" "), unknowns.join(" ")));
    };
    let mut ordered = Vec::with_capacity(points.len());
    for (k, point) in points.iter().enumerate() {
        if point.len() != unknowns.len() {
            let (found, expected) = (counted(point.len(), "coordinate"), counted(unknowns.len(), "unknown"));
            return Err(format!("point {} has {found}, the system has {expected}", k + 1));
        }
        ordered.push(places.iter().map(|&place| point[place]).collect());
    }
    Ok(ordered)
}

#[cfg(test)]
mod tests {
    use super::{ordered, phcpack};
    use num_complex::Complex64;

    #[test]
    fn reads_the_last_list_of_phcpack() {
        let block = |x: &str, y: &str| {
            format!(
                "solution 1 :\nt :  1.0E+00   0.0E+00\nm : 1\nthe solution for t :\n y : {y}\n x : {x}\n\
                 == err :  1.0E-16 = rco :  1.0E-01 = res :  1.0E-16 = complex regular ==\n"
            )
        };
        let text = format!(
            "2\n x - 1;\n y - 2;\n\nTHE SOLUTIONS :\n1 2\n===\n{}\nTHE SOLUTIONS :\n1 2\n=====\n{}",
            block("9.0E+00 0.0E+00", "9.0E+00 0.0E+00"),
            block("1.0E+00 -3.0E-17", " 2.00000000000000E+00   0.0E+00")
        );
        let unknowns = ["x".to_owned(), "y".to_owned()];
        let points = phcpack(&text).and_then(|named| ordered(named, &unknowns)).unwrap();
        assert_eq!(points, [[Complex64::new(1.0, -3e-17), Complex64::new(2.0, 0.0)]]);
        for (text, word) in [
            ("THE SOLUTIONS\nthe solution for t :\n x 1.0 2.0\n==", "line 3: expected `name"),
            ("THE SOLUTIONS\nthe solution for t :\n x : 1.0\n==", "line 3: expected two"),
            ("THE SOLUTIONS\nthe solution for t :\n x : 1.0 0.0\n", "cut off"),
        ] {
            let error = phcpack(text).unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}

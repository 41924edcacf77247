//! Known positions: `id,x,y` with a first line (further columns are ignored), or `x,y` without one.
//! Where the first line has a column `kind`, as in [`crate::node_table`], only the lines of
//! receivers that have a position count.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use super::cells::{Decimals, Record, number, records, shorten};
use super::error::ReadError;
use super::heading::Heading;
use super::mat::File;
use super::source::{is_mat, open, text};

const EXPECTED: &str = "expected a first line with name (or id, receiver, mic, anchor, sensor), x and y, in any order, then \
     one node a line, metres; or lines name,x,y or x,y without a first line";

/// Positions with the names that the file gives.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Nodes {
    /// Names, if the file has them.
    pub names: Option<Vec<String>>,
    /// Positions in metres.
    pub positions: Vec<[f64; 2]>,
    /// Heights in metres, if the file has a column z; NaN where that is empty.
    pub heights: Option<Vec<f64>>,
    /// Standard deviations of x and y in metres, if the file has a column sigma, or columns std_x and
    /// std_y; NaN where these are empty.
    pub sigmas: Option<Vec<[f64; 2]>>,
    /// Named nodes of which one coordinate is known alone, with their standard deviations, NaN where
    /// none is given.
    pub partial: Vec<(String, [Option<f64>; 2], [f64; 2])>,
}

impl Nodes {
    /// Whether the file names any of these.
    pub fn names_any(&self, names: &[String]) -> bool {
        self.names.iter().flatten().any(|name| names.contains(name))
    }

    /// The names in the file that are none of these.
    pub fn unknown<'a>(&'a self, names: &[String]) -> Vec<&'a str> {
        self.names.iter().flatten().filter(|name| !names.contains(name)).map(String::as_str).collect()
    }

    /// The positions in the order of these names. By name if the file names any of them, else in
    /// the file's order, which needs as many positions as names. `None` if neither works.
    pub fn in_order(&self, names: &[String]) -> Option<Vec<Option<[f64; 2]>>> {
        if let Some(own) = &self.names
            && self.names_any(names)
        {
            let find = |name: &String| own.iter().position(|other| other == name).map(|k| self.positions[k]);
            return Some(names.iter().map(find).collect());
        }
        if self.positions.len() == names.len() {
            return Some(self.positions.iter().copied().map(Some).collect());
        }
        None
    }

    /// The lowest and the highest height, if the file has any.
    pub fn height_range(&self) -> Option<[f64; 2]> {
        let known = self.heights.iter().flatten().copied().filter(|height| !height.is_nan());
        known.fold(None, |range: Option<[f64; 2]>, height| {
            let [low, high] = range.unwrap_or([height; 2]);
            Some([low.min(height), high.max(height)])
        })
    }
}

/// Reads positions of receivers in metres: the variable rgt of a `.mat` file, else CSV.
///
/// # Errors
/// A file that cannot be read, lines without two numbers, a name that is there twice.
pub fn read_nodes(path: &Path) -> Result<Nodes, ReadError> {
    let file = path.display().to_string();
    let source = open(path, &file)?;
    if is_mat(path) {
        let found = File::read(source, &file)?;
        return mat_nodes(&found, &file)?.ok_or_else(|| found.missing("rgt", "the positions of the receivers"));
    }
    read_nodes_from(source, &file)
}

/// Reads the variable rgt of a .mat file, one receiver a column with x, y and perhaps z in its
/// rows; `None` if it has none.
///
/// # Errors
/// Those of [`read_nodes`].
pub fn read_mat_nodes(path: &Path) -> Result<Option<Nodes>, ReadError> {
    let file = path.display().to_string();
    mat_nodes(&File::read(open(path, &file)?, &file)?, &file)
}

fn mat_nodes(found: &File<'_>, file: &str) -> Result<Option<Nodes>, ReadError> {
    let Some(all) = mat_positions(found, file, "rgt")? else { return Ok(None) };
    let positions: Option<Vec<[f64; 2]>> = all.points.into_iter().collect();
    let positions = positions.ok_or_else(|| ReadError::Mat {
        file: file.to_string(),
        problem: "has a variable rgt with numbers that are not finite".to_string(),
    })?;
    Ok(Some(Nodes { positions, heights: all.heights, ..Nodes::default() }))
}

/// Reads the variable sgt of a .mat file, the true transmitters, one a column with x and y in its
/// first two rows (`None` where these are not finite); `None` if it has none.
///
/// # Errors
/// Those of [`read_nodes`].
pub fn read_mat_transmitters(path: &Path) -> Result<Option<Vec<Option<[f64; 2]>>>, ReadError> {
    let file = path.display().to_string();
    let found = File::read(open(path, &file)?, &file)?;
    Ok(mat_positions(&found, &file, "sgt")?.map(|all| all.points))
}

/// The columns of a matrix of positions.
struct MatPositions {
    points: Vec<Option<[f64; 2]>>,
    heights: Option<Vec<f64>>,
}

fn mat_positions(found: &File<'_>, file: &str, variable: &str) -> Result<Option<MatPositions>, ReadError> {
    let Some(all) = found.variable(variable)? else { return Ok(None) };
    if !matches!(all.rows, 2 | 3) || all.columns == 0 {
        return Err(ReadError::Mat {
            file: file.to_string(),
            problem: format!(
                "has a variable {variable} of {} x {} that is no list of positions (2 or 3 rows)",
                all.rows, all.columns
            ),
        });
    }
    let point = |k: usize| [all.get(0, k), all.get(1, k)];
    let finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    Ok(Some(MatPositions {
        points: (0..all.columns).map(|k| Some(point(k)).filter(finite)).collect(),
        heights: (all.rows == 3).then(|| (0..all.columns).map(|k| all.get(2, k)).collect()),
    }))
}

/// Where a table has its columns.
#[derive(Clone, Copy)]
struct Columns {
    name: Option<usize>,
    x: usize,
    y: usize,
    z: Option<usize>,
    kind: Option<usize>,
    /// Those of the deviations of x and y, which may be one.
    sigma: Option<[usize; 2]>,
}

impl Columns {
    /// The columns by a first line that names them; `None` if it names no coordinates.
    fn named(cells: &[String]) -> Result<Option<Columns>, String> {
        let headings: Vec<Heading> = cells.iter().map(|cell| Heading::new(cell)).collect();
        let at = |k: usize| headings.iter().position(|heading| heading.coordinate() == Some(k));
        let (Some(x), Some(y)) = (at(0), at(1)) else { return Ok(None) };
        let z = at(2);
        let both = headings.iter().position(Heading::heads_sigmas);
        let each = [0, 1].map(|k| headings.iter().position(|heading| heading.coordinate_of_sigma() == Some(k)));
        let sigma = match (both, each) {
            (None, [None, None]) => None,
            (Some(both), [None, None]) => Some([both; 2]),
            (None, [Some(x), Some(y)]) => Some([x, y]),
            (Some(k), [Some(other), _] | [_, Some(other)]) => {
                return Err(format!(
                    "the columns {:?} and {:?} are both standard deviations; remove one, or both to take the positions as exact",
                    cells[k], cells[other]
                ));
            }
            (None, [Some(only), None] | [None, Some(only)]) => {
                return Err(format!(
                    "the column {:?} is the standard deviation of one coordinate alone; give both std_x and std_y, or one column sigma",
                    cells[only]
                ));
            }
        };
        for k in [Some(x), Some(y), z].into_iter().chain(sigma.iter().flatten().map(|k| Some(*k))).flatten() {
            if let Some(unit) = headings[k].unit.filter(|unit| *unit != "m") {
                return Err(format!("the column {:?} is in {unit}; convert it to metres", cells[k]));
            }
        }
        let kind = headings.iter().position(|heading| heading.name == "kind");
        let headed = headings.iter().position(|heading| heading.heads_nodes());
        let name = headed.or_else(|| (0..x.min(y)).find(|k| Some(*k) != kind && Some(*k) != z));
        Ok(Some(Columns { name, x, y, z, kind, sigma }))
    }

    /// The columns of a table whose first line is a node.
    fn unnamed(cells: &[String]) -> Result<Columns, String> {
        let is_number: Vec<bool> = cells.iter().map(|cell| number(cell).is_some()).collect();
        let columns =
            |name: Option<usize>, x: usize, z: Option<usize>| Columns { name, x, y: x + 1, z, kind: None, sigma: None };
        match is_number.as_slice() {
            [true, true] => Ok(columns(None, 0, None)),
            [false, true, true] => Ok(columns(Some(0), 1, None)),
            [false, true, true, true] => Ok(columns(Some(0), 1, Some(3))),
            [true, true, true, ..] => Err(format!(
                "{} numbers a line may be id,x,y or x,y,z; give the file a first line that says which",
                cells.len()
            )),
            _ => Err(EXPECTED.to_string()),
        }
    }
}

/// Reads positions as [`read_nodes`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read_nodes`].
pub fn read_nodes_from(source: impl Read, file: &str) -> Result<Nodes, ReadError> {
    let text = text(source, file)?;
    let mut lines: HashMap<String, u64> = HashMap::new();
    let (mut names, mut positions, mut heights) = (Vec::new(), Vec::new(), Vec::new());
    let (mut sigmas, mut partial) = (Vec::new(), Vec::new());
    let mut columns: Option<Columns> = None;
    let mut decimals = Decimals::default();
    for record in records(&text, file) {
        let record = record?;
        if record.is_blank() {
            continue;
        }
        let bad = |problem: String| ReadError::Line { file: file.to_string(), line: record.line, problem };
        let place = match columns {
            Some(known) => known,
            None => {
                let named = Columns::named(&record.cells).map_err(bad)?;
                let place = named.map_or_else(|| Columns::unnamed(&record.cells), Ok).map_err(bad)?;
                columns = Some(place);
                if named.is_some() {
                    continue;
                }
                place
            }
        };
        let cell = |k: usize| record.cells.get(k).map(String::as_str);
        let is_unlocated = cell(place.x) == Some("") && cell(place.y) == Some("");
        if place.kind.is_some_and(|k| cell(k) != Some("receiver") || is_unlocated) {
            continue;
        }
        let mut read = |k: usize| coordinate(&record, k, &mut decimals).map_err(bad);
        let mut optional = |k: usize| if cell(k).is_none_or(str::is_empty) { Ok(f64::NAN) } else { read(k) };
        let sigma = match place.sigma {
            Some([x, y]) => Some([optional(x)?, optional(y)?]),
            None => None,
        };
        if let (Some(name), true, false) =
            (place.name.and_then(cell), cell(place.x) == Some("") || cell(place.y) == Some(""), is_unlocated)
        {
            let position = [optional(place.x)?, optional(place.y)?].map(|x| Some(x).filter(|x| !x.is_nan()));
            if let Some(earlier) = lines.insert(name.to_string(), record.line) {
                return Err(bad(format!("receiver {name} is there twice, on line {earlier} too; keep one position")));
            }
            partial.push((name.to_string(), position, sigma.unwrap_or([f64::NAN; 2])));
            continue;
        }
        sigmas.extend(sigma);
        let position = [read(place.x)?, read(place.y)?];
        if let Some(z) = place.z {
            heights.push(if cell(z).is_none_or(str::is_empty) { f64::NAN } else { read(z)? });
        }
        positions.push(position);
        if let Some(name) = place.name.and_then(|k| record.cells.get(k)) {
            if let Some(earlier) = lines.insert(name.clone(), record.line) {
                return Err(bad(format!("receiver {name} is there twice, on line {earlier} too; keep one position")));
            }
            names.push(name.clone());
        }
    }
    if positions.is_empty() && partial.is_empty() {
        let problem = format!("has no positions; {EXPECTED}");
        return Err(ReadError::Line { file: file.to_string(), line: 1, problem });
    }
    Ok(Nodes {
        names: if names.len() == positions.len() { Some(names) } else { None },
        positions,
        heights: if heights.is_empty() { None } else { Some(heights) },
        sigmas: if sigmas.is_empty() { None } else { Some(sigmas) },
        partial,
    })
}

/// The coordinate in a cell.
fn coordinate(record: &Record, k: usize, decimals: &mut Decimals) -> Result<f64, String> {
    let cell = record.cells.get(k).ok_or_else(|| format!("has no column {}; {EXPECTED}", k + 1))?;
    let wrong = |remedy: &str| format!("column {}: {:?} is not a coordinate in metres; {remedy}", k + 1, shorten(cell));
    match decimals.number(cell) {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(wrong("leave out the line of a node that is not known")),
        Err(remedy) if number(cell).is_some() => Err(wrong(&remedy)),
        Err(_) => Err(wrong("write a number")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(text: &str) -> Result<Nodes, String> {
        read_nodes_from(text.as_bytes(), "f.csv").map_err(|error| error.to_string())
    }

    #[test]
    fn first_lines_in_other_words_and_orders() {
        let expected = Some(vec!["a".to_string(), "b".to_string()]);
        for text in [
            "name,x,y\na,1,2\nb,3,4\n",
            "y,x,Mic\n2,1,a\n4,3,b\n",
            "anchor;x (m);y (m)\na;1,0;2\nb;3;4,0\n",
            "what,x,y\na,1,2\nb,3,4\n",
            "a,1,2\nb,3,4\n",
            "id,x,y,z\na,1,2,\nb,3,4,\n",
            "\n# a comment\nid,x,y\n,,\na,1,2\nb,3,4\n",
        ] {
            let found = nodes(text).unwrap();
            assert_eq!((found.names, found.positions), (expected.clone(), vec![[1.0, 2.0], [3.0, 4.0]]), "{text}");
        }
        assert_eq!(nodes("1,2\n3,4\n").unwrap().names, None);
    }

    #[test]
    fn deviations_and_single_coordinates_are_kept() {
        let found = nodes("id,x,y,sigma\na,1,2,0.5\nb,3,4,0\nc,,6,0.1\nd,7,8,\n").unwrap();
        assert_eq!(found.positions, [[1.0, 2.0], [3.0, 4.0], [7.0, 8.0]]);
        let sigmas = found.sigmas.unwrap();
        assert!(sigmas[..2] == [[0.5; 2], [0.0; 2]] && sigmas[2][0].is_nan());
        assert_eq!(found.partial, [("c".to_string(), [None, Some(6.0)], [0.1; 2])]);
        let found = nodes("kind,name,x,y,std_x,std_y\nreceiver,a,1,2,0.5,0.25\n").unwrap();
        assert_eq!(found.sigmas, Some(vec![[0.5, 0.25]]));
        assert!(nodes("id,x,y,std_x\na,1,2,3\n").unwrap_err().contains("give both std_x and std_y"));
        assert!(nodes("id,x,y,std_x,std_y,sigma\na,1,2,3,4,5\n").unwrap_err().contains("both standard deviations"));
        assert!(nodes("id,x,y\na,1,\na,1,2\n").unwrap_err().contains("is there twice"));
        assert!(nodes("id,x,y,std_mm\na,1,2,3\n").unwrap_err().contains("convert it to metres"));
    }

    #[test]
    fn heights_are_kept() {
        let found = nodes("id,x,y,z\na,1,2,0.5\nb,3,4,\nc,5,6,-1\n").unwrap();
        assert_eq!(found.height_range(), Some([-1.0, 0.5]));
        assert_eq!(nodes("a,1,2,7\n").unwrap().height_range(), Some([7.0, 7.0]));
        assert_eq!(nodes("a,1,2\n").unwrap().height_range(), None);
    }

    #[test]
    fn what_is_no_table_of_positions() {
        for (text, part) in [
            ("", "has no positions"),
            ("id,x,y\n", "name (or id, receiver"),
            ("1,2,3\n4,5,6\n", "may be id,x,y or x,y,z"),
            ("id,lat,lon\na,1,2\n", "in any order"),
            ("id,x_mm,y_mm\na,1,2\n", "convert it to metres"),
            ("id,x,y\na,1,2\na,1,2\n", "receiver a is there twice, on line 2 too"),
            ("id,x,y\na,1,nan\n", "line 2"),
            ("id,x,y\na,1\n", "has no column 3"),
            ("id,x,y\na,1,left\n", "\"left\" is not a coordinate"),
        ] {
            let error = nodes(text).unwrap_err();
            assert!(error.contains(part), "{part:?} is not in: {error}");
        }
    }
}

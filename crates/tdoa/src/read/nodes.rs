//! Known positions: `id,x,y` with a header (further columns are ignored), or `x,y` without one. Where the header has a
//! column `kind`, as in [`crate::node_table`], only the lines of receivers that have a position count.

use std::io::Read;
use std::path::Path;

use super::ReadError;
use super::table::{number, records, shorten};

/// Positions with the names that the file gives.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Nodes {
    /// Names, if the file has them.
    pub names: Option<Vec<String>>,
    /// Positions in metres.
    pub positions: Vec<[f64; 2]>,
}

impl Nodes {
    /// Whether the file names any of these.
    pub fn names_any(&self, names: &[String]) -> bool {
        self.names.iter().flatten().any(|name| names.contains(name))
    }

    /// The positions in the order of these names. By name if the file names any of them, else in the file's order, which
    /// needs as many positions as names. `None` if neither works.
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
}

/// Reads positions of receivers in metres: the variable rgt of a `.mat` file, else CSV.
///
/// # Errors
/// A file that cannot be read, lines without two numbers.
pub fn read_nodes(path: &Path) -> Result<Nodes, ReadError> {
    let file = path.display().to_string();
    if super::is_mat(path) {
        return read_mat_nodes(path)?.ok_or_else(|| ReadError::Mat {
            file,
            problem: "has no variable rgt, the positions of the receivers".to_string(),
        });
    }
    read_nodes_from(super::open(path, &file)?, &file)
}

/// Reads the variable rgt of a .mat file, one receiver a column with x and y in its first two rows; `None` if it has none.
///
/// # Errors
/// As [`read_nodes`].
pub fn read_mat_nodes(path: &Path) -> Result<Option<Nodes>, ReadError> {
    let Some(all) = mat_positions(path, "rgt")? else { return Ok(None) };
    let positions: Option<Vec<[f64; 2]>> = all.into_iter().collect();
    let positions = positions.ok_or_else(|| ReadError::Mat {
        file: path.display().to_string(),
        problem: "has a variable rgt with numbers that are not finite".to_string(),
    })?;
    Ok(Some(Nodes { names: None, positions }))
}

/// Reads the variable sgt of a .mat file, the true transmitters, one a column with x and y in its first two rows (`None` where these
/// are not finite); `None` if it has none.
///
/// # Errors
/// As [`read_nodes`].
pub fn read_mat_transmitters(path: &Path) -> Result<Option<Vec<Option<[f64; 2]>>>, ReadError> {
    mat_positions(path, "sgt")
}

fn mat_positions(path: &Path, variable: &str) -> Result<Option<Vec<Option<[f64; 2]>>>, ReadError> {
    let file = path.display().to_string();
    let Some(all) = super::mat::find(super::open(path, &file)?, &file, variable)? else { return Ok(None) };
    if !matches!(all.rows, 2 | 3) || all.columns == 0 {
        return Err(ReadError::Mat {
            file,
            problem: format!(
                "has a variable {variable} of {} x {} that is no list of positions (2 or 3 rows)",
                all.rows, all.columns
            ),
        });
    }
    let point = |k: usize| [all.get(0, k), all.get(1, k)];
    let finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    Ok(Some((0..all.columns).map(|k| Some(point(k)).filter(finite)).collect()))
}

/// Reads positions as [`read_nodes`] does; `file` names the source in errors.
///
/// # Errors
/// As [`read_nodes`].
pub fn read_nodes_from(source: impl Read, file: &str) -> Result<Nodes, ReadError> {
    let file = file.to_string();
    let text = super::text(source, &file)?;
    let mut names = Vec::new();
    let mut positions = Vec::new();
    let mut columns = None;
    let mut kind = None;
    for record in records(&text, &file) {
        let record = record?;
        let bad = |problem: String| ReadError::Line { file: file.clone(), line: record.line, problem };
        if columns.is_none() {
            let at = |name: &str| record.cells.iter().position(|c| c.eq_ignore_ascii_case(name));
            if let (Some(x), Some(y)) = (at("x"), at("y")) {
                let headed = at("name").or_else(|| at("id")).or_else(|| at("receiver"));
                let name = headed.or_else(|| (0..record.cells.len()).find(|k| *k < x.min(y)));
                kind = at("kind");
                columns = Some((name, x, y));
                continue;
            }
            let named = record.cells.len() > 2 && number(&record.cells[0]).is_none();
            columns = Some(if named { (Some(0), 1, 2) } else { (None, 0, 1) });
        }
        let Some((name, x, y)) = columns else { continue };
        let cell = |k: usize| record.cells.get(k).map(String::as_str);
        if kind.is_some_and(|k| cell(k) != Some("receiver") || (cell(x) == Some("") && cell(y) == Some(""))) {
            continue;
        }
        let read = |k: usize| -> Result<f64, ReadError> {
            let cell = record.cells.get(k).ok_or_else(|| bad(format!("has no column {}; expected id,x,y", k + 1)))?;
            number(cell)
                .filter(|v| v.is_finite())
                .ok_or_else(|| bad(format!("column {}: {:?} is not a coordinate in metres", k + 1, shorten(cell))))
        };
        positions.push([read(x)?, read(y)?]);
        names.extend(name.and_then(|k| record.cells.get(k).cloned()));
    }
    if positions.is_empty() {
        return Err(ReadError::Line { file, line: 1, problem: "has no positions; expected lines id,x,y".to_string() });
    }
    Ok(Nodes { names: if names.len() == positions.len() { Some(names) } else { None }, positions })
}

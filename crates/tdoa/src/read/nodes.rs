//! Known positions: `id,x,y` or `id,x,y,z` with a first line (further columns are ignored), or `x,y`
//! without one. Where the first line has a column `kind`, as in [`crate::node_table`], only the lines
//! of receivers that have a position count.

mod columns;

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use super::cells::{Record, Table};
use super::error::ReadError;
use super::mat::File;
use super::numbers::{Numbers, number, shorten};
use super::source::{is_mat, open, text};
use columns::Columns;

/// A node with what a file says of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// x, y and z in metres; `None` where unknown.
    pub position: [Option<f64>; 3],
    /// Standard deviations of x, y and z in metres; NaN where none is given.
    pub sigma: [f64; 3],
}

impl Node {
    /// The position in the plane (`D` = 2) or in space (`D` = 3); `None` if a coordinate is unknown.
    pub fn whole<const D: usize>(&self) -> Option<[f64; D]> {
        let mut whole = [0.0; D];
        for (k, x) in whole.iter_mut().enumerate() {
            *x = self.position.get(k).copied().flatten()?;
        }
        Some(whole)
    }
}

/// The nodes of a file, in its order.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Nodes {
    /// The nodes. Those without a name have x and y; those with one have at least one coordinate.
    pub nodes: Vec<Node>,
    /// Whether the file has standard deviations: a column sigma, or columns std_x and std_y.
    pub has_sigmas: bool,
}

impl Nodes {
    /// 3 if nodes of different heights are known, else 2.
    pub fn dimensions(&self) -> usize {
        if self.height_range().is_some_and(|[low, high]| low < high) { 3 } else { 2 }
    }

    /// Whether every node has a name.
    pub fn is_named(&self) -> bool {
        self.nodes.iter().all(|node| node.name.is_some())
    }

    /// The node of this name.
    pub fn named(&self, name: &str) -> Option<&Node> {
        self.nodes.iter().find(|node| node.name.as_deref() == Some(name))
    }

    /// Whether every node has a name, and any has one of these.
    pub fn names_any(&self, names: &[String]) -> bool {
        self.is_named() && names.iter().any(|name| self.named(name).is_some())
    }

    /// The names in the file that are none of these.
    pub fn unknown<'a>(&'a self, names: &[String]) -> Vec<&'a str> {
        let all = self.nodes.iter().filter_map(|node| node.name.as_deref());
        all.filter(|name| !names.iter().any(|other| other == name)).collect()
    }

    /// The positions in the file's order; `None` where a coordinate is unknown.
    pub fn positions<const D: usize>(&self) -> Vec<Option<[f64; D]>> {
        self.nodes.iter().map(Node::whole).collect()
    }

    /// The positions in the order of these names, `None` where a coordinate is unknown. By name if
    /// the file names any of them, else in the file's order, which needs as many nodes as names.
    /// `None` if neither works.
    pub fn in_order<const D: usize>(&self, names: &[String]) -> Option<Vec<Option<[f64; D]>>> {
        if self.names_any(names) {
            return Some(names.iter().map(|name| self.named(name)?.whole()).collect());
        }
        (self.nodes.len() == names.len()).then(|| self.positions())
    }

    /// The lowest and the highest z, if any is known.
    pub fn height_range(&self) -> Option<[f64; 2]> {
        let known = self.nodes.iter().filter_map(|node| node.position[2]);
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
        return mat_receivers(&found, &file)?.ok_or_else(|| found.missing("rgt", "the positions of the receivers"));
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
    mat_receivers(&File::read(open(path, &file)?, &file)?, &file)
}

fn mat_receivers(found: &File<'_>, file: &str) -> Result<Option<Nodes>, ReadError> {
    let all = mat_positions(found, file, "rgt")?;
    if all.iter().flat_map(|all| &all.nodes).any(|node| node.whole::<2>().is_none()) {
        return Err(ReadError::Mat {
            file: file.to_string(),
            problem: "has a variable rgt with numbers that are not finite".to_string(),
        });
    }
    Ok(all)
}

/// Reads the variable sgt of a .mat file, the true transmitters, one a column with x, y and perhaps
/// z in its rows, unknown where these are not finite; `None` if it has none.
///
/// # Errors
/// Those of [`read_nodes`].
pub fn read_mat_transmitters(path: &Path) -> Result<Option<Nodes>, ReadError> {
    let file = path.display().to_string();
    mat_positions(&File::read(open(path, &file)?, &file)?, &file, "sgt")
}

fn mat_positions(found: &File<'_>, file: &str, variable: &str) -> Result<Option<Nodes>, ReadError> {
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
    let coordinate = |row: usize, column: usize| {
        let value = (row < all.rows).then(|| all.get(row, column));
        value.filter(|x| x.is_finite())
    };
    let node =
        |column: usize| Node { name: None, position: [0, 1, 2].map(|k| coordinate(k, column)), sigma: [f64::NAN; 3] };
    Ok(Some(Nodes { nodes: (0..all.columns).map(node).collect(), has_sigmas: false }))
}

/// Reads positions as [`read_nodes`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read_nodes`].
pub fn read_nodes_from(source: impl Read, file: &str) -> Result<Nodes, ReadError> {
    let text = text(source, file)?;
    let mut lines: HashMap<String, u64> = HashMap::new();
    let mut nodes = Vec::new();
    let mut columns: Option<Columns> = None;
    let mut numbers = Numbers::default();
    let table = Table::new(&text, file);
    for record in table.records() {
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
        let Some(node) = node(&record, &place, &mut numbers).map_err(bad)? else { continue };
        if let Some(name) = &node.name
            && let Some(earlier) = lines.insert(name.clone(), record.line)
        {
            return Err(bad(format!("receiver {name} is there twice, on line {earlier} too; keep one position")));
        }
        nodes.push(node);
    }
    if nodes.is_empty() {
        let problem = format!("has no positions; {}", columns::EXPECTED);
        return Err(ReadError::Line { file: file.to_string(), line: 1, problem });
    }
    Ok(Nodes { nodes, has_sigmas: columns.is_some_and(|columns| columns.sigma.is_some()) })
}

/// The node of a line; `None` if it is no receiver, or a receiver without a position in a table of
/// nodes of both kinds.
fn node(record: &Record, place: &Columns, numbers: &mut Numbers) -> Result<Option<Node>, String> {
    let cell = |k: usize| record.cells.get(k).map(String::as_str);
    let is_empty = |k: usize| cell(k) == Some("");
    let is_given = |k: usize| cell(k).is_some_and(|cell| !cell.is_empty());
    let is_unlocated = is_empty(place.x) && is_empty(place.y) && !place.z.is_some_and(is_given);
    if place.kind.is_some_and(|k| cell(k) != Some("receiver") || is_unlocated) {
        return Ok(None);
    }
    let name = place.name.and_then(cell).map(str::to_string);
    // What has a name is known by it, whatever else of it is not.
    let may_be_empty = name.is_some() && !is_unlocated;
    let mut optional = |k: Option<usize>| match k.filter(|&k| is_given(k)) {
        Some(k) => coordinate(record, k, numbers).map(Some),
        None => Ok(None),
    };
    let [x, y, z] = place.sigma.unwrap_or_default();
    let sigma = [optional(x)?, optional(y)?, optional(z)?].map(|sigma| sigma.unwrap_or(f64::NAN));
    let mut needed = |k: usize| {
        if may_be_empty && is_empty(k) { Ok(None) } else { coordinate(record, k, numbers).map(Some) }
    };
    let [x, y] = [needed(place.x)?, needed(place.y)?];
    let z = place.z.filter(|&k| is_given(k)).map(|k| coordinate(record, k, numbers)).transpose()?;
    Ok(Some(Node { name, position: [x, y, z], sigma }))
}

/// The coordinate in a cell.
fn coordinate(record: &Record, k: usize, numbers: &mut Numbers) -> Result<f64, String> {
    let cell = record.cells.get(k).ok_or_else(|| format!("has no column {}; {}", k + 1, columns::EXPECTED))?;
    let wrong = |remedy: &str| format!("column {}: {:?} is not a coordinate in metres; {remedy}", k + 1, shorten(cell));
    match numbers.number(cell) {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(wrong("leave out the line of a node that is not known")),
        Err(remedy) if number(cell).is_some() => Err(wrong(&remedy)),
        Err(_) => Err(wrong("write a number")),
    }
}

#[cfg(test)]
mod tests;

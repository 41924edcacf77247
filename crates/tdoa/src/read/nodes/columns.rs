//! Which columns of a table of nodes hold what.

use crate::read::heading::Heading;
use crate::read::numbers::number;

/// What a file of nodes looks like, for messages.
pub(super) const EXPECTED: &str = "expected a first line with name (or id, receiver, mic, anchor, sensor, station), x and y, in any order \
     (or easting and northing), in space z (or height, elevation) too, then one node a line, metres; or lines name,x,y or x,y without a first line";

/// Where a table has its columns.
#[derive(Clone, Copy)]
pub(super) struct Columns {
    pub(super) name: Option<usize>,
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) z: Option<usize>,
    pub(super) kind: Option<usize>,
    /// Those of the standard deviations of x, y and z, which may be one; `None` for z where it has
    /// none.
    pub(super) sigma: Option<[Option<usize>; 3]>,
}

impl Columns {
    /// The columns by a first line that names them; `None` if it names no coordinates.
    pub(super) fn named(cells: &[String]) -> Result<Option<Columns>, String> {
        let headings: Vec<Heading> = cells.iter().map(|cell| Heading::new(cell)).collect();
        let headed = |k: usize| headings.iter().position(|heading| heading.coordinate() == Some(k));
        let lettered = |k: usize| headings.iter().position(|heading| heading.letter() == Some(k));
        let by_words = headed(0).zip(headed(1)).map(|(x, y)| (x, y, headed(2)));
        // The letters e, n and u say it together.
        let by_letters = || lettered(0).zip(lettered(1)).map(|(x, y)| (x, y, lettered(2).or_else(|| headed(2))));
        let wrong = |(k, heading): (usize, &Heading)| {
            Some(format!("the column {:?} {}", cells[k], heading.is_no_coordinate()?))
        };
        let wrong = headings.iter().enumerate().find_map(wrong);
        let Some((x, y, z)) = by_words.or_else(by_letters) else {
            return wrong.map_or(Ok(None), |wrong| Err(format!("{wrong}; {EXPECTED}")));
        };
        if let Some(wrong) = wrong.filter(|_| z.is_none()) {
            return Err(wrong);
        }
        let sigma = sigma_columns(&headings, cells, z)?;
        for k in [Some(x), Some(y), z].into_iter().chain(sigma.into_iter().flatten()).flatten() {
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
    pub(super) fn unnamed(cells: &[String]) -> Result<Columns, String> {
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

/// The columns of the standard deviations of x, y and z: one for all, or one for each. A deviation
/// of z needs no column, and counts only where there is a column z.
fn sigma_columns(
    headings: &[Heading],
    cells: &[String],
    z: Option<usize>,
) -> Result<Option<[Option<usize>; 3]>, String> {
    let all = headings.iter().position(Heading::heads_sigmas);
    let each = [0, 1, 2].map(|k| headings.iter().position(|heading| heading.coordinate_of_sigma() == Some(k)));
    match (all, each) {
        (None, [None, None, None]) => Ok(None),
        (Some(all), [None, None, None]) => Ok(Some([Some(all), Some(all), z.map(|_| all)])),
        (None, [Some(x), Some(y), of_z]) => Ok(Some([Some(x), Some(y), z.and(of_z)])),
        (Some(k), [Some(other), ..] | [_, Some(other), _] | [.., Some(other)]) => Err(format!(
            "the columns {:?} and {:?} are both standard deviations; remove one, or both to take the positions as exact",
            cells[k], cells[other]
        )),
        (None, [Some(only), ..] | [_, Some(only), _] | [.., Some(only)]) => Err(format!(
            "the column {:?} is the standard deviation of one coordinate alone; give both std_x and std_y{}, or one column sigma",
            cells[only],
            if z.is_some() { " (and std_z)" } else { "" }
        )),
    }
}

//! Columns of a list that hold further candidates: `value2`, `value3`, ... beside `value`, and the same behind other
//! names of that column.

use super::heading::{Heading, check_unit, quoted};
use super::units::Units;
use super::words::{LENGTH, SIGMA, TIME, WEIGHT};

/// The name and the number of a heading that ends in one.
fn numbered(heading: &Heading) -> Option<(&str, u32)> {
    let stem = heading.name.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = heading.name[stem.len()..].parse().ok()?;
    let stem = stem.trim_end_matches('_');
    (!stem.is_empty()).then_some((stem, number))
}

/// The column of values where each has a number, such as `toa1` beside `toa2`, and whether it holds times: the
/// one of the least number. `None` if there is none, or if they have several names.
pub(super) fn first_of_numbered(headings: &[Heading]) -> Option<(usize, bool)> {
    let named = headings.iter().enumerate().filter_map(|(k, heading)| Some((k, numbered(heading)?)));
    let values: Vec<(usize, &str, u32)> = named
        .filter(|(_, (stem, _))| LENGTH.sure.contains(stem) || TIME.sure.contains(stem))
        .map(|(k, (stem, number))| (k, stem, number))
        .collect();
    let &(first, stem, _) = values.iter().min_by_key(|(_, _, number)| *number)?;
    values.iter().all(|(_, other, _)| *other == stem).then(|| (first, TIME.sure.contains(&stem)))
}

/// The columns of further candidates beside that of values: those of the same name and a greater number, in the
/// order of these. `is_free` says which columns are for no other use.
pub(super) fn further_columns(headings: &[Heading], value: usize, is_free: impl Fn(usize) -> bool) -> Vec<usize> {
    let (stem, first) = numbered(&headings[value]).unwrap_or((&headings[value].name, 1));
    let of = |k: usize| numbered(&headings[k]).filter(|(other, number)| *other == stem && *number > first);
    let mut further: Vec<(u32, usize)> =
        (0..headings.len()).filter(|&k| k != value && is_free(k)).filter_map(|k| Some((of(k)?.1, k))).collect();
    further.sort_unstable();
    further.into_iter().map(|(_, k)| k).collect()
}

/// Checks the columns of further candidates: they have the unit of the values, and no standard deviations of their
/// own. `cells` are the headings as they are written.
///
/// # Errors
/// What is wrong and what to do.
pub(super) fn check_further(
    cells: &[String],
    headings: &[Heading],
    value: usize,
    further: &[usize],
    is_free: impl Fn(usize) -> bool,
    units: Option<Units>,
) -> Result<(), String> {
    for &k in further {
        check_unit("column", &cells[k], headings[k].unit, false, units)?;
        if let (Some(unit), Some(other)) = (headings[value].unit, headings[k].unit)
            && unit != other
        {
            return Err(format!("{:?} and {:?} are in different units; give both in {unit}", cells[value], cells[k]));
        }
    }
    let tells_how_sure = |stem: &str| SIGMA.sure.contains(&stem) || WEIGHT.sure.contains(&stem);
    let is_sigma = |k: usize| numbered(&headings[k]).is_some_and(|(stem, _)| tells_how_sure(stem));
    match (0..headings.len()).find(|&k| !further.is_empty() && is_free(k) && is_sigma(k)) {
        None => Ok(()),
        Some(k) => Err(format!(
            "the column {:?} says how sure further candidates are, but one is for all candidates of a pair; leave it out \
             (--columns ignore={})",
            cells[k],
            quoted(&cells[k])
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headings(cells: &[&str]) -> Vec<Heading> {
        cells.iter().map(|cell| Heading::new(cell)).collect()
    }

    #[test]
    fn further_candidates_have_the_name_and_a_greater_number() {
        let all = headings(&["value3", "mic", "value", "Value 2", "value_10 (m)", "toa2", "value2x", "value0"]);
        assert_eq!(further_columns(&all, 2, |_| true), [3, 0, 4]);
        assert_eq!(further_columns(&all, 2, |k| k != 3), [0, 4]);
        assert_eq!(further_columns(&all, 0, |_| true), [4]);
        assert!(further_columns(&all, 1, |_| true).is_empty());
    }

    #[test]
    fn the_least_number_is_the_value() {
        assert_eq!(first_of_numbered(&headings(&["mic1", "toa2", "toa1"])), Some((2, true)));
        assert_eq!(first_of_numbered(&headings(&["range_2", "event", "range_3"])), Some((0, false)));
        assert_eq!(first_of_numbered(&headings(&["toa1", "range2"])), None);
        assert_eq!(first_of_numbered(&headings(&["toa", "x2", "99999999999999999"])), None);
    }
}

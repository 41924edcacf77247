//! Whether the rows of a matrix seem to be the transmitters.

use hc::poly::counted;

use crate::pseudoranges::Pseudoranges;

/// Rows and columns whose middles differ by more than this many times what is left of the
/// measurements without them have offsets of their own.
const FAR: f64 = 5.0;

/// So many times as many rows as columns are unusual.
const TALL: usize = 4;

/// Fewer rows than this are not many.
const MANY: usize = 30;

/// What to say where the transmitters seem to be the rows: each event has an offset of its own, so that
/// the measurements of an event differ from those of another by more than receivers are apart. Nothing
/// where receivers have delays of their own, or all offsets are small.
pub fn orientation(measured: &Pseudoranges) -> Option<String> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    // There are mostly more events than receivers.
    if n < 3 || m <= n {
        return None;
    }
    let advice = "give --transpose if the rows are the events and the columns the receivers";
    let size = format!("{} in rows and {} in columns", counted(m, "receiver"), counted(n, "transmitter"));
    let [of_rows, of_columns] = [false, true].map(|turn| own_offsets(measured, turn));
    if of_rows && !of_columns {
        return Some(format!(
            "{size}: the rows differ like events that begin at different times, the columns do not; {advice}"
        ));
    }
    if starts_at_zero(measured, false) && !starts_at_zero(measured, true) {
        return Some(format!("{size}: each row begins at zero, as times of one event do; {advice}"));
    }
    let is_tall = m >= MANY && m >= TALL * n;
    (is_tall && !of_columns).then(|| format!("{size}: are there so many receivers? {advice}"))
}

/// The measurements of each row, or of each column.
fn lines(measured: &Pseudoranges, turn: bool) -> Vec<Vec<(usize, f64)>> {
    let count = if turn { measured.transmitters() } else { measured.receivers() };
    let mut lines = vec![Vec::new(); count];
    for (i, j, value) in measured.cells().iter() {
        let (line, place) = if turn { (j, i) } else { (i, j) };
        lines[line].push((place, *value));
    }
    lines
}

/// Whether rows (or columns) differ by offsets that are large beside what is within them.
fn own_offsets(measured: &Pseudoranges, turn: bool) -> bool {
    let lines = lines(measured, turn);
    let middle = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let middles: Vec<f64> =
        lines.iter().filter_map(|line| middle(line.iter().map(|(_, value)| *value).collect())).collect();
    let within: Vec<f64> = lines
        .iter()
        .filter_map(|line| {
            let own = middle(line.iter().map(|(_, value)| *value).collect())?;
            middle(line.iter().map(|(_, value)| (value - own).abs()).collect())
        })
        .collect();
    let Some((own, rest)) = middle(middles.clone()).zip(middle(within)) else { return false };
    let apart = middle(middles.iter().map(|value| (value - own).abs()).collect());
    apart.is_some_and(|apart| apart > FAR * rest && rest > 0.0)
}

/// Whether the least measurement of each row (or column) is zero, and no other is.
fn starts_at_zero(measured: &Pseudoranges, turn: bool) -> bool {
    lines(measured, turn).iter().filter(|line| line.len() > 1).all(|line| {
        let zeros = line.iter().filter(|(_, value)| *value == 0.0).count();
        zeros == 1 && line.iter().all(|(_, value)| *value >= 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances between grid points and a line of sources, with offsets of rows or columns.
    fn network(rows: usize, columns: usize, of_row: fn(usize) -> f64, of_column: fn(usize) -> f64) -> Pseudoranges {
        let distance = |i: usize, j: usize| {
            let (x, y) = ((i * 7 % 11) as f64 - (j * 5 % 13) as f64, (i * 3 % 13) as f64 - (j * j % 11) as f64);
            x.hypot(y) + 0.01 * (i + 3 * j) as f64
        };
        let value = |k: usize| distance(k / columns, k % columns) + of_row(k / columns) + of_column(k % columns);
        Pseudoranges::new(rows, columns, (0..rows * columns).map(value).collect()).unwrap()
    }

    #[test]
    fn events_in_rows_are_noticed() {
        let offset = |k: usize| 343.0 * (k * 7 % 11) as f64;
        let said = orientation(&network(20, 8, offset, |_| 0.0)).unwrap();
        assert!(said.contains("20 receivers in rows") && said.contains("--transpose"), "{said}");
        for (rows, columns, of_row, of_column) in [
            (8, 20, (|_| 0.0) as fn(usize) -> f64, offset as fn(usize) -> f64),
            (20, 8, |_| 0.0, offset),
            // Receivers with clocks of their own.
            (8, 20, offset, offset),
            (8, 20, |_| 0.0, |_| 0.0),
        ] {
            assert_eq!(orientation(&network(rows, columns, of_row, of_column)), None, "{rows} x {columns}");
        }
        assert!(orientation(&network(146, 19, |_| 0.0, |_| 0.0)).unwrap().contains("so many receivers"));
    }

    #[test]
    fn rows_that_begin_at_zero_are_events() {
        let measured = network(9, 5, |_| 0.0, |_| 0.0);
        let least = |i: usize| (0..5).filter_map(|j| measured.get(i, j)).fold(f64::INFINITY, f64::min);
        let from_zero = measured.map(|i, _, value| value - least(i));
        assert!(orientation(&from_zero).unwrap().contains("begins at zero"));
    }
}

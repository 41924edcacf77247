//! Cells that no network can have measured, such as 9999 or -2147483648 where nothing was heard.

use std::borrow::Cow;

use crate::degeneracy::list;
use crate::median::median;
use crate::pseudoranges::Pseudoranges;
use crate::quantity::number;

/// By how much a cell may differ from the median of its column, as a multiple of what three quarters
/// of all cells, and of those of its receiver, stay below. Differences are at most the distance of
/// two receivers, so that only a receiver that is far from all others comes near it.
const FAR: f64 = 50.0;

/// The measurements without impossible cells, and a warning that names these.
///
/// Columns have their own offsets: a cell is compared with the median of its column. Where most
/// cells of a column hold the one number that stands for nothing, the others look impossible, and
/// cells that hold the number are the ones that go.
pub(crate) fn without_impossible(measured: &Pseudoranges) -> (Cow<'_, Pseudoranges>, Option<String>) {
    let mut kept = Cow::Borrowed(measured);
    let mut gone: Vec<Cell> = Vec::new();
    // Numbers that are impossible in two places stand for nothing in all.
    for _ in 0..2 {
        let found = far(&kept);
        let repeated = |cell: &&Cell| found.iter().filter(|other| other.2 == cell.2).count() > 1;
        let sentinels: Vec<f64> = found.iter().filter(repeated).map(|cell| cell.2).collect();
        let is_found = |i, j| found.binary_search_by_key(&(i, j), |cell| (cell.0, cell.1)).is_ok();
        let is_gone = |i, j, value: f64| is_found(i, j) || sentinels.contains(&value);
        let before = gone.len();
        gone.extend(kept.cells().iter().map(|(i, j, f)| (i, j, *f)).filter(|&(i, j, f)| is_gone(i, j, f)));
        if gone.len() == before {
            break;
        }
        kept = Cow::Owned(kept.filter(|i, j, f| !is_gone(i, j, f)));
    }
    if gone.is_empty() {
        return (kept, None);
    }
    gone.sort_unstable_by_key(|cell| (cell.0, cell.1));
    let name = |&(i, j, value): &Cell| {
        let (receiver, transmitter) = (&measured.receiver_names()[i], &measured.transmitter_names()[j]);
        format!("{receiver}-{transmitter} ({} m)", number(value, 12))
    };
    let names: Vec<String> = gone.iter().map(name).collect();
    let warning = format!(
        "left out as impossible, for they differ by far more than the network is large from what the other receivers measured: {}; leave \
         cells empty where nothing was measured",
        list(&names)
    );
    (kept, Some(warning))
}

/// Receiver, transmitter and value.
type Cell = (usize, usize, f64);

/// Cells that are far from the median of their column, in the order of the matrix.
fn far(measured: &Pseudoranges) -> Vec<Cell> {
    let mut columns: Vec<Vec<Cell>> = vec![Vec::new(); measured.transmitters()];
    for (i, j, f) in measured.cells().iter() {
        columns[j].push((i, j, *f));
    }
    let middle_of = |column: &Vec<Cell>| median(column.iter().map(|cell| cell.2).collect()).unwrap_or(0.0);
    let middle: Vec<f64> = columns.iter().map(middle_of).collect();
    let sizes = measured.cells().map(|_, j, f| (f - middle[j]).abs());
    let usual = |mut sizes: Vec<f64>| -> f64 {
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() * 3 / 4).copied().unwrap_or(0.0)
    };
    let of_all = usual(sizes.values().to_vec());
    let of_row: Vec<f64> =
        (0..measured.receivers()).map(|i| usual(sizes.row(i).map(|(_, size)| *size).collect())).collect();
    let is_far = |&(i, j, f): &Cell| of_all > 0.0 && (f - middle[j]).abs() > FAR * of_all.max(of_row[i]);
    let mut found = Vec::new();
    for column in columns {
        let (outside, inside): (Vec<Cell>, Vec<Cell>) = column.into_iter().partition(is_far);
        let one_number = inside.len() > 1 && inside.iter().all(|cell| cell.2 == inside[0].2);
        found.extend(if one_number && !outside.is_empty() { inside } else { outside });
    }
    found.sort_unstable_by_key(|cell| (cell.0, cell.1));
    found
}

#[cfg(test)]
mod tests {
    use super::without_impossible;
    use crate::{CalibrateOptions, Layout, Pseudoranges, SimulateOptions, calibrate, simulate};

    #[test]
    fn sentinels_go_and_nothing_else() {
        let made = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        for sentinel in [9999.0, -9999.0, 65535.0, -2147483648.0] {
            let mut values = made.pseudoranges.dense();
            // Two cells, and most of a column: 12 columns.
            let places = [5, 12 + 3, 7, 12 + 7, 24 + 7, 36 + 7, 48 + 7];
            places.iter().for_each(|&k| values[k] = sentinel);
            let measured = Pseudoranges::new(8, 12, values.clone()).unwrap();
            let (kept, warning) = without_impossible(&measured);
            let missing: Vec<usize> = (0..96).filter(|&k| kept.get(k / 12, k % 12).is_none()).collect();
            let mut places = places.to_vec();
            places.sort_unstable();
            assert_eq!(missing, places, "{sentinel}");
            assert!(warning.unwrap().contains("r1-s6 ("));
            let found = calibrate(&measured, &CalibrateOptions::default()).unwrap();
            places.iter().for_each(|&k| values[k] = f64::NAN);
            let gaps = Pseudoranges::new(8, 12, values).unwrap();
            let expected = calibrate(&gaps, &CalibrateOptions::default()).unwrap();
            assert_eq!((found.receivers, found.unique), (expected.receivers, expected.unique));
        }
    }

    #[test]
    fn gross_errors_and_far_receivers_stay() {
        for seed in 0..100 {
            let layout = if seed % 2 == 0 { Layout::Normal } else { Layout::Chain { extent: [2000.0, 20.0] } };
            let options = SimulateOptions {
                layout,
                noise: 0.01,
                outliers: 0.1,
                hearing: (seed % 4 == 1).then_some(5),
                receivers: 12,
                seed,
                ..Default::default()
            };
            let made = simulate(&options).unwrap();
            assert_eq!(without_impossible(&made.pseudoranges).1, None, "seed {seed}");
            // One receiver a thousand times as far away as the others.
            let mut network = made.network;
            network.receivers[3] = [1000.0 * network.size(), 0.0];
            let measured = Pseudoranges::new(12, 12, network.pseudoranges()).unwrap();
            assert_eq!(without_impossible(&measured).1, None, "seed {seed}");
        }
    }
}

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
pub(super) fn without_impossible(measured: &Pseudoranges) -> (Cow<'_, Pseudoranges>, Option<String>) {
    let mut values = measured.values().to_vec();
    let n = measured.transmitters();
    let mut gone: Vec<usize> = Vec::new();
    // Numbers that are impossible in two places stand for nothing in all.
    for _ in 0..2 {
        let found = far(&values, n);
        let repeated = |k: &&usize| found.iter().filter(|&&other| values[other] == values[**k]).count() > 1;
        let sentinels: Vec<f64> = found.iter().filter(repeated).map(|&k| values[k]).collect();
        let all: Vec<usize> = match sentinels.as_slice() {
            [] => found,
            _ => (0..values.len()).filter(|k| found.contains(k) || sentinels.contains(&values[*k])).collect(),
        };
        if all.is_empty() {
            break;
        }
        for &k in &all {
            values[k] = f64::NAN;
        }
        gone.extend(all);
    }
    if gone.is_empty() {
        return (Cow::Borrowed(measured), None);
    }
    gone.sort_unstable();
    let name = |&k: &usize| {
        let (receiver, transmitter) = (&measured.receiver_names()[k / n], &measured.transmitter_names()[k % n]);
        format!("{receiver}-{transmitter} ({} m)", number(measured.values()[k], 12))
    };
    let names: Vec<String> = gone.iter().map(name).collect();
    let warning = format!(
        "left out as impossible, for they differ by far more than the network is large from what the other receivers measured: {}; leave \
         cells empty where nothing was measured",
        list(&names)
    );
    (Cow::Owned(measured.with_values(values)), Some(warning))
}

/// Cells that are far from the median of their column, by place.
fn far(values: &[f64], n: usize) -> Vec<usize> {
    let m = values.len() / n;
    let column = |j: usize| (0..m).map(move |i| i * n + j).filter(|&k| !values[k].is_nan());
    let middle: Vec<f64> = (0..n).map(|j| median(column(j).map(|k| values[k]).collect()).unwrap_or(0.0)).collect();
    let size = |k: usize| (values[k] - middle[k % n]).abs();
    let usual = |cells: &mut dyn Iterator<Item = usize>| -> f64 {
        let mut sizes: Vec<f64> = cells.filter(|&k| !values[k].is_nan()).map(size).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() * 3 / 4).copied().unwrap_or(0.0)
    };
    let of_all = usual(&mut (0..values.len()));
    let of_row: Vec<f64> = (0..m).map(|i| usual(&mut (i * n..(i + 1) * n))).collect();
    let is_far = |k: usize| of_all > 0.0 && size(k) > FAR * of_all.max(of_row[k / n]);
    let mut found = Vec::new();
    for j in 0..n {
        let (outside, inside): (Vec<usize>, Vec<usize>) = column(j).partition(|&k| is_far(k));
        let one_number = inside.len() > 1 && inside.iter().all(|&k| values[k] == values[inside[0]]);
        found.extend(if one_number && !outside.is_empty() { inside } else { outside });
    }
    found.sort_unstable();
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
            let mut values = made.pseudoranges.values().to_vec();
            // Two cells, and most of a column: 12 columns.
            let places = [5, 12 + 3, 7, 12 + 7, 24 + 7, 36 + 7, 48 + 7];
            places.iter().for_each(|&k| values[k] = sentinel);
            let measured = Pseudoranges::new(8, 12, values.clone()).unwrap();
            let (kept, warning) = without_impossible(&measured);
            let missing: Vec<usize> = (0..96).filter(|&k| kept.values()[k].is_nan()).collect();
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
            let layout = if seed % 2 == 0 { Layout::Normal } else { Layout::Chain { length: 2000.0, width: 20.0 } };
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

//! Whether receivers are the rows of a table, as they should be.

use crate::median::median;
use crate::pseudoranges::Pseudoranges;

/// Offsets differ by more than this many times what distances do between themselves.
const LARGE: f64 = 2.0;

/// Rounds of taking out medians of rows and columns.
const ROUNDS: usize = 10;

/// Whether rows seem to have the offsets that columns should have: a table with receivers as
/// columns. Offsets make one kind of node differ by more than distances do; where both kinds do, or
/// neither, nothing can be told.
///
/// Medians of rows and columns are taken out in turns (median polish, Tukey 1977).
pub(crate) fn looks_transposed(measured: &Pseudoranges) -> bool {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let (mut rows, mut columns) = (vec![0.0; m], vec![0.0; n]);
    let left = |i: usize, j: usize, rows: &[f64], columns: &[f64]| Some(measured.get(i, j)? - rows[i] - columns[j]);
    for _ in 0..ROUNDS {
        for i in 0..m {
            rows[i] += median((0..n).filter_map(|j| left(i, j, &rows, &columns)).collect()).unwrap_or(0.0);
        }
        for j in 0..n {
            columns[j] += median((0..m).filter_map(|i| left(i, j, &rows, &columns)).collect()).unwrap_or(0.0);
        }
    }
    let cells = (0..m).flat_map(|i| (0..n).map(move |j| (i, j)));
    let rest = spread(cells.filter_map(|(i, j)| left(i, j, &rows, &columns)).collect());
    let (rows, columns) = (spread(rows), spread(columns));
    rows > LARGE * rest && rows > LARGE * columns
}

/// Median distance from the median.
fn spread(values: Vec<f64>) -> f64 {
    let middle = median(values.clone()).unwrap_or(0.0);
    median(values.into_iter().map(|value| (value - middle).abs()).collect()).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::looks_transposed;
    use crate::{CalibrateOptions, Layout, Pseudoranges, SimulateOptions, calibrate, simulate};

    fn transposed(measured: &Pseudoranges) -> Pseudoranges {
        let (m, n) = (measured.receivers(), measured.transmitters());
        let values = (0..m * n).map(|k| measured.get(k % m, k / m).unwrap_or(f64::NAN)).collect();
        Pseudoranges::new(n, m, values).unwrap()
    }

    #[test]
    fn offsets_in_the_rows_are_told() {
        let chain = Layout::Chain { extent: [400.0, 50.0] };
        let room = SimulateOptions::default().layout;
        let (mut told, mut all) = (0, 0);
        for (receivers, transmitters, hearing, layout) in [
            (6, 30, None, room),
            (8, 12, None, room),
            (10, 20, None, room),
            (20, 60, Some(8), chain),
            (30, 6, None, room),
        ] {
            for seed in 0..40 {
                let options = SimulateOptions {
                    receivers,
                    transmitters,
                    hearing,
                    layout,
                    noise: 0.01,
                    outliers: 0.05,
                    missing: 0.1,
                    seed,
                    ..Default::default()
                };
                let measured = simulate(&options).unwrap().pseudoranges;
                assert!(!looks_transposed(&measured), "{receivers}r/{transmitters}s, seed {seed}");
                told += usize::from(looks_transposed(&transposed(&measured)));
                all += 1;
            }
        }
        // Offsets are uniform in plus or minus 1.4 widths of the room here, which is little.
        assert!(10 * told > 8 * all, "{told} of {all}");
    }

    #[test]
    fn a_transposed_table_is_not_trusted() {
        for seed in [1, 2] {
            let options = SimulateOptions { receivers: 8, transmitters: 12, noise: 0.01, seed, ..Default::default() };
            let measured = simulate(&options).unwrap().pseudoranges;
            let right = calibrate(&measured, &CalibrateOptions::default()).unwrap();
            assert!(right.determined && right.unique);
            let wrong = calibrate(&transposed(&measured), &CalibrateOptions::default()).unwrap();
            assert!(!wrong.determined && !wrong.unique, "seed {seed}");
            assert!(
                wrong.warnings.iter().any(|warning| warning.contains("transpose the table")),
                "{:?}",
                wrong.warnings
            );
        }
    }
}

//! Clocks of all receivers that were started apart: a first estimate of their delays.

use crate::pseudoranges::Pseudoranges;

/// A first guess of the delays of all receivers: a transmitter on the far side of one of two
/// receivers makes their difference as large as one on the far side of the other makes it small, so
/// that the middle of the differences is the delay between them. Zero in the mean.
pub(crate) fn middle_delays(measured: &Pseudoranges) -> Vec<f64> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let mut delays = vec![0.0; m];
    let mut between = vec![None; m * m];
    for a in 0..m {
        for b in a + 1..m {
            let common = (0..n).filter_map(|j| Some(measured.get(a, j)? - measured.get(b, j)?));
            let mut differences: Vec<f64> = common.collect();
            if differences.len() < 3 {
                continue;
            }
            differences.sort_by(f64::total_cmp);
            // Gross errors sit at the ends.
            let tenth = differences.len() / 10;
            let middle = 0.5 * (differences[tenth] + differences[differences.len() - 1 - tenth]);
            between[a * m + b] = Some(middle);
            between[b * m + a] = Some(-middle);
        }
    }
    // Least squares over all pairs, receiver by receiver.
    for _ in 0..50 {
        for a in 0..m {
            let pairs = (0..m).filter_map(|b| Some(between[a * m + b]? + delays[b]));
            let (sum, count) = pairs.fold((0.0, 0usize), |(sum, count), x| (sum + x, count + 1));
            if count > 0 {
                delays[a] = sum / count as f64;
            }
        }
        let mean = delays.iter().sum::<f64>() / m as f64;
        for delay in delays.iter_mut() {
            *delay -= mean;
        }
    }
    delays
}

/// The measurements without these guesses.
pub(crate) fn without_middle_delays(measured: &Pseudoranges) -> Pseudoranges {
    let delays = middle_delays(measured);
    measured.map(|i, _, value| value - delays[i])
}

/// The measurements on a grid far finer than any noise: a search is chaotic, so that mere rounding
/// would make it depend on the size of the delays.
pub(crate) fn on_a_grid(measured: &Pseudoranges) -> Pseudoranges {
    let largest = measured.cells().values().iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let step = (largest.log2().floor() - 30.0).exp2();
    if !step.is_normal() {
        return measured.clone();
    }
    measured.map(|_, _, value| (value / step).round() * step)
}

//! First guesses of the clocks of recorders that were started apart.
//!
//! Of two recorders, an event on the far side of one makes their difference as large as one on the far side of the other
//! makes it small, so that the middle of the differences is the offset between them. A difference that grows over the
//! recording by more than events on all sides make of it is a drift.

use crate::clocks::Recorders;
use crate::median::median;
use crate::pseudoranges::Pseudoranges;

/// Events that two recorders must share to be compared.
const SHARED: usize = 3;

/// Standard deviations beyond which a drift is no chance.
const SIGNIFICANT: f64 = 3.0;

/// Rounds of adjusting the guesses to all pairs of recorders.
const ROUNDS: usize = 50;

/// Per receiver, offset and drift over half the recording against the first recorder, metres.
pub(crate) fn first_clocks(measured: &Pseudoranges, recorders: &Recorders) -> Vec<[f64; 2]> {
    let present = recorders.present();
    let place = |i: usize| present.binary_search(&recorders.of_receivers()[i]).unwrap_or_default();
    let (count, n) = (present.len(), measured.transmitters());
    // Per recorder and event: sums of readings and times of its receivers, and their number.
    let mut heard = vec![[0.0; 3]; count * n];
    for (i, j, value) in measured.cells().iter() {
        let [reading, time, number] = &mut heard[place(i) * n + j];
        *reading += value;
        *time += recorders.time(i, j);
        *number += 1.0;
    }
    let mut between = vec![None; count * count];
    for a in 0..count {
        for b in a + 1..count {
            let common = heard[a * n..(a + 1) * n].iter().zip(&heard[b * n..(b + 1) * n]);
            let common = common.filter(|(p, q)| p[2] > 0.0 && q[2] > 0.0);
            let apart: Vec<(f64, f64)> =
                common.map(|(p, q)| (0.5 * (p[1] / p[2] + q[1] / q[2]), p[0] / p[2] - q[0] / q[2])).collect();
            if apart.len() >= SHARED {
                let [offset, drift] = line(&apart, recorders);
                between[a * count + b] = Some([offset, drift]);
                between[b * count + a] = Some([-offset, -drift]);
            }
        }
    }
    // Least squares over all pairs, recorder by recorder.
    let mut clocks = vec![[0.0; 2]; count];
    for _ in 0..ROUNDS {
        for a in 0..count {
            for k in 0..2 {
                let pairs = (0..count).filter_map(|b| Some(between[a * count + b]?[k] + clocks[b][k]));
                let (sum, count) = pairs.fold((0.0, 0usize), |(sum, count), x: f64| (sum + x, count + 1));
                if count > 0 {
                    clocks[a][k] = sum / count as f64;
                }
            }
        }
        let first = clocks[0];
        clocks.iter_mut().for_each(|clock| (0..2).for_each(|k| clock[k] -= first[k]));
    }
    let first = if recorders.is_scheduled() && recorders.drift() { against_schedule(measured, recorders) } else { 0.0 };
    clocks.iter_mut().for_each(|[_, drift]| *drift += first);
    (0..measured.receivers()).map(|i| clocks[place(i)]).collect()
}

/// Drift of the first recorder against the times at which transmitters send.
fn against_schedule(measured: &Pseudoranges, recorders: &Recorders) -> f64 {
    let first = recorders.of_receivers().first();
    let cells = measured.cells().iter().filter(|(i, ..)| recorders.of_receivers().get(*i) == first);
    let late: Vec<(f64, f64)> =
        cells.map(|(i, j, value)| (recorders.time(i, j), value - measured.emission_time(j))).collect();
    line(&late, recorders)[1]
}

/// Offset and drift of differences at these times: the middle, and the slope if there may be one and it is no chance.
fn line(apart: &[(f64, f64)], recorders: &Recorders) -> [f64; 2] {
    if apart.is_empty() {
        return [0.0; 2];
    }
    let drift = if recorders.drift() { slope(apart, recorders.information()[1]) } else { 0.0 };
    let mut left: Vec<f64> = apart.iter().map(|(time, apart)| apart - drift * time).collect();
    left.sort_by(f64::total_cmp);
    // Gross errors sit at the ends.
    let tenth = left.len() / 10;
    [0.5 * (left[tenth] + left[left.len() - 1 - tenth]), drift]
}

/// The median slope from each difference to the one half of the list later in time, if it is no chance; with what is
/// expected of drifts, one over their variance, if that is anything.
fn slope(apart: &[(f64, f64)], information: f64) -> f64 {
    let mut all = apart.to_vec();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = all.len() / 2;
    let pairs = all.iter().zip(&all[all.len() - half..]).filter(|(early, late)| late.0 > early.0);
    let slopes: Vec<f64> = pairs.take(half).map(|(early, late)| (late.1 - early.1) / (late.0 - early.0)).collect();
    let count = slopes.len() as f64;
    let Some(middle) = median(slopes.clone()) else { return 0.0 };
    let Some(spread) = median(slopes.into_iter().map(|slope| (slope - middle).abs()).collect()) else { return 0.0 };
    // The deviation of a median is 1.25 that of a mean, and that of normal numbers 1.48 their median size.
    let deviation = 1.25 * 1.48 * spread / count.sqrt();
    if information > 0.0 {
        // Two clocks drift apart by both their drifts.
        return middle / (1.0 + 0.5 * information * deviation.powi(2));
    }
    if middle.abs() > SIGNIFICANT * deviation { middle } else { 0.0 }
}

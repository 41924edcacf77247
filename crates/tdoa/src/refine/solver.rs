//! The receivers' normal equations, transmitters eliminated, ready to be solved.

use faer::prelude::Solve;
use faer::{Mat, MatMut, Side, linalg::solvers::Llt};

use super::cancel::{Cancelled, apart};
use super::covariance::{RANK_TOLERANCE, reduced};
use super::normal::Normal;
use super::refiner::NetworkRefiner;
use super::rigid::{Motions, rigid_motion};
use crate::loss::Loss;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Receivers from which on the equations are factored, not inverted: some fifty times less work.
const MANY: usize = 12;

/// Coordinates of receivers from which on factoring takes some time.
const LONG: usize = 1000;

/// Equations of all coordinates of the receivers and unknowns of clocks, with the motion of least size where they leave one
/// open.
pub(super) enum ReceiverEquations {
    /// The inverse, by rows.
    Inverse(Vec<f64>),
    /// The Cholesky factor, rigid motions made to cost something.
    Factor(Llt<f64>),
}

impl ReceiverEquations {
    /// `None` where the network cannot be linearised; with the normal equations it comes from.
    pub(super) fn new<T, const D: usize>(
        observations: &Observations<D>,
        network: &Network<D>,
        monitor: &Monitor,
        use_normal: impl FnOnce(&Normal<D>) -> T,
    ) -> Result<Option<(ReceiverEquations, T)>, Cancelled> {
        if observations.receivers >= MANY && observations.clocks().count() == 0 {
            let mut refiner = NetworkRefiner::new(observations, f64::INFINITY, monitor);
            let normal = refiner.normal_at(network, &Loss { nu: f64::INFINITY, scale: 1.0 })?;
            if let Some(factor) = factor(observations, network, normal, monitor)? {
                return Ok(Some((ReceiverEquations::Factor(factor), use_normal(normal))));
            }
        }
        let Some(reduced) = reduced(observations, network, 1.0, monitor)? else { return Ok(None) };
        Ok(Some((ReceiverEquations::Inverse(reduced.joint()), use_normal(reduced.normal()))))
    }

    /// The solution for a right-hand side that no rigid motion changes; what belongs to held receivers
    /// must be zero.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let size = right.len();
        match self {
            ReceiverEquations::Inverse(inverse) => {
                let row = |a: usize| inverse[a * size..(a + 1) * size].iter().zip(right).map(|(x, y)| x * y).sum();
                (0..size).map(row).collect()
            }
            ReceiverEquations::Factor(factor) => {
                let mut solution = right.to_vec();
                factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut solution, size, 1));
                solution
            }
        }
    }
}

/// `None` where the equations leave more open than a rigid motion.
fn factor<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    normal: &Normal<D>,
    monitor: &Monitor,
) -> Result<Option<Llt<f64>>, Cancelled> {
    let size = D * observations.receivers;
    let lower = normal.schur();
    let mut square = Mat::from_fn(size, size, |a, b| lower[a.min(b) * size + a.max(b)]);
    if observations.leave_rigid_motions() {
        let cost = (0..size).map(|k| square[(k, k)]).sum::<f64>() / size as f64;
        let of = rigid_motion(network);
        let rigid: Vec<Motions> = (0..size).map(|k| of(k / D, k % D)).collect();
        for (b, to) in rigid.iter().enumerate() {
            for (a, from) in rigid.iter().enumerate() {
                square[(a, b)] += cost * from.iter().zip(to).map(|(x, y)| x * y).sum::<f64>();
            }
        }
    }
    let Ok(factor) = apart(monitor, size >= LONG, move || square.llt(Side::Lower))? else { return Ok(None) };
    let pivots = (0..size).map(|k| factor.L()[(k, k)].powi(2));
    let (least, largest) =
        pivots.fold((f64::INFINITY, 0.0), |(least, most), x| (f64::min(least, x), f64::max(most, x)));
    Ok((least > RANK_TOLERANCE.sqrt() * largest).then_some(factor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{SimulateOptions, simulate};

    /// Too few to be factored.
    const M: usize = MANY - 1;

    #[test]
    fn factor_and_inverse_give_the_same_motion() {
        let options = SimulateOptions { receivers: M, transmitters: 20, hearing: Some(8), ..Default::default() };
        let simulation = simulate(&options).unwrap();
        let network = &simulation.network;
        for held in [vec![false; M], (0..M).map(|i| i < 2).collect::<Vec<bool>>()] {
            let observations = Observations::new(&simulation.pseudoranges, |_, _| true).holding(&held);
            let (inverse, (right, factor)) =
                ReceiverEquations::new(&observations, network, &Monitor::default(), |normal| {
                    // What measurements that differ make of a right-hand side: rays of pairs.
                    let mut right = vec![0.0; 2 * M];
                    let schur = normal.schur();
                    let any: Vec<f64> = (0..2 * M).map(|k| (k as f64).sin()).collect();
                    for a in (0..2 * M).filter(|a| !held[a / 2]) {
                        right[a] = (0..2 * M)
                            .filter(|b| !held[b / 2])
                            .map(|b| schur[a.min(b) * 2 * M + a.max(b)] * any[b])
                            .sum();
                    }
                    (right, factor(&observations, network, normal, &Monitor::default()).unwrap().unwrap())
                })
                .unwrap()
                .unwrap();
            assert!(matches!(inverse, ReceiverEquations::Inverse(_)));
            let (x, y) = (inverse.solve(&right), ReceiverEquations::Factor(factor).solve(&right));
            for (x, y) in x.iter().zip(&y) {
                assert!((x - y).abs() < 1e-8, "{x} {y}");
            }
        }
    }
}

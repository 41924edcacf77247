//! Proofs that the roots of a solver exist and are distinct.

use super::formulation::{Formulation, Parameters};
use hc::certify::{CertifyOptions, Reality};
use hc::poly::{ComplexInterval, System, parse};
use hc::{Monitor, Run};
use num_complex::Complex64;
use serde::Serialize;
use std::ops::AddAssign;

/// What interval arithmetic proves about the complex roots that a solver has found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RootProofs {
    /// Number of roots that were tested.
    pub roots: usize,
    /// Number of roots proved to exist, each the only one in a box of its own.
    pub proved: usize,
    /// Number of these proved real.
    pub real: usize,
    /// Number of pairs of roots that are not proved different.
    pub unseparated: usize,
}

impl AddAssign for RootProofs {
    /// Adds the proofs for other parameters.
    fn add_assign(&mut self, more: RootProofs) {
        self.roots += more.roots;
        self.proved += more.proved;
        self.real += more.real;
        self.unseparated += more.unseparated;
    }
}

/// Puts the roots `points` for the parameters `target` to the test of Krawczyk, in every chart
/// until all are proved: a root that is ill-conditioned in one, as next to a far node, is none in
/// another. What is proved is about the differences `f_ij - f_1j` as they are in `target`. `None` if the
/// monitor is cancelled.
pub(crate) fn prove<F: Formulation>(
    target: &[Complex64],
    points: &[Vec<Complex64>],
    monitor: &Monitor,
) -> Option<RootProofs> {
    let run = Run::new().watched(monitor);
    let family = parse::family(F::FAMILY).ok()?;
    let count = points.len();
    let mut proved = vec![false; count];
    let mut real = vec![false; count];
    let mut separated = vec![false; count * count];
    let parameters: Vec<ComplexInterval> = target.iter().map(|&p| ComplexInterval::point(p)).collect();
    for chart in 0..F::CHARTS {
        let system = in_chart::<F>(&family.system, chart)?;
        let carried: Vec<Vec<Complex64>> = points.iter().map(|x| F::enter(chart, x).to_vec()).collect();
        let found = run.certify(&system, &parameters, &carried, &CertifyOptions::default()).ok()?;
        if monitor.is_cancelled() {
            return None;
        }
        let mut different = vec![false; count * count];
        let alone: Vec<usize> =
            (0..count).filter(|&k| found.points[k].is_ok() && found.duplicate_of[k].is_none()).collect();
        for &i in &alone {
            proved[i] = true;
            real[i] |= found.points[i].as_ref().is_ok_and(|c| c.reality == Reality::Real);
            for &j in alone.iter() {
                different[i * count + j] = true;
            }
        }
        found.unseparated.iter().for_each(|&[i, j]| {
            (different[i * count + j], different[j * count + i]) = (false, false);
        });
        for (s, d) in separated.iter_mut().zip(different) {
            *s |= d;
        }
        if separated.iter().all(|&s| s) {
            break;
        }
    }
    let pairs = (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j)));
    let unseparated = pairs.filter(|&(i, j)| !separated[i * count + j]).count();
    let total = |flags: &[bool]| flags.iter().filter(|&&f| f).count();
    Some(RootProofs { roots: count, proved: total(&proved), real: total(&real), unseparated })
}

/// The equations of a chart in the parameters of chart 0, of which those of the chart are sums and
/// differences: as formulas, so that nothing is rounded before the proof.
fn in_chart<F: Formulation>(family: &System, chart: usize) -> Option<System> {
    let count = family.parameters().len();
    let unit = |k: usize| (0..count).map(|i| if i == k { 1.0.into() } else { 0.0.into() }).collect::<Vec<Complex64>>();
    let columns: Vec<Parameters> = (0..count).map(|k| F::parameters(chart, &unit(k))).collect();
    System::build(|s| {
        let unknowns: Vec<_> = family.variables().iter().map(|name| s.variable(name)).collect();
        let given: Vec<_> = family.parameters().iter().map(|name| s.parameter(name)).collect();
        let parameters: Vec<_> = (0..count)
            .map(|i| {
                let terms = given.iter().zip(&columns).filter(|(_, column)| column[i] != Complex64::ZERO);
                let signed = terms.map(|(&p, column)| if column[i].re > 0.0 { p } else { -p });
                signed.reduce(|sum, term| sum + term).unwrap_or_else(|| s.constant(0))
            })
            .collect();
        family.instantiate(s, &unknowns, &parameters)
    })
    .ok()
}

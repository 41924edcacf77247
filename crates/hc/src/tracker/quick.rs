//! Quick steps: one attempt for all lanes at a time, whatever the others need.
//!
//! An attempt takes the Jacobian at the predicted point and three corrections with it. The first two tell
//! whether the step is accepted and how long the next one is; the third catches what converges to another
//! path. The next step is that for which `omega` times the predictor's error, which grows with the fourth
//! power of the step, is [`aim`](crate::tolerances::QuickTolerances::aim), within the share of the radius of
//! trust that the options allow. Rows are never exchanged, residuals never extended, and a path that needs
//! more is left to the [careful tracker](super::Tracker). A lane depends on no other.

use super::attempts::Attempts;
use super::batch::Tracker;
use super::derivatives::derivatives;
use super::kernels::{Coefficients, Correct, Predict, Radius, Take, Weigh};
use super::result::PathSet;
use crate::homotopy::ParameterPath;
use crate::tolerances::QUICK;
use num_complex::Complex64;
use poly::{Evaluate, Lane};

impl<E: Evaluate, S: Lane> Tracker<'_, E, S> {
    /// Tracks paths as [`track`](Self::track) does. The difficult ones, and those that have
    /// not begun when the monitor is cancelled, go to `left`.
    pub(super) fn track_quickly<P: ParameterPath>(
        &mut self,
        path: &P,
        starts: &[Complex64],
        which: impl IntoIterator<Item = usize>,
        out: &mut PathSet,
        left: &mut Vec<usize>,
    ) {
        let n = self.n;
        let mut which = which.into_iter();
        left.reserve(which.size_hint().0);
        self.attempts.fill(Attempts::of(None));
        // Idle lanes compute too; harmless numbers keep them from slow exceptional arithmetic.
        self.taylor.fill(S::zero());
        let mut live = true;
        while live {
            live = false;
            for l in 0..S::LANES {
                if self.attempts[l].path.is_none() && !self.monitor.is_cancelled() {
                    self.attempts[l] = Attempts::of(which.next());
                    if let Some(k) = self.attempts[l].path {
                        for (x, z) in self.taylor.iter_mut().zip(&starts[k * n..(k + 1) * n]) {
                            x.set(l, *z);
                        }
                    }
                }
                live |= self.attempts[l].path.is_some();
            }
            if live {
                self.attempt(path, out, left);
            }
        }
        left.extend(which);
    }

    /// One attempt at a step, accepted or not, of every path.
    fn attempt<P: ParameterPath>(&mut self, path: &P, out: &mut PathSet, left: &mut Vec<usize>) {
        let (n, m) = (self.n, self.system.parameters());
        let some = self.attempts.iter().find_map(|lane| lane.path).unwrap_or(0);
        let (mut t, mut step, mut radius_sqr) = (S::real(1.0), S::real(0.0), S::real(0.0));
        let mut fresh = 0u16;
        for (l, lane) in self.attempts.iter().enumerate() {
            self.labels[l] = lane.path.unwrap_or(some);
            t.as_mut()[l] = lane.t_next;
            step.as_mut()[l] = lane.t_next - lane.t;
            radius_sqr.as_mut()[l] = lane.radius * lane.radius;
            fresh |= u16::from(lane.fresh) << l;
        }
        self.isa.run(Coefficients { path, labels: &self.labels, t: &t, out: &mut self.parameters });
        self.isa.run(Predict { taylor: &self.taylor, step, radius_sqr, out: &mut self.point });
        if fresh != 0 {
            self.isa.run(Take { from: &self.taylor[..n], mask: fresh, to: &mut self.point });
        }
        self.isa.run(Weigh {
            x: &self.point,
            fresh,
            least_share_sqr: self.bounds.least_share_sqr,
            weights_sqr: &mut self.weights_sqr,
            inverse: &mut self.inverse_weights_sqr,
        });
        self.factor_in_order();
        let sizes = [0, 1, 2].map(|k| {
            if k > 0 {
                self.system.values(&mut self.memory, &self.point, &self.parameters[..m], &mut self.values);
            }
            self.lu.solve(&mut self.values);
            let size = self.isa.run(Correct {
                x: &self.point,
                dx: &self.values,
                inverse_weights_sqr: &self.inverse_weights_sqr,
                running: u16::MAX,
                out: &mut self.corrected,
            });
            std::mem::swap(&mut self.point, &mut self.corrected);
            size
        });
        let mut accepted = 0u16;
        for (l, lane) in self.attempts.iter_mut().enumerate().filter(|(_, lane)| lane.path.is_some()) {
            if lane.judge([0, 1, 2].map(|k: usize| sizes[k].as_ref()[l].sqrt())) {
                accepted |= 1 << l;
            } else {
                lane.retreat();
            }
        }
        if accepted != 0 {
            self.go_on(accepted, path.is_straight());
        }
        for l in 0..S::LANES {
            let Some(number) = self.attempts[l].path else { continue };
            if self.attempts[l].t == 0.0 {
                let pivot = self.lu.smallest_pivot_in_order(l, &self.jacobian, &self.weights_sqr);
                // A correction that is not a number is not small either.
                if pivot > QUICK.pivot && self.attempts[l].last < QUICK.noise {
                    out.push(self.attempts[l].arrived(number, pivot), self.taylor[..n].iter().map(|x| x.get(l)));
                } else {
                    left.push(number);
                }
                self.attempts[l] = Attempts::of(None);
            } else if self.attempts[l].is_difficult(&self.bounds.options) {
                left.push(number);
                self.attempts[l] = Attempts::of(None);
            }
        }
    }

    /// Values and the factored Jacobian at `point`.
    fn factor_in_order(&mut self) {
        let p = &self.parameters[..self.system.parameters()];
        self.system.jacobian(&mut self.memory, &self.point, p, &mut self.values, &mut self.jacobian);
        self.lu.factor_in_order(&self.jacobian);
    }

    /// One Newton iteration more for the accepted points at `t = 0`, with the Jacobian there, and the rounding
    /// error that is left.
    fn arrive(&mut self, accepted: u16) {
        let mut arriving = 0u16;
        for (l, lane) in self.attempts.iter().enumerate() {
            arriving |= u16::from(accepted >> l & 1 == 1 && lane.t_next == 0.0) << l;
        }
        if arriving == 0 {
            return;
        }
        self.lu.solve(&mut self.values);
        self.isa.run(Correct {
            x: &self.point,
            dx: &self.values,
            inverse_weights_sqr: &self.inverse_weights_sqr,
            running: arriving,
            out: &mut self.corrected,
        });
        // What another correction finds is rounding error.
        let (n, m) = (self.n, self.system.parameters());
        self.system.values(&mut self.memory, &self.corrected, &self.parameters[..m], &mut self.values);
        self.lu.solve(&mut self.values);
        let size = self.isa.run(Correct {
            x: &self.corrected,
            dx: &self.values,
            inverse_weights_sqr: &self.inverse_weights_sqr,
            running: arriving,
            out: &mut self.point,
        });
        self.isa.run(Take { from: &self.point, mask: arriving, to: &mut self.taylor[..n] });
        for (l, lane) in self.attempts.iter_mut().enumerate().filter(|(l, _)| arriving >> l & 1 == 1) {
            lane.last = size.as_ref()[l].sqrt();
        }
    }

    /// Derivatives at the accepted points, and with them the next steps.
    fn go_on(&mut self, accepted: u16, straight: bool) {
        let (n, m) = (self.n, self.system.parameters());
        self.factor_in_order();
        self.taylor_next[..n].copy_from_slice(&self.point);
        let p = &self.parameters[..if straight { 2 } else { 4 } * m];
        derivatives(self.system, self.isa, &mut self.memory, &self.lu, p, &mut self.taylor_next);
        self.isa.run(Take { from: &self.taylor_next, mask: accepted, to: &mut self.taylor });
        self.arrive(accepted);
        let mut omega_sqr = S::real(1.0);
        for (omega_sqr, lane) in omega_sqr.as_mut().iter_mut().zip(&self.attempts) {
            *omega_sqr = lane.omega * lane.omega;
        }
        let (taylor, inverse_weights_sqr) = (&self.taylor, &self.inverse_weights_sqr);
        let radius = self.isa.run(Radius { n, taylor, inverse_weights_sqr, omega_sqr: &omega_sqr });
        for (l, lane) in self.attempts.iter_mut().enumerate().filter(|(l, _)| accepted >> l & 1 == 1) {
            lane.advance(radius.as_ref()[l].sqrt(), &self.bounds.options);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::homotopy::Segment;
    use crate::monitor::Monitor;
    use crate::tracker::{PathEnd, PathSet, Tracker, TrackerOptions};
    use num_complex::Complex64;
    use poly::{Evaluate, Lane, Lanes8, parse};

    fn quick() -> TrackerOptions {
        TrackerOptions { quick: true, ..TrackerOptions::fast() }
    }

    /// The ends of all paths of `x^12 = a`, `y = x^2 + b` from `a = 1, b = 0` to these parameters, in order.
    fn ends<S: Lane>(target: [Complex64; 2], options: &TrackerOptions, monitor: &Monitor) -> PathSet {
        let text =
            "name = 'roots'\nunknowns = ['x', 'y']\nparameters = ['a', 'b']\nequations = ['x^12 - a', 'y - x^2 - b']";
        let system = parse::family(text).expect("a family").system.compile().expect("a program");
        let starts: Vec<Complex64> = (0..12)
            .map(|k| Complex64::from_polar(1.0, f64::from(k) * std::f64::consts::TAU / 12.0))
            .flat_map(|x| [x, x * x])
            .collect();
        let path = Segment::new(&[1.0, 0.0].map(Complex64::from), &target);
        let mut out = PathSet::new(system.variables());
        let mut tracker = Tracker::<_, S>::new(&system, options);
        tracker.set_monitor(monitor);
        tracker.track(&path, &starts, 0..12, &mut out);
        out.sort();
        out
    }

    #[test]
    fn all_roots_alone_and_among_others_to_the_same_bits() {
        let (a, b) = (Complex64::new(-3.0, 4.0), Complex64::new(0.5, -2.0));
        let eight = ends::<Lanes8>([a, b], &quick(), &Monitor::default());
        assert_eq!(eight.len(), 12);
        for (result, x) in eight.iter() {
            assert_eq!(result.end, PathEnd::Success, "{result:?}");
            assert!((x[0].powi(12) - a).norm() < 1e-12 && (x[1] - x[0] * x[0] - b).norm() < 1e-14, "{x:?}");
            assert!(result.accuracy < 1e-8 && result.pivot > 1e-3, "{result:?}");
            // Quick steps did it: they take two Jacobians each, and two at the start solution.
            assert_eq!(result.jacobians, 2 + 2 * result.accepted + result.rejected, "{result:?}");
        }
        // Twelve roots, none twice.
        let near = |k: usize, j: usize| (eight.point(k)[0] - eight.point(j)[0]).norm() < 1e-3;
        assert!((0..12).all(|k| (0..k).all(|j| !near(k, j))));
        assert_eq!(eight, ends::<Complex64>([a, b], &quick(), &Monitor::default()));
        // The same ends as with all care.
        let careful = ends::<Lanes8>([a, b], &TrackerOptions::fast(), &Monitor::default());
        for k in 0..12 {
            assert!((eight.point(k)[0] - careful.point(k)[0]).norm() < 1e-6, "path {k}");
        }
    }

    #[test]
    fn what_is_singular_is_left_to_the_careful_tracker() {
        // All roots meet at zero.
        let target = [0.0, 1.0].map(Complex64::from);
        let careful = ends::<Lanes8>(target, &TrackerOptions::fast(), &Monitor::default());
        assert_eq!(ends::<Lanes8>(target, &quick(), &Monitor::default()), careful);
        assert_eq!(careful.count(PathEnd::Success), 0);
    }

    #[test]
    fn paths_that_have_not_begun_are_cancelled() {
        let monitor = Monitor::watched();
        monitor.cancel();
        let ends = ends::<Lanes8>([2.0, 1.0].map(Complex64::from), &quick(), &monitor);
        assert_eq!((ends.len(), ends.count(PathEnd::Cancelled)), (12, 12));
    }

    #[test]
    fn a_start_that_is_no_solution_is_found_out() {
        let system = parse::family("name = 'root'\nunknowns = ['x']\nparameters = ['a']\nequations = ['x^2 - a']");
        let system = system.expect("a family").system.compile().expect("a program");
        let path = Segment::new(&[Complex64::from(1.0)], &[Complex64::new(2.0, 1.0)]);
        let mut out = PathSet::new(1);
        Tracker::<_, Lanes8>::new(&system, &quick()).track(&path, &[Complex64::from(1.7)], [0], &mut out);
        assert_eq!(out.results()[0].end, PathEnd::InvalidStart);
    }
}

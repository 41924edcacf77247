//! Distances between receivers that were measured by themselves, such as taped ones or ranges between anchors.

use crate::loss::{CAUCHY, Loss};
use crate::points::{dot, minus};

/// Standard deviations beyond which a measured distance says nothing to least squares.
const WRONG: f64 = 5.5;

/// A measured distance between two receivers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ReceiverDistance {
    /// Indices of the two receivers.
    pub(crate) receivers: [usize; 2],
    /// Metres.
    pub(crate) value: f64,
    /// Standard deviation, metres.
    pub(crate) sigma: f64,
}

impl ReceiverDistance {
    /// The unit vector from the first receiver to the second, of all at these places, and the distance between them, metres.
    pub(crate) fn ray<const D: usize>(&self, places: &[[f64; D]]) -> ([f64; D], f64) {
        let [a, b] = self.receivers;
        let between = minus(places[b], places[a]);
        let d = dot(between, between).sqrt();
        (if d > 0.0 { between.map(|x| x / d) } else { [0.0; D] }, d)
    }

    /// What was measured less the distance between receivers at these places, over the standard deviation.
    pub(crate) fn residual<const D: usize>(&self, places: &[[f64; D]]) -> f64 {
        (self.value - self.ray(places).1) / self.sigma
    }

    /// The same distance, with at least this standard deviation.
    pub(crate) fn softened(&self, sigma: f64) -> ReceiverDistance {
        ReceiverDistance { sigma: self.sigma.max(sigma), ..*self }
    }

    /// Whether such a residual is a gross error.
    pub(crate) fn is_wrong(e: f64) -> bool {
        e.abs() > WRONG
    }

    /// The negative log-likelihood of such a residual: that of a normal one, but for gross errors. Least squares, where
    /// measurements that are wrong have been left out, leaves it out too if it is wrong.
    pub(crate) fn cost(e: f64, is_least_squares: bool) -> f64 {
        if is_least_squares { 0.5 * e.clamp(-WRONG, WRONG).powi(2) } else { ROBUST.cost(e) * CAUCHY * CAUCHY / 2.0 }
    }

    /// The derivative of that cost over the residual.
    pub(crate) fn weight(e: f64, is_least_squares: bool) -> f64 {
        if is_least_squares { f64::from(!Self::is_wrong(e)) } else { ROBUST.weight(e) / 2.0 }
    }
}

/// The loss of a residual over its standard deviation.
const ROBUST: Loss = Loss { nu: 1.0, scale: CAUCHY };

/// The distances between receivers of these indices, by their places among them.
pub(crate) fn select(all: &[ReceiverDistance], receivers: &[usize]) -> Vec<ReceiverDistance> {
    let place = |i: usize| receivers.iter().position(|&other| other == i);
    let of = |known: &ReceiverDistance| {
        let [a, b] = known.receivers.map(place);
        Some(ReceiverDistance { receivers: [a?, b?], ..*known })
    };
    all.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::{ReceiverDistance, WRONG};

    #[test]
    fn the_weight_is_the_derivative_of_the_cost_over_the_residual() {
        for is_least_squares in [false, true] {
            let cost = |e| ReceiverDistance::cost(e, is_least_squares);
            for e in [-40.0, -2.0, 0.3, 5.0, 17.0] {
                let slope = (cost(e + 1e-5) - cost(e - 1e-5)) / 2e-5;
                assert!((slope - ReceiverDistance::weight(e, is_least_squares) * e).abs() < 1e-6, "{e}: {slope}");
            }
            // Normal where it is small.
            assert!((cost(0.1) - 0.005).abs() < 1e-5 && cost(0.0) == 0.0);
        }
        assert_eq!(ReceiverDistance::cost(100.0, true), 0.5 * WRONG * WRONG);
    }
}

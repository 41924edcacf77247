//! Offsets by rank where they are not linear: seven receivers and six transmitters, six and eight.
//!
//! With the first receiver's measurements subtracted, `q_ij = f_ij (f_ij - 2 p_j)` is the difference of
//! the squared distances, and `q_ij - q_i1` has rank three. Of seven receivers and six transmitters two
//! combinations of the columns vanish: the vectors `(g_j, g_j p_j)` of such combinations are a plane in a
//! linear space of dimension five, and the `p_j` are the same for all of them. Of six receivers and eight
//! transmitters two combinations of the rows are constant. The numbers of planes, 5 and 14, are the degrees
//! of the Grassmannians G(2, 5) and G(2, 6).

use super::bilinear::positions;
use super::grassmannian::{Form, IN_FIVE, IN_SIX, Shape, planes};
use super::monomials::of_unit_length;
use super::offsets::DEGENERATE;
use crate::minimal::error::MinimalError;
use crate::minimal::normalised::Normalised;
use crate::minimal::solution::{PathCounts, RootCounts};
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;

/// Networks in metres, and the numbers of paths and roots behind them.
pub(super) struct Found {
    pub(super) networks: Vec<Network<3>>,
    pub(super) paths: PathCounts,
    pub(super) counts: RootCounts,
    /// Whether the search was stopped at the first network that fits.
    pub(super) stopped_early: bool,
}

impl Found {
    /// What was found without paths.
    pub(super) fn directly(networks: Vec<Network<3>>, counts: RootCounts) -> Found {
        Found { networks, paths: PathCounts::default(), counts, stopped_early: false }
    }
}

/// Networks of seven receivers and six transmitters: five roots for the offsets.
pub(super) fn seven_six(measured: &Pseudoranges) -> Result<Found, MinimalError> {
    let data = Normalised::new(measured);
    let (f, n) = (data.parameters(), data.transmitters());
    let row = |f: &[f64]| f.iter().map(|f| f * f).chain(f.iter().map(|f| -2.0 * f)).collect::<Vec<f64>>();
    let sum = (0..2 * n).map(|k| if k < n { 1.0 } else { 0.0 }).collect();
    let equations = of_unit_length(f.chunks_exact(n).map(row).chain([sum]).collect());
    let (rank, dimension) = (equations.nrows(), IN_FIVE.dimension);
    let svd = equations.svd().map_err(|_| MinimalError::SpecialPosition)?;
    let independent = svd.S()[rank - 1] > DEGENERATE * svd.S()[0];
    if !independent {
        return Err(MinimalError::SpecialPosition);
    }
    let left = svd.V().subcols(rank, dimension);
    let row = |j: usize| (0..dimension).map(|k| left[(j, k)]).collect::<Vec<f64>>();
    let quotients: Vec<Form> = (0..n).map(|j| [row(n + j), row(j)]).collect();
    networks(&data, &quotients, &IN_FIVE, (2, 1))
}

/// Networks of six receivers and eight transmitters: fourteen roots for the offsets.
pub(super) fn six_eight(measured: &Pseudoranges) -> Result<Found, MinimalError> {
    let data = Normalised::new(measured);
    let (f, n) = (data.parameters(), data.transmitters());
    let quotient = |j: usize| {
        let column: Vec<f64> = f.iter().copied().skip(j).step_by(n).collect();
        let squares = column.iter().map(|f| 0.5 * f * f).chain([-0.5]).collect();
        [squares, column.iter().copied().chain([0.0]).collect()]
    };
    let quotients: Vec<Form> = (0..n).map(quotient).collect();
    networks(&data, &quotients, &IN_SIX, (1, 1))
}

/// Networks of the planes on which the quotients, which are the offsets, do not depend on the vector.
fn networks(
    data: &Normalised,
    quotients: &[Form],
    shape: &Shape,
    degrees: (usize, usize),
) -> Result<Found, MinimalError> {
    let planes = planes(quotients, shape).ok_or(MinimalError::SpecialPosition)?;
    let n = quotients.len();
    let network = |plane: &Form| {
        let p: Vec<f64> = quotients.iter().map(|quotient| offset(quotient, plane)).collect();
        let squared: Vec<f64> = data.matrix.iter().enumerate().map(|(k, f)| (f - p[k % n]).powi(2)).collect();
        let found = positions(&squared, n, degrees)?;
        let mut network = Network::new(found.receivers, found.transmitters, p);
        data.restore(&mut network);
        network.is_finite().then_some(network)
    };
    let networks: Vec<Network<3>> = planes.iter().filter_map(network).collect();
    let counts =
        RootCounts { complex: shape.planes, real: planes.len(), positive_definite: networks.len(), physical: 0 };
    Ok(Found::directly(networks, counts))
}

/// The quotient of two linear forms on a plane on which it is the same everywhere.
fn offset([above, below]: &Form, plane: &Form) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let [a, b] = [above, below].map(|form| [dot(form, &plane[0]), dot(form, &plane[1])]);
    (a[0] * b[0] + a[1] * b[1]) / (b[0] * b[0] + b[1] * b[1])
}

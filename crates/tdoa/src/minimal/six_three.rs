//! Six receivers, three transmitters: 180 paths.

use super::chart::{CHARTS, COLUMNS, PARAMETERS, ROWS, UNKNOWNS, enter, leave, permute_parameters};
use super::{SolveError, SolveOptions, check, dual, polish::polish};
use crate::calibrate::flatness;
use crate::generated::six_three as generated;
use crate::network::{Candidate, MinimalSolution, PathCounts, RootCounts};
use crate::pseudoranges::Pseudoranges;
use hc::fibre::{Fibre, doubtful};
use hc::homotopy::Segment;
use hc::poly::{Evaluate, Lanes8};
use hc::refine::Refiner;
use hc::tracker::{PathEnd, PathSet, Tracker};
use num_complex::Complex64;

/// Solver for six receivers and three transmitters; keeps its memory from call to call.
pub struct SixThree {
    tracker: Tracker<'static, generated::System, Lanes8>,
    /// The stored fibre, and the same in the other charts.
    fibres: [Fibre; CHARTS.len()],
    paths: PathSet,
}

static SYSTEM: generated::System = generated::System;

impl Default for SixThree {
    fn default() -> Self {
        Self::new()
    }
}

impl SixThree {
    /// A solver with its start solutions.
    pub fn new() -> Self {
        let first = Fibre {
            parameters: pairs(&generated::PARAMETERS),
            dimension: UNKNOWNS,
            solutions: pairs(&generated::SOLUTIONS),
        };
        let fibres = CHARTS.map(|chart| {
            let parameters = permute_parameters(&first.parameters, &chart);
            let solutions: Vec<Complex64> = (0..first.len()).flat_map(|k| enter(&chart, first.solution(k))).collect();
            Fibre { parameters, dimension: UNKNOWNS, solutions }
        });
        SixThree {
            tracker: Tracker::new(&SYSTEM, &SolveOptions::default().paths.tracker),
            fibres,
            paths: PathSet::new(UNKNOWNS),
        }
    }

    /// Every network that explains a 6 x 3 matrix.
    ///
    /// # Errors
    /// If a measurement is missing or two nodes coincide.
    ///
    /// # Panics
    /// If the matrix is not 6 x 3.
    pub fn solve(&mut self, measured: &Pseudoranges, options: &SolveOptions) -> Result<MinimalSolution, SolveError> {
        assert_eq!((measured.receivers(), measured.transmitters()), (ROWS + 1, COLUMNS), "size of the matrix");
        check(measured)?;
        let data = Normalised::new(measured);
        let target: Vec<Complex64> = data.parameters.iter().map(|&f| f.into()).collect();
        let paths = self.track(&target, options);

        let mut refiner = Refiner::new(&SYSTEM);
        let mut counts = RootCounts { complex: paths.finite, ..RootCounts::default() };
        let mut candidates = Vec::new();
        for (_, root) in self.paths.iter().filter(|(r, _)| r.end == PathEnd::Success) {
            let Some((x, real)) = real_root(&mut refiner, &target, root, options.near_real) else { continue };
            counts.real += usize::from(real);
            let Some(network) = dual::network(&data.parameters, &x) else { continue };
            counts.positive_definite += usize::from(real);
            let candidate = data.candidate(network, options);
            counts.physical += usize::from(real && candidate.physical);
            candidates.push(candidate);
        }
        candidates.sort_by(|a, b| b.physical.cmp(&a.physical).then(a.residual.total_cmp(&b.residual)));
        for candidate in &mut candidates {
            data.restore(&mut candidate.network);
            candidate.residual = candidate.network.rms(measured);
        }
        let warnings = warnings(&paths, &candidates);
        let configuration = measured.configuration();
        Ok(MinimalSolution { configuration, solver: "6r/3s", paths, counts, warnings, candidates })
    }

    /// The records of the paths of the last call.
    pub fn records(&self) -> &[hc::tracker::PathResult] {
        self.paths.results()
    }

    /// Tracks all paths. Those that fail, jump or take too many steps are continued in the other charts, then with more and shorter
    /// steps in all of them.
    fn track(&mut self, target: &[Complex64], options: &SolveOptions) -> PathCounts {
        let settings = &options.paths;
        let mut refiner = Refiner::new(&SYSTEM);
        let mut retracked = 0;
        let mut lost: Vec<usize> = (0..self.fibres[0].len()).collect();
        let mut again = PathSet::new(UNKNOWNS);
        'levels: for level in 0..=settings.retries {
            let tracker = if level == 0 { settings.tracker.clone() } else { settings.tracker.stricter(level) };
            self.tracker.set_options(&tracker);
            for (k, (chart, fibre)) in CHARTS.iter().zip(&self.fibres).enumerate() {
                let first = level == 0 && k == 0;
                let path = Segment::new(&fibre.parameters, &permute_parameters(target, chart));
                let out = if first { &mut self.paths } else { &mut again };
                out.clear(UNKNOWNS);
                self.tracker.track(&path, &fibre.solutions, lost.iter().copied(), out);
                if first {
                    self.paths.sort();
                } else {
                    retracked += lost.len();
                    for (result, point) in again.iter().filter(|(r, _)| r.end == PathEnd::Success) {
                        let back = refiner.refine(target, &leave(chart, point));
                        if back.accuracy < 1e-8 {
                            self.paths.replace(result.path, *result, &back.point);
                        }
                    }
                }
                lost = doubtful(&self.paths, settings.coincidence);
                if lost.is_empty() {
                    break 'levels;
                }
            }
        }
        let at_infinity = self.paths.count(PathEnd::AtInfinity);
        PathCounts {
            tracked: self.paths.len(),
            finite: self.paths.len() - at_infinity - lost.len(),
            at_infinity,
            failed: lost.len(),
            retracked,
        }
    }
}

fn pairs(values: &[[f64; 2]]) -> Vec<Complex64> {
    values.iter().map(|&[re, im]| Complex64::new(re, im)).collect()
}

/// The real root near a complex one, and whether it is that very root: Newton's method from the real parts stays real.
fn real_root<E: Evaluate>(
    refiner: &mut Refiner<'_, E>,
    target: &[Complex64],
    root: &[Complex64],
    near: f64,
) -> Option<(Vec<f64>, bool)> {
    let imaginary = root[..COLUMNS].iter().map(|z| z.im.abs()).fold(0.0, f64::max);
    let size = root[..COLUMNS].iter().map(|z| z.norm()).fold(1.0, f64::max);
    // Beyond this a root is far from real however ill-conditioned; nearer, Newton's method decides.
    if imaginary > 1e-4 * size && imaginary > near {
        return None;
    }
    // Ends of difficult paths are known to a few digits only; the last ones decide between a real root and a complex pair.
    let refined = refiner.refine(target, root);
    let root = if refined.accuracy < 1e-10 { &refined.point[..] } else { root };
    let imaginary = root[..COLUMNS].iter().map(|z| z.im.abs()).fold(0.0, f64::max);
    let start: Vec<Complex64> = root.iter().map(|z| z.re.into()).collect();
    let refined = refiner.refine(target, &start);
    let distance = hc::distinct::relative_distance(&refined.point, root);
    let real = refined.accuracy < 1e-6 && distance < 1e-7;
    if real {
        Some((refined.point.iter().map(|z| z.re).collect(), true))
    } else {
        (imaginary <= near).then(|| (root.iter().map(|z| z.re).collect(), false))
    }
}

/// Physical candidates flatter than this are said to be collinear; exact data tell no more of them.
const FLAT: f64 = 1e-4;

fn warnings(paths: &PathCounts, candidates: &[Candidate]) -> Vec<String> {
    let mut warnings = Vec::new();
    if paths.failed > 0 {
        warnings.push(format!(
            "{} of {} paths were lost: the list of networks may not be whole; the nodes may be collinear or nearly coincide",
            paths.failed, paths.tracked
        ));
    }
    for (kind, points) in [
        ("receivers", (|n| &n.receivers) as fn(&crate::network::Network) -> &Vec<[f64; 2]>),
        ("transmitters", |n| &n.transmitters),
    ] {
        if candidates.iter().any(|c| c.physical && flatness(points(&c.network)) < FLAT) {
            warnings.push(format!(
                "in a network that fits, the {kind} lie in one line: the data cannot tell on which side of it the other nodes lie; \
                 move some {kind} off the line"
            ));
        }
    }
    warnings
}

/// Measurements relative to the first receiver, in units of their own size.
struct Normalised {
    /// `(f_ij - f_1j) / size` for `i = 2..6`, row-major.
    parameters: Vec<f64>,
    /// The same with a row of zeros for the first receiver.
    matrix: Vec<f64>,
    first: [f64; COLUMNS],
    size: f64,
}

impl Normalised {
    fn new(measured: &Pseudoranges) -> Self {
        let f = measured.values();
        let first: [f64; COLUMNS] = std::array::from_fn(|j| f[j]);
        let differences: Vec<f64> = (0..f.len()).map(|k| f[k] - first[k % COLUMNS]).collect();
        let size = (differences.iter().map(|d| d * d).sum::<f64>() / PARAMETERS as f64).sqrt();
        let matrix: Vec<f64> = differences.iter().map(|d| d / size).collect();
        Normalised { parameters: matrix[COLUMNS..].to_vec(), matrix, first, size }
    }

    fn candidate(&self, mut network: crate::network::Network, options: &SolveOptions) -> Candidate {
        let condition = if options.polish { polish(&self.matrix, &mut network) } else { f64::NAN };
        let n = COLUMNS;
        let physical = (self.matrix.iter().enumerate()).all(|(k, f)| f - network.offsets[k % n] >= -options.tolerance);
        let residuals =
            self.matrix.iter().enumerate().map(|(k, f)| f - network.offsets[k % n] - network.distance(k / n, k % n));
        let residual = (residuals.map(|r| r * r).sum::<f64>() / self.matrix.len() as f64).sqrt();
        Candidate { network, residual, physical, condition }
    }

    /// Back to metres and to the offsets of the data.
    fn restore(&self, network: &mut crate::network::Network) {
        network.receivers.iter_mut().chain(&mut network.transmitters).flatten().for_each(|x| *x *= self.size);
        network.offsets.iter_mut().zip(self.first).for_each(|(o, first)| *o = *o * self.size + first);
    }
}

#[cfg(test)]
mod tests {
    use super::SixThree;
    use crate::minimal::SolveOptions;
    use crate::network::Network;
    use crate::pseudoranges::Pseudoranges;
    use hc::random::Random;

    /// Positions and offsets standard normal, as in the paper.
    fn instance(seed: u64) -> (Network, Pseudoranges) {
        let mut random = Random::new(seed, 63);
        let mut normal = || random.normal().re * 2f64.sqrt();
        let network = Network {
            receivers: (0..6).map(|_| [normal(), normal()]).collect(),
            transmitters: (0..3).map(|_| [normal(), normal()]).collect(),
            offsets: (0..3).map(|_| normal()).collect(),
        };
        let values = (0..18).map(|k| network.pseudorange(k / 3, k % 3)).collect();
        (network, Pseudoranges::new(6, 3, values).unwrap())
    }

    #[test]
    fn finds_the_truth_among_all_180_roots() {
        let mut solver = SixThree::new();
        for seed in 0..40 {
            let (truth, measured) = instance(seed);
            let solution = solver.solve(&measured, &SolveOptions::default()).unwrap();
            assert_eq!((solution.paths.finite, solution.paths.failed), (180, 0), "seed {seed}: {:?}", solution.paths);
            // The number of roots with H > 0 is even: real configurations meet and vanish in pairs.
            assert_eq!(solution.counts.positive_definite % 2, 0, "seed {seed}: {:?}", solution.counts);
            let error =
                |offsets: &[f64]| offsets.iter().zip(&truth.offsets).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let best = solution.candidates.iter().filter(|c| c.physical).map(|c| error(&c.network.offsets));
            let best = best.fold(f64::INFINITY, f64::min);
            assert!(best < 1e-8, "seed {seed}: {best:.1e}");
        }
    }
}

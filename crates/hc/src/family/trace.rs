//! The trace test: numerical proof that the orbits of a fibre of a parameter family are whole.
//!
//! On a generic line `p + lambda v` through the parameter point, the solutions `(x, lambda)` form a
//! curve. The fibre is the intersection of the curve with `lambda = 0`. The intersection with
//! `(a x - c) lambda = tau` has instead the points of the fibre and further points near `a x = c`.
//! Over parallel hypersurfaces of this kind (in `tau`), the sum of some points moves linearly if, and
//! for a generic choice only if, they are all points of some irreducible components of the curve (Leykin,
//! Rodriguez, Sottile 2018, arXiv:1608.00540, for the bilinear case). Monodromy in the enlarged family
//! finds the further points, starting from the fibre. A component, an orbit of the monodromy group, of
//! which the fibre has no point is not missed by the test: see [`Stopped`](super::Stopped).
//!
//! A solution that no parameter moves is a component of its own: `lambda = tau / (a x - c)` is linear. Such
//! solutions are left out of the sum.

use super::fibre::{Fibre, FibreOptions};
use super::monodromy::LoopSearch;
use super::reach::{Reach, Sizes};
use super::search::{MonodromyOptions, TraceTest};
use super::sides::Searched;
use super::still::Still;
use super::symmetry::Symmetry;
use crate::checkpoint::{Piece, Pieces};
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use crate::tolerances::families;
use crate::tracker::PathEnd;
use num_complex::Complex64;
use poly::{CompileError, ComplexDd, Evaluate, Interpreter, Scalar, System};

/// Whether a point is wanted, for its parameters.
type Accept<'a> = dyn Fn(&[Complex64], &[Complex64]) -> bool + 'a;

/// The trace test of a fibre of `system`: whether it is a union of whole orbits. If some solutions of the system do not
/// count, `accept` refuses those, which are whole orbits.
///
/// The line and the hypersurface move by the natural sizes of parameters and unknowns, unless the family
/// looks simpler on that scale than it is. If the test shows nothing, they move as far as single
/// parameters have to move until they matter. Each of the two tests has three parts of pieces.
pub(super) fn trace_test(
    system: &System,
    fibre: &Fibre,
    accept: &Accept<'_>,
    options: &MonodromyOptions,
    pieces: Pieces<'_>,
) -> Result<TraceTest, CompileError> {
    let Some(enlarged) = enlarge(system)? else { return Ok(FAILED) };
    let searched = Searched { system: &enlarged, enlarged: true };
    let compiled = system.compile()?;
    let still = Still::new(&compiled, &fibre.parameters);
    let (moving, apart) = still.parted(fibre);
    let apart = apart.len() / fibre.dimension.max(1);
    if moving.is_empty() {
        return Ok(TraceTest { deviation: 0.0, fibre: apart, further: 0, complete: true });
    }
    let Reach { natural, wide, hidden } = Reach::new(&compiled, &moving);
    let all = match (wide == natural, hidden) {
        (true, _) => vec![natural],
        (false, false) => vec![natural, wide],
        (false, true) => vec![wide],
    };
    let mut test = FAILED;
    for (sizes, part) in all.iter().zip((0..).step_by(3)) {
        test = on_sizes(&searched, &moving, &still, accept, sizes, options, pieces.part(part));
        if test.passed(moving.len()) {
            break;
        }
    }
    Ok(TraceTest { fibre: test.fibre + apart, ..test })
}

/// The outcome of a test without a result.
const FAILED: TraceTest = TraceTest { deviation: f64::INFINITY, fibre: 0, further: 0, complete: false };

/// The trace test with a line and a hypersurface of these sizes.
fn on_sizes<E: Evaluate>(
    enlarged: &Searched<'_, E>,
    fibre: &Fibre,
    still: &Still<'_, E>,
    accept: &Accept<'_>,
    sizes: &Sizes,
    options: &MonodromyOptions,
    pieces: Pieces<'_>,
) -> TraceTest {
    let result = Piece::Whole(2);
    if let Some(test) = pieces.part(2).take(result, |_| true) {
        return test;
    }
    let (n, m) = (fibre.dimension, fibre.parameters.len());
    // Parameters of the enlarged family: p, v, a, c, tau.
    let mut random = Random::of(options.seed, Stream::Trace);
    let mut parameters = fibre.parameters.clone();
    let shares = sizes.unknowns.iter().map(|size| 1.0 / size);
    let scales = sizes.parameters.iter().copied().chain(shares).chain([1.0]);
    parameters.extend(random.normals(m + n + 1).into_iter().zip(scales).map(|(z, scale)| z * scale));
    // The step has so few digits that its multiples are equidistant to the last bit.
    let tau = random.short_unit();
    let at = |factor: f64| {
        let mut p = parameters.clone();
        p.push(tau * factor);
        p
    };
    let mut solutions = Vec::with_capacity(fibre.len() * (n + 1));
    for k in 0..fibre.len() {
        solutions.extend_from_slice(fibre.solution(k));
        solutions.push(Complex64::new(0.0, 0.0));
    }
    let on_fibre = Fibre::new(at(0.0), n + 1, solutions);
    let careful = FibreOptions::default();
    let moved = |pieces: Pieces<'_>, number: usize, fibre: &Fibre, factor: f64| {
        let is_of = |solutions: &Option<Vec<Complex64>>| {
            solutions.as_ref().is_none_or(|all| all.len() == fibre.solutions.len())
        };
        let recorded = pieces.take(Piece::Whole(number), is_of);
        let solutions = recorded.unwrap_or_else(|| {
            let moved = enlarged.moved(fibre, &at(factor), &careful, pieces).map(|moved| moved.solutions);
            pieces.record(Piece::Whole(number), fibre.len(), &moved);
            moved
        });
        Some(Fibre::new(at(factor), n + 1, solutions?))
    };
    let Some(start) = moved(pieces, 0, &on_fibre, 1.0) else { return FAILED };
    let mut search = options.clone();
    search.roots = None;
    let (is_still, symmetry) = (|z: &[Complex64]| still.is(&z[..n]), &Symmetry::default());
    let accept = |q: &[Complex64], z: &[Complex64]| {
        let on_line: Vec<Complex64> = (0..m).map(|k| q[k] + z[n] * q[m + k]).collect();
        accept(&on_line, &z[..n])
    };
    let filled = LoopSearch { searched: enlarged, accept: &accept, is_still: &is_still, symmetry, options: &search };
    let filled = filled.fill(&start, pieces.part(1)).fibre;

    let ends = pieces.part(2);
    let (Some(second), Some(third)) = (moved(ends, 0, &filled, 2.0), moved(ends, 1, &filled, 3.0)) else {
        return FAILED;
    };
    let deviation = Bends::new(enlarged.system, &[&filled, &second, &third], n + 1).deviation();

    // Back on lambda = 0: every point of the curve there must be one of the fibre.
    let (paths, counts) = enlarged.track(&filled, &at(0.0), &careful, pieces);
    let back = paths.iter().filter(|(r, x)| r.end == PathEnd::Success && x[n].norm() < 1e-8).count();
    let complete = counts.failed == 0 && counts.finite == filled.len();
    let test = TraceTest { deviation, fibre: back, further: filled.len() - back, complete };
    ends.record(result, filled.len(), &test);
    test
}

/// `F(x; p + lambda v) = 0`, `(a x - c) lambda = tau`; `None` if this is no system.
pub(super) fn enlarge(system: &System) -> Result<Option<Interpreter>, CompileError> {
    let enlarged = System::build(|s| {
        // Names cannot clash: those of the system are not used.
        let unknowns: Vec<_> = (0..system.variables().len()).map(|j| s.variable(&format!("x{j}"))).collect();
        let lambda = s.variable("lambda");
        let group = |name: &str, len: usize| (0..len).map(|k| s.parameter(&format!("{name}{k}"))).collect::<Vec<_>>();
        let m = system.parameters().len();
        let (p, v, a) = (group("p", m), group("v", m), group("a", unknowns.len()));
        let (c, tau) = (s.parameter("c"), s.parameter("tau"));
        let line: Vec<_> = p.iter().zip(&v).map(|(&p, &v)| p + lambda * v).collect();
        let mut equations = system.instantiate(s, &unknowns, &line);
        let plane = s.sum(a.iter().zip(&unknowns).map(|(&a, &x)| a * x)) - c;
        equations.push(plane * lambda - tau);
        equations
    });
    enlarged.ok().map(|enlarged| enlarged.compile()).transpose()
}

/// How the points of three fibres at equal distances, in the same order, bend: the second differences of their first
/// coordinates.
pub(crate) struct Bends {
    /// By points.
    points: Vec<Vec<ComplexDd>>,
    /// The size of the largest coordinate: other coordinates may be zero except for its rounding errors.
    size: f64,
}

/// Parts are sought among so many points at most.
const PARTED: usize = 20;

impl Bends {
    /// For the first `n` coordinates.
    pub(crate) fn new<E: Evaluate>(system: &E, fibres: &[&Fibre; 3], n: usize) -> Bends {
        let mut refiner = Refiner::new(system);
        let (mut points, mut sizes) = (Vec::new(), vec![0.0; n]);
        for k in 0..fibres[0].len() {
            // In double-double: far points would drown the others.
            let [a, b, c] = fibres.map(|fibre| refiner.extend(&fibre.parameters, fibre.solution(k)));
            let bend = |j: usize| Scalar::sub(&Scalar::add(&a[j], &c[j]), &Scalar::add(&b[j], &b[j]));
            points.push((0..n).map(bend).collect());
            sizes.iter_mut().zip(&b).for_each(|(size, z)| *size += Complex64::from(*z).norm());
        }
        Bends { points, size: sizes.into_iter().fold(0.0, f64::max) }
    }

    /// How far the sum of all points deviates from a straight line: the largest deviation among coordinates, each
    /// relative to the deviations of the single points. It depends neither on the scale nor on how far the points move.
    pub(crate) fn deviation(&self) -> f64 {
        self.deviation_of(&(0..self.points.len()).collect::<Vec<_>>())
    }

    /// [`deviation`](Self::deviation) of some points.
    fn deviation_of(&self, which: &[usize]) -> f64 {
        let relative = |j: usize| {
            let zero = ComplexDd::from(Complex64::default());
            let all = || which.iter().map(|&k| &self.points[k][j]);
            let off = Complex64::from(all().fold(zero, |sum, bend| Scalar::add(&sum, bend))).norm();
            if off <= families::STRAIGHT * self.size {
                0.0
            } else {
                off / all().map(|bend| Complex64::from(*bend).norm()).sum::<f64>()
            }
        };
        let largest = |a: f64, b: f64| if b.is_nan() { f64::INFINITY } else { a.max(b) };
        (0..self.points.first().map_or(0, Vec::len)).map(relative).fold(0.0, largest)
    }

    /// The least part of the points, with the first one, whose sum moves straight, with its deviation; `None` if all
    /// have to be taken together, or are too many to try. Part of an irreducible component never moves straight.
    pub(crate) fn least_part(&self) -> Option<(Vec<usize>, f64)> {
        let count = self.points.len();
        if !(2..=PARTED).contains(&count) {
            return None;
        }
        // One coordinate for all: few parts pass by it that do not pass.
        let mut random = Random::of(0, Stream::Trace);
        let factors: Vec<Complex64> = (0..self.points[0].len()).map(|_| random.unit()).collect();
        let mixed = |bend: &Vec<ComplexDd>| bend.iter().zip(&factors).map(|(z, f)| Complex64::from(*z) * f).sum();
        let mixed: Vec<Complex64> = self.points.iter().map(mixed).collect();
        let mut parts: Vec<usize> = (0..(1usize << (count - 1)) - 1).collect();
        parts.sort_by_key(|part| part.count_ones());
        parts.into_iter().find_map(|part| {
            let which = || std::iter::once(0).chain((1..count).filter(|k| part >> (k - 1) & 1 == 1));
            let sum: Complex64 = which().map(|k| mixed[k]).sum();
            let terms: f64 = which().map(|k| mixed[k].norm()).sum();
            if sum.norm() > families::NEARLY_STRAIGHT * terms.max(self.size) {
                return None;
            }
            let which: Vec<usize> = which().collect();
            let deviation = self.deviation_of(&which);
            (deviation < families::TRACE_PASSED).then_some((which, deviation))
        })
    }
}

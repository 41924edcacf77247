//! A parameter family, ready to be tracked.

use super::error::FamilyError;
use super::fibre::Fibre;
use super::job::{Points, job};
use super::monodromy::{Monodromy, MonodromyOptions, Stop, fill, joined};
use super::pair::{TRIES, find_pair};
use super::symmetry::{SAME, Symmetry};
use super::trace::trace_test;
use super::trace_result::TraceTest;
use crate::checkpoint::{Checkpoint, Pieces};
use crate::distinct::relative_distance;
use crate::monitor::Monitor;
use num_complex::Complex64;
use poly::{Evaluate, Interpreter, Isa, System};
use serde::Serialize;
use std::str::FromStr;

/// Values of this size and below count as zero where a family demands that something does not
/// vanish.
const VANISHES: f64 = 1e-9;
/// Other first pairs, and how often each is tried to be found.
const PAIRS: u64 = 48;
const FEW_TRIES: u64 = 20;
/// The parts of the pieces of [`Family::complete`]: the search goes on in the second with solutions
/// for other parameters.
const AGAIN: u32 = 1;
const TRACE: u32 = 2;

/// A parameter family, compiled: its equations, what must not vanish at its solutions, and its
/// symmetries.
///
/// ```
/// use hc::{Family, MonodromyOptions};
///
/// let family: Family = r#"
///     name = "circle and line"
///     unknowns = ["x", "y"]
///     parameters = ["r", "a"]
///     equations = ["x^2 + y^2 - r^2", "y - a*x"]
///     symmetry = [["-x", "-y"]]
/// "#.parse()?;
/// let found = family.monodromy(&MonodromyOptions::new().roots(2))?;
/// let targets: Vec<[f64; 2]> = (1..=1000).map(|k| [k as f64, 0.75]).collect();
/// for (solutions, target) in family.track(&found.fibre, &targets).run()?.iter().zip(&targets) {
///     assert!(solutions.real_solutions().all(|x| (x[0].abs() - 0.8 * target[0]).abs() < 1e-9));
/// }
/// # Ok::<(), hc::FamilyError>(())
/// ```
#[derive(Debug)]
pub struct Family {
    pub(super) given: poly::Family,
    pub(super) program: Interpreter,
    nonzero: Interpreter,
    pub(super) symmetry: Symmetry,
}

impl Family {
    /// Compiles a family: a [`poly::Family`], or a [`System`] with parameters.
    ///
    /// # Errors
    /// If a formula does not compile or the equations are not square.
    pub fn new(family: impl Into<poly::Family>) -> Result<Family, FamilyError> {
        let family = family.into();
        let (program, nonzero) = (family.system.compile()?, family.nonzero.compile()?);
        let (equations, unknowns) = (program.equations(), program.variables());
        if equations != unknowns || unknowns == 0 {
            return Err(FamilyError::NotSquare { equations, unknowns });
        }
        if let Some(k) = family.symmetry.iter().position(|map| map.len() != unknowns) {
            return Err(FamilyError::Symmetry { map: k + 1, found: family.symmetry[k].len(), unknowns });
        }
        let symmetry = Symmetry::new(&family.symmetry)?;
        Ok(Family { given: family, program, nonzero, symmetry })
    }

    /// A family of equations in these unknowns and parameters; [`poly::Family`] can have more.
    ///
    /// # Errors
    /// If an equation does not parse, or as for [`new`](Self::new).
    pub fn from_formulas<N: AsRef<str>, P: AsRef<str>, S: AsRef<str>>(
        unknowns: &[N],
        parameters: &[P],
        formulas: &[S],
    ) -> Result<Family, FamilyError> {
        Family::new(poly::Family::from_formulas(unknowns, parameters, formulas)?)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.given.name
    }

    /// The equations.
    pub fn system(&self) -> &System {
        &self.given.system
    }

    /// The number of solutions for generic parameters, where the family states it.
    pub fn roots(&self) -> Option<usize> {
        self.given.roots
    }

    /// The maps of the unknowns, one formula an unknown, that take solutions to solutions.
    pub fn symmetry(&self) -> &[System] {
        &self.given.symmetry
    }

    /// The equations as a program, for the lower layers of this crate.
    pub fn program(&self) -> &Interpreter {
        &self.program
    }

    /// Whether none of the factors that the family declares nonzero vanishes at the solution `x`
    /// (one entry an unknown) for the parameters `p` (one entry a parameter).
    pub fn accepts(&self, p: &[Complex64], x: &[Complex64]) -> bool {
        let mut memory = self.nonzero.memory(Isa::Portable);
        let mut values = vec![Complex64::new(0.0, 0.0); self.nonzero.equations()];
        self.nonzero.values(&mut memory, x, p, &mut values);
        values.iter().all(|z| z.norm() > VANISHES)
    }

    /// Checks that a fibre has the family's numbers of parameters and unknowns.
    ///
    /// # Errors
    /// If it has not.
    pub fn check(&self, fibre: &Fibre) -> Result<(), FamilyError> {
        let (parameters, unknowns) = (self.program.parameters(), self.program.variables());
        let (found_parameters, found_unknowns) = (fibre.parameters.len(), fibre.dimension);
        if (found_parameters, found_unknowns) == (parameters, unknowns) {
            return Ok(());
        }
        Err(FamilyError::Misfit { found_parameters, found_unknowns, parameters, unknowns })
    }

    /// Checks that the stated maps take the tracked solutions of a fibre, whose parameters are
    /// generic, to solutions: they do so for all parameters then.
    pub(super) fn check_symmetry(&self, fibre: &Fibre) -> Result<(), FamilyError> {
        let tracked = fibre.tracked();
        match self.symmetry.broken(&self.program, &fibre.parameters, tracked.iter()) {
            Some(map) => Err(FamilyError::NotSymmetric { map: map + 1 }),
            None => Ok(()),
        }
    }

    /// The fibre with one solution of each orbit noted as representative, where the family has
    /// symmetries: these alone are then tracked.
    #[must_use]
    pub fn folded(&self, fibre: Fibre) -> Fibre {
        if self.symmetry.is_trivial() || fibre.representatives.is_some() {
            return fibre;
        }
        let mut known = vec![false; fibre.len()];
        let mut representatives = Vec::new();
        for k in 0..fibre.len() {
            if known[k] {
                continue;
            }
            representatives.push(k);
            let orbit = self.symmetry.orbit(&fibre.parameters, fibre.solution(k), SAME);
            for (j, known) in known.iter_mut().enumerate() {
                *known |= orbit.iter().any(|x| relative_distance(x, fibre.solution(j)) <= SAME);
            }
        }
        Fibre { representatives: Some(representatives), ..fibre }
    }

    /// A first solution, for some generic parameters; the same for the same seed.
    ///
    /// # Errors
    /// If no regular solution is found that the family accepts.
    pub fn find_pair(&self, seed: u64) -> Result<Fibre, FamilyError> {
        find_pair(self.system(), |p, x| self.accepts(p, x), seed, TRIES)?.ok_or(FamilyError::NoPair)
    }

    /// All solutions for some generic parameters: a first pair, and what loops in parameter space
    /// make of it. The number of roots that the family states ends the search, unless the options
    /// have one.
    ///
    /// # Errors
    /// If no first solution is found.
    pub fn monodromy(&self, options: &MonodromyOptions) -> Result<Monodromy, FamilyError> {
        let first = self.find_pair(options.seed)?;
        self.complete(&first, options, &Monitor::default())
    }

    /// All solutions for the parameters of `first`, which has one or several of them; a cancelled
    /// monitor ends the search. Where loops bring nothing new, solutions for other parameters are
    /// tracked to these.
    ///
    /// # Errors
    /// If `first` is of another family, an option is out of range, the stated symmetry is none, or the
    /// enlarged family of the [trace test](Self::trace_test), if asked for, does not compile.
    pub fn complete(
        &self,
        first: &Fibre,
        options: &MonodromyOptions,
        monitor: &Monitor,
    ) -> Result<Monodromy, FamilyError> {
        self.complete_anywhere(first, options, monitor, None)
    }

    /// [`complete`](Self::complete), recorded in a [checkpoint](crate::checkpoint): loops that it has
    /// are not gone again, nor steps of the trace test. The family, `first` and all options but
    /// [`trace_test`](MonodromyOptions::trace_test) have to be those of the run that it is of.
    ///
    /// # Errors
    /// As [`complete`](Self::complete); if the checkpoint is of another run, or cannot be written.
    pub fn complete_recorded(
        &self,
        first: &Fibre,
        options: &MonodromyOptions,
        monitor: &Monitor,
        checkpoint: &Checkpoint,
    ) -> Result<Monodromy, FamilyError> {
        self.complete_anywhere(first, options, monitor, Some(checkpoint))
    }

    fn complete_anywhere(
        &self,
        first: &Fibre,
        options: &MonodromyOptions,
        monitor: &Monitor,
        checkpoint: Option<&Checkpoint>,
    ) -> Result<Monodromy, FamilyError> {
        self.check(first)?;
        options.fibre.validate()?;
        self.check_symmetry(first)?;
        let options = MonodromyOptions { roots: options.roots.or(self.roots()), ..options.clone() };
        if let Some(checkpoint) = checkpoint {
            let settings = Settings { options: &options, start: Points::of_fibre(first) };
            checkpoint.begin(job("monodromy", &self.given, &self.program, &settings))?;
        }
        let pieces = Pieces::new(checkpoint, monitor);
        let accept = |p: &[Complex64], x: &[Complex64]| self.accepts(p, x);
        let mut found = fill(&self.program, first, accept, &self.symmetry, &options, pieces);
        if found.stop == Stop::NoProgress {
            let others = self.other_pairs(options.seed)?;
            let joined = joined(&self.program, &found.fibre, &others, accept, &self.symmetry, &options, monitor);
            if let Some(fibre) = joined {
                let (loops, paths) = (found.loops, found.paths + others.len());
                found = fill(&self.program, &fibre, accept, &self.symmetry, &options, pieces.part(AGAIN));
                (found.loops, found.paths) = (found.loops + loops, found.paths + paths);
            }
        }
        if options.trace_test && !matches!(found.stop, Stop::RootsReached | Stop::Cancelled) {
            let test = trace_test(self.system(), &found.fibre, &options, pieces.part(TRACE))?;
            // What an interrupted test says is no deviation.
            if monitor.is_cancelled() { found.stop = Stop::Cancelled } else { found.trace = Some(test) }
        }
        match checkpoint.and_then(Checkpoint::failure) {
            Some(error) => Err(error.into()),
            None => Ok(found),
        }
    }

    /// First pairs from other random points. On sheets that nearly part from each other loops of any
    /// common size may keep to one, on which the trace test passes; pairs lie on all.
    fn other_pairs(&self, seed: u64) -> Result<Vec<Fibre>, FamilyError> {
        let pair = |k: u64| find_pair(self.system(), |p, x| self.accepts(p, x), seed.wrapping_add(k), FEW_TRIES);
        Ok((1..=PAIRS).map(pair).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    /// The trace test of a fibre: whether it is whole. It takes several times as long as finding
    /// the fibre; `patience` of the options counts for the further points that it needs.
    ///
    /// # Errors
    /// If the fibre is of another family, or the enlarged family of the test does not compile.
    pub fn trace_test(
        &self,
        fibre: &Fibre,
        options: &MonodromyOptions,
        monitor: &Monitor,
    ) -> Result<TraceTest, FamilyError> {
        self.check(fibre)?;
        Ok(trace_test(self.system(), fibre, options, Pieces::new(None, monitor))?)
    }
}

/// What a search for solutions depends on.
#[derive(Serialize)]
struct Settings<'a> {
    #[serde(flatten)]
    options: &'a MonodromyOptions,
    start: Points,
}

/// From TOML.
impl FromStr for Family {
    type Err = FamilyError;

    fn from_str(text: &str) -> Result<Family, FamilyError> {
        Family::new(poly::parse::family(text)?)
    }
}

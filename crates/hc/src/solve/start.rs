//! Which start system is used, and the equations with the terms that it needs.

use super::equations::ScaledEquations;
use super::error::SolveError;
use super::options::{SolveOptions, Start};
use crate::monitor::Monitor;
use crate::start::{
    Grouped, MixedError, Multihomogeneous, PathSystem, Polyhedral, StartSystem, TotalDegree, bezout_number, degrees,
    leading_unknowns, mixed_volume_is_bezout,
};
use num_complex::Complex64;
use poly::{Interpreter, SparseSystem};

/// Polyhedral paths take two stages, the others one: up to this part of the paths more are worth a
/// trial.
const HARDLY_MORE: u64 = 8;

/// A source of start systems for given equations.
pub(super) struct Starts {
    /// The system of the coefficient stage.
    pub(super) system: PathSystem,
    /// As many equations as unknowns, with all terms of the system.
    pub(super) equations: ScaledEquations,
    /// Their coefficients in one row.
    pub(super) coefficients: Vec<Complex64>,
    /// The parameters of the system at which paths end.
    pub(super) target: Vec<Complex64>,
    pub(super) kind: Start,
    pub(super) numbers: Numbers,
    /// Number of paths.
    pub(super) paths: usize,
    degrees: Vec<u64>,
    /// The unknown of each equation in a total degree start system.
    unknowns: Vec<usize>,
    grouped: Option<Grouped>,
    /// The first mixed cells, if they were found while choosing.
    first: Option<Polyhedral>,
    /// Whether other start systems may be tried.
    may_try: bool,
}

/// How many paths start systems have; `None` where that is not known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Numbers {
    pub(super) mixed_volume: Option<u64>,
    pub(super) bezout: Option<u64>,
    pub(super) multihomogeneous: Option<u64>,
}

impl Numbers {
    /// The start system without a stage before its paths that has fewest.
    fn of_one_stage(&self) -> Option<(Start, u64)> {
        match (self.multihomogeneous, self.bezout) {
            (Some(m), b) if b.is_none_or(|b| m < b) => Some((Start::Multihomogeneous, m)),
            (_, b) => b.map(|b| (Start::TotalDegree, b)),
        }
    }
}

impl Starts {
    /// The start systems of equations. Those of named sums are not combined with others.
    pub(super) fn new(given: ScaledEquations, options: &SolveOptions, monitor: &Monitor) -> Result<Starts, SolveError> {
        let n = given.unknowns;
        let named_sums: Vec<usize> = given.named_sums().collect();
        let mut equations = if given.len() > n { given.squared(options.seed, &named_sums) } else { given };
        let laurent = equations.is_laurent();
        // Sums may vanish at solutions in the torus.
        if !named_sums.is_empty() || (!options.torus_only && !laurent) {
            for i in 0..n {
                equations.add_term(i, vec![0; n]);
            }
        }
        let degrees = degrees(&equations.supports).unwrap_or_default();
        let bezout = if laurent { None } else { bezout_number(&degrees) };
        let grouped = groups(&equations, options)?;
        let multihomogeneous = grouped.as_ref().map(Grouped::number);
        let direct = matches!(options.start, Start::TotalDegree | Start::Multihomogeneous);
        if direct && laurent {
            return Err(SolveError::NegativeExponents);
        }
        let mut numbers = Numbers { mixed_volume: None, bezout, multihomogeneous };
        let mut first = None;
        let (kind, paths) = match options.start {
            Start::TotalDegree => (Start::TotalDegree, bezout.unwrap_or(u64::MAX)),
            Start::Multihomogeneous => (Start::Multihomogeneous, multihomogeneous.ok_or(SolveError::StartTooLarge)?),
            Start::Auto if !options.torus_only && !laurent && mixed_volume_is_bezout(&equations.supports, &degrees) => {
                // Mixed cells are looked for if the trial of one stage fails.
                numbers.mixed_volume = bezout;
                (Start::Polyhedral, bezout.unwrap_or(u64::MAX))
            }
            choice => {
                match (Polyhedral::new(&equations.supports, options.seed, 0, monitor), numbers.of_one_stage()) {
                    (Ok(cells), _) => {
                        let volume = cells.mixed_volume;
                        numbers.mixed_volume = Some(volume);
                        first = Some(cells);
                        (Start::Polyhedral, volume)
                    }
                    (Err(MixedError::Cancelled), _) => return Err(MixedError::Cancelled.into()),
                    // Determinants out of range, but no more paths than are allowed.
                    (Err(_), Some(other)) if choice == Start::Auto && other.1 <= options.max_paths => other,
                    (Err(error), _) => return Err(error.into()),
                }
            }
        };
        // With the factors of a product as unknowns, those of one stage take far longer.
        let leads = || bezout.is_some() && leading_unknowns(&equations.supports, &degrees).is_some();
        let may_try = named_sums.is_empty() || leads();
        let starts = Starts::with(kind, paths, equations, None, numbers, degrees, grouped, options)?;
        Ok(Starts { first, may_try, ..starts })
    }

    /// Those of total degree of formulas of these degrees that are tracked as they were written, times the
    /// parameter of the program.
    pub(super) fn of_program(
        without_terms: ScaledEquations,
        program: Interpreter,
        degrees: Vec<u64>,
        options: &SolveOptions,
    ) -> Result<Starts, SolveError> {
        let (kind, bezout) = (Start::TotalDegree, bezout_number(&degrees));
        let numbers = Numbers { bezout, ..Numbers::default() };
        let paths = bezout.unwrap_or(u64::MAX);
        Starts::with(kind, paths, without_terms, Some(program), numbers, degrees, None, options)
    }

    /// Those of a kind.
    fn with(
        kind: Start,
        paths: u64,
        mut equations: ScaledEquations,
        written: Option<Interpreter>,
        numbers: Numbers,
        degrees: Vec<u64>,
        grouped: Option<Grouped>,
        options: &SolveOptions,
    ) -> Result<Starts, SolveError> {
        let n = equations.unknowns;
        let too_many = SolveError::TooManyPaths { paths, limit: options.max_paths };
        let paths = usize::try_from(paths).ok().filter(|_| paths <= options.max_paths).ok_or(too_many)?;
        // Otherwise the unknowns of the same numbers.
        let leading = if kind == Start::TotalDegree { leading_unknowns(&equations.supports, &degrees) } else { None };
        let unknowns = leading.unwrap_or_else(|| (0..n).collect());
        for i in 0..n {
            match (kind, &grouped) {
                (Start::TotalDegree, _) => {
                    let degree = i32::try_from(degrees[i]).map_err(|_| SolveError::NegativeExponents)?;
                    equations.add_term(i, vec![0; n]);
                    equations.add_term(i, (0..n).map(|j| if j == unknowns[i] { degree } else { 0 }).collect());
                }
                (Start::Multihomogeneous, Some(grouped)) => {
                    equations.add_terms(i, grouped.terms(i).ok_or(SolveError::StartTooLarge)?);
                }
                _ => {}
            }
        }
        let terms = SparseSystem::new(n, &equations.supports)?;
        let coefficients = equations.coefficients.concat();
        let (system, target) = match written {
            None => (PathSystem::of_terms(terms), coefficients.clone()),
            Some(program) => {
                let mut target = vec![Complex64::new(0.0, 0.0); coefficients.len()];
                target.push(Complex64::new(1.0, 0.0));
                (PathSystem::with_written(terms, program), target)
            }
        };
        let first = None;
        Ok(Starts {
            system,
            equations,
            coefficients,
            target,
            kind,
            numbers,
            paths,
            degrees,
            unknowns,
            grouped,
            first,
            may_try: false,
        })
    }

    /// Instead of these polyhedral ones, and only for [`Start::Auto`]: those of one stage that have
    /// hardly more paths. Whether they are less work shows after some paths, see
    /// [`super::paths::follow`].
    pub(super) fn direct(&self, options: &SolveOptions) -> Option<Starts> {
        let may_try = self.may_try && options.start == Start::Auto && !options.torus_only;
        let volume = self.numbers.mixed_volume.filter(|_| may_try)?;
        let (kind, paths) = self.numbers.of_one_stage().filter(|(_, paths)| *paths <= volume + volume / HARDLY_MORE)?;
        let (degrees, grouped) = (self.degrees.clone(), self.grouped.clone());
        Starts::with(kind, paths, self.equations.clone(), None, self.numbers, degrees, grouped, options).ok()
    }

    /// A start system, another one for every attempt.
    pub(super) fn system(
        &mut self,
        attempt: u64,
        options: &SolveOptions,
        monitor: &Monitor,
    ) -> Result<StartSystem, SolveError> {
        let supports = &self.equations.supports;
        let start = match (self.kind, &self.grouped) {
            (Start::TotalDegree, _) => StartSystem::TotalDegree(TotalDegree::new(
                supports,
                &self.degrees,
                &self.unknowns,
                options.seed,
                attempt,
            )),
            (Start::Multihomogeneous, Some(grouped)) => {
                StartSystem::Multihomogeneous(Multihomogeneous::new(supports, grouped.clone(), options.seed, attempt))
            }
            _ => StartSystem::Polyhedral(match self.first.take() {
                Some(cells) => cells,
                None => Polyhedral::new(supports, options.seed, attempt, monitor)?,
            }),
        };
        Ok(start.with_further(self.system.further()))
    }
}

/// The given groups with the degrees in them; `None` without groups, or if they are too many or
/// exponents negative.
fn groups(equations: &ScaledEquations, options: &SolveOptions) -> Result<Option<Grouped>, SolveError> {
    let n = equations.unknowns;
    if options.groups.is_empty() && options.start != Start::Multihomogeneous {
        return Ok(None);
    }
    let mut unknowns: Vec<usize> = options.groups.concat();
    unknowns.sort_unstable();
    if !unknowns.into_iter().eq(0..n) || options.groups.iter().any(Vec::is_empty) {
        return Err(SolveError::Groups(n));
    }
    Ok(Grouped::new(&equations.supports, &options.groups))
}

//! The formulas of a system, in the form in which they are solved.

use super::error::SolveError;
use super::options::{SolveOptions, Start};
use super::polynomials::{SolveContext, solve_polynomials, solve_written};
use super::solutions::{Direction, Solutions};
use crate::distinct::is_real;
use crate::monitor::Monitor;
use crate::start::bezout_number;
use crate::tolerances::{ends, equations};
use num_complex::Complex64;
use poly::{Exact, ExpandError, ExpandLimits, Polynomial, System};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A system as it was given, or with [named sums](System::with_named_sums) where it multiplies many: expanded,
/// these have many terms, in which digits cancel.
pub(crate) struct Formulas<'a> {
    /// The given system.
    pub(super) given: &'a System,
    pub(crate) solved: Cow<'a, System>,
    /// The system that is solved, expanded, or why it cannot be.
    pub(crate) polynomials: Result<Vec<Polynomial<Exact>>, ExpandError>,
}

impl<'a> Formulas<'a> {
    /// The form in which a system is solved with these options: with named sums where it multiplies at least
    /// `factors` of them.
    ///
    /// # Errors
    /// If it cannot be expanded, has parameters, or an option is out of range.
    pub(crate) fn new(given: &'a System, factors: u32, options: &SolveOptions) -> Result<Formulas<'a>, SolveError> {
        options.validate()?;
        if !given.parameters().is_empty() {
            return Err(SolveError::Parameters(given.parameters().join(", ")));
        }
        let counts = given.sums_multiplied();
        // In one unknown there are better ways to all roots.
        if given.variables().len() > 1 && counts.iter().any(|&count| count >= factors) {
            // Where the names are more than the sums that are multiplied, as in a sum of many powers, their
            // equations are more work than they save.
            let count = counts.iter().fold(0usize, |sum, &count| sum.saturating_add(count as usize));
            let same = |named: &System| bezout_of(named) == bezout_of(given);
            if let Some(formulas) = Formulas::with_names(given, count.min(equations::NAMED_SUMS), same, options) {
                return Ok(formulas);
            }
        }
        let error = match given.expand(&ExpandLimits::default()) {
            Ok(polynomials) => {
                return Ok(Formulas { given, solved: Cow::Borrowed(given), polynomials: Ok(polynomials) });
            }
            Err(error) => error,
        };
        if !matches!(error, ExpandError::TooLarge { .. }) {
            return Err(error.into());
        }
        let with_names = Formulas::with_names(given, equations::NAMED_SUMS, |_| true, options);
        Ok(with_names.unwrap_or(Formulas { given, solved: Cow::Borrowed(given), polynomials: Err(error) }))
    }

    /// With named sums; `None` where these would be more than `most`, or not serve the start system that was
    /// asked for: that of total degree needs their approval.
    fn with_names(
        given: &'a System,
        most: usize,
        approved: impl Fn(&System) -> bool,
        options: &SolveOptions,
    ) -> Option<Formulas<'a>> {
        if !options.groups.is_empty() {
            return None;
        }
        let named = given.with_named_sums(equations::KEPT_FACTORS, most)?;
        let serves = match options.start {
            Start::Auto | Start::Polyhedral => true,
            Start::TotalDegree => approved(&named),
            Start::Multihomogeneous => false,
        };
        let polynomials = serves.then(|| named.expand(&ExpandLimits::default()).ok())??;
        Some(Formulas { given, solved: Cow::Owned(named), polynomials: Ok(polynomials) })
    }

    /// How many unknowns, the last ones, and equations, the last ones, are named sums.
    pub(super) fn named_sums(&self) -> usize {
        self.solved.variables().len() - self.given.variables().len()
    }

    /// The solutions of the system that is solved.
    pub(super) fn solve(
        &self,
        options: &SolveOptions,
        monitor: &Monitor,
        context: SolveContext<'_>,
    ) -> Result<Solutions, SolveError> {
        let (equations, unknowns) = (self.given.len(), self.given.variables());
        if equations < unknowns.len() {
            return Err(SolveError::Underdetermined { equations, unknowns: unknowns.to_vec() });
        }
        let context = SolveContext { named_sums: self.named_sums(), ..context };
        match &self.polynomials {
            Ok(polynomials) => solve_polynomials(polynomials, self.solved.variables(), options, monitor, context),
            Err(error) => solve_written(&self.solved, error, options, monitor, context),
        }
    }

    /// What was found, in the given unknowns alone.
    pub(crate) fn in_given(&self, mut found: Solutions) -> Solutions {
        if self.named_sums() == 0 {
            return found;
        }
        let unknowns = self.given.variables().len();
        let cut = |value: &mut Vec<Complex64>| value.truncate(unknowns);
        for solution in &mut found.solutions {
            cut(&mut solution.value);
            let tolerance = if solution.multiplicity > 1 { ends::REAL_SINGULAR } else { ends::REAL };
            // Sums may be so large that imaginary parts beside them seem to be zero.
            solution.is_real &= is_real(&solution.value, tolerance);
        }
        found.component_points.iter_mut().for_each(cut);
        found.unresolved.iter_mut().for_each(|end| cut(&mut end.value));
        let mut directions: BTreeMap<(Vec<i64>, usize), usize> = BTreeMap::new();
        for Direction { mut valuations, denominator, paths } in std::mem::take(&mut found.directions) {
            valuations.truncate(unknowns);
            *directions.entry((valuations, denominator)).or_default() += paths;
        }
        let merged = directions.into_iter();
        found.directions =
            merged.map(|((valuations, denominator), paths)| Direction { valuations, denominator, paths }).collect();
        found
    }
}

/// The product of the degrees, as far as it is known before formulas are expanded.
fn bezout_of(system: &System) -> Option<u64> {
    bezout_number(&system.degrees_as_written()?)
}

//! What a solve has found.

use super::options::Start;
use super::warning::Warning;
use crate::certify::{Certificates, CertifyError, CertifyOptions, Reality, certify};
use crate::distinct::is_real;
use crate::family::{Limit, PathCounts};
use crate::tolerances::ends;
use num_complex::Complex64;
use poly::{ComplexInterval, System};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// An isolated solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Solution {
    /// The coordinates, in the order of the unknowns.
    pub value: Vec<Complex64>,
    /// Multiplicity: the dimension of the local ring of the given equations. As many paths end
    /// here. If there are more equations than unknowns, they may be more, and fewer from a fibre.
    pub multiplicity: usize,
    /// The largest winding number of these paths.
    pub winding_number: usize,
    /// Whether the Jacobian is singular here, to working precision.
    pub singular: bool,
    /// Whether the solution is real. Imaginary parts that are neither rounding errors nor clearly not zero are looked at
    /// with three hundred digits, by the exact coefficients; where these do not tell, parts below 1e-10 of the largest
    /// coordinate (or of one) count as zero.
    pub is_real: bool,
    /// Largest residual, relative to its row of the Jacobian times the sizes of the coordinates. If
    /// the Jacobian is singular, relative to the sizes of the terms of the equation.
    pub residual: f64,
    /// Condition number of the scaled Jacobian.
    pub condition: f64,
    /// Whether the solution is certified; `None` if this was not requested.
    pub certified: Option<bool>,
}

impl Solution {
    /// A solution, not certified, with its largest winding number.
    pub(super) fn new(
        value: Vec<Complex64>,
        multiplicity: usize,
        winding_number: usize,
        singular: bool,
        residual: f64,
        condition: f64,
    ) -> Solution {
        let is_real = is_real(&value, if singular { ends::REAL_SINGULAR } else { ends::REAL });
        Solution { value, multiplicity, winding_number, singular, is_real, residual, condition, certified: None }
    }
}

/// Whether the digits of a regular solution do not tell if it is real. With real coefficients the conjugate is a
/// solution too, which is another one only if both are far apart or ill-conditioned.
pub(super) fn is_real_in_doubt(value: &[Complex64], condition: f64, real_coefficients: bool) -> bool {
    let is_rounded = condition < ends::EXACT_CONDITION && is_real(value, ends::SURELY_REAL);
    let is_plain = real_coefficients && (is_rounded || value.iter().all(|z| z.im == 0.0));
    !is_plain && is_real(value, ends::SURELY_IMAGINARY)
}

/// A direction in which paths go to infinity.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Direction {
    /// Unknown `j` is of order `t^(valuations[j] / denominator)` as `t` falls to zero.
    pub valuations: Vec<i64>,
    /// The winding number.
    pub denominator: usize,
    /// Number of paths.
    pub paths: usize,
}

/// The system that was solved, and its parameters: what certificates are about.
#[derive(Clone, Debug, Default)]
pub(super) struct Member(Option<Arc<(System, Vec<ComplexInterval>)>>);

impl Member {
    pub(super) fn new(system: &System, parameters: &[Complex64]) -> Member {
        let parameters = parameters.iter().map(|&p| ComplexInterval::point(p)).collect();
        Member(Some(Arc::new((system.clone(), parameters))))
    }
}

/// Results are compared by what was found.
impl PartialEq for Member {
    fn eq(&self, _: &Member) -> bool {
        true
    }
}

/// The result of [`solve`](crate::solve): the distinct isolated solutions, and what became of the
/// paths. It is serialized without the names of the unknowns, the system, and [`represents`](Self::represents).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Solutions {
    /// Names of the unknowns, in the order of the coordinates.
    #[serde(skip)]
    pub variables: Vec<String>,
    #[serde(skip)]
    pub(super) member: Member,
    /// The start system that was used, never [`Start::Auto`]; `None` if paths came from a stored
    /// fibre or did not begin.
    pub start: Option<Start>,
    /// The mixed volume of the supports, including the origin unless only the torus was requested;
    /// `None` if it was not needed.
    pub mixed_volume: Option<u64>,
    /// The product of the degrees: the number of paths of total degree. `None` if exponents are
    /// negative or the number does not fit.
    pub bezout_number: Option<u64>,
    /// The multihomogeneous Bezout number of the given groups; `None` as above, or without groups.
    pub multihomogeneous_number: Option<u64>,
    /// How the paths ended. `finite` counts all ends at solutions, including singular solutions,
    /// solutions on components and excess solutions of `solve`.
    pub paths: PathCounts,
    /// Paths that ended on components of positive dimension.
    pub on_components: usize,
    /// Points on such components, one or more on each.
    pub component_points: Vec<Vec<Complex64>>,
    /// Paths that ended at points that were not requested: points that solve only random
    /// combinations of more equations than unknowns, and points outside the torus if only the torus
    /// was requested. Those of a tracked [`Family`](crate::Family) count as failed too: its paths begin at solutions of
    /// all equations, and those that end elsewhere have jumped.
    pub excess: usize,
    /// The directions in which paths went to infinity.
    pub directions: Vec<Direction>,
    /// Number of start systems that were used: more than one if paths were lost.
    pub start_systems: u32,
    /// Whether the work was cancelled. The list is then partial, and paths not tracked count as
    /// failed. In JSON `partial`.
    #[serde(rename = "partial")]
    pub interrupted: bool,
    /// The limit for whose sake failed paths were not tracked again; `None` if there was none, or no path failed.
    pub limited: Option<Limit>,
    /// The distinct isolated solutions, regular ones first.
    pub solutions: Vec<Solution>,
    /// Where one solution of each orbit under a family's symmetry is listed
    /// ([`Targets::up_to_symmetry`](crate::family::Targets::up_to_symmetry)): for how many each stands, itself among
    /// them. Empty if all are listed.
    #[serde(skip)]
    pub represents: Vec<usize>,
    /// Ends of paths at which the equations nearly vanish, but which could not be judged. Their
    /// paths count as failed.
    pub unresolved: Vec<Unresolved>,
}

/// An end of paths whose nature is not known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Unresolved {
    /// The coordinates, in the order of the unknowns.
    pub value: Vec<Complex64>,
    /// The number of paths that end here.
    pub paths: usize,
    /// Why it could not be judged.
    pub reason: String,
}

impl Solutions {
    /// Number of distinct isolated solutions that are listed.
    pub fn len(&self) -> usize {
        self.solutions.len()
    }

    /// Number of distinct isolated solutions, with those for which listed ones [stand](Self::represents).
    pub fn count(&self) -> usize {
        if self.represents.is_empty() { self.len() } else { self.represents.iter().sum() }
    }

    /// Whether all points have so many coordinates.
    pub(crate) fn fits(&self, unknowns: usize) -> bool {
        let values = self.solutions.iter().map(|s| &s.value).chain(self.unresolved.iter().map(|end| &end.value));
        values.chain(&self.component_points).all(|value| value.len() == unknowns)
    }

    /// Whether no isolated solution was found.
    pub fn is_empty(&self) -> bool {
        self.solutions.is_empty()
    }

    /// The solutions, regular ones first.
    pub fn iter(&self) -> std::slice::Iter<'_, Solution> {
        self.solutions.iter()
    }

    /// The real solutions ([`Solution::is_real`]), as real numbers.
    pub fn real_solutions(&self) -> impl Iterator<Item = Vec<f64>> {
        self.iter().filter(|s| s.is_real).map(|s| s.value.iter().map(|z| z.re).collect())
    }

    /// The solutions at which the Jacobian is not singular.
    pub fn nonsingular(&self) -> impl Iterator<Item = &Solution> {
        self.iter().filter(|s| !s.singular)
    }

    /// The solutions that are real to within `tolerance`: all imaginary parts are at most this
    /// share of the largest coordinate, or of one.
    pub fn at(&self, tolerance: f64) -> impl Iterator<Item = &Solution> {
        self.iter().filter(move |s| is_real(&s.value, tolerance))
    }

    /// Proves for each regular solution that it exists, that it is distinct, and whether it is real
    /// ([`certify`](mod@crate::certify)). The result is noted in [`Solution::certified`], and what
    /// is proved in [`Solution::is_real`] and [`Solution::singular`].
    ///
    /// # Errors
    /// If the system has more equations than unknowns.
    pub fn certify(&mut self) -> Result<Certificates, CertifyError> {
        let points: Vec<Vec<Complex64>> = self.iter().map(|s| s.value.clone()).collect();
        let Some(member) = &self.member.0 else { return Ok(Certificates::default()) };
        let found = certify(&member.0, &member.1, &points, &CertifyOptions::default())?;
        for (k, solution) in self.solutions.iter_mut().enumerate() {
            let unseparated = found.unseparated.iter().any(|pair| pair.contains(&k));
            let proof = found.points[k].as_ref().ok().filter(|_| found.duplicate_of[k].is_none() && !unseparated);
            solution.certified = Some(proof.is_some());
            // What is certified is regular, however badly conditioned.
            solution.singular &= proof.is_none();
            match proof.map(|p| p.reality) {
                Some(Reality::Real) => solution.is_real = true,
                Some(Reality::NotReal) => solution.is_real = false,
                Some(Reality::Undecided) | None => {}
            }
        }
        Ok(found)
    }

    /// How many solutions are real.
    pub fn n_real(&self) -> usize {
        self.iter().filter(|s| s.is_real).count()
    }

    /// Number of regular solutions for which certification was requested and failed.
    pub fn uncertified(&self) -> usize {
        self.nonsingular().filter(|s| s.certified == Some(false)).count()
    }

    /// What a reader of the list must know.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.interrupted {
            warnings.push(Warning::Partial);
        }
        if self.on_components > 0 {
            warnings.push(Warning::Components { paths: self.on_components, points: self.component_points.len() });
        }
        if self.excess > 0 {
            warnings.push(Warning::Excess { paths: self.excess });
        }
        if self.start_systems > 1 {
            warnings.push(Warning::Restarted { start_systems: self.start_systems });
        }
        if self.paths.failed > 0 {
            warnings.push(Warning::Lost { paths: self.paths.failed });
        }
        if let Some(limit) = self.limited {
            warnings.push(Warning::Limited { paths: self.paths.failed, limit });
        }
        if !self.unresolved.is_empty() {
            warnings.push(Warning::Unresolved { ends: self.unresolved.len() });
        }
        if self.uncertified() > 0 {
            warnings.push(Warning::Uncertified { solutions: self.uncertified() });
        }
        warnings
    }

    /// The numbers of paths of the start systems that were not chosen, as far as they are known.
    pub(super) fn others(&self, chosen: Start) -> String {
        let all = [
            (Start::Polyhedral, self.mixed_volume),
            (Start::Multihomogeneous, self.multihomogeneous_number),
            (Start::TotalDegree, self.bezout_number),
        ];
        let others = all.into_iter().filter(|(start, _)| *start != chosen);
        let known: Vec<String> = others.filter_map(|(start, paths)| Some(format!("{start}: {}", paths?))).collect();
        if known.is_empty() { String::new() } else { format!("; {}", known.join(", ")) }
    }
}

impl<'a> IntoIterator for &'a Solutions {
    type Item = &'a Solution;
    type IntoIter = std::slice::Iter<'a, Solution>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

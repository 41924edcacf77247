//! `hc.Family`: a compiled family, and its solutions for one parameter point.

use crate::arrays::{array, rows};
use crate::errors::{Failure, guarded};
use crate::work::{Done, WorkOptions, run, whole};
use hc::family::{StartFile, TargetLimits};
use hc::{FamilyError, MonodromyOptions, Run, Solution, Solutions, SolveOptions};
use num_complex::Complex64;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// A family, compiled.
#[pyclass(frozen, module = "hc._native")]
pub(crate) struct Family(Arc<hc::Family>);

/// All solutions of a family for one parameter point.
#[pyclass(frozen, module = "hc._native")]
pub(crate) struct Fibre(Arc<hc::Fibre>);

/// How a slot of a target's solutions was filled.
mod end {
    pub(super) const FINITE: i8 = 0;
    pub(super) const SINGULAR: i8 = 1;
    pub(super) const AT_INFINITY: i8 = 2;
    pub(super) const ON_COMPONENT: i8 = 3;
    pub(super) const FAILED: i8 = 4;
    pub(super) const IMAGE: i8 = 5;
}

#[pymethods]
impl Family {
    /// A family from TOML.
    #[staticmethod]
    fn from_text(text: &str) -> PyResult<Family> {
        guarded(|| Ok(Family(Arc::new(text.parse().map_err(|error: FamilyError| Failure::input(error))?))))
    }

    /// A family from formulas, with factors that do not vanish and maps that take solutions to solutions.
    #[staticmethod]
    fn from_formulas(
        unknowns: Vec<String>,
        parameters: Vec<String>,
        equations: Vec<String>,
        nonzero: Vec<String>,
        symmetry: Vec<Vec<String>>,
        roots: Option<usize>,
        name: String,
    ) -> PyResult<Family> {
        guarded(|| {
            let made = hc::poly::Family::from_formulas(&unknowns, &parameters, &equations);
            let made = made.and_then(|family| family.with_name(name).with_nonzero(&nonzero));
            let made = symmetry.iter().fold(made, |made, map| made.and_then(|family| family.with_symmetry(map)));
            let mut family = made.map_err(Failure::input)?;
            family.roots = roots;
            Ok(Family(Arc::new(hc::Family::new(family).map_err(Failure::input)?)))
        })
    }

    /// Name, unknowns, parameters and the number of roots, where it is known.
    fn describe(&self) -> (String, Vec<String>, Vec<String>, Option<usize>) {
        let (name, system) = (self.0.name().to_owned(), self.0.system());
        (name, system.variables().to_vec(), system.parameters().to_vec(), self.0.roots())
    }

    /// A fibre from the text of a start file.
    fn fibre(&self, json: &str) -> PyResult<Fibre> {
        guarded(|| {
            let file = StartFile::from_json(json).map_err(Failure::input)?;
            Ok(Fibre(Arc::new(self.0.stored(&file).map_err(Failure::input)?)))
        })
    }

    /// All solutions for some generic parameters: the text of a start file, and what the search
    /// says of itself.
    fn monodromy<'py>(
        &self,
        py: Python<'py>,
        seed: u64,
        roots: Option<usize>,
        patience: Option<usize>,
        trace: bool,
        only_component: bool,
        group: usize,
        up_to_symmetry: bool,
        first: Option<PyRef<'py, Fibre>>,
        how: WorkOptions,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(|| {
            let family = self.0.clone();
            let symmetric = family.clone();
            if up_to_symmetry && family.symmetry().is_empty() {
                return Err(Failure::input(FamilyError::NoSymmetry));
            }
            let first = first.map(|first| first.0.clone());
            let mut options = MonodromyOptions::new().seed(seed);
            options.roots = roots;
            options.patience = patience.unwrap_or(options.patience);
            (options.trace_test, options.only_component, options.group) = (trace, only_component, group);
            let Done { result: found, stopped, .. } = run(py, &how, move |monitor| {
                let first = match &first {
                    Some(first) => hc::Fibre::clone(first),
                    None => family.find_pair(seed)?,
                };
                Run::new().watched(monitor).complete(&family, &first, &options)
            })?;
            let found = found.map_err(|error: FamilyError| match error {
                FamilyError::NoPair | FamilyError::Special { .. } => Failure::undetermined(error),
                error => Failure::input(error),
            })?;
            let result = PyDict::new(py);
            let file = found.start_file();
            let file = if up_to_symmetry { symmetric.up_to_symmetry(&file).map_err(Failure::input)? } else { file };
            result.set_item("json", file.to_json())?;
            result.set_item("loops", found.loops)?;
            result.set_item("paths", found.paths)?;
            whole(py, result.into_any(), stopped)
        })
    }

    /// The solutions for many targets, from those of a fibre: points of shape (targets, roots,
    /// unknowns), NaN where there is none, and how each slot was filled.
    fn track<'py>(
        &self,
        py: Python<'py>,
        fibre: PyRef<'py, Fibre>,
        targets: PyReadonlyArrayDyn<'py, Complex64>,
        certify: bool,
        up_to_symmetry: bool,
        effort: (f64, Option<f64>),
        how: WorkOptions,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(|| {
            let (family, fibre, targets) = (self.0.clone(), fibre.0.clone(), rows(&targets)?);
            let (roots, unknowns) = (fibre.len(), fibre.dimension);
            let shown = fibre.representatives.as_ref().map_or(roots, Vec::len);
            let Done { result: found, stopped, seconds } = run(py, &how, move |monitor| {
                let options = SolveOptions::new().certify(certify);
                let mut limits = TargetLimits::default();
                (limits.again, limits.seconds) = effort;
                let tracking = Run::new().watched(monitor).track(&family, &fibre, &targets).options(&options);
                let tracking = tracking.limits(&limits).up_to_symmetry(up_to_symmetry);
                tracking.transform(|_, found| slots(&found, roots, shown, certify))
            })?;
            let found = found.map_err(Failure::input)?;
            let width = found.iter().map(|row| row.ends.len()).max().unwrap_or(0).max(roots);
            let nothing = Complex64::new(f64::NAN, f64::NAN);
            let mut points = vec![nothing; found.len() * width * unknowns];
            let mut ends = vec![end::AT_INFINITY; found.len() * width];
            let mut real = vec![false; found.len() * width];
            for (k, row) in found.iter().enumerate() {
                points[k * width * unknowns..][..row.points.len()].copy_from_slice(&row.points);
                ends[k * width..][..row.ends.len()].copy_from_slice(&row.ends);
                real[k * width..][..row.real.len()].copy_from_slice(&row.real);
            }
            let result = PyDict::new(py);
            result.set_item("points", array(py, points, &[found.len(), width, unknowns])?)?;
            result.set_item("ends", array(py, ends, &[found.len(), width])?)?;
            result.set_item("is_real", array(py, real, &[found.len(), width])?)?;
            let uncertified: Vec<i64> = found.iter().map(|row| row.uncertified as i64).collect();
            result.set_item("seconds", seconds)?;
            result.set_item("uncertified", array(py, uncertified, &[found.len()])?)?;
            whole(py, result.into_any(), stopped)
        })
    }
}

/// One target's solutions.
struct Slots {
    /// Coordinates; those of a singular solution are repeated as often as it counts.
    points: Vec<Complex64>,
    /// Whether each is real.
    real: Vec<bool>,
    /// The ends of all slots.
    ends: Vec<i8>,
    /// Regular solutions without certificate, where one was asked for.
    uncertified: usize,
}

fn slots(found: &Solutions, roots: usize, tracked: usize, certify: bool) -> Slots {
    let counts = |s: &Solution| if s.singular { s.multiplicity } else { 1 };
    let (mut points, mut real, mut ends) = (Vec::new(), Vec::new(), Vec::with_capacity(roots));
    for solution in found {
        let end = if solution.singular { end::SINGULAR } else { end::FINITE };
        for _ in 0..counts(solution) {
            points.extend(&solution.value);
            real.push(solution.is_real);
            ends.push(end);
        }
    }
    let images = found.iter().zip(&found.represents).map(|(s, &stands)| counts(s) * stands.saturating_sub(1)).sum();
    ends.extend(std::iter::repeat_n(end::IMAGE, images));
    let rest = roots.saturating_sub(ends.len());
    // In a symmetric family a path stands for an orbit, whose size an end without a solution does
    // not tell: one lost path leaves all the rest in doubt.
    let whole = |paths: usize| if tracked == roots || paths == 0 { paths.min(rest) } else { rest };
    let failed = whole(found.paths.failed);
    let components = whole(found.on_components).min(rest - failed);
    ends.extend(std::iter::repeat_n(end::FAILED, failed));
    ends.extend(std::iter::repeat_n(end::ON_COMPONENT, components));
    ends.extend(std::iter::repeat_n(end::AT_INFINITY, rest - failed - components));
    Slots { points, real, ends, uncertified: if certify { found.uncertified() } else { 0 } }
}

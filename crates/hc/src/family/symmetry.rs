//! Symmetries of a family: maps that take solutions to solutions, for the same parameters.

use super::error::FamilyError;
use super::images::Images;
use crate::distinct::relative_distance;
use crate::refine::Refiner;
use crate::tolerances::{families, same};
use num_complex::Complex64;
use poly::{Interpreter, System};

/// Most points of an orbit; maps that make more are not taken for a symmetry of finite order.
const LARGEST_ORBIT: usize = 10_000;

/// The group that some maps of the unknowns generate, compiled.
#[derive(Debug, Default)]
pub(super) struct Symmetry {
    /// The coordinates of all images, one map after the other; `None` if there are no maps.
    maps: Option<Interpreter>,
}

impl Symmetry {
    /// The group of maps of a family, each given by one formula per unknown.
    pub(super) fn new(family: &System, maps: &[System]) -> Result<Symmetry, FamilyError> {
        if maps.is_empty() {
            return Ok(Symmetry::default());
        }
        let all = System::build(|s| {
            let unknowns: Vec<_> = family.variables().iter().map(|name| s.variable(name)).collect();
            let parameters: Vec<_> = family.parameters().iter().map(|name| s.parameter(name)).collect();
            maps.iter().flat_map(|map| map.instantiate(s, &unknowns, &parameters)).collect()
        });
        // The names and constants come from systems that exist already.
        let all = all.map_err(|_| FamilyError::NoSymmetry)?;
        Ok(Symmetry { maps: Some(all.compile()?) })
    }

    /// The coordinates of all images, one map after the other; `None` if there are no maps.
    pub(super) fn program(&self) -> Option<&Interpreter> {
        self.maps.as_ref()
    }

    /// Whether there are no maps.
    pub(super) fn is_trivial(&self) -> bool {
        self.maps.is_none()
    }

    /// The orbit of the solution `x` for the parameters `p`, `x` first. Points within the relative
    /// distance `tolerance` are one.
    pub(super) fn orbit(&self, p: &[Complex64], x: &[Complex64], tolerance: f64) -> Vec<Vec<Complex64>> {
        let mut orbit = vec![x.to_vec()];
        let Some(maps) = &self.maps else { return orbit };
        let mut images = Images::new(maps);
        let mut next = 0;
        while next < orbit.len() && orbit.len() < LARGEST_ORBIT {
            for image in images.of(p, &orbit[next]).chunks_exact(x.len().max(1)) {
                let known = orbit.iter().any(|y| relative_distance(y, image) <= tolerance);
                if !known && image.iter().all(|z| z.is_finite()) {
                    orbit.push(image.to_vec());
                }
            }
            next += 1;
        }
        orbit
    }

    /// The numbers of solutions for the parameters `p` by orbits, ascending, in the order of their first. Images of
    /// solution `k` within the relative distance `tolerance(k)` of another solution are this one.
    pub(super) fn orbits(
        &self,
        p: &[Complex64],
        solutions: &[&[Complex64]],
        tolerance: impl Fn(usize) -> f64,
    ) -> Vec<Vec<usize>> {
        let mut orbits = Vec::new();
        let mut known = vec![false; solutions.len()];
        for k in 0..solutions.len() {
            if known[k] {
                continue;
            }
            let tolerance = tolerance(k);
            let images = self.orbit(p, solutions[k], tolerance);
            let is_image = |x: &[Complex64]| images.iter().any(|image| relative_distance(image, x) <= tolerance);
            let members: Vec<usize> =
                (k..solutions.len()).filter(|&j| j == k || (!known[j] && is_image(solutions[j]))).collect();
            members.iter().for_each(|&j| known[j] = true);
            orbits.push(members);
        }
        orbits
    }

    /// The first map, from 0, that takes one of these solutions of `system` for the parameters `p`
    /// to a point that is no regular solution.
    pub(super) fn broken<'x>(
        &self,
        system: &Interpreter,
        p: &[Complex64],
        solutions: impl Iterator<Item = &'x [Complex64]>,
    ) -> Option<usize> {
        let (mut refiner, mut images) = (Refiner::new(system), Images::new(self.maps.as_ref()?));
        let mut keeps = |image: &[Complex64]| {
            let refined = refiner.refine(p, image);
            refined.accuracy < families::ACCURATE && relative_distance(&refined.point, image) <= same::REGULAR
        };
        solutions.into_iter().find_map(|x| {
            let mut all = images.of(p, x).chunks_exact(x.len().max(1));
            all.position(|image| !keeps(image))
        })
    }
}

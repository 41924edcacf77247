//! Symmetries of a family: maps that take solutions to solutions, for the same parameters.

use crate::distinct::relative_distance;
use crate::refine::Refiner;
use crate::tolerances::{families, same};
use num_complex::Complex64;
use poly::{CompileError, Evaluate, Interpreter, Isa, System};

/// Most points of an orbit; maps that make more are not taken for a symmetry of finite order.
const LARGEST_ORBIT: usize = 10_000;

/// The group that some maps of the unknowns generate, compiled.
#[derive(Debug, Default)]
pub(super) struct Symmetry {
    maps: Vec<Interpreter>,
}

impl Symmetry {
    /// The group of maps, each given by one formula per unknown.
    pub(super) fn new(maps: &[System]) -> Result<Symmetry, CompileError> {
        Ok(Symmetry { maps: maps.iter().map(System::compile).collect::<Result<_, _>>()? })
    }

    /// Whether there are no maps.
    pub(super) fn is_trivial(&self) -> bool {
        self.maps.is_empty()
    }

    /// The orbit of the solution `x` for the parameters `p`, `x` first. Points within the relative
    /// distance `tolerance` are one.
    pub(super) fn orbit(&self, p: &[Complex64], x: &[Complex64], tolerance: f64) -> Vec<Vec<Complex64>> {
        let mut orbit = vec![x.to_vec()];
        let mut next = 0;
        while next < orbit.len() && orbit.len() < LARGEST_ORBIT {
            for map in &self.maps {
                let image = image(map, p, &orbit[next]);
                let known = orbit.iter().any(|y| relative_distance(y, &image) <= tolerance);
                if !known && image.iter().all(|z| z.is_finite()) {
                    orbit.push(image);
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
        let mut refiner = Refiner::new(system);
        for x in solutions {
            let keeps = |map: &Interpreter, refiner: &mut Refiner<'_, Interpreter>| {
                let image = image(map, p, x);
                let refined = refiner.refine(p, &image);
                refined.accuracy < families::ACCURATE && relative_distance(&refined.point, &image) <= same::REGULAR
            };
            if let Some(k) = self.maps.iter().position(|map| !keeps(map, &mut refiner)) {
                return Some(k);
            }
        }
        None
    }
}

/// Where a map takes the point `x`.
fn image(map: &Interpreter, p: &[Complex64], x: &[Complex64]) -> Vec<Complex64> {
    let mut memory = map.memory(Isa::Portable);
    let mut image = vec![Complex64::new(0.0, 0.0); map.equations()];
    map.values(&mut memory, x, p, &mut image);
    image
}

//! What the checkpoint of a family describes.

use super::fibre::Fibre;
use crate::checkpoint::{Hash, Job, System};
use crate::random::{Random, Stream};
use num_complex::Complex64;
use poly::{Evaluate, Interpreter, Isa};
use serde::Serialize;

/// A short hash of many points.
#[derive(Serialize)]
pub(super) struct Points {
    count: usize,
    hash: Hash,
}

impl Points {
    pub(super) fn new<'x>(points: impl Iterator<Item = &'x [Complex64]>) -> Points {
        let bytes: Vec<Vec<u8>> = points.map(bytes).collect();
        Points { count: bytes.len(), hash: Hash::of(bytes) }
    }

    /// The parameters of a fibre and its solutions.
    pub(super) fn of_fibre(fibre: &Fibre) -> Points {
        let hash = Hash::of(std::iter::once(&fibre.parameters[..]).chain(fibre.iter()).map(bytes));
        Points { count: fibre.len(), hash }
    }
}

/// Work on a family whose equations are this program, with the settings on which the result depends.
pub(super) fn job(what: &str, given: &poly::Family, program: &Interpreter, settings: &impl Serialize) -> Job {
    let systems = [&given.system, &given.nonzero].into_iter().chain(&given.symmetry);
    let mut parts: Vec<Vec<u8>> = systems.map(|system| system.to_string().into_bytes()).collect();
    parts.push(bytes(&somewhere(program)));
    let unknowns = given.system.variables().to_vec();
    let system = System { unknowns, equations: given.system.len(), hash: Hash::of(parts) };
    Job::new(what, system, settings)
}

/// The values of the equations at one point. They tell equations apart whose formulas are too long to be
/// shown in full.
fn somewhere(program: &Interpreter) -> Vec<Complex64> {
    let mut random = Random::of(0, Stream::Member(0));
    let (x, p) = (random.normals(program.variables()), random.normals(program.parameters()));
    let mut values = vec![Complex64::default(); program.equations()];
    program.values(&mut program.memory(Isa::Portable), &x, &p, &mut values);
    values
}

fn bytes(numbers: &[Complex64]) -> Vec<u8> {
    numbers.iter().flat_map(|z| [z.re, z.im]).flat_map(f64::to_le_bytes).collect()
}

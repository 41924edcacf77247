//! A parameter family, ready to be tracked.

use super::error::FamilyError;
use super::fibre::Fibre;
use super::overdetermined::Overdetermined;
use super::pair::{Beginning, MOVING_TRIES, Pairs, TRIES};
use super::stated::{Stated, Vanishing};
use super::still::{Still, refined};
use super::symmetry::Symmetry;
use super::verdict::Verdict;
use crate::checkpoint::{self, Hash, Job};
use crate::distinct::relative_distance;
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use crate::solve::Solutions;
use crate::tolerances::families;
use num_complex::Complex64;
use poly::{Evaluate, Interpreter, Isa, Split, System};
use serde::Serialize;
use std::str::FromStr;
use std::sync::OnceLock;

/// A compiled parameter family: its equations, the factors that must not vanish at its solutions,
/// and its symmetries.
///
/// Where there are more equations than unknowns, random combinations of them are tracked, and every solution is checked
/// against all equations. They must have solutions for generic parameters.
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
    /// The equations that are tracked, as many as unknowns.
    pub(super) program: Interpreter,
    /// These equations with less to do along a path, if there is a way; made when paths are first tracked.
    split: OnceLock<Option<Split>>,
    /// All equations, if these are more.
    pub(super) overdetermined: Option<Overdetermined>,
    pub(super) nonzero: Interpreter,
    pub(super) symmetry: Symmetry,
}

impl Family {
    /// Compiles a family: a [`poly::Family`], or a [`System`] with parameters.
    ///
    /// # Errors
    /// If a formula does not compile, or there are fewer equations than unknowns or no unknowns.
    pub fn new(family: impl Into<poly::Family>) -> Result<Family, FamilyError> {
        let family = family.into();
        let (equations, unknowns) = (family.system.len(), family.system.variables().len());
        if equations < unknowns || unknowns == 0 {
            return Err(FamilyError::Underdetermined { equations, unknowns });
        }
        let overdetermined = Overdetermined::new(&family.system)?;
        let square = overdetermined.as_ref().map_or(&family.system, |more| &more.square);
        let (program, nonzero) = (square.compile()?, family.nonzero.compile()?);
        if let Some(k) = family.symmetry.iter().position(|map| map.len() != unknowns) {
            return Err(FamilyError::Symmetry { map: k + 1, found: family.symmetry[k].len(), unknowns });
        }
        let symmetry = Symmetry::new(&family.system, &family.symmetry)?;
        Ok(Family { given: family, program, split: OnceLock::new(), overdetermined, nonzero, symmetry })
    }

    /// A family of equations in these unknowns and parameters. A [`poly::Family`] can state more.
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

    /// The family's name.
    pub fn name(&self) -> &str {
        &self.given.name
    }

    /// The equations.
    pub fn system(&self) -> &System {
        &self.given.system
    }

    /// The number of solutions for generic parameters, if the family states it.
    pub fn roots(&self) -> Option<usize> {
        self.given.roots
    }

    /// The maps of the unknowns that take solutions to solutions, with one formula per unknown.
    pub fn symmetry(&self) -> &[System] {
        &self.given.symmetry
    }

    /// The equations as a program, for the lower layers of this crate. If there are more than unknowns, these are random
    /// combinations of them, as many as unknowns; which of their solutions solve all equations
    /// [`accepts`](Self::accepts) tells.
    pub fn program(&self) -> &Interpreter {
        &self.program
    }

    /// The program with its parts that know no unknowns as parameters, if that makes it shorter.
    pub(super) fn split(&self) -> Option<&Split> {
        self.split.get_or_init(|| Split::new(self.square(), &self.program)).as_ref()
    }

    /// Whether the regular solution `x` of the [program](Self::program) (one entry per unknown) for the parameters `p`
    /// (one entry per parameter) is one of the family: it solves all equations, and none of the factors that the family
    /// declares nonzero vanishes.
    pub fn accepts(&self, p: &[Complex64], x: &[Complex64]) -> bool {
        self.is_inside(p, x, families::VANISHES) && self.verdict(p, x) == Verdict::Solves
    }

    /// Whether none of the factors that the family declares nonzero vanishes at a solution; values up to `tolerance`
    /// vanish.
    pub(super) fn is_inside(&self, p: &[Complex64], x: &[Complex64], tolerance: f64) -> bool {
        let mut memory = self.nonzero.memory(Isa::Portable);
        let mut values = vec![Complex64::new(0.0, 0.0); self.nonzero.equations()];
        self.nonzero.values(&mut memory, x, p, &mut values);
        values.iter().all(|z| z.norm() > tolerance)
    }

    /// Whether the family states nothing of its solutions but its equations, as many as unknowns.
    pub(crate) fn states_equations_alone(&self) -> bool {
        self.overdetermined.is_none() && self.nonzero.equations() == 0
    }

    /// Checks that a fibre has the family's numbers of parameters and unknowns.
    ///
    /// # Errors
    /// If it does not.
    pub fn check(&self, fibre: &Fibre) -> Result<(), FamilyError> {
        FamilyError::unless_fits(&self.program, fibre.parameters.len(), fibre.dimension)
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

    /// A first solution, for some generic parameters; if one is found that parameters move, such a
    /// solution. The same seed gives the same solution. Where Newton's method leads to none, as where it is drawn to
    /// multiple solutions, a start system for random parameters is solved if that takes few paths.
    ///
    /// # Errors
    /// If no regular solution is found that the family accepts, or only solutions for special parameters.
    pub fn find_pair(&self, seed: u64) -> Result<Fibre, FamilyError> {
        let pairs = Pairs::new(self.system(), self.square())?;
        let moves = |p: &[Complex64], x: &[Complex64]| !Still::new(&self.program, p).is(x);
        let (mut still, mut special) = (None, None);
        let accept = |p: &[Complex64], x: &[Complex64]| self.accepts(p, x);
        let tried = (0..TRIES).map(|attempt| (attempt, pairs.from(seed, attempt, &Beginning::default(), accept)));
        let of_member = std::iter::once_with(|| self.pairs_of_member(&pairs, seed)).flatten();
        for (attempt, pair) in tried.chain(of_member.map(|pair| (TRIES, Some(pair)))) {
            if (still.is_some() || special.is_some()) && attempt >= MOVING_TRIES {
                break;
            }
            let Some(pair) = pair else { continue };
            if let Err(error) = self.check_generic(&pair) {
                if matches!(error, FamilyError::Special { .. }) {
                    special.get_or_insert(error);
                }
                continue;
            }
            if moves(&pair.parameters, pair.solution(0)) {
                return Ok(pair);
            }
            still.get_or_insert(pair);
        }
        still.ok_or(special.unwrap_or(FamilyError::NoPair))
    }

    /// The first solutions of a search, refined if they are not.
    ///
    /// # Errors
    /// If one is not a regular solution of all equations, or far from one, or is one for special parameters only.
    pub(super) fn polished(&self, first: &Fibre) -> Result<Fibre, FamilyError> {
        let mut refiner = Refiner::new(&self.program);
        let mut polished = first.clone();
        let n = first.dimension.max(1);
        for (k, x) in polished.solutions.chunks_exact_mut(n).enumerate() {
            let refined = refined(&mut refiner, &first.parameters, x);
            if !(refined.accuracy < families::ACCURATE && refiner.is_regular(&first.parameters, &refined)) {
                return Err(FamilyError::FirstSingular { solution: k + 1 });
            }
            let moved = relative_distance(&refined.point, x);
            if moved > families::FIRST_MOVED {
                return Err(FamilyError::FirstSolution { solution: k + 1, moved });
            }
            if moved >= families::STORED_MOVED {
                x.copy_from_slice(&refined.point);
            }
        }
        self.check_solutions(&polished)?;
        self.check_generic(&polished)?;
        Ok(polished)
    }

    /// What the family states of its solutions besides its equations, for a
    /// [`FibreTracker`](crate::family::FibreTracker).
    pub fn stated(&self) -> Stated<'_> {
        let stated = Stated::default().nonzero(&self.nonzero);
        let stated = match &self.overdetermined {
            Some(more) => stated.equations(&more.all),
            None => stated,
        };
        match self.symmetry.program() {
            Some(maps) => stated.symmetry(maps),
            None => stated,
        }
    }

    /// All equations, if these are more than unknowns.
    #[cfg(feature = "codegen")]
    pub(crate) fn all_equations(&self) -> Option<&Interpreter> {
        self.overdetermined.as_ref().map(|more| &more.all)
    }

    /// The factors that must not vanish, one an equation.
    #[cfg(feature = "codegen")]
    pub(crate) fn factors(&self) -> &Interpreter {
        &self.nonzero
    }

    /// The coordinates of the images under all maps of the symmetry; `None` if there are none.
    #[cfg(feature = "codegen")]
    pub(crate) fn maps(&self) -> Option<&Interpreter> {
        self.symmetry.program()
    }

    /// Drops solutions outside the family, where a factor vanishes that it declares nonzero. The paths to them count
    /// as failed. A path can jump to them, and shares its end with no other path then, so that nothing else shows it.
    pub(super) fn keep_own(&self, p: &[Complex64], found: &mut Solutions) {
        let mut vanishing = Vanishing::new(&self.nonzero);
        let mut paths = 0;
        found.solutions.retain(|solution| {
            let degenerates = vanishing.at(p, &solution.value);
            paths += usize::from(degenerates) * solution.multiplicity;
            !degenerates
        });
        let paths = paths.min(found.paths.finite);
        found.paths.finite -= paths;
        found.paths.failed += paths;
    }

    /// What a checkpoint describes of work on this family, with the settings on which the result depends.
    pub(super) fn job(&self, what: &str, settings: &impl Serialize) -> Job {
        let given = &self.given;
        let systems = [&given.system, &given.nonzero].into_iter().chain(&given.symmetry);
        let mut parts: Vec<Vec<u8>> = systems.map(|system| system.to_string().into_bytes()).collect();
        parts.push(bytes(&somewhere(&self.program)));
        let unknowns = given.system.variables().to_vec();
        let system = checkpoint::System { unknowns, equations: given.system.len(), hash: Hash::of(parts) };
        Job::new(what, system, settings)
    }
}

/// From plain text or TOML, as [`poly::Family`] is read.
impl FromStr for Family {
    type Err = FamilyError;

    fn from_str(text: &str) -> Result<Family, FamilyError> {
        Family::new(text.parse::<poly::Family>()?)
    }
}

/// A short hash of many points.
#[derive(Serialize)]
pub(super) struct PointsHash {
    count: usize,
    hash: Hash,
}

impl PointsHash {
    pub(super) fn new<'x>(points: impl Iterator<Item = &'x [Complex64]>) -> PointsHash {
        let bytes: Vec<Vec<u8>> = points.map(bytes).collect();
        PointsHash { count: bytes.len(), hash: Hash::of(bytes) }
    }

    /// The parameters of a fibre and its solutions.
    pub(super) fn of_fibre(fibre: &Fibre) -> PointsHash {
        let hash = Hash::of(std::iter::once(&fibre.parameters[..]).chain(fibre.iter()).map(bytes));
        PointsHash { count: fibre.len(), hash }
    }
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

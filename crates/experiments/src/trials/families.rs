//! Families of twenty kinds whose numbers of solutions are known, and whether monodromy finds them.
//!
//! The numbers follow from how the equations are made. Coefficients are random, so that an unlucky draw could have
//! fewer solutions than its kind: [`singular`] writes the families for Singular, which has confirmed the numbers of
//! the first 50 of each kind at random parameters modulo 2147483629 and 1000000007.

mod draw;
mod known;
mod multiple;
mod orbits;
mod overdetermined;
mod problems;
mod scales;
mod singular;
mod symmetric;

use draw::Draw;
pub use hc::family::Stopped;
use hc::{Family, FamilyError, Monodromy, MonodromyOptions};
pub use known::Known;
pub use singular::singular;

/// A kind of family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// Products of trinomials in one unknown.
    Orbits,
    /// Products of curves or surfaces.
    Factors,
    /// Orbits that no product shows.
    Split,
    /// Solutions that no parameter moves.
    Constants,
    /// Solutions at which a stated factor vanishes do not count.
    Excluded,
    /// Species that compete.
    Species,
    /// Multiple solutions on a line that parameters move.
    Moving,
    /// A point of higher multiplicity.
    Point,
    /// A component of positive dimension.
    Component,
    /// Stated changes of signs.
    Signs,
    /// Symmetric polynomials.
    Exchange,
    /// Polynomials of polynomials.
    Composed,
    /// Weakly coupled equations.
    Coupled,
    /// Two groups of solutions far apart.
    Far,
    /// Units of their own.
    Units,
    /// Further equations that follow from the others.
    Redundant,
    /// Minors of a matrix.
    Minors,
    /// Linear in groups of unknowns.
    Groups,
    /// Oscillators.
    Oscillators,
    /// Stationary distances from a point.
    Nearest,
}

impl Kind {
    /// All kinds, with their names in tables.
    pub const ALL: [(Kind, &str); 20] = [
        (Kind::Orbits, "orbits"),
        (Kind::Factors, "curves and surfaces"),
        (Kind::Split, "powers of parameters"),
        (Kind::Constants, "constant solutions"),
        (Kind::Excluded, "excluded solutions"),
        (Kind::Species, "species"),
        (Kind::Moving, "multiple solutions"),
        (Kind::Point, "multiple point"),
        (Kind::Component, "component"),
        (Kind::Signs, "signs"),
        (Kind::Exchange, "symmetric polynomials"),
        (Kind::Composed, "composed"),
        (Kind::Coupled, "weakly coupled"),
        (Kind::Far, "far apart"),
        (Kind::Units, "units"),
        (Kind::Redundant, "redundant equations"),
        (Kind::Minors, "minors"),
        (Kind::Groups, "groups of unknowns"),
        (Kind::Oscillators, "oscillators"),
        (Kind::Nearest, "nearest points"),
    ];

    /// The family of this kind that belongs to a seed.
    pub fn family(self, seed: u64) -> Known {
        let draw = &mut Draw::new(seed ^ 0x2b7e_1516_28ae_d2a6 ^ ((self as u64) << 40));
        match self {
            Kind::Orbits => orbits::orbits(draw),
            Kind::Factors => orbits::factors(draw),
            Kind::Split => orbits::split(draw),
            Kind::Constants => orbits::constants(draw),
            Kind::Excluded => orbits::excluded(draw),
            Kind::Species => orbits::species(draw),
            Kind::Moving => multiple::moving(draw),
            Kind::Point => multiple::point(draw),
            Kind::Component => multiple::component(draw),
            Kind::Signs => symmetric::signs(draw),
            Kind::Exchange => symmetric::exchange(draw),
            Kind::Composed => symmetric::composed(draw),
            Kind::Coupled => scales::coupled(draw),
            Kind::Far => scales::far(draw),
            Kind::Units => scales::units(draw),
            Kind::Redundant => overdetermined::redundant(draw),
            Kind::Minors => overdetermined::minors(draw),
            Kind::Groups => problems::groups(draw),
            Kind::Oscillators => problems::oscillators(draw),
            Kind::Nearest => problems::nearest(draw),
        }
    }
}

/// How a search ended, as the program `hc monodromy` ends without options.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// Exit status 0, with these numbers of regular solutions and multiplicities of others, in ascending order.
    Whole(usize, Vec<usize>),
    /// Exit status 1, since this is all that is known.
    Undetermined(Stopped),
    /// Exit status 1, since no first solution is found.
    NoPair,
    /// The family is refused.
    Refused(FamilyError),
}

impl End {
    /// Whether it ends with exit status 0 and has these solutions.
    pub fn is_right(&self, known: &Known) -> bool {
        matches!(self, End::Whole(regular, multiple) if *regular == known.regular && *multiple == known.multiplicities)
    }
}

/// Searches for all solutions of a family, with a seed.
pub fn searched(known: &Known, seed: u64) -> End {
    let found = known
        .family()
        .map_err(FamilyError::from)
        .and_then(Family::new)
        .and_then(|family| family.monodromy(&MonodromyOptions::new().seed(seed)));
    match found {
        Ok(Monodromy { fibre, stopped, multiple, .. }) if stopped.is_complete() => {
            let mut multiplicities: Vec<usize> = multiple.iter().map(|multiple| multiple.multiplicity).collect();
            multiplicities.sort_unstable();
            End::Whole(fibre.len(), multiplicities)
        }
        Ok(Monodromy { stopped, .. }) => End::Undetermined(stopped),
        Err(FamilyError::NoPair) => End::NoPair,
        Err(error) => End::Refused(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_families_of_few_solutions() {
        for (kind, name) in Kind::ALL {
            for seed in 0..50 {
                let known = kind.family(seed);
                let family = Family::new(known.family().unwrap()).unwrap();
                assert!((2..=4).contains(&known.unknowns) && (1..=40).contains(&known.regular), "{name} {known:?}");
                let more = matches!(kind, Kind::Redundant | Kind::Minors);
                assert_eq!(known.equations.len() > known.unknowns, more, "{name} {known:?}");
                let parameters = family.system().parameters();
                let is_used = |p: &&str| known.equations.iter().any(|equation| equation.contains(*p));
                assert!(
                    parameters.len() == known.parameters && known.parameters().iter().all(is_used),
                    "{name} {known:?}"
                );
                assert_eq!(kind.family(seed), known);
                assert!(seed == 0 || kind.family(seed - 1) != known, "{name}");
            }
        }
    }

    /// Two species: none, either, both.
    #[test]
    fn an_end_is_right_with_the_same_numbers() {
        let equations = ["x*(a + x + 2*y)", "y*(3 + x + y)"].map(str::to_owned).to_vec();
        let known = Known { unknowns: 2, parameters: 1, equations, regular: 4, ..Known::default() };
        assert_eq!(searched(&known, 1), End::Whole(4, Vec::new()));
        for (end, is_right) in [
            (End::Whole(4, Vec::new()), true),
            (End::Whole(3, Vec::new()), false),
            (End::Whole(4, vec![2]), false),
            (End::Undetermined(Stopped::OrbitsWhole), false),
            (End::NoPair, false),
        ] {
            assert_eq!(end.is_right(&known), is_right, "{end:?}");
        }
        let equations = ["x - 1", "x - 2", "y - a"].map(str::to_owned).to_vec();
        assert_eq!(searched(&Known { equations, ..known }, 1), End::NoPair);
    }
}

//! Random systems whose ends are not all regular, with answers that are known by construction.

mod case;
mod classical;
mod clusters;
mod components;
mod draw;
mod extreme;
mod multiple;
mod plane;

pub(crate) use case::Case;
pub(crate) use draw::Draw;

/// Draws a system of a kind.
pub(crate) type Kind = fn(&mut Draw) -> Case;

/// The kinds of systems, by name.
pub(crate) const KINDS: [(&str, Kind); 41] = [
    ("component not reduced", components::not_reduced),
    ("component near a solution", components::near),
    ("component with embedded points", components::embedded),
    ("overdetermined, a zero coordinate", plane::overdetermined),
    ("overdetermined, multiple", plane::overdetermined_multiple),
    ("isolated, corank 1", plane::corank_one),
    ("isolated, corank 2", plane::corank_two),
    ("multiple beside regular", plane::multiple_beside_regular),
    ("ill-conditioned", plane::ill_conditioned),
    ("one unknown", plane::one_unknown),
    ("large integers", plane::large_integers),
    ("paths to infinity", plane::infinite),
    ("cluster, a pair", clusters::pair),
    ("cluster, one unknown", clusters::one_unknown),
    ("cluster, two unknowns", clusters::two_unknowns),
    ("cluster, three unknowns", clusters::three_unknowns),
    ("cluster beside others", clusters::beside_others),
    ("cluster on a curve", clusters::on_a_curve),
    ("cluster round irrational points", clusters::round_irrational),
    ("multiplicity to 32, two unknowns", multiple::two_unknowns),
    ("multiplicity to 32, three unknowns", multiple::three_unknowns),
    ("multiple, irrational", multiple::irrational),
    ("multiple, equal squares", multiple::equal_squares),
    ("multiple, powers equal products", multiple::powers_equal_products),
    ("corank 3", multiple::corank::<3>),
    ("corank 4", multiple::corank::<4>),
    ("corank 5", multiple::corank::<5>),
    ("corank 3 beside regular", multiple::corank_beside_regular::<3>),
    ("corank 4 beside regular", multiple::corank_beside_regular::<4>),
    ("extreme, nearly consistent", extreme::nearly_consistent),
    ("extreme, far", extreme::far),
    ("extreme, far and irrational", extreme::far_irrational),
    ("extreme, irrational pairs", extreme::irrational_pairs),
    ("extreme, nearly a component", extreme::nearly_a_component),
    ("extreme, nearly real", extreme::nearly_real),
    ("Mignotte, one unknown", classical::mignotte),
    ("Mignotte, two unknowns", classical::mignotte_beside_a_curve),
    ("Wilkinson, one unknown", classical::wilkinson),
    ("Wilkinson, two unknowns", classical::wilkinson_beside_a_curve),
    ("Chebyshev, one unknown", classical::chebyshev),
    ("Chebyshev, two unknowns", classical::chebyshev_beside_a_curve),
];

//! Families on several scales.

use super::draw::{Draw, plain, power, product, signed};
use super::known::Known;
use super::orbits::root;

/// Equations in one unknown each, coupled by small terms (1e-2 to 1e-8): the number of solutions is the product of the
/// degrees, as there is none at infinity. Where not every equation has a parameter, its solutions hardly move.
pub(super) fn coupled(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(2);
    let unknowns = draw.between(2, 3);
    let names = plain(unknowns);
    let small = 10u64.pow(draw.between(2, 8) as u32);
    let degrees: Vec<usize> = (0..unknowns).map(|_| draw.between(2, 3)).collect();
    let share_all = draw.is_heads();
    let equation = |k: usize| {
        let moved = match (parameters.get(k), share_all) {
            (Some(p), _) => draw.lower(p, &names[k], degrees[k]),
            (None, true) => draw.lower(parameters[0], &names[k], degrees[k]),
            (None, false) => draw.term(&names[k]),
        };
        let coupling = draw.term(&product(&[&format!("1/{small}"), &names[(k + 1) % unknowns]]));
        format!("{} {moved} {} {coupling}", power(&names[k], degrees[k]), draw.term(""))
    };
    let equations = (0..unknowns).map(equation).collect();
    Known::new(unknowns, parameters.len(), equations, degrees.iter().product())
}

/// Two groups of solutions 10 to 1,000,000 apart, of which a constant makes one orbit.
pub(super) fn far(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let names = draw.coordinates(2);
    let (x, distance) = (&names[0], 10i64.pow(draw.between(1, 6) as u32));
    let degrees = [0, 1].map(|_| draw.between(1, 3));
    let there = power(&format!("({x} {})", signed(-distance, "")), degrees[0]);
    let (first, second) = (parameters[0], parameters[parameters.len() / 2]);
    let equation =
        format!("({there} {})*({} {}) {}", draw.term(first), power(x, degrees[1]), draw.term(second), draw.term(""));
    let (root, count) = root(draw, &names, parameters[parameters.len() - 1]);
    Known::new(2, parameters.len(), vec![equation, root], (degrees[0] + degrees[1]) * count)
}

/// Curves and surfaces in unknowns and parameters that have units of their own, 1e-6 to 1e6.
pub(super) fn units(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let unknowns = draw.between(2, 3);
    let names: Vec<String> = plain(unknowns).iter().map(|name| in_unit(draw, name)).collect();
    let own: Vec<String> = parameters.iter().map(|name| in_unit(draw, name)).collect();
    let degrees: Vec<usize> = (0..unknowns).map(|_| draw.between(2, 5 - unknowns)).collect();
    let equations = draw.generals(&names, &degrees, &own.iter().map(String::as_str).collect::<Vec<_>>());
    let equations = equations.iter().map(|equation| in_unit(draw, &format!("({equation})"))).collect();
    Known::new(unknowns, parameters.len(), equations, degrees.iter().product())
}

fn in_unit(draw: &mut Draw, what: &str) -> String {
    let unit = 10u64.pow(draw.between(0, 6) as u32);
    if draw.is_heads() { format!("({unit}*{what})") } else { format!("(1/{unit}*{what})") }
}

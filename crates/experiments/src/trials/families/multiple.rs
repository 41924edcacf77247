//! Families with solutions that are multiple for all parameters, and with components.

use super::draw::{Draw, monomials, power, signed};
use super::known::Known;
use super::orbits::root;

/// One unknown solves a product with a repeated factor that a parameter moves; the other one is a root. The solutions
/// of the repeated factor have its multiplicity.
pub(super) fn moving(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let names = draw.coordinates(2);
    let (times, degree) = (draw.between(2, 3), draw.between(1, 3));
    let constants = draw.different(2);
    let repeated = format!("({} {} {})", names[0], draw.term("a"), signed(constants[0], ""));
    let moved = draw.lower(parameters[parameters.len() / 2], &names[0], degree);
    let other = format!("({} {moved} {})", power(&names[0], degree), signed(constants[1], ""));
    let (root, count) = root(draw, &names, parameters[parameters.len() - 1]);
    let equations = vec![format!("{}*{other}", power(&repeated, times)), root];
    let known = Known::new(2, parameters.len(), equations, degree * count);
    Known { multiplicities: vec![times; count], ..known }
}

/// Two curves that both have a multiple point at the same place, which a parameter moves or none. The multiplicity
/// there is the product of theirs, as they have no common tangent; Bezout's theorem counts the others.
pub(super) fn point(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let orders = draw.one(&[[1, 2], [2, 1], [2, 2], [1, 3], [2, 3]]);
    let degrees = orders.map(|order| order + draw.between(1, 2));
    let place = draw.different(2);
    let moved = if draw.is_heads() { draw.term("a") } else { String::new() };
    let names = [format!("(x {} {moved})", signed(place[0], "")), format!("(y {})", signed(place[1], ""))];
    let shares = draw.shares(parameters, 2);
    let curve = |(k, share): (usize, Vec<&str>)| {
        // Not of the highest degree: nothing moves to infinity.
        let factors: Vec<String> = (orders[k]..degrees[k]).flat_map(|degree| monomials(&names, degree)).collect();
        format!("{}{}", draw.dense(&names, orders[k]..=degrees[k]), draw.moved(&share, &factors))
    };
    let equations = shares.into_iter().enumerate().map(curve).collect();
    let times = orders[0] * orders[1];
    let known = Known::new(2, parameters.len(), equations, degrees[0] * degrees[1] - times);
    Known { multiplicities: vec![times], ..known }
}

/// Two equations have a linear factor in common, whose zeros are a component; the other factors, and a third equation in
/// space, have as many points as the product of their degrees.
pub(super) fn component(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let unknowns = draw.between(2, 3);
    let names = draw.coordinates(unknowns);
    let degrees: Vec<usize> = (0..unknowns).map(|_| draw.between(1, 5 - unknowns)).collect();
    let own = if draw.is_heads() { &parameters[..1] } else { &[] };
    let shared = draw.general(&names, 1, own);
    let mut equations = draw.generals(&names, &degrees, parameters);
    equations[..2].iter_mut().for_each(|equation| *equation = format!("({shared})*({equation})"));
    let known = Known::new(unknowns, parameters.len(), equations, degrees.iter().product());
    Known { has_components: true, ..known }
}

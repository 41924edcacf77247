//! Symmetric families, and others whose solutions come in groups.

use super::draw::{Draw, monomials, plain};
use super::known::Known;

/// Curves and surfaces that keep when all unknowns change their signs, or any one does; the symmetries are stated.
pub(super) fn signs(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let unknowns = draw.between(2, 3);
    let names = plain(unknowns);
    let map = |negative: &dyn Fn(usize) -> bool| -> Vec<String> {
        let image = |(k, name): (usize, &String)| if negative(k) { format!("-{name}") } else { name.clone() };
        names.iter().enumerate().map(image).collect()
    };
    // All degrees are even; at most one of three is four.
    let mut degrees: Vec<usize> = vec![2; unknowns];
    for degree in &mut degrees[..4 - unknowns] {
        *degree = draw.one(&[2, 4]);
    }
    let count = degrees.iter().product();
    if draw.is_heads() {
        let shares = draw.shares(parameters, unknowns);
        let equation = |(&degree, share): (&usize, Vec<&str>)| {
            let moved: Vec<String> = (0..degree).step_by(2).flat_map(|d| monomials(&names, d)).collect();
            format!("{}{}", draw.dense(&names, (0..=degree).step_by(2)), draw.moved(&share, &moved))
        };
        let equations = degrees.iter().zip(shares).map(equation).collect();
        return Known { symmetry: vec![map(&|_| true)], ..Known::new(unknowns, parameters.len(), equations, count) };
    }
    let squares: Vec<String> = names.iter().map(|name| format!("({name}^2)")).collect();
    let halves: Vec<usize> = degrees.iter().map(|degree| degree / 2).collect();
    let equations = draw.generals(&squares, &halves, parameters);
    let symmetry = (0..unknowns).map(|j| map(&|k| j == k)).collect();
    Known { symmetry, ..Known::new(unknowns, parameters.len(), equations, count) }
}

/// Equations in the elementary symmetric functions of the unknowns: for each of their solutions as many as there are
/// orders of the unknowns. The symmetry is stated or not.
pub(super) fn exchange(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let (functions, degrees, orders, maps): (&[&str], &[usize], usize, &[&[&str]]) = match draw.between(0, 4) {
        0 => (&["(x + y + z)", "(x*y + y*z + z*x)", "(x*y*z)"], &[1, 1, 1], 6, &[&["y", "x", "z"], &["y", "z", "x"]]),
        1 => (&["(x + y + z)", "(x*y + y*z + z*x)", "(x*y*z)"], &[1, 2, 1], 6, &[&["y", "x", "z"], &["y", "z", "x"]]),
        2 => (&["(x + y)", "(x*y)"], &[1, 2], 2, &[&["y", "x"]]),
        3 => (&["(x + y)", "(x*y)"], &[2, 2], 2, &[&["y", "x"]]),
        _ => (&["(x + y)", "(x*y)"], &[2, 3], 2, &[&["y", "x"]]),
    };
    let names: Vec<String> = functions.iter().map(|&name| name.to_owned()).collect();
    let equations = draw.generals(&names, degrees, parameters);
    let known = Known::new(names.len(), parameters.len(), equations, orders * degrees.iter().product::<usize>());
    let maps = if draw.is_heads() { maps } else { &[] };
    Known { symmetry: maps.iter().map(|map| map.iter().map(|&x| x.to_owned()).collect()).collect(), ..known }
}

/// Two curves in the plane to which two polynomials map: the number of solutions is the product of all degrees.
pub(super) fn composed(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let names = plain(2);
    let [d, e, f, g] = draw.one(&[[1, 2, 2, 2], [2, 2, 1, 2], [2, 2, 2, 2], [2, 3, 1, 2], [1, 3, 2, 2]]);
    let inner = [f, g].map(|degree| format!("({})", draw.dense(&names, 1..=degree)));
    let equations = draw.generals(&inner, &[d, e], parameters);
    Known::new(2, parameters.len(), equations, d * e * f * g)
}

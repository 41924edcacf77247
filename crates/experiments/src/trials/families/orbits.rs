//! Families that fall into several orbits.

use super::draw::{Draw, plain, power, product, signed, sum};
use super::known::Known;

/// One unknown solves a product of trinomials, the other one is a root of a number that the first one moves. The number
/// of solutions is the product of the degrees.
pub(super) fn orbits(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let names = draw.coordinates(2);
    let degrees: Vec<usize> = (0..draw.between(2, 3)).map(|_| draw.between(1, 3)).collect();
    let constants = draw.different(degrees.len());
    let factor = |(k, &degree): (usize, &usize)| {
        let moved = draw.lower(parameters[k % parameters.len()], &names[0], degree);
        format!("({} {moved} {})", power(&names[0], degree), signed(constants[k], ""))
    };
    let factors: Vec<String> = degrees.iter().enumerate().map(factor).collect();
    let (root, degree) = root(draw, &names, parameters[parameters.len() - 1]);
    let count = degrees.iter().sum::<usize>() * degree;
    Known::new(2, parameters.len(), vec![factors.join("*"), root], count)
}

/// The second unknown as a root, of degree one to three, of a number that the first one and a parameter move.
pub(super) fn root(draw: &mut Draw, names: &[String], parameter: &str) -> (String, usize) {
    let degree = draw.between(1, 3);
    let terms = [draw.term(&names[0]), draw.term(parameter), draw.term("")];
    (format!("{} {}", power(&names[1], degree), terms.join(" ")), degree)
}

/// Products of curves or surfaces: each choice of one of every equation has as many points as the product of their
/// degrees, by Bezout's theorem.
pub(super) fn factors(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let unknowns = draw.between(2, 3);
    let names = draw.coordinates(unknowns);
    let degrees: Vec<Vec<usize>> = if unknowns == 2 {
        (0..2).map(|_| draw.one(&[vec![1, 1], vec![1, 2], vec![2, 2], vec![1, 1, 1], vec![1, 3]])).collect()
    } else {
        let first = draw.one(&[vec![1, 1], vec![1, 2]]);
        let others = [vec![1, 1], vec![2], vec![1, 1, 1]];
        vec![first, draw.one(&others), draw.one(&others)]
    };
    let all: Vec<usize> = degrees.iter().flatten().copied().collect();
    let mut factors = draw.generals(&names, &all, parameters).into_iter();
    let mut equation = |degrees: &Vec<usize>| {
        let factors = factors.by_ref().take(degrees.len());
        factors.map(|factor| format!("({factor})")).collect::<Vec<_>>().join("*")
    };
    let equations = degrees.iter().map(&mut equation).collect();
    Known::new(unknowns, parameters.len(), equations, degrees.iter().map(|d| d.iter().sum::<usize>()).product())
}

/// A power of an unknown equals another power of a parameter, where the exponents have a common divisor: as many orbits
/// as that, though nothing is written as a product.
pub(super) fn split(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(2);
    let names = draw.coordinates(2);
    let (degree, exponent) = draw.one(&[(2, 2), (3, 3), (4, 2), (6, 3), (6, 2), (4, 4)]);
    let moved = format!("(a {})^{exponent}", draw.term(""));
    let moved = draw.term(&moved);
    let (root, count) = root(draw, &names, parameters[parameters.len() - 1]);
    let equations = vec![format!("{} {moved}", power(&names[0], degree)), root];
    Known::new(2, parameters.len(), equations, degree * count)
}

/// Some solutions are moved by no parameter: the origin, where there are no constant terms; zeros of factors without
/// parameters; two points that all conics have in common.
pub(super) fn constants(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(2);
    match draw.between(0, 2) {
        0 => {
            let unknowns = draw.between(2, 3);
            let names = draw.coordinates(unknowns);
            let degrees: Vec<usize> = (0..unknowns).map(|_| draw.between(2, 5 - unknowns)).collect();
            let shares = draw.shares(parameters, unknowns);
            let equation = |(&degree, share): (&usize, Vec<&str>)| {
                format!("{}{}", draw.dense(&names, 1..=degree), draw.moved(&share, &names))
            };
            let equations = degrees.iter().zip(shares).map(equation).collect();
            Known::new(unknowns, parameters.len(), equations, degrees.iter().product())
        }
        1 => {
            let names = draw.coordinates(2);
            let (x, degree) = (&names[0], draw.between(2, 3));
            let constants = draw.different(3);
            let moved = draw.term(&product(&["a", x]));
            let factors = format!(
                "({x} {})*({x}^2 {})*({x}^{degree} {moved} {})",
                signed(constants[0], ""),
                signed(constants[1].abs(), ""),
                signed(constants[2], "")
            );
            let (root, count) = root(draw, &names, parameters[parameters.len() - 1]);
            Known::new(2, parameters.len(), vec![factors, root], (3 + degree) * count)
        }
        _ => {
            let names = draw.coordinates(2);
            let [p, q] = [0, 1].map(|_| draw.different(2));
            // A line through each point, and one through both.
            let mut line = |p: &[i64]| {
                let terms = [0, 1].map(|k| draw.term(&format!("({} {})", names[k], signed(-p[k], ""))));
                format!("({})", sum(terms))
            };
            let lines = [line(&p), line(&q)].join("*");
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            let both =
                format!("({dy}*({} {}) - ({dx})*({} {}))", names[0], signed(-p[0], ""), names[1], signed(-p[1], ""));
            let shares = draw.shares(parameters, 2);
            let conic =
                |share: Vec<&str>| format!("{both}*({}) {}", draw.general(&names, 1, &share), draw.term(&lines));
            Known::new(2, parameters.len(), shares.into_iter().map(conic).collect(), 4)
        }
    }
}

/// Solutions at which a linear form vanishes are not counted; the others are those of two curves.
pub(super) fn excluded(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let names = draw.coordinates(2);
    let degrees = draw.one(&[[1, 2], [2, 1], [2, 2], [1, 3], [3, 2], [3, 3]]);
    let own = if draw.is_heads() { &parameters[..1] } else { &[] };
    let line = draw.general(&names, 1, own);
    let mut equations = draw.generals(&names, &degrees, parameters);
    equations[0] = format!("{}*({})", power(&format!("({line})"), draw.between(1, 2)), equations[0]);
    Known { nonzero: vec![line], ..Known::new(2, parameters.len(), equations, degrees[0] * degrees[1]) }
}

/// Species that compete, each of which may be absent: a point for each set of them (Lotka and Volterra).
pub(super) fn species(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let unknowns = draw.between(2, 4);
    let names = plain(unknowns);
    let shares = draw.shares(parameters, unknowns);
    let equation = |(name, share): (&String, Vec<&str>)| {
        let growth =
            if share.is_empty() { format!(" {}", draw.term("")) } else { draw.moved(&share, &[String::new()]) };
        format!("{name}*({}{growth})", draw.dense(&names, [1]))
    };
    let equations = names.iter().zip(shares).map(equation).collect();
    Known::new(unknowns, parameters.len(), equations, 1 << unknowns)
}

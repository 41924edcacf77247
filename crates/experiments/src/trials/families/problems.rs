//! Families of problems that others have counted.

use super::draw::{Draw, monomials, plain, power, product, signed, sum};
use super::known::Known;

/// Equations that are linear, or of low degree, in each group of unknowns. In two unknowns mixed terms of the product
/// of linear forms count the solutions; three equations linear in each of three unknowns have 6, and four that are linear
/// in each of two pairs of unknowns have 6 (multihomogeneous Bezout numbers).
pub(super) fn groups(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let (groups, degrees, count): (&[&[usize]], Vec<Vec<usize>>, usize) = match draw.between(0, 2) {
        0 => {
            let [p, q, r, s] = [0; 4].map(|_| draw.between(1, 3));
            (&[&[0], &[1]], vec![vec![p, q], vec![r, s]], p * s + q * r)
        }
        1 => (&[&[0], &[1], &[2]], vec![vec![1; 3]; 3], 6),
        _ => (&[&[0, 1], &[2, 3]], vec![vec![1; 2]; 4], 6),
    };
    let unknowns = degrees.len();
    let names = plain(unknowns);
    let shares = draw.shares(parameters, unknowns);
    let equation = |(degrees, share): (&Vec<usize>, Vec<&str>)| {
        let mut all = vec![String::new()];
        for (group, &degree) in groups.iter().zip(degrees) {
            let of: Vec<String> = group.iter().map(|&k| names[k].clone()).collect();
            let own: Vec<String> = (0..=degree).flat_map(|d| monomials(&of, d)).collect();
            all = all.iter().flat_map(|a| own.iter().map(move |b| product(&[a, b]))).collect();
        }
        sum(all.iter().map(|monomial| draw.term(monomial))) + &draw.moved(&share, &all)
    };
    let equations = degrees.iter().zip(shares).map(equation).collect();
    Known::new(unknowns, parameters.len(), equations, count)
}

/// Oscillators. Three that are coupled have 6 states (Baillieul and Byrnes 1982), without frequencies too: four in which
/// each is in phase with the first or opposite, and two more. Duffing's, forced, has 3: the power s = |A|^2 solves
/// a cubic equation, and the amplitude A follows from it. The parametron has 5: at rest, and two cycles of either
/// phase.
pub(super) fn oscillators(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let kind = draw.between(0, 3);
    let count = [5, 3, 4, 4][kind];
    // Parameters in the place of some of the numbers.
    let mut numbers: Vec<String> = draw.different(count).iter().map(|c| format!("({c})")).collect();
    let first = draw.between(0, count - parameters.len());
    numbers[first..].iter_mut().zip(parameters).for_each(|(number, &p)| *number = p.to_owned());
    let n = |k: usize| numbers.get(k).map_or("0", String::as_str);
    let (unknowns, equations, count) = match kind {
        0 | 1 => {
            let equations = vec![
                format!("{}*y + {}*(z*y - x*w) + {}", n(0), n(1), n(3)),
                format!("{}*w + {}*(x*w - z*y) + {}", n(2), n(1), n(4)),
                "x^2 + y^2 - 1".to_owned(),
                "z^2 + w^2 - 1".to_owned(),
            ];
            (4, equations, 6)
        }
        2 => {
            let equations = vec![
                format!("{}*x*(x^2 + y^2) + {}*x - {}*y - {}", n(0), n(1), n(2), n(3)),
                format!("{}*y*(x^2 + y^2) + {}*y + {}*x", n(0), n(1), n(2)),
            ];
            (2, equations, 3)
        }
        _ => {
            let equations = vec![
                format!("{}*x*(x^2 + y^2) + ({} - {})*x + {}*y", n(0), n(1), n(2), n(3)),
                format!("{}*y*(x^2 + y^2) + ({} + {})*y - {}*x", n(0), n(1), n(2), n(3)),
            ];
            (2, equations, 5)
        }
    };
    Known::new(unknowns, parameters.len(), equations, count)
}

/// Points of a curve or surface at which the distance from a given point is stationary: d^2 for a plane curve of
/// degree d, 6 for a quadric in space (Draisma, Horobet, Ottaviani, Sturmfels, Thomas 2016, the Euclidean distance degree).
pub(super) fn nearest(draw: &mut Draw) -> Known {
    let (space, degree, count) = draw.one(&[(2, 2, 4), (2, 3, 9), (3, 2, 6)]);
    let parameters = draw.parameters(space);
    let names = plain(space + 1);
    let (points, multiplier) = (&names[..space], &names[space]);
    let all: Vec<Vec<usize>> = exponents(space, degree);
    let coefficients: Vec<i64> = all.iter().map(|_| draw.coefficient()).collect();
    let text = |exponents: &[usize]| -> String {
        let powers: Vec<String> = exponents.iter().zip(points).map(|(&e, name)| power(name, e)).collect();
        product(&powers.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let curve = sum(all.iter().zip(&coefficients).map(|(e, &c)| signed(c, &text(e))));
    let mut equations = vec![curve];
    for k in 0..space {
        let derived = all.iter().zip(&coefficients).filter(|(e, _)| e[k] > 0).map(|(e, &c)| {
            let mut lower = e.clone();
            lower[k] -= 1;
            signed(c * e[k] as i64, &text(&lower))
        });
        let derivative = sum(derived);
        let given = parameters.get(k).map_or_else(|| draw.coefficient().to_string(), |&p| p.to_owned());
        equations.push(format!("{} - ({given}) + {multiplier}*({derivative})", points[k]));
    }
    Known::new(space + 1, parameters.len(), equations, count)
}

/// The exponents of all monomials up to a degree.
fn exponents(unknowns: usize, degree: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..unknowns {
        let longer = |e: &Vec<usize>| {
            let left = degree - e.iter().sum::<usize>();
            let e = e.clone();
            (0..=left).map(move |k| [e.as_slice(), &[k]].concat())
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

//! One and two unknowns: few solutions, multiple and badly conditioned ones.

use super::case::Case;
use super::draw::{Draw, Form, apart, meet, meets, show};

/// Points with different first coordinates, none of them zero, in four equations; some second
/// coordinates are zero.
pub(super) fn overdetermined(draw: &mut Draw) -> Case {
    let mut firsts: Vec<i128> = Vec::new();
    while firsts.len() < 3 {
        let a = draw.nonzero();
        if !firsts.contains(&a) {
            firsts.push(a);
        }
    }
    let seconds = [0, draw.between(-2, 2), draw.between(-5, 5)];
    // Lagrange's polynomial through them.
    let mut through = String::from("0");
    for (k, a) in firsts.iter().enumerate() {
        let others: Vec<i128> = firsts.iter().copied().filter(|b| b != a).collect();
        let below: i128 = others.iter().map(|b| a - b).product();
        through += &format!("+(({})/({below}))*(x-({}))*(x-({}))", seconds[k], others[0], others[1]);
    }
    let product: Vec<String> = firsts.iter().map(|a| format!("(x-({a}))")).collect();
    let (f, c) = (format!("(y-({through}))"), draw.between(1, 5));
    let last = format!("{f}*(x-3*y+({}))", draw.between(-3, 3));
    let points: Vec<Vec<f64>> = firsts.iter().zip(seconds).map(|(&a, b)| vec![a as f64, b as f64]).collect();
    Case::new(&[product.join("*"), format!("{f}*(y+{c}.5)"), format!("{f}*x"), last])
        .in_unknowns(2)
        .with_simple(&points)
}

/// `u^a, u v, v^b`: the functionals are 1, a - 1 powers of one kind and b - 1 of the other.
pub(super) fn overdetermined_multiple(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.cross();
    let (a, b) = (draw.between(2, 3), draw.between(2, 4));
    let (u, v) = (show(&u), show(&v));
    Case::new(&[format!("{u}^{a}"), format!("{u}*{v}"), format!("{v}^{b}")])
        .in_unknowns(2)
        .with(&at, (a + b - 1) as usize)
}

/// `u + c v^2`, and `v^m` with a multiple of it: a smooth curve that meets another in one point,
/// `m`-fold.
pub(super) fn corank_one(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.cross();
    let (m, c, k) = (draw.between(3, 6), draw.nonzero(), draw.between(-3, 3));
    let (u, v) = (show(&u), show(&v));
    let curve = format!("{u}+({c})*{v}^2");
    let second = format!("{v}^{m}+({curve})*(x+2*y+({k}))");
    Case::new(&[curve, second]).with(&at, m as usize)
}

/// `u^a; v^b`, a product of multiplicities.
pub(super) fn corank_two(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.cross();
    let (a, b) = (draw.between(2, 3), draw.between(2, 3));
    let c = draw.nonzero();
    let (u, v) = (show(&u), show(&v));
    // The second without the multiple of the first.
    Case::new(&[format!("{u}^{a}"), format!("{v}^{b}+({c})*{u}^{a}")]).with(&at, (a * b) as usize)
}

/// `(u + c v^2) l` and `v^m (u + 4 c)`: two points of multiplicity `m`, three simple ones.
pub(super) fn multiple_beside_regular(draw: &mut Draw) -> Case {
    loop {
        let (u, v, _) = draw.cross();
        let (m, c, l) = (draw.between(2, 5), draw.nonzero(), draw.line());
        let moved = |line: &Form, by: i128| vec![line[0], line[1], line[2] + by];
        let (far, above, below) = (moved(&u, 4 * c), moved(&v, 2), moved(&v, -2));
        // Where `u = -4 c`, `v` is 2 or -2.
        let points = [(&u, &v), (&l, &v), (&far, &above), (&far, &below), (&l, &far)].map(|(a, b)| meet(&[a, b]));
        let Some(points) = points.into_iter().collect::<Option<Vec<_>>>().filter(|p| apart(p)) else { continue };
        let (u, v, far, l) = (show(&u), show(&v), show(&far), show(&l));
        return Case::new(&[format!("({u}+({c})*{v}^2)*{l}"), format!("{v}^{m}*{far}")])
            .with(&points[0], m as usize)
            .with(&points[1], m as usize)
            .with_simple(&points[2..]);
    }
}

/// `l1 l2; c l1 l2 + e l3 l4`
pub(super) fn ill_conditioned(draw: &mut Draw) -> Case {
    loop {
        let lines: [Form; 4] = std::array::from_fn(|_| draw.line());
        let [a, b, c, d] = lines.each_ref().map(|line| show(line));
        let (first, second) = lines.split_at(2);
        let Some(points) = meets(&[first.to_vec(), second.to_vec()]).filter(|p| apart(p)) else { continue };
        let (factor, k) = (draw.nonzero(), draw.between(6, 13));
        return Case::new(&[format!("{a}*{b}"), format!("({factor})*{a}*{b}+1E-{k}*{c}*{d}")]).with_simple(&points);
    }
}

/// Simple and double integer roots, of degree up to 18.
pub(super) fn one_unknown(draw: &mut Draw) -> Case {
    let mut roots: Vec<(i128, usize)> = Vec::new();
    for _ in 0..draw.between(4, 9) {
        let root = draw.between(-12, 12);
        let multiplicity = draw.between(1, 2) as usize;
        if roots.iter().all(|(r, _)| *r != root) {
            roots.push((root, multiplicity));
        }
    }
    let factors: Vec<String> = roots.iter().map(|(root, m)| format!("(x-({root}))^{m}")).collect();
    roots.iter().fold(Case::new(&[factors.join("*")]), |case, &(root, m)| case.with(&[root as f64], m))
}

/// `l1 l2; l3 l4` with coefficients up to 1e6 or up to 1e12.
pub(super) fn large_integers(draw: &mut Draw) -> Case {
    let largest = 10i128.pow(draw.between(6, 12) as u32);
    loop {
        let [a, b, c, d]: [Form; 4] = std::array::from_fn(|_| (0..3).map(|_| draw.nonzero_to(largest)).collect());
        let equations = [[&a, &b], [&c, &d]].map(|[a, b]| format!("{}*{}", show(a), show(b)));
        let Some(points) = meets(&[vec![a, b], vec![c, d]]) else { continue };
        if apart(&points) && points.iter().flatten().all(|c| c.abs() < 100.0) {
            return Case::new(&equations).with_simple(&points);
        }
    }
}

/// Fewer solutions than paths: parallel lines in both equations; `u v = c` and lines `u = a`,
/// `v = b`; `u v^2 = c` and lines `v = b`.
pub(super) fn infinite(draw: &mut Draw) -> Case {
    let frame = draw.frame(2);
    let texts = frame.texts();
    let (u, v) = (&texts[0], &texts[1]);
    let lines = |u: &String, at: &[i128]| at.iter().map(|a| format!("({u}-({a}))")).collect::<Vec<_>>().join("*");
    let point = |u: f64, v: f64| frame.real_point(&[u, v]);
    let (few, more) = (draw.between(1, 3) as usize, draw.between(1, 3) as usize);
    let (low, high) = (draw.different(few, -6, -1), draw.different(more, 1, 6));
    let c = draw.nonzero();
    match draw.between(0, 2) {
        0 => {
            let points: Vec<Vec<f64>> = low.iter().map(|&a| point(a as f64, c as f64)).collect();
            Case::new(&[lines(u, &low), format!("{}*({v}-({c}))", lines(u, &high))]).with_simple(&points)
        }
        1 => {
            // Where `u` is negative and `v` positive, `u v = c` is a positive number.
            let c = c.abs();
            let first = low.iter().map(|&a| point(a as f64, c as f64 / a as f64));
            let second = high.iter().map(|&b| point(c as f64 / b as f64, b as f64));
            let points: Vec<Vec<f64>> = first.chain(second).collect();
            Case::new(&[format!("{u}*{v}-{c}"), format!("{}*{}", lines(u, &low), lines(v, &high))]).with_simple(&points)
        }
        _ => {
            let at = [low, high].concat();
            let points: Vec<Vec<f64>> = at.iter().map(|&b| point(c as f64 / (b * b) as f64, b as f64)).collect();
            Case::new(&[format!("{u}*{v}^2-({c})"), lines(v, &at)]).with_simple(&points)
        }
    }
}

//! Families of systems by their generators, in PHCpack's format. `cargo xtask compare` uses this
//! file too.

pub(crate) fn system(equations: Vec<String>) -> String {
    format!("{}\n{};\n", equations.len(), equations.join(";\n"))
}

/// Cyclic n-roots (Bjorck & Froberg 1991).
pub(crate) fn cyclic(n: usize) -> String {
    let product = |j: usize, m: usize| (j..=j + m).map(|k| format!("x{}", k % n)).collect::<Vec<_>>().join("*");
    let sums = (0..n - 1).map(|m| (0..n).map(|j| product(j, m)).collect::<Vec<_>>().join("+"));
    system(sums.chain([format!("{}-1", product(0, n - 1))]).collect())
}

/// Katsura's magnetism problem, `n + 1` unknowns.
pub(crate) fn katsura(n: usize) -> String {
    let convolution = |m: i64| {
        let terms = (-(n as i64)..=n as i64).filter_map(|l| {
            let (a, b) = (l.unsigned_abs() as usize, (m - l).unsigned_abs() as usize);
            (b <= n).then(|| format!("u{a}*u{b}"))
        });
        format!("{}-u{m}", terms.collect::<Vec<_>>().join("+"))
    };
    let sum = (1..=n).map(|l| format!("+2*u{l}")).collect::<String>();
    system((0..n as i64).map(convolution).chain([format!("u0{sum}-1")]).collect())
}

/// Noonburg's neural network.
pub(crate) fn noon(n: usize) -> String {
    let squares = |i: usize| (0..n).filter(|&j| j != i).map(|j| format!("x{j}^2")).collect::<Vec<_>>().join("+");
    system((0..n).map(|i| format!("x{i}*({})-1.1*x{i}+1", squares(i))).collect())
}

/// The economics problem.
pub(crate) fn eco(n: usize) -> String {
    let equation = |k: usize| {
        let products: String = (1..n - k).map(|i| format!("+x{i}*x{}", i + k)).collect();
        format!("(x{k}{products})*x{n}-{k}")
    };
    let sum = (1..n).map(|i| format!("x{i}")).collect::<Vec<_>>().join("+");
    system((1..n).map(equation).chain([format!("{sum}+1")]).collect())
}

/// Reimer's system.
pub(crate) fn reimer(n: usize) -> String {
    let sign = |i: usize| if i.is_multiple_of(2) { '+' } else { '-' };
    let equation = |k: usize| {
        let sum: String = (0..n).map(|i| format!("{}x{i}^{}", sign(i), k + 1)).collect();
        format!("-1/2{sum}")
    };
    system((1..=n).map(equation).collect())
}

/// Gaussian quadrature with `n` nodes and weights on [-1, 1]: moments 0 to `2 n - 1`.
#[allow(dead_code, reason = "used by the comparison only")]
pub(crate) fn gaukwa(n: usize) -> String {
    let moment = |k: usize| if k.is_multiple_of(2) { format!("-2/{}", k + 1) } else { "-0.1".to_owned() };
    let equation = |k: usize| {
        let power = |i: usize| if k == 0 { format!("w{i}") } else { format!("w{i}*x{i}^{k}") };
        format!("{}{}", (1..=n).map(power).collect::<Vec<_>>().join("+"), moment(k))
    };
    system((0..2 * n).map(equation).collect())
}

/// Planes that touch a space curve of degree six in three points: the points `x`, `y`, `z` of contact and the plane `h x = 1`.
/// The curve is that of `x3 = x1 x2` on a cubic surface, whose coefficients are integers; with rounded ones the derivatives
/// of the cubic would be others than those in the equations. The cubic of a general curve has 120 such planes.
#[allow(dead_code, reason = "used by the comparison only")]
pub(crate) fn tritangents() -> String {
    let exponents: Vec<[usize; 3]> =
        (0..64).map(|k| [k / 16, k / 4 % 4, k % 4]).filter(|e| e.iter().sum::<usize>() <= 3).collect();
    let coefficients = |k: usize| [(k * k * 7 + 3 * k + 5) % 19, (k * k * 5 + 11 * k + 2) % 17].map(|c| c as i64);
    // The cubic at a point, or its derivative by one coordinate.
    let cubic = |x: &[String; 3], by: Option<usize>| {
        let terms = exponents.iter().enumerate().filter_map(|(k, exponents)| {
            let ([re, im], mut e) = (coefficients(k), *exponents);
            let factor = by.map_or(1, |j| e[j]) as i64;
            by.filter(|&j| e[j] > 0).into_iter().for_each(|j| e[j] -= 1);
            let powers: String = (0..3).filter(|&j| e[j] > 0).map(|j| format!("*{}^{}", x[j], e[j])).collect();
            (factor > 0).then(|| format!("({}{:+}*i){powers}", factor * (re - 9), factor * (im - 8)))
        });
        terms.collect::<Vec<_>>().join("+")
    };
    let at = |point: &str| {
        let x = ["1", "2", "3"].map(|j| format!("{point}{j}"));
        let [c1, c2, c3] = [0, 1, 2].map(|j| format!("({})", cubic(&x, Some(j))));
        let [x1, x2, x3] = &x;
        [
            format!("h1*{x1}+h2*{x2}+h3*{x3}-1"),
            format!("{x3}-{x1}*{x2}"),
            cubic(&x, None),
            format!("h1*({c2}+{x1}*{c3})-h2*({x2}*{c3}+{c1})+h3*({x2}*{c2}-{x1}*{c1})"),
        ]
    };
    system(["x", "y", "z"].into_iter().flat_map(at).collect())
}

/// Conics `a x^2 + b x y + c y^2 + d x + e y + 1` that touch five given ones, as a family: the conic and the points of contact.
#[allow(dead_code, reason = "used by the comparison only")]
pub(crate) fn tangent_conics() -> String {
    let sought = ["a", "b", "c", "d", "e", "1"].map(str::to_owned);
    let value = |c: &[String; 6], x: &str, y: &str| {
        format!("{}*{x}^2+{}*{x}*{y}+{}*{y}^2+{}*{x}+{}*{y}+{}", c[0], c[1], c[2], c[3], c[4], c[5])
    };
    let slopes = |c: &[String; 6], x: &str, y: &str| {
        [format!("(2*{}*{x}+{}*{y}+{})", c[0], c[1], c[3]), format!("({}*{x}+2*{}*{y}+{})", c[1], c[2], c[4])]
    };
    let (mut unknowns, mut parameters, mut equations) = (sought[..5].to_vec(), Vec::new(), Vec::new());
    for k in 1..=5 {
        let [x, y] = ["x", "y"].map(|name| format!("{name}{k}"));
        let given: [String; 6] = std::array::from_fn(|j| format!("g{k}{j}"));
        let ([f, g], [u, v]) = (slopes(&sought, &x, &y), slopes(&given, &x, &y));
        equations.extend([value(&sought, &x, &y), value(&given, &x, &y), format!("{f}*{v}-{g}*{u}")]);
        unknowns.extend([x, y]);
        parameters.extend(given);
    }
    let list = |words: &[String]| words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(", ");
    let (unknowns, parameters, equations) = (list(&unknowns), list(&parameters), list(&equations));
    format!(
        "name = 'conics'\nroots = 3264\nunknowns = [{unknowns}]\nparameters = [{parameters}]\nequations = [{equations}]\n"
    )
}

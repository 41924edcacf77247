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

//! The systems that are measured, each from its formula.

use poly::{Expr, System, parse};

/// A system that is measured.
pub struct Case {
    /// Name in tables.
    pub name: &'static str,
    /// Module of its generated code.
    pub module: &'static str,
    /// Type of its generated code.
    pub type_name: &'static str,
    /// The system.
    pub system: System,
}

/// All systems that are measured.
///
/// # Panics
/// Never: the formulas are fixed.
pub fn cases() -> Vec<Case> {
    let case = |name, module, type_name, system| Case { name, module, type_name, system };
    let family = |text: &str| parse::family(text).expect("a family that parses").system;
    vec![
        case("cyclic-7", "cyclic_7", "Cyclic7", cyclic(7)),
        case("katsura-8", "katsura_8", "Katsura8", katsura(8)),
        case("noon-5", "noon_5", "Noon5", noon(5)),
        case("6r/3s", "s6r_3s", "S6r3s", family(&six_receivers())),
        case("4r/5s", "s4r_5s", "S4r5s", family(&five_transmitters())),
        case("pencils", "pencils", "Pencils", pencils()),
    ]
}

/// Cyclic n-roots: sums of products of neighbours, and the product of all less one.
fn cyclic(n: usize) -> System {
    System::build(|s| {
        let x: Vec<Expr<'_>> = (0..n).map(|j| s.variable(&format!("z{j}"))).collect();
        let run = |length: usize, first: usize| s.product((0..length).map(|j| x[(first + j) % n]));
        let mut equations: Vec<Expr<'_>> = (1..n).map(|k| s.sum((0..n).map(|first| run(k, first)))).collect();
        equations.push(run(n, 0) - 1);
        equations
    })
    .expect("names are in order")
}

/// Magnetism, n + 1 unknowns: convolutions of a symmetric sequence, and its sum.
fn katsura(n: usize) -> System {
    System::build(|s| {
        let u: Vec<Expr<'_>> = (0..=n).map(|j| s.variable(&format!("u{j}"))).collect();
        let mut equations: Vec<Expr<'_>> = (0..n)
            .map(|m| {
                let products = (0..=2 * n).filter_map(|shifted| {
                    // The index runs from -n to n.
                    let (j, k) = (shifted.abs_diff(n), shifted.abs_diff(m + n));
                    (k <= n).then(|| u[j] * u[k])
                });
                s.sum(products) - u[m]
            })
            .collect();
        equations.push(u[0] + 2 * s.sum(u[1..].iter().copied()) - 1);
        equations
    })
    .expect("names are in order")
}

/// Neural network (Noonburg): `x_i * sum of the other squares - 1.1 x_i + 1`.
fn noon(n: usize) -> System {
    System::build(|s| {
        let x: Vec<Expr<'_>> = (0..n).map(|j| s.variable(&format!("x{j}"))).collect();
        let tenth = s.constant(11) / 10;
        let others = |i: usize| s.sum((0..n).filter(|&j| j != i).map(|j| x[j].powi(2)));
        (0..n).map(|i| x[i] * others(i) - tenth * x[i] + 1).collect()
    })
    .expect("names are in order")
}

/// Three determinants `det(A + x B + y C + z D)` of 4 x 4 matrices of parameters, not expanded.
fn pencils() -> System {
    System::build(|s| {
        let unknowns = [s.constant(1), s.variable("x"), s.variable("y"), s.variable("z")];
        (0..3)
            .map(|k| {
                let entry =
                    |i: usize, j: usize| s.sum((0..4).map(|u| s.parameter(&format!("m{k}{u}{i}{j}")) * unknowns[u]));
                let matrix: Vec<Vec<Expr<'_>>> = (0..4).map(|i| (0..4).map(|j| entry(i, j)).collect()).collect();
                determinant(&matrix, &[0, 1, 2, 3])
            })
            .collect()
    })
    .expect("names are in order")
}

/// Expansion along the last of the first `columns.len()` rows; equal minors are one node.
fn determinant<'a>(matrix: &[Vec<Expr<'a>>], columns: &[usize]) -> Expr<'a> {
    let row = columns.len() - 1;
    if row == 0 {
        return matrix[0][columns[0]];
    }
    let term = |k: usize| {
        let rest: Vec<usize> = columns.iter().copied().filter(|&c| c != columns[k]).collect();
        let product = matrix[row][columns[k]] * determinant(matrix, &rest);
        if (row + k).is_multiple_of(2) { product } else { -product }
    };
    (1..columns.len()).fold(term(0), |sum, k| sum + term(k))
}

/// Six receivers, three transmitters: the dual formulation in offsets `o`, `H` and `b`, with
/// `f_1j = 0`.
///
/// Parameters are `f_ij` for receivers 2 to 6, pseudoranges less those of receiver 1.
fn six_receivers() -> String {
    let mut equations = vec![
        "(H22*b1^2 - 2*H12*b1*b2 + H11*b2^2) - o1^2*(H11*H22 - H12^2)".to_owned(),
        "H22/4 - (H22*b1 - H12*b2) - (o2^2 - o1^2)*(H11*H22 - H12^2)".to_owned(),
        "H11/4 - (H11*b2 - H12*b1) - (o3^2 - o1^2)*(H11*H22 - H12^2)".to_owned(),
    ];
    let mut parameters = Vec::new();
    for i in 2..=6 {
        parameters.extend((1..=3).map(|j| format!("f{i}{j}")));
        let q = |j: usize| format!("(f{i}{j}^2 - 2*o{j}*f{i}{j})");
        let (u, v) = (format!("({} - {})", q(2), q(1)), format!("({} - {})", q(3), q(1)));
        equations.push(format!("(H11*{u} + 2*H12*{v})*{u} + H22*{v}^2 - 2*(b1*{u} + b2*{v}) - {}", q(1)));
    }
    toml("6r/3s", &["o1", "o2", "o3", "H11", "H12", "H22", "b1", "b2"], &parameters, &equations, 180)
}

/// Four receivers, five transmitters, in the affine coordinates of receiver 4 and the Gram matrix
/// of 2 and 3.
///
/// Parameters are pseudoranges of receivers 2 to 4 less those of receiver 1.
fn five_transmitters() -> String {
    let mut parameters = Vec::new();
    let mut equations = Vec::new();
    for j in 1..=5 {
        let [a, b, c] = ["a", "b", "c"].map(|name| format!("{name}{j}"));
        let link = "(alpha^2*E + 2*alpha*beta*F + beta^2*K - alpha*E - beta*K)";
        let n = format!("(alpha*{a}^2 + beta*{b}^2 - {c}^2 + {link})");
        let d = format!("(alpha*{a} + beta*{b} - {c})");
        let u = format!("((E - {a}^2)*{d} + {a}*{n})");
        let v = format!("((K - {b}^2)*{d} + {b}*{n})");
        equations.push(format!("K*{u}^2 - 2*F*{u}*{v} + E*{v}^2 - (E*K - F^2)*{n}^2"));
        parameters.extend([a, b, c]);
    }
    toml("4r/5s", &["alpha", "beta", "E", "F", "K"], &parameters, &equations, 344)
}

fn toml(name: &str, unknowns: &[&str], parameters: &[String], equations: &[String], roots: usize) -> String {
    let list = |items: &[String]| items.iter().map(|i| format!("    \"{i}\",\n")).collect::<String>();
    format!(
        "name = \"{name}\"\nunknowns = {unknowns:?}\nparameters = [\n{}]\nequations = [\n{}]\nroots = {roots}\n",
        list(parameters),
        list(equations)
    )
}

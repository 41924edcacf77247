//! Counts of enumerative geometry as systems of equations: curves that touch others.

use super::generators::system;

/// Planes that touch a space curve of degree six in three points: the points `x`, `y`, `z` of contact and the plane `h x = 1`.
/// The curve is that of `x3 = x1 x2` on a cubic surface, whose coefficients are integers; with rounded ones the derivatives
/// of the cubic would be others than those in the equations. The cubic of a general curve has 120 such planes.
pub(super) fn tritangents() -> String {
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
pub(super) fn tangent_conics() -> String {
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

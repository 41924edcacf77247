//! Programs over exact rationals against expanded polynomials: values, Jacobian and Taylor
//! coefficients agree exactly.

use num_rational::BigRational;
use num_traits::Zero;
use poly::{Evaluate, Exact, ExpandLimits, Isa, Polynomial, Rational, parse};

const FAMILY: &str = r#"
    name = "mixed"
    unknowns = ["x", "y", "z"]
    parameters = ["a", "b"]
    equations = ["(x + a*y)^3 - (y - z)*(x*z - b)/3 + 0.125",
                 "((x - y)*(y - z)*(z - a) + b*x)^2 - x^4*y",
                 "x*y*z*a*b - (a - x)^2*(b + z^2)"]
"#;

fn rational(p: i64, q: i64) -> Exact {
    Exact::new(BigRational::new(p.into(), q.into()), BigRational::zero())
}

fn exact(values: &[Rational]) -> Vec<Exact> {
    values.iter().map(|v| v.0.clone().expect("no division by zero")).collect()
}

/// The points that are tried: unknowns x, y, z, then parameters a, b.
fn points() -> Vec<Vec<Exact>> {
    (0..20i64).map(|k| (0..5i64).map(|j| rational((k * 7 + j * 11) % 13 - 6, (k + 3 * j) % 5 + 1)).collect()).collect()
}

#[test]
fn values_and_jacobian_are_those_of_the_expanded_polynomials() {
    let family = parse::family(FAMILY).unwrap();
    let system = family.system.compile().unwrap();
    let expanded = family.system.expand(&ExpandLimits::default()).unwrap();
    let mut memory = system.memory::<Rational>(Isa::Portable);
    for point in points() {
        let wrapped: Vec<Rational> = point.iter().cloned().map(Rational::new).collect();
        let mut values = vec![Rational::integer(0); 3];
        let mut jacobian = vec![Rational::integer(0); 9];
        system.jacobian(&mut memory, &wrapped[..3], &wrapped[3..], &mut values, &mut jacobian);
        let (values, jacobian) = (exact(&values), exact(&jacobian));
        for (i, polynomial) in expanded.iter().enumerate() {
            assert_eq!(values[i], polynomial.evaluate(&point).unwrap());
            for j in 0..3 {
                assert_eq!(jacobian[j * 3 + i], polynomial.derivative(j).evaluate(&point).unwrap());
            }
        }
    }
}

#[test]
fn taylor_coefficients_are_those_of_the_substituted_polynomials() {
    let family = parse::family(FAMILY).unwrap();
    let system = family.system.compile().unwrap();
    let expanded = family.system.expand(&ExpandLimits::default()).unwrap();
    let mut memory = system.memory::<Rational>(Isa::Portable);
    let all = points();
    for k in 0..10 {
        // Coefficients of orders 0 to 3 of the five quantities, from four of the points.
        let series: Vec<&Vec<Exact>> = (0..4).map(|order| &all[(k + 3 * order) % all.len()]).collect();
        for order in 1..=3 {
            let x: Vec<Rational> =
                series[..order].iter().flat_map(|c| c[..3].iter().cloned().map(Rational::new)).collect();
            let p: Vec<Rational> =
                series[..=order].iter().flat_map(|c| c[3..].iter().cloned().map(Rational::new)).collect();
            let mut out = vec![Rational::integer(0); 3];
            system.taylor(&mut memory, order, &x, &p, &mut out);
            let out = exact(&out);
            // The path as polynomials in t, put in for the unknowns (whose coefficient `order` is
            // zero) and parameters.
            let path = |j: usize| {
                let last = if j < 3 { order } else { order + 1 };
                let t = Polynomial::<Exact>::variable(1, 0);
                (0..last).fold(Polynomial::zero(1), |sum, e| {
                    let term = t.pow(e as u32).scaled(&series[e][j]);
                    &sum + &term
                })
            };
            for (i, polynomial) in expanded.iter().enumerate() {
                let mut substituted = Polynomial::<Exact>::zero(1);
                for (monomial, coefficient) in polynomial.terms() {
                    let mut term = Polynomial::constant(1, coefficient.clone());
                    for (j, &e) in monomial.exponents().iter().enumerate() {
                        term = &term * &path(j).pow(e as u32);
                    }
                    substituted = &substituted + &term;
                }
                let expected = substituted.terms().iter().find(|(m, _)| m.exponents()[0] == order as i32);
                assert_eq!(
                    out[i],
                    expected.map_or_else(Exact::zero, |(_, c)| c.clone()),
                    "order {order}, equation {i}"
                );
            }
        }
    }
}

/// A sum of multiples of a few formulas, which repeat, with parentheses and signs, and its value
/// term by term.
fn repeating_sum(seed: i64, point: &[Exact]) -> (String, Exact) {
    let mut state = seed;
    let mut next = |below: i64| {
        state = (state * 48_271 + 11) % 2_147_483_647;
        state % below
    };
    let value_of = |name: &str| match name {
        "x" => point[0].clone(),
        "x*y" => point[0].clone() * &point[1],
        "(y + 2*z)" => point[1].clone() + rational(2, 1) * &point[2],
        "a*z" => point[3].clone() * &point[2],
        _ => rational(1, 1),
    };
    let (mut text, mut value) = ("0".to_owned(), Exact::zero());
    for _ in 0..12 {
        let name = ["x", "x*y", "(y + 2*z)", "a*z", "1"][next(5) as usize];
        let (p, q) = (next(7) - 3, next(4) + 1);
        let term = rational(p, q) * value_of(name);
        match next(3) {
            0 => {
                text = format!("{text} + ({p}/{q})*{name}");
                value += term;
            }
            1 => {
                text = format!("({text}) - {name}*({p}/{q})");
                value -= term;
            }
            _ => {
                text = format!("({p}/{q})*{name} - ({text})");
                value = term - value;
            }
        }
    }
    (text, value)
}

#[test]
fn collected_sums_keep_their_values_and_have_no_term_twice() {
    for (seed, point) in (1..).zip(points()) {
        let (text, value) = repeating_sum(seed, &point);
        let family =
            format!("name = 'sum'\nunknowns = ['x', 'y', 'z']\nparameters = ['a', 'b']\nequations = ['{text}']");
        let system = parse::family(&family).unwrap().system.compile().unwrap();
        let wrapped: Vec<Rational> = point.iter().cloned().map(Rational::new).collect();
        let mut values = [Rational::integer(0)];
        system.values(&mut system.memory::<Rational>(Isa::Portable), &wrapped[..3], &wrapped[3..], &mut values);
        assert_eq!(exact(&values), [value], "{text}");
        // Two products and a sum inside terms; then at most one operation a term and one more for
        // the first.
        assert!(system.program().value_operations() <= 3 + 5, "{text}: {}", system.program().value_operations());
    }
}

//! The interpreter against Cauchy's formula: derivatives and Taylor coefficients from values on a
//! circle.

use crate::{ComplexDd, Evaluate, Isa, Lane, Lanes8, Scalar, Singles16, System, parse};
use num_complex::Complex64;
use proptest::prelude::*;

type C = Complex64;

const FAMILIES: [&str; 4] = [
    r#"name = "conics"
       unknowns = ["x", "y"]
       parameters = ["a", "b"]
       equations = ["a*x^2 + 3*x*y - 2.5*y^2 + (1/3)*b", "(x + a*y)^3 - b^2*x + 7", "a - b^2"]"#,
    r#"name = "quotients"
       unknowns = ["x", "y", "z"]
       parameters = ["p"]
       equations = ["x/(y + 2*p) - z^-2", "(x*y - z)/(x + 1) + p/(z + 3)^3", "2*i*x - y*z/(1 - p)"]"#,
    r#"name = "cyclic"
       unknowns = ["a", "b", "c", "d"]
       equations = ["a + b + c + d", "a*b + b*c + c*d + d*a", "a*b*c + b*c*d + c*d*a + d*a*b", "a*b*c*d - 1"]"#,
    r#"name = "powers"
       unknowns = ["x", "y"]
       parameters = ["q"]
       equations = ["x^7 - x^5*y^2 + q*y^4", "x", "3", "-x^3 + (x - y)*(x + y) - 5*(x*y*q)", "-q*(x*y) - x*q*q"]"#,
];

fn families() -> Vec<System> {
    FAMILIES.iter().map(|text| parse::family(text).unwrap().system).collect()
}

fn values(f: &impl Evaluate, x: &[C], p: &[C]) -> Vec<C> {
    let mut out = vec![C::new(f64::NAN, 0.0); f.equations()];
    f.values(&mut f.memory(Isa::Portable), x, p, &mut out);
    out
}

/// Taylor coefficient `order` at zero of each component, from 64 values on a circle.
fn cauchy(order: usize, function: impl Fn(C) -> Vec<C>) -> Vec<C> {
    const POINTS: usize = 64;
    const RADIUS: f64 = 0.125;
    let angle = |j: usize| C::from_polar(1.0, std::f64::consts::TAU * j as f64 / POINTS as f64);
    let samples: Vec<Vec<C>> = (0..POINTS).map(|j| function(angle(j) * RADIUS)).collect();
    let scale = RADIUS.powi(order as i32) * POINTS as f64;
    (0..samples[0].len())
        .map(|i| (0..POINTS).map(|j| samples[j][i] * angle(j * order % POINTS).conj()).sum::<C>() / scale)
        .collect()
}

fn close(a: &[C], b: &[C]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).norm() <= 1e-8 * (1.0 + a.norm()))
}

fn series(coefficients: &[C], width: usize, t: C) -> Vec<C> {
    let mut value = vec![C::ZERO; width];
    for chunk in coefficients.chunks(width.max(1)).rev() {
        for (v, c) in value.iter_mut().zip(chunk) {
            *v = *v * t + c;
        }
    }
    value
}

fn numbers(count: usize) -> impl Strategy<Value = Vec<C>> {
    proptest::collection::vec((-1.0..1.0f64, 0.5..1.5f64).prop_map(|(re, im)| C::new(re, im)), count)
}

#[test]
fn values_of_a_formula_written_by_hand() {
    let system = &families()[0];
    let f = system.compile().unwrap();
    let (x, y) = (C::new(0.3, -0.7), C::new(1.1, 0.2));
    let (a, b) = (C::new(-0.4, 0.9), C::new(0.6, 0.1));
    let expected = [a * x * x + x * y * 3.0 - y * y * 2.5 + b / 3.0, (x + a * y).powi(3) - b * b * x + 7.0, a - b * b];
    assert!(close(&values(&f, &[x, y], &[a, b]), &expected));
}

/// Orders asked for in turn and how many orders of the parameters are given: a curve, then a
/// straight line.
const TURNS: [(usize, usize); 6] = [(1, 2), (2, 3), (3, 4), (1, 2), (2, 2), (3, 2)];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn jacobian_is_the_derivative(x in numbers(4), p in numbers(2)) {
        for system in families() {
            let f = system.compile().unwrap();
            let (m, n, k) = (f.equations(), f.variables(), f.parameters());
            let (x, p) = (&x[..n], &p[..k]);
            let mut memory = f.memory::<C>(Isa::Portable);
            let mut v = vec![C::new(f64::NAN, 0.0); m];
            let mut jacobian = vec![C::new(f64::NAN, 0.0); m * n];
            f.jacobian(&mut memory, x, p, &mut v, &mut jacobian);
            prop_assert!(close(&v, &values(&f, x, p)));
            for j in 0..n {
                let column = cauchy(1, |t| {
                    let mut x = x.to_vec();
                    x[j] += t;
                    values(&f, &x, p)
                });
                prop_assert!(close(&jacobian[j * m..][..m], &column), "{:?} {:?}", &jacobian[j * m..][..m], column);
            }
        }
    }

    #[test]
    fn taylor_coefficients_are_those_of_the_path(x in numbers(16), p in numbers(8)) {
        for system in families() {
            let f = system.compile().unwrap();
            let (m, n, k) = (f.equations(), f.variables(), f.parameters());
            let (x, p) = (&x[..4 * n], &p[..4 * k]);
            let mut memory = f.memory::<C>(Isa::Portable);
            // Twice over, so that what one path leaves behind cannot help or harm the next.
            for round in 0..2 {
                for order in 1..=3 {
                    let mut out = vec![C::new(f64::NAN, 0.0); m];
                    f.taylor(&mut memory, order, &x[..order * n], &p[..(order + 1) * k], &mut out);
                    let expected = cauchy(order, |t| {
                        values(&f, &series(&x[..order * n], n, t), &series(&p[..(order + 1) * k], k, t))
                    });
                    prop_assert!(close(&out, &expected), "round {round} order {order}: {out:?} {expected:?}");
                }
            }
        }
    }

    #[test]
    fn parameters_on_a_straight_line_need_no_zeros(x in numbers(16), p in numbers(8), q in numbers(8)) {
        for system in families() {
            let f = system.compile().unwrap();
            let (m, n, k) = (f.equations(), f.variables(), f.parameters());
            let mut padded = p[..2 * k].to_vec();
            padded.resize(4 * k, C::ZERO);
            let mut memory = f.memory::<C>(Isa::Portable);
            let mut run = |p: &[C], given: [usize; 3]| -> Vec<C> {
                let mut all = Vec::new();
                for (order, given) in (1..=3).zip(given) {
                    let mut out = vec![C::new(f64::NAN, 0.0); m];
                    f.taylor(&mut memory, order, &x[..order * n], &p[..given * k], &mut out);
                    all.extend(out);
                }
                all
            };
            // Curved paths in between leave coefficients behind that must not be used.
            let expected = run(&padded, [2, 3, 4]);
            run(&q[..4 * k], [2, 3, 4]);
            prop_assert_eq!(&run(&padded, [2, 2, 2]), &expected);
            run(&q[..4 * k], [2, 3, 4]);
            prop_assert_eq!(&run(&padded, [2, 2, 4]), &expected);
            prop_assert_eq!(&run(&padded, [2, 3, 2]), &expected);
        }
    }

    #[test]
    fn singles_agree_with_doubles_on_every_instruction_set(x in numbers(16), p in numbers(8)) {
        for system in families() {
            let f = system.compile().unwrap();
            let (m, n, k) = (f.equations(), f.variables(), f.parameters());
            // What single precision can hold, so that only the arithmetic rounds.
            let short = |z: &C| C::new(f64::from(z.re as f32), f64::from(z.im as f32));
            let (x, p): (Vec<C>, Vec<C>) = (x.iter().map(short).collect(), p.iter().map(short).collect());
            let wide = |z: &[C]| -> Vec<Singles16> { z.iter().map(|&z| Singles16::from_c64(z)).collect() };
            let mut doubles = f.memory::<C>(Isa::Portable);
            let (mut v1, mut j1) = (vec![C::ZERO; m], vec![C::ZERO; m * n]);
            f.jacobian(&mut doubles, &x[..n], &p[..k], &mut v1, &mut j1);
            let mut first = None;
            for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
                let mut memory = f.memory::<Singles16>(isa);
                let (x, p) = (wide(&x), wide(&p));
                let (mut v, mut j) = (vec![Singles16::zero(); m], vec![Singles16::zero(); m * n]);
                f.jacobian(&mut memory, &x[..n], &p[..k], &mut v, &mut j);
                for (a, b) in v.iter().zip(&v1).chain(j.iter().zip(&j1)) {
                    let size = v1.iter().chain(&j1).map(|z| z.norm()).fold(1.0, f64::max);
                    prop_assert!((a.get(11) - b).norm() < 1e-4 * size, "{a:?} {b}");
                }
                let mut all = v;
                all.extend(j);
                for (order, given) in TURNS {
                    let mut out = vec![Singles16::zero(); m];
                    f.taylor(&mut memory, order, &x[..order * n], &p[..given * k], &mut out);
                    all.extend(out);
                }
                prop_assert!(all.iter().all(|z| (1..16).all(|l| z.get(l) == z.get(0))));
                // The same bits everywhere.
                prop_assert_eq!(first.get_or_insert_with(|| all.clone()), &all);
            }
        }
    }

    #[test]
    fn lanes_agree_with_one_path_bit_for_bit_on_every_instruction_set(x in numbers(8 * 16), p in numbers(8 * 8)) {
        for system in families() {
            let f = system.compile().unwrap();
            let (m, n, k) = (f.equations(), f.variables(), f.parameters());
            let pack = |z: &[C], count: usize| -> Vec<Lanes8> {
                let mut packed = vec![Lanes8::zero(); count];
                for (j, slot) in packed.iter_mut().enumerate() {
                    for lane in 0..8 {
                        slot.set(lane, z[lane * count + j]);
                    }
                }
                packed
            };
            let (x8, p8) = (pack(&x, 4 * n), pack(&p, 4 * k));
            for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
                let mut memory = f.memory::<Lanes8>(isa);
                let mut v = vec![Lanes8::zero(); m];
                let mut jacobian = vec![Lanes8::zero(); m * n];
                f.jacobian(&mut memory, &x8[..n], &p8[..k], &mut v, &mut jacobian);
                let mut coefficients = Vec::new();
                for (order, given) in TURNS {
                    let mut out = vec![Lanes8::zero(); m];
                    f.taylor(&mut memory, order, &x8[..order * n], &p8[..given * k], &mut out);
                    coefficients.extend(out);
                }
                for l in 0..8 {
                    let (x, p) = (&x[l * 4 * n..][..4 * n], &p[l * 4 * k..][..4 * k]);
                    let mut memory = f.memory::<C>(Isa::Portable);
                    let mut v1 = vec![C::ZERO; m];
                    let mut jacobian1 = vec![C::ZERO; m * n];
                    f.jacobian(&mut memory, &x[..n], &p[..k], &mut v1, &mut jacobian1);
                    for (turn, (order, given)) in TURNS.into_iter().enumerate() {
                        let mut out = vec![C::ZERO; m];
                        f.taylor(&mut memory, order, &x[..order * n], &p[..given * k], &mut out);
                        for (i, z) in out.iter().enumerate() {
                            prop_assert_eq!(coefficients[turn * m + i].get(l), *z);
                        }
                    }
                    for (a, b) in v.iter().zip(&v1).chain(jacobian.iter().zip(&jacobian1)) {
                        prop_assert_eq!(a.get(l), *b);
                    }
                }
            }
        }
    }

    #[test]
    fn double_double_refines_double(x in numbers(4), p in numbers(2)) {
        for system in families() {
            let f = system.compile().unwrap();
            let wide = |z: &[C]| z.iter().map(|&z| ComplexDd::new(z)).collect::<Vec<_>>();
            let (x, p) = (&x[..f.variables()], &p[..f.parameters()]);
            let mut out = vec![ComplexDd::default(); f.equations()];
            f.values(&mut f.memory(Isa::detect()), &wide(x), &wide(p), &mut out);
            let rounded: Vec<C> = out.iter().map(ComplexDd::high).collect();
            prop_assert!(close(&rounded, &values(&f, x, p)));
        }
    }
}

/// Values and Jacobians share the place where a memory keeps its parameters.
#[test]
fn parameters_are_kept() {
    for system in families() {
        let program = system.compile().unwrap();
        let (n, m, rows) = (program.variables(), program.parameters(), program.equations());
        let number = |k: usize| C::new((k * k % 7) as f64 - 2.5, (k * 5 % 11) as f64 - 4.25);
        let mut memory = program.memory(Isa::Portable);
        for round in 0..2 {
            let p: Vec<C> = (0..m).map(|k| number(k + 3 + round)).collect();
            let (mut found, mut derivatives) = (vec![C::ZERO; rows], vec![C::ZERO; rows * n]);
            for again in 0..4 {
                let x: Vec<C> = (0..n).map(|k| number(k + 20 + 7 * again)).collect();
                let mut expected = vec![C::ZERO; rows * n];
                program.jacobian(&mut program.memory(Isa::Portable), &x, &p, &mut found, &mut expected);
                match (again, round) {
                    (0, 0) => program.jacobian(&mut memory, &x, &p, &mut found, &mut derivatives),
                    (0, _) => program.values(&mut memory, &x, &p, &mut found),
                    (2, _) => program.jacobian_again(&mut memory, &x, &p, &mut found, &mut derivatives),
                    _ => program.values_again(&mut memory, &x, &p, &mut found),
                }
                assert_eq!(found, values(&program, &x, &p), "{round} {again}");
                assert!(again != 2 || derivatives == expected, "{round}");
            }
        }
    }
}

#[test]
fn subexpressions_are_shared() {
    // (x+y)^8 needs one sum and three squarings; the second equation one product more.
    let system = System::build(|s| {
        let (x, y) = (s.variable("x"), s.variable("y"));
        vec![(x + y).powi(8), (y + x).powi(9)]
    })
    .unwrap();
    assert_eq!(system.compile().unwrap().program().value_operations(), 5);
}

#[test]
fn division_by_zero_is_refused() {
    let system = System::build(|s| {
        let x = s.variable("x");
        vec![x, 1 / (x - x)]
    })
    .unwrap();
    assert_eq!(system.compile().unwrap_err(), crate::CompileError::DivisionByZero { equation: 2 });
}

#[test]
fn long_sums_and_deep_formulas_compile() {
    let system = System::build(|s| {
        let x = s.variable("x");
        vec![(0..100_000).fold(x, |sum, k| sum * x + k)]
    })
    .unwrap();
    let f = system.compile().unwrap();
    let mut out = [C::ZERO];
    f.values(&mut f.memory(Isa::Portable), &[C::ZERO], &[], &mut out);
    assert_eq!(out[0], C::new(99_999.0, 0.0));
}

#[test]
fn gradient_of_a_product_takes_three_products_a_factor() {
    // Speelpenning's bound for reverse mode; column by column it would be quadratic.
    let n = 40;
    let system = System::build(|s| vec![s.product((0..n).map(|j| s.variable(&format!("x{j}"))))]).unwrap();
    let f = system.compile().unwrap();
    assert_eq!(f.program().value_operations(), n - 1);
    assert!(f.program().jacobian_operations() <= 3 * n, "{}", f.program().jacobian_operations());
}

#[test]
fn many_equations_in_one_unknown_are_derived_forward() {
    // One chain of 20 squarings, used by 30 equations: row by row its derivative would be made 30
    // times.
    let system = System::build(|s| {
        let x = s.variable("x");
        let chain = (0..20).fold(x, |y, _| y * y + x);
        (2..32).map(|k| chain * (x + k) + x).collect()
    })
    .unwrap();
    let f = system.compile().unwrap();
    let (values, both) = (f.program().value_operations(), f.program().jacobian_operations());
    // Each squaring gives at most three operations more, each equation at most three.
    assert!(both <= values + 3 * 20 + 3 * 30, "{values} {both}");
}

#[test]
fn like_terms_are_collected() {
    let operations = |formula: &str| {
        let system = parse::phcpack(&format!("1\nx - x + y - y + z - z + {formula};")).unwrap();
        system.compile().unwrap().program().value_operations()
    };
    for (formula, collected) in [
        // A product and a fused product with sum.
        ("x + 2*x + 3*y - y", 2),
        // One fused product with sum.
        ("x + y + x - z + z", 1),
        ("x + 1 + y + 2 - 0.5", 2),
        ("x*y + z - y*x", 0),
        ("(x + y)^2 + z - 3*(y + x)^2 - z", 3),
        ("x - (y - (z - (x - (y - z))))", 0),
        // Unlike terms stay as they are.
        ("x + 2*y - 3*z", 2),
    ] {
        assert_eq!(operations(formula), collected, "{formula}");
    }
    // A sum that is used elsewhere stays one term.
    let system = parse::phcpack("2\n(x + y + z) + x;\n(x + y + z)*x;").unwrap();
    assert_eq!(system.compile().unwrap().program().value_operations(), 4);
}

#[test]
fn a_divisor_that_cancels_is_zero() {
    let system = parse::phcpack("1\n1/(x + y - x - y);").unwrap();
    assert_eq!(system.compile().unwrap_err(), crate::CompileError::DivisionByZero { equation: 1 });
}

//! Generated code computes bit for bit what the interpreter computes.

use benches::{generated, systems};
use poly::{Complex64, ComplexDd, Evaluate, Interpreter, Isa, Lane, Lanes8, Scalar};

/// A fixed sequence of numbers of modulus about one.
fn numbers<S: Lane>(count: usize) -> Vec<S> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut number = || {
        let mut z = S::zero();
        for lane in 0..S::LANES {
            z.set(lane, Complex64::new(next(), next()));
        }
        z
    };
    (0..count).map(|_| number()).collect()
}

/// Everything that a system computes at one point.
fn all<E: Evaluate, S: Scalar>(f: &E, isa: Isa, x: &[S], p: &[S]) -> Vec<S> {
    let (m, n, k) = (f.equations(), f.variables(), f.parameters());
    let mut memory = f.memory::<S>(isa);
    let junk = S::from_c64(Complex64::new(f64::NAN, 7.0));
    let mut out = vec![junk; 2 * m + m * n + 6 * m];
    let (values, rest) = out.split_at_mut(m);
    f.values(&mut memory, &x[..n], &p[..k], values);
    let (values, rest) = rest.split_at_mut(m);
    let (jacobian, rest) = rest.split_at_mut(m * n);
    f.jacobian(&mut memory, &x[..n], &p[..k], values, jacobian);
    // The parameters on a curve, then on a straight line.
    let turns = [(1, 2), (2, 3), (3, 4), (1, 2), (2, 2), (3, 2)];
    for ((order, given), coefficients) in turns.into_iter().zip(rest.chunks_mut(m)) {
        f.taylor(&mut memory, order, &x[..order * n], &p[..given * k], coefficients);
    }
    out
}

fn same_shape(a: &impl Evaluate, b: &impl Evaluate) {
    assert_eq!((a.equations(), a.variables(), a.parameters()), (b.equations(), b.variables(), b.parameters()));
}

/// One path at a time.
fn agrees<E: Evaluate>(interpreter: &Interpreter, f: &E) {
    same_shape(interpreter, f);
    let (x, p) = (numbers::<Complex64>(4 * f.variables()), numbers::<Complex64>(4 * f.parameters()));
    assert_eq!(all(interpreter, Isa::Portable, &x, &p), all(f, Isa::Portable, &x, &p));
}

/// Eight paths on every instruction set.
fn agrees_in_lanes<E: Evaluate>(interpreter: &Interpreter, f: &E) {
    let (x, p) = (numbers::<Lanes8>(4 * f.variables()), numbers::<Lanes8>(4 * f.parameters()));
    for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
        assert_eq!(all(interpreter, Isa::Portable, &x, &p), all(f, isa, &x, &p), "{isa:?}");
    }
}

/// In double-double, constants included.
fn agrees_in_double_double<E: Evaluate>(interpreter: &Interpreter, f: &E) {
    let wide = |z: Vec<Complex64>| z.into_iter().map(ComplexDd::new).collect::<Vec<_>>();
    let (x, p) = (wide(numbers(4 * f.variables())), wide(numbers(4 * f.parameters())));
    assert_eq!(all(interpreter, Isa::Portable, &x, &p), all(f, Isa::detect(), &x, &p));
}

#[test]
fn generated_code_agrees_with_the_interpreter() {
    for case in systems::cases() {
        let f = case.system.compile().unwrap();
        // Every kernel of a wide type takes long to compile, so those are tried on a few systems.
        match case.name {
            "cyclic-7" => agrees(&f, &generated::cyclic_7::Cyclic7),
            "katsura-8" => agrees(&f, &generated::katsura_8::Katsura8),
            "noon-5" => {
                agrees(&f, &generated::noon_5::Noon5);
                agrees_in_lanes(&f, &generated::noon_5::Noon5);
                agrees_in_double_double(&f, &generated::noon_5::Noon5);
            }
            "6r/3s" => {
                agrees(&f, &generated::s6r_3s::S6r3s);
                agrees_in_lanes(&f, &generated::s6r_3s::S6r3s);
            }
            "4r/5s" => agrees(&f, &generated::s4r_5s::S4r5s),
            "pencils" => agrees(&f, &generated::pencils::Pencils),
            other => panic!("no generated code for {other}"),
        }
    }
}

//! Evaluation of six systems: interpreted and generated, one path and eight at once; three of them
//! also by the kernel for supports and coefficients.
//!
//! `compare_sympy.py` runs this and SymPy and prints the tables of README.md. With the environment
//! variable `POLY_PRINT_SYSTEMS` set, the systems are printed instead.

use benches::systems;
use divan::{Bencher, black_box};
use poly::{Complex64, Evaluate, Interpreter, Isa, Lane, Lanes8, SparseSystem};

fn main() {
    if std::env::var_os("POLY_PRINT_SYSTEMS").is_some() {
        print_systems();
    } else {
        divan::main();
    }
}

fn print_systems() {
    for case in systems::cases() {
        let f = case.system.compile().expect("a system that compiles");
        let (values, jacobian) = (f.program().value_operations(), f.program().jacobian_operations());
        println!("system\t{}\t{values}\t{jacobian}", case.name);
        println!("{}\n{}", case.system.variables().join(" "), case.system.parameters().join(" "));
        for formula in case.system.formulas() {
            println!("{formula};");
        }
        println!("end");
    }
}

/// What is measured in one iteration.
#[derive(Clone, Copy)]
enum Job {
    Values,
    Jacobian,
    /// Orders 1, 2 and 3, the parameters on a straight line.
    Taylor,
    /// Values with the parameters on a curve.
    Curved,
}

fn numbers<S: Lane>(count: usize) -> Vec<S> {
    let number = |k: usize| {
        let mut z = S::zero();
        for lane in 0..S::LANES {
            z.set(lane, Complex64::from_polar(1.0, (8 * k + lane) as f64));
        }
        z
    };
    (0..count).map(number).collect()
}

fn measure<S: Lane, E: Evaluate>(bencher: Bencher<'_, '_>, f: &E, job: Job) {
    let (m, n, k) = (f.equations(), f.variables(), f.parameters());
    let (x, p) = (numbers::<S>(3 * n), numbers::<S>(4 * k));
    let mut memory = f.memory::<S>(Isa::detect());
    let (mut values, mut jacobian) = (vec![S::zero(); m], vec![S::zero(); m * n]);
    bencher.counter(divan::counter::ItemsCount::new(S::LANES)).bench_local(|| {
        let (x, p, values) = (black_box(&x), black_box(&p), black_box(&mut values));
        match job {
            Job::Values => f.values(&mut memory, x, p, values),
            Job::Jacobian => f.jacobian(&mut memory, x, p, values, black_box(&mut jacobian)),
            Job::Taylor | Job::Curved => {
                let p = if matches!(job, Job::Taylor) { &p[..2 * k] } else { p };
                for order in 1..=3 {
                    f.taylor(&mut memory, order, x, p, values);
                }
            }
        }
    });
}

fn interpreter(name: &str) -> Interpreter {
    let case = systems::cases().into_iter().find(|case| case.name == name).expect("a known system");
    case.system.compile().expect("a system that compiles")
}

/// The kernel for supports; the coefficients are its parameters.
fn sparse(name: &str) -> SparseSystem {
    let case = systems::cases().into_iter().find(|case| case.name == name).expect("a known system");
    let polynomials = case.system.expand(&Default::default()).expect("a small system");
    SparseSystem::from_polynomials(&polynomials).expect("supports of polynomials").0
}

macro_rules! cases {
    ($($module:ident $name:literal $generated:path $(, $sparse_one:ident $sparse_eight:ident)?;)*) => {$(
        #[divan::bench_group(name = $name)]
        mod $module {
            #[allow(unused_imports)]
            use crate::{Bencher, Complex64, Job, Lanes8, interpreter, measure, sparse};

            cases!(@jobs interpreted_one, Complex64, interpreter($name));
            cases!(@jobs interpreted_eight, Lanes8, interpreter($name));
            cases!(@jobs generated_one, Complex64, $generated);
            cases!(@jobs generated_eight, Lanes8, $generated);
            $(
                cases!(@jobs $sparse_one, Complex64, sparse($name));
                cases!(@jobs $sparse_eight, Lanes8, sparse($name));
            )?
        }
    )*};
    (@jobs $mode:ident, $scalar:ty, $system:expr) => {
        mod $mode {
            #[allow(unused_imports)]
            use super::{Bencher, Complex64, Job, Lanes8, interpreter, measure, sparse};

            #[divan::bench]
            fn values(bencher: Bencher<'_, '_>) {
                measure::<$scalar, _>(bencher, &$system, Job::Values);
            }
            #[divan::bench]
            fn jacobian(bencher: Bencher<'_, '_>) {
                measure::<$scalar, _>(bencher, &$system, Job::Jacobian);
            }
            #[divan::bench]
            fn taylor(bencher: Bencher<'_, '_>) {
                measure::<$scalar, _>(bencher, &$system, Job::Taylor);
            }
            #[divan::bench]
            fn curved(bencher: Bencher<'_, '_>) {
                measure::<$scalar, _>(bencher, &$system, Job::Curved);
            }
        }
    };
}

cases! {
    cyclic "cyclic-7" benches::generated::cyclic_7::Cyclic7, sparse_one sparse_eight;
    katsura "katsura-8" benches::generated::katsura_8::Katsura8, sparse_one sparse_eight;
    noon "noon-5" benches::generated::noon_5::Noon5, sparse_one sparse_eight;
    six_receivers "6r/3s" benches::generated::s6r_3s::S6r3s;
    five_transmitters "4r/5s" benches::generated::s4r_5s::S4r5s;
    pencils "pencils" benches::generated::pencils::Pencils;
}

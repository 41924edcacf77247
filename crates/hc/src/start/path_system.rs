//! The system whose zeros are the paths of a solve.

use poly::program::InterpreterMemory;
use poly::simd::{Isa, Kernel};
use poly::{Evaluate, Interpreter, Scalar, SparseMemory, SparseSystem};

/// Sums of terms with their coefficients as parameters. To these, formulas may be added as they were
/// written, times one more parameter `s`, the last one: the terms are then those of the start system,
/// and a path leads from its coefficients and `s = 0` to no terms and `s = 1`.
#[derive(Clone, Debug)]
pub(crate) struct PathSystem {
    terms: SparseSystem,
    written: Option<Interpreter>,
}

/// Scratch space of a [`PathSystem`] system.
pub(crate) struct PathMemory<S> {
    isa: Isa,
    terms: SparseMemory<S>,
    written: Option<WrittenMemory<S>>,
}

struct WrittenMemory<S> {
    program: InterpreterMemory<S>,
    values: Vec<S>,
    jacobian: Vec<S>,
    /// Taylor coefficients of the parameters of the terms, and of `s`.
    coefficients: Vec<S>,
    share: Vec<S>,
}

impl PathSystem {
    /// A system of terms alone.
    pub(crate) fn of_terms(terms: SparseSystem) -> PathSystem {
        PathSystem { terms, written: None }
    }

    /// Terms and formulas as they were written, as many, in the same unknowns, that are multiplied by
    /// their only parameter.
    pub(crate) fn with_written(terms: SparseSystem, written: Interpreter) -> PathSystem {
        debug_assert_eq!(terms.equations(), written.equations());
        debug_assert_eq!(terms.variables(), written.variables());
        debug_assert_eq!(written.parameters(), 1);
        PathSystem { terms, written: Some(written) }
    }

    /// Parameters that are not coefficients of terms.
    pub(crate) fn further(&self) -> usize {
        usize::from(self.written.is_some())
    }
}

impl Evaluate for PathSystem {
    type Memory<S: Scalar> = PathMemory<S>;

    fn equations(&self) -> usize {
        self.terms.equations()
    }
    fn variables(&self) -> usize {
        self.terms.variables()
    }
    fn parameters(&self) -> usize {
        self.terms.parameters() + self.further()
    }

    fn memory<S: Scalar>(&self, isa: Isa) -> PathMemory<S> {
        let written = self.written.as_ref().map(|program| {
            let zeros = |count: usize| vec![S::zero(); count];
            let rows = program.equations();
            WrittenMemory {
                program: program.memory(isa),
                values: zeros(rows),
                jacobian: zeros(rows * program.variables()),
                coefficients: zeros(ORDERS * self.terms.parameters()),
                share: zeros(ORDERS),
            }
        });
        PathMemory { isa, terms: self.terms.memory(isa), written }
    }

    fn values<S: Scalar>(&self, memory: &mut PathMemory<S>, x: &[S], p: &[S], values: &mut [S]) {
        let (coefficients, share) = p.split_at(self.terms.parameters());
        self.terms.values(&mut memory.terms, x, coefficients, values);
        if let (Some(program), Some(own)) = (&self.written, &mut memory.written) {
            program.values(&mut own.program, x, share, &mut own.values);
            memory.isa.run(Add { from: &own.values, to: values });
        }
    }

    fn jacobian<S: Scalar>(&self, memory: &mut PathMemory<S>, x: &[S], p: &[S], values: &mut [S], jacobian: &mut [S]) {
        let (coefficients, share) = p.split_at(self.terms.parameters());
        self.terms.jacobian(&mut memory.terms, x, coefficients, values, jacobian);
        if let (Some(program), Some(own)) = (&self.written, &mut memory.written) {
            program.jacobian(&mut own.program, x, share, &mut own.values, &mut own.jacobian);
            memory.isa.run(Add { from: &own.values, to: values });
            memory.isa.run(Add { from: &own.jacobian, to: jacobian });
        }
    }

    fn vanishes(&self, row: usize, column: usize) -> bool {
        let written = self.written.as_ref().is_none_or(|program| program.vanishes(row, column));
        self.terms.vanishes(row, column) && written
    }

    fn taylor<S: Scalar>(&self, memory: &mut PathMemory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]) {
        let (Some(program), Some(own)) = (&self.written, &mut memory.written) else {
            return self.terms.taylor(&mut memory.terms, order, x, p, out);
        };
        let (m, all) = (self.terms.parameters(), self.parameters());
        // Two orders where all parameters move on a straight line.
        let orders = (p.len() / all).min(order + 1);
        for (k, p) in p.chunks_exact(all).take(orders).enumerate() {
            own.coefficients[k * m..(k + 1) * m].clone_from_slice(&p[..m]);
            own.share[k] = p[m].clone();
        }
        self.terms.taylor(&mut memory.terms, order, x, &own.coefficients[..orders * m], out);
        program.taylor(&mut own.program, order, x, &own.share[..orders], &mut own.values);
        memory.isa.run(Add { from: &own.values, to: out });
    }
}

/// Orders of Taylor coefficients: 0 to 3.
const ORDERS: usize = 4;

/// Adds numbers to others.
struct Add<'a, S> {
    from: &'a [S],
    to: &'a mut [S],
}

impl<S: Scalar> Kernel for Add<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        for (to, from) in self.to.iter_mut().zip(self.from) {
            *to = S::add(to, from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PathSystem;
    use num_complex::Complex64;
    use poly::{Evaluate, Isa, SparseSystem, parse};

    /// `c0 x^2 + c1 + s ((x + y)^2 - 3)` and `c2 y + s (x y - 1)`, and the same expanded.
    #[test]
    fn terms_and_formulas_are_added() {
        let terms = SparseSystem::new(2, &[vec![vec![2, 0], vec![0, 0]], vec![vec![0, 1]]]).unwrap();
        let family = |formulas: [&str; 2], parameters: &str| {
            let text = format!(
                "name = 'f'\nunknowns = ['x', 'y']\nparameters = [{parameters}]\nequations = ['{}', '{}']",
                formulas[0], formulas[1]
            );
            parse::family(&text).unwrap().system.compile().unwrap()
        };
        let system = PathSystem::with_written(terms, family(["s*((x + y)^2 - 3)", "s*(x*y - 1)"], "'s'"));
        let whole =
            family(["c0*x^2 + c1 + s*x^2 + 2*s*x*y + s*y^2 - 3*s", "c2*y + s*x*y - s"], "'c0', 'c1', 'c2', 's'");
        assert_eq!((system.equations(), system.variables(), system.parameters()), (2, 2, 4));
        let number = |k: usize| Complex64::new((k * k % 7) as f64 - 2.5, (k * 5 % 11) as f64 - 4.0);
        let p: Vec<Complex64> = (0..16).map(number).collect();
        let x: Vec<Complex64> = (20..28).map(number).collect();
        let (mut a, mut b) = (system.memory(Isa::detect()), whole.memory(Isa::detect()));
        let near = |a: &[Complex64], b: &[Complex64]| a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-9);
        let zeros = |count: usize| vec![Complex64::default(); count];
        let (mut values, mut expected) = (zeros(2), zeros(2));
        let (mut jacobian, mut derivatives) = (zeros(4), zeros(4));
        system.values(&mut a, &x, &p[..4], &mut values);
        whole.values(&mut b, &x, &p[..4], &mut expected);
        assert!(near(&values, &expected));
        system.jacobian(&mut a, &x, &p[..4], &mut values, &mut jacobian);
        whole.jacobian(&mut b, &x, &p[..4], &mut expected, &mut derivatives);
        assert!(near(&values, &expected) && near(&jacobian, &derivatives));
        // On a straight line of the parameters, and on a curve.
        for straight in [true, false] {
            for order in 1..4 {
                let orders = if straight { 2 } else { order + 1 };
                system.taylor(&mut a, order, &x[..2 * order], &p[..4 * orders], &mut values);
                whole.taylor(&mut b, order, &x[..2 * order], &p[..4 * orders], &mut expected);
                assert!(near(&values, &expected), "{straight} {order}");
            }
        }
    }
}

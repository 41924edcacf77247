//! How many sums the formulas of a system multiply.

use crate::graph::{Graph, Id, Node};
use crate::system::System;

impl System {
    /// The most sums that a formula multiplies: 0 for a monomial, 1 for a sum of monomials and for
    /// `x*(y*(x + 1) + 1)`, 3 for `(y - 1)^2*(x + y)`, 20 for `(x + y)^20`.
    ///
    /// Near a root of all these sums, each of them costs the expanded formula the digits that cancel in
    /// it, which the formula as written keeps.
    ///
    /// ```
    /// let system = poly::System::build(|s| vec![(s.variable("x") + s.variable("y")).powi(20) - 1])?;
    /// assert_eq!(system.sums_multiplied(), 20);
    /// # Ok::<(), poly::SystemError>(())
    /// ```
    pub fn sums_multiplied(&self) -> u32 {
        let counts = counts(&self.arena.graph);
        self.equations.iter().map(|&id| counts[id as usize]).max().unwrap_or(0)
    }
}

fn counts(graph: &Graph) -> Vec<u32> {
    let mut counts: Vec<u32> = Vec::with_capacity(graph.len());
    // Operands have smaller indices than the nodes that use them.
    for k in 0..graph.len() {
        let of = |id: Id| counts[id as usize];
        counts.push(match graph.node(k as Id) {
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => 0,
            Node::Add(a, b) | Node::Sub(a, b) => of(a).max(of(b)).max(1),
            Node::Mul(a, b) | Node::Div(a, b) => of(a).saturating_add(of(b)),
            Node::Neg(a) => of(a),
            Node::Pow(a, exponent) => of(a).saturating_mul(exponent.unsigned_abs()),
        });
    }
    counts
}

#[cfg(test)]
mod tests {
    use crate::parse::phcpack;

    #[test]
    fn products_and_powers_of_sums_are_counted() {
        let cases = [
            ("x^5*y", 0),
            ("x^2+3*x*y-1", 1),
            ("-x*(y*(x+1)+1)", 1),
            ("(y-1)^2*(y+x)+x", 3),
            ("((x+y)^3-x)^4", 12),
            ("(x+1)^2-(y+1)^3*(x+y)", 4),
        ];
        for (formula, count) in cases {
            assert_eq!(phcpack(&format!("2\n{formula};\nx*y;")).unwrap().sums_multiplied(), count, "{formula}");
        }
    }
}

//! What the formulas of a system tell before they are expanded: how many sums they multiply, and their
//! degrees.

use crate::graph::{Graph, Id, Node};
use crate::system::System;

impl System {
    /// How many sums each formula multiplies at most: 0 for a monomial, 1 for a sum of monomials and for
    /// `x*(y*(x + 1) + 1)`, 3 for `(y - 1)^2*(x + y)`, 20 for `(x + y)^20`.
    ///
    /// Near a root of all these sums, each of them costs the expanded formula the digits that cancel in
    /// it.
    ///
    /// ```
    /// let system: poly::System = "(x + y)^20 = 1; x = y^2".parse()?;
    /// assert_eq!(system.sums_multiplied(), [20, 1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sums_multiplied(&self) -> Vec<u32> {
        let counts = counts(&self.arena.graph, u32::MAX);
        self.equations.iter().map(|&id| counts[id as usize]).collect()
    }

    /// The degrees of the formulas in the unknowns, as far as they can be told without expanding them: what
    /// cancels counts. `None` if a formula divides by unknowns, or a degree does not fit.
    ///
    /// ```
    /// let system: poly::System = "(x^2 + y)^20 = 1; (x + y)^3 - (x - y)^3 = y".parse()?;
    /// assert_eq!(system.degrees_as_written(), Some(vec![40, 3]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn degrees_as_written(&self) -> Option<Vec<u64>> {
        let graph = &self.arena.graph;
        let mut degrees: Vec<Option<u64>> = Vec::with_capacity(graph.len());
        for k in 0..graph.len() {
            let of = |id: Id| degrees[id as usize];
            degrees.push(match graph.node(k as Id) {
                Node::Constant(_) | Node::Parameter(_) => Some(0),
                Node::Variable(_) => Some(1),
                Node::Add(a, b) | Node::Sub(a, b) => of(a).zip(of(b)).map(|(a, b)| a.max(b)),
                Node::Mul(a, b) => of(a).zip(of(b)).and_then(|(a, b)| a.checked_add(b)),
                Node::Div(a, b) => of(a).filter(|_| of(b) == Some(0)),
                Node::Neg(a) => of(a),
                Node::Pow(a, exponent) => {
                    of(a).and_then(|a| if a == 0 { Some(0) } else { a.checked_mul(u64::try_from(exponent).ok()?) })
                }
            });
        }
        self.equations.iter().map(|&id| degrees[id as usize]).collect()
    }
}

/// How many sums each node multiplies, where products of more than `most` are products of names when they are
/// terms of sums.
pub(crate) fn counts(graph: &Graph, most: u32) -> Vec<u32> {
    let mut counts: Vec<u32> = Vec::with_capacity(graph.len());
    // Operands have smaller indices than the nodes that use them.
    for k in 0..graph.len() {
        let of = |id: Id| counts[id as usize];
        let term = |id: Id| if of(id) > most { 0 } else { of(id) };
        counts.push(match graph.node(k as Id) {
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => 0,
            Node::Add(a, b) | Node::Sub(a, b) => term(a).max(term(b)).max(1),
            Node::Mul(a, b) => of(a).saturating_add(of(b)),
            Node::Div(a, b) => of(a).saturating_add(term(b)),
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
            assert_eq!(phcpack(&format!("2\n{formula};\nx*y;")).unwrap().sums_multiplied()[0], count, "{formula}");
        }
    }

    #[test]
    fn degrees_that_expansion_confirms() {
        for text in ["(x+y)^3*x*y; x^2*y-4", "((x+y)^3-x)^4; (x*y+1)/2", "-(x^2-1)^2*7; 3^2*x"] {
            let system: crate::System = text.parse().unwrap();
            let expanded = system.expand(&Default::default()).unwrap();
            let degrees = expanded.iter().map(|p| u64::try_from(p.degree()?).ok()).collect::<Option<Vec<u64>>>();
            assert_eq!(system.degrees_as_written(), degrees, "{text}");
        }
        let degrees = |text: &str| text.parse::<crate::System>().unwrap().degrees_as_written();
        // Quotients, and 8e27, do not have one.
        for text in ["x/y", "x^(-1)", "((x^2000000000)^2000000000)^2000000000"] {
            assert_eq!(degrees(text), None, "{text}");
        }
        assert_eq!(degrees("(x^1000000000*y)^1000000000*x^7"), Some(vec![1_000_000_001_000_000_007]));
    }
}

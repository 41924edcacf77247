//! Systems with unknowns in place of sums that are multiplied.

use crate::expression::Expr;
use crate::factors::counts;
use crate::graph::{Graph, Id, Node};
use crate::system::System;

impl System {
    /// These equations with a new unknown for each sum in a product of more than `factors` sums,
    /// followed by an equation for each new unknown; `None` if there is no such product, or more than
    /// `most` unknowns would be new.
    ///
    /// The solutions are the same once the new unknowns, which are the last ones, are left out, and so
    /// are their multiplicities: each new unknown is a polynomial in the others. The expanded formulas
    /// are short, and no digits cancel in them.
    ///
    /// ```
    /// let system: poly::System = "(x + y)^20 = 1; x = y^2".parse()?;
    /// let named = system.with_named_sums(4, 8).unwrap();
    /// assert_eq!(named.to_string(), "variables: x y sum1\nsum1^20 - 1;\nx - y^2;\nsum1 - (x + y);\n");
    /// assert!(system.with_named_sums(20, 8).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_named_sums(&self, factors: u32, most: usize) -> Option<System> {
        let named = named(&self.arena.graph, &self.equations, factors);
        let count = named.iter().filter(|&&named| named).count();
        if count == 0 || count > most {
            return None;
        }
        let prefix = prefix(self);
        let system = System::build(|arena| {
            let unknowns: Vec<_> = self.variables().iter().map(|name| arena.variable(name)).collect();
            let parameters: Vec<_> = self.parameters().iter().map(|name| arena.parameter(name)).collect();
            let mut definitions: Vec<Expr<'_>> = Vec::new();
            let name = |id: Id, sum| {
                if !named[id as usize] {
                    return sum;
                }
                let name = arena.variable(&format!("{prefix}{}", definitions.len() + 1));
                definitions.push(name - sum);
                name
            };
            let mut equations = self.instantiate_with(arena, &unknowns, &parameters, name);
            equations.extend(definitions);
            equations
        });
        system.ok()
    }
}

/// What no name of the system begins with.
fn prefix(system: &System) -> String {
    let mut prefix = String::from("sum");
    while system.variables().iter().chain(system.parameters()).any(|name| name.starts_with(&prefix)) {
        prefix.push('_');
    }
    prefix
}

/// Which nodes are sums in a product of more than `factors` sums.
fn named(graph: &Graph, equations: &[Id], factors: u32) -> Vec<bool> {
    let used = graph.reachable(equations.iter().copied());
    let counts = counts(graph, factors);
    // Products that are whole equations, or terms of sums.
    let mut whole = vec![false; graph.len()];
    equations.iter().for_each(|&id| whole[id as usize] = true);
    for k in (0..graph.len()).filter(|&k| used[k]) {
        let node = graph.node(k as Id);
        if matches!(node, Node::Add(..) | Node::Sub(..)) {
            node.operands().for_each(|id| whole[id as usize] = true);
        }
    }
    let mut many: Vec<bool> = (0..graph.len()).map(|k| used[k] && whole[k] && counts[k] > factors).collect();
    let mut named = vec![false; graph.len()];
    // Operands have smaller indices than the nodes that use them.
    for k in (0..graph.len()).rev().filter(|&k| used[k]) {
        match graph.node(k as Id) {
            Node::Add(..) | Node::Sub(..) => named[k] = many[k],
            Node::Mul(a, b) if many[k] => (many[a as usize], many[b as usize]) = (true, true),
            // What is divided by a sum is no polynomial: a name would hide that.
            Node::Div(a, _) | Node::Neg(a) if many[k] => many[a as usize] = true,
            Node::Pow(a, exponent) if many[k] && exponent > 0 => many[a as usize] = true,
            _ => {}
        }
    }
    named
}

#[cfg(test)]
mod tests {
    use crate::evaluate::Evaluate;
    use crate::{Complex64, Isa, System};

    fn named(text: &str, factors: u32, most: usize) -> Option<String> {
        let system: System = text.parse().unwrap();
        Some(system.with_named_sums(factors, most)?.to_string().replace('\n', ""))
    }

    #[test]
    fn sums_in_long_products_have_names() {
        assert_eq!(named("x*(y + 1)^3 - 2", 3, 9), None);
        assert_eq!(
            named("-(x + 1)^2*(y - x)*x + (x + 1)^2; sum1 + x", 2, 9).unwrap(),
            "variables: x y sum1 sum_1 sum_2sum_1^2 - sum_1^2*sum_2*x;sum1 + x;sum_1 - (x + 1);sum_2 - (y - x);"
        );
        // Nested: with a name for the middle, the outer square has two factors.
        assert_eq!(
            named("(((x + y)^2 + x)^2 - y)^2", 3, 9).unwrap(),
            "variables: x y sum1(sum1^2 - y)^2;sum1 - ((x + y)^2 + x);"
        );
        assert_eq!(named("(x + 1)*(x + 2)*(x + 3)*(x + 4)", 3, 3), None);
        // Not a polynomial, and that stays to be seen.
        assert_eq!(named("x/(x + 1)^9", 3, 3), None);
    }

    /// With the new unknowns at the values of their sums, the equations have the values that they had.
    #[test]
    fn values_are_the_same() {
        let system: System = "((x + 2*y)^3*(x - y)^2 + x)^2*(y - 3)/7 - x; -(x*y - 2)^5*(x + 2*y)".parse().unwrap();
        let named = system.with_named_sums(2, 9).unwrap();
        let (x, y) = (Complex64::new(0.7, -0.2), Complex64::new(-0.4, 0.9));
        let (f, g) = (system.compile().unwrap(), named.compile().unwrap());
        let values = |f: &crate::Interpreter, point: &[Complex64]| {
            let mut values = vec![Complex64::default(); f.equations()];
            f.values(&mut f.memory(Isa::Portable), point, &[], &mut values);
            values
        };
        // Each new unknown stands alone in its equation, and its sum has earlier ones only.
        let mut point = vec![x, y];
        point.resize(named.variables().len(), Complex64::default());
        for k in 2..point.len() {
            point[k] = -values(&g, &point)[k];
        }
        let (before, after) = (values(&f, &[x, y]), values(&g, &point));
        assert!(before.iter().zip(&after).all(|(a, b)| (a - b).norm() <= 1e-13 * a.norm()), "{before:?} {after:?}");
        assert!(after[2..].iter().all(|z| z.norm() < 1e-13) && named.sums_multiplied().iter().all(|&count| count <= 2));
    }

    #[test]
    fn long_products_of_few_sums_take_no_quadratic_time() {
        let system = System::build(|s| {
            let (x, y) = (s.variable("x"), s.variable("y"));
            vec![(0..20_000).fold(s.constant(1), |product, k| product * if k % 2 == 0 { x + y } else { x - y })]
        });
        let named = system.unwrap().with_named_sums(4, 8).unwrap();
        assert_eq!(named.variables().len(), 4);
    }
}

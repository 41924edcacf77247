//! Systems with formulas in place of their unknowns and parameters.

use crate::exact::{Exact, ToExact};
use crate::expression::{Expr, Expressions};
use crate::graph::{Id, Node};
use crate::system::{System, SystemError};
use num_traits::Zero;

impl System {
    /// The system with numbers, taken exactly, in place of its parameters: a member of the family
    /// that the system describes.
    ///
    /// ```
    /// let family = poly::System::build(|s| vec![s.variable("x") * s.variable("x") - s.parameter("a")])?;
    /// let member = family.at(&[2.0])?;
    /// assert_eq!((member.variables().len(), member.parameters().len()), (1, 0));
    /// // x^2 and -2
    /// assert_eq!(member.expand(&Default::default())?[0].terms().len(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If a parameter is not finite.
    ///
    /// # Panics
    /// If the number of values differs from the number of parameters.
    pub fn at<T: ToExact>(&self, parameters: &[T]) -> Result<System, SystemError> {
        System::build(|s| {
            let unknowns: Vec<_> = self.variables().iter().map(|name| s.variable(name)).collect();
            let parameters: Vec<_> = parameters.iter().map(|p| s.constant(p)).collect();
            self.instantiate(s, &unknowns, &parameters)
        })
    }

    /// The equations as formulas in `arena`, with `unknowns[j]` in place of unknown `j` and
    /// `parameters[i]` in place of parameter `i`. This makes a system a part of another system.
    ///
    /// ```
    /// use poly::System;
    /// let circle = System::build(|s| vec![s.variable("x").powi(2) + s.variable("y").powi(2) - s.parameter("r")])?;
    /// // On the line (x, y) = (u, 2u), with the parameter as an unknown.
    /// let both = System::build(|s| {
    ///     let (u, r) = (s.variable("u"), s.variable("r"));
    ///     circle.instantiate(s, &[u, u * 2], &[r])
    /// })?;
    /// assert_eq!(both.variables(), ["u", "r"]);
    /// # Ok::<(), poly::SystemError>(())
    /// ```
    ///
    /// # Panics
    /// If there is not one formula for each unknown and each parameter.
    pub fn instantiate<'a>(
        &self,
        arena: &'a Expressions,
        unknowns: &[Expr<'a>],
        parameters: &[Expr<'a>],
    ) -> Vec<Expr<'a>> {
        self.instantiate_with(arena, unknowns, parameters, |_, formula| formula)
    }

    /// The equations with these formulas in place of unknowns and parameters, and for each node what `replaced` makes of
    /// its formula.
    pub(crate) fn instantiate_with<'a>(
        &self,
        arena: &'a Expressions,
        unknowns: &[Expr<'a>],
        parameters: &[Expr<'a>],
        mut replaced: impl FnMut(Id, Expr<'a>) -> Expr<'a>,
    ) -> Vec<Expr<'a>> {
        assert_eq!(unknowns.len(), self.variables().len(), "one formula an unknown");
        assert_eq!(parameters.len(), self.parameters().len(), "one formula a parameter");
        let graph = &self.arena.graph;
        let mut built: Vec<Expr<'a>> = Vec::with_capacity(graph.len());
        // Operands have smaller indices than the nodes that use them.
        for k in 0..graph.len() {
            let operand = |id: Id| built[id as usize];
            let id = k as Id;
            let formula = match graph.node(id) {
                Node::Constant(_) => arena.constant(graph.as_constant(id).cloned().unwrap_or_else(Exact::zero)),
                Node::Variable(j) => unknowns[j as usize],
                Node::Parameter(i) => parameters[i as usize],
                Node::Add(a, b) => operand(a) + operand(b),
                Node::Sub(a, b) => operand(a) - operand(b),
                Node::Mul(a, b) => operand(a) * operand(b),
                Node::Div(a, b) => operand(a) / operand(b),
                Node::Neg(a) => -operand(a),
                Node::Pow(a, e) => operand(a).powi(e),
            };
            built.push(replaced(id, formula));
        }
        self.equations.iter().map(|&id| built[id as usize]).collect()
    }
}

//! Formulas that own their parts.

use crate::arena::Arena;
use crate::display;
use crate::exact::{Exact, ToExact};
use crate::graph::{self, Id};
use crate::system::{System, SystemError};
use num_complex::Complex64;
use num_rational::BigRational;
use num_traits::Zero;
use std::collections::HashMap;
use std::fmt::{self, Debug, Display, Formatter};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// A formula in named symbols: it owns its parts, is cheap to clone, and can be sent to other
/// threads.
///
/// A symbol becomes an unknown or a parameter only in the [`System`] that uses the formula as an
/// equation. Within [`System::build`], [`Expr`](crate::Expr) needs fewer clones.
///
/// ```
/// use poly::{Formula, System};
/// let (x, r) = (Formula::symbol("x"), Formula::symbol("r"));
/// let circle = x.powi(2) + "y^2".parse::<Formula>()? - &r * &r;
/// assert_eq!(circle.to_string(), "x^2 + y^2 - r^2");
/// let system = System::new(&["x", "y"], &["r"], &[circle, x - 1])?;
/// assert_eq!(system.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Formula(Arc<Node>);

struct Node {
    kind: Kind,
    operands: Vec<Formula>,
}

enum Kind {
    /// `None` where the number is not finite: reported when a system is made.
    Constant(Option<Exact>),
    Symbol(String),
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    Pow(i32),
}

impl Formula {
    /// The symbol of this name. A name that the parsers would not read becomes an error when a
    /// system is made.
    pub fn symbol(name: &str) -> Formula {
        Formula::leaf(Kind::Symbol(name.to_owned()))
    }

    /// A number, taken exactly. A number that is not finite becomes an error when a system is made.
    pub fn constant(value: impl ToExact) -> Formula {
        Formula::leaf(Kind::Constant(value.to_exact()))
    }

    /// The formula to an integer power; a negative exponent is a power of the reciprocal.
    #[must_use]
    pub fn powi(&self, exponent: i32) -> Formula {
        Formula::node(Kind::Pow(exponent), vec![self.clone()])
    }

    fn leaf(kind: Kind) -> Formula {
        Formula::node(kind, Vec::new())
    }

    fn node(kind: Kind, operands: Vec<Formula>) -> Formula {
        Formula(Arc::new(Node { kind, operands }))
    }

    /// The formula at a node of an arena.
    pub(crate) fn from_arena(arena: &Arena, root: Id) -> Formula {
        let built = Built::new(arena, &[root]);
        built.get(root)
    }
}

impl System {
    /// The system of these equations in named unknowns and parameters.
    ///
    /// # Errors
    /// If a name is used twice, could not be parsed back or is missing from both lists, or if a
    /// constant is not finite.
    pub fn new<U: AsRef<str>, P: AsRef<str>>(
        unknowns: &[U],
        parameters: &[P],
        equations: &[Formula],
    ) -> Result<System, SystemError> {
        let mut arena = Arena::default();
        let mut names: HashMap<&str, Id> = HashMap::new();
        let unknowns = unknowns.iter().map(|name| (name.as_ref(), true));
        for (name, unknown) in unknowns.chain(parameters.iter().map(|name| (name.as_ref(), false))) {
            let id = if unknown { arena.variable(name) } else { arena.parameter(name) };
            if names.insert(name, id).is_some() {
                return Err(SystemError::Duplicate(name.to_owned()));
            }
        }
        let mut lowered = HashMap::new();
        let mut roots = Vec::with_capacity(equations.len());
        for (k, equation) in equations.iter().enumerate() {
            let symbol = |_: &mut Arena, name: &str| names.get(name).copied().ok_or_else(|| name.to_owned());
            let root = lower(&mut arena, &mut lowered, equation, symbol);
            roots.push(root.map_err(|name| SystemError::Undeclared { equation: k + 1, name })?);
        }
        System::from_arena(arena, roots)
    }

    /// The equations as formulas, in order.
    pub fn formulas(&self) -> Vec<Formula> {
        let built = Built::new(&self.arena, &self.equations);
        self.equations.iter().map(|&root| built.get(root)).collect()
    }
}

/// Formulas made from nodes of an arena; equal nodes are shared.
struct Built(Vec<Option<Formula>>);

impl Built {
    fn new(arena: &Arena, roots: &[Id]) -> Built {
        let graph = &arena.graph;
        let used = graph.reachable(roots.iter().copied());
        let mut built: Vec<Option<Formula>> = Vec::with_capacity(graph.len());
        // Operands have smaller indices than the nodes that use them.
        for (k, used) in used.into_iter().enumerate() {
            if !used {
                built.push(None);
                continue;
            }
            let node = graph.node(k as Id);
            let kind = match node {
                graph::Node::Constant(_) => Kind::Constant(graph.as_constant(k as Id).cloned()),
                graph::Node::Variable(j) => Kind::Symbol(arena.variables[j as usize].clone()),
                graph::Node::Parameter(i) => Kind::Symbol(arena.parameters[i as usize].clone()),
                graph::Node::Add(..) => Kind::Add,
                graph::Node::Sub(..) => Kind::Sub,
                graph::Node::Mul(..) => Kind::Mul,
                graph::Node::Div(..) => Kind::Div,
                graph::Node::Neg(_) => Kind::Neg,
                graph::Node::Pow(_, exponent) => Kind::Pow(exponent),
            };
            let operands = node.operands().filter_map(|id| built[id as usize].clone()).collect();
            built.push(Some(Formula::node(kind, operands)));
        }
        Built(built)
    }

    fn get(&self, root: Id) -> Formula {
        self.0[root as usize].clone().unwrap_or_else(|| Formula::constant(0))
    }
}

/// The node of a formula in an arena; `lowered` holds the formulas that were lowered before, by
/// address. Iterative, so that deep formulas do not exhaust the stack.
fn lower<E>(
    arena: &mut Arena,
    lowered: &mut HashMap<*const Node, Id>,
    formula: &Formula,
    mut symbol: impl FnMut(&mut Arena, &str) -> Result<Id, E>,
) -> Result<Id, E> {
    let address = |formula: &Formula| Arc::as_ptr(&formula.0);
    let mut pending = vec![(formula, false)];
    while let Some((formula, operands_done)) = pending.pop() {
        if lowered.contains_key(&address(formula)) {
            continue;
        }
        let node = &*formula.0;
        if !operands_done && !node.operands.is_empty() {
            pending.push((formula, true));
            pending.extend(node.operands.iter().rev().map(|operand| (operand, false)));
            continue;
        }
        let operand = |k: usize| lowered[&address(&node.operands[k])];
        let graph = &mut arena.graph;
        let id = match &node.kind {
            Kind::Constant(Some(value)) => graph.constant(value.clone()),
            Kind::Constant(None) => {
                let zero = graph.constant(Exact::zero());
                arena.non_finite = true;
                zero
            }
            Kind::Symbol(name) => symbol(arena, name)?,
            Kind::Add => graph.add(operand(0), operand(1)),
            Kind::Sub => graph.sub(operand(0), operand(1)),
            Kind::Mul => graph.mul(operand(0), operand(1)),
            Kind::Div => graph.div(operand(0), operand(1)),
            Kind::Neg => graph.neg(operand(0)),
            Kind::Pow(exponent) => graph.pow(operand(0), *exponent),
        };
        lowered.insert(address(formula), id);
    }
    Ok(lowered[&address(formula)])
}

/// An arena with all symbols as unknowns, and the formulas in it.
fn free<const N: usize>(formulas: [&Formula; N]) -> (Arena, [Id; N]) {
    let mut arena = Arena::default();
    let mut lowered = HashMap::new();
    let ids = formulas.map(|formula| {
        let symbol = |arena: &mut Arena, name: &str| Ok::<Id, std::convert::Infallible>(arena.variable(name));
        let Ok(id) = lower(&mut arena, &mut lowered, formula, symbol);
        id
    });
    (arena, ids)
}

impl Drop for Node {
    /// Drops parts that nothing else holds one by one: a long formula would otherwise exhaust the
    /// stack.
    fn drop(&mut self) {
        let mut pending = std::mem::take(&mut self.operands);
        while let Some(formula) = pending.pop() {
            if let Some(mut node) = Arc::into_inner(formula.0) {
                pending.append(&mut node.operands);
            }
        }
    }
}

impl PartialEq for Formula {
    /// Whether both are the same formula after trivial identities; formulas that are equal only
    /// after expansion differ.
    fn eq(&self, other: &Formula) -> bool {
        let (arena, [a, b]) = free([self, other]);
        a == b && !arena.non_finite
    }
}

impl Display for Formula {
    /// The formula as text that parses to a formula with the same values. A formula of more than
    /// 100,000 symbols is cut short by `...`.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (arena, [root]) = free([self]);
        if arena.non_finite {
            return f.write_str("nan");
        }
        display::write_node(f, &arena, root)
    }
}

impl Debug for Formula {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Display::fmt(self, f)
    }
}

impl Neg for Formula {
    type Output = Formula;
    fn neg(self) -> Formula {
        Formula::node(Kind::Neg, vec![self])
    }
}

impl Neg for &Formula {
    type Output = Formula;
    fn neg(self) -> Formula {
        -self.clone()
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for Formula {
            type Output = Formula;
            fn $method(self, other: Formula) -> Formula {
                Formula::node(Kind::$trait, vec![self, other])
            }
        }
        impl $trait<&Formula> for Formula {
            type Output = Formula;
            fn $method(self, other: &Formula) -> Formula {
                $trait::$method(self, other.clone())
            }
        }
        impl $trait<Formula> for &Formula {
            type Output = Formula;
            fn $method(self, other: Formula) -> Formula {
                $trait::$method(self.clone(), other)
            }
        }
        impl $trait for &Formula {
            type Output = Formula;
            fn $method(self, other: &Formula) -> Formula {
                $trait::$method(self.clone(), other.clone())
            }
        }
        operators!(@constants $trait $method: i32, i64, f64, Complex64, BigRational, Exact);
    )*};
    (@constants $trait:ident $method:ident: $($constant:ty),*) => {$(
        impl $trait<$constant> for Formula {
            type Output = Formula;
            fn $method(self, other: $constant) -> Formula {
                $trait::$method(self, Formula::constant(other))
            }
        }
        impl $trait<$constant> for &Formula {
            type Output = Formula;
            fn $method(self, other: $constant) -> Formula {
                $trait::$method(self.clone(), Formula::constant(other))
            }
        }
        impl $trait<Formula> for $constant {
            type Output = Formula;
            fn $method(self, other: Formula) -> Formula {
                $trait::$method(Formula::constant(self), other)
            }
        }
        impl $trait<&Formula> for $constant {
            type Output = Formula;
            fn $method(self, other: &Formula) -> Formula {
                $trait::$method(Formula::constant(self), other.clone())
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Family, Interpreter};

    fn symbols() -> [Formula; 2] {
        ["x", "y"].map(Formula::symbol)
    }

    #[test]
    fn operators_build_what_the_text_says() {
        let [x, y] = symbols();
        let cube = (2.5 * &y - Complex64::new(0.0, 1.0)).powi(3);
        let made: Formula = 7 - (&x + 1) * cube / (x.clone() - &y);
        let read: Formula = "7 - (x + 1)*(5/2*y - i)^3/(x - y)".parse().unwrap();
        assert_eq!(made, read);
        assert_eq!(made.to_string().parse::<Formula>().unwrap(), made);
        assert_ne!(x, y);
        assert!("x = y".parse::<Formula>().is_err());
    }

    #[test]
    fn systems_name_what_is_wrong() {
        let [x, y] = symbols();
        let none: [&str; 0] = [];
        let system = |unknowns: &[&str], equations: &[Formula]| System::new(unknowns, &none, equations);
        assert_eq!(system(&["x", "y"], &[&x - &y]).unwrap().formulas(), [&x - &y]);
        let undeclared = SystemError::Undeclared { equation: 2, name: "y".to_owned() };
        assert_eq!(system(&["x"], &[x.clone(), &x * &y]).unwrap_err(), undeclared);
        assert_eq!(system(&["x", "x"], &[]).unwrap_err(), SystemError::Duplicate("x".to_owned()));
        assert_eq!(system(&["2x"], &[]).unwrap_err(), SystemError::Name("2x".to_owned()));
        assert_eq!(system(&["x"], &[x * f64::NAN]).unwrap_err(), SystemError::NonFinite);
        assert_eq!(Formula::constant(f64::INFINITY).to_string(), "nan");
    }

    #[test]
    fn depth_is_no_concern() {
        let [x, y] = symbols();
        let mut deep = x.clone();
        for _ in 0..200_000 {
            deep = (deep * &y + &x).powi(1) - 1;
        }
        let again = System::new(&["x", "y"], &["p"], &[deep.clone(), deep]).unwrap().formulas();
        assert_eq!(again[0], again[1]);
        assert!(again[0].to_string().ends_with("..."));
    }

    #[test]
    fn what_is_owned_can_be_sent() {
        fn sendable<T: Send + Sync + Clone + 'static>() {}
        sendable::<Formula>();
        sendable::<System>();
        sendable::<Family>();
        sendable::<Interpreter>();
    }
}

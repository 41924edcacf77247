//! Formulas as text that the parsers read back.

use crate::arena::Arena;
use crate::exact::{self, Exact};
use crate::graph::{Id, Node};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use std::fmt::{Display, Formatter, Result, Write};

/// Shared subformulas are printed every time they occur; past this many the text ends in `...`.
const PRINT_LIMIT: usize = 100_000;

/// How tightly a formula binds.
const SUM: u8 = 1;
pub(crate) const PRODUCT: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

enum Task {
    /// Print the node, in parentheses if it binds less tightly.
    Node(Id, u8),
    /// As a term of a sum after the first: with its sign as the operator.
    Term(Id),
    Text(&'static str),
    Exponent(i32),
}

/// Writes one formula; iterative, so that deep formulas do not exhaust the stack.
pub(crate) fn write_node(f: &mut Formatter<'_>, arena: &Arena, root: Id) -> Result {
    let graph = &arena.graph;
    let mut tasks = vec![Task::Node(root, SUM)];
    let mut printed = 0;
    while let Some(task) = tasks.pop() {
        printed += 1;
        if printed > PRINT_LIMIT {
            return f.write_str("...");
        }
        match task {
            Task::Text(text) => f.write_str(text)?,
            Task::Exponent(k) if k < 0 => write!(f, "^({k})")?,
            Task::Exponent(k) => write!(f, "^{k}")?,
            Task::Term(id) => match graph.node(id) {
                Node::Constant(_) if is_negative(graph.as_constant(id)) => {
                    f.write_str(" - ")?;
                    let positive = -graph.as_constant(id).expect("a constant").clone();
                    write_constant(f, &positive, PRODUCT)?;
                }
                Node::Mul(c, y) if is_negative(graph.as_constant(c)) => {
                    f.write_str(" - ")?;
                    let positive = -graph.as_constant(c).expect("a constant").clone();
                    if !positive.is_one() {
                        write_constant(f, &positive, PRODUCT)?;
                        f.write_char('*')?;
                    }
                    tasks.push(Task::Node(y, POWER));
                }
                _ => {
                    f.write_str(" + ")?;
                    tasks.push(Task::Node(id, PRODUCT));
                }
            },
            Task::Node(id, tight) => {
                let binds = match graph.node(id) {
                    Node::Constant(_) => {
                        write_constant(f, graph.as_constant(id).expect("a constant"), tight)?;
                        continue;
                    }
                    Node::Variable(k) => {
                        f.write_str(&arena.variables[k as usize])?;
                        continue;
                    }
                    Node::Parameter(k) => {
                        f.write_str(&arena.parameters[k as usize])?;
                        continue;
                    }
                    Node::Add(..) | Node::Sub(..) | Node::Neg(_) => SUM,
                    Node::Mul(c, _) if is_negative(graph.as_constant(c)) => SUM,
                    Node::Mul(..) | Node::Div(..) => PRODUCT,
                    Node::Pow(..) => POWER,
                };
                let brackets = binds < tight;
                if brackets {
                    f.write_char('(')?;
                    tasks.push(Task::Text(")"));
                }
                match graph.node(id) {
                    Node::Add(a, b) => tasks.extend([Task::Term(b), Task::Node(a, SUM)]),
                    Node::Sub(a, b) => tasks.extend([Task::Node(b, PRODUCT), Task::Text(" - "), Task::Node(a, SUM)]),
                    Node::Neg(a) => tasks.extend([Task::Node(a, PRODUCT), Task::Text("-")]),
                    Node::Mul(a, b) => {
                        let left = if binds == SUM { SUM } else { PRODUCT };
                        tasks.extend([Task::Node(b, POWER), Task::Text("*"), Task::Node(a, left)]);
                    }
                    Node::Div(a, b) => {
                        tasks.extend([Task::Node(b, POWER), Task::Text("/"), Task::Node(a, PRODUCT)]);
                    }
                    Node::Pow(a, k) => tasks.extend([Task::Exponent(k), Task::Node(a, ATOM)]),
                    Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => {}
                }
            }
        }
    }
    Ok(())
}

/// A real constant below zero.
fn is_negative(c: Option<&Exact>) -> bool {
    c.is_some_and(|c| exact::is_real(c) && c.re.is_negative())
}

/// Writes a constant, in parentheses if it binds less tightly than `tight`.
pub(crate) fn write_constant(f: &mut Formatter<'_>, c: &Exact, tight: u8) -> Result {
    let binds = if !exact::is_real(c) {
        if c.re.is_zero() && c.im.is_one() {
            return f.write_char('i');
        }
        SUM
    } else if c.re.is_negative() {
        SUM
    } else if c.re.is_integer() {
        ATOM
    } else {
        PRODUCT
    };
    let text = ConstantText(c);
    if binds < tight || !exact::is_real(c) { write!(f, "({text})") } else { write!(f, "{text}") }
}

struct ConstantText<'a>(&'a Exact);

impl Display for ConstantText<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Exact { re, im } = self.0;
        if im.is_zero() {
            return write!(f, "{re}");
        }
        if !re.is_zero() {
            write!(f, "{re} {} ", if im.is_negative() { '-' } else { '+' })?;
        } else if im.is_negative() {
            f.write_char('-')?;
        }
        let im: BigRational = im.abs();
        if im.is_one() { f.write_char('i') } else { write!(f, "{im}*i") }
    }
}

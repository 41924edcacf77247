//! Like terms: `x + 2*x + 3*y - y` becomes `3*x + 2*y`.

use crate::exact::{self, Exact, FOLD_BITS};
use crate::graph::{Graph, Id, Node};
use num_traits::{One, Zero};
use std::collections::HashMap;

/// Formulas of equal value. Each sum that repeats a term has its terms collected by their
/// coefficients.
///
/// A part of a sum that something else uses too counts as one term, so that nothing is computed
/// twice.
pub(super) fn collect(graph: &Graph, roots: &[Id]) -> (Graph, Vec<Id>) {
    let part = parts_of_sums(graph, roots);
    let mut collected = Graph::default();
    let mut new: Vec<Id> = Vec::with_capacity(graph.len());
    for (id, &is_part) in part.iter().enumerate() {
        let at = |id: Id| new[id as usize];
        let node = graph.node(id as Id);
        let sum =
            if node.is_sum() && !is_part { collect_sum(graph, id as Id, &part, &new, &mut collected) } else { None };
        new.push(match (sum, node) {
            (Some(sum), _) => sum,
            (None, Node::Constant(_)) => collected.constant(graph.as_constant(id as Id).cloned().unwrap_or_default()),
            (None, Node::Variable(_) | Node::Parameter(_)) => collected.push(node),
            (None, Node::Add(a, b)) => collected.add(at(a), at(b)),
            (None, Node::Sub(a, b)) => collected.sub(at(a), at(b)),
            (None, Node::Mul(a, b)) => collected.mul(at(a), at(b)),
            (None, Node::Div(a, b)) => collected.div(at(a), at(b)),
            (None, Node::Neg(a)) => collected.neg(at(a)),
            (None, Node::Pow(a, k)) => collected.pow(at(a), k),
        });
    }
    let roots = roots.iter().map(|&root| new[root as usize]).collect();
    (collected, roots)
}

/// Marks sums whose only use is in another sum.
fn parts_of_sums(graph: &Graph, roots: &[Id]) -> Vec<bool> {
    let uses = graph.uses(roots);
    let mut part = vec![false; graph.len()];
    for id in (0..graph.len()).filter(|&id| uses[id] > 0 && graph.node(id as Id).is_sum()) {
        for operand in graph.node(id as Id).operands() {
            part[operand as usize] = uses[operand as usize] == 1 && graph.node(operand).is_sum();
        }
    }
    part
}

/// The sum with like terms collected, `None` where no term occurs twice.
fn collect_sum(graph: &Graph, sum: Id, part: &[bool], new: &[Id], collected: &mut Graph) -> Option<Id> {
    let one = collected.integer(1);
    let mut terms: Vec<(Id, Exact)> = Vec::new();
    let mut place: HashMap<Id, usize> = HashMap::new();
    let mut merged = false;
    for (id, negative) in graph.terms_of_sum(sum, |id| part[id as usize]) {
        let (formula, coefficient) = coefficient_of(collected, new[id as usize], one);
        let coefficient = if negative { -coefficient } else { coefficient };
        let next = terms.len();
        match place.get(&formula) {
            Some(&k) if exact::bits(&terms[k].1) + exact::bits(&coefficient) <= FOLD_BITS => {
                terms[k].1 += coefficient;
                merged = true;
            }
            _ => {
                place.insert(formula, next);
                terms.push((formula, coefficient));
            }
        }
    }
    if !merged {
        return None;
    }
    let mut total = collected.integer(0);
    for (formula, coefficient) in terms.into_iter().filter(|(_, coefficient)| !coefficient.is_zero()) {
        let coefficient = collected.constant(coefficient);
        let term = collected.mul(coefficient, formula);
        total = collected.add(total, term);
    }
    Some(total)
}

/// A term as a formula and its constant factor; constants are multiples of the formula `one`.
fn coefficient_of(graph: &Graph, term: Id, one: Id) -> (Id, Exact) {
    if let Some(c) = graph.as_constant(term) {
        return (one, c.clone());
    }
    match graph.node(term) {
        Node::Mul(c, formula) => match graph.as_constant(c) {
            Some(c) => (formula, c.clone()),
            None => (term, Exact::one()),
        },
        Node::Neg(formula) => (formula, -Exact::one()),
        _ => (term, Exact::one()),
    }
}

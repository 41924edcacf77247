//! Like terms: `x + 2*x + 3*y - y` becomes `3*x + 2*y`.

use crate::exact::{self, Exact, FOLD_BITS};
use crate::graph::{Graph, Id, Node};
use num_traits::{One, Zero};
use std::collections::HashMap;

/// The same formulas with the terms of every sum that repeats one collected by their coefficients.
///
/// Parts of a sum that something else uses as well count as one term, so that nothing is computed twice.
pub(super) fn collect(graph: &Graph, roots: &[Id]) -> (Graph, Vec<Id>) {
    let part = parts_of_sums(graph, roots);
    let mut collected = Graph::default();
    let mut new: Vec<Id> = Vec::with_capacity(graph.len());
    for (id, &is_part) in part.iter().enumerate() {
        let at = |id: Id| new[id as usize];
        let node = graph.node(id as Id);
        let sum =
            if is_sum(node) && !is_part { collect_sum(graph, id as Id, &part, &new, &mut collected) } else { None };
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

fn is_sum(node: Node) -> bool {
    matches!(node, Node::Add(..) | Node::Sub(..) | Node::Neg(_))
}

/// Marks sums whose only use is in another sum.
fn parts_of_sums(graph: &Graph, roots: &[Id]) -> Vec<bool> {
    let used = graph.reachable(roots.iter().copied());
    let mut uses = vec![0u32; graph.len()];
    let mut in_sum = vec![false; graph.len()];
    for &root in roots {
        uses[root as usize] += 1;
    }
    for id in (0..graph.len()).filter(|&id| used[id]) {
        let node = graph.node(id as Id);
        for operand in node.operands() {
            uses[operand as usize] = uses[operand as usize].saturating_add(1);
            in_sum[operand as usize] = is_sum(node);
        }
    }
    (0..graph.len()).map(|id| is_sum(graph.node(id as Id)) && uses[id] == 1 && in_sum[id]).collect()
}

/// The sum with like terms collected, `None` where no term occurs twice.
fn collect_sum(graph: &Graph, sum: Id, part: &[bool], new: &[Id], collected: &mut Graph) -> Option<Id> {
    let one = collected.integer(1);
    let mut terms: Vec<(Id, Exact)> = Vec::new();
    let mut place: HashMap<Id, usize> = HashMap::new();
    let mut merged = false;
    let mut stack = vec![(sum, false)];
    while let Some((id, negative)) = stack.pop() {
        if id == sum || part[id as usize] {
            // The first operand is met first, so it is pushed last.
            match graph.node(id) {
                Node::Add(a, b) => stack.extend([(b, negative), (a, negative)]),
                Node::Sub(a, b) => stack.extend([(b, !negative), (a, negative)]),
                Node::Neg(a) => stack.push((a, !negative)),
                _ => {}
            }
            continue;
        }
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

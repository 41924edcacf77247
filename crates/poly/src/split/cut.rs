//! Formulas cut as they are written: the largest parts that know no unknowns become parameters.

use super::pieces::{MOST_DEGREE, Pieces};
use crate::graph::{Graph, Id, Node};
use crate::system::System;

/// What a formula is, as far as a cut is concerned.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// A polynomial in the parameters alone, of this degree; a constant has degree 0.
    Part(u32),
    /// Anything else.
    Other,
}

/// The system cut where formulas begin to depend on unknowns, or are no polynomials of low degree in the
/// parameters; `None` if no formula is cut off.
pub(super) fn cut(system: &System) -> Option<Pieces> {
    let graph = &system.arena.graph;
    let kinds = kinds(graph);
    let used = graph.reachable(system.equations.iter().copied());
    let mut wanted = vec![false; graph.len()];
    let cut_off = |id: Id| matches!(kinds[id as usize], Kind::Part(degree) if degree > 0);
    for id in (0..graph.len()).filter(|&id| used[id] && kinds[id] == Kind::Other) {
        graph.node(id as Id).operands().filter(|&k| cut_off(k)).for_each(|k| wanted[k as usize] = true);
    }
    system.equations.iter().filter(|&&root| cut_off(root)).for_each(|&root| wanted[root as usize] = true);

    let mut rest = Graph::default();
    let mut new: Vec<Id> = Vec::with_capacity(graph.len());
    let mut roots = Vec::new();
    for (id, &wanted) in wanted.iter().enumerate() {
        let at = |id: Id| new[id as usize];
        let copy = match (graph.node(id as Id), kinds[id]) {
            (_, Kind::Part(degree)) if wanted => {
                roots.push((id as Id, degree));
                rest.push(Node::Parameter(roots.len() as u32 - 1))
            }
            // Not used any more, unless it is a constant.
            (Node::Constant(_), _) => rest.constant(graph.as_constant(id as Id).cloned().unwrap_or_default()),
            (_, Kind::Part(_)) => rest.integer(0),
            (Node::Variable(k), _) => rest.push(Node::Variable(k)),
            (Node::Parameter(_), _) => rest.integer(0),
            (Node::Add(a, b), _) => rest.add(at(a), at(b)),
            (Node::Sub(a, b), _) => rest.sub(at(a), at(b)),
            (Node::Mul(a, b), _) => rest.mul(at(a), at(b)),
            (Node::Div(a, b), _) => rest.div(at(a), at(b)),
            (Node::Neg(a), _) => rest.neg(at(a)),
            (Node::Pow(a, k), _) => rest.pow(at(a), k),
        };
        new.push(copy);
    }
    if roots.is_empty() {
        return None;
    }
    let equations = system.equations.iter().map(|&root| new[root as usize]).collect();
    Some(Pieces { parts: graph.clone(), roots, rest, equations })
}

fn kinds(graph: &Graph) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::with_capacity(graph.len());
    for id in 0..graph.len() {
        let degree = |id: Id| match kinds[id as usize] {
            Kind::Part(degree) => Some(degree),
            Kind::Other => None,
        };
        let found = match graph.node(id as Id) {
            Node::Constant(_) => Some(0),
            Node::Parameter(_) => Some(1),
            Node::Variable(_) => None,
            Node::Add(a, b) | Node::Sub(a, b) => degree(a).zip(degree(b)).map(|(a, b)| a.max(b)),
            Node::Mul(a, b) => degree(a).zip(degree(b)).map(|(a, b)| a.saturating_add(b)),
            Node::Neg(a) => degree(a),
            Node::Div(a, b) => degree(a).filter(|_| degree(b) == Some(0) && !graph.is_zero(b)),
            Node::Pow(a, k) => match degree(a) {
                Some(0) if !graph.is_zero(a) => Some(0),
                Some(degree) => u32::try_from(k).ok().map(|k| degree.saturating_mul(k)),
                None => None,
            },
        };
        kinds.push(found.filter(|&degree| degree <= MOST_DEGREE).map_or(Kind::Other, Kind::Part));
    }
    kinds
}

//! Jacobians as formulas: reverse mode row by row, forward mode column by column.

use crate::graph::{Graph, Id, Node};

/// For each node, whether some unknown occurs in it.
fn depends_on_variables(graph: &Graph) -> Vec<bool> {
    let mut depends = vec![false; graph.len()];
    for id in 0..graph.len() {
        let node = graph.node(id as Id);
        depends[id] = matches!(node, Node::Variable(_)) || node.operands().any(|k| depends[k as usize]);
    }
    depends
}

/// Structurally nonzero derivatives of the roots: `(root, variable, formula)`.
pub(crate) type Entries = Vec<(usize, u32, Id)>;

/// One sweep per root, from the root down.
pub(crate) fn reverse(graph: &mut Graph, roots: &[Id]) -> Entries {
    let depends = depends_on_variables(graph);
    let mut entries = Entries::new();
    let mut adjoint: Vec<Option<Id>> = vec![None; graph.len()];
    for (row, &root) in roots.iter().enumerate() {
        if !depends[root as usize] {
            continue;
        }
        let one = graph.integer(1);
        adjoint[root as usize] = Some(one);
        let mut found = Vec::new();
        for id in (0..=root).rev() {
            let Some(w) = adjoint[id as usize].take() else { continue };
            if graph.is_zero(w) {
                continue;
            }
            let mut give = |graph: &mut Graph, operand: Id, derivative: &dyn Fn(&mut Graph) -> Id| {
                if depends[operand as usize] {
                    let term = derivative(graph);
                    let slot = &mut adjoint[operand as usize];
                    *slot = Some(slot.map_or(term, |sum| graph.add(sum, term)));
                }
            };
            match graph.node(id) {
                Node::Constant(_) | Node::Parameter(_) => {}
                Node::Variable(k) => found.push((row, k, w)),
                Node::Add(a, b) => {
                    give(graph, a, &|_| w);
                    give(graph, b, &|_| w);
                }
                Node::Sub(a, b) => {
                    give(graph, a, &|_| w);
                    give(graph, b, &|g| g.neg(w));
                }
                Node::Neg(a) => give(graph, a, &|g| g.neg(w)),
                Node::Mul(a, b) => {
                    give(graph, a, &|g| g.mul(w, b));
                    give(graph, b, &|g| g.mul(w, a));
                }
                Node::Div(a, b) => {
                    let reciprocal = graph.pow(b, -1);
                    let scaled = graph.mul(w, reciprocal);
                    give(graph, a, &|_| scaled);
                    give(graph, b, &|g| {
                        let product = g.mul(scaled, id);
                        g.neg(product)
                    });
                }
                Node::Pow(a, k) => give(graph, a, &|g| {
                    let slope = power_slope(g, a, k);
                    g.mul(w, slope)
                }),
            }
        }
        found.sort_by_key(|&(_, k, _)| k);
        entries.extend(found);
    }
    entries
}

/// `k * a^(k-1)`
fn power_slope(graph: &mut Graph, a: Id, k: i32) -> Id {
    let factor = graph.integer(i64::from(k));
    // The smallest 32-bit exponent cannot be lowered by one; the parser does not admit it.
    let power = graph.pow(a, k.saturating_sub(1));
    graph.mul(factor, power)
}

/// One sweep per unknown, from the unknown up.
pub(crate) fn forward(graph: &mut Graph, roots: &[Id], variables: usize) -> Entries {
    let depends = depends_on_variables(graph);
    let count = graph.len();
    let used = graph.reachable(roots.iter().copied());
    let mut entries = Entries::new();
    for variable in 0..variables as u32 {
        let mut tangent: Vec<Option<Id>> = vec![None; count];
        for id in 0..count {
            if !used[id] || !depends[id] {
                continue;
            }
            let t = |k: Id| tangent[k as usize];
            tangent[id] = match graph.node(id as Id) {
                Node::Constant(_) | Node::Parameter(_) => None,
                Node::Variable(k) => (k == variable).then(|| graph.integer(1)),
                Node::Add(a, b) => sum(graph, t(a), t(b)),
                Node::Sub(a, b) => {
                    let negative = t(b).map(|d| graph.neg(d));
                    sum(graph, t(a), negative)
                }
                Node::Neg(a) => t(a).map(|d| graph.neg(d)),
                Node::Mul(a, b) => {
                    let left = t(a).map(|d| graph.mul(d, b));
                    let right = t(b).map(|d| graph.mul(d, a));
                    sum(graph, left, right)
                }
                Node::Div(a, b) => {
                    let bend = t(b).map(|d| {
                        let product = graph.mul(d, id as Id);
                        graph.neg(product)
                    });
                    sum(graph, t(a), bend).map(|d| {
                        let reciprocal = graph.pow(b, -1);
                        graph.mul(d, reciprocal)
                    })
                }
                Node::Pow(a, k) => t(a).map(|d| {
                    let slope = power_slope(graph, a, k);
                    graph.mul(slope, d)
                }),
            };
        }
        for (row, &root) in roots.iter().enumerate() {
            if let Some(d) = tangent[root as usize].filter(|&d| !graph.is_zero(d)) {
                entries.push((row, variable, d));
            }
        }
    }
    entries.sort_by_key(|&(row, k, _)| (row, k));
    entries
}

fn sum(graph: &mut Graph, a: Option<Id>, b: Option<Id>) -> Option<Id> {
    match (a, b) {
        (Some(a), Some(b)) => Some(graph.add(a, b)),
        (a, b) => a.or(b),
    }
}

//! What formulas are stored in: the graph and the names of its leaves.

use crate::graph::{Graph, Id, Node};
use std::collections::HashMap;

/// A graph with the names of its unknowns and parameters, each list in order of first mention.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arena {
    pub(crate) graph: Graph,
    pub(crate) variables: Vec<String>,
    pub(crate) parameters: Vec<String>,
    /// Places of the names in the two lists.
    variable_index: HashMap<String, u32>,
    parameter_index: HashMap<String, u32>,
    /// A constant was not finite; reported when the system is made.
    pub(crate) non_finite: bool,
}

impl Arena {
    pub(crate) fn variable(&mut self, name: &str) -> Id {
        let k = position_or_push(&mut self.variables, &mut self.variable_index, name);
        self.graph.push(Node::Variable(k))
    }

    pub(crate) fn parameter(&mut self, name: &str) -> Id {
        let k = position_or_push(&mut self.parameters, &mut self.parameter_index, name);
        self.graph.push(Node::Parameter(k))
    }
}

fn position_or_push(names: &mut Vec<String>, index: &mut HashMap<String, u32>, name: &str) -> u32 {
    if let Some(&k) = index.get(name) {
        return k;
    }
    let k = u32::try_from(names.len()).expect("fewer than 2^32 names");
    names.push(name.to_owned());
    index.insert(name.to_owned(), k);
    k
}

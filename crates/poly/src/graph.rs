//! The hash-consed graph behind expressions: equal formulas are one node, constants are folded.

use crate::exact::{self, Exact, FOLD_BITS};
use num_traits::{One, Zero};
use std::collections::HashMap;

/// Index of a node; operands have smaller indices than the node that uses them.
pub(crate) type Id = u32;

/// One operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    Constant(u32),
    Variable(u32),
    Parameter(u32),
    Add(Id, Id),
    Sub(Id, Id),
    Mul(Id, Id),
    Div(Id, Id),
    Neg(Id),
    Pow(Id, i32),
}

impl Node {
    /// Operands of the node.
    pub(crate) fn operands(self) -> impl Iterator<Item = Id> {
        let (a, b) = match self {
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => (None, None),
            Node::Add(a, b) | Node::Sub(a, b) | Node::Mul(a, b) | Node::Div(a, b) => (Some(a), Some(b)),
            Node::Neg(a) | Node::Pow(a, _) => (Some(a), None),
        };
        a.into_iter().chain(b)
    }

    /// Whether the node is a sum, a difference or a change of sign.
    pub(crate) fn is_sum(self) -> bool {
        matches!(self, Node::Add(..) | Node::Sub(..) | Node::Neg(_))
    }

    /// Commutative operations are looked up with sorted operands.
    fn key(self) -> Node {
        match self {
            Node::Add(a, b) if b < a => Node::Add(b, a),
            Node::Mul(a, b) if b < a => Node::Mul(b, a),
            node => node,
        }
    }
}

/// An arena of nodes in topological order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    index: HashMap<Node, Id>,
    constants: Vec<Exact>,
    constant_index: HashMap<Exact, u32>,
}

impl Graph {
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn node(&self, id: Id) -> Node {
        self.nodes[id as usize]
    }

    /// The value of a constant node.
    pub(crate) fn as_constant(&self, id: Id) -> Option<&Exact> {
        match self.node(id) {
            Node::Constant(k) => Some(&self.constants[k as usize]),
            _ => None,
        }
    }

    pub(crate) fn push(&mut self, node: Node) -> Id {
        let next = Id::try_from(self.nodes.len()).expect("fewer than 2^32 nodes");
        let id = *self.index.entry(node.key()).or_insert(next);
        if id == next {
            self.nodes.push(node);
        }
        id
    }

    pub(crate) fn constant(&mut self, value: Exact) -> Id {
        let k = match self.constant_index.get(&value) {
            Some(&k) => k,
            None => {
                let k = u32::try_from(self.constants.len()).expect("fewer than 2^32 constants");
                self.constants.push(value.clone());
                self.constant_index.insert(value, k);
                k
            }
        };
        self.push(Node::Constant(k))
    }

    pub(crate) fn integer(&mut self, k: i64) -> Id {
        self.constant(exact::from_i64(k))
    }

    /// Both operands, when both are constants small enough to be combined.
    fn foldable(&self, a: Id, b: Id) -> Option<(Exact, Exact)> {
        let (a, b) = (self.as_constant(a)?, self.as_constant(b)?);
        (exact::bits(a) + exact::bits(b) <= FOLD_BITS).then(|| (a.clone(), b.clone()))
    }

    pub(crate) fn is_zero(&self, a: Id) -> bool {
        self.as_constant(a).is_some_and(Zero::is_zero)
    }

    pub(crate) fn add(&mut self, a: Id, b: Id) -> Id {
        if let Some((x, y)) = self.foldable(a, b) {
            return self.constant(x + y);
        }
        if self.is_zero(a) {
            return b;
        }
        if self.is_zero(b) {
            return a;
        }
        if a == b {
            let two = self.integer(2);
            return self.mul(two, a);
        }
        match (self.node(a), self.node(b)) {
            (_, Node::Neg(c)) => self.sub(a, c),
            (Node::Neg(c), _) => self.sub(b, c),
            _ => self.push(Node::Add(a, b)),
        }
    }

    pub(crate) fn sub(&mut self, a: Id, b: Id) -> Id {
        if a == b {
            return self.integer(0);
        }
        if let Some(c) = self.as_constant(b) {
            let negative = self.negative_constant(c.clone());
            return self.add(a, negative);
        }
        if self.is_zero(a) {
            return self.neg(b);
        }
        match (self.node(a), self.node(b)) {
            (_, Node::Neg(c)) => self.add(a, c),
            (Node::Neg(c), _) => {
                let sum = self.add(c, b);
                self.neg(sum)
            }
            _ => self.push(Node::Sub(a, b)),
        }
    }

    fn negative_constant(&mut self, c: Exact) -> Id {
        self.constant(-c)
    }

    pub(crate) fn neg(&mut self, a: Id) -> Id {
        match self.node(a) {
            Node::Constant(k) => self.negative_constant(self.constants[k as usize].clone()),
            Node::Neg(c) => c,
            Node::Sub(x, y) => self.sub(y, x),
            Node::Mul(c, y) if self.as_constant(c).is_some() => {
                let c = self.neg(c);
                self.mul(c, y)
            }
            _ => self.push(Node::Neg(a)),
        }
    }

    pub(crate) fn mul(&mut self, a: Id, b: Id) -> Id {
        if let Some((x, y)) = self.foldable(a, b) {
            return self.constant(x * y);
        }
        if self.as_constant(b).is_some() && self.as_constant(a).is_none() {
            return self.mul(b, a);
        }
        if let Some(c) = self.as_constant(a) {
            if c.is_zero() {
                return a;
            }
            if c.is_one() {
                return b;
            }
            let minus_one = (-c.clone()).is_one();
            return match self.node(b) {
                Node::Neg(y) => {
                    let c = self.neg(a);
                    self.mul(c, y)
                }
                Node::Mul(c2, y) if self.foldable(a, c2).is_some() => {
                    let c = self.mul(a, c2);
                    self.mul(c, y)
                }
                _ if minus_one => self.neg(b),
                _ => self.push(Node::Mul(a, b)),
            };
        }
        match (self.node(a), self.node(b)) {
            (Node::Neg(x), _) => {
                let product = self.mul(x, b);
                self.neg(product)
            }
            (_, Node::Neg(y)) => {
                let product = self.mul(a, y);
                self.neg(product)
            }
            (Node::Mul(c, x), _) if self.as_constant(c).is_some() && !self.is_scaled(x) => {
                let product = self.mul(x, b);
                self.mul(c, product)
            }
            (_, Node::Mul(c, y)) if self.as_constant(c).is_some() && !self.is_scaled(y) => {
                let product = self.mul(a, y);
                self.mul(c, product)
            }
            _ => self.mul_powers(a, b),
        }
    }

    /// A constant times something: nested only where constants are too large to be folded, and
    /// then left nested, so that the recursion of [`mul`](Graph::mul) stays shallow.
    fn is_scaled(&self, id: Id) -> bool {
        matches!(self.node(id), Node::Mul(c, _) if self.as_constant(c).is_some())
    }

    /// `x^j * x^k = x^(j+k)` for positive exponents.
    fn mul_powers(&mut self, a: Id, b: Id) -> Id {
        let split = |graph: &Graph, id| match graph.node(id) {
            Node::Pow(x, k) if k > 0 => (x, k),
            _ => (id, 1),
        };
        let ((x, j), (y, k)) = (split(self, a), split(self, b));
        match j.checked_add(k) {
            Some(sum) if x == y => self.pow(x, sum),
            _ => self.push(Node::Mul(a, b)),
        }
    }

    pub(crate) fn div(&mut self, a: Id, b: Id) -> Id {
        if let Some(c) = self.as_constant(b) {
            if c.is_zero() {
                return self.push(Node::Div(a, b));
            }
            if exact::bits(c) <= FOLD_BITS {
                let inverse = Exact::one() / c;
                let inverse = self.constant(inverse);
                return self.mul(inverse, a);
            }
        }
        if self.is_zero(a) {
            return a;
        }
        match (self.node(a), self.node(b)) {
            (Node::Neg(x), _) => {
                let quotient = self.div(x, b);
                self.neg(quotient)
            }
            (_, Node::Neg(y)) => {
                let quotient = self.div(a, y);
                self.neg(quotient)
            }
            _ => self.push(Node::Div(a, b)),
        }
    }

    pub(crate) fn pow(&mut self, a: Id, k: i32) -> Id {
        if k == 0 {
            return self.integer(1);
        }
        if k == 1 {
            return a;
        }
        if let Some(c) = self.as_constant(a) {
            // Zero and one stay what they are however high the power; a zero left in a power would
            // not be seen as one.
            if c.is_one() || (k > 0 && c.is_zero()) {
                return a;
            }
            if exact::bits(c).saturating_mul(u64::from(k.unsigned_abs())) <= FOLD_BITS && !c.is_zero() {
                let power = exact::pow(c, k);
                return self.constant(power);
            }
        }
        match self.node(a) {
            Node::Pow(x, j) if j.checked_mul(k).is_some() => self.pow(x, j * k),
            Node::Neg(x) => {
                let power = self.pow(x, k);
                if k % 2 == 0 { power } else { self.neg(power) }
            }
            _ => self.push(Node::Pow(a, k)),
        }
    }

    /// The same formulas with parameter `place[i]` in place of parameter `i`; no two places are equal.
    pub(crate) fn renumbered(mut self, place: &[u32]) -> Graph {
        for node in &mut self.nodes {
            if let Node::Parameter(k) = node {
                *k = place[*k as usize];
            }
        }
        self.index = self.nodes.iter().map(|node| node.key()).zip(0..).collect();
        self
    }

    /// Marks every node that the roots depend on.
    pub(crate) fn reachable(&self, roots: impl IntoIterator<Item = Id>) -> Vec<bool> {
        let mut seen = vec![false; self.len()];
        for root in roots {
            seen[root as usize] = true;
        }
        for id in (0..self.len()).rev() {
            if seen[id] {
                for operand in self.nodes[id].operands() {
                    seen[operand as usize] = true;
                }
            }
        }
        seen
    }

    /// How often each node is a root or an operand of a node that the roots depend on; zero for all
    /// others.
    pub(crate) fn uses(&self, roots: &[Id]) -> Vec<u32> {
        let used = self.reachable(roots.iter().copied());
        let mut uses = vec![0u32; self.len()];
        let operands = (0..self.len()).filter(|&id| used[id]).flat_map(|id| self.nodes[id].operands());
        for id in operands.chain(roots.iter().copied()) {
            uses[id as usize] = uses[id as usize].saturating_add(1);
        }
        uses
    }

    /// The terms of a sum from first to last, each with whether it is subtracted. An inner sum is a
    /// term itself, unless it is `part` of the outer sum.
    pub(crate) fn terms_of_sum(&self, sum: Id, part: impl Fn(Id) -> bool) -> Vec<(Id, bool)> {
        let mut terms = Vec::new();
        let mut stack = vec![(sum, false)];
        while let Some((id, negative)) = stack.pop() {
            let open = id == sum || part(id);
            // The first operand is met first, so it is pushed last.
            match self.node(id) {
                Node::Add(a, b) if open => stack.extend([(b, negative), (a, negative)]),
                Node::Sub(a, b) if open => stack.extend([(b, !negative), (a, negative)]),
                Node::Neg(a) if open => stack.push((a, !negative)),
                _ => terms.push((id, negative)),
            }
        }
        terms
    }
}

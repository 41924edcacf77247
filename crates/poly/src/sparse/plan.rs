//! The kernel's work, planned once: the table of powers, the tree of prefixes, and each row's
//! sweep.

use super::error::SupportError;
use crate::program::generated::TaylorTape;
use crate::program::{Op, Operand, TapeWriter};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ops::Range;

/// No coefficient.
pub(super) const NONE: u32 = u32::MAX;

/// How an entry of the table of powers is made from earlier ones.
#[derive(Clone, Copy, Debug)]
pub(super) enum Power {
    /// The unknown whose index is the entry's.
    Unknown,
    Inverse(u32),
    Square(u32),
    Product(u32, u32),
}

/// A prefix of monomials: its parent times a power.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) parent: u32,
    pub(super) power: u32,
}

/// One node of a row's sweep, children before parents.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) node: u32,
    pub(super) parent: u32,
    pub(super) power: u32,
    /// The coefficient of a leaf, [`NONE`] for nodes with children.
    pub(super) coefficient: u32,
    /// The parent's own coefficient or [`NONE`].
    pub(super) parent_coefficient: u32,
    /// Whether this is the parent's first child.
    pub(super) first: bool,
    /// Whether the row meets this power for the first time.
    pub(super) first_power: bool,
}

/// A power `x^e` that occurs in a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub(super) power: u32,
    pub(super) unknown: u32,
    pub(super) exponent: i32,
    /// Where `x^(e-1)` is; meaningless for `e = 1`.
    pub(super) lower: u32,
    /// Whether it is the first power of its unknown in the row.
    pub(super) first: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) terms: Range<usize>,
    pub(super) steps: Vec<Step>,
    pub(super) slopes: Vec<Slope>,
    /// Coefficient of the constant term or [`NONE`].
    pub(super) constant: u32,
}

#[derive(Debug)]
pub(super) struct Plan {
    pub(super) variables: usize,
    pub(super) terms: usize,
    pub(super) powers: Vec<Power>,
    /// Node 0 is the empty product.
    pub(super) nodes: Vec<Node>,
    pub(super) rows: Vec<Row>,
    /// Entries of the Jacobian that are always zero.
    pub(super) zeros: Vec<u32>,
    pub(super) taylor: TaylorTape,
}

/// The table of powers under construction.
struct Powers {
    entries: Vec<Power>,
    index: HashMap<(u32, i32), u32>,
}

impl Powers {
    /// The entry of `x^e` for `e != 0`, by squaring.
    fn entry(&mut self, unknown: u32, e: i32) -> u32 {
        if let Some(&k) = self.index.get(&(unknown, e)) {
            return k;
        }
        let sign = e.signum();
        let power = if e == -1 {
            Power::Inverse(self.entry(unknown, 1))
        } else if e % 2 == 0 {
            Power::Square(self.entry(unknown, e / 2))
        } else {
            Power::Product(self.entry(unknown, e - sign), self.entry(unknown, sign))
        };
        self.entries.push(power);
        let k = (self.entries.len() - 1) as u32;
        self.index.insert((unknown, e), k);
        k
    }
}

impl Plan {
    pub(super) fn new(variables: usize, supports: &[Vec<Vec<i32>>]) -> Result<Plan, SupportError> {
        check(variables, supports)?;
        let mut powers = Powers {
            entries: vec![Power::Unknown; variables],
            index: (0..variables as u32).map(|j| ((j, 1), j)).collect(),
        };
        let mut nodes = vec![Node { parent: 0, power: 0 }];
        let mut children: HashMap<(u32, u32), u32> = HashMap::new();
        let mut rows = Vec::with_capacity(supports.len());
        let mut begin = 0;
        for support in supports {
            // The node at which each term ends, and its coefficient.
            let mut coefficients: BTreeMap<u32, u32> = BTreeMap::new();
            let mut exponents: BTreeMap<u32, (u32, i32)> = BTreeMap::new();
            for (k, term) in support.iter().enumerate() {
                let mut node = 0;
                for (unknown, &e) in (0u32..).zip(term).filter(|(_, e)| **e != 0) {
                    let power = powers.entry(unknown, e);
                    exponents.insert(power, (unknown, e));
                    node = *children.entry((node, power)).or_insert_with(|| {
                        nodes.push(Node { parent: node, power });
                        (nodes.len() - 1) as u32
                    });
                }
                coefficients.insert(node, (begin + k) as u32);
            }
            let slopes = slopes(&mut powers, &exponents);
            let terms = begin..begin + support.len();
            begin = terms.end;
            let constant = coefficients.get(&0).copied().unwrap_or(NONE);
            rows.push(Row { terms, steps: steps(&nodes, &coefficients), slopes, constant });
        }
        let written: HashSet<u32> = (0u32..)
            .zip(&rows)
            .flat_map(|(i, row)| row.slopes.iter().map(move |slope| (i, slope.unknown)))
            .map(|(i, unknown)| unknown * rows.len() as u32 + i)
            .collect();
        let zeros = (0..(variables * rows.len()) as u32).filter(|entry| !written.contains(entry)).collect();
        let taylor = taylor(variables, begin, &powers.entries, &rows);
        Ok(Plan { variables, terms: begin, powers: powers.entries, nodes, rows, zeros, taylor })
    }
}

fn check(variables: usize, supports: &[Vec<Vec<i32>>]) -> Result<(), SupportError> {
    for (i, support) in supports.iter().enumerate() {
        let mut seen = HashSet::new();
        for (k, term) in support.iter().enumerate() {
            let (equation, place) = (i + 1, k + 1);
            if term.len() != variables {
                return Err(SupportError::Length { equation, term: place, found: term.len(), expected: variables });
            }
            if term.contains(&i32::MIN) {
                return Err(SupportError::Exponent { equation, term: place });
            }
            if !seen.insert(term) {
                return Err(SupportError::Repeated { equation, term: place });
            }
        }
    }
    Ok(())
}

/// The sweep over all nodes that a row's terms pass through.
fn steps(nodes: &[Node], coefficients: &BTreeMap<u32, u32>) -> Vec<Step> {
    let mut used = BTreeSet::new();
    for &end in coefficients.keys() {
        let mut node = end;
        while node != 0 && used.insert(node) {
            node = nodes[node as usize].parent;
        }
    }
    let coefficient = |node: u32| coefficients.get(&node).copied().unwrap_or(NONE);
    let (mut parents, mut met) = (HashSet::new(), HashSet::new());
    // Children have larger indices than their parents.
    used.into_iter()
        .rev()
        .map(|node| {
            let Node { parent, power } = nodes[node as usize];
            // A node with children has begun with its own coefficient when the first of them came
            // by.
            let has_children = parents.contains(&node);
            Step {
                node,
                parent,
                power,
                coefficient: if has_children { NONE } else { coefficient(node) },
                parent_coefficient: coefficient(parent),
                first: parents.insert(parent),
                first_power: met.insert(power),
            }
        })
        .collect()
}

fn slopes(powers: &mut Powers, exponents: &BTreeMap<u32, (u32, i32)>) -> Vec<Slope> {
    let mut unknowns = HashSet::new();
    exponents
        .iter()
        .map(|(&power, &(unknown, exponent))| Slope {
            power,
            unknown,
            exponent,
            lower: if exponent == 1 { 0 } else { powers.entry(unknown, exponent - 1) },
            first: unknowns.insert(unknown),
        })
        .collect()
}

/// The sweep as instructions, for Taylor coefficients.
fn taylor(variables: usize, terms: usize, powers: &[Power], rows: &[Row]) -> TaylorTape {
    let mut writer = TapeWriter::default();
    let mut table: Vec<Operand> = Vec::with_capacity(powers.len());
    for (k, power) in powers.iter().enumerate() {
        let operand = match *power {
            Power::Unknown => Operand::Variable(k as u32),
            Power::Inverse(a) => writer.push(Op::Inv, &[table[a as usize]]),
            Power::Square(a) => writer.push(Op::Sqr, &[table[a as usize]]),
            Power::Product(a, b) => writer.push(Op::Mul, &[table[a as usize], table[b as usize]]),
        };
        table.push(operand);
    }
    let mut outputs = Vec::with_capacity(rows.len());
    for row in rows {
        let mut sums: HashMap<u32, Operand> = HashMap::new();
        for step in &row.steps {
            let a = match step.coefficient {
                NONE => sums[&step.node],
                k => Operand::Parameter(k),
            };
            let power = table[step.power as usize];
            let sum = if !step.first {
                writer.push(Op::MulAdd, &[a, power, sums[&step.parent]])
            } else if step.parent_coefficient != NONE {
                writer.push(Op::MulAdd, &[a, power, Operand::Parameter(step.parent_coefficient)])
            } else {
                writer.push(Op::Mul, &[a, power])
            };
            sums.insert(step.parent, sum);
        }
        outputs.push(match (sums.get(&0), row.constant) {
            (Some(&sum), _) => sum,
            (None, NONE) => writer.zero(),
            (None, k) => Operand::Parameter(k),
        });
    }
    writer.finish(outputs, terms, variables)
}

//! Formulas expanded, collected by monomials in the unknowns, and nested: a multivariate Horner scheme.
//!
//! The unknown that occurs in most terms is taken out of these, again and again. This greedy choice is that of
//! Ceberio and Kreinovich, *Greedy algorithms for optimizing multivariate Horner schemes* (2004).

use super::pieces::{MOST_DEGREE, Pieces};
use crate::exact::Exact;
use crate::expand::ExpandLimits;
use crate::graph::{Graph, Id, Node};
use crate::polynomial::Polynomial;
use crate::system::System;
use num_traits::{Signed, Zero};
use std::collections::{BTreeMap, HashMap};

/// Limits within which families are expanded to see whether that helps: some hundredths of a second.
const LIMITS: ExpandLimits = ExpandLimits { terms: 20_000, work: 100_000, bits: 1 << 12 };

/// A term: the exponents of the unknowns, and the formula of its coefficient.
type Term = (Vec<i32>, Id);

/// A polynomial in the parameters: their exponents and the constant of each term.
type Coefficient = Vec<(Vec<i32>, Exact)>;

/// The expanded system with the coefficients of its terms as parts; `None` if it is not expanded within limits, or has
/// negative exponents or coefficients of high degree.
pub(super) fn nested(system: &System) -> Option<Pieces> {
    let polynomials = system.expand(&LIMITS).ok()?;
    let unknowns = system.variables().len();
    let mut pieces =
        Pieces { parts: Graph::default(), roots: Vec::new(), rest: Graph::default(), equations: Vec::new() };
    let mut known: HashMap<Id, u32> = HashMap::new();
    for polynomial in &polynomials {
        let mut terms: Vec<Term> = Vec::new();
        for (monomial, coefficient) in collected(polynomial, unknowns)? {
            let coefficient = pieces.coefficient(coefficient, &mut known)?;
            terms.push((monomial, coefficient));
        }
        let equation = nest(&mut pieces.rest, &|graph, j| graph.push(Node::Variable(j)), terms);
        pieces.equations.push(equation);
    }
    Some(pieces)
}

/// The terms by their monomials in the unknowns, each with the terms of its coefficient in the parameters.
fn collected(polynomial: &Polynomial<Exact>, unknowns: usize) -> Option<BTreeMap<Vec<i32>, Coefficient>> {
    let mut terms: BTreeMap<Vec<i32>, Coefficient> = BTreeMap::new();
    for (monomial, c) in polynomial.terms() {
        if monomial.exponents().iter().any(|&e| e < 0) {
            return None;
        }
        let (x, p) = monomial.exponents().split_at(unknowns);
        terms.entry(x.to_vec()).or_default().push((p.to_vec(), c.clone()));
    }
    Some(terms)
}

impl Pieces {
    /// The formula of a coefficient among the equations: a constant, or a part or its negative.
    fn coefficient(&mut self, terms: Coefficient, known: &mut HashMap<Id, u32>) -> Option<Id> {
        let degree = |(p, _): &(Vec<i32>, Exact)| p.iter().try_fold(0u32, |sum, &e| sum.checked_add(e as u32));
        let degree = terms.iter().map(degree).try_fold(0, |most, degree| degree.map(|degree| degree.max(most)))?;
        match &terms[..] {
            [(_, c)] if degree == 0 => return Some(self.rest.constant(c.clone())),
            _ if degree > MOST_DEGREE => return None,
            _ => {}
        }
        let negative = terms.first().is_some_and(|(_, c)| c.re.is_negative() || c.re.is_zero() && c.im.is_negative());
        let constant = |(p, c): (Vec<i32>, Exact)| (p, self.parts.constant(if negative { -c } else { c }));
        let terms: Vec<Term> = terms.into_iter().map(constant).collect();
        let formula = nest(&mut self.parts, &|graph, j| graph.push(Node::Parameter(j)), terms);
        let next = self.roots.len() as u32;
        let k = *known.entry(formula).or_insert(next);
        if k == next {
            self.roots.push((formula, degree));
        }
        let part = self.rest.push(Node::Parameter(k));
        Some(if negative { self.rest.neg(part) } else { part })
    }
}

/// The sum of the terms, nested.
fn nest(graph: &mut Graph, leaf: &impl Fn(&mut Graph, u32) -> Id, mut terms: Vec<Term>) -> Id {
    let mut sum = graph.integer(0);
    while !terms.is_empty() {
        let occurs = |j: usize| terms.iter().filter(|(monomial, _)| monomial[j] > 0).count();
        let unknowns = terms[0].0.len();
        // Of those in equally many terms the first.
        let most = (0..unknowns).map(|j| (occurs(j), j)).max_by_key(|&(count, j)| (count, std::cmp::Reverse(j)));
        let Some((_, j)) = most.filter(|&(count, _)| count > 1) else {
            for (monomial, coefficient) in terms {
                let mut product = graph.integer(1);
                for (j, &exponent) in (0u32..).zip(&monomial).filter(|&(_, &exponent)| exponent > 0) {
                    let x = leaf(graph, j);
                    let power = graph.pow(x, exponent);
                    product = graph.mul(product, power);
                }
                let term = graph.mul(coefficient, product);
                sum = graph.add(sum, term);
            }
            return sum;
        };
        let (mut inner, rest): (Vec<Term>, Vec<Term>) = terms.into_iter().partition(|(monomial, _)| monomial[j] > 0);
        let least = inner.iter().map(|(monomial, _)| monomial[j]).min().unwrap_or(1);
        inner.iter_mut().for_each(|(monomial, _)| monomial[j] -= least);
        let inner = nest(graph, leaf, inner);
        let x = leaf(graph, j as u32);
        let power = graph.pow(x, least);
        let product = graph.mul(power, inner);
        sum = graph.add(sum, product);
        terms = rest;
    }
    sum
}

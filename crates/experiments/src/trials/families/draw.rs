//! Random polynomials as text.

use super::known::{PARAMETERS, UNKNOWNS};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The largest coefficient.
const LARGEST: i64 = 99;

/// What families are drawn with.
pub(super) struct Draw(Pcg64Mcg);

impl Draw {
    pub(super) fn new(seed: u64) -> Draw {
        Draw(Pcg64Mcg::seed_from_u64(seed))
    }

    /// A whole number, bounds included.
    pub(super) fn between(&mut self, low: usize, high: usize) -> usize {
        self.0.random_range(low..=high)
    }

    pub(super) fn is_heads(&mut self) -> bool {
        self.0.random()
    }

    /// One of several.
    pub(super) fn one<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.between(0, of.len() - 1)].clone()
    }

    /// A coefficient, not zero.
    pub(super) fn coefficient(&mut self) -> i64 {
        let size = self.0.random_range(1..=LARGEST);
        if self.is_heads() { size } else { -size }
    }

    /// Different numbers, none of them zero.
    pub(super) fn different(&mut self, count: usize) -> Vec<i64> {
        let mut all: Vec<i64> = (-LARGEST..=LARGEST).filter(|&c| c != 0).collect();
        all.shuffle(&mut self.0);
        all.truncate(count);
        all
    }

    /// A term with its sign: a random coefficient and what it is multiplied with, nothing for a constant.
    pub(super) fn term(&mut self, factor: &str) -> String {
        signed(self.coefficient(), factor)
    }

    /// Some parameters, at most so many.
    pub(super) fn parameters(&mut self, most: usize) -> &'static [&'static str] {
        &PARAMETERS[..self.between(1, most)]
    }

    /// The unknowns, or independent linear forms in them.
    pub(super) fn coordinates(&mut self, unknowns: usize) -> Vec<String> {
        let plain = plain(unknowns);
        if self.is_heads() {
            return plain;
        }
        // Triangular, with ones on the diagonal.
        let sheared = |k: usize| match plain.get(k + 1) {
            Some(next) => format!("({} {})", plain[k], signed(self.0.random_range(1..=4), next)),
            None => plain[k].clone(),
        };
        (0..unknowns).map(sheared).collect()
    }

    /// All monomials of some degrees, each with a random coefficient.
    pub(super) fn dense(&mut self, names: &[String], degrees: impl IntoIterator<Item = usize>) -> String {
        let all: Vec<String> = degrees.into_iter().flat_map(|degree| monomials(names, degree)).collect();
        sum(all.iter().map(|monomial| self.term(monomial)))
    }

    /// A polynomial of this degree with all monomials. Parameters are added to coefficients of monomials of a lower
    /// degree, one or zero.
    pub(super) fn general(&mut self, names: &[String], degree: usize, parameters: &[&str]) -> String {
        let moved: Vec<String> = (0..degree.min(2)).flat_map(|degree| monomials(names, degree)).collect();
        format!("{}{}", self.dense(names, 0..=degree), self.moved(parameters, &moved))
    }

    /// These parameters, each with a random coefficient and one of some factors, to be added to a sum.
    pub(super) fn moved(&mut self, parameters: &[&str], factors: &[String]) -> String {
        let mut all = String::new();
        for parameter in parameters {
            let factor = self.one(factors);
            all += &format!(" {}", self.term(&product(&[parameter, &factor])));
        }
        all
    }

    /// A term with a parameter and a power of an unknown below this one.
    pub(super) fn lower(&mut self, parameter: &str, name: &str, degree: usize) -> String {
        let factor = power(name, self.between(0, degree - 1));
        self.term(&product(&[parameter, &factor]))
    }

    /// Gives each parameter to one of so many places.
    pub(super) fn shares<'a>(&mut self, parameters: &[&'a str], places: usize) -> Vec<Vec<&'a str>> {
        let mut shares = vec![Vec::new(); places];
        for parameter in parameters {
            shares[self.between(0, places - 1)].push(*parameter);
        }
        shares
    }

    /// [General](Self::general) polynomials of these degrees, among which the parameters are shared out.
    pub(super) fn generals(&mut self, names: &[String], degrees: &[usize], parameters: &[&str]) -> Vec<String> {
        let shares = self.shares(parameters, degrees.len());
        degrees.iter().zip(shares).map(|(&degree, share)| self.general(names, degree, &share)).collect()
    }
}

/// The names of the unknowns.
pub(super) fn plain(unknowns: usize) -> Vec<String> {
    UNKNOWNS[..unknowns].iter().map(|&name| name.to_owned()).collect()
}

/// A term with its sign.
pub(super) fn signed(coefficient: i64, factor: &str) -> String {
    let sign = if coefficient < 0 { "-" } else { "+" };
    match factor {
        "" => format!("{sign} {}", coefficient.abs()),
        factor => format!("{sign} {}*{factor}", coefficient.abs()),
    }
}

/// The sum of terms that have signs.
pub(super) fn sum(terms: impl IntoIterator<Item = String>) -> String {
    let all = terms.into_iter().collect::<Vec<_>>().join(" ");
    all.strip_prefix("+ ").unwrap_or(&all).to_owned()
}

/// A product of factors, without those that are one.
pub(super) fn product(factors: &[&str]) -> String {
    factors.iter().filter(|factor| !factor.is_empty()).copied().collect::<Vec<_>>().join("*")
}

/// A power; nothing for one.
pub(super) fn power(name: &str, exponent: usize) -> String {
    match exponent {
        0 => String::new(),
        1 => name.to_owned(),
        _ => format!("{name}^{exponent}"),
    }
}

/// The monomials of a degree.
pub(super) fn monomials(names: &[String], degree: usize) -> Vec<String> {
    let Some((first, others)) = names.split_first() else {
        return if degree == 0 { vec![String::new()] } else { Vec::new() };
    };
    let with = |k: usize| {
        let rest = monomials(others, degree - k);
        rest.into_iter().map(move |rest| product(&[&power(first, k), &rest])).collect::<Vec<_>>()
    };
    (0..=degree).rev().flat_map(with).collect()
}

//! The monomials in a few variables up to an order, by which series and functionals are listed.

use std::collections::HashMap;

/// The monomials in some variables up to an order, lower orders first.
pub(crate) struct Monomials {
    pub(super) exponents: Vec<Vec<u16>>,
    /// The number of monomials of each order or less.
    pub(super) counts: Vec<usize>,
    /// `raised[k][i]`: the place of monomial `k`, of less than the highest order, times variable `i`.
    pub(super) raised: Vec<Vec<usize>>,
}

impl Monomials {
    pub(super) fn new(variables: usize, order: usize) -> Monomials {
        let mut all = Monomials { exponents: vec![vec![0; variables]], counts: vec![1], raised: Vec::new() };
        let mut places: HashMap<Vec<u16>, usize> = HashMap::new();
        for _ in 0..order {
            let to = all.exponents.len();
            for k in all.raised.len()..to {
                let times = |i: usize| {
                    let mut product = all.exponents[k].clone();
                    product[i] += 1;
                    product
                };
                let products: Vec<Vec<u16>> = (0..variables).map(times).collect();
                let mut place = |product: Vec<u16>| {
                    *places.entry(product).or_insert_with_key(|product| {
                        all.exponents.push(product.clone());
                        all.exponents.len() - 1
                    })
                };
                let row = products.into_iter().map(&mut place).collect();
                all.raised.push(row);
            }
            all.counts.push(all.exponents.len());
        }
        all
    }

    pub(super) fn order(&self) -> usize {
        self.counts.len() - 1
    }
}

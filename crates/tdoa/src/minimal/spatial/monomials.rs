//! Monomials of one degree, and the coefficients of multiples of polynomials in them.

use faer::Mat;

/// Variables with repetition, ascending.
pub(super) type Monomial = Vec<u8>;

/// All monomials of a degree, in lexicographic order.
#[derive(Clone, Debug)]
pub(super) struct Monomials(Vec<Monomial>);

impl Monomials {
    pub(super) fn new(variables: usize, degree: usize) -> Monomials {
        let mut all: Vec<Monomial> = vec![Vec::new()];
        for _ in 0..degree {
            let longer = |m: &Monomial| {
                let (least, m) = (m.last().copied().unwrap_or(0), m.clone());
                (least..variables as u8).map(move |v| [&m[..], &[v]].concat())
            };
            all = all.iter().flat_map(longer).collect();
        }
        Monomials(all)
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn all(&self) -> &[Monomial] {
        &self.0
    }

    /// The place of a product of two monomials, whose degrees add up to this one.
    pub(super) fn place(&self, a: &[u8], b: &[u8]) -> usize {
        let mut product = [a, b].concat();
        product.sort_unstable();
        self.0.binary_search(&product).unwrap_or(0)
    }
}

/// Rows of length one.
pub(super) fn of_unit_length(mut rows: Vec<Vec<f64>>) -> Mat<f64> {
    for row in &mut rows {
        let length = row.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        row.iter_mut().for_each(|x| *x /= length);
    }
    let columns = rows.first().map_or(0, Vec::len);
    Mat::from_fn(rows.len(), columns, |i, j| rows[i][j])
}

#[cfg(test)]
mod tests {
    use super::Monomials;

    #[test]
    fn monomials_of_degree_two() {
        let all = Monomials::new(3, 2);
        assert_eq!(all.all(), [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]]);
        assert_eq!(all.place(&[2], &[1]), 4);
        // Binomials: 7 + 4 - 1 over 4.
        assert_eq!((Monomials::new(7, 4).len(), Monomials::new(4, 3).len()), (210, 20));
    }
}

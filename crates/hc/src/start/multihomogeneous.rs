//! The multihomogeneous start system (Morgan & Sommese 1987; Wampler 1993). The unknowns are
//! divided into groups. Every equation becomes a product of linear forms; the number of forms in
//! the unknowns of a group is the degree of the equation in that group.
//!
//! A solution chooses a factor of every equation, so that each group has as many equations as
//! unknowns.

use super::reached::Supports;
use crate::linalg::Lu;
use crate::random::{Random, Stream};
use num_complex::Complex64;
use poly::simd::Isa;
use std::collections::BTreeMap;

/// Most terms of an equation, and most entries of the table of numbers of solutions.
const MAX_TERMS: usize = 1 << 16;
const MAX_STATES: usize = 1 << 22;

/// Groups of unknowns and the degrees of all equations in them.
#[derive(Clone, Debug)]
pub(crate) struct Grouped {
    groups: Vec<Vec<usize>>,
    /// `degrees[i][g]`: of equation `i` in the unknowns of group `g`.
    degrees: Vec<Vec<u64>>,
    /// `counts[i][s]`: the number of ways to choose factors of the equations from `i` on if `s`
    /// says how many equations each group still takes.
    counts: Vec<Vec<u64>>,
    /// What one equation of each group adds to `s`.
    strides: Vec<usize>,
}

impl Grouped {
    /// `None` if an exponent is negative or there are too many solutions or groups to be counted.
    /// The groups hold every unknown once.
    pub(crate) fn new(supports: &Supports, groups: &[Vec<usize>]) -> Option<Grouped> {
        let n = supports.len();
        let degree = |points: &Vec<Vec<i32>>, group: &[usize]| {
            let of = |p: &Vec<i32>| group.iter().map(|&j| u64::try_from(p[j]).ok()).sum::<Option<u64>>();
            points.iter().map(of).collect::<Option<Vec<u64>>>()?.into_iter().max()
        };
        let degrees: Vec<Vec<u64>> =
            supports.iter().map(|s| groups.iter().map(|g| degree(s, g)).collect()).collect::<Option<_>>()?;
        let (mut strides, mut states) = (Vec::new(), 1usize);
        for group in groups {
            strides.push(states);
            states = states.checked_mul(group.len() + 1)?;
        }
        if states.checked_mul(n + 1)? > MAX_STATES {
            return None;
        }
        let mut counts = vec![vec![0u64; states]; n + 1];
        counts[n][0] = 1;
        for i in (0..n).rev() {
            for s in 0..states {
                let mut sum = 0u64;
                for ((&d, &stride), group) in degrees[i].iter().zip(&strides).zip(groups) {
                    if s / stride % (group.len() + 1) > 0 {
                        sum = sum.checked_add(d.checked_mul(counts[i + 1][s - stride])?)?;
                    }
                }
                counts[i][s] = sum;
            }
        }
        Some(Grouped { groups: groups.to_vec(), degrees, counts, strides })
    }

    /// The multihomogeneous Bezout number.
    pub(crate) fn number(&self) -> u64 {
        self.counts[0].last().copied().unwrap_or(0)
    }

    /// The terms that equation `i` of the start system has; `None` if they are too many.
    pub(crate) fn terms(&self, i: usize) -> Option<Vec<Vec<i32>>> {
        let mut terms = vec![vec![0i32; self.degrees.len()]];
        for (group, &degree) in self.groups.iter().zip(&self.degrees[i]) {
            let degree = i32::try_from(degree).ok()?;
            let mut left: Vec<(Vec<i32>, i32)> = terms.into_iter().map(|t| (t, degree)).collect();
            for &j in group {
                let size = left.iter().try_fold(0usize, |sum, (_, rest)| sum.checked_add(*rest as usize + 1))?;
                if size > MAX_TERMS {
                    return None;
                }
                let with = |(term, rest): (Vec<i32>, i32)| {
                    (0..=rest).map(move |e| {
                        let mut term = term.clone();
                        term[j] = e;
                        (term, rest - e)
                    })
                };
                left = left.into_iter().flat_map(with).collect();
            }
            terms = left.into_iter().map(|(term, _)| term).collect();
        }
        Some(terms)
    }

    /// The group and the factor of each equation for solution `number`.
    fn choice(&self, mut number: u64) -> Vec<(usize, usize)> {
        let mut state = self.counts[0].len() - 1;
        let mut chosen = Vec::with_capacity(self.degrees.len());
        for (i, degrees) in self.degrees.iter().enumerate() {
            for (g, (&degree, &stride)) in degrees.iter().zip(&self.strides).enumerate() {
                if (state / stride).is_multiple_of(self.groups[g].len() + 1) {
                    continue;
                }
                let each = self.counts[i + 1][state - stride];
                // No overflow: the sum of these products has been counted.
                if number < degree * each {
                    chosen.push((g, (number / each) as usize));
                    number %= each;
                    state -= stride;
                    break;
                }
                number -= degree * each;
            }
        }
        chosen
    }
}

/// The start system with random linear forms.
pub(crate) struct Multihomogeneous {
    grouped: Grouped,
    /// `forms[i][g][k]`: coefficients of the unknowns of group `g`, then the constant.
    forms: Vec<Vec<Vec<Vec<Complex64>>>>,
    /// The coefficients, to which parameters of another kind may be appended.
    pub(super) parameters: Vec<Complex64>,
}

impl Multihomogeneous {
    /// The start system as coefficients of the supports, which must contain all [`Grouped::terms`].
    pub(crate) fn new(supports: &Supports, grouped: Grouped, seed: u64, attempt: u64) -> Multihomogeneous {
        let mut random = Random::of(seed, Stream::Multihomogeneous(attempt));
        let mut forms = Vec::new();
        let mut parameters = Vec::new();
        for (points, degrees) in supports.iter().zip(&grouped.degrees) {
            let mut form =
                |g: usize| -> Vec<Complex64> { (0..=grouped.groups[g].len()).map(|_| random.unit()).collect() };
            let own: Vec<Vec<Vec<Complex64>>> =
                degrees.iter().enumerate().map(|(g, &d)| (0..d).map(|_| form(g)).collect()).collect();
            let mut product = BTreeMap::from([(vec![0i32; supports.len()], random.unit())]);
            for (group, forms) in grouped.groups.iter().zip(&own) {
                for form in forms {
                    product = times(&product, group, form);
                }
            }
            let largest = product.values().map(|c| c.norm()).fold(f64::MIN_POSITIVE, f64::max);
            let coefficient = |p| product.get(p).map_or(Complex64::new(0.0, 0.0), |c| c / largest);
            parameters.extend(points.iter().map(coefficient));
            forms.push(own);
        }
        Multihomogeneous { grouped, forms, parameters }
    }

    /// The solution with this number, which is below the number of paths.
    pub(crate) fn solution(&self, number: u64) -> Vec<Complex64> {
        let mut x = vec![Complex64::new(0.0, 0.0); self.forms.len()];
        let choice = self.grouped.choice(number);
        for (g, group) in self.grouped.groups.iter().enumerate() {
            let size = group.len();
            let chosen = choice.iter().enumerate().filter(|(_, c)| c.0 == g);
            let rows: Vec<&Vec<Complex64>> = chosen.map(|(i, &(g, k))| &self.forms[i][g][k]).collect();
            let matrix: Vec<Complex64> = (0..size).flat_map(|j| rows.iter().map(move |row| row[j])).collect();
            let mut side: Vec<Complex64> = rows.iter().map(|row| -row[size]).collect();
            let mut lu = Lu::new(size, Isa::Portable);
            lu.factor(&matrix, &vec![[1.0]; size]);
            lu.solve(&mut side);
            for (&j, &value) in group.iter().zip(&side) {
                x[j] = value;
            }
        }
        x
    }
}

/// A polynomial times a linear form in the unknowns of a group.
fn times(
    product: &BTreeMap<Vec<i32>, Complex64>,
    group: &[usize],
    form: &[Complex64],
) -> BTreeMap<Vec<i32>, Complex64> {
    let mut out: BTreeMap<Vec<i32>, Complex64> = BTreeMap::new();
    for (term, c) in product {
        for (k, a) in form.iter().enumerate() {
            let mut term = term.clone();
            if let Some(&j) = group.get(k) {
                term[j] += 1;
            }
            *out.entry(term).or_default() += c * a;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{Grouped, Multihomogeneous};
    use poly::{Evaluate, Isa, SparseSystem};

    /// Supports of equations with all terms up to given degrees in groups of unknowns.
    fn dense(groups: &[Vec<usize>], degrees: &[Vec<u64>]) -> Vec<Vec<Vec<i32>>> {
        let n = degrees.len();
        let grouped = Grouped { groups: groups.to_vec(), degrees: degrees.to_vec(), counts: vec![], strides: vec![] };
        (0..n).map(|i| grouped.terms(i).unwrap()).collect()
    }

    #[test]
    fn numbers_of_known_systems() {
        let number = |groups: &[Vec<usize>], degrees: &[Vec<u64>]| {
            Grouped::new(&dense(groups, degrees), groups).unwrap().number()
        };
        // Eigenvalues of an n x n matrix: n, where Bezout's number is 2^n.
        let eigen = [vec![0, 1, 2, 3], vec![4]];
        assert_eq!(number(&eigen, &[vec![1, 1], vec![1, 1], vec![1, 1], vec![1, 1], vec![1, 0]]), 4);
        // The quadratic eigenvalue problem (PHCpack's geneig): 10 of 243.
        let quadratic = [vec![0, 1, 2, 3, 4], vec![5]];
        let degrees = [vec![vec![1, 2]; 5], vec![vec![1, 0]]].concat();
        assert_eq!(number(&quadratic, &degrees), 10);
        // One group: Bezout's number.
        assert_eq!(number(&[vec![0, 1, 2]], &[vec![2], vec![3], vec![5]]), 30);
        // Groups of one, every equation without its own: permutations without a fixed point.
        let single: Vec<Vec<usize>> = (0..5).map(|j| vec![j]).collect();
        let degrees: Vec<Vec<u64>> = (0..5).map(|i| (0..5).map(|j| u64::from(i != j)).collect()).collect();
        assert_eq!(number(&single, &degrees), 44);
    }

    #[test]
    fn start_solutions_solve_the_start_system() {
        let groups = [vec![2, 0], vec![1], vec![3]];
        let degrees = [vec![2, 1, 0], vec![1, 0, 2], vec![1, 1, 1], vec![0, 2, 1]];
        let supports = dense(&groups, &degrees);
        let grouped = Grouped::new(&supports, &groups).unwrap();
        let start = Multihomogeneous::new(&supports, grouped, 7, 0);
        let system = SparseSystem::new(4, &supports).unwrap();
        let mut memory = system.memory(Isa::Portable);
        let solutions: Vec<_> = (0..start.grouped.number()).map(|k| start.solution(k)).collect();
        // By hand: the coefficient of a^2 b c in (2a + b)(a + 2c)(a + b + c)(2b + c).
        assert_eq!(solutions.len(), 15);
        for (k, x) in solutions.iter().enumerate() {
            let mut values = vec![num_complex::Complex64::default(); 4];
            system.values(&mut memory, x, &start.parameters, &mut values);
            let size = x.iter().map(|z| z.norm()).fold(1.0, f64::max).powi(3);
            assert!(values.iter().all(|v| v.norm() < 1e-13 * size), "{values:?}");
            assert!(solutions[..k].iter().all(|y| crate::distinct::relative_distance(x, y) > 1e-6));
        }
    }
}

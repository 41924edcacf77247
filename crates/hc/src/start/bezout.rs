//! Supports whose mixed volume is Bezout's number, known without a search for mixed cells.

use super::reached::Supports;

/// Most unknowns, because all sets of unknowns are looked at.
const MOST_UNKNOWNS: usize = 14;

/// Whether the mixed volume of supports that all hold the origin is certainly the product of the
/// `degrees`; it often is even if this is false.
///
/// A system with these supports and generic coefficients has as many zeros as the mixed volume (Li
/// & Wang 1996), and as many as the product of the degrees if there are none at infinity. Zeros
/// there solve the forms of highest degree. Where exactly the unknowns in a set `S` are nonzero, the
/// dimension is `|S| - 1` at first. Each form that does not vanish identically there has generic
/// coefficients and lowers the dimension on the torus by one. So there is no zero if there are at
/// least `|S|` such forms.
pub(crate) fn mixed_volume_is_bezout(supports: &Supports, degrees: &[u64]) -> bool {
    let n = supports.len();
    if n > MOST_UNKNOWNS || !supports.iter().all(|points| points.iter().any(|p| p.iter().all(|&e| e == 0))) {
        return false;
    }
    let unknowns = |p: &[i32]| p.iter().enumerate().fold(0u32, |set, (j, &e)| set | (u32::from(e != 0) << j));
    // The sets of unknowns in the terms of highest degree.
    let forms: Vec<Vec<u32>> = supports
        .iter()
        .zip(degrees)
        .map(|(points, &degree)| {
            let highest = points.iter().filter(|p| p.iter().map(|&e| i64::from(e)).sum::<i64>() as u64 == degree);
            let mut sets: Vec<u32> = highest.map(|p| unknowns(p)).collect();
            sets.sort_unstable();
            sets.dedup();
            sets
        })
        .collect();
    (1..1u32 << n).all(|set| {
        let live = forms.iter().filter(|form| form.iter().any(|term| term & !set == 0)).count();
        live >= set.count_ones() as usize
    })
}

#[cfg(test)]
mod tests {
    use super::mixed_volume_is_bezout;
    use crate::random::{Random, Stream};
    use crate::start::{bezout_number, degrees, mixed_volume};

    fn holds(supports: &[Vec<Vec<i32>>]) -> bool {
        mixed_volume_is_bezout(supports, &degrees(supports).unwrap())
    }

    #[test]
    fn never_against_the_mixed_volume() {
        let mut random = Random::of(0, Stream::Member(0));
        let mut draw = |below: f64| ((random.unit().arg() / std::f64::consts::TAU + 0.5) * below) as i32;
        let (mut yes, mut no) = (0, 0);
        for _ in 0..400 {
            let n = 2 + draw(2.0) as usize;
            let supports: Vec<Vec<Vec<i32>>> = (0..n)
                .map(|_| {
                    let mut points = vec![vec![0; n]];
                    points.extend((0..2 + draw(5.0)).map(|_| (0..n).map(|_| draw(3.0)).collect::<Vec<_>>()));
                    points.push((0..n).map(|j| if j == draw(n as f64) as usize { 4 } else { 0 }).collect());
                    points.sort();
                    points.dedup();
                    points
                })
                .collect();
            let volume = mixed_volume(n, &supports).unwrap().volume;
            if holds(&supports) {
                assert_eq!(Some(volume), bezout_number(&degrees(&supports).unwrap()), "{supports:?}");
                yes += 1;
            } else {
                no += 1;
            }
        }
        assert!(yes > 20 && no > 20, "{yes}, {no}");
    }

    #[test]
    fn of_known_systems() {
        let square = |terms: &[[i32; 2]]| terms.iter().map(|t| t.to_vec()).collect::<Vec<_>>();
        let dense = square(&[[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]]);
        assert!(holds(&[dense.clone(), dense.clone()]));
        // x y + x + 1 twice: mixed volume 1 (x y and x are two unknowns), Bezout's number 4.
        let product = square(&[[0, 0], [1, 0], [1, 1]]);
        assert!(!holds(&[product.clone(), product]));
        // Without the origin nothing is said.
        assert!(!holds(&[square(&[[2, 0], [0, 2]]), dense]));
    }
}

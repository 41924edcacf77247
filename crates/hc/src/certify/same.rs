//! Which proofs are about the same solution.
//!
//! Boxes are sorted by the lower end of their image under a fixed real projection; only boxes whose
//! images meet are compared.

use super::certificate::Obstacle;
use super::proof::Proof;
use crate::distinct::root;
use poly::Interval;

/// For each proof the first one about the same solution, if that is another, and the pairs that may be about the same
/// solution or about two.
pub(super) fn compare(proofs: &[Result<Proof, Obstacle>]) -> (Vec<Option<usize>>, Vec<[usize; 2]>) {
    let proved = proofs.iter().enumerate().filter_map(|(k, p)| Some((k, p.as_ref().ok()?)));
    let mut images: Vec<(Interval, usize, &Proof)> = proved.map(|(k, p)| (image(p), k, p)).collect();
    images.sort_by(|a, b| a.0.low.total_cmp(&b.0.low).then(a.1.cmp(&b.1)));

    // The first point known to stand for the same solution, by way of others of the kind.
    let mut first: Vec<usize> = (0..proofs.len()).collect();
    let mut unseparated = Vec::new();
    for (i, &(image, k, proof)) in images.iter().enumerate() {
        for &(_, other, candidate) in images[i + 1..].iter().take_while(|(next, ..)| next.low <= image.high) {
            if !proof.meets(candidate) {
                continue;
            }
            if proof.holds(candidate) || candidate.holds(proof) {
                let (a, b) = (root(&mut first, k), root(&mut first, other));
                first[a.max(b)] = a.min(b);
            } else {
                unseparated.push([k.min(other), k.max(other)]);
            }
        }
    }
    // Two points that a third one joins are separated after all.
    unseparated.retain(|&[a, b]| root(&mut first, a) != root(&mut first, b));
    unseparated.sort_unstable();
    let duplicate_of = (0..proofs.len()).map(|k| Some(root(&mut first, k)).filter(|&f| f != k)).collect();
    (duplicate_of, unseparated)
}

/// Bounds of a projection of the small box with fixed irrational coefficients.
fn image(proof: &Proof) -> Interval {
    let golden = 0.618_033_988_749_894_9_f64;
    let coefficient = |k: usize| Interval::point((k as f64 * golden).fract() * 2.0 - 1.0);
    let parts = proof.centre.iter().zip(&proof.small).enumerate();
    parts.fold(Interval::point(0.0), |sum, (j, (c, small))| {
        let re = Interval::point(c.re.high).plus(Interval::point(c.re.low).plus(small.re));
        let im = Interval::point(c.im.high).plus(Interval::point(c.im.low).plus(small.im));
        sum.plus(coefficient(2 * j + 1).times(re)).plus(coefficient(2 * j + 2).times(im))
    })
}

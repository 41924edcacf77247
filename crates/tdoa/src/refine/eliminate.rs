//! The inner loop of the Schur complement, in the lanes of a vector unit.

use hc::poly::simd::{Isa, Kernel};

/// Entries of a column that are computed together.
const LANES: usize = 8;

/// Transmitters that are taken off in one pass over the matrix.
const BATCH: usize = 4;

/// What a column needs beyond its end: lanes that are filled with nothing.
pub(super) const ROOM: usize = LANES - 1;

/// Transmitters on their way out of the equations.
pub(super) struct Batch<const D: usize> {
    /// Coordinates of receivers and unknowns of clocks.
    size: usize,
    /// D + 1 rows for each transmitter, with [`ROOM`] at the end of each: what it couples to receivers and clocks, in the
    /// frame in which its block is the identity.
    rows: Vec<f64>,
    count: usize,
    isa: Isa,
}

impl<const D: usize> Batch<D> {
    pub(super) fn new(size: usize) -> Self {
        Batch { size, rows: vec![0.0; BATCH * (D + 1) * (size + ROOM)], count: 0, isa: Isa::detect() }
    }

    /// Forgets what was not taken off.
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// The rows of the next transmitter, all zero. Those before it are taken off if there are too many.
    pub(super) fn next(&mut self, schur: &mut [f64]) -> &mut [f64] {
        if self.count == BATCH {
            self.take_off(schur);
        }
        let of_one = (D + 1) * (self.size + ROOM);
        let rows = &mut self.rows[self.count * of_one..][..of_one];
        rows.fill(0.0);
        self.count += 1;
        rows
    }

    /// Takes the transmitters off a column-major matrix with [`ROOM`] at its end, whose lower triangle counts.
    pub(super) fn take_off(&mut self, schur: &mut [f64]) {
        let rows = &self.rows[..self.count * (D + 1) * (self.size + ROOM)];
        self.isa.run(Eliminate::<D> { schur, size: self.size, rows });
        self.count = 0;
    }
}

/// Subtracts `B^T B` from the lower triangle of a column-major matrix with [`ROOM`] at its end. `B` has D + 1 rows for each
/// transmitter, one after the other, each with zeros in the room at its end.
struct Eliminate<'a, const D: usize> {
    schur: &'a mut [f64],
    size: usize,
    rows: &'a [f64],
}

impl<const D: usize> Kernel for Eliminate<'_, D> {
    type Output = ();
    const WIDEST: Isa = Isa::Avx512;

    #[inline(always)]
    fn run(self) {
        let of_one = (D + 1) * (self.size + ROOM);
        let mut batches = self.rows.chunks_exact(BATCH * of_one);
        for rows in batches.by_ref() {
            take_off::<D, BATCH>(self.schur, self.size, rows);
        }
        for rows in batches.remainder().chunks_exact(of_one) {
            take_off::<D, 1>(self.schur, self.size, rows);
        }
    }
}

/// Takes off the rows of `N` transmitters, one after the other, so that the sums do not depend on how many go together.
#[inline(always)]
fn take_off<const D: usize, const N: usize>(schur: &mut [f64], size: usize, rows: &[f64]) {
    let width = size + ROOM;
    for k in 0..size {
        // Loops, not closures: these are compiled with the instructions of the kernel.
        let (mut lead, mut end, mut any) = ([[0.0; D]; N], [0.0; N], false);
        for t in 0..N {
            for a in 0..D {
                lead[t][a] = rows[(t * (D + 1) + a) * width + k];
                any |= lead[t][a] != 0.0;
            }
            end[t] = rows[(t * (D + 1) + D) * width + k];
            any |= end[t] != 0.0;
        }
        // Receivers that have no measurement.
        if !any {
            continue;
        }
        // Lanes beyond the end of a column lie above the diagonal of the next one, and get zeros.
        let chunks = (size - k).div_ceil(LANES);
        let mut positions: [[&[[f64; LANES]]; D]; N] = [[&[]; D]; N];
        let mut last: [&[[f64; LANES]]; N] = [&[]; N];
        for t in 0..N {
            for a in 0..D {
                positions[t][a] = &rows[(t * (D + 1) + a) * width + k..].as_chunks().0[..chunks];
            }
            last[t] = &rows[(t * (D + 1) + D) * width + k..].as_chunks().0[..chunks];
        }
        let column = &mut schur[k * size + k..].as_chunks_mut::<LANES>().0[..chunks];
        for (c, entries) in column.iter_mut().enumerate() {
            let mut now = *entries;
            for t in 0..N {
                for (l, entry) in now.iter_mut().enumerate() {
                    let mut sum = lead[t][0] * positions[t][0][c][l];
                    for a in 1..D {
                        sum += lead[t][a] * positions[t][a][c][l];
                    }
                    *entry -= sum + end[t] * last[t][c][l];
                }
            }
            *entries = now;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{BATCH, Eliminate, ROOM};
    use hc::poly::simd::{Isa, Kernel};

    /// The lower triangle is what plain loops give, to the last bit, with any number of transmitters and any instruction set;
    /// above the diagonal nothing changes.
    #[test]
    fn all_sizes_are_as_by_plain_loops() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for size in (1..20).chain([27, 90]) {
            for transmitters in 0..=2 * BATCH + 1 {
                let first: Vec<f64> = (0..size * size + ROOM).map(|_| random()).collect();
                let mut rows = vec![0.0; transmitters * 4 * (size + ROOM)];
                for (k, x) in rows.iter_mut().enumerate() {
                    // Some columns are empty.
                    let at = k % (size + ROOM);
                    *x = if at < size && at % 5 != 2 { random() } else { 0.0 };
                }
                let mut plain = first.clone();
                for of in rows.chunks_exact(4 * (size + ROOM)) {
                    let row = |a: usize| &of[a * (size + ROOM)..];
                    for k in 0..size {
                        for l in k..size {
                            let mut sum = row(0)[k] * row(0)[l];
                            (1..3).for_each(|a| sum += row(a)[k] * row(a)[l]);
                            plain[k * size + l] -= sum + row(3)[k] * row(3)[l];
                        }
                    }
                }
                let mut schur = first.clone();
                Eliminate::<3> { schur: &mut schur, size, rows: &rows }.run();
                assert_eq!(schur, plain, "{size} {transmitters}");
                let mut schur = first;
                Isa::detect().run(Eliminate::<3> { schur: &mut schur, size, rows: &rows });
                assert_eq!(schur, plain, "{size} {transmitters}");
            }
        }
    }
}

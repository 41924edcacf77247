//! The stored fibre in the position nearest to the data.
//!
//! Nodes may be numbered in any order, and all lengths may be multiplied by a complex number of size one. The
//! order of the data's nodes and the number are taken for which the measurements, relative to their means over
//! the receivers, are nearest to those of the stored fibre: the paths are shorter then.

use super::normalised::Normalised;
use super::orders::{Order, Orders};
use crate::pseudoranges::Pseudoranges;
use hc::Fibre;
use num_complex::Complex64;
use smallvec::SmallVec;

/// Orders of both sides are gone through if there are not more than these pairs of them.
const PAIRS: usize = 10_000;
/// Orders of the longer side are gone through if there are not more than these; else its first node stays.
const ORDERS: usize = 50_000;

/// The stored fibre, and what finds the position nearest to some data; keeps its memory from call to call.
pub(crate) struct Nearest {
    stored: Fibre,
    /// Its measurements relative to their means over the receivers, a row for each node of the longer side.
    centred: Vec<Complex64>,
    /// Whether the receivers are the longer side.
    by_receivers: bool,
    /// The numbers of nodes, that of the longer side first.
    sizes: [usize; 2],
    data: Vec<Complex64>,
    products: Vec<Complex64>,
    best: Best,
}

/// The best order so far, longer side first, and the square of its sum of products.
struct Best {
    orders: [Order; 2],
    size: f64,
}

impl Nearest {
    /// The stored fibre of a problem with these nodes; none where their order is given.
    pub(crate) fn new(stored: Fibre, receivers: usize, transmitters: usize) -> Self {
        let by_receivers = receivers >= transmitters;
        let (long, short) = (receivers.max(transmitters), receivers.min(transmitters));
        let best = Best { orders: Default::default(), size: -1.0 };
        let mut nearest = Nearest {
            stored,
            centred: Vec::new(),
            by_receivers,
            sizes: [long, short],
            data: Vec::new(),
            products: Vec::new(),
            best,
        };
        let zero = Complex64::new(0.0, 0.0);
        let cells: Vec<Complex64> =
            std::iter::repeat_n(zero, transmitters).chain(nearest.stored.parameters.iter().copied()).collect();
        let mut centred = Vec::new();
        nearest.centre(&cells, &mut centred);
        nearest.centred = centred;
        nearest
    }

    /// The stored fibre.
    pub(crate) fn stored(&self) -> &Fibre {
        &self.stored
    }

    /// Another fibre in its place.
    pub(crate) fn replace(&mut self, fibre: Fibre) -> Fibre {
        let [receivers, transmitters] = if self.by_receivers { self.sizes } else { [self.sizes[1], self.sizes[0]] };
        std::mem::replace(self, Nearest::new(fibre, receivers, transmitters)).stored
    }

    /// A matrix of all nodes relative to the means over the receivers, in rows of the longer side.
    fn centre(&self, cells: &[Complex64], out: &mut Vec<Complex64>) {
        let [long, short] = self.sizes;
        let (receivers, transmitters) = if self.by_receivers { (long, short) } else { (short, long) };
        out.clear();
        out.resize(long * short, Complex64::new(0.0, 0.0));
        for j in 0..transmitters {
            let mean = (0..receivers).map(|i| cells[i * transmitters + j]).sum::<Complex64>() / receivers as f64;
            for i in 0..receivers {
                let place = if self.by_receivers { i * short + j } else { j * short + i };
                out[place] = cells[i * transmitters + j] - mean;
            }
        }
    }

    /// The order of the nodes in which the data are nearest to the stored fibre, multiplied by some number.
    pub(crate) fn orders(&mut self, measured: &Pseudoranges) -> Orders {
        let mut data = std::mem::take(&mut self.data);
        let mut cells = std::mem::take(&mut self.products);
        cells.clear();
        cells.extend(measured.cells().values().iter().map(|&f| Complex64::from(f)));
        self.centre(&cells, &mut data);
        (self.data, self.products) = (data, cells);

        let [long, short] = self.sizes;
        let count = |k: usize| (1..=k).fold(1usize, usize::saturating_mul);
        let both = count(long).saturating_mul(count(short)) <= PAIRS;
        let first = usize::from(count(long) > ORDERS);
        let mut orders: [Order; 2] = [(0..long).collect(), (0..short).collect()];
        self.best.orders.clone_from(&orders);
        self.best.size = -1.0;
        let from = if both { 0 } else { short };
        self.search_short(&mut orders, from, first);
        let [longer, shorter] = self.best.orders.clone();
        let (receivers, transmitters) = if self.by_receivers { (longer, shorter) } else { (shorter, longer) };
        Orders { receivers, transmitters }
    }

    /// Goes through the orders of the shorter side from place `at` on.
    fn search_short(&mut self, orders: &mut [Order; 2], at: usize, first: usize) {
        let [long, short] = self.sizes;
        if at < short {
            for k in at..short {
                orders[1].swap(at, k);
                self.search_short(orders, at + 1, first);
                orders[1].swap(at, k);
            }
            return;
        }
        self.products.clear();
        for stored in self.centred.chunks_exact(short) {
            for data in self.data.chunks_exact(short) {
                let pairs = stored.iter().zip(&orders[1]);
                self.products.push(pairs.map(|(stored, &k)| stored.conj() * data[k].re).sum());
            }
        }
        let sum = (0..first).map(|a| self.products[a * long + a]).sum();
        let products = &self.products;
        self.best.search_long(products, orders, first, sum);
    }

    /// The number of size one by which the stored measurements come nearest to the data `target`.
    fn towards(&self, target: &[Complex64], scaled: usize) -> Complex64 {
        let pairs = self.stored.parameters.iter().zip(target).take(scaled);
        let sum: Complex64 = pairs.map(|(stored, data)| stored.conj() * data).sum();
        if sum.norm() > 0.0 { sum / sum.norm() } else { Complex64::new(1.0, 0.0) }
    }

    /// Turns the stored fibre towards the data `target` and then by `turn` (radians) away again; a turn gives
    /// other paths to the same ends. The fibre goes into `moved`; `scaled` is the number of parameters that grow with
    /// the unit of length, and `weights` says by which power of it each unknown grows.
    pub(crate) fn turn(&self, target: &[Complex64], turn: f64, scaled: usize, weights: &[i32], moved: &mut Fibre) {
        let stored = &self.stored;
        let factor = self.towards(target, scaled) * Complex64::from_polar(1.0, turn);
        moved.dimension = stored.dimension;
        moved.parameters.clear();
        moved.parameters.extend(stored.parameters.iter().take(scaled).map(|f| factor * f));
        moved.parameters.extend(stored.parameters.iter().skip(scaled));
        let powers: SmallVec<[Complex64; 8]> = weights.iter().map(|&w| factor.powi(w)).collect();
        moved.solutions.clear();
        moved.solutions.extend(stored.solutions.iter().enumerate().map(|(k, x)| x * powers[k % powers.len()]));
    }
}

impl Best {
    /// Goes through the orders of the longer side from place `at` on; what is before gives the sum `sum`.
    fn search_long(&mut self, products: &[Complex64], orders: &mut [Order; 2], at: usize, sum: Complex64) {
        let count = orders[0].len();
        if at == count {
            if sum.norm_sqr() > self.size {
                self.size = sum.norm_sqr();
                self.orders.clone_from(orders);
            }
            return;
        }
        for k in at..count {
            orders[0].swap(at, k);
            self.search_long(products, orders, at + 1, sum + products[at * count + orders[0][at]]);
            orders[0].swap(at, k);
        }
    }
}

/// The parameters of a family of this crate at some data without gaps, with the nodes in the order nearest to a
/// fibre and all lengths turned towards it: for the choice of the stored fibres.
///
/// # Panics
/// If the fibre belongs to data of another size.
#[doc(hidden)]
pub fn parameters_near(fibre: &Fibre, measured: &Pseudoranges) -> Vec<Complex64> {
    let mut nearest = Nearest::new(fibre.clone(), measured.receivers(), measured.transmitters());
    let mut data = Normalised::default();
    data.take_in_order(measured, &nearest.orders(measured));
    let target: Vec<Complex64> = data.parameters().iter().map(|&f| f.into()).collect();
    let towards = nearest.towards(&target, usize::MAX);
    target.iter().map(|f| f / towards).collect()
}

#[cfg(test)]
mod tests {
    use super::{Nearest, Normalised, Order, Orders};
    use crate::clocks::Emissions;
    use crate::minimal::formulation::Formulation;
    use crate::minimal::planar::four_five::FourFive;
    use crate::minimal::planar::three::{FiveFour, SixThree};
    use crate::minimal::ranges::{FiveFive, FourSeven, FourSix, Gram, GramAndConstant, ThreeFour, ThreeThree};
    use crate::pseudoranges::Pseudoranges;
    use hc::Fibre;
    use hc::poly::{Evaluate, Isa};
    use hc::random::Random;
    use num_complex::Complex64;

    fn random(receivers: usize, transmitters: usize, seed: u64) -> Pseudoranges {
        let values = Random::new(seed, 0).normals(receivers * transmitters).iter().map(|z| z.re).collect();
        Pseudoranges::new(receivers, transmitters, values).unwrap()
    }

    /// Solutions stay solutions.
    fn turned_fibres_are_fibres<F: Formulation>() {
        let stored = F::fibre();
        let [m, n] = if F::EMISSIONS == Emissions::Unknown { [F::RECEIVERS, F::TRANSMITTERS] } else { [0, 0] };
        let nearest = Nearest::new(stored.clone(), m, n);
        let n = stored.dimension;
        let mut moved = stored.clone();
        let mut memory = F::system().memory(Isa::Portable);
        let (mut values, mut jacobian) = (vec![Complex64::new(0.0, 0.0); n], vec![Complex64::new(0.0, 0.0); n * n]);
        for seed in 0..5 {
            let target = Random::new(seed, 0).normals(stored.parameters.len());
            for turn in [0.0, 1.0] {
                nearest.turn(&target, turn, F::SCALED, F::WEIGHTS, &mut moved);
                for x in moved.solutions.chunks_exact(n) {
                    F::system().jacobian(&mut memory, x, &moved.parameters, &mut values, &mut jacobian);
                    for i in 0..n {
                        let scale: f64 = (0..n).map(|j| (jacobian[j * n + i] * x[j]).norm()).sum();
                        assert!(values[i].norm() < 1e-9 * scale, "{}: {:.1e}", F::NAME, values[i].norm() / scale);
                    }
                }
                let distance = |p: &[Complex64]| {
                    p.iter().zip(&target).map(|(a, b)| (a - b).norm_sqr()).take(F::SCALED).sum::<f64>()
                };
                assert!(turn > 0.0 || distance(&moved.parameters) <= distance(&stored.parameters));
            }
        }
    }

    #[test]
    fn turned_fibres() {
        turned_fibres_are_fibres::<SixThree>();
        turned_fibres_are_fibres::<FiveFour>();
        turned_fibres_are_fibres::<FourFive>();
        turned_fibres_are_fibres::<Gram<ThreeThree, 2>>();
        turned_fibres_are_fibres::<Gram<FourSix, 3>>();
        turned_fibres_are_fibres::<Gram<FiveFive, 3>>();
        turned_fibres_are_fibres::<GramAndConstant<ThreeFour, 2>>();
        turned_fibres_are_fibres::<GramAndConstant<FourSeven, 3>>();
    }

    /// Data that are the stored measurements in another order, with other clocks, come back in the stored one.
    #[test]
    fn the_order_of_the_fibre_is_found() {
        for (receivers, transmitters) in [(6, 3), (3, 6), (5, 4), (4, 5), (5, 6), (8, 5), (10, 4)] {
            let stored = random(receivers, transmitters, 1);
            let parameters = Normalised::new(&stored).parameters().iter().map(|&f| Complex64::from(f)).collect();
            let fibre = Fibre::new(parameters, 1, Vec::new());
            let mut nearest = Nearest::new(fibre, receivers, transmitters);
            for seed in 0..5 {
                // Both sides where all pairs of orders are gone through, all or all but the first of the longer
                // one elsewhere.
                let (rows, columns) = match (receivers, transmitters) {
                    (10, 4) => (1..10, 0..0),
                    (8, 5) => (0..8, 0..0),
                    (5, 6) => (0..0, 0..6),
                    _ => (0..receivers, 0..transmitters),
                };
                let orders = Orders {
                    receivers: shuffled(receivers, rows, seed),
                    transmitters: shuffled(transmitters, columns, seed + 10),
                };
                let mut data = vec![0.0; receivers * transmitters];
                for (i, &row) in orders.receivers.iter().enumerate() {
                    for (j, &column) in orders.transmitters.iter().enumerate() {
                        data[row * transmitters + column] =
                            stored.cells().values()[i * transmitters + j] + column as f64;
                    }
                }
                let data = Pseudoranges::new(receivers, transmitters, data).unwrap();
                assert_eq!(nearest.orders(&data), orders, "{receivers}r/{transmitters}s, seed {seed}");
            }
        }
    }

    /// Some nodes in random order, the others in their places.
    fn shuffled(count: usize, some: std::ops::Range<usize>, seed: u64) -> Order {
        let mut order: Order = (0..count).collect();
        let keys: Vec<f64> = Random::new(seed, 1).normals(count).iter().map(|z| z.re).collect();
        order[some].sort_by(|&a, &b| keys[a].total_cmp(&keys[b]));
        order
    }
}

//! The measured cells as flat lists, for the inner loops.

use crate::clocks::{ClockTerms, ClockUnknowns, Emissions};
use crate::distances::ReceiverDistance;
use crate::loss::Loss;
use crate::network::Network;
use crate::points::distance;
use crate::pseudoranges::Pseudoranges;
use std::ops::Range;

/// One measured cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Observation {
    pub(crate) receiver: usize,
    pub(crate) transmitter: usize,
    /// Pseudorange, metres.
    pub(crate) value: f64,
    /// One over the standard deviation given for the cell, or 1 where none is given.
    pub(crate) precision: f64,
    /// When, by the recorder's clock, as a share of half the recording about its middle; 0 where clocks do not drift.
    pub(crate) time: f64,
}

impl Observation {
    /// Pseudorange less what the recorder's clock adds in a network, metres.
    #[inline]
    pub(crate) fn synchronised<const D: usize>(&self, network: &Network<D>) -> f64 {
        self.without_clock(&network.clocks)
    }

    /// Pseudorange less what one of these clocks adds, which receivers have, metres.
    #[inline]
    pub(crate) fn without_clock(&self, clocks: &[[f64; 2]]) -> f64 {
        match clocks.get(self.receiver) {
            None => self.value,
            Some([offset, drift]) => self.value - offset - drift * self.time,
        }
    }

    /// The distance between receiver and transmitter that was measured, by the clocks of a network, metres.
    #[inline]
    pub(crate) fn length<const D: usize>(&self, network: &Network<D>) -> f64 {
        self.synchronised(network) - network.offsets[self.transmitter]
    }

    /// Residual divided by the cell's standard deviation.
    #[inline]
    pub(crate) fn residual<const D: usize>(&self, network: &Network<D>) -> f64 {
        let (i, j) = (self.receiver, self.transmitter);
        let d = distance(network.receivers[i], network.transmitters[j]);
        (self.length(network) - d) * self.precision
    }
}

/// A node by its index among those of its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Node {
    /// The receiver of this index.
    Receiver(usize),
    /// The transmitter of this index.
    Transmitter(usize),
}

impl Node {
    /// The position in a network of that size.
    #[inline]
    pub(crate) fn of<const D: usize>(self, network: &Network<D>) -> [f64; D] {
        match self {
            Node::Receiver(i) => network.receivers[i],
            Node::Transmitter(j) => network.transmitters[j],
        }
    }

    /// The name in the table.
    pub(crate) fn name(self, measured: &Pseudoranges) -> &str {
        match self {
            Node::Receiver(i) => &measured.receiver_names()[i],
            Node::Transmitter(j) => &measured.transmitter_names()[j],
        }
    }

    /// The position, to be changed.
    pub(crate) fn of_mut<const D: usize>(self, network: &mut Network<D>) -> &mut [f64; D] {
        match self {
            Node::Receiver(i) => &mut network.receivers[i],
            Node::Transmitter(j) => &mut network.transmitters[j],
        }
    }
}

/// A coordinate of a node that was measured by itself, or that is expected to be near a value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pin {
    pub(crate) node: Node,
    /// 0 for x, 1 for y, 2 for z.
    pub(crate) axis: usize,
    /// Metres.
    pub(crate) value: f64,
    /// What makes the residual one of the size of those of the measurements: their deviation over
    /// that of the coordinate.
    pub(crate) precision: f64,
}

impl Pin {
    /// Residual, comparable with those of the measurements.
    #[inline]
    pub(crate) fn residual<const D: usize>(&self, network: &Network<D>) -> f64 {
        (self.value - self.node.of(network)[self.axis]) * self.precision
    }
}

/// A length by which the values of some pins change together, and which is not known well.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    /// Per pin, how much of that length it changes by.
    pub(crate) shares: Vec<f64>,
    /// What is known of the length beside the measurements: their deviation over that of the length.
    pub(crate) precision: f64,
}

/// All measured cells, transmitter by transmitter, and the same cells receiver by receiver: of nodes
/// in the plane, or in space with `D` = 3.
#[derive(Debug, Clone)]
pub(crate) struct Observations<const D: usize = 2> {
    pub(crate) receivers: usize,
    pub(crate) transmitters: usize,
    entries: Vec<Observation>,
    columns: Vec<usize>,
    rows: Vec<usize>,
    row_entries: Vec<usize>,
    held: Vec<bool>,
    pins: Vec<Pin>,
    levels: Vec<Level>,
    other_unknowns: usize,
    /// What is known of the times at which transmitters send.
    emissions: Emissions,
    clocks: ClockUnknowns,
    clock_terms: ClockTerms,
    /// Distances between receivers that were measured by themselves.
    distances: Vec<ReceiverDistance>,
    /// Standard deviation of the measurements, metres, or the factor on their own.
    deviation: f64,
}

impl<const D: usize> Observations<D> {
    /// The measured cells for which `keep(receiver, transmitter)` holds.
    pub(crate) fn new(measured: &Pseudoranges, keep: impl Fn(usize, usize) -> bool) -> Self {
        let observe = |(i, j, value): (usize, usize, &f64)| {
            let precision = measured.sigma(i, j).map_or(1.0, |sigma| 1.0 / sigma);
            let time = measured.unknown_clocks().map_or(0.0, |recorders| recorders.time(i, j));
            keep(i, j).then_some(Observation { receiver: i, transmitter: j, value: *value, precision, time })
        };
        Observations::in_columns(measured, measured.cells().iter().filter_map(observe).collect())
    }

    /// Measurements of these nodes, in the order of the receivers.
    fn in_columns(measured: &Pseudoranges, mut entries: Vec<Observation>) -> Self {
        // Stable: those of a transmitter stay in the order of the receivers.
        entries.sort_by_key(|o| o.transmitter);
        let first = |j: usize| entries.partition_point(|o| o.transmitter < j);
        let columns = (0..=measured.transmitters()).map(first).collect();
        let all = Observations::of(measured.receivers(), entries, columns);
        let all = Observations { distances: measured.distances().to_vec(), deviation: measured.deviation(), ..all };
        all.with_clocks(measured.emissions(), ClockUnknowns::new(measured.emissions(), measured.unknown_clocks()))
    }

    /// All candidates of all measured cells, as if each were a measurement: at most one of a cell is right, the
    /// others are gross errors.
    pub(crate) fn of_all_candidates(measured: &Pseudoranges) -> Self {
        let observe = |(i, j, _): (usize, usize, &f64)| {
            let precision = measured.sigma(i, j).map_or(1.0, |sigma| 1.0 / sigma);
            let time = measured.unknown_clocks().map_or(0.0, |recorders| recorders.time(i, j));
            let of = move |value: &f64| Observation { receiver: i, transmitter: j, value: *value, precision, time };
            measured.candidates(i, j).iter().map(of)
        };
        Observations::in_columns(measured, measured.cells().iter().flat_map(observe).collect())
    }

    /// Measurements in the order of the transmitters, of which `columns` holds the first of each
    /// and their number.
    fn of(m: usize, entries: Vec<Observation>, columns: Vec<usize>) -> Self {
        let mut row_entries: Vec<usize> = (0..entries.len()).collect();
        row_entries.sort_by_key(|&k| entries[k].receiver);
        let rows = (0..=m).map(|i| row_entries.partition_point(|&k| entries[k].receiver < i)).collect();
        let transmitters = columns.len() - 1;
        Observations {
            receivers: m,
            transmitters,
            entries,
            columns,
            rows,
            row_entries,
            held: vec![false; m],
            pins: Vec::new(),
            levels: Vec::new(),
            other_unknowns: 0,
            emissions: Emissions::Unknown,
            clocks: ClockUnknowns::default(),
            clock_terms: ClockTerms::default(),
            distances: Vec::new(),
            deviation: 1.0,
        }
    }

    /// Those measurements for which `keep` holds, of the same nodes.
    pub(crate) fn subset(&self, keep: impl Fn(&Observation) -> bool) -> Self {
        let mut columns = vec![0];
        let mut entries = Vec::with_capacity(self.entries.len());
        for j in 0..self.transmitters {
            entries.extend(self.of_transmitter(j).iter().filter(|o| keep(o)).copied());
            columns.push(entries.len());
        }
        self.like(Observations::of(self.receivers, entries, columns).holding(&self.held))
    }

    /// These measurements less a length each, metres.
    pub(crate) fn reduced_by(&self, of: impl Fn(&Observation) -> f64) -> Self {
        let mut all = self.clone();
        for o in &mut all.entries {
            o.value -= of(o);
        }
        all
    }

    /// With what a receiver measured from transmitter `from` on given to a further receiver, the last
    /// one.
    pub(crate) fn split(&self, receiver: usize, from: usize) -> Self {
        let (mut columns, mut entries) = (vec![0], Vec::with_capacity(self.entries.len()));
        for j in 0..self.transmitters {
            let column = self.of_transmitter(j);
            let is_later = |o: &&Observation| o.receiver == receiver && j >= from;
            entries.extend(column.iter().filter(|o| !is_later(o)).copied());
            let later = column.iter().filter(is_later);
            entries.extend(later.map(|o| Observation { receiver: self.receivers, ..*o }));
            columns.push(entries.len());
        }
        let held: Vec<bool> = self.held.iter().copied().chain([false]).collect();
        let split = self.like(Observations::of(self.receivers + 1, entries, columns).holding(&held));
        split.with_clocks(self.emissions, self.clocks.split(receiver))
    }

    /// Measurements of the same kind with the same pins and distances.
    fn like(&self, others: Self) -> Self {
        let others = others.pinned_like(self).with_other_unknowns(self.other_unknowns);
        let others = Observations { distances: self.distances.clone(), deviation: self.deviation, ..others };
        others.with_clocks(self.emissions, self.clocks.clone())
    }

    /// These measurements with what is unknown of clocks.
    fn with_clocks(self, emissions: Emissions, clocks: ClockUnknowns) -> Self {
        let first = D * self.receivers;
        let clock_terms = if clocks.count() > 0 {
            ClockTerms::new(
                self.entries.iter().map(|o| clocks.terms(o.receiver, o.time).map(move |(at, x)| (first + at, x))),
            )
        } else {
            ClockTerms::default()
        };
        Observations { emissions, clocks, clock_terms, ..self }
    }

    /// These measurements, whose standard deviation this is, metres, or the factor on their own: what is known of clocks and
    /// distances is compared with it.
    pub(crate) fn at_deviation(self, deviation: f64) -> Self {
        Observations { deviation, ..self }
    }

    /// The standard deviation of the measurements that was given last.
    #[inline]
    pub(crate) fn deviation(&self) -> f64 {
        self.deviation
    }

    /// Distances between receivers that were measured by themselves.
    pub(crate) fn distances(&self) -> &[ReceiverDistance] {
        &self.distances
    }

    /// The negative log-likelihood of what is known of clocks and distances, in a network.
    pub(crate) fn misfit(&self, network: &Network<D>, is_least_squares: bool) -> f64 {
        self.soft_misfit(network, is_least_squares, 0.0)
    }

    /// That of distances with at least this standard deviation.
    fn soft_misfit(&self, network: &Network<D>, is_least_squares: bool, softest: f64) -> f64 {
        let cost = |known: &ReceiverDistance| {
            ReceiverDistance::cost(known.softened(softest).residual(&network.receivers), is_least_squares)
        };
        let of_clocks = self.clocks.prior().map_or(0.0, |prior| prior.misfit(network));
        self.distances.iter().fold(of_clocks, |sum, known| sum + cost(known))
    }

    /// What that costs among residuals of this loss, with distances of at least this standard deviation.
    pub(crate) fn unexpected(&self, network: &Network<D>, loss: &Loss, softest: f64) -> f64 {
        if self.distances.is_empty() && self.clocks.prior().is_none() {
            return 0.0;
        }
        loss.prior_weight(self.deviation) / loss.scale.powi(2)
            * self.soft_misfit(network, loss.nu.is_infinite(), softest)
    }

    /// These measurements, each with a share of its information.
    pub(crate) fn trusted(&self, shares: &[f64]) -> Self {
        let mut all = self.clone();
        for (o, share) in all.entries.iter_mut().zip(shares) {
            o.precision *= share.sqrt();
        }
        all
    }

    /// These measurements, with receivers that stay where they are.
    pub(crate) fn holding(self, held: &[bool]) -> Self {
        Observations { held: held.to_vec(), ..self }
    }

    /// These measurements, and coordinates of nodes.
    pub(crate) fn pinned(self, pins: &[Pin]) -> Self {
        Observations { pins: pins.to_vec(), levels: Vec::new(), ..self }
    }

    /// These measurements, whose pins have values that are not known well.
    pub(crate) fn levelled(self, levels: Vec<Level>) -> Self {
        Observations { levels, ..self }
    }

    /// These measurements with the pins of others, which are of the same nodes.
    pub(crate) fn pinned_like(self, others: &Self) -> Self {
        Observations { pins: others.pins.clone(), levels: others.levels.clone(), ..self }
    }

    /// What is not known well of the values of pins. It counts in covariances alone.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Coordinates of nodes that were measured by themselves.
    pub(crate) fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// These measurements, which have this many unknowns more than the nodes.
    pub(crate) fn with_other_unknowns(self, other_unknowns: usize) -> Self {
        Observations { other_unknowns, ..self }
    }

    /// Unknowns beside the nodes.
    pub(crate) fn other_unknowns(&self) -> usize {
        self.other_unknowns
    }

    /// Which receivers stay where they are.
    pub(crate) fn held(&self) -> &[bool] {
        &self.held
    }

    /// Whether nothing says where the network lies as a whole.
    pub(crate) fn leave_rigid_motions(&self) -> bool {
        self.rigid_motions() > 0
    }

    /// Dimension of the rigid motions that nothing hinders: all where no place is known, those along the plane
    /// where heights above it are.
    pub(crate) fn rigid_motions(&self) -> usize {
        let in_the_plane = self.pins.iter().all(|pin| pin.axis == 2);
        match (self.held.contains(&true), self.pins.is_empty()) {
            (false, true) => D * (D + 1) / 2,
            (false, false) if in_the_plane => 3,
            _ => 0,
        }
    }

    /// What is known of the times at which transmitters send.
    pub(crate) fn emissions(&self) -> Emissions {
        self.emissions
    }

    /// Whether they are distances, but for what all share: no transmitter has an offset of its own.
    #[inline]
    pub(crate) fn are_ranges(&self) -> bool {
        self.emissions != Emissions::Unknown
    }

    /// What a measurement says of its transmitter's own offset: `x`, and nothing if there is none.
    #[inline]
    pub(crate) fn of_offset(&self, x: f64) -> f64 {
        if self.are_ranges() { 0.0 } else { x }
    }

    /// The unknowns of clocks.
    pub(crate) fn clocks(&self) -> &ClockUnknowns {
        &self.clocks
    }

    /// Number of unknowns that are left once transmitters are eliminated: coordinates of receivers, then
    /// unknowns of clocks.
    #[inline]
    pub(crate) fn reduced(&self) -> usize {
        D * self.receivers + self.clocks.count()
    }

    /// How the measurements depend on unknowns of clocks.
    #[inline]
    pub(crate) fn clock_terms(&self) -> &ClockTerms {
        &self.clock_terms
    }

    /// All of them, transmitter by transmitter.
    pub(crate) fn all(&self) -> &[Observation] {
        &self.entries
    }

    /// Those of one transmitter, by receiver.
    pub(crate) fn of_transmitter(&self, j: usize) -> &[Observation] {
        &self.entries[self.places(j)]
    }

    /// The places of the cells of a transmitter among all.
    pub(crate) fn places(&self, j: usize) -> Range<usize> {
        self.columns[j]..self.columns[j + 1]
    }

    /// Those of one receiver, by transmitter.
    pub(crate) fn of_receiver(&self, i: usize) -> impl ExactSizeIterator<Item = &Observation> {
        self.row_entries[self.rows[i]..self.rows[i + 1]].iter().map(|&k| &self.entries[k])
    }

    /// Number of measurements.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Number of unknowns: positions, offsets of transmitters that have their own, and those of clocks, up to a rigid motion or
    /// without the receivers that are held and less the coordinates that were measured. Held receivers leave the
    /// rotations about them: one of them one in the plane and three in space, two one in space.
    pub(crate) fn unknowns(&self) -> usize {
        let held = self.held.iter().filter(|&&held| held).count();
        let loose = D.saturating_sub(held);
        let measured = self.pins.len() + if self.pins.is_empty() { 0 } else { self.rigid_motions() };
        let known = D * held + measured.max(loose * (loose + 1) / 2);
        (D * (self.receivers + self.transmitters)).saturating_sub(known) + self.unknown_times() + self.other_unknowns
    }

    /// Number of unknowns that are times: offsets of transmitters that have their own, and those of clocks.
    pub(crate) fn unknown_times(&self) -> usize {
        self.clocks.count() + if self.are_ranges() { 0 } else { self.transmitters }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_list_the_same_cells() {
        let nan = f64::NAN;
        let f = Pseudoranges::new(3, 2, vec![1.0, nan, 3.0, 4.0, nan, 6.0]).unwrap();
        let observations = Observations::<2>::new(&f, |i, _| i != 1 || f.observed() == 4);
        assert_eq!(observations.len(), 4);
        let column: Vec<_> = observations.of_transmitter(1).iter().map(|o| (o.receiver, o.value)).collect();
        assert_eq!(column, [(1, 4.0), (2, 6.0)]);
        let row: Vec<_> = observations.of_receiver(1).map(|o| (o.transmitter, o.value)).collect();
        assert_eq!(row, [(0, 3.0), (1, 4.0)]);
        assert_eq!(Observations::<2>::new(&f, |i, _| i != 2).len(), 3);
    }

    #[test]
    fn unknowns_are_positions_and_offsets_less_what_is_given() {
        let f = Pseudoranges::new(4, 2, vec![1.0; 8]).unwrap();
        let pin = |receiver, axis| Pin { node: Node::Receiver(receiver), axis, value: 0.0, precision: 1.0 };
        fn left<const D: usize>(f: &Pseudoranges, held: usize, pins: &[Pin]) -> usize {
            let held: Vec<bool> = (0..4).map(|i| i < held).collect();
            Observations::<D>::new(f, |_, _| true).holding(&held).pinned(pins).unknowns()
        }
        // 14 in the plane; rigid motions have three dimensions there, one of which a held point leaves.
        assert_eq!([0, 1, 2, 3].map(|held| left::<2>(&f, held, &[])), [11, 11, 10, 8]);
        assert_eq!(left::<2>(&f, 1, &[pin(2, 0), pin(3, 1)]), 10);
        // 20 in space; six, of which one point leaves three and two points one.
        assert_eq!([0, 1, 2, 3, 4].map(|held| left::<3>(&f, held, &[])), [14, 14, 13, 11, 8]);
        assert_eq!(left::<3>(&f, 2, &[pin(2, 2), pin(3, 1)]), 12);
    }

    #[test]
    fn a_split_receiver_is_two() {
        let f = Pseudoranges::new(2, 3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        let observations = Observations::<2>::new(&f, |_, _| true);
        let split = observations.split(0, 1);
        let row = |i: usize| -> Vec<_> { split.of_receiver(i).map(|o| (o.transmitter, o.value)).collect() };
        assert_eq!((split.receivers, row(0), row(2)), (3, vec![(0, 1.0)], vec![(1, 2.0), (2, 3.0)]));
        assert_eq!(split.len(), 6);
        assert_eq!(split.unknowns(), observations.unknowns() + 2);
    }
}

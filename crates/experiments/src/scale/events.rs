//! Events in the order of their times.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Events to come.
pub(super) struct Events<E> {
    heap: BinaryHeap<Entry<E>>,
    count: u64,
}

struct Entry<E> {
    time: f64,
    /// Events at the same time come in the order in which they were added.
    number: u64,
    event: E,
}

impl<E> Events<E> {
    pub(super) fn new() -> Events<E> {
        Events { heap: BinaryHeap::new(), count: 0 }
    }

    pub(super) fn at(&mut self, time: f64, event: E) {
        self.count += 1;
        self.heap.push(Entry { time, number: self.count, event });
    }

    /// The next event, with its time.
    pub(super) fn next(&mut self) -> Option<(f64, E)> {
        self.heap.pop().map(|entry| (entry.time, entry.event))
    }
}

impl<E> Ord for Entry<E> {
    /// The heap gives the greatest first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time).then(other.number.cmp(&self.number))
    }
}

impl<E> PartialOrd for Entry<E> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<E> PartialEq for Entry<E> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<E> Eq for Entry<E> {}

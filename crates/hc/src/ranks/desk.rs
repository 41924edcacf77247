//! Which paths remain to be tracked, and which rank has them.

use super::message::Portion;
use crate::runner::Round;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::{Duration, Instant};

/// Portions that another rank has at a time: one that it tracks, and the next.
const DEPTH: usize = 2;
/// Paths of a portion for each thread of who tracks it: at least so that its lanes are full for most
/// of the time, and at most so that all end together.
const LEAST: usize = 32;
const MOST: usize = 256;

/// The paths of a round that are not tracked yet, and those that some rank has. Rank 0 divides the
/// work between ranks with it.
///
/// A rank with room takes a portion: half of its share of the known paths, but 32 to 256 paths for
/// each of its threads. Ranks other than the first may have two portions at a time. The desk has no
/// clock; the caller passes the time.
///
/// ```
/// use hc::ranks::Desk;
/// use std::time::{Duration, Instant};
///
/// let mut desk = Desk::new(2, 1, Duration::from_secs(600));
/// desk.begin_part(1);
/// desk.ready(1, 4);
/// desk.offer(&(0..10_000).collect::<Vec<_>>());
/// let portion = desk.take(1, Instant::now()).unwrap();
/// assert_eq!(portion.paths.len(), 4 * 256);
/// assert_eq!(desk.answer(1, portion.number), Some(portion.paths));
/// ```
#[derive(Debug, Default)]
pub struct Desk {
    patience: Duration,
    round: Round,
    /// Least and largest portion for each thread.
    sizes: [usize; 2],
    /// Paths that no rank has, in ascending order.
    fresh: VecDeque<usize>,
    /// The last path that was offered.
    last: Option<usize>,
    /// The number of the next portion.
    next: u64,
    /// Portions that somebody has, by their numbers.
    out: BTreeMap<u64, Out>,
    /// No portion that another rank than the first has was handed out before this.
    oldest: Option<Instant>,
    seats: Vec<Seat>,
    /// All threads of ranks that are ready.
    threads: usize,
}

/// A portion that a rank has.
#[derive(Debug)]
struct Out {
    paths: Vec<usize>,
    rank: usize,
    since: Instant,
}

/// A rank.
#[derive(Clone, Debug, Default)]
struct Seat {
    /// Its threads; zero while it is not ready.
    threads: usize,
    /// Portions that it has not answered.
    held: BTreeSet<u64>,
}

impl Desk {
    /// A desk for this many ranks, the first of which has this many threads. A portion that a rank
    /// has not answered for as long as `patience` is given to another rank too.
    pub fn new(ranks: usize, threads: usize, patience: Duration) -> Desk {
        let mut seats = vec![Seat::default(); ranks.max(1)];
        seats[0].threads = threads.max(1);
        Desk { patience, sizes: [LEAST, MOST], threads: seats[0].threads, seats, ..Desk::default() }
    }

    /// Begins another part, for which the other ranks have to become ready. Each of its numbers
    /// stands for `weight` paths.
    pub fn begin_part(&mut self, weight: usize) {
        self.sizes = [LEAST, MOST].map(|size| (size / weight.max(1)).max(1));
        self.begin_round(Round::FIRST);
        self.seats[1..].fill(Seat::default());
        self.threads = self.seats[0].threads;
    }

    /// Begins a round. What was not answered is not wanted any more.
    pub(super) fn begin_round(&mut self, round: Round) {
        self.fresh.clear();
        self.out.clear();
        (self.round, self.last, self.oldest) = (round, None, None);
    }

    /// Notes that a rank is ready to work, on this many threads.
    pub fn ready(&mut self, rank: usize, threads: usize) {
        if let Some(seat) = self.seats.get_mut(rank) {
            let threads = threads.clamp(1, 1 << 16);
            self.threads = self.threads - seat.threads + threads;
            seat.threads = threads;
        }
    }

    /// Number of threads of all ranks that are ready.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// How many paths beyond the next batch should be known, so that no rank waits for the end of
    /// the batch.
    pub fn horizon(&self) -> usize {
        2 * self.sizes[1] * self.threads()
    }

    /// Adds paths, in ascending order, except those that were offered before.
    pub fn offer(&mut self, paths: &[usize]) {
        let new = self.last.map_or(0, |last| paths.partition_point(|&path| path <= last));
        self.fresh.extend(&paths[new..]);
        self.last = self.last.max(paths.last().copied());
    }

    /// A portion for a rank: one that another rank has had for too long, or the next one.
    pub fn take(&mut self, rank: usize, now: Instant) -> Option<Portion> {
        let all = self.threads;
        let seat = self.seats.get_mut(rank).filter(|seat| seat.threads > 0)?;
        if rank > 0 && seat.held.len() >= DEPTH {
            return None;
        }
        // There may be thousands of portions: late ones are sought only if there may be some.
        let is_late = |since: Instant| now.saturating_duration_since(since) >= self.patience;
        let mut late = None;
        if self.oldest.is_some_and(is_late) {
            let of_others = self.out.values().filter(|out| out.rank != 0);
            self.oldest = of_others.map(|out| out.since).min();
            late = self.out.iter_mut().find(|(_, out)| out.rank != 0 && out.rank != rank && is_late(out.since));
        }
        let (number, paths) = match late {
            Some((&number, out)) => {
                (out.rank, out.since) = (rank, now);
                (number, out.paths.clone())
            }
            None if self.fresh.is_empty() => return None,
            None => {
                let share = self.fresh.len().saturating_mul(seat.threads) / (2 * all);
                let [least, most] = self.sizes.map(|size| size * seat.threads);
                let size = share.clamp(least, most).min(self.fresh.len());
                let paths: Vec<usize> = self.fresh.drain(..size).collect();
                let number = self.next;
                self.next += 1;
                self.out.insert(number, Out { paths: paths.clone(), rank, since: now });
                if rank > 0 {
                    self.oldest.get_or_insert(now);
                }
                (number, paths)
            }
        };
        if rank > 0 {
            seat.held.insert(number);
        }
        Some(Portion { number, round: self.round, paths })
    }

    /// Notes the answer of a rank. Returns the paths of the portion if this is the first answer and
    /// it is wanted.
    pub fn answer(&mut self, rank: usize, number: u64) -> Option<Vec<usize>> {
        self.seats.get_mut(rank)?.held.remove(&number);
        self.out.remove(&number).map(|out| out.paths)
    }

    /// When a portion must be handed out again if no answer comes.
    pub fn due(&self) -> Option<Instant> {
        let others = self.out.values().filter(|out| out.rank != 0);
        others.filter_map(|out| out.since.checked_add(self.patience)).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_is_handed_out_once_and_again_when_it_is_late() {
        let (now, patience) = (Instant::now(), Duration::from_secs(10));
        let mut desk = Desk::new(3, 1, patience);
        desk.begin_part(1);
        desk.begin_round(Round { level: 2, chart: 0 });
        let paths: Vec<usize> = (0..1000).map(|k| 3 * k).collect();
        desk.offer(&paths[..600]);
        // Nothing for ranks that are not ready.
        assert_eq!(desk.take(1, now), None);
        desk.ready(1, 2);
        desk.ready(2, 1);
        assert_eq!(desk.take(7, now), None);
        // The same again, and more.
        desk.offer(&paths[200..]);
        let held = [desk.take(1, now).unwrap(), desk.take(1, now).unwrap()];
        assert_eq!(desk.take(1, now), None);
        assert_eq!((held[0].round.level, held[0].paths.len()), (2, 250));
        let mut seen: Vec<usize> = held[1].paths.clone();
        seen.extend(&held[0].paths);
        while let Some(portion) = desk.take(0, now) {
            assert_eq!(desk.answer(0, portion.number).as_ref(), Some(&portion.paths));
            seen.extend(portion.paths);
        }
        seen.sort_unstable();
        assert_eq!(seen, paths);
        // An answer in time, and one that does not come.
        assert_eq!(desk.due(), Some(now + patience));
        assert_eq!(desk.answer(1, held[0].number).as_ref(), Some(&held[0].paths));
        let late = now + patience;
        assert_eq!(desk.take(1, late), None);
        let again = desk.take(2, late).unwrap();
        assert_eq!(again, held[1]);
        assert_eq!(desk.take(0, late), None);
        assert_eq!(desk.take(0, late + patience).as_ref(), Some(&again));
        // The first answer counts.
        assert_eq!(desk.answer(1, again.number), Some(again.paths));
        assert_eq!(desk.answer(2, again.number), None);
        assert_eq!((desk.answer(9, 0), desk.due()), (None, None));
        // Heavy ones are handed out one by one, as many as there are threads.
        desk.begin_part(1000);
        desk.ready(1, 2);
        desk.offer(&paths);
        let sizes = [0, 1].map(|rank| desk.take(rank, now).map(|portion| portion.paths.len()));
        assert_eq!((sizes, desk.horizon()), ([Some(1), Some(2)], 6));
    }
}

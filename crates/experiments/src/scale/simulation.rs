//! The paths of one solve on many ranks, event by event.

use super::events::Events;
use super::load::{Load, Random};
use hc::ranks::Desk;
use std::time::{Duration, Instant};

/// What the paths run on. Ranks have one thread each; rank 0 has two processors, one for its paths
/// and one for messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Number of ranks.
    pub ranks: usize,
    /// Seconds from the sending of a message to its reception. MPI is asked every millisecond.
    pub latency: f64,
    /// Seconds of rank 0 for each message.
    pub message: f64,
    /// Bytes a second into rank 0.
    pub bandwidth: f64,
    /// Portions are so many times smaller than the 32 to 256 paths of the program.
    pub smaller: usize,
}

impl Machine {
    /// So many ranks on a cluster with Ethernet of 10 Gbit/s.
    pub fn new(ranks: usize) -> Machine {
        Machine { ranks, latency: 1e-3, message: 20e-6, bandwidth: 1.25e9, smaller: 1 }
    }
}

/// Paths that rank 0 takes in at a time, as in the program.
const BATCH: usize = 1 << 11;
/// Seconds of rank 0 for the number of each path that it knows of, once a batch.
const KNOWN: f64 = 1.5e-9;

/// How it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Seconds from the first ready rank to the end.
    pub seconds: f64,
    /// The share of all threads' time in which they tracked paths.
    pub efficiency: f64,
    /// The share of the time in which rank 0 took in ends.
    pub lead: f64,
    /// The share of the time in which rank 0 carried messages.
    pub post: f64,
    /// Portions that were handed out.
    pub portions: u64,
}

enum Event {
    /// A rank has become ready; the message is at rank 0.
    Ready(usize),
    /// An answer is at rank 0.
    Answer { rank: usize, number: u64, paths: usize },
    /// A message has been read.
    Heard { rank: usize, answer: Option<u64> },
    /// A portion is at a rank.
    Order { rank: usize, number: u64, paths: usize },
    /// Rank 0 has tracked a portion of its own.
    Own(u64),
    /// Rank 0 looks what there is to do.
    Look,
}

/// So many paths on a machine.
pub fn simulate(load: &Load, paths: usize, machine: &Machine, seed: u64) -> Outcome {
    let mut desk = Desk::new(machine.ranks, 1, Duration::from_secs(1 << 40));
    desk.begin_part(machine.smaller);
    let run = Run {
        load,
        machine,
        paths,
        desk,
        random: Random::new(seed),
        events: Events::new(),
        epoch: Instant::now(),
        free: vec![0.0; machine.ranks],
        post: 0.0,
        offered: 0,
        there: vec![0; paths.div_ceil(BATCH)],
        batch: 0,
        waiting: false,
        tracked: 0.0,
        taken_in: 0.0,
        carried: 0.0,
        portions: 0,
    };
    run.played()
}

struct Run<'a> {
    load: &'a Load,
    machine: &'a Machine,
    paths: usize,
    desk: Desk,
    random: Random,
    events: Events<Event>,
    /// What the clock of the desk shows at time zero.
    epoch: Instant,
    /// When each rank has tracked what it was given.
    free: Vec<f64>,
    /// When rank 0 has carried all messages so far.
    post: f64,
    /// Paths that the desk knows of.
    offered: usize,
    /// Ends of each batch.
    there: Vec<usize>,
    /// The batch that rank 0 waits for.
    batch: usize,
    /// Whether rank 0 has nothing to do.
    waiting: bool,
    tracked: f64,
    taken_in: f64,
    carried: f64,
    portions: u64,
}

impl Run<'_> {
    fn played(mut self) -> Outcome {
        for rank in 1..self.machine.ranks {
            self.events.at(self.machine.latency, Event::Ready(rank));
        }
        self.offer(0.0);
        self.events.at(0.0, Event::Look);
        let mut seconds = 0.0;
        while let Some((now, event)) = self.events.next() {
            match event {
                Event::Ready(rank) => self.read(now, 0, rank, None),
                Event::Answer { rank, number, paths } => {
                    let bytes = (paths as f64 * self.load.bytes()) as usize;
                    self.read(now, bytes, rank, Some(number));
                }
                Event::Heard { rank, answer } => {
                    match answer {
                        None => self.desk.ready(rank, 1),
                        Some(number) => self.end(rank, number),
                    }
                    self.feed(rank, now);
                    if std::mem::take(&mut self.waiting) {
                        self.events.at(now, Event::Look);
                    }
                }
                Event::Order { rank, number, paths } => {
                    let begun = now.max(self.free[rank]);
                    self.free[rank] = begun + self.track(paths);
                    let at = self.free[rank] + self.machine.latency;
                    self.events.at(at, Event::Answer { rank, number, paths });
                }
                Event::Own(number) => {
                    self.end(0, number);
                    self.events.at(now, Event::Look);
                }
                Event::Look => {
                    if let Some(end) = self.look(now) {
                        seconds = end;
                        break;
                    }
                }
            }
        }
        let efficiency = self.tracked / (seconds * self.machine.ranks as f64);
        let [lead, post] = [self.taken_in, self.carried].map(|busy| busy / seconds);
        Outcome { seconds, efficiency, lead, post, portions: self.portions }
    }

    /// Tells the desk of as many paths as the program does.
    fn offer(&mut self, now: f64) {
        let begun = self.batch * BATCH;
        let known = self.paths.min(begun + BATCH + self.desk.horizon());
        if known > self.offered {
            self.desk.offer(&(self.offered..known).collect::<Vec<usize>>());
            self.offered = known;
        }
        for rank in 1..self.machine.ranks {
            self.feed(rank, now);
        }
    }

    /// Rank 0 reads a message once it has carried the earlier ones.
    fn read(&mut self, now: f64, bytes: usize, rank: usize, answer: Option<u64>) {
        let at = self.carry(now, bytes);
        self.events.at(at, Event::Heard { rank, answer });
    }

    fn carry(&mut self, now: f64, bytes: usize) -> f64 {
        let takes = self.machine.message + bytes as f64 / self.machine.bandwidth;
        self.carried += takes;
        self.post = self.post.max(now) + takes;
        self.post
    }

    /// Sends a rank what it has room for.
    fn feed(&mut self, rank: usize, now: f64) {
        while let Some(portion) = self.desk.take(rank, self.epoch + Duration::from_secs_f64(now)) {
            self.portions += 1;
            let paths = portion.paths.len();
            let at = self.carry(now, 4 * paths) + self.machine.latency;
            self.events.at(at, Event::Order { rank, number: portion.number, paths });
        }
    }

    /// Seconds of a portion.
    fn track(&mut self, paths: usize) -> f64 {
        let seconds = self.load.draw(paths, &mut self.random);
        self.tracked += seconds;
        seconds
    }

    /// Notes the ends of a portion.
    fn end(&mut self, rank: usize, number: u64) {
        for path in self.desk.answer(rank, number).unwrap_or_default() {
            self.there[path / BATCH] += 1;
        }
    }

    /// Rank 0 takes in a batch, or tracks a portion; when all is done, if it is.
    fn look(&mut self, now: f64) -> Option<f64> {
        let size = BATCH.min(self.paths - self.batch * BATCH);
        if self.there[self.batch] == size {
            let takes = size as f64 * self.load.lead + KNOWN * (self.offered - self.batch * BATCH) as f64;
            self.taken_in += takes;
            self.batch += 1;
            if self.batch == self.there.len() {
                return Some(now + takes);
            }
            self.offer(now + takes);
            self.events.at(now + takes, Event::Look);
        } else if let Some(portion) = self.desk.take(0, self.epoch + Duration::from_secs_f64(now)) {
            self.portions += 1;
            let at = now + self.track(portion.paths.len());
            self.events.at(at, Event::Own(portion.number));
        } else {
            self.waiting = true;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::Portion;
    use super::*;

    fn load(path: f64, lead: f64) -> Load {
        let portion = |paths: usize| Portion { paths, seconds: path * paths as f64, bytes: 200 * paths };
        Load { system: "equal".into(), lead, start: 0.0, portions: [32, 64, 256].map(portion).to_vec() }
    }

    #[test]
    fn one_rank_does_everything_one_after_the_other() {
        let outcome = simulate(&load(1e-3, 1e-5), 10_000, &Machine::new(1), 1);
        let expected = 10_000.0 * (1e-3 + 1e-5);
        assert!((outcome.seconds - expected).abs() < 1e-3 * expected, "{outcome:?}");
        assert!((outcome.efficiency - 1e-3 / (1e-3 + 1e-5)).abs() < 1e-3, "{outcome:?}");
        assert_eq!(outcome.post, 0.0);
    }

    #[test]
    fn ranks_share_the_paths_until_rank_0_has_no_time_left() {
        // Twenty paths a rank are too few for portions of 32.
        let few = simulate(&load(1e-2, 1e-6), 20_000, &Machine::new(1000), 1);
        assert!(few.efficiency < 0.7, "{few:?}");
        let many = simulate(&load(1e-2, 1e-6), 1_000_000, &Machine::new(100), 1);
        assert!(many.efficiency > 0.9 && many.efficiency <= 1.0, "{many:?}");
        // Rank 0 spends a hundredth of the time of the others on a path: it serves a hundred ranks at most.
        let limited = simulate(&load(1e-3, 1e-5), 1_000_000, &Machine::new(1000), 1);
        assert!(limited.seconds >= 1_000_000.0 * 1e-5 && limited.lead > 0.9, "{limited:?}");
        assert!(limited.efficiency < 0.11, "{limited:?}");
    }

    #[test]
    fn the_same_seed_gives_the_same_and_each_path_is_tracked_once() {
        let mut load = load(1e-3, 1e-6);
        load.portions.push(Portion { paths: 100, seconds: 1.0, bytes: 10_000 });
        let run = |seed| simulate(&load, 50_000, &Machine::new(33), seed);
        assert_eq!(run(3), run(3));
        assert_ne!(run(3).seconds, run(4).seconds);
        load.portions.pop();
        let outcome = simulate(&load, 50_000, &Machine::new(33), 1);
        assert!((outcome.efficiency * outcome.seconds * 33.0 - 50.0).abs() < 1e-6, "{outcome:?}");
    }
}

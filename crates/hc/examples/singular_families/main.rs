//! Random systems of each kind with singular, hidden or badly conditioned solutions: how many are
//! right, how many are said to be unknown, and how long they take.
//!
//!     cargo run --release -p hc --example singular_families [SYSTEMS [FIRST [KIND]]]
//!
//! with the systems of each kind, the first seed, and how the names of kinds begin.

mod families;
mod verdict;

use families::{Draw, KINDS};
use std::time::Instant;
use verdict::{Answer, answer};

/// Systems by what their results are worth, and seconds.
#[derive(Default)]
struct Tally {
    right: usize,
    unknown: usize,
    wrong: usize,
    seconds: f64,
    slowest: f64,
}

impl Tally {
    fn add(&mut self, found: Answer, seconds: f64) {
        match found {
            Answer::Right => self.right += 1,
            Answer::Unknown => self.unknown += 1,
            Answer::Wrong => self.wrong += 1,
        }
        self.seconds += seconds;
        self.slowest = self.slowest.max(seconds);
    }

    fn print(&self, name: &str) {
        let Tally { right, unknown, wrong, seconds, slowest } = self;
        println!("{name:36} {right:6} {unknown:8} {wrong:6} {seconds:9.2} {slowest:8.2}");
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default: u64| {
        arguments.get(at).map_or(default, |text| text.parse().expect("SYSTEMS and FIRST are numbers"))
    };
    let (systems, first) = (number(0, 100), number(1, 0));
    let prefix = arguments.get(2).map_or("", String::as_str);
    println!("{:36} {:>6} {:>8} {:>6} {:>9} {:>8}", "kind", "right", "unknown", "wrong", "seconds", "slowest");
    let mut all = Tally::default();
    for (name, kind) in KINDS.iter().filter(|(name, _)| name.starts_with(prefix)) {
        let mut tally = Tally::default();
        for seed in first..first + systems {
            let case = kind(&mut Draw(seed));
            let begun = Instant::now();
            let found = answer(&case, seed);
            let seconds = begun.elapsed().as_secs_f64();
            tally.add(found, seconds);
            all.add(found, seconds);
            if found != Answer::Right {
                println!("{found:?} {name} {seed}, {seconds:.2} s:\n{}", case.text);
            }
        }
        tally.print(name);
    }
    all.print("all");
    let count = all.right + all.unknown + all.wrong;
    println!("{:.2} % right", 100.0 * all.right as f64 / count.max(1) as f64);
}

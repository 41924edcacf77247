//! Random systems of each kind with singular, hidden or badly conditioned solutions: how many are
//! right, how many are said to be unknown.
//!
//!     cargo run --release -p hc --example singular_families [SYSTEMS [FIRST]]

mod families;
mod verdict;

use families::{Draw, KINDS};
use verdict::{Answer, answer};

fn main() {
    let mut arguments = std::env::args().skip(1).map_while(|text| text.parse::<u64>().ok());
    let (systems, first) = (arguments.next().unwrap_or(100), arguments.next().unwrap_or(0));
    println!("{:36} {:>6} {:>8} {:>6} {:>9}", "kind", "right", "unknown", "wrong", "seconds");
    for (name, kind) in KINDS {
        let begun = std::time::Instant::now();
        let mut tally = [0; 3];
        for seed in first..first + systems {
            let case = kind(&mut Draw(seed));
            let found = answer(&case, seed);
            tally[match found {
                Answer::Right => 0,
                Answer::Unknown => 1,
                Answer::Wrong => 2,
            }] += 1;
            if found != Answer::Right {
                println!("{found:?} {name} {seed}:\n{}", case.text);
            }
        }
        println!("{name:36} {:6} {:8} {:6} {:9.2}", tally[0], tally[1], tally[2], begun.elapsed().as_secs_f64());
    }
}

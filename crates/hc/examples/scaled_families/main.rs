//! Twenty families of known counts whose parameters enter on scales from 1e-9 to 1e9: how often
//! monodromy and the trace test find all solutions, and how often they say so of too few.
//!
//!     cargo run --release -p hc --example scaled_families

mod families;

use families::{FAMILIES, Outcome};

const SEEDS: u64 = 5;

fn main() {
    let (mut whole, mut unsettled, mut wrong) = (0, 0, 0);
    for family in &FAMILIES {
        let mut line = String::new();
        for power in -9..=9 {
            let outcomes: Vec<Outcome> = (0..SEEDS).map(|seed| family.outcome(&format!("1e{power}"), seed)).collect();
            let good = outcomes.iter().filter(|o| **o == Outcome::Whole).count();
            let bad = outcomes.iter().filter(|o| matches!(o, Outcome::False(_))).count();
            line += &if bad > 0 { format!(" {good}!{bad}") } else { format!(" {good}  ") };
            (whole, wrong, unsettled) = (whole + good, wrong + bad, unsettled + outcomes.len() - good - bad);
        }
        println!("{line}  {}", family.equations.join("; "));
    }
    println!("whole {whole}, unsettled {unsettled}, false {wrong}");
    assert_eq!(wrong, 0, "a fibre that is not whole was said to be");
}

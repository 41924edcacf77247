//! Many ranks on paper: portions of paths are timed on two ranks of one thread each, and from these
//! runs on 2 to 4,096 ranks are simulated. See `experiments::scale`.
//!
//!     cargo run --release -p experiments --example scale -- record results/scale
//!     cargo run --release -p experiments --example scale -- simulate results/scale 1 > results/scale.md

mod record;

use experiments::scale::{Load, Machine, simulate};
use std::path::Path;
use std::process::ExitCode;

const RANKS: [usize; 7] = [2, 4, 16, 64, 256, 1024, 4096];
const PATHS: [usize; 4] = [10_000, 100_000, 1_000_000, 10_000_000];
/// Portions of 32 to 256 paths, and smaller ones.
const SMALLER: [usize; 3] = [1, 4, 32];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["record", folder] => record::systems().and_then(|loads| Load::write(&loads, Path::new(folder))),
        ["simulate", folder, seed] => match seed.parse() {
            Ok(seed) => Load::read(Path::new(folder)).map(|loads| print!("{}", page(&loads, folder, seed))),
            Err(_) => Err(cli::Failure::Unusable(format!("`{seed}` is no seed"))),
        },
        _ => Err(cli::Failure::Unusable("scale record FOLDER | scale simulate FOLDER SEED".into())),
    };
    cli::finish("scale", result, "nothing was written")
}

/// The simulated runs of all systems.
fn page(loads: &[Load], folder: &str, seed: u64) -> String {
    let machine = Machine::new(1);
    let mut text = format!(
        "# Many ranks, on paper\n\n`cargo run --release -p experiments --example scale -- simulate {folder} {seed}`: the paths of `mpirun \
         -n N hc solve`, simulated from portions that were timed on two ranks of one thread ({folder}/portions.csv). Paths are handed \
         out as the program does it. Assumed: one thread a rank, a second processor of rank 0 for messages, {} ms from sending to \
         reception (MPI is asked every millisecond), {} us of rank 0 a message, 10 Gbit/s. Start systems, which every rank makes for \
         itself, come before.\n\nEfficiency is the share of the time of all ranks in which they track paths; behind it the share of the \
         time in which rank 0 takes in ends, which no other rank does.\n",
        1e3 * machine.latency,
        1e6 * machine.message
    );
    for load in loads {
        let (path, lead) = (load.path(), load.lead);
        text += &format!(
            "\n## {}\n\nA path takes {:.2} ms, and {:.1} us and {:.0} bytes of rank 0, which can serve {:.0} ranks. Start system: \
             {:.1} s.\n",
            load.system,
            1e3 * path,
            1e6 * lead,
            load.bytes(),
            path / lead,
            load.start
        );
        for smaller in SMALLER {
            let [least, most] = [32, 256].map(|size: usize| (size / smaller).max(1));
            text += &format!("\nPortions of {least} to {most} paths:\n\n| ranks |");
            text += &PATHS.map(|paths| format!(" {paths} paths |")).concat();
            text += &format!("\n|---|{}\n", "---|".repeat(PATHS.len()));
            for ranks in RANKS {
                let mut machine = Machine::new(ranks);
                machine.smaller = smaller;
                text += &format!("| {ranks} |");
                for paths in PATHS {
                    let outcome = simulate(load, paths, &machine, seed);
                    text += &format!(" {:.0} % ({:.0} %) |", 100.0 * outcome.efficiency, 100.0 * outcome.lead);
                }
                text += "\n";
            }
        }
    }
    text
}

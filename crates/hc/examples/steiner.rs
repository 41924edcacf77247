//! Steiner's problem: how many conics touch five given ones? 3264 (Chasles 1864), and here they
//! are, with a proof of each.
//!
//! A generic fibre is filled by monodromy, then tracked to five random conics, complex or real, and
//! every solution is certified:
//!
//!     cargo run --release -p hc --example steiner -- [SEED [real]]

#[path = "../tests/all/common/conics.rs"]
mod conics;

use conics::{COUNTS, tangent_conics};
use hc::random::Random;
use hc::{Family, MonodromyOptions};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let seed: u64 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let real = arguments.next().is_some_and(|word| word == "real");
    let (family, count) = (Family::new(tangent_conics(5))?, COUNTS[5]);

    let started = Instant::now();
    let generic = family.monodromy(&MonodromyOptions::new().roots(count).seed(seed))?;
    let (found, seconds) = (generic.fibre.len(), started.elapsed().as_secs_f64());
    println!("monodromy: {found} conics after {} loops and {} paths, {seconds:.1} s", generic.loops, generic.paths);

    let started = Instant::now();
    let mut target = Random::new(seed, 149).normals(generic.fibre.parameters.len());
    if real {
        target.iter_mut().for_each(|p| p.im = 0.0);
    }
    let mut solved = family.track(&generic.fibre, &[target]).run()?.remove(0);
    let (paths, seconds) = (solved.paths, started.elapsed().as_secs_f64());
    println!(
        "five random conics: {} solutions, {} paths lost, {} tracked again, {seconds:.1} s",
        solved.len(),
        paths.failed,
        paths.retracked
    );

    let started = Instant::now();
    let proofs = solved.certify()?;
    println!(
        "certified: {} distinct, {} of them real, {:.1} s",
        proofs.n_distinct(),
        proofs.n_real(),
        started.elapsed().as_secs_f64()
    );
    if (proofs.n_distinct(), proofs.complete(), paths.failed) != (count, true, 0) {
        return Err(format!("{count} certified conics were expected").into());
    }
    Ok(())
}

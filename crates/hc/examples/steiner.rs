//! Steiner's problem: how many conics touch five given ones? 3264 (Chasles 1864), and here they are, with a proof of each.
//!
//! A generic fibre is filled by monodromy, then tracked to five random conics, complex or real, and every solution is certified:
//!
//!     cargo run --release -p hc --example steiner -- [SEED [real]]

#[path = "../tests/common/conics.rs"]
mod conics;

use conics::{COUNTS, tangent_conics};
use hc::certify::{CertifyOptions, certify};
use hc::monodromy::{MonodromyOptions, monodromy};
use hc::pair::find_pair;
use hc::poly::{Complex64, ComplexInterval};
use hc::random::Random;
use hc::solve::{SolveOptions, solve_member};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let seed: u64 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let real = arguments.next().is_some_and(|word| word == "real");
    let (family, count) = (tangent_conics(5), COUNTS[5]);
    let compiled = family.compile()?;

    let started = Instant::now();
    let first = find_pair(&family, |_, _| true, seed)?.ok_or("no first conic")?;
    let mut options = MonodromyOptions::default();
    options.roots = Some(count);
    options.seed = seed;
    let generic = monodromy(&compiled, &first, |_, _| true, &options);
    let (found, seconds) = (generic.fibre.len(), started.elapsed().as_secs_f64());
    println!("monodromy: {found} conics after {} loops and {} paths, {seconds:.1} s", generic.loops, generic.paths);

    let started = Instant::now();
    let mut target = Random::new(seed, 9).normals(generic.fibre.parameters.len());
    if real {
        target.iter_mut().for_each(|p| p.im = 0.0);
    }
    let solved = solve_member(&family, &compiled, &generic.fibre, &target, &SolveOptions::default());
    let (paths, seconds) = (solved.paths, started.elapsed().as_secs_f64());
    let solutions = solved.solutions.iter().filter(|s| !s.singular);
    println!(
        "five random conics: {} solutions, {} paths lost, {} tracked again, {seconds:.1} s",
        solved.solutions.len(),
        paths.failed,
        paths.retracked
    );

    let started = Instant::now();
    let points: Vec<Vec<Complex64>> =
        solutions.map(|s| s.value.iter().map(|&[re, im]| Complex64::new(re, im)).collect()).collect();
    let parameters: Vec<ComplexInterval> = target.iter().map(|&p| ComplexInterval::point(p)).collect();
    let proofs = certify(&family, &parameters, &points, &CertifyOptions::default())?;
    println!(
        "certified: {} distinct, {} of them real, {:.1} s",
        proofs.distinct(),
        proofs.real(),
        started.elapsed().as_secs_f64()
    );
    if (proofs.distinct(), proofs.complete(), paths.failed) != (count, true, 0) {
        return Err(format!("{count} certified conics were expected").into());
    }
    Ok(())
}

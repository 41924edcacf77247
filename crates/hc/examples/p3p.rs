//! A family from its formulas to 1,000 members: a camera's distances from three points (P3P).
//!
//! The generic fibre is filled by monodromy from one pair; each member has a planted camera, and
//! the example says whether it is among the solutions every time, and how long a path takes:
//!
//!     cargo run --release -p hc --example p3p

use hc::poly::Complex64;
use hc::random::Random;
use hc::{Family, MonodromyOptions};
use std::time::Instant;

const PROBLEMS: usize = 1000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let family: Family = include_str!("../../../examples/families/p3p.toml").parse()?;
    let fibre = family.monodromy(&MonodromyOptions::new())?.fibre;
    let mut random = Random::new(0, 5);
    let (distances, targets): (Vec<_>, Vec<_>) = (0..PROBLEMS).map(|_| problem(&mut random)).unzip();

    let started = Instant::now();
    let solved = family.track(&fibre, &targets).run()?;
    let seconds = started.elapsed().as_secs_f64();
    let near = |x: &[Complex64], d: &[f64; 3]| x.iter().zip(d).all(|(x, d)| (x - d).norm() < 1e-6);
    let camera = |(found, d): &(&hc::Solutions, &[f64; 3])| found.iter().any(|s| near(&s.value, d));
    let found = solved.iter().zip(&distances).filter(camera).count();
    let paths: usize = solved.iter().map(|found| found.paths.tracked).sum();
    let retracked: usize = solved.iter().map(|found| found.paths.retracked).sum();
    let lost: usize = solved.iter().map(|found| found.paths.failed).sum();
    println!("planted cameras found: {found} of {PROBLEMS}");
    println!("paths: {paths}, tracked again: {retracked}, lost: {lost}");
    println!("microseconds a path, all threads: {:.1}", 1e6 * seconds / paths as f64);
    if found < PROBLEMS || lost > 0 {
        return Err("a camera or a path is missing".into());
    }
    Ok(())
}

/// Random distances, and the family's parameters for them: cosines of the angles between the
/// points, as the camera sees them, and squares of the points' distances.
fn problem(random: &mut Random) -> ([f64; 3], Vec<Complex64>) {
    let mut uniform = |low: f64, high: f64| low + (high - low) * (random.unit().arg() / std::f64::consts::TAU + 0.5);
    let d = [(); 3].map(|()| uniform(1.0, 5.0));
    let g = [(); 3].map(|()| uniform(-0.9, 0.9));
    let side = |a: usize, b: usize, g: f64| d[a] * d[a] + d[b] * d[b] - 2.0 * g * d[a] * d[b];
    let parameters = [g[0], g[1], g[2], side(0, 1, g[0]), side(0, 2, g[1]), side(1, 2, g[2])];
    (d, parameters.iter().map(|&p| p.into()).collect())
}

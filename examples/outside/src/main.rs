//! What a crate needs of `hc`: a system from a string, a family for a thousand targets, and proofs.
//!
//!     cargo run --manifest-path examples/outside/Cargo.toml

use hc::{Family, MonodromyOptions, SolveOptions, System};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A circle and a hyperbola meet in four points, all real; interval arithmetic proves it.
    let system: System = "x^2 + y^2 - 5; x*y - 2".parse()?;
    let mut found = hc::solve(&system, &SolveOptions::new().seed(1))?;
    let proofs = found.certify()?;
    print!("{found}");
    assert_eq!((proofs.n_distinct(), proofs.n_real()), (4, 4));

    // All points of a circle on a line through its centre, for a thousand circles and lines.
    let family = Family::from_formulas(&["x", "y"], &["r", "a"], &["x^2 + y^2 - r^2", "y - a*x"])?;
    let found = family.monodromy(&MonodromyOptions::new())?;
    assert!(found.stopped.is_complete() && found.fibre.len() == 2);
    let fibre = found.fibre;
    let targets: Vec<[f64; 2]> = (1..=1000).map(|k| [k as f64, 0.75]).collect();
    let solved = family.track(&fibre, &targets).only_real(true).run()?;
    let on_circle = |x: &[f64], r: f64| (x[0].hypot(x[1]) - r).abs() < 1e-9 * r;
    for (solutions, target) in solved.iter().zip(&targets) {
        assert_eq!(solutions.real_solutions().filter(|x| on_circle(x, target[0])).count(), 2);
    }
    println!("{} targets, two real points each", solved.len());
    Ok(())
}

//! Times of random instances of three families: how much longer than the median the worst takes,
//! and whether any solution is lost.
//!
//! ```sh
//! cargo run --release -p hc --example tail            # 1,000 instances each
//! cargo run --release -p hc --example tail 100 7      # 100 instances each, seed 7
//! ```
//!
//! The families are three points seen by a camera (P3P), five points seen by two cameras, and the
//! critical points of the distance of two conics, whose fibres are shown to be whole by a known
//! count or the trace test; parameters are real and normal.

use hc::poly::parse;
use hc::random::Random;
use hc::{Family, MonodromyOptions};
use std::error::Error;
use std::time::Instant;

const FAMILIES: [(&str, &str); 3] = [
    ("P3P", include_str!("../../../examples/families/p3p.toml")),
    ("five points", include_str!("../../../examples/families/five_point.toml")),
    ("two conics", TWO_CONICS),
];

/// Critical points of the distance of a point on one conic from one on another, by multipliers.
const TWO_CONICS: &str = r#"
name = "two conics"
unknowns = ["x", "y", "u", "v", "l", "k"]
parameters = ["a", "b", "c", "d", "e", "f", "g", "h", "m", "n"]
equations = [
    "a*x^2 + b*x*y + c*y^2 + d*x + e*y - 1",
    "f*u^2 + g*u*v + h*v^2 + m*u + n*v - 1",
    "x - u + l*(2*a*x + b*y + d)",
    "y - v + l*(b*x + 2*c*y + e)",
    "u - x + k*(2*f*u + g*v + m)",
    "v - y + k*(g*u + 2*h*v + n)",
]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u64| arguments.next().map_or(Ok(default), |text| text.parse());
    let (instances, seed) = (number(1000)?.max(1), number(0)?);
    println!("family,solutions,instances,median ms,99th percentile ms,worst ms,worst / median,tracked again,lost");
    for (name, text) in FAMILIES {
        let family = Family::new(parse::family(text)?)?;
        let options = MonodromyOptions::new().seed(seed);
        let found = family.monodromy(&options)?;
        let fibre = found.fibre;
        if !found.stopped.is_complete() {
            return Err(
                format!("{name}: the fibre of {} solutions is not whole; take another seed", fibre.len()).into()
            );
        }
        let (mut times, mut again, mut lost) = (Vec::new(), 0, 0);
        for instance in 0..instances {
            let normals = Random::new(seed, 16 * instance + 5).normals(fibre.parameters.len());
            let target: Vec<f64> = normals.iter().map(|z| z.re).collect();
            let begin = Instant::now();
            let found = family.track(&fibre, &[target]).run()?;
            times.push(begin.elapsed().as_secs_f64() * 1e3);
            again += found[0].paths.retracked;
            lost += found[0].paths.failed;
        }
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
        let (median, worst) = (at(0.5), at(1.0));
        let percentile = at(0.99);
        let count = fibre.len();
        println!(
            "{name},{count},{instances},{median:.3},{percentile:.3},{worst:.3},{:.1},{again},{lost}",
            worst / median
        );
    }
    Ok(())
}

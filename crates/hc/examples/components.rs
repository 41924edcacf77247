//! Solution sets of positive dimension of systems from the literature: whether `decompose` finds their
//! components, and in what time.
//!
//! ```sh
//! cargo run --release -p hc --example components                  # five seeds, 60 s each at most
//! cargo run --release -p hc --example components 1 300 cyclic     # one seed, 300 s, these alone
//! ```
//!
//! A line for each system: for how many seeds dimensions, degrees and the number of isolated solutions
//! are those expected; for how many of these every path is accounted for and every component is shown to
//! be irreducible; the mean and the largest number of seconds. What is found is listed where it is not
//! what was expected.
//!
//! Expected are: of cyclic n (Björck & Fröberg 1991) what Backelin & Fröberg 1991, Faugère 2001 and
//! Sommese, Verschelde & Wampler 2001 give; of its reduced form, ratios to the first unknown, an n-th of
//! the isolated solutions of cyclic n and the sets with zeros, read off the runs of unknowns between
//! them (multiplicities are not compared); of all 2 x 2 minors the Segre variety; of adjacent ones a
//! component for each set of columns, no two neighbours, that are zero (Diaconis, Eisenbud & Sturmfels
//! 1998), of the product of the numbers of columns between them.

use hc::witness::Decomposition;
use hc::{Monitor, Run, SolveOptions, System};
use std::collections::BTreeMap;
use std::error::Error;
use std::time::{Duration, Instant};

/// A system in PHCpack's format, and what it is expected to have.
struct Case {
    name: String,
    text: String,
    /// Dimension and degree of each component.
    components: Vec<(usize, usize)>,
    /// The number of isolated solutions, with their multiplicities where so stated.
    isolated: usize,
}

fn case(name: &str, unknowns: usize, equations: &[String], components: &[(usize, usize)], isolated: usize) -> Case {
    let text = format!("{} {unknowns}\n{};\n", equations.len(), equations.join(";\n"));
    let mut components = components.to_vec();
    components.sort_unstable();
    Case { name: name.to_owned(), text, components, isolated }
}

/// Sums of products of `length` neighbours among `names` in a circle, for all lengths but the last.
fn circles(names: &[String]) -> Vec<String> {
    let n = names.len();
    let product =
        |j: usize, length: usize| (0..length).map(|k| names[(j + k) % n].as_str()).collect::<Vec<_>>().join("*");
    (1..n).map(|length| (0..n).map(|j| product(j, length)).collect::<Vec<_>>().join("+")).collect()
}

fn cyclic(n: usize, components: &[(usize, usize)], isolated: usize) -> Case {
    let names: Vec<String> = (0..n).map(|k| format!("x{k}")).collect();
    let mut equations = circles(&names);
    equations.push(format!("{}-1", names.join("*")));
    case(&format!("cyclic-{n}"), n, &equations, components, isolated)
}

fn reduced(n: usize, components: &[(usize, usize)], isolated: usize) -> Case {
    let names: Vec<String> = std::iter::once("1".to_owned()).chain((1..n).map(|k| format!("y{k}"))).collect();
    case(&format!("redcyc-{n}"), n - 1, &circles(&names), components, isolated)
}

fn minor(i: usize, j: usize) -> String {
    format!("a{i}*b{j}-a{j}*b{i}")
}

fn adjacent_minors(n: usize) -> Case {
    let equations: Vec<String> = (1..n).map(|i| minor(i - 1, i)).collect();
    let mut components = Vec::new();
    // Columns that are zero: neither the first nor the last, no two neighbours.
    for zero in (0..1_usize << n).filter(|zero| zero & 1 == 0 && zero >> (n - 1) & 1 == 0 && zero & (zero << 1) == 0) {
        let mut degree = 1;
        let mut run = 0;
        for k in 0..=n {
            if k == n || zero >> k & 1 == 1 {
                degree *= run;
                run = 0;
            } else {
                run += 1;
            }
        }
        components.push((n + 1, degree));
    }
    case(&format!("adjacent 2x{n}"), 2 * n, &equations, &components, 0)
}

fn all_minors(n: usize) -> Case {
    let equations: Vec<String> = (0..n).flat_map(|i| (i + 1..n).map(move |j| minor(i, j))).collect();
    case(&format!("minors 2x{n}"), 2 * n, &equations, &[(n + 1, n)], 0)
}

fn cases() -> Vec<Case> {
    let of = |texts: &[&str]| texts.iter().map(|t| (*t).to_owned()).collect::<Vec<String>>();
    let (s, t) = ("(x^2+y^2+z^2-1)", "(y-x^2)");
    let example = [format!("{t}*{s}*(x-1/2)"), format!("(z-x^3)*{s}*(y-1/2)"), format!("{t}*(z-x^3)*{s}*(z-1/2)")];
    let mut all = vec![
        case("twisted cubic", 3, &of(&["y-x^2", "z-x*y", "x*z-y^2"]), &[(1, 3)], 0),
        case("sphere, curves", 3, &example, &[(2, 2), (1, 3), (1, 1), (1, 1), (1, 1)], 1),
        cyclic(4, &[(1, 2); 2], 0),
        cyclic(8, &[[(1, 16); 8], [(1, 2); 8]].concat(), 1152),
        cyclic(9, &[(2, 3); 6], 6642),
        reduced(5, &[], 14 + 2),
        reduced(6, &[(1, 1), (1, 2), (1, 2)], 26),
        reduced(7, &[[(1, 1); 3].as_slice(), &[(1, 2); 4]].concat(), 132),
        // With zeros: two runs of three, two of two and one of one, four of one. Without: curves of cyclic
        // 8, of which four each become one.
        reduced(8, &[&[(2, 5); 3][..], &[(2, 2); 5], &[(2, 1)], &[(1, 8); 2], &[(1, 1); 2]].concat(), 144),
    ];
    all.extend((2..=6).map(adjacent_minors));
    all.extend((2..=6).map(all_minors));
    all
}

/// Dimensions and degrees with their numbers, in words.
fn summary(found: &Decomposition) -> String {
    let mut counts: BTreeMap<(usize, usize, usize), usize> = BTreeMap::new();
    for c in &found.components {
        *counts.entry((c.dimension, c.degree, c.multiplicity)).or_default() += 1;
    }
    let sets = counts.iter().map(|((d, k, m), n)| format!("{n} of dimension {d}, degree {k}, multiplicity {m}"));
    let sets: Vec<String> = sets.collect();
    format!(
        "{}; {} isolated, {} failed, partial: {}",
        sets.join("; "),
        found.isolated.len(),
        found.failed,
        found.partial
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(Ok(5), |text| text.parse())?;
    let limit: u64 = arguments.next().map_or(Ok(60), |text| text.parse())?;
    let wanted = arguments.next().unwrap_or_default();
    println!("{:16}{:>7}{:>9}{:>9}{:>9}", "system", "right", "shown", "mean s", "worst s");
    for case in cases().iter().filter(|case| case.name.contains(&wanted)) {
        let system: System = hc::poly::parse::phcpack(&case.text)?;
        let (mut right, mut shown, mut seconds) = (0, 0, Vec::new());
        for seed in 0..seeds {
            let begun = Instant::now();
            let monitor = Monitor::asking(move |_| begun.elapsed() > Duration::from_secs(limit));
            let found = Run::new().watched(&monitor).decompose(&system, &SolveOptions::new().seed(seed))?;
            seconds.push(begun.elapsed().as_secs_f64());
            let mut have: Vec<(usize, usize)> = found.components.iter().map(|c| (c.dimension, c.degree)).collect();
            have.sort_unstable();
            let counted: usize = found.isolated.iter().map(|s| s.multiplicity).sum();
            let isolated = [found.isolated.len(), counted].contains(&case.isolated);
            let is_right = !found.partial && have == case.components && isolated;
            right += usize::from(is_right);
            shown += usize::from(is_right && found.failed == 0 && found.components.iter().all(|c| c.irreducible));
            if !is_right {
                println!("  {} with seed {seed}: {}", case.name, summary(&found));
            }
        }
        let mean = seconds.iter().sum::<f64>() / seconds.len().max(1) as f64;
        let worst = seconds.iter().copied().fold(0.0, f64::max);
        println!("{:16}{right:>5}/{seeds}{shown:>7}/{seeds}{mean:>9.2}{worst:>9.2}", case.name);
    }
    Ok(())
}

//! Families of systems by their generators, with the numbers of solutions known from theory and the
//! literature.

use crate::common::generators::{cyclic, eco, katsura, noon, reimer, system};
use crate::common::{multiplicities, options, real, solved};
use hc::Start;

fn chandra(n: usize) -> String {
    let equation = |i: usize| {
        let sum: String = (1..n).map(|j| format!("+{i}/{}*h{j}", i + j)).collect();
        format!("{}*h{i}-0.51234*h{i}*(1{sum})-{}", 2 * n, 2 * n)
    };
    system((1..=n).map(equation).collect())
}

/// Number of solutions, all simple, and how many are real where that is known.
fn check(name: &str, text: &str, count: usize, real_count: Option<usize>, seeds: u64) {
    for seed in 0..seeds {
        let found = solved(text, &options(seed));
        assert_eq!(multiplicities(&found), format!("{count}x1"), "{name} {seed}");
        if let Some(expected) = real_count {
            assert_eq!(real(&found), expected, "{name} {seed}");
        }
    }
}

/// Bjorck & Froberg 1991; cyclic-8 has a curve of solutions besides 1152 isolated ones.
#[test]
fn cyclic_roots() {
    check("cyclic-5", &cyclic(5), 70, Some(10), 3);
    check("cyclic-6", &cyclic(6), 156, Some(24), 3);
    check("cyclic-7", &cyclic(7), 924, Some(56), 1);
    let found = solved(&cyclic(8), &options(1));
    assert_eq!((&multiplicities(&found)[..], found.on_components > 0), ("1152x1", true));
}

/// 2^n, the number of Bezout; real counts from PHCpack's lists of solutions, for katsura-5 from
/// real Newton iterations in 40 digits, which keep 16 roots apart.
#[test]
fn katsura_systems() {
    for (n, real) in [(5, 16), (6, 32), (7, 44), (8, 84), (9, 120), (10, 216)] {
        check(&format!("katsura-{n}"), &katsura(n), 1 << n, Some(real), if n < 9 { 3 } else { 1 });
    }
}

/// 3^n - 2n (Noonburg 1989); real counts from PHCpack's lists.
#[test]
fn noon_systems() {
    for (n, real) in [(3, Some(7)), (4, Some(15)), (5, Some(11)), (6, None)] {
        check(&format!("noon-{n}"), &noon(n), 3usize.pow(n as u32) - 2 * n, real, 2);
    }
}

/// 2^(n-2), the mixed volume.
#[test]
fn eco_systems() {
    for (n, real) in [(5, Some(4)), (6, Some(4)), (7, Some(8)), (8, Some(8)), (9, None), (10, None)] {
        check(&format!("eco-{n}"), &eco(n), 1 << (n - 2), real, 3);
    }
}

/// 2^(n-1), all real; coefficients and roots of very different sizes.
#[test]
fn chandra_systems() {
    for n in 4..=8 {
        check(&format!("chandra-{n}"), &chandra(n), 1 << (n - 1), Some(1 << (n - 1)), 3);
    }
}

/// Total degree has as many paths as polyhedral for katsura-5, all to regular solutions, and for
/// reimer-4, most of them to infinity.
#[test]
fn auto_takes_one_stage_only_where_paths_end_well() {
    let cases = [("katsura-5", katsura(5), Start::TotalDegree, 32), ("reimer-4", reimer(4), Start::Polyhedral, 120)];
    for (name, text, start, paths) in cases {
        for seed in 0..3 {
            let found = solved(&text, &options(seed));
            assert_eq!((found.start, found.start_systems), (Some(start), 1), "{name} {seed}");
            let (mixed_volume, bezout) = (found.mixed_volume, found.bezout_number);
            assert_eq!(
                (mixed_volume, bezout, found.paths.tracked),
                (Some(paths), Some(paths), paths as usize),
                "{name}"
            );
        }
    }
}

/// 36, 144, 576 of (n + 1)! paths (PHCpack's collection of demonstration systems).
#[test]
fn reimer_systems() {
    check("reimer-4", &reimer(4), 36, None, 3);
    check("reimer-5", &reimer(5), 144, Some(24), 1);
    check("reimer-6", &reimer(6), 576, None, 1);
}

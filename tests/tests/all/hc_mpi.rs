//! `mpirun hc`: the same bytes on any number of ranks, and an end of all of them.

use crate::mpi::{on_ranks, process, said, signal, succeeds, text, waited, written};
use end_to_end::run;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

const SYSTEMS: [(&str, &str, &[&str]); 5] = [
    ("cyclic6", CYCLIC6, &["--seed", "1"]),
    // Multiple solutions and paths that are tracked again.
    ("multiple", "x*(x - y)*(x + y - 1)^2 - 1e-9\n(y - 1)^2*(y + x)*(x - 2)\n", &["--seed", "1"]),
    ("infinity", "x*y*z - 1\nx^2*y + z - 2\nx^2 + y^2*z - 3*x\n", &["--start", "total-degree"]),
    (
        "eigenvalues",
        "x*t - 2*x - y\ny*t - x - 3*y\nx + y - 1\n",
        &["--start", "multihomogeneous", "--groups", "x,y;t", "--certify"],
    ),
    ("excess", "x^2 + y^2 - 5\nx*y - 2\nx^3 - 4*x + y - 1\nx^2*y - 2*x\n", &["--torus-only"]),
];

const CYCLIC6: &str = "a + b + c + d + e + f
a*b + b*c + c*d + d*e + e*f + f*a
a*b*c + b*c*d + c*d*e + d*e*f + e*f*a + f*a*b
a*b*c*d + b*c*d*e + c*d*e*f + d*e*f*a + e*f*a*b + f*a*b*c
a*b*c*d*e + b*c*d*e*f + c*d*e*f*a + d*e*f*a*b + e*f*a*b*c + f*a*b*c*d
a*b*c*d*e*f - 1
";

/// A system of `2^n` regular solutions.
fn quadrics(n: usize) -> String {
    let next = |i: usize, k: usize| (i + k) % n;
    let equation =
        |i: usize| format!("x{i}^2 - {}*x{}*x{} + 3*x{} + {}\n", i + 2, next(i, 1), next(i, 2), next(i, 3), i + 1);
    (0..n).map(equation).collect()
}

/// Standard output without the lines that say how long it took.
fn untimed(output: &Output) -> String {
    let text = String::from_utf8(output.stdout.clone()).expect("text");
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("\"seconds\":")).collect();
    assert!(lines.len() < text.lines().count(), "{}", said(output));
    lines.join("\n")
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn any_number_of_ranks_prints_the_same_bytes() {
    let folder = tempfile::tempdir().expect("directory");
    let large = quadrics(11);
    let large = ("quadrics", &large[..], &["--start", "total-degree"][..]);
    for (name, system, options) in SYSTEMS.into_iter().chain([large]) {
        let file = written(folder.path(), name, system);
        let arguments = [&["solve", &file, "--json", "-"], options].concat();
        let alone = run("hc", &[&arguments[..], &["--threads", "2"]].concat());
        let expected = untimed(&alone);
        for (count, threads) in [(1, "2"), (2, "1"), (4, "1"), (2, "2")] {
            let output = on_ranks("hc", count, &[&arguments[..], &["--threads", threads]].concat());
            let output = { output }.output().expect("mpirun runs");
            assert_eq!(untimed(&output), expected, "{name} on {count} ranks: {}", said(&output));
            assert_eq!(output.status.code(), alone.status.code(), "{name}: {}", said(&output));
        }
    }
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn targets_of_families_have_the_same_bytes_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().expect("directory");
    // Tangents, asymptotes and ordinary points of conics; cameras.
    let conics = "name = \"conics\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"a\", \"b\", \"c\"]\n\
        equations = [\"a*x^2 + y^2 - b\", \"x*y - c\"]\n";
    let conics = written(folder.path(), "conics.toml", conics);
    let cameras = text(&end_to_end::root().join("examples/families/p3p.toml"));
    let conic = |k: usize| match k % 100 {
        7 => "[1, 2, 1]".to_owned(),
        8 => "[0, 4, 3]".to_owned(),
        _ => format!("[1, {}, 2]", 5 + k),
    };
    // At distances of 2, 3 and 4 and more from the three points.
    let camera = |k: usize| {
        let far = 4.0 + k as f64 / 64.0;
        format!("[0.5, 0.625, 0.75, 7, {}, {}]", 4.0 + far * far - 2.5 * far, 9.0 + far * far - 4.5 * far)
    };
    for (name, family, target) in [("conics", &conics, &conic as &dyn Fn(usize) -> String), ("p3p", &cameras, &camera)]
    {
        let start = text(&folder.path().join(format!("{name}.start.json")));
        let made = run("hc", &["monodromy", family, "--seed", "1", "--output", &start]);
        assert!(made.status.success(), "{}", said(&made));
        let all: Vec<String> = (0..600).map(|k| format!("{{\"parameters\": {}}}", target(k))).collect();
        let targets = written(folder.path(), &format!("{name}.json"), &format!("[{}]", all.join(",\n")));
        let arguments = ["track", family, "--start", &start, "--target", &targets, "--json", "-", "--threads"];
        let alone = run("hc", &[&arguments[..], &["2"]].concat());
        assert!(alone.status.success(), "{name}: {}", said(&alone));
        for (count, threads) in [(1, "2"), (2, "1"), (4, "1")] {
            let output = on_ranks("hc", count, &[&arguments[..], &[threads]].concat()).output().expect("mpirun runs");
            assert_eq!(untimed(&output), untimed(&alone), "{name} on {count} ranks: {}", said(&output));
            assert!(output.status.success(), "{name}: {}", said(&output));
        }
    }
}

/// Two curves of degree 8 in a plane: 64 points by Bezout's theorem, none of them at infinity.
const CURVES: &str = "name = \"curves\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"a\", \"b\", \"c\", \"d\"]\n\
    equations = [\"x^8 + a*x*y - b\", \"y^8 + c*x*y - d\"]\n";

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn fibres_have_the_same_bytes_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().expect("directory");
    let curves = written(folder.path(), "curves.toml", CURVES);
    let cameras = text(&end_to_end::root().join("examples/families/p3p.toml"));
    for (family, count, stopped) in [(&curves, 64, "trace"), (&cameras, 8, "roots reached")] {
        let arguments = ["monodromy", family, "--seed", "1", "--output", "-", "--threads"];
        let alone = run("hc", &[&arguments[..], &["8"]].concat());
        assert!(alone.status.success(), "{}", said(&alone));
        let start: serde_json::Value = serde_json::from_slice(&alone.stdout).expect("JSON");
        assert_eq!(start["solutions"].as_array().map(Vec::len), Some(count));
        assert_eq!(start["stopped"], stopped);
        for (count, threads) in [(1, "1"), (2, "1"), (4, "1"), (2, "8")] {
            let output = on_ranks("hc", count, &[&arguments[..], &[threads]].concat()).output().expect("mpirun runs");
            assert!(output.stdout == alone.stdout, "{family} on {count} ranks: {}", said(&output));
            assert!(said(&output).contains(said(&alone).trim()), "{}", said(&output));
            assert!(output.status.success());
        }
    }
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn a_search_whose_rank_dies_goes_on_from_its_checkpoint() {
    let folder = tempfile::tempdir().expect("directory");
    let curves = written(folder.path(), "curves.toml", CURVES);
    let directory = text(&folder.path().join("run"));
    let arguments = ["monodromy", &curves, "--seed", "1", "--output", "-"];
    let expected = run("hc", &[&arguments[..], &["--threads", "2"]].concat());
    let recorded =
        [&arguments[..], &["--checkpoint", &directory, "--resume", "--rank-timeout", "60", "--threads", "1"]].concat();
    let records = || {
        let output = run("hc", &["monodromy", "--status", &directory]);
        let status: Option<serde_json::Value> = serde_json::from_slice(&output.stdout).ok();
        status.and_then(|status| status["records"].as_u64())
    };
    for (rank, loops) in [(1, 4), (0, 8)] {
        let mut command = on_ranks("hc", 2, &recorded);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("mpirun runs");
        let victim = waited(|| process(&child, rank));
        waited(|| records().filter(|&records| records >= loops));
        signal("-KILL", victim);
        assert!(!succeeds(child));
    }
    let output = on_ranks("hc", 4, &recorded).output().expect("mpirun runs");
    assert!(output.stdout == expected.stdout, "{}", said(&output));
    assert!(said(&output).contains(&format!("{directory}: goes on after ")), "{}", said(&output));
}

/// Cyclic n-roots: sums of products of k neighbours are zero, the product of all is one.
fn cyclic(n: usize) -> String {
    let product = |i: usize, k: usize| (i..i + k).map(|j| format!("x{}", j % n)).collect::<Vec<_>>().join("*");
    let sum = |k: usize| (0..n).map(|i| product(i, k)).collect::<Vec<_>>().join(" + ") + "\n";
    (1..n).map(sum).chain([product(0, n) + " - 1\n"]).collect()
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn mixed_volumes_are_the_same_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().expect("directory");
    // Counts from the literature (Li & Li 2001).
    for (n, expected) in [(6, 156), (11, 184_756)] {
        let file = written(folder.path(), &format!("cyclic{n}.txt"), &cyclic(n));
        let arguments = ["mixed-volume", &file, "--json", "-", "--threads"];
        let alone = run("hc", &[&arguments[..], &["8"]].concat());
        let found: serde_json::Value = serde_json::from_slice(&alone.stdout).expect("JSON");
        assert_eq!(found["mixed_volume"], expected);
        for (count, threads) in [(1, "1"), (2, "1"), (4, "1"), (2, "8")] {
            let output = on_ranks("hc", count, &[&arguments[..], &[threads]].concat()).output().expect("mpirun runs");
            assert_eq!(untimed(&output), untimed(&alone), "cyclic {n} on {count} ranks: {}", said(&output));
            assert!(output.status.success(), "{}", said(&output));
        }
    }
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn errors_are_said_once_and_end_all_ranks() {
    let folder = tempfile::tempdir().expect("directory");
    let system = written(folder.path(), "system.txt", "x^2 - 2\n");
    let open = written(folder.path(), "open.txt", "x^2 + y - 2\n");
    let missing = text(&folder.path().join("missing.txt"));
    for (arguments, words) in [
        (&["solve", &missing][..], "missing.txt"),
        (&["solve", &open], "1 equation in 2 unknowns"),
        (&["solve", &system, "--max-paths", "1"], "more than the 1 allowed"),
        (&["solve", &system, "--seed", "none"], "invalid value 'none'"),
        (&["solve", &system, "--rank-timeout", "0"], "--rank-timeout"),
        (&["decompose", &system], "only `hc solve`, `track`, `monodromy` and `mixed-volume` run on several ranks"),
    ] {
        let output = on_ranks("hc", 3, arguments).output().expect("mpirun runs");
        assert_eq!(output.status.code(), Some(2), "{words}: {}", said(&output));
        assert_eq!(said(&output).matches(words).count(), 1, "{words}: {}", said(&output));
        assert!(output.stdout.is_empty());
    }
    let help = on_ranks("hc", 3, &["solve", "--help"]).output().expect("mpirun runs");
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    assert_eq!(help.matches("--rank-timeout").count(), 1, "{help}");
    // Some commands are as ever on one rank.
    let output = on_ranks("hc", 1, &["decompose", &system]).output().expect("mpirun runs");
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn an_interrupt_of_rank_0_ends_all_with_what_there_is() {
    let folder = tempfile::tempdir().expect("directory");
    let system = written(folder.path(), "system.txt", &quadrics(18));
    let solve = &["solve", &system, "--start", "total-degree", "--json", "-", "--threads", "1"][..];
    let cyclic = written(folder.path(), "cyclic.txt", &cyclic(14));
    let volume = &["mixed-volume", &cyclic, "--json", "-", "--threads", "1"][..];
    for (name, arguments) in [("-INT", solve), ("-TERM", solve), ("-INT", volume)] {
        let mut command = on_ranks("hc", 3, arguments);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("mpirun runs");
        let first = waited(|| process(&child, 0));
        end_to_end::wait_for_handler(first);
        std::thread::sleep(Duration::from_millis(500));
        let begun = Instant::now();
        signal(name, first);
        let output = child.wait_with_output().expect("mpirun ends");
        assert!(begun.elapsed() < Duration::from_secs(60));
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        assert!(said(&output).contains("interrupted; the result is partial"), "{}", said(&output));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(result["partial"], true);
        // Of 8,795,976.
        assert!(result["mixed_volume"].as_u64().is_none_or(|volume| volume < 8_795_976), "{result}");
    }
}

#[test]
#[cfg_attr(not(feature = "mpi"), ignore = "needs Open MPI: cargo test -p end-to-end --features mpi")]
fn a_rank_that_dies_ends_all_and_the_checkpoint_goes_on() {
    let folder = tempfile::tempdir().expect("directory");
    let system = written(folder.path(), "system.txt", &quadrics(13));
    let directory = text(&folder.path().join("run"));
    let arguments = ["solve", &system, "--start", "total-degree", "--json", "-"];
    let expected = untimed(&run("hc", &[&arguments[..], &["--threads", "2"]].concat()));
    let recorded = [&arguments[..], &["--checkpoint", &directory, "--resume", "--threads", "1"]].concat();
    let done = || {
        let output = run("hc", &["solve", "--status", &directory]);
        let status: Option<serde_json::Value> = serde_json::from_slice(&output.stdout).ok();
        status.and_then(|status| status["done"].as_u64())
    };
    // Ten moments up to three quarters of the paths, and a little later; rank 0, another one, or all.
    let mut random = 1u64;
    let mut draw = |below: u64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let mut moments: Vec<[u64; 3]> = (0..10).map(|_| [draw(6144), draw(30), draw(3)]).collect();
    moments.sort_unstable();
    for [paths, milliseconds, which] in moments {
        let mut command = on_ranks("hc", 2, &recorded);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("mpirun runs");
        let ranks = [0, 1].map(|rank| waited(|| process(&child, rank)));
        // MPI has begun.
        ranks.into_iter().for_each(end_to_end::wait_for_handler);
        waited(|| done().or(Some(0)).filter(|&done| done >= paths));
        std::thread::sleep(Duration::from_millis(milliseconds));
        if which == 2 {
            signal("-KILL", child.id());
            ranks.into_iter().for_each(|rank| signal("-KILL", rank));
        } else {
            signal("-KILL", ranks[which as usize]);
        }
        assert!(!succeeds(child), "killed at {paths} paths");
    }
    let output = on_ranks("hc", 4, &recorded).output().expect("mpirun runs");
    assert_eq!(untimed(&output), expected, "{}", said(&output));
    assert!(said(&output).contains(&format!("{directory}: goes on after ")), "{}", said(&output));
}

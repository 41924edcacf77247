use super::*;
use crate::clocks::{Clocks, ReceiverClocks};
use crate::simulate::{SimulateOptions, simulate};

fn measured(receivers: usize, transmitters: usize) -> Pseudoranges {
    let options = SimulateOptions { receivers, transmitters, ..Default::default() };
    simulate(&options).unwrap().pseudoranges
}

#[test]
fn smallest_sizes_are_the_named_ones() {
    // From the excess formula: (m-3)(n-2) - 3.
    for (m, n) in [(6, 3), (5, 4), (4, 5), (100, 3), (4, 100)] {
        assert!(is_solvable::<2>(m, n, Emissions::Unknown), "{m}r/{n}s");
        assert_eq!(excess::<2>(m, n, Emissions::Unknown), (m as i64 - 3) * (n as i64 - 2) - 3);
    }
    for (m, n) in [(5, 3), (4, 4), (3, 100), (100, 2), (2, 2), (0, 0)] {
        assert!(!is_solvable::<2>(m, n, Emissions::Unknown), "{m}r/{n}s");
    }
}

#[test]
fn smallest_sizes_in_space() {
    // (m - 4)(n - 3) >= 6.
    assert_eq!(smallest::<2>(Emissions::Unknown), "6 receivers and 3 transmitters, 5 and 4, or 4 and 5");
    assert_eq!(smallest::<3>(Emissions::Unknown), "10 receivers and 4 transmitters, 7 and 5, 6 and 6, or 5 and 9");
    for (m, n) in [(9, 4), (6, 5), (5, 8), (4, 100), (100, 3)] {
        let error = usable::<3>(&measured(m, n)).unwrap_err().to_string();
        assert!(error.contains("in space are 10 receivers and 4 transmitters"), "{error}");
    }
    assert!(usable::<3>(&measured(5, 9)).is_ok());
}

#[test]
fn smallest_sizes_of_ranges() {
    // (m - 2)(n - 2) >= 1 in the plane, (m - 3)(n - 3) >= 3 in space.
    assert_eq!(smallest::<2>(Emissions::Known), "3 receivers and 3 transmitters");
    assert_eq!(smallest::<3>(Emissions::Known), "6 receivers and 4 transmitters, 5 and 5, or 4 and 6");
    let ranges = |m: usize, n: usize| measured(m, n).with_emissions(Emissions::Known);
    assert!(usable::<2>(&ranges(3, 3)).is_ok());
    for (m, n) in [(4, 6), (5, 5), (6, 4)] {
        assert!(usable::<3>(&ranges(m, n)).is_ok());
    }
    for (m, n) in [(3, 100), (100, 3), (4, 5), (5, 4)] {
        let error = usable::<3>(&ranges(m, n)).unwrap_err().to_string();
        assert!(error.contains("in space are 6 receivers and 4 transmitters, 5 and 5, or 4 and 6"), "{error}");
    }
    let error = usable::<3>(&ranges(5, 4)).unwrap_err().to_string();
    assert!(error.contains("add 1 receiver or 1 transmitter"), "{error}");
}

#[test]
fn smallest_sizes_of_ranges_with_a_constant() {
    // (m - 2)(n - 2) >= 2 in the plane, (m - 3)(n - 3) >= 4 in space.
    assert_eq!(smallest::<2>(Emissions::Constant), "4 receivers and 3 transmitters, or 3 and 4");
    assert_eq!(smallest::<3>(Emissions::Constant), "7 receivers and 4 transmitters, 5 and 5, or 4 and 7");
    let ranges = |m: usize, n: usize| measured(m, n).with_emissions(Emissions::Constant);
    assert!(usable::<2>(&ranges(3, 4)).is_ok() && usable::<2>(&ranges(4, 3)).is_ok());
    let error = usable::<2>(&ranges(3, 3)).unwrap_err().to_string();
    assert!(error.contains("add 1 receiver or 1 transmitter"), "{error}");
    // Recorders with clocks of their own have more unknowns.
    let measured = measured(4, 3).with_unknown_clocks(None);
    let clocks = Clocks { emissions: Emissions::Constant, receivers: ReceiverClocks::Offset, ..Default::default() };
    assert!(usable::<2>(&clocks.of(&measured)).is_err());
}

#[test]
fn too_small_says_what_to_add() {
    let error = usable::<2>(&measured(5, 3)).unwrap_err();
    assert!(error.to_string().contains("add 1 receiver or 1 transmitter"), "{error}");
    let error = usable::<2>(&measured(4, 2)).unwrap_err();
    assert!(error.to_string().contains("6 receivers and 3 transmitters"), "{error}");
    assert!(usable::<2>(&measured(6, 3)).is_ok());
}

#[test]
fn sparse_nodes_are_named_and_left_out() {
    let full = measured(7, 8);
    let mut values = full.dense();
    for i in 0..4 {
        values[i * 8 + 5] = f64::NAN;
    }
    let found = usable::<2>(&Pseudoranges::new(7, 8, values).unwrap()).unwrap();
    assert_eq!(found.transmitters, [0, 1, 2, 3, 4, 6, 7]);
    assert!(found.warnings[0].contains("s6"), "{:?}", found.warnings);
    let nothing = Pseudoranges::new(7, 8, vec![f64::NAN; 56]).unwrap();
    assert_eq!(usable::<2>(&nothing), Err(Degeneracy::NothingMeasured(56)));
}

#[test]
fn parts_that_share_no_node_are_told_apart() {
    let full = measured(12, 12);
    let block = |k: usize| (k / 12 < 7) == (k % 12 < 7);
    let found = usable::<2>(&full.filter(|i, j, _| block(12 * i + j))).unwrap();
    assert_eq!((found.receivers.len(), found.transmitters.len()), (7, 7));
    let without = "without receivers r8, r9, r10, r11, r12, and transmitters s8, s9, s10, s11, s12;";
    assert!(found.warnings[0].contains(without), "{:?}", found.warnings);
}

#[test]
fn identical_receivers_are_named() {
    let full = measured(7, 6);
    let mut values = full.dense();
    for j in 0..6 {
        values[4 * 6 + j] = values[6 + j] + 0.25;
    }
    let error = usable::<2>(&Pseudoranges::new(7, 6, values).unwrap()).unwrap_err();
    assert!(error.to_string().contains("receivers r2 and r5"), "{error}");
}

#[test]
fn repeated_transmitters_add_nothing() {
    let full = measured(5, 5);
    let mut values = full.dense();
    for i in 0..5 {
        values[i * 5 + 1] = values[i * 5] + 3.0;
        values[i * 5 + 2] = values[i * 5] - 1.0;
    }
    let error = usable::<2>(&Pseudoranges::new(5, 5, values.clone()).unwrap()).unwrap_err();
    assert!(matches!(error, Degeneracy::TooSmall { transmitters: 3, .. }), "{error}");
    // With gaps they are no copies, but as good as.
    (values[1], values[7]) = (f64::NAN, f64::NAN);
    let error = usable::<2>(&Pseudoranges::new(5, 5, values).unwrap()).unwrap_err();
    assert!(matches!(error, Degeneracy::TooSmall { transmitters: 3, .. }), "{error}");
}

/// A tag that stands still sends the same from its first place and from another.
#[test]
fn copies_count_once() {
    let full = measured(6, 9);
    let mut values = full.dense();
    for i in 0..6 {
        values[i * 9 + 3] = values[i * 9 + 1] + 3.0;
        values[i * 9 + 4] = values[i * 9 + 1];
        values[i * 9 + 8] = values[i * 9 + 6] - 1.5;
    }
    let found = usable::<2>(&Pseudoranges::new(6, 9, values).unwrap()).unwrap();
    assert_eq!(found.transmitters, [0, 1, 2, 5, 6, 7]);
    let said = &found.warnings[0];
    assert!(["s4 as s2", "s5 as s2", "s9 as s7"].iter().all(|copy| said.contains(copy)), "{said}");
}

//! Tests of the measurement matrix.

use super::*;

#[test]
fn select_keeps_order_names_and_sigmas() {
    let f = Pseudoranges::new(2, 3, vec![0.0, 1.0, 2.0, 10.0, 11.0, f64::NAN]).unwrap();
    let f = f.with_sigmas(vec![0.1, 0.2, 0.3, 0.4, 0.5, f64::NAN]).unwrap();
    let g = f.select(&[1, 0], &[2, 0]);
    assert_eq!((g.get(0, 0), g.get(0, 1), g.get(1, 0), g.get(1, 1)), (None, Some(10.0), Some(2.0), Some(0.0)));
    assert_eq!(g.receiver_names(), ["r2", "r1"]);
    assert_eq!(g.transmitter_names(), ["s3", "s1"]);
    assert_eq!((g.sigma(0, 0), g.sigma(1, 0)), (None, Some(0.3)));
    assert_eq!(g.configuration(), "2r/2s");
}

#[test]
fn candidates_go_with_their_cells() {
    let f = Pseudoranges::new(2, 3, vec![0.0, 1.0, 2.0, 10.0, 11.0, f64::NAN]).unwrap();
    assert!(!f.has_candidates() && f.clone().with_candidates([(0, 0, f64::NAN)]).unwrap().candidates.is_none());
    let f = f.with_candidates([(1, 0, 12.0), (0, 2, 3.0), (1, 0, 9.0)]).unwrap();
    let f = f.with_candidates([(0, 2, 4.0), (0, 0, 5.0)]).unwrap();
    assert_eq!((f.candidates(1, 0), f.candidates(0, 2)), (&[10.0, 12.0, 9.0][..], &[2.0, 3.0, 4.0][..]));
    assert_eq!((f.candidates(0, 1), f.candidates(1, 2), f.candidates(7, 7)), (&[1.0][..], &[][..], &[][..]));

    let chosen = f.choosing(|i, _, _| i + 1);
    let values = |f: &Pseudoranges| [f.get(0, 0), f.get(0, 1), f.get(0, 2), f.get(1, 0)].map(Option::unwrap);
    assert_eq!((values(&f), values(&chosen)), ([0.0, 1.0, 2.0, 10.0], [5.0, 1.0, 3.0, 9.0]));
    // One that is not there.
    assert_eq!(values(&f.choosing(|_, _, _| 7)), values(&f));
    let moved = chosen.map(|i, j, value| value + (10 * i + j) as f64);
    assert_eq!((values(&moved), moved.candidates(0, 2)), ([5.0, 2.0, 5.0, 19.0], &[4.0, 5.0, 6.0][..]));
    let turned = chosen.select(&[1, 0], &[2, 0]);
    assert_eq!((turned.get(0, 1), turned.candidates(1, 0)), (Some(9.0), &[2.0, 3.0, 4.0][..]));
    assert!(!f.select(&[0, 1], &[1]).has_candidates());
    let some = chosen.filter(|i, _, _| i == 1);
    assert_eq!((some.candidates(0, 0), some.candidates(1, 0).len()), (&[][..], 3));

    for (i, j, value, said) in [
        (1, 2, 1.0, "receiver r2, transmitter s3 has further candidates but no first"),
        (0, 3, 1.0, "receiver 1, transmitter 4: there are only 2r/3s"),
        (0, 0, f64::INFINITY, "receiver r1, transmitter s1: inf is not a usable"),
    ] {
        assert!(f.clone().with_candidates([(i, j, value)]).unwrap_err().to_string().starts_with(said));
    }
}

#[test]
fn refuses_what_is_no_matrix() {
    assert!(matches!(Pseudoranges::new(0, 3, vec![]), Err(PseudorangeError::Empty { .. })));
    assert!(matches!(Pseudoranges::new(usize::MAX, 2, vec![]), Err(PseudorangeError::TooLarge { .. })));
    assert!(matches!(Pseudoranges::new(2, 2, vec![0.0; 3]), Err(PseudorangeError::Count { found: 3, .. })));
    for bad in [f64::INFINITY, f64::NEG_INFINITY, 2e12] {
        let error = Pseudoranges::new(1, 2, vec![0.0, bad]).unwrap_err();
        assert!(error.to_string().starts_with("receiver r1, transmitter s2"), "{error}");
    }
    let f = Pseudoranges::new(1, 2, vec![0.0, 1.0]).unwrap();
    assert!(matches!(f.clone().with_sigmas(vec![1.0, 0.0]), Err(PseudorangeError::Sigma { .. })));
    let twice = Pseudoranges::from_cells(2, 2, [(1, 0, 1.0), (0, 1, 2.0), (1, 0, f64::NAN), (1, 0, 3.0)]);
    assert_eq!(twice.unwrap_err(), PseudorangeError::Twice { receiver: 2, transmitter: 1 });
    let outside = Pseudoranges::from_cells(2, 2, [(0, 2, 1.0)]).unwrap_err();
    assert_eq!(outside.to_string(), "receiver 1, transmitter 3: there are only 2r/2s");
    let twice = f.with_names(vec!["a".into()], vec!["b".into(), "b".into()]);
    assert!(matches!(twice, Err(PseudorangeError::DuplicateName { kind: "transmitter", .. })));
}

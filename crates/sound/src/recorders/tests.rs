//! Recorders are aligned as the truth is, or not at all.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::align::align;
use super::{Alignment, AlignmentOptions, UnalignedReason};
use crate::events::{EventOptions, Onset};

/// How onsets are made: sound takes 87 ms over the extent, and onsets are right to 1 ms.
const SPREAD: f64 = 30.0 / 343.0;
const ONSET: f64 = 1e-3;

/// A recorder: start in seconds, rate in parts per million, for how long it runs, and from how far it hears sounds, as a share
/// of the extent.
#[derive(Debug, Clone, Copy)]
struct Clock {
    start: f64,
    rate: f64,
    length: f64,
    reach: f64,
}

const CLOCK: Clock = Clock { start: 0.0, rate: 0.0, length: 100.0, reach: 1.0 };

impl Clock {
    fn own(&self, time: f64) -> f64 {
        (1.0 + self.rate * 1e-6) * (time - self.start)
    }

    /// The onsets of two channels: of sounds at these times on ways of up to the extent, of which a share is missed, and
    /// false ones, as a share of the sounds.
    fn heard(&self, times: &[f64], missed: f64, wrong: f64, rng: &mut Pcg64Mcg) -> Vec<Vec<Onset>> {
        let channel = |_| {
            let mut all: Vec<f64> = Vec::new();
            for time in times {
                if rng.random::<f64>() >= missed {
                    all.push(self.own(time + self.reach * SPREAD * rng.random::<f64>()) + ONSET * rng.random::<f64>());
                }
                if rng.random::<f64>() < wrong {
                    all.push(self.length * rng.random::<f64>());
                }
            }
            all.retain(|seconds| (0.0..self.length).contains(seconds));
            all.sort_by(f64::total_cmp);
            all.into_iter().map(|seconds| Onset { seconds, strength_db: 20.0 + 15.0 * rng.random::<f64>() }).collect()
        };
        (0..2).map(channel).collect()
    }
}

/// So many times that are uneven: a pause between two is up to three times as long as another.
fn uneven(count: usize, rng: &mut Pcg64Mcg) -> Vec<f64> {
    let mut time = 0.0;
    let mut next = |_| {
        time += 1.0 + 2.0 * rng.random::<f64>();
        time
    };
    (0..count).map(&mut next).collect()
}

fn aligned(recorders: &[Vec<Vec<Onset>>]) -> Alignment {
    align(recorders, &EventOptions::default(), &AlignmentOptions::default())
}

/// By how much an alignment is wrong at most in this time, seconds.
fn error(alignment: &Alignment, clocks: &[Clock], times: &[f64]) -> f64 {
    let reference = clocks[alignment.recorders[0].recorder];
    let mut most: f64 = 0.0;
    for recorder in &alignment.recorders {
        let clock = clocks[recorder.recorder];
        for &time in times {
            most = most.max((recorder.common(clock.own(time)) - reference.own(time)).abs());
            assert!((recorder.own(recorder.common(time)) - time).abs() < 1e-9);
        }
    }
    most
}

#[test]
fn recorders_minutes_apart_are_aligned() {
    let rng = &mut Pcg64Mcg::seed_from_u64(1);
    let times = uneven(300, rng);
    let clock = |start: f64, rate: f64| Clock { start, rate, length: 600.0, ..CLOCK };
    let clocks = [clock(-10.0, 40.0), clock(290.0, -100.0), clock(-310.0, 100.0), clock(60.0, 0.0)];
    let heard: Vec<_> = clocks.iter().map(|clock| clock.heard(&times, 0.1, 0.1, rng)).collect();
    let alignment = aligned(&heard);
    assert_eq!(alignment.recorders.len(), 4, "{alignment:?}");
    // All run from 290 to 290 s. The second and the third have nothing in common; the mean of many ways is near.
    let worst = error(&alignment, &clocks, &[0.0, 100.0, 290.0, 500.0]);
    assert!(worst < 0.03, "{worst} {alignment:?}");
    for recorder in &alignment.recorders {
        let relative = clocks[recorder.recorder].rate - 40.0;
        assert!((recorder.rate - relative).abs() < 4.0 * recorder.rate_sigma.max(1.0), "{alignment:?}");
        assert!(recorder.matched > 70 && recorder.scatter < SPREAD / 2.0, "{alignment:?}");
    }
}

#[test]
fn regular_sounds_are_ambiguous() {
    let rng = &mut Pcg64Mcg::seed_from_u64(2);
    let times: Vec<f64> = (0..20).map(|k| 1.0 + 1.5 * f64::from(k)).collect();
    let clock = |start: f64| Clock { start, rate: 20.0, ..CLOCK };
    let clocks = [clock(0.0), clock(-40.0), clock(7.0)];
    let heard: Vec<_> = clocks.iter().map(|clock| clock.heard(&times, 0.0, 0.0, rng)).collect();
    let alignment = aligned(&heard);
    assert_eq!((alignment.recorders.len(), alignment.unaligned.len()), (1, 2), "{alignment:?}");
    for unaligned in &alignment.unaligned {
        let UnalignedReason::Ambiguous { start, other_start, other: 0, matched, other_matched } = unaligned.reason
        else {
            panic!("{unaligned:?}");
        };
        // The third recorder may have missed the first five; two thirds of what matches are said to be about as many.
        assert!(matched >= 15 && 3 * other_matched >= 2 * matched, "{unaligned:?}");
        // The offsets are some periods apart, and one is some periods from the truth.
        for apart in [other_start - start, start - clocks[unaligned.recorder].start] {
            assert!((apart - 1.5 * (apart / 1.5).round()).abs() < 2.0 * SPREAD, "{unaligned:?}");
        }
        assert!((other_start - start).abs() > 1.0);
    }
    let said = alignment.unaligned[0].to_string();
    assert!(said.starts_with("recorder 2 is left out: beside recorder 1 it was started at"), "{said}");
}

#[test]
fn strangers_and_the_silent_are_named() {
    let rng = &mut Pcg64Mcg::seed_from_u64(3);
    let (here, elsewhere) = (uneven(25, rng), uneven(25, rng));
    let late = Clock { start: 12.0, ..CLOCK };
    let mut heard = |times: &[f64], clock: Clock| clock.heard(times, 0.05, 0.05, rng);
    let recorders =
        [heard(&elsewhere, CLOCK), heard(&here, CLOCK), vec![], heard(&here, late), heard(&here[..1], CLOCK)];
    let alignment = aligned(&recorders);
    // The reference is the first of those that heard the same.
    assert_eq!(alignment.recorders.iter().map(|r| r.recorder).collect::<Vec<_>>(), [1, 3], "{alignment:?}");
    assert_eq!(alignment.recorders[0].start, 0.0);
    assert!((alignment.recorders[1].start - 12.0).abs() < SPREAD, "{alignment:?}");
    let reasons: Vec<_> = alignment.unaligned.iter().map(|unaligned| (unaligned.recorder, unaligned.reason)).collect();
    assert!(matches!(reasons[0], (0, UnalignedReason::OtherSounds { heard: 20.. })), "{reasons:?}");
    assert_eq!(reasons[1], (2, UnalignedReason::TooFewSounds { heard: 0, least: 4 }));
    assert!(matches!(reasons[2], (4, UnalignedReason::TooFewSounds { heard: ..4, least: 4 })), "{reasons:?}");
    // There may be nothing at all.
    assert_eq!(aligned(&[]).recorders.len(), 0);
    let alone = aligned(&recorders[..1]);
    assert_eq!((alone.recorders.len(), alone.unaligned.len()), (1, 0));
    let silent = aligned(&[vec![], vec![vec![], vec![]]]);
    assert_eq!((silent.recorders[0].recorder, silent.unaligned.len()), (0, 1));
}

#[test]
fn three_recorders_must_agree() {
    let rng = &mut Pcg64Mcg::seed_from_u64(4);
    // Each two heard other sounds together, at offsets that do not fit: 0 to 1 by 5 s, 1 to 2 by 5 s, 0 to 2 by 30 s.
    let sets: Vec<Vec<f64>> = (0..3).map(|_| uneven(20, rng)).collect();
    let clock = |start: f64| Clock { start, length: 1e3, ..CLOCK };
    let mut heard = |parts: [(usize, f64); 2]| {
        let [first, second] = parts.map(|(set, late)| clock(-late).heard(&sets[set], 0.0, 0.0, rng));
        [first, second].concat()
    };
    let recorders = [heard([(0, 0.0), (1, 100.0)]), heard([(0, 5.0), (2, 200.0)]), heard([(1, 130.0), (2, 205.0)])];
    let alignment = aligned(&recorders);
    assert_eq!(alignment.recorders.len(), 1, "{alignment:?}");
    for unaligned in &alignment.unaligned {
        let UnalignedReason::Contradiction { seconds, .. } = unaligned.reason else { panic!("{unaligned:?}") };
        assert!((seconds - 20.0).abs() < 4.0 * SPREAD, "{unaligned:?}");
    }
}

#[test]
fn very_many_onsets_take_bounded_work() {
    let rng = &mut Pcg64Mcg::seed_from_u64(5);
    let length = 40_000.0;
    let recorder = |count: usize, rng: &mut Pcg64Mcg| -> Vec<Vec<Onset>> {
        let mut seconds: Vec<f64> = (0..count).map(|_| length * rng.random::<f64>()).collect();
        seconds.sort_by(f64::total_cmp);
        let strength = |seconds| Onset { seconds, strength_db: 20.0 + 15.0 * rng.random::<f64>() };
        vec![seconds.into_iter().map(strength).collect()]
    };
    let recorders: Vec<_> = [300_000, 300_000, 5].iter().map(|&count| recorder(count, rng)).collect();
    let alignment = aligned(&recorders);
    assert_eq!((alignment.recorders.len(), alignment.unaligned.len()), (1, 2), "{alignment:?}");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 40,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(0),
        ..ProptestConfig::default()
    })]

    #[test]
    fn recorders_are_aligned_as_the_truth_is(
        clocks in prop::collection::vec((-300.0..100.0_f64, -100.0..100.0_f64), 2..6),
        count in 20..120_usize,
        missed in 0.0..0.25_f64,
        wrong in 0.0..0.5_f64,
        seed in any::<u64>(),
    ) {
        let rng = &mut Pcg64Mcg::seed_from_u64(seed);
        let times: Vec<f64> = uneven(count, rng).into_iter().map(|time| time + 100.0).collect();
        let clocks: Vec<Clock> =
            clocks.into_iter().map(|(start, rate)| Clock { start, rate, length: 800.0, ..CLOCK }).collect();
        let heard: Vec<_> = clocks.iter().map(|clock| clock.heard(&times, missed, wrong, rng)).collect();
        let alignment = aligned(&heard);
        prop_assert_eq!(alignment.recorders.len(), clocks.len(), "{:?}", alignment);
        // The mean of the ways to two recorders differs by less than the extent.
        let worst = error(&alignment, &clocks, &times);
        prop_assert!(worst < SPREAD, "{} {:?}", worst, alignment);
        for recorder in &alignment.recorders {
            let relative = clocks[recorder.recorder].rate - clocks[0].rate;
            prop_assert!((recorder.rate - relative).abs() < 5.0 * recorder.rate_sigma + 0.02, "{:?}", alignment);
        }
    }

    /// From perfectly regular sounds to uneven ones, and few to many: what is aligned is right.
    #[test]
    fn nothing_is_aligned_by_a_wrong_period(
        starts in prop::collection::vec(-30.0..30.0_f64, 2..4),
        count in 4..40_i32,
        jitter in 0.0..1.0_f64,
        reach in 0.1..1.0_f64,
        missed in 0.0..0.3_f64,
        seed in any::<u64>(),
    ) {
        let rng = &mut Pcg64Mcg::seed_from_u64(seed);
        let times: Vec<f64> = (0..count).map(|k| 1.5 * f64::from(k) + jitter * rng.random::<f64>()).collect();
        let clock = |start| Clock { start, length: 150.0, reach, ..CLOCK };
        let clocks: Vec<Clock> = starts.into_iter().map(clock).collect();
        let heard: Vec<_> = clocks.iter().map(|clock| clock.heard(&times, missed, 0.1, rng)).collect();
        let alignment = aligned(&heard);
        let worst = error(&alignment, &clocks, &times);
        prop_assert!(worst < SPREAD + 3e-3, "{} {:?}", worst, alignment);
    }

    #[test]
    fn any_onsets_are_aligned_or_not(
        recorders in prop::collection::vec(
            prop::collection::vec(prop::collection::vec((any::<f64>(), any::<f64>()), 0..12), 0..3), 0..5
        ),
    ) {
        let onset = |&(seconds, strength_db): &(f64, f64)| Onset { seconds, strength_db };
        let channel = |onsets: &Vec<(f64, f64)>| onsets.iter().map(onset).collect();
        let recorders: Vec<Vec<Vec<Onset>>> =
            recorders.iter().map(|channels| channels.iter().map(channel).collect()).collect();
        let Alignment { recorders: aligned, unaligned } = aligned(&recorders);
        prop_assert_eq!(aligned.len() + unaligned.len(), recorders.len());
        for recorder in aligned {
            prop_assert!([recorder.start, recorder.rate, recorder.rate_sigma, recorder.scatter].iter().all(|x| x.is_finite()));
        }
    }
}

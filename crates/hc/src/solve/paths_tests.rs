//! Batches may come from anywhere, in any order.

use super::{CHUNK, CoefficientStage, End, Route};
use crate::endgame::Ending;
use crate::family::Fibre;
use crate::monitor::Monitor;
use crate::refine::LaneRefiners;
use crate::runner::{Round, Work};
use crate::solve::excess::Excess;
use crate::solve::record::Record;
use crate::solve::solutions::Direction;
use crate::tracker::Trackers;
use crate::{Family, SolveOptions};
use num_complex::Complex64;
use poly::Evaluate;

/// From the fourth roots of one to `x^3 - 2 x^2 + x`: a double root at 1, a simple one at 0, one at
/// infinity.
const FAMILY: &str = "name = \"quartic\"\nunknowns = [\"x\"]\nparameters = [\"a\", \"b\", \"c\", \"d\", \"e\"]\n\
    equations = [\"a*x^4 + b*x^3 + c*x^2 + d*x + e\"]";
const TARGET: [f64; 5] = [0.0, 1.0, -2.0, 1.0, 0.0];

/// What a route needs besides its paths.
struct Surroundings {
    excess: Excess<'static>,
    options: SolveOptions,
    monitor: Monitor,
}

impl Default for Surroundings {
    fn default() -> Surroundings {
        Surroundings { excess: Excess::none(), options: SolveOptions::default(), monitor: Monitor::default() }
    }
}

impl Surroundings {
    /// From all points of a fibre.
    fn route<'a, 'e, E: Evaluate>(
        &'a self,
        (trackers, refiners): &'a (Trackers<'e, E>, LaneRefiners<'e, E>),
        start: &'a Fibre,
        target: &'a [Complex64],
    ) -> Route<'a, 'e, E, Fibre> {
        let Surroundings { excess, options, monitor } = self;
        let count = start.len();
        Route {
            trackers,
            refiners,
            start,
            count,
            target,
            excess,
            options,
            monitor,
            record: None,
            lead: None,
            moving: None,
            has_other_ways: true,
        }
    }
}

#[test]
fn batches_are_absorbed_in_any_order() {
    let family: Family = FAMILY.parse().unwrap();
    // Generic coefficients of a monic quartic with these roots.
    let roots = [(0.3, 1.1), (-1.2, 0.4), (0.7, -0.9), (1.4, 0.6)].map(|(re, im)| Complex64::new(re, im));
    let mut coefficients = vec![Complex64::from(1.0)];
    for root in roots {
        coefficients.push(Complex64::from(0.0));
        for k in (1..coefficients.len()).rev() {
            let below = coefficients[k - 1];
            coefficients[k] -= root * below;
        }
    }
    let fibre = Fibre::new(coefficients, 1, roots.to_vec());
    let target = TARGET.map(Complex64::from);
    let surroundings = Surroundings::default();
    let trackers = (Trackers::new(family.program()), LaneRefiners::new(family.program()));
    let route = || surroundings.route(&trackers, &fibre, &target);

    // Records of batches of some paths, through the text that another machine would send.
    let batches = |cuts: &[&[usize]]| -> Vec<Vec<Record>> {
        let stage = CoefficientStage::new(route(), false);
        let batch = |numbers: &&[usize]| {
            let mut records = Vec::new();
            stage.batch(&mut (), numbers, Round::FIRST, &mut records);
            let open: Vec<Record> = records.extract_if(.., |record| record.is_open()).collect();
            records.extend(stage.ended(&open, Round::FIRST, &surroundings.monitor));
            let text = serde_json::to_string(&records).unwrap();
            let back: Vec<Record> = serde_json::from_str(&text).unwrap();
            assert_eq!(back, records);
            back
        };
        cuts.iter().map(batch).collect()
    };
    let absorbed = |batches: Vec<Vec<Record>>| {
        let mut stage = CoefficientStage::new(route(), false);
        for mut batch in batches {
            stage.absorb(&mut batch, Round::FIRST);
        }
        let doubts = stage.doubts();
        let ends: Vec<End> = (0..4).map(|path| stage.ends.get(path)).collect();
        (ends, stage.ends.regular.clone(), stage.ends.singular.clone(), stage.directions.clone(), doubts)
    };

    let whole = absorbed(batches(&[&[0, 1, 2, 3]]));
    let count = |end: End| whole.0.iter().filter(|&&e| e == end).count();
    let infinite = whole.0.iter().filter(|end| end.direction().is_some()).count();
    assert_eq!((count(End::SOLUTION), count(End::SINGULAR), infinite), (1, 2, 1));
    assert!(whole.4.is_empty(), "{:?}", whole.4);
    let single = batches(&[&[0], &[1], &[2], &[3]]);
    for order in [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1], [1, 3, 0, 2]] {
        assert_eq!(absorbed(order.map(|k| single[k].clone()).to_vec()), whole, "{order:?}");
    }
    let pairs = batches(&[&[1, 2], &[0, 3]]);
    assert_eq!(absorbed(pairs), whole);
    // A record of a later round takes the place of an earlier one.
    let mut again = single.clone();
    again[2] = vec![Record::lost(2)];
    again.push(single[2].clone());
    assert_eq!(absorbed(again), whole);
    assert!(single.iter().flatten().all(|record| !matches!(record.end, Ending::Lost)));
    assert!(whole.0.len() < CHUNK);
}

/// `x = 1 / t` and `y = t^(3/2)`: one cycle of two paths. Where the endgame begins, `y` is so much smaller
/// than `x` that `y` and `-y` are one number on the scale of `x`.
#[test]
fn small_coordinates_tell_the_winding_number() {
    let family =
        "name = \"cusp\"\nunknowns = [\"x\", \"y\"]\nparameters = [\"p\"]\nequations = [\"x*p - 1\", \"y^2 - p^3\"]";
    let family: Family = family.parse().unwrap();
    let one = Complex64::from(1.0);
    // From p = i, so that the path meets no singularity of the parameter but the last.
    let (p, y) = (Complex64::i(), Complex64::from_polar(1.0, 0.75 * std::f64::consts::PI));
    let fibre = Fibre::new(vec![p], 2, vec![one / p, y, one / p, -y]);
    let target = [Complex64::from(0.0)];
    let surroundings = Surroundings::default();
    let trackers = (Trackers::new(family.program()), LaneRefiners::new(family.program()));
    let route = surroundings.route(&trackers, &fibre, &target);
    let mut ends = super::follow(route, false);
    assert_eq!(ends.lost(), 0);
    assert_eq!(ends.directions, [Direction { valuations: vec![-2, 3], denominator: 2, paths: 2 }]);
}

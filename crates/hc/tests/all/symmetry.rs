//! Families with stated symmetries.

use hc::poly::Complex64;
use hc::{Family, FamilyError, MonodromyOptions};

/// `x^2 = p`, `y^2 = q` has four solutions; signs change one by one.
const SQUARES: &str = r#"
    name = "squares"
    unknowns = ["x", "y"]
    parameters = ["p", "q"]
    equations = ["x^2 - p", "y^2 - q"]
    symmetry = [["-x", "y"], ["x", "-y"]]
"#;

fn options() -> MonodromyOptions {
    MonodromyOptions::new()
}

/// Points and multiplicities, to three decimals, sorted.
fn listed(found: &hc::Solutions) -> Vec<(Vec<i64>, usize)> {
    let rounded = |z: &Complex64| [(z.re * 1e3).round() as i64, (z.im * 1e3).round() as i64];
    let mut all: Vec<_> = found.iter().map(|s| (s.value.iter().flat_map(rounded).collect(), s.multiplicity)).collect();
    all.sort();
    all
}

#[test]
fn one_path_for_each_orbit_finds_all() {
    let family: Family = SQUARES.parse().unwrap();
    let fibre = family.monodromy(&options()).unwrap().fibre;
    assert_eq!((fibre.len(), fibre.representatives.as_ref().unwrap().len()), (4, 1));
    let found = &family.track(&fibre, &[[4.0, 9.0]]).run().unwrap()[0];
    let expected = [[-2, -3], [-2, 3], [2, -3], [2, 3]];
    assert_eq!(listed(found), expected.map(|[x, y]| (vec![x * 1000, 0, y * 1000, 0], 1)).to_vec());
    assert_eq!(found.paths.tracked, 1);
}

#[test]
fn multiplicities_count_all_paths_where_images_meet() {
    let family: Family = SQUARES.parse().unwrap();
    let fibre = family.monodromy(&options()).unwrap().fibre;
    // x = 0 is double: both signs of x end there.
    let found = &family.track(&fibre, &[[0.0, 9.0]]).run().unwrap()[0];
    assert_eq!(listed(found), [-3000, 3000].map(|y| (vec![0, 0, y, 0], 2)).to_vec());
    let found = &family.track(&fibre, &[[0.0, 0.0]]).run().unwrap()[0];
    assert_eq!(found.iter().map(|s| s.multiplicity).collect::<Vec<_>>(), [4]);
}

#[test]
fn a_path_at_infinity_takes_its_orbit_along() {
    // x^2 = p / q: both solutions are at infinity where q vanishes.
    let family: Family = r#"
        name = "quotient"
        unknowns = ["x", "y"]
        parameters = ["p", "q", "r"]
        equations = ["q*x^2 - p", "y^2 - r"]
        symmetry = [["-x", "y"]]
    "#
    .parse()
    .unwrap();
    let fibre = family.monodromy(&options()).unwrap().fibre;
    assert_eq!(fibre.len(), 4);
    let found = &family.track(&fibre, &[[1.0, 0.0, 3.0], [1.0, 4.0, 2.5]]).run().unwrap();
    assert!(found[0].is_empty());
    assert_eq!(listed(&found[1]).len(), 4);
}

/// Of the solutions of each target one of each orbit, and how many it stands for.
#[test]
fn solutions_are_listed_up_to_symmetry_on_request() {
    let family: Family = SQUARES.parse().unwrap();
    let fibre = family.monodromy(&options()).unwrap().fibre;
    let targets = [[4.0, 9.0], [0.0, 9.0], [0.0, 0.0], [-4.0, 9.0]];
    let found = family.track(&fibre, &targets).up_to_symmetry(true).run().unwrap();
    let counts = |found: &hc::Solutions| (found.len(), found.represents.clone(), found.count());
    assert_eq!(found.iter().map(counts).collect::<Vec<_>>(), [4, 2, 1, 4].map(|n| (1, vec![n], n)).to_vec());
    assert_eq!(found.iter().map(|found| found.solutions[0].multiplicity).collect::<Vec<_>>(), [1, 2, 4, 1]);
    assert!(found[0].to_string().starts_with("4 isolated solutions, 1 up to symmetry; 1 of these real\n"));
    let all = family.track(&fibre, &targets).run().unwrap();
    assert!(all.iter().all(|found| found.represents.is_empty() && found.count() == found.len()));

    // Roots of x^4 = p are multiples of a real one by powers of i.
    let powers: Family =
        "name = ''\nunknowns = ['x']\nparameters = ['p']\nequations = ['x^4 - p']\nsymmetry = [['i*x']]"
            .parse()
            .unwrap();
    let fibre = powers.monodromy(&options()).unwrap().fibre;
    let track = || powers.track(&fibre, &[[16.0]]).up_to_symmetry(true);
    let found = &track().run().unwrap()[0];
    assert!(found.represents == [4] && found.solutions[0].is_real, "{found}");
    assert_eq!(track().only_real(true).run().unwrap()[0].represents, [2]);
    let mut certified = hc::SolveOptions::new();
    certified.certify = true;
    assert_eq!(track().options(&certified).run().unwrap()[0].solutions[0].certified, Some(true));

    let none = Family::from_formulas(&["x"], &["p"], &["x^4 - p"]).unwrap();
    let refused = none.track(&fibre, &[[16.0]]).up_to_symmetry(true).run().unwrap_err();
    assert_eq!(refused, FamilyError::NoSymmetry);
}

#[test]
fn maps_that_are_no_symmetry_are_refused() {
    let wrong = SQUARES.replace("[\"x\", \"-y\"]", "[\"x\", \"2*y\"]");
    let family: Family = wrong.parse().unwrap();
    assert_eq!(family.monodromy(&options()).unwrap_err(), FamilyError::NotSymmetric { map: 2 });
    // Nor are they believed of a fibre from elsewhere.
    let roots = [[2.0, 3.0], [2.0, -3.0], [-2.0, 3.0], [-2.0, -3.0]].concat();
    let numbers = |values: &[f64]| values.iter().map(|&v| Complex64::from(v)).collect();
    let mut fibre = hc::Fibre::new(numbers(&[4.0, 9.0]), 2, numbers(&roots));
    fibre.representatives = Some(vec![0]);
    let error = family.track(&fibre, &[[1.0, 1.0]]).run().unwrap_err();
    assert_eq!(error, FamilyError::NotSymmetric { map: 2 });
}

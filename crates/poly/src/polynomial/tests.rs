//! Ring laws over exact integers and rationals, and what must commute with evaluation.

use super::Polynomial;
use crate::monomial::Monomial;
use crate::{System, parse};
use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;

const N: usize = 3;

fn integers(least: i32) -> impl Strategy<Value = Polynomial<BigInt>> {
    let term = (proptest::collection::vec(least..4, N), -20i64..20);
    proptest::collection::vec(term, 0..7).prop_map(|terms| {
        Polynomial::from_terms(N, terms.into_iter().map(|(e, c)| (Monomial::new(e), BigInt::from(c))))
    })
}

fn rationals() -> impl Strategy<Value = Polynomial<BigRational>> {
    (integers(0), 1i64..30).prop_map(|(p, d)| p.map(|c| BigRational::new(c.clone(), BigInt::from(d))))
}

fn point() -> impl Strategy<Value = Vec<BigInt>> {
    proptest::collection::vec((-9i64..9).prop_map(BigInt::from), N)
}

fn check_ring<R: super::Ring + std::fmt::Debug>(
    a: &Polynomial<R>,
    b: &Polynomial<R>,
    c: &Polynomial<R>,
) -> Result<(), TestCaseError> {
    let (zero, one) = (Polynomial::zero(N), Polynomial::constant(N, R::one()));
    prop_assert_eq!(a + b, b + a);
    prop_assert_eq!(&(a + b) + c, a + &(b + c));
    prop_assert_eq!(a * b, b * a);
    prop_assert_eq!(&(a * b) * c, a * &(b * c));
    prop_assert_eq!(a * &(b + c), &(a * b) + &(a * c));
    prop_assert_eq!(a + &zero, a.clone());
    prop_assert_eq!(a * &one, a.clone());
    let same = a.clone();
    prop_assert_eq!(a - &same, zero);
    prop_assert_eq!(a - b, a + &-b);
    prop_assert_eq!(a.pow(3), &(a * a) * a);
    // The rule for products.
    let product_rule = &(&a.derivative(1) * b) + &(a * &b.derivative(1));
    prop_assert_eq!((a * b).derivative(1), product_rule);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn integers_form_a_ring(a in integers(-3), b in integers(-3), c in integers(-3)) {
        check_ring(&a, &b, &c)?;
    }

    #[test]
    fn rationals_form_a_ring(a in rationals(), b in rationals(), c in rationals()) {
        check_ring(&a, &b, &c)?;
    }

    #[test]
    fn evaluation_is_a_homomorphism(a in integers(0), b in integers(0), x in point()) {
        let at = |p: &Polynomial<BigInt>| p.evaluate(&x).unwrap();
        prop_assert_eq!(at(&(&a + &b)), at(&a) + at(&b));
        prop_assert_eq!(at(&(&a * &b)), at(&a) * at(&b));
        let mut moved = x.clone();
        moved[1] = at(&b);
        prop_assert_eq!(at(&a.substitute(1, &b).unwrap()), a.evaluate(&moved).unwrap());
    }

    #[test]
    fn homogenised_terms_have_one_degree(a in integers(0)) {
        let groups = [vec![0, 2], vec![1]];
        let h = a.homogenised(&groups);
        prop_assert_eq!(h.variables(), N + 2);
        prop_assert_eq!(h.len(), a.len());
        for groups in [[0, 2, 3].as_slice(), &[1, 4]] {
            let degrees: Vec<i64> = h.terms().iter().map(|(m, _)| super::terms::group_degree(m, groups)).collect();
            prop_assert!(degrees.windows(2).all(|d| d[0] == d[1]));
        }
        prop_assert_eq!(h.multidegree(&groups).is_none(), a.is_empty());
        // One new unknown set to one gives the old polynomial back.
        let ones = Polynomial::constant(N + 2, BigInt::from(1));
        let back = h.substitute(3, &ones).unwrap().substitute(4, &ones).unwrap();
        let wide = Polynomial::from_terms(N + 2, a.terms().iter().map(|(m, c)| {
            (Monomial::new(m.exponents().iter().copied().chain([0, 0])), c.clone())
        }));
        prop_assert_eq!(back, wide);
    }

    #[test]
    fn text_reads_back(a in integers(-3), d in 1i64..30) {
        let a = a.map(|c| BigRational::new(c.clone(), BigInt::from(d)));
        // The leading sums fix the order of the unknowns.
        let text = format!("1\nx - x + y - y + z - z + {};", a.display(&["x", "y", "z"]));
        let system = parse::phcpack(&text).unwrap();
        let read = system.expand(&Default::default()).unwrap();
        prop_assert_eq!(&read[0], &a.map(|c| num_complex::Complex::new(c.clone(), BigRational::from_integer(0.into()))));
        let again: System = system.to_string().parse().unwrap();
        prop_assert_eq!(again.expand(&Default::default()).unwrap(), read);
    }
}

#[test]
fn degrees_and_leading_terms() {
    let system = parse::phcpack("1\n 3*x^2*y - 5*y^4*z + z;").unwrap();
    let p = &system.expand(&Default::default()).unwrap()[0];
    assert_eq!(p.degree(), Some(5));
    assert_eq!(p.multidegree(&[vec![0], vec![1, 2]]), Some(vec![2, 5]));
    assert_eq!(p.leading_term().unwrap().0.exponents(), [0, 4, 1]);
    assert_eq!(p.support(), [[0, 4, 1], [2, 1, 0], [0, 0, 1]]);
    assert_eq!(Polynomial::<i64>::zero(2).degree(), None);
}

#[test]
fn systems_from_polynomials_expand_to_them() {
    let x = Polynomial::<i64>::variable(2, 0);
    let p = &x.pow(3) - &Polynomial::variable(2, 1).scaled(&7);
    let system = System::from_polynomials(&["x", "y"], std::slice::from_ref(&p)).unwrap();
    let expanded = system.expand(&Default::default()).unwrap();
    assert_eq!(expanded[0].display(&["x", "y"]).to_string(), "x^3 - 7*y");
    assert_eq!(expanded[0], p.map(|c| crate::exact::from_i64(*c)));
}

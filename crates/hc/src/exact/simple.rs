//! Whether two polynomials in two unknowns, or one in one, have no multiple roots, proved modulo
//! random primes by their eliminant.

use super::eliminant::Eliminant;
use crate::random::{Random, Stream};
use crate::singular::{PrimeField, Residue, is_squarefree};
use poly::{Exact, Polynomial};

/// Systems with more roots are not looked at.
const MAX_ROOTS: usize = 600;

/// Whether all common roots are isolated and simple; false tells nothing.
///
/// If the eliminant had a multiple root, so would its image modulo a prime, unless the leading
/// coefficient vanishes there: of all changes of coordinates, at most one in 1e13 does that. Two primes have to agree.
pub(super) fn all_simple(polynomials: &[Polynomial<Exact>], seed: u64) -> bool {
    if let [polynomial] = polynomials {
        return in_both(polynomials, seed, || coefficients(polynomial).map(is_squarefree)) == Some(true);
    }
    let mut random = Random::of(seed, Stream::Combinations);
    let simple = || {
        let found = eliminant(polynomials, &mut random)?;
        Some((found.degree(), is_squarefree(found.coefficients)))
    };
    in_both(polynomials, seed, simple).is_some_and(|(degree, simple)| degree > 0 && simple)
}

/// The number of all common roots, with their multiplicities, if they are isolated.
pub(super) fn finite_solutions(polynomials: &[Polynomial<Exact>], seed: u64) -> Option<usize> {
    let mut random = Random::of(seed, Stream::Combinations);
    in_both(polynomials, seed, || eliminant(polynomials, &mut random).map(|found| found.degree()))
}

/// What is the same modulo two primes, of which none divides a coefficient.
fn in_both<T: PartialEq>(
    polynomials: &[Polynomial<Exact>],
    seed: u64,
    mut work: impl FnMut() -> Option<T>,
) -> Option<T> {
    let coefficients = polynomials.iter().flat_map(|p| p.terms()).map(|(_, c)| c);
    let [first, second] = PrimeField::pair(seed, coefficients);
    let found = first.run(&mut work)?;
    (second.run(work)? == found).then_some(found)
}

/// The coefficients of a polynomial in one unknown modulo the prime of the thread, from the constant on; `None` if
/// the leading one vanishes, or the roots are too many.
fn coefficients(polynomial: &Polynomial<Exact>) -> Option<Vec<Residue>> {
    let degree = usize::try_from(polynomial.degree()?).ok().filter(|degree| (1..=MAX_ROOTS).contains(degree))?;
    let mut coefficients = vec![Residue::new(0); degree + 1];
    for (monomial, c) in polynomial.terms() {
        let [exponent] = monomial.exponents() else { return None };
        coefficients[usize::try_from(*exponent).ok()?] = Residue::image(c)?;
    }
    (coefficients[degree] != Residue::new(0)).then_some(coefficients)
}

/// The eliminant modulo the prime of the thread, after a random change of coordinates.
fn eliminant(polynomials: &[Polynomial<Exact>], random: &mut Random) -> Option<Eliminant<Residue>> {
    let t = Residue::random(random);
    Eliminant::new(polynomials, &t, MAX_ROOTS, Residue::image)
}

#[cfg(test)]
mod tests {
    use super::super::subresultants::Gaussian;
    use super::{Eliminant, Exact, PrimeField, Residue, all_simple, finite_solutions};
    use num_bigint::BigInt;
    use poly::parse::phcpack;

    #[test]
    fn numbers_of_finite_solutions() {
        let count = |text: &str| finite_solutions(&phcpack(text).unwrap().expand(&Default::default()).unwrap(), 0);
        assert_eq!(count("2\nx^2+y^2-5;\nx*y-2;"), Some(4));
        // Circles, parallel lines, a double point, a common line.
        assert_eq!(count("2\nx^2+y^2-5;\nx^2+y^2-x;"), Some(2));
        assert_eq!(count("2\nx+y-1;\nx+y-2;"), Some(0));
        assert_eq!(count("2\n(x-y)^3;\n(x+y)^2;"), Some(6));
        assert_eq!(count("2\n(x+y)*x;\n(x+y)*(y-2);"), None);
        assert_eq!(count("3\nx-1;\ny-1;\nz-1;"), None);
    }

    #[test]
    fn eliminants_modulo_the_prime_are_images_of_those_over_integers() {
        for text in ["2\nx^2*y-3*x+7;\ny^3-x*y+2;", "2\n(x-2*y)^2*(x+1);\nx*y-5;", "2\nx+y-1;\nx+y-2;"] {
            let polynomials = phcpack(text).unwrap().expand(&Default::default()).unwrap();
            let whole = |c: &Exact| Some(Gaussian::new(c.re.to_integer(), c.im.to_integer()));
            let integers = Eliminant::new(&polynomials, &BigInt::from(3).into(), 9, whole).unwrap();
            let image = |n: &Gaussian| Residue::image(&Exact::new(n.re.clone().into(), n.im.clone().into())).unwrap();
            for field in PrimeField::pair(0, std::iter::empty()) {
                field.run(|| {
                    let residues = Eliminant::new(&polynomials, &Residue::new(3), 9, Residue::image).unwrap();
                    assert_eq!(integers.coefficients.iter().map(image).collect::<Vec<_>>(), residues.coefficients);
                    assert_eq!(image(&integers.factor), residues.factor);
                });
            }
        }
    }

    #[test]
    fn simple_and_multiple_roots() {
        let simple = |text: &str| all_simple(&phcpack(text).unwrap().expand(&Default::default()).unwrap(), 0);
        assert!(simple("2\nx^2+y^2-5;\nx*y-2;"));
        assert!(simple("2\nx^21-2000000*x^2+4000*x-2;\ny-x^2+1;"));
        assert!(simple("2\n(1e9*(x+y-5)-1)*(1e9*(x+y-5)-2);\nx-2*y-3;"));
        assert!(simple("2\nx*y-1;\nx+y^2;"));
        assert!(simple("1\nx^3-2*x;") && !simple("1\nx^3-2*x^2;") && !simple("1\n(x^2+x+3)^2*(x-1);"));
        // Tangent, a double line, a common component, an imaginary double point.
        assert!(!simple("2\nx^2+y^2-1;\nx-1;"));
        assert!(!simple("2\n(x+y)^2;\nx-y-1;"));
        assert!(!simple("2\n(x+y)*x;\n(x+y)*(y-2);"));
        assert!(!simple("2\nx^2+y^2+1;\nx-i;"));
    }
}

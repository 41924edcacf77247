//! Solution sets of positive dimension, with dimensions and degrees from geometry or the
//! literature.

use hc::SolveOptions;
use hc::witness::{Decomposition, decompose};

fn decomposed(text: &str, seed: u64) -> Decomposition {
    let system = hc::poly::parse::phcpack(text).unwrap();
    decompose(&system, &SolveOptions::new().seed(seed)).unwrap()
}

/// Dimension, degree and multiplicity of each component, sorted, and the number of isolated
/// solutions; all shown to be irreducible.
fn check(text: &str, seeds: u64, components: &[(usize, usize, usize)], isolated: usize) {
    for seed in 0..seeds {
        let found = decomposed(text, seed);
        let mut have: Vec<_> = found.components.iter().map(|c| (c.dimension, c.degree, c.multiplicity)).collect();
        have.sort_unstable();
        have.reverse();
        assert_eq!((&have[..], found.isolated.len(), found.failed), (components, isolated, 0), "{text} {seed}");
        assert!(found.components.iter().all(|c| c.irreducible && c.witness_points.len() == c.degree), "{text} {seed}");
    }
}

/// Dimensions that would take too many paths are counted, not passed over.
#[test]
fn few_paths() {
    let system =
        hc::poly::parse::phcpack("4\na+b+c+d;\na*b+b*c+c*d+d*a;\na*b*c+b*c*d+c*d*a+d*a*b;\na*b*c*d-1;").unwrap();
    let found = decompose(&system, &SolveOptions::new().max_paths(3)).unwrap();
    assert_eq!(
        (&found.components[..], &found.unsearched[..], found.failed, found.partial),
        (&[][..], &[1, 0][..], 2, false)
    );
}

#[test]
fn curves() {
    check("3\nx-x+y-x^2;\nz-x*y;\nx*z-y^2;", 3, &[(1, 3, 1)], 0);
    // Three lines.
    check("2 3\nx*z+y;\ny*z+x;", 3, &[(1, 1, 1), (1, 1, 1), (1, 1, 1)], 0);
    // Cyclic-4: two conics.
    check("4\na+b+c+d;\na*b+b*c+c*d+d*a;\na*b*c+b*c*d+c*d*a+d*a*b;\na*b*c*d-1;", 2, &[(1, 2, 1), (1, 2, 1)], 0);
    // A double line and a point.
    check("2\n(x-y)^2*(x+y-1);\n(x-y)^2*(x+2*y+2);", 3, &[(1, 1, 2)], 1);
}

/// Coefficients that are multiples of large primes, just below powers of two and of the form 2^64 - 2^32 + 1.
#[test]
fn coefficients_that_primes_divide() {
    for prime in [(1u64 << 61) - 1, (1 << 63) - 25, u64::MAX - 58, 0xFFFF_FFFF_0000_0001] {
        check(&format!("1 2\n{prime}*x*y-3*{prime};"), 2, &[(1, 2, 1)], 0);
        check(&format!("2\n{prime}*(x-y)-1;\nx^2+y^2-3;"), 2, &[], 2);
        check(&format!("2 3\n{prime}*(x*y+z-x^2)-1;\nx^2+y^2+z^2-3;"), 2, &[(1, 4, 1)], 0);
        check(&format!("2 3\n(x*y+z-x^2)/{prime};\nx^2+y^2+z^2-3;"), 2, &[(1, 4, 1)], 0);
    }
}

/// Powers of ideals: of a circle, of several curves together, of the twisted cubic (the square of its
/// ideal of two equations, of length three), and of a plane with two lines across it.
#[test]
fn multiple_components() {
    check("1 2\n(x^2+y^2-1)^3;", 3, &[(1, 2, 3)], 0);
    check("1 2\n(x^2+y^2-1)^2*(x-2*y)^2*(y-x^3);", 3, &[(1, 3, 1), (1, 2, 2), (1, 1, 2)], 0);
    check("3\n(y-x^2)^2;\n(y-x^2)*(z-x*y);\n(z-x*y)^2;", 3, &[(1, 3, 3)], 0);
    check("2 3\nz^2*(x^2+y^2-1);\nz^2*(x-y);", 3, &[(2, 1, 2), (1, 1, 1), (1, 1, 1)], 0);
}

/// Sums that are multiplied many times have unknowns of their own, which neither hyperplanes nor degrees see:
/// thirty parallel planes meet a parabolic cylinder in conics; an equation between powers, tenth and fifth, is
/// five quartics, one for each root of unity; lines and a conic of high multiplicity hide a point each; curves
/// of several multiplicities lie together; two surfaces are graphs of powers.
#[test]
fn sums_that_are_multiplied() {
    check("2 3\n(x+y+z)^30-1;\nx-y^2;", 3, &[(1, 2, 1); 30], 0);
    check("1 3\n(x^2+y^2+z^2-1)^10-(z-2)^5;", 2, &[(2, 4, 1); 5], 0);
    check("2\n(x+y)^6*(x-1);\n(x+y)^6*(y-2);", 6, &[(1, 1, 6)], 1);
    check("2\n(x+y)^20*(x-1);\n(x+y)^20*(y-2);", 6, &[(1, 1, 20)], 1);
    check("2\n(x^2+y^2-1)^12*(x-2*y);\n(x^2+y^2-1)^12*(y-3);", 3, &[(1, 2, 12)], 1);
    check("1 2\n(x^2+y^2-1)^4*(x-2*y)^3*(y-x^3)^5;", 3, &[(1, 3, 5), (1, 2, 4), (1, 1, 3)], 0);
    let both = "(x^2+y^2-1)^6*(x-2*y)^5";
    check(&format!("2\n{both}*(x-3);\n{both}*(y+x-1);"), 3, &[(1, 2, 6), (1, 1, 5)], 1);
    check("1 3\n((x+y)^10-z)*((x-y+1)^12-z);", 3, &[(2, 12, 1), (2, 10, 1)], 0);
    check("2 3\n(x+y+z)^12*(x^2+y^2+z^2-1);\n(x+y+z)^12*(x-y);", 2, &[(2, 1, 12), (1, 2, 1)], 0);
}

/// The example of Sommese, Verschelde & Wampler 2001 (SIAM J. Numer. Anal. 38:2022): a sphere, a
/// twisted cubic and three lines, and a point.
#[test]
fn a_sphere_curves_and_a_point() {
    let (s, t) = ("(x^2+y^2+z^2-1)", "(y-x^2)");
    let text = format!("3\n{t}*{s}*(x-1/2);\n(z-x^3)*{s}*(y-1/2);\n{t}*(z-x^3)*{s}*(z-1/2);");
    let lines = [(1, 1, 1); 3];
    check(&text, 3, &[&[(2, 2, 1), (1, 3, 1)], &lines[..]].concat(), 1);
}

/// The matrices of two rows and n columns of rank one: the Segre variety, irreducible of dimension
/// n + 1 and degree n.
#[test]
fn all_minors() {
    for n in 2..=4 {
        let minors: Vec<String> =
            (0..n).flat_map(|i| (i + 1..n).map(move |j| format!("a{i}*b{j}-a{j}*b{i};"))).collect();
        let text = format!("{} {}\n{}", minors.len(), 2 * n, minors.join("\n"));
        check(&text, 2, &[(n + 1, n, 1)], 0);
    }
}

/// Cyclic 5 in ratios to the first unknown: a fifth of its 70 solutions, and two with zeros but for
/// minus one at one of the places that are not next to the first.
#[test]
fn reduced_cyclic() {
    let text = "4\n1+a+b+c+d;\na+a*b+b*c+c*d+d;\na*b+a*b*c+b*c*d+c*d+d*a;\na*b*c+a*b*c*d+b*c*d+c*d*a+d*a*b;";
    check(text, 3, &[], 16);
}

/// Cyclic 6 and 7 in ratios: a sixth of 156 solutions and a seventh of 924 (Backelin & Fröberg 1991), and
/// sets with zeros, of which the first is none: three runs of one unknown between zeros, whose sum is zero
/// (lines), and two runs of two (`a + b + c + d = ab + cd = 0`, conics). Of six places one pattern makes
/// the former and two the latter, of seven places three and four. Multiplicities are not compared.
#[test]
fn reduced_cyclic_with_multiple_components() {
    let product = |names: &[String], j: usize, length: usize| {
        (0..length).map(|k| names[(j + k) % names.len()].as_str()).collect::<Vec<_>>().join("*")
    };
    for (n, degrees, isolated) in [(6, &[1, 2, 2][..], 26), (7, &[1, 1, 1, 2, 2, 2, 2], 132)] {
        let names: Vec<String> = std::iter::once("1".to_owned()).chain((1..n).map(|k| format!("y{k}"))).collect();
        let sum = |l: usize| (0..n).map(|j| product(&names, j, l)).collect::<Vec<_>>().join("+");
        let text = format!("{}\n{};", n - 1, (1..n).map(sum).collect::<Vec<_>>().join(";\n"));
        let found = decomposed(&text, 0);
        let mut have: Vec<_> = found.components.iter().map(|c| c.degree).collect();
        have.sort_unstable();
        assert_eq!((&have[..], found.isolated.len(), found.failed), (degrees, isolated, 0), "{n}");
        assert!(found.components.iter().all(|c| c.irreducible && c.dimension == 1), "{n}");
    }
}

/// Adjacent minors of a matrix of two rows (Diaconis, Eisenbud & Sturmfels 1998): a component for each
/// set of columns, no two neighbours, that are zero, of the product of the numbers of columns between
/// them.
#[test]
fn adjacent_minors() {
    let of = |n: usize, degrees: &[usize], seeds: u64| {
        let minors: Vec<String> = (1..n).map(|i| format!("a{}*b{i}-a{i}*b{};", i - 1, i - 1)).collect();
        let components: Vec<_> = degrees.iter().map(|&degree| (n + 1, degree, 1)).collect();
        check(&format!("{} {}\n{}", n - 1, 2 * n, minors.join("\n")), seeds, &components, 0);
    };
    of(3, &[3, 1], 1);
    of(4, &[4, 2, 2], 1);
    of(5, &[5, 4, 3, 3, 1], 4);
}

/// Components whose points lie 1e-5 to 1e-12 apart, where loops jump from one to the other: each is found, or is not
/// said to be irreducible.
#[test]
fn components_that_are_close_are_not_one() {
    for (text, degree, count) in [
        ("(x*y-1)^2 = 1e-18", 2, 2),
        ("(x^2+y^2+z^2-1)^2 = 1e-14", 2, 2),
        ("(x*y+z^2-1)*(x*y+z^2-1-1e-5)", 2, 2),
        // So close that points on two of the lines may be one to all digits of a path.
        ("(x-y)*(x-y-1e-12)\nz*(x-3)", 1, 0),
        ("(x*y+z-1)^2 = 1e-12\nx+2*y-z+3", 2, 2),
    ] {
        let mut most = 0;
        // With seed 2 the spheres take a minute.
        for seed in 0..2 {
            let found = decompose(&text.parse().unwrap(), &SolveOptions::new().seed(seed)).unwrap();
            let irreducible = found.components.iter().filter(|c| c.irreducible);
            assert!(irreducible.clone().all(|c| c.degree == degree), "{text} {seed}: {:?}", found.components);
            most = most.max(irreducible.count());
        }
        assert!(most >= count, "{text}");
    }
}

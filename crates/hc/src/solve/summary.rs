//! What a solve has found, in words.

use super::solutions::{Solution, Solutions};
use num_complex::Complex64;
use poly::{counted, one_or};
use std::collections::BTreeMap;
use std::fmt;

/// Solutions of each kind that a summary shows.
const LISTED: usize = 20;

/// A point in words: the names of its coordinates and their values with twelve decimals, imaginary
/// parts where these show any.
///
/// ```
/// use num_complex::Complex64;
/// let names = ["x".to_owned(), "y".to_owned()];
/// let point = [Complex64::new(0.5, 0.0), Complex64::new(1.0, -2.0)];
/// assert_eq!(hc::coordinates(&names, &point), "x = 0.500000000000, y = 1.000000000000 - 2.000000000000i");
/// ```
pub fn coordinates(names: &[String], point: &[Complex64]) -> String {
    let one = |(name, z): (&String, &Complex64)| {
        let (size, sign) = (format!("{:.12}", z.im.abs()), if z.im < 0.0 { '-' } else { '+' });
        let imaginary = if size.contains(|c| matches!(c, '1'..='9')) || !z.im.is_finite() {
            format!(" {sign} {size}i")
        } else {
            String::new()
        };
        format!("{name} = {:.12}{imaginary}", z.re)
    };
    names.iter().zip(point).map(one).collect::<Vec<_>>().join(", ")
}

/// One screen: numbers of solutions and paths, warnings, the first real solutions that are regular,
/// and the first singular ones.
impl fmt::Display for Solutions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (paths, real) = (&self.paths, self.n_real());
        let isolated = counted(self.count(), "isolated solution");
        match self.represents.len() {
            0 => writeln!(f, "{isolated}, {real} real")?,
            listed => writeln!(f, "{isolated}, {listed} up to symmetry; {real} of these real")?,
        }
        let mut multiplicities: BTreeMap<usize, usize> = BTreeMap::new();
        for solution in self.iter().filter(|s| s.singular) {
            *multiplicities.entry(solution.multiplicity).or_default() += 1;
        }
        for (multiplicity, count) in multiplicities {
            writeln!(f, "  {count} of them singular, of multiplicity {multiplicity}")?;
        }
        if self.iter().any(|s| s.certified.is_some()) {
            let certified = self.iter().filter(|s| s.certified == Some(true)).count();
            writeln!(f, "  {certified} of them certified")?;
        }
        let start = self.start.map_or(String::new(), |start| format!(" ({start}{})", self.others(start)));
        writeln!(
            f,
            "{}{start}: {} finite, {} at infinity, {} failed, {} tracked again",
            counted(paths.tracked, "path"),
            paths.finite,
            paths.at_infinity,
            paths.failed,
            paths.retracked
        )?;
        for warning in self.warnings() {
            writeln!(f, "warning: {warning}")?;
        }
        self.list(f, |s| s.is_real && !s.singular, "regular real")?;
        self.list(f, |s| s.singular, "singular")
    }
}

impl Solutions {
    /// The first of these solutions, and how many more there are.
    fn list(&self, f: &mut fmt::Formatter<'_>, is_one: impl Fn(&Solution) -> bool, kind: &str) -> fmt::Result {
        let all = self.iter().filter(|s| is_one(s));
        for solution in all.clone().take(LISTED) {
            writeln!(f, "  {}", solution.row(&self.variables))?;
        }
        match all.count().saturating_sub(LISTED) {
            0 => Ok(()),
            more => writeln!(f, "  and {more} more {kind} {}", one_or(more, "solution", "solutions")),
        }
    }
}

impl Solution {
    /// The solution in a line: its [coordinates], without imaginary parts where it is real, and its
    /// multiplicity if that is not one, or whether it is singular.
    pub fn row(&self, names: &[String]) -> String {
        let is_shown = |z: &Complex64| if self.is_real { Complex64::new(z.re, 0.0) } else { *z };
        let point: Vec<Complex64> = self.value.iter().map(is_shown).collect();
        let kind = match (self.multiplicity, self.singular) {
            (multiplicity @ 2.., _) => format!("  (multiplicity {multiplicity})"),
            (_, true) => "  (singular)".to_owned(),
            (_, false) => String::new(),
        };
        coordinates(names, &point) + &kind
    }
}

#[cfg(test)]
mod tests {
    use super::coordinates;
    use crate::{SolveOptions, solve};
    use num_complex::Complex64;

    fn shown(text: &str) -> String {
        solve(&text.parse().unwrap(), &SolveOptions::new()).unwrap().to_string()
    }

    /// The roots are those of the factors.
    #[test]
    fn rows_say_which_solution_is_multiple() {
        let text = shown("(x - 1)*(x - 2)^2*(x^2 + 4)^3");
        assert!(text.starts_with("4 isolated solutions, 2 real\n"), "{text}");
        for row in [
            "  x = 1.000000000000\n",
            "  x = 2.000000000000  (multiplicity 2)\n",
            " + 2.000000000000i  (multiplicity 3)\n",
            " - 2.000000000000i  (multiplicity 3)\n",
        ] {
            assert_eq!(text.matches(row).count(), 1, "{row:?}: {text}");
        }
        // Five by five regular ones, of which twenty are shown, and five that are double.
        let text = shown("x*(x^2 - 1)*(x^2 - 4); y*(y^2 - 1)*(y^2 - 4)*(y - 3)^2");
        assert!(text.starts_with("30 isolated solutions, 30 real\n"), "{text}");
        assert!(text.contains("  and 5 more regular real solutions\n"), "{text}");
        assert_eq!(text.matches(", y = 3.000000000000  (multiplicity 2)\n").count(), 5, "{text}");
    }

    #[test]
    fn one_is_in_the_singular() {
        let text = shown("x^3 = 8*x^2");
        assert!(text.starts_with("2 isolated solutions, 2 real\n  1 of them singular, of multiplicity 2\n"), "{text}");
        let text = shown("x + 1");
        assert!(text.starts_with("1 isolated solution, 1 real\n1 path ("), "{text}");
    }

    #[test]
    fn imaginary_parts_are_shown_where_they_show_anything() {
        let names = ["x".to_owned()];
        let shown = |re: f64, im: f64| coordinates(&names, &[Complex64::new(re, im)]);
        assert_eq!(shown(1.5, 4e-13), "x = 1.500000000000");
        assert_eq!(shown(1.5, -6e-13), "x = 1.500000000000 - 0.000000000001i");
        assert!(shown(f64::NAN, f64::NAN).contains("NaNi") && shown(0.0, f64::INFINITY).contains("+ infi"));
        assert_eq!(coordinates(&names, &[]), "");
    }
}

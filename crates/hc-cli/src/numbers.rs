//! Points as plain text: one a line, as numbers.

use hc::poly::counted;
use num_complex::Complex64;

/// Points with the names of their coordinates, where the file has them.
pub(crate) type Named = (Option<Vec<String>>, Vec<Vec<Complex64>>);

/// What else the file may be, for messages.
const FORMATS: &str = "points are one a line in plain text, the JSON of `hc solve`, or PHCpack's list of solutions";

/// The points of a plain text: on each line a number for each unknown, with blanks or commas between
/// them, below a line `variables: ...` if there is one. Blank lines do not count, `#` begins a comment.
pub(crate) fn points(text: &str, unknowns: &[String]) -> Result<Named, String> {
    let mut names: Option<Vec<String>> = None;
    let mut points = Vec::new();
    for (k, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let at = |problem: String| format!("line {}: {problem}", k + 1);
        let line = line.split('#').next().unwrap_or_default().trim();
        let words = line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        if let Some(list) = line.strip_prefix("variables:").or_else(|| line.strip_prefix("unknowns:")) {
            if names.is_some() || !points.is_empty() {
                return Err(at("name the unknowns once, before the first point".to_owned()));
            }
            let list = list.split(|c: char| c.is_whitespace() || c == ',').filter(|name| !name.is_empty());
            names = Some(list.map(str::to_owned).collect());
            continue;
        }
        let read = |word: &str| {
            number(word).ok_or_else(|| {
                at(format!("{} is not a finite number such as 1.5, -2e-3 or 1.5+2i; {FORMATS}", shown(word)))
            })
        };
        let point = words.map(read).collect::<Result<Vec<Complex64>, String>>()?;
        match point.len() {
            0 => {}
            found if found == unknowns.len() => points.push(point),
            found => {
                return Err(at(format!(
                    "{}, but {} needed: {}",
                    counted(found, "number"),
                    counted(unknowns.len(), "coordinate"),
                    unknowns.join(" ")
                )));
            }
        }
    }
    if points.is_empty() {
        return Err(format!("no points; {FORMATS}"));
    }
    Ok((names, points))
}

/// A number without blanks: `1.5`, `-2e-3`, `1.5+2i`, `-i`, `3*i`, in parentheses or not.
fn number(word: &str) -> Option<Complex64> {
    let inner = word.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(word);
    let found = match inner.strip_suffix(['i', 'j', 'I']) {
        None => Complex64::new(real(inner)?, 0.0),
        Some(parts) => {
            let (re, im) = parts.split_at(sign(parts));
            let im = match im {
                "" | "+" => 1.0,
                "-" => -1.0,
                im => real(im.strip_suffix('*').unwrap_or(im))?,
            };
            Complex64::new(if re.is_empty() { 0.0 } else { real(re)? }, im)
        }
    };
    Some(found).filter(|z| z.is_finite())
}

/// The place of the sign of the imaginary part, the last sign that belongs to no exponent; zero
/// where there is no real part before it.
fn sign(parts: &str) -> usize {
    let is_one = |&(k, c): &(usize, char)| matches!(c, '+' | '-') && !parts[..k].ends_with(['e', 'E']);
    parts.char_indices().rev().find(is_one).map_or(0, |(k, _)| k)
}

/// A decimal number; the words that Rust reads as numbers are none here.
pub(crate) fn real(text: &str) -> Option<f64> {
    let is_decimal = text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | 'e' | 'E'));
    if is_decimal { text.parse().ok() } else { None }
}

/// What stands there, shortened.
pub(crate) fn shown(word: &str) -> String {
    let start: String = word.chars().take(40).collect();
    format!("`{start}{}`", if start.len() < word.len() { "..." } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|k| format!("x{k}")).collect()
    }

    #[test]
    fn numbers_in_all_spellings() {
        for (word, re, im) in [
            ("1", 1.0, 0.0),
            ("-2.5e-3", -2.5e-3, 0.0),
            ("+.5", 0.5, 0.0),
            ("1.5+2i", 1.5, 2.0),
            ("1.5-2*i", 1.5, -2.0),
            ("(1.5+2j)", 1.5, 2.0),
            ("-1e-3-2E+4I", -1e-3, -2e4),
            ("i", 0.0, 1.0),
            ("-i", 0.0, -1.0),
            ("2-i", 2.0, -1.0),
            ("3i", 0.0, 3.0),
            ("1e+2i", 0.0, 100.0),
            ("(7)", 7.0, 0.0),
        ] {
            assert_eq!(number(word), Some(Complex64::new(re, im)), "{word}");
        }
        for word in
            ["", "x", "nan", "inf", "1e999", "1+", "1+2", "2ii", "i2", "1..2", "(1", "*i", "1+*2i", "e", "-", "1-infi"]
        {
            assert!(number(word).is_none(), "{word}");
        }
    }

    #[test]
    fn lines_are_points() {
        let text = "\u{feff}# two points\r\n\r\n 1, 2+i  # the first\r\n3\t-4\r\n";
        let expected = vec![
            vec![Complex64::new(1.0, 0.0), Complex64::new(2.0, 1.0)],
            vec![Complex64::new(3.0, 0.0), Complex64::new(-4.0, 0.0)],
        ];
        assert_eq!(points(text, &names(2)), Ok((None, expected)));
        let (order, found) = points("variables: b, a\n1 2", &names(2)).unwrap();
        assert_eq!((order.unwrap(), found.len()), (vec!["b".to_owned(), "a".to_owned()], 1));
        for (text, words) in [
            ("1 2\n\n3 z4\n", "line 3: `z4` is not a finite number"),
            ("1 2 3", "line 1: 3 numbers, but 2 coordinates needed: x0 x1"),
            ("1\n", "line 1: 1 number, but"),
            ("# nothing\n", "no points"),
            ("1 2\nvariables: x0 x1", "line 2: name the unknowns once"),
            ("1 + 2*i", "line 1: `+` is not"),
        ] {
            let error = points(text, &names(2)).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    fn finite() -> impl Strategy<Value = f64> {
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        #[test]
        fn what_is_printed_is_read_back_to_the_bit(
            parts in proptest::collection::vec((finite(), finite()), 1..5),
            exponent: bool,
            separator in "[ \t,]|, ",
        ) {
            let print = |&(re, im): &(f64, f64)| if exponent { format!("{re:e}{im:+e}i") } else { format!("{re}{im:+}i") };
            let line = parts.iter().map(print).collect::<Vec<_>>().join(&separator);
            let (_, read) = points(&line, &names(parts.len())).unwrap();
            let bits = |z: &Complex64| (z.re.to_bits(), z.im.to_bits());
            let given: Vec<_> = parts.iter().map(|&(re, im)| bits(&Complex64::new(re, im))).collect();
            prop_assert_eq!(read[0].iter().map(bits).collect::<Vec<_>>(), given);
        }

        #[test]
        fn no_text_panics(text in "[-+*.,0-9eEijI()# \nxµ:]{0,60}", any in any::<String>()) {
            let _ = points(&text, &names(2));
            let _ = points(&any, &names(1));
        }
    }
}

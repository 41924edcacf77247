//! No text makes the parsers, the expansion or the compiler panic, hang or take memory out of
//! proportion.

use poly::{ExpandLimits, Formula, System, parse};
use proptest::prelude::*;

/// Everything that is done with a system, within small limits.
fn digest(system: &System) {
    let mut limits = ExpandLimits::default();
    limits.work = 20_000;
    limits.terms = 2_000;
    let _ = system.expand(&limits);
    let _ = system.compile();
    let _ = system.to_string();
}

fn both(text: &str) {
    for body in [text.to_owned(), format!("2\n{text};"), format!("1\n{text};")] {
        if let Ok(system) = parse::phcpack(&body) {
            digest(&system);
        }
    }
    let family = format!("name = 'f'\nunknowns = ['x', 'y']\nparameters = ['p']\nequations = [{text:?}]\n");
    match parse::family(&family) {
        Ok(family) => digest(&family.system),
        // The message shows the place whatever the text is.
        Err(error) => assert!(error.to_string().contains('^')),
    }
    let _ = parse::family(text);
    let _ = System::from_formulas(&[text]);
    let _ = text.parse::<Formula>().map(|formula| formula.to_string());
    for plain in [text.to_owned(), format!("variables: x y p\n{text}"), format!("parameters: p # {text}\n{text}")] {
        if let Ok(system) = plain.parse::<System>() {
            digest(&system);
        }
    }
}

/// Texts made of the pieces of formulas.
fn formula_like() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "x",
        "y",
        "p",
        "i",
        "I",
        "1",
        "2",
        "0",
        "3.5",
        "1.0E-40",
        "1e99999",
        "9999999999",
        ".",
        "e",
        "+",
        "-",
        "*",
        "**",
        "^",
        "/",
        "(",
        ")",
        "(x+y)",
        "^2",
        "^(-3)",
        "^999999999",
        "^31",
        ";",
        "\n",
        " ",
        "=",
        "#",
        ":",
        ",",
        "variables:",
        "é",
        "\u{0}",
        "_a",
    ]);
    prop::collection::vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

/// Texts that parse: nested sums, products, quotients and powers.
fn formula() -> impl Strategy<Value = String> {
    let leaf = prop::sample::select(vec!["x", "y", "p", "2", "0.25", "i", "7/3"]).prop_map(str::to_owned);
    leaf.prop_recursive(8, 64, 2, |inner| {
        prop_oneof![
            (inner.clone(), prop::sample::select(vec!["+", "-", "*", "/"]), inner.clone())
                .prop_map(|(a, op, b)| format!("({a}) {op} ({b})")),
            (inner, prop_oneof![-4..9i32, Just(1_000_000), Just(-2_147_483_646)])
                .prop_map(|(a, k)| format!("({a})^({k})")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_text(text in "\\PC{0,60}") {
        both(&text);
    }

    #[test]
    fn pieces_of_formulas(text in formula_like()) {
        both(&text);
    }

    #[test]
    fn formulas_and_their_text_read_back(text in formula()) {
        both(&text);
        // The sums in front fix the order of the unknowns in both readings.
        let fixed = "x - x + y - y + p - p + ";
        if let Ok(system) = parse::phcpack(&format!("1\n{fixed}{text};")) {
            let again: System = system.to_string().parse().expect("text of a system parses");
            prop_assert_eq!(again.variables(), system.variables());
            let mut limits = ExpandLimits::default();
            limits.work = 20_000;
            if let (Ok(a), Ok(b)) = (system.expand(&limits), again.expand(&limits)) {
                prop_assert_eq!(a, b);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Equations with a right side, comments and blank lines read back from the text that a system
    /// prints.
    #[test]
    fn plain_text_reads_back(lines in prop::collection::vec((formula(), formula(), 0..3usize), 1..6)) {
        let mut text = "# x - y\nvariables: y x, p\n".to_owned();
        for (left, right, end) in &lines {
            text += &format!("{left} = {right}{}\n", [";", " # = 0;", "\n"][*end]);
        }
        // A quotient by zero is an error; and so is a sign that begins a line where only some lines
        // end in `;`.
        if let Ok(system) = text.parse::<System>() {
            prop_assert_eq!((system.variables().join(" "), system.len()), ("y x p".to_owned(), lines.len()));
            let again: System = system.to_string().parse().expect("text of a system parses");
            prop_assert_eq!(again.to_string(), system.to_string());
            let mut limits = ExpandLimits::default();
            limits.work = 20_000;
            if let (Ok(a), Ok(b)) = (system.expand(&limits), again.expand(&limits)) {
                prop_assert_eq!(a, b);
            }
        }
    }
}

/// However large the exponent, a power of zero is zero, so that no negative power of it passes for
/// a number.
#[test]
fn powers_of_zero_are_zero() {
    for text in ["(x - x)^1000000", "0^1000000000", "(0^1000000)^3"] {
        assert!(parse::phcpack(&format!("1\n({text})^(-4);")).is_err(), "{text}");
        assert!(parse::phcpack(&format!("1\n1/({text});")).is_err(), "{text}");
        let system = parse::phcpack(&format!("1\nx + {text};")).expect("a formula");
        assert_eq!(system.to_string(), parse::phcpack("1\nx;").expect("a formula").to_string());
    }
}

#[test]
fn hostile_texts() {
    let nested = "(".repeat(1_000_000);
    let signs = "-".repeat(1_000_000);
    let terms: String = (0..200_000).map(|k| format!("+{k}*x^{k}*y")).collect();
    let products = "x*y*".repeat(200_000) + "x";
    let quotients = "x/".repeat(100_000) + "y";
    let powers = "(".repeat(200) + "x+y" + &")^9".repeat(200);
    let constants = "3^9999*".repeat(50_000) + "x";
    let fractions: String = (2..20_000).map(|k| format!("+1/{k}")).collect();
    let digits = "7".repeat(1_000_000);
    let names: String = (0..20_000).map(|k| format!("+x{k}")).collect();
    for text in [nested, signs, terms, products, quotients, powers, constants, fractions, digits, names] {
        if let Ok(system) = parse::phcpack(&format!("1\n{text};")) {
            let mut limits = ExpandLimits::default();
            limits.work = 20_000;
            let _ = system.expand(&limits);
            let _ = system.to_string();
        }
    }
    for text in ["x^999999999", "x^-999999999", "x^2147483646", "(x+y)^2147483646", "2^999999999", "(1/3)^99999999*x"] {
        let system = parse::phcpack(&format!("1\n{text};")).unwrap_or_else(|e| panic!("{e}"));
        system.compile().unwrap_or_else(|e| panic!("{e}"));
        let expanded = system.expand(&ExpandLimits::default());
        assert_eq!(expanded.is_ok(), text.starts_with('x'), "{text}");
    }
    assert!(parse::phcpack("18446744073709551615\nx;").is_err());
}

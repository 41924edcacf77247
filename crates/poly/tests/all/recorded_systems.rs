//! Systems of real origin: every file parses, with the sizes and degrees that are on record.

use poly::parse;
use std::path::Path;

#[test]
fn every_file_parses_to_the_recorded_degrees() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems");
    let table = std::fs::read_to_string(folder.join("expected.csv")).unwrap();
    let mut seen = 0;
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let (name, unknowns, total_degree) = (fields[0], fields[1], fields[2]);
        let text = std::fs::read_to_string(folder.join(format!("{name}.phc"))).unwrap();
        let system = parse::phcpack(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(system.variables().len().to_string(), unknowns, "{name}");
        assert_eq!(system.len().to_string(), unknowns, "{name}");
        let polynomials = system.expand(&Default::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let product: i64 = polynomials.iter().map(|p| p.degree().unwrap()).product();
        assert_eq!(product.to_string(), total_degree, "{name}: product of degrees");
        // As many terms as the text has: nothing was merged or lost, the files are written
        // expanded.
        let terms: usize = polynomials.iter().map(|p| p.len()).sum();
        let body: String = text.lines().skip(1).collect::<Vec<_>>().join(" ");
        let equations: Vec<&str> = body.split(';').take(system.len()).collect();
        let written: usize = equations.iter().map(|e| written_terms(e)).sum();
        assert_eq!(terms, written, "{name}: number of terms");
        system.compile().unwrap_or_else(|e| panic!("{name}: {e}"));
        let names: Vec<&str> = system.variables().iter().map(String::as_str).collect();
        let order: String = names.iter().map(|n| format!("{n} - {n} + ")).collect();
        for p in &polynomials {
            let again = parse::phcpack(&format!("1\n{order}{};", p.display(&names))).unwrap();
            assert_eq!(&again.expand(&Default::default()).unwrap()[0], p, "{name}: text reads back");
        }
        seen += 1;
    }
    assert_eq!(seen, std::fs::read_dir(&folder).unwrap().filter(|f| is_system(f.as_ref().unwrap())).count());
}

fn is_system(file: &std::fs::DirEntry) -> bool {
    file.path().extension().is_some_and(|e| e == "phc")
}

/// Number of terms of an expanded polynomial: signs outside parentheses and exponents, and the
/// first term.
fn written_terms(text: &str) -> usize {
    let characters: Vec<char> = text.chars().filter(|c| !c.is_whitespace()).collect();
    let mut depth = 0;
    let mut terms = 1;
    for (k, c) in characters.iter().enumerate() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            '+' | '-' if depth == 0 && k > 0 => {
                let exponent =
                    matches!(characters[k - 1], 'e' | 'E') && characters[k.saturating_sub(2)].is_ascii_digit();
                terms += usize::from(!exponent);
            }
            _ => {}
        }
    }
    terms
}

//! Families whose parameters enter on any scale, and how many solutions they have: irreducible over
//! the parameters, counted by hand.

/// Unknowns, equations in which `S` is a factor, and the number of solutions for generic parameters
/// `a`, `b`, `c`, `d`.
pub(crate) struct Scaled {
    pub(crate) unknowns: &'static [&'static str],
    pub(crate) equations: &'static [&'static str],
    pub(crate) count: usize,
}

const fn scaled(unknowns: &'static [&'static str], equations: &'static [&'static str], count: usize) -> Scaled {
    Scaled { unknowns, equations, count }
}

const X: &[&str] = &["x"];
const XY: &[&str] = &["x", "y"];
const XYZ: &[&str] = &["x", "y", "z"];

pub(crate) const FAMILIES: [Scaled; 20] = [
    scaled(X, &["x^2 - S*a"], 2),
    scaled(X, &["x^3 - 12*x - S*a"], 3),
    scaled(X, &["x^3 - 12*S*x - a"], 3),
    scaled(X, &["x^5 - x - S*a"], 5),
    scaled(X, &["x^6 - S*a*x - 1"], 6),
    scaled(X, &["x^4 - S*a*x^3 + x + 1"], 4),
    scaled(X, &["S*a*x^3 + x + 1"], 3),
    scaled(X, &["x^2 + S*a*x + b"], 2),
    scaled(XY, &["x^2 + y^2 - S*a", "x*y - 1"], 4),
    scaled(XY, &["x*y - S*a", "x + y - b"], 2),
    // Substituting y leaves a quartic in x.
    scaled(XY, &["x^2 + y^2 - S*a", "x^2 - y - b"], 4),
    scaled(XY, &["x^3 + y^3 - S*a", "x*y - b"], 6),
    // Two circles.
    scaled(XY, &["(x - a)^2 + (y - S*b)^2 - 1", "x^2 + y^2 - c"], 2),
    // A line and a cubic.
    scaled(XY, &["y^2 - x^3 - S*a*x - b", "y - c*x - d"], 3),
    // Two parabolas.
    scaled(XY, &["x^2 - S*a*y - c", "y^2 - b*x + 1"], 4),
    // Two conics.
    scaled(XY, &["a*x^2 + y^2 - S", "x^2 + b*y^2 - x - 1"], 4),
    scaled(XY, &["x^3 - y - S*a", "y^3 - x - b"], 9),
    // The roots of a cubic, in any order.
    scaled(XYZ, &["x*y*z - S*a", "x + y + z - b", "x*y + y*z + z*x - c"], 6),
    // Two spheres and a plane.
    scaled(XYZ, &["x^2 + y^2 + z^2 - S*a", "x^2 + (y - 1)^2 + z^2 - b", "x + y - 2*z - c"], 2),
    // Three points at known distances in known directions.
    scaled(XYZ, &["x^2 + y^2 - a*x*y - S*d", "y^2 + z^2 - b*y*z - 2*S*d", "z^2 + x^2 - c*z*x - 3*S*d"], 8),
];

/// What became of a family: how many solutions monodromy found, and whether the trace test or
/// nothing says that they are all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All, and shown to be.
    Whole,
    /// What was found is said to be unsettled.
    Unsettled(usize),
    /// Too few or too many, and said to be all.
    False(usize),
}

impl Scaled {
    /// The family with this factor, in TOML.
    pub(crate) fn family(&self, factor: &str) -> String {
        let list = |items: Vec<String>| items.iter().map(|i| format!("{i:?}")).collect::<Vec<_>>().join(", ");
        let equations: Vec<String> = self.equations.iter().map(|e| e.replace('S', factor)).collect();
        let parameters = ["a", "b", "c", "d"].iter().filter(|p| equations.iter().any(|e| e.contains(**p)));
        format!(
            "name = \"scaled\"\nunknowns = [{}]\nparameters = [{}]\nequations = [{}]",
            list(self.unknowns.iter().map(ToString::to_string).collect()),
            list(parameters.map(ToString::to_string).collect()),
            list(equations),
        )
    }

    /// Solves the family from nothing, with the trace test.
    pub(crate) fn outcome(&self, factor: &str, seed: u64) -> Outcome {
        let family: hc::Family = self.family(factor).parse().expect("a family");
        let options = hc::MonodromyOptions::new().seed(seed);
        let Ok(found) = family.monodromy(&options) else { return Outcome::Unsettled(0) };
        match found.fibre.len() {
            count if !found.stopped.is_complete() => Outcome::Unsettled(count),
            count if count == self.count => Outcome::Whole,
            count => Outcome::False(count),
        }
    }
}

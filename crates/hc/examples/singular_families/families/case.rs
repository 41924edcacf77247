//! A system and its answer.

use hc::poly::Complex64;

/// A system and what it has.
pub(crate) struct Case {
    /// The system in PHCpack's format.
    pub(crate) text: String,
    /// The isolated solutions, and their multiplicities.
    pub(crate) solutions: Vec<(Vec<Complex64>, usize)>,
    /// The multiplicities of the solutions besides, at points that are not known, in ascending order.
    pub(crate) others: Vec<usize>,
    /// How many solutions are real, where that is known.
    pub(crate) real: Option<usize>,
    /// Whether there is a component of positive dimension besides.
    pub(crate) component: bool,
}

impl Case {
    /// Square equations in as many unknowns, without solutions as yet.
    pub(super) fn new(equations: &[String]) -> Case {
        let text = format!("{}\n{};", equations.len(), equations.join(";\n"));
        Case { text, solutions: Vec::new(), others: Vec::new(), real: None, component: false }
    }

    /// With more equations than unknowns.
    pub(super) fn in_unknowns(mut self, unknowns: usize) -> Case {
        let (equations, rest) = self.text.split_once('\n').expect("a first line");
        self.text = format!("{equations} {unknowns}\n{rest}");
        self
    }

    /// With a solution of this multiplicity, which may be complex.
    pub(super) fn with_complex(mut self, point: Vec<Complex64>, multiplicity: usize) -> Case {
        self.solutions.push((point, multiplicity));
        self
    }

    /// With a real solution of this multiplicity.
    pub(super) fn with(self, point: &[f64], multiplicity: usize) -> Case {
        self.with_complex(point.iter().map(|&c| c.into()).collect(), multiplicity)
    }

    /// With simple real solutions.
    pub(super) fn with_simple(self, points: &[Vec<f64>]) -> Case {
        points.iter().fold(self, |case, point| case.with(point, 1))
    }

    /// With solutions of these multiplicities besides, at points that are not known.
    pub(super) fn with_others(self, others: &[usize]) -> Case {
        Case { others: others.to_vec(), ..self }
    }

    /// With so many real solutions.
    pub(super) fn with_real(self, real: usize) -> Case {
        Case { real: Some(real), ..self }
    }

    /// With a component.
    pub(super) fn with_component(self) -> Case {
        Case { component: true, ..self }
    }
}

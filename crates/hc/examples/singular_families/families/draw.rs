//! Random integers, linear forms and where they vanish.

use hc::poly::Complex64;

/// Random integers by Steele, Lea & Flood's SplitMix64.
pub(crate) struct Draw(pub(crate) u64);

/// The coefficients of a linear form, then its constant.
pub(super) type Form = Vec<i128>;

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// An integer from `low` to `high`.
    pub(super) fn between(&mut self, low: i128, high: i128) -> i128 {
        low + (self.next() % (high - low + 1) as u64) as i128
    }

    pub(super) fn coin(&mut self) -> bool {
        self.next() & 1 == 0
    }

    pub(super) fn nonzero(&mut self) -> i128 {
        self.nonzero_to(6)
    }

    /// An integer of at most this size, not zero.
    pub(super) fn nonzero_to(&mut self, largest: i128) -> i128 {
        let size = self.between(1, largest);
        if self.coin() { size } else { -size }
    }

    /// Different integers from `low` to `high`, in order.
    pub(super) fn different(&mut self, count: usize, low: i128, high: i128) -> Vec<i128> {
        let mut numbers = std::collections::BTreeSet::new();
        while numbers.len() < count {
            numbers.insert(self.between(low, high));
        }
        numbers.into_iter().collect()
    }

    /// A line `a x + b y + c`.
    pub(super) fn line(&mut self) -> Form {
        (0..3).map(|_| self.nonzero()).collect()
    }

    /// Two lines through an integer point that cross there, and the point.
    pub(super) fn cross(&mut self) -> (Form, Form, [f64; 2]) {
        let point = [self.between(-3, 3), self.between(-3, 3)];
        loop {
            let mut through = || {
                let (a, b) = (self.nonzero(), self.between(-4, 4));
                vec![a, b, -a * point[0] - b * point[1]]
            };
            let (u, v) = (through(), through());
            if u[0] * v[1] != u[1] * v[0] {
                return (u, v, point.map(|c| c as f64));
            }
        }
    }

    /// Linear coordinates of `n` unknowns whose inverse has integers too.
    pub(super) fn frame(&mut self, n: usize) -> Frame {
        let unit = |i: usize| (0..n).map(move |j| i128::from(i == j));
        let mut rows: Vec<Form> = (0..n).map(|i| unit(i).collect()).collect();
        let mut columns: Vec<Form> = rows.clone();
        for i in 0..n {
            // Twice the neighbour would make the numbers large.
            let (j, c) = ((i + 1) % n, self.between(-1, 1));
            for k in 0..n {
                rows[i][k] += c * rows[j][k];
                columns[j][k] -= c * columns[i][k];
            }
        }
        let at: Vec<i128> = (0..n).map(|_| self.between(-3, 3)).collect();
        let constant = |row: &Form| -row.iter().zip(&at).map(|(a, b)| a * b).sum::<i128>();
        let forms = rows.iter().map(|row| row.iter().copied().chain([constant(row)]).collect()).collect();
        Frame { forms, columns, at }
    }
}

/// Linear coordinates.
pub(super) struct Frame {
    /// The coordinates as forms in the unknowns.
    forms: Vec<Form>,
    /// The columns of the inverse.
    columns: Vec<Vec<i128>>,
    /// Where the coordinates are zero.
    at: Vec<i128>,
}

impl Frame {
    /// The coordinates in the unknowns, as text.
    pub(super) fn texts(&self) -> Vec<String> {
        self.forms.iter().map(|form| show(form)).collect()
    }

    /// The point with these coordinates.
    pub(super) fn point(&self, coordinates: &[Complex64]) -> Vec<Complex64> {
        let along = |i: usize| self.columns.iter().zip(coordinates).map(move |(c, t)| t * c[i] as f64);
        (0..self.at.len()).map(|i| along(i).sum::<Complex64>() + self.at[i] as f64).collect()
    }

    /// The point with these real coordinates.
    pub(super) fn real_point(&self, coordinates: &[f64]) -> Vec<f64> {
        let coordinates: Vec<Complex64> = coordinates.iter().map(|&c| c.into()).collect();
        self.point(&coordinates).iter().map(|c| c.re).collect()
    }
}

/// A linear form in x, y and so on, as text.
pub(super) fn show(form: &[i128]) -> String {
    let (constant, coefficients) = form.split_last().expect("a constant");
    let terms = coefficients.iter().zip(["x", "y", "z", "w", "v"]).map(|(c, name)| format!("({c})*{name}+"));
    format!("({}({constant}))", terms.collect::<String>())
}

fn determinant(rows: &[Vec<i128>]) -> i128 {
    if rows.is_empty() {
        return 1;
    }
    let without = |column: usize| -> Vec<Vec<i128>> {
        let kept = |row: &Vec<i128>| row.iter().enumerate().filter(|(k, _)| *k != column).map(|(_, &c)| c).collect();
        rows[1..].iter().map(kept).collect()
    };
    let sign = |column: usize| 1 - 2 * (column as i128 % 2);
    rows[0].iter().enumerate().map(|(k, &c)| if c == 0 { 0 } else { sign(k) * c * determinant(&without(k)) }).sum()
}

/// Where as many forms as unknowns vanish, if that is one point: Cramer's rule.
pub(super) fn meet(forms: &[&Form]) -> Option<Vec<f64>> {
    let n = forms.len();
    let matrix: Vec<Vec<i128>> = forms.iter().map(|form| form[..n].to_vec()).collect();
    let below = determinant(&matrix);
    let coordinate = |unknown: usize| {
        let mut rows = matrix.clone();
        rows.iter_mut().zip(forms).for_each(|(row, form)| row[unknown] = -form[n]);
        quotient(determinant(&rows), below)
    };
    (below != 0).then(|| (0..n).map(coordinate).collect())
}

/// A quotient of integers, the digits before the point apart.
pub(super) fn quotient(above: i128, below: i128) -> f64 {
    (above / below) as f64 + (above % below) as f64 / below as f64
}

/// The points where one form of each group vanishes.
pub(super) fn meets(groups: &[Vec<Form>]) -> Option<Vec<Vec<f64>>> {
    let mut choices: Vec<Vec<&Form>> = vec![Vec::new()];
    for group in groups {
        let longer = |choice: Vec<_>| group.iter().map(move |form| [&choice[..], &[form]].concat());
        choices = choices.into_iter().flat_map(longer).collect();
    }
    choices.iter().map(|choice| meet(choice)).collect()
}

/// Whether points keep a distance from each other.
pub(super) fn apart(points: &[Vec<f64>]) -> bool {
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-2);
    points.iter().enumerate().all(|(k, a)| points[..k].iter().all(|b| !near(a, b)))
}

//! Solutions that are 1e-4 to 1e-10 apart.

use super::case::Case;
use super::draw::{Draw, Form, apart, meet, meets, quotient, show};

/// Factors `10^k form - j` for some numbers `j`.
struct Beam {
    form: Form,
    exponent: u32,
    numbers: Vec<i128>,
}

impl Beam {
    /// So many factors; one alone is the form.
    fn draw(draw: &mut Draw, form: Form, exponent: u32, count: usize) -> Beam {
        if count == 1 {
            return Beam { form, exponent: 0, numbers: vec![0] };
        }
        Beam { form, exponent, numbers: draw.different(count, 0, 5) }
    }

    fn forms(&self) -> Vec<Form> {
        let scale = 10i128.pow(self.exponent);
        let mut scaled: Form = self.form.iter().map(|c| scale * c).collect();
        let last = scaled.len() - 1;
        let constant = scaled[last];
        let factor = |j: &i128| {
            scaled[last] = constant - j;
            scaled.clone()
        };
        self.numbers.iter().map(factor).collect()
    }

    fn text(&self) -> String {
        let form = show(&self.form);
        let factors: Vec<String> = self.numbers.iter().map(|j| format!("(1E{}*{form}-{j})", self.exponent)).collect();
        factors.join("*")
    }
}

/// Forms in `n` unknowns that vanish together, near the origin, near an integer point or within 100.
fn forms(draw: &mut Draw, n: usize) -> Vec<Form> {
    let reach = [0, 5, 100][draw.between(0, 2) as usize];
    let at: Vec<i128> = (0..n).map(|_| draw.between(-reach, reach)).collect();
    // Where the lines miss the integer point, their crossing has a denominator.
    let miss = i128::from(reach > 0) * draw.between(0, 2);
    loop {
        let mut through = || {
            let mut form: Form = (0..n).map(|_| draw.nonzero_to(4)).collect();
            let there: i128 = form.iter().zip(&at).map(|(a, b)| a * b).sum();
            form.push(draw.between(-miss, miss) - there);
            form
        };
        let forms: Vec<Form> = (0..n).map(|_| through()).collect();
        if meet(&forms.iter().collect::<Vec<_>>()).is_some() {
            return forms;
        }
    }
}

/// Beams of so many factors each.
fn beams(draw: &mut Draw, counts: &[usize]) -> Vec<Beam> {
    let (forms, exponent) = (forms(draw, counts.len()), draw.between(4, 10) as u32);
    forms.into_iter().zip(counts).map(|(form, &count)| Beam::draw(draw, form, exponent, count)).collect()
}

/// Two solutions at a distance of 1e-3 to 1e-7.
pub(super) fn pair(draw: &mut Draw) -> Case {
    let (a, b, k) = (draw.nonzero(), draw.between(-3, 3), draw.between(3, 7));
    let distance = 10f64.powi(-k as i32);
    let pair = [a as f64 - distance, a as f64 + distance];
    Case::new(&[format!("x^2-2*({a})*x+({a})^2-1E-{}", 2 * k), format!("y-({b})*x-1")])
        .with_simple(&pair.map(|x| vec![x, b as f64 * x + 1.0]))
}

/// Roots `a + j 10^-k` with a rational `a`, and others far from them.
pub(super) fn one_unknown(draw: &mut Draw) -> Case {
    let (below, k, count) = (draw.between(1, 7), draw.between(4, 10) as u32, draw.between(2, 4) as usize);
    let above = draw.between(-20 * below, 20 * below);
    let mut cluster = Beam::draw(draw, vec![below, -above], k, count);
    cluster.numbers.iter_mut().for_each(|j| *j *= below);
    let points: Vec<Vec<f64>> = meets(&[cluster.forms()]).expect("roots");
    let middle = quotient(above, below);
    let far: Vec<i128> = (0..draw.between(0, 2)).map(|_| draw.between(-25, 25)).collect();
    let far: Vec<i128> = far.into_iter().filter(|&root| (root as f64 - middle).abs() > 0.01).collect();
    let mut text = cluster.text();
    let mut roots: Vec<(i128, usize)> = Vec::new();
    for root in far {
        text += &format!("*(x-({root}))");
        match roots.iter_mut().find(|(there, _)| *there == root) {
            Some((_, multiplicity)) => *multiplicity += 1,
            None => roots.push((root, 1)),
        }
    }
    let case = Case::new(&[text]).with_simple(&points);
    roots.iter().fold(case, |case, &(root, multiplicity)| case.with(&[root as f64], multiplicity))
}

/// Two or three parallel lines that cross as many: a grid.
pub(super) fn two_unknowns(draw: &mut Draw) -> Case {
    let counts = [draw.between(2, 3) as usize, draw.between(2, 3) as usize];
    let [a, b]: [Beam; 2] = beams(draw, &counts).try_into().ok().expect("two");
    let points = meets(&[a.forms(), b.forms()]).expect("lines that cross");
    Case::new(&[a.text(), b.text()]).with_simple(&points)
}

/// A grid of planes: 2 x 2 in a third, or 3 x 2 x 2.
pub(super) fn three_unknowns(draw: &mut Draw) -> Case {
    let counts = if draw.coin() { [2, 2, 1] } else { [3, 2, 2] };
    let beams = beams(draw, &counts);
    let points = meets(&beams.iter().map(Beam::forms).collect::<Vec<_>>()).expect("planes that cross");
    Case::new(&beams.iter().map(Beam::text).collect::<Vec<_>>()).with_simple(&points)
}

/// A grid of lines, and one more line in each equation.
pub(super) fn beside_others(draw: &mut Draw) -> Case {
    loop {
        let [a, b]: [Beam; 2] = beams(draw, &[2, 2]).try_into().ok().expect("two");
        let (c, d) = (draw.line(), draw.line());
        let groups = [vec![a.form.clone(), c.clone()], vec![b.form.clone(), d.clone()]];
        if !meets(&groups).is_some_and(|points| apart(&points)) {
            continue;
        }
        let (text, more) = ([a.text(), b.text()], [show(&c), show(&d)]);
        let groups = [[a.forms(), vec![c]].concat(), [b.forms(), vec![d]].concat()];
        let points = meets(&groups).expect("lines that cross");
        return Case::new(&[0, 1].map(|k| format!("{}*{}", text[k], more[k]))).with_simple(&points);
    }
}

/// `u + c v^2`, and two to four factors `v - j 10^-k` with a multiple of it.
pub(super) fn on_a_curve(draw: &mut Draw) -> Case {
    let (u, v, _) = draw.cross();
    let (k, c, l) = (draw.between(4, 10), draw.nonzero(), draw.between(-3, 3));
    let count = draw.between(2, 4) as usize;
    let numbers = draw.different(count, 0, 5);
    let scale = 10i128.pow(k as u32);
    let moved = |form: &Form, scale: i128, by: i128| vec![scale * form[0], scale * form[1], scale * form[2] + by];
    let at = |j: &i128| meet(&[&moved(&u, scale * scale, c * j * j), &moved(&v, scale, -j)]).expect("a point");
    let points: Vec<Vec<f64>> = numbers.iter().map(at).collect();
    let (u, v) = (show(&u), show(&v));
    let factors: Vec<String> = numbers.iter().map(|j| format!("({v}-{j}E-{k})")).collect();
    let curve = format!("{u}+({c})*{v}^2");
    let second = format!("{}+({curve})*(x+2*y+({l}))", factors.join("*"));
    Case::new(&[curve, second]).with_simple(&points)
}

/// `(x^2 - s)^2 = 10^-k` and a line: `x` is a square root of `s + 10^(-k/2)` or `s - 10^(-k/2)`.
pub(super) fn round_irrational(draw: &mut Draw) -> Case {
    let (s, b, k) = (draw.between(2, 7), draw.nonzero(), draw.between(8, 20));
    let distance = 10f64.powf(-(k as f64) / 2.0);
    let roots = [1.0, -1.0].map(|sign| (s as f64 + sign * distance).sqrt());
    let points: Vec<Vec<f64>> = roots.iter().flat_map(|&x| [x, -x]).map(|x| vec![x, b as f64 * x + 1.0]).collect();
    Case::new(&[format!("(x^2-{s})^2-1E-{k}"), format!("y-({b})*x-1")]).with_simple(&points)
}

//! Random systems whose ends are not all regular, with answers that are known by construction.

/// A system in the unknowns x and y, or x alone, and what it has.
pub(crate) struct Case {
    /// In PHCpack's format.
    pub(crate) text: String,
    /// The isolated solutions, and their multiplicities.
    pub(crate) solutions: Vec<(Vec<f64>, usize)>,
    /// Whether there is a component of positive dimension besides.
    pub(crate) component: bool,
}

/// Draws a system of a kind.
pub(crate) type Kind = fn(&mut Draw) -> Case;

/// The kinds of systems, by name.
pub(crate) const KINDS: [(&str, Kind); 10] = [
    ("component not reduced", not_reduced),
    ("overdetermined, a zero coordinate", overdetermined),
    ("overdetermined, multiple", overdetermined_multiple),
    ("isolated, corank 1", corank_one),
    ("isolated, corank 2", corank_two),
    ("multiple beside regular", multiple_beside_regular),
    ("close pair", close_pair),
    ("near a component", near_component),
    ("ill-conditioned", ill_conditioned),
    ("one unknown", one_unknown),
];

/// Random integers by Steele, Lea & Flood's SplitMix64.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// An integer from `low` to `high`.
    pub(crate) fn between(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % (high - low + 1) as u64) as i64
    }

    fn nonzero(&mut self) -> i64 {
        let size = self.between(1, 6);
        if self.next() & 1 == 0 { size } else { -size }
    }

    /// A line `a x + b y + c`.
    fn line(&mut self) -> [i64; 3] {
        [self.nonzero(), self.nonzero(), self.nonzero()]
    }

    /// Two lines through an integer point that cross there, and the point.
    fn frame(&mut self) -> ([i64; 3], [i64; 3], [i64; 2]) {
        let point = [self.between(-3, 3), self.between(-3, 3)];
        loop {
            let mut through = || {
                let (a, b) = (self.nonzero(), self.between(-4, 4));
                [a, b, -a * point[0] - b * point[1]]
            };
            let (u, v) = (through(), through());
            if u[0] * v[1] != u[1] * v[0] {
                return (u, v, point);
            }
        }
    }
}

fn show(line: [i64; 3]) -> String {
    format!("(({})*x+({})*y+({}))", line[0], line[1], line[2])
}

/// Where lines cross, if they do.
fn crossing(a: [i64; 3], b: [i64; 3]) -> Option<[f64; 2]> {
    let d = a[0] * b[1] - a[1] * b[0];
    let at = |n: i64| n as f64 / d as f64;
    (d != 0).then(|| [at(a[1] * b[2] - a[2] * b[1]), at(a[2] * b[0] - a[0] * b[2])])
}

fn value(line: [i64; 3], at: [f64; 2]) -> f64 {
    line[0] as f64 * at[0] + line[1] as f64 * at[1] + line[2] as f64
}

/// Whether points keep a distance from each other.
fn apart(points: &[[f64; 2]]) -> bool {
    let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-2;
    points.iter().enumerate().all(|(k, a)| points[..k].iter().all(|b| !near(a, b)))
}

/// `g^k l1 l2; g^k l3 l4`: four points and a multiple line.
fn not_reduced(draw: &mut Draw) -> Case {
    loop {
        let (g, k) = (draw.line(), draw.between(2, 3));
        let lines: [[i64; 3]; 4] = std::array::from_fn(|_| draw.line());
        let crossings: Option<Vec<[f64; 2]>> =
            [(0, 2), (0, 3), (1, 2), (1, 3)].iter().map(|&(a, b)| crossing(lines[a], lines[b])).collect();
        let Some(points) = crossings.filter(|p| apart(p) && p.iter().all(|&p| value(g, p).abs() > 1e-2)) else {
            continue;
        };
        let [a, b, c, d] = lines.map(show);
        let g = format!("{}^{k}", show(g));
        return Case {
            text: format!("2\n{g}*{a}*{b};\n{g}*{c}*{d};"),
            solutions: points.iter().map(|p| (p.to_vec(), 1)).collect(),
            component: true,
        };
    }
}

/// Points with different first coordinates, none of them zero, in four equations; some second
/// coordinates are zero.
fn overdetermined(draw: &mut Draw) -> Case {
    let mut firsts: Vec<i64> = Vec::new();
    while firsts.len() < 3 {
        let a = draw.nonzero();
        if !firsts.contains(&a) {
            firsts.push(a);
        }
    }
    let seconds = [0, draw.between(-2, 2), draw.between(-5, 5)];
    // Lagrange's polynomial through them.
    let mut through = String::from("0");
    for (k, a) in firsts.iter().enumerate() {
        let others: Vec<i64> = firsts.iter().copied().filter(|b| b != a).collect();
        let below: i64 = others.iter().map(|b| a - b).product();
        through += &format!("+(({})/({below}))*(x-({}))*(x-({}))", seconds[k], others[0], others[1]);
    }
    let product: Vec<String> = firsts.iter().map(|a| format!("(x-({a}))")).collect();
    let (f, c) = (format!("(y-({through}))"), draw.between(1, 5));
    let text = format!("4 2\n{};\n{f}*(y+{c}.5);\n{f}*x;\n{f}*(x-3*y+({}));", product.join("*"), draw.between(-3, 3));
    let solutions = firsts.iter().zip(seconds).map(|(&a, b)| (vec![a as f64, b as f64], 1)).collect();
    Case { text, solutions, component: false }
}

/// `u^a, u v, v^b`: the functionals are 1, a - 1 powers of one kind and b - 1 of the other.
fn overdetermined_multiple(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.frame();
    let (a, b) = (draw.between(2, 3), draw.between(2, 4));
    let (u, v) = (show(u), show(v));
    Case {
        text: format!("3 2\n{u}^{a};\n{u}*{v};\n{v}^{b};"),
        solutions: vec![(at.iter().map(|&c| c as f64).collect(), (a + b - 1) as usize)],
        component: false,
    }
}

/// `u + c v^2`, and `v^m` with a multiple of it: a smooth curve that meets another in one point,
/// `m`-fold.
fn corank_one(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.frame();
    let (m, c, k) = (draw.between(3, 6), draw.nonzero(), draw.between(-3, 3));
    let (u, v) = (show(u), show(v));
    Case {
        text: format!("2\n{u}+({c})*{v}^2;\n{v}^{m}+({u}+({c})*{v}^2)*(x+2*y+({k}));"),
        solutions: vec![(at.iter().map(|&c| c as f64).collect(), m as usize)],
        component: false,
    }
}

/// `u^a; v^b`, a product of multiplicities.
fn corank_two(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.frame();
    let (a, b) = (draw.between(2, 3), draw.between(2, 3));
    let c = draw.nonzero();
    let (u, v) = (show(u), show(v));
    Case {
        // The second without the multiple of the first.
        text: format!("2\n{u}^{a};\n{v}^{b}+({c})*{u}^{a};"),
        solutions: vec![(at.iter().map(|&c| c as f64).collect(), (a * b) as usize)],
        component: false,
    }
}

/// `(u + c v^2) l` and `v^m (u + 4 c)`: two points of multiplicity `m`, three simple ones.
fn multiple_beside_regular(draw: &mut Draw) -> Case {
    loop {
        let (u, v, _) = draw.frame();
        let (m, c, l) = (draw.between(2, 5), draw.nonzero(), draw.line());
        let moved = |line: [i64; 3], by: i64| [line[0], line[1], line[2] + by];
        let far = moved(u, 4 * c);
        // Where `u = -4 c`, `v` is 2 or -2.
        let points = [(u, v), (l, v), (far, moved(v, 2)), (far, moved(v, -2)), (l, far)].map(|(a, b)| crossing(a, b));
        let Some(points) = points.into_iter().collect::<Option<Vec<_>>>().filter(|p| apart(p)) else { continue };
        let multiplicities = [m as usize, m as usize, 1, 1, 1];
        let (u, v, far, l) = (show(u), show(v), show(far), show(l));
        return Case {
            text: format!("2\n({u}+({c})*{v}^2)*{l};\n{v}^{m}*{far};"),
            solutions: points.iter().map(|p| p.to_vec()).zip(multiplicities).collect(),
            component: false,
        };
    }
}

/// Two solutions at a distance of 1e-3 to 1e-7.
fn close_pair(draw: &mut Draw) -> Case {
    let (a, b, k) = (draw.nonzero(), draw.between(-3, 3), draw.between(3, 7));
    let distance = 10f64.powi(-k as i32);
    let pair = [a as f64 - distance, a as f64 + distance];
    Case {
        text: format!("2\nx^2-2*({a})*x+({a})^2-1E-{};\ny-({b})*x-1;", 2 * k),
        solutions: pair.iter().map(|&x| (vec![x, b as f64 * x + 1.0], 1)).collect(),
        component: false,
    }
}

/// `(u - e) g; v g` with a circle `g` through the point where `u` and `v` vanish.
fn near_component(draw: &mut Draw) -> Case {
    let k = draw.between(3, 7);
    let (c, at) = (draw.nonzero(), [draw.between(-2, 2), draw.between(-2, 2)]);
    // The circle through `at` about (at + (c, 0)).
    let circle = format!("((x-({}))^2+(y-({}))^2-({c})^2)", at[0] + c, at[1]);
    Case {
        text: format!("2\n(x-({})+1E-{k})*{circle};\n(y-({}))*{circle};", at[0], at[1]),
        solutions: vec![(vec![at[0] as f64 - 10f64.powi(-k as i32), at[1] as f64], 1)],
        component: true,
    }
}

/// `l1 l2; c l1 l2 + e l3 l4`
fn ill_conditioned(draw: &mut Draw) -> Case {
    loop {
        let lines: [[i64; 3]; 4] = std::array::from_fn(|_| draw.line());
        let crossings: Option<Vec<[f64; 2]>> =
            [(0, 2), (0, 3), (1, 2), (1, 3)].iter().map(|&(a, b)| crossing(lines[a], lines[b])).collect();
        let Some(points) = crossings.filter(|p| apart(p)) else { continue };
        let ([a, b, c, d], factor, k) = (lines.map(show), draw.nonzero(), draw.between(6, 13));
        return Case {
            text: format!("2\n{a}*{b};\n({factor})*{a}*{b}+1E-{k}*{c}*{d};"),
            solutions: points.iter().map(|p| (p.to_vec(), 1)).collect(),
            component: false,
        };
    }
}

/// Integer roots of multiplicities up to three, of degree up to 18.
fn one_unknown(draw: &mut Draw) -> Case {
    let mut solutions: Vec<(Vec<f64>, usize)> = Vec::new();
    let mut factors: Vec<String> = Vec::new();
    for _ in 0..draw.between(4, 9) {
        let root = draw.between(-12, 12);
        let multiplicity = draw.between(1, 2) as usize;
        if solutions.iter().all(|(r, _)| r[0] != root as f64) {
            solutions.push((vec![root as f64], multiplicity));
            factors.push(format!("(x-({root}))^{multiplicity}"));
        }
    }
    Case { text: format!("1\n{};", factors.join("*")), solutions, component: false }
}

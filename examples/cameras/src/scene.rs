//! Random cameras and points, as the two families have them.

use hc::random::Random;

/// Data with a known solution.
pub struct Problem {
    pub parameters: Vec<f64>,
    pub solution: Vec<f64>,
}

/// Takes `x` to `R x + t`, with the rotation `R` in Cayley's parameters.
struct Camera {
    cayley: [f64; 3],
    translation: [f64; 3],
}

impl Camera {
    /// `R x = x + 2 (c x + c c x) / (1 + |c|^2)`, where `c x` is the cross product with the parameters.
    fn turn(&self, x: [f64; 3]) -> [f64; 3] {
        let c = self.cayley;
        let (once, twice) = (cross(c, x), cross(c, cross(c, x)));
        let scale = 2.0 / (1.0 + c.iter().map(|c| c * c).sum::<f64>());
        std::array::from_fn(|i| x[i] + scale * (once[i] + twice[i]))
    }

    fn place(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(x);
        std::array::from_fn(|i| turned[i] + self.translation[i])
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn uniform(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * (random.unit().arg() / std::f64::consts::TAU + 0.5)
}

/// Five points in two cameras, the first at distance about 1 from the second.
pub fn five_points(random: &mut Random) -> Problem {
    let [x, y, z, u, v] = [(); 5].map(|()| uniform(random, -0.5, 0.5));
    let first = Camera { cayley: [x, y, z], translation: [1.0, u, v] };
    let mut parameters = Vec::new();
    while parameters.len() < 20 {
        let [p, q, depth] = point(random);
        let [a, b, c] = first.place([p, q, depth]);
        // In front of both cameras.
        if c > 0.5 {
            parameters.extend([a / c, b / c, p / depth, q / depth]);
        }
    }
    Problem { parameters, solution: vec![x, y, z, u, v] }
}

/// Three points in three cameras, with lines through two of them.
pub fn chicago(random: &mut Random) -> Problem {
    let mut camera = |size: f64| Camera {
        cayley: [(); 3].map(|()| size * uniform(random, -0.5, 0.5)),
        translation: [(); 3].map(|()| size * uniform(random, -1.0, 1.0)),
    };
    let cameras = [camera(0.0), camera(1.0), camera(1.0)];
    let mut points = Vec::new();
    while points.len() < 3 {
        let x = point(random);
        if cameras.iter().all(|camera| camera.place(x)[2] > 0.5) {
            points.push(x);
        }
    }
    let lines = [(); 2].map(|()| [(); 3].map(|()| random.normal().re));
    let (mut seen, mut directions, mut depths) = (Vec::new(), Vec::new(), Vec::new());
    for camera in &cameras {
        for (k, &x) in points.iter().enumerate() {
            let [a, b, depth] = camera.place(x);
            seen.extend([a / depth, b / depth]);
            depths.push(depth);
            let Some(&line) = lines.get(k) else { continue };
            // The derivative of the image of x + s line, made a unit vector.
            let [p, q, r] = camera.turn(line);
            let [p, q] = [p - r * a / depth, q - r * b / depth];
            directions.extend([p / p.hypot(q), q / p.hypot(q)]);
        }
    }
    let rotations = cameras[1..].iter().flat_map(|camera| camera.cayley);
    // From camera by camera to point by point, without the depth that is one.
    let depths = (1..9).map(|i| depths[3 * (i % 3) + i / 3] / depths[0]);
    Problem { solution: rotations.chain(depths).collect(), parameters: [seen, directions].concat() }
}

/// A point three to six units in front of the camera at the origin.
fn point(random: &mut Random) -> [f64; 3] {
    [uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0), uniform(random, 3.0, 6.0)]
}

//! Three views of three points, with lines through two of them: examples/families/chicago.toml.

use hc::family::Stopped;
use hc::poly::Complex64;
use hc::random::Random;
use hc::{Family, MonodromyOptions};

type Vector = [f64; 3];

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The rotation with these Cayley parameters, of a vector.
fn turn(c: Vector, x: Vector) -> Vector {
    let (once, twice) = (cross(c, x), cross(c, cross(c, x)));
    let scale = 2.0 / (1.0 + c.iter().map(|c| c * c).sum::<f64>());
    std::array::from_fn(|i| x[i] + scale * (once[i] + twice[i]))
}

/// The parameters and the solution of a scene: rotations and translations of the cameras, points, directions of the lines.
fn scene(cameras: [(Vector, Vector); 3], points: [Vector; 3], lines: [Vector; 2]) -> (Vec<f64>, Vec<f64>) {
    let (mut seen, mut directions, mut depths) = (Vec::new(), Vec::new(), [[0.0; 3]; 3]);
    for (v, (c, t)) in cameras.into_iter().enumerate() {
        for (k, x) in points.into_iter().enumerate() {
            let turned = turn(c, x);
            let [a, b, depth]: Vector = std::array::from_fn(|i| turned[i] + t[i]);
            seen.extend([a / depth, b / depth]);
            depths[k][v] = depth;
            // The derivative of the image of x + s line, times the depth.
            directions.extend(lines.get(k).map(|&line| turn(c, line)).into_iter().flat_map(|[p, q, r]| {
                let [a, b] = [a / depth, b / depth];
                [p - r * a, q - r * b]
            }));
        }
    }
    let depths = depths.iter().flatten().skip(1).map(|d| d / depths[0][0]);
    ([seen, directions].concat(), [cameras[1].0, cameras[2].0].into_iter().flatten().chain(depths).collect())
}

/// 312 solutions: Fabbri et al., CVPR 2020, and Gröbner bases (see the family). Each of several targets has as many, among them the
/// scene behind the data.
#[test]
fn chicago_has_312_solutions() {
    let family: Family = include_str!("../../../../examples/families/chicago.toml").parse().unwrap();
    let found = family.monodromy(&MonodromyOptions::new()).unwrap();
    assert_eq!((found.stopped, found.fibre.len()), (Stopped::RootsReached, 312));
    let (data, planted) = scene(
        [([0.0; 3], [0.0; 3]), ([0.1, -0.2, 0.3], [1.0, 0.2, -0.1]), ([-0.3, 0.1, 0.2], [-0.4, 0.9, 0.3])],
        [[1.0, 0.5, 4.0], [-0.7, 1.1, 5.0], [0.3, -0.9, 3.5]],
        [[0.2, 1.0, 0.4], [1.0, -0.3, 0.6]],
    );
    let targets = [data.iter().map(|&p| p.into()).collect(), Random::new(1, 0).normals(data.len())];
    let solved = family.track(&found.fibre, &targets).run().unwrap();
    for (k, solutions) in solved.iter().enumerate() {
        assert_eq!((solutions.paths.finite, solutions.len()), (312, 312), "target {k}: {:?}", solutions.paths);
    }
    let near = |x: &[Complex64]| x.iter().zip(&planted).all(|(x, p)| (x - p).norm() < 1e-8);
    assert!(solved[0].iter().any(|solution| near(&solution.value)));
}

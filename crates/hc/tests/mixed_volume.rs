//! Mixed volumes of families with known counts, and against inclusion and exclusion.

use hc::start::{mixed_cells, mixed_volume};
use proptest::prelude::{Strategy, prop, prop_assert_eq, proptest};
use std::collections::BTreeSet;

type Support = Vec<Vec<i32>>;

fn support(points: impl IntoIterator<Item = Vec<i32>>) -> Support {
    points.into_iter().collect::<BTreeSet<_>>().into_iter().collect()
}

/// Sum of unit vectors.
fn units(n: usize, which: &[usize]) -> Vec<i32> {
    let mut e = vec![0; n];
    which.iter().for_each(|&i| e[i] += 1);
    e
}

fn cyclic(n: usize) -> Vec<Support> {
    let mut system: Vec<Support> =
        (1..n).map(|m| support((0..n).map(|j| units(n, &(j..j + m).map(|k| k % n).collect::<Vec<_>>())))).collect();
    system.push(vec![vec![1; n], vec![0; n]]);
    system
}

fn noon(n: usize) -> Vec<Support> {
    let equation = |i: usize| {
        let cubes = (0..n).filter(move |&j| j != i).map(move |j| units(n, &[i, j, j]));
        support(cubes.chain([units(n, &[i]), vec![0; n]]))
    };
    (0..n).map(equation).collect()
}

fn eco(n: usize) -> Vec<Support> {
    let equation = |k: usize| {
        let products = (1..n - k).map(move |i| units(n, &[i - 1, i + k - 1, n - 1]));
        support(products.chain([units(n, &[k - 1, n - 1]), vec![0; n]]))
    };
    let mut system: Vec<Support> = (1..n).map(equation).collect();
    system.push(support((0..n - 1).map(|i| units(n, &[i])).chain([vec![0; n]])));
    system
}

fn katsura(n: usize) -> Vec<Support> {
    let equation = |m: i32| {
        let l = -(n as i32)..=n as i32;
        let products = l.filter(|l| (m - l).unsigned_abs() as usize <= n);
        let products = products.map(|l| units(n + 1, &[l.unsigned_abs() as usize, (m - l).unsigned_abs() as usize]));
        support(products.chain([units(n + 1, &[m as usize])]))
    };
    let mut system: Vec<Support> = (0..n as i32).map(equation).collect();
    system.push(support((0..=n).map(|i| units(n + 1, &[i])).chain([vec![0; n + 1]])));
    system
}

fn chandra(n: usize) -> Vec<Support> {
    let equation = |i: usize| {
        let products = (0..n - 1).map(move |j| units(n, &[i, j]));
        support(products.chain([units(n, &[i]), vec![0; n]]))
    };
    (0..n).map(equation).collect()
}

fn volume(system: &[Support]) -> u64 {
    mixed_volume(system.len(), system).unwrap().volume
}

/// Roots of cyclic-n counted by mixed volume: 5, 6, 7, 8 as in the literature (Emiris & Canny 1995; Verschelde's PHCpack).
#[test]
fn cyclic_roots() {
    assert_eq!([5, 6, 7, 8].map(|n| volume(&cyclic(n))), [70, 156, 924, 2560]);
}

#[test]
fn families_with_formulas() {
    assert_eq!([3, 4, 5].map(|n| volume(&noon(n))), [21, 73, 233]); // 3^n - 2n
    assert_eq!([5, 6, 7, 8].map(|n| volume(&eco(n))), [8, 16, 32, 64]); // 2^(n-2)
    // All 2^n roots, some of them with zero coordinates, which count where the origin belongs to every support (Li & Wang 1996).
    let with_origin = |system: Vec<Support>| -> Vec<Support> {
        system.into_iter().map(|s| support(s.into_iter().chain([vec![0; 6]]))).collect()
    };
    assert_eq!(volume(&with_origin(katsura(5))), 32);
    assert_eq!([5, 8].map(|n| volume(&katsura(n))), [30, 240]); // in the torus: gfan_mixedvolume 0.6.2
    assert_eq!([4, 5, 6].map(|n| volume(&chandra(n))), [8, 16, 32]); // 2^(n-1)
}

/// Cells of a small pair of supports for two liftings (tests of MixedSubdivisions.jl).
#[test]
fn cells_of_given_liftings() {
    let a = vec![vec![0, 0], vec![0, 2], vec![1, 0], vec![1, 1]];
    let b = vec![vec![0, 0], vec![0, 1], vec![1, 1], vec![2, 0]];
    let system = [a, b];
    for (first, expected) in [(vec![0, 0, 0, 1], vec![1, 1, 2]), (vec![0, 0, 0, 2], vec![1, 3])] {
        let lifting = [first, vec![0, 3, 4, 8]];
        let cells = mixed_cells(2, &system, &lifting).unwrap();
        let mut volumes: Vec<u64> = cells.iter().map(|c| c.volume).collect();
        volumes.sort_unstable();
        assert_eq!(volumes, expected);
        check_normals(&system, &lifting, &cells);
    }
}

/// Negative exponents (issue 30 of MixedSubdivisions.jl).
#[test]
fn laurent_supports() {
    let columns = |rows: [&[i32]; 3]| (0..rows[0].len()).map(|k| rows.iter().map(|r| r[k]).collect()).collect();
    let system: [Support; 3] = [
        columns([&[1, 0, 1, 0, 1, 1, 0], &[0, 1, 1, 0, 1, 1, 0], &[0, 0, 0, 1, -1, 0, 0]]),
        columns([&[1, 1, 0], &[1, 1, 0], &[-1, 0, 0]]),
        columns([&[0, 1, 0], &[1, 1, 0], &[0, 0, 0]]),
    ];
    assert_eq!(volume(&system), 3);
    let lifting = [vec![2, 4, 1, 4, 5, 4, 3], vec![1, 4, 3], vec![5, 5, 2]];
    let cells = mixed_cells(3, &system, &lifting).unwrap();
    assert!(cells.iter().all(|c| c.volume == 1));
    let normals: BTreeSet<Vec<i128>> = cells.iter().map(|c| c.normal.clone()).collect();
    let expected = [[-4, 1, -3], [2, -3, -4], [3, -3, -2]];
    assert_eq!(normals, expected.iter().map(|g| g.to_vec()).collect());
}

fn check_normals(system: &[Support], lifting: &[Vec<i32>], cells: &[hc::start::MixedCell]) {
    for cell in cells {
        for (i, points) in system.iter().enumerate() {
            let height = |p: usize| {
                let slope: i128 = points[p].iter().zip(&cell.normal).map(|(&x, g)| i128::from(x) * g).sum();
                slope + i128::from(lifting[i][p]) * i128::from(cell.volume)
            };
            let least = height(cell.edges[i][0]);
            assert_eq!(height(cell.edges[i][1]), least);
            assert!((0..points.len()).all(|p| height(p) >= least));
        }
    }
}

/// `n!` times the volume of the convex hull, by summing determinants over an exact triangulation of placed points.
fn normalised_volume(points: &[Vec<i64>]) -> i64 {
    match points[0].len() {
        2 => hull_area(points),
        _ => hull_volume(points),
    }
}

/// Twice the area, by Andrew's monotone chain.
fn hull_area(points: &[Vec<i64>]) -> i64 {
    let sorted: Vec<&Vec<i64>> = points.iter().collect::<BTreeSet<_>>().into_iter().collect();
    let cross = |o: &[i64], a: &[i64], b: &[i64]| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    let half = |points: Vec<&Vec<i64>>| {
        let mut chain: Vec<&Vec<i64>> = Vec::new();
        for p in points {
            while chain.len() > 1 && cross(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.windows(2).map(|w| w[0][0] * w[1][1] - w[1][0] * w[0][1]).sum::<i64>()
    };
    half(sorted.clone()) + half(sorted.into_iter().rev().collect())
}

/// Six times the volume: cones from the first point over the facets, each facet measured by the area of its projection.
fn hull_volume(points: &[Vec<i64>]) -> i64 {
    let points: Vec<&Vec<i64>> = points.iter().collect::<BTreeSet<_>>().into_iter().collect();
    let sub = |a: &[i64], b: &[i64]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: &[i64; 3], b: &[i64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut facets: BTreeSet<([i64; 3], i64)> = BTreeSet::new();
    for i in 0..points.len() {
        for j in 0..i {
            for k in 0..j {
                let (u, v) = (sub(points[j], points[i]), sub(points[k], points[i]));
                let mut normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                let common = normal.iter().fold(0i64, |a, &b| gcd(a, b));
                if common == 0 {
                    continue;
                }
                normal = normal.map(|x| x / common);
                for normal in [normal, normal.map(|x| -x)] {
                    let top = points.iter().map(|p| dot(&normal, &sub(p, &[0; 3]))).max().unwrap_or(0);
                    if top == dot(&normal, &sub(points[i], &[0; 3])) {
                        facets.insert((normal, top));
                    }
                }
            }
        }
    }
    let apex = points[0];
    facets
        .iter()
        .map(|(normal, top)| {
            let axis = (0..3).find(|&c| normal[c] != 0).unwrap_or(0);
            let flat: Vec<Vec<i64>> = points
                .iter()
                .filter(|p| dot(normal, &sub(p, &[0; 3])) == *top)
                .map(|p| (0..3).filter(|&c| c != axis).map(|c| p[c]).collect())
                .collect();
            hull_area(&flat) * (top - dot(normal, &sub(apex, &[0; 3]))) / normal[axis].abs()
        })
        .sum()
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

/// `MV = sum over nonempty S of (-1)^(n-|S|) vol(sum of S)`; with `n! vol` this is `n! MV`.
fn inclusion_exclusion(system: &[Support]) -> i64 {
    let n = system.len();
    (1u32..1 << n)
        .map(|subset| {
            let mut sum = vec![vec![0i64; n]];
            for (_, points) in system.iter().enumerate().filter(|(i, _)| subset >> i & 1 == 1) {
                let sums: BTreeSet<Vec<i64>> = sum
                    .iter()
                    .flat_map(|s| points.iter().map(|p| s.iter().zip(p).map(|(a, &b)| a + i64::from(b)).collect()))
                    .collect();
                sum = sums.into_iter().collect();
            }
            let sign = if (n - subset.count_ones() as usize).is_multiple_of(2) { 1 } else { -1 };
            sign * normalised_volume(&sum)
        })
        .sum()
}

fn random_system(n: usize, sizes: std::ops::Range<usize>, top: i32) -> impl Strategy<Value = Vec<Support>> {
    let point = prop::collection::vec(-top..=top, n);
    prop::collection::vec(prop::collection::btree_set(point, sizes).prop_map(support), n)
}

proptest! {
    #[test]
    fn planar_supports_by_inclusion_and_exclusion(system in random_system(2, 1..7, 4)) {
        prop_assert_eq!(2 * volume(&system) as i64, inclusion_exclusion(&system));
    }

    #[test]
    fn spatial_supports_by_inclusion_and_exclusion(system in random_system(3, 1..5, 2)) {
        prop_assert_eq!(6 * volume(&system) as i64, inclusion_exclusion(&system));
    }

    #[test]
    fn translations_shears_and_liftings_change_nothing(
        system in random_system(3, 2..6, 3),
        shift in prop::collection::vec(-5i32..5, 9),
        seed in prop::collection::vec(-1000i32..1000, 18),
    ) {
        let expected = volume(&system);
        let moved: Vec<Support> = system.iter().enumerate().map(|(i, points)| points.iter().map(|p| {
            let s = &shift[3 * i..3 * i + 3];
            vec![p[0] + s[0], p[1] + 2 * p[0] + s[1], p[2] - p[1] + s[2]]
        }).collect()).collect();
        prop_assert_eq!(volume(&moved), expected);
        let lifting: Vec<Vec<i32>> =
            system.iter().enumerate().map(|(i, a)| seed[6 * i..6 * i + a.len()].to_vec()).collect();
        let cells = mixed_cells(3, &system, &lifting).unwrap();
        prop_assert_eq!(cells.iter().map(|c| c.volume).sum::<u64>(), expected);
        check_normals(&system, &lifting, &cells);
    }
}

/// Exponents 100 times as large make the volume 100^5 times as large, beyond the small integers.
#[test]
fn large_exponents_need_large_integers() {
    let scaled: Vec<Support> =
        cyclic(5).iter().map(|a| a.iter().map(|p| p.iter().map(|e| 100 * e).collect()).collect()).collect();
    assert_eq!(volume(&scaled), 70 * 100u64.pow(5));
}

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

/// `sum over i < n/2 of x_i y_i^k = c_k`, `k = 0 .. n - 1`.
fn gaukwa(half: usize) -> Vec<Support> {
    let n = 2 * half;
    let term = |i: usize, k: usize| units(n, &[vec![i], vec![half + i; k]].concat());
    (0..n).map(|k| support((0..half).map(|i| term(i, k)).chain([vec![0; n]]))).collect()
}

/// `sum over i of (-1)^(i+1) x_i^(k+1) = 1/2`, `k = 1 .. n`.
fn reimer(n: usize) -> Vec<Support> {
    (1..=n).map(|k| support((0..n).map(|i| units(n, &vec![i; k + 1])).chain([vec![0; n]]))).collect()
}

/// Cyclic roots with the last coordinate one.
fn reduced_cyclic(n: usize) -> Vec<Support> {
    cyclic(n)[..n - 1].iter().map(|s| support(s.iter().map(|p| p[..n - 1].to_vec()))).collect()
}

/// `n` players with two strategies each: equation `i` is linear in every unknown but its own, which
/// it lacks.
fn game(n: usize) -> Vec<Support> {
    let subset = |bits: usize| (0..n).map(|j| (bits >> j & 1) as i32).collect::<Vec<_>>();
    (0..n).map(|i| support((0..1 << n).filter(|bits| bits >> i & 1 == 0).map(subset))).collect()
}

/// Distances between neighbours and second neighbours in a ring of eight atoms, the first three in
/// a frame, and two linear equations.
fn ring_of_eight() -> Vec<Support> {
    let n = 17;
    let unknown = |atom: usize, axis: usize| match (atom, axis) {
        (0 | 1, _) | (2, 2) => None,
        (2, axis) => Some(axis),
        (atom, axis) => Some(3 * atom - 7 + axis),
    };
    let distance = |a: usize, b: usize| {
        let axis = |axis: usize| {
            let own: Vec<usize> = [a, b].into_iter().filter_map(|atom| unknown(atom, axis)).collect();
            let linear = own.iter().map(|&i| units(n, &[i])).collect::<Vec<_>>();
            let products = own.iter().flat_map(|&i| own.iter().map(move |&j| units(n, &[i, j])));
            linear.into_iter().chain(products.collect::<Vec<_>>())
        };
        support((0..3).flat_map(axis).chain([vec![0; n]]))
    };
    let mut system: Vec<Support> = (1..8).map(|i| distance(i, (i + 1) % 8)).collect();
    system.extend((0..8).map(|i| distance(i, (i + 2) % 8)));
    system.extend(vec![support((0..n).map(|i| units(n, &[i])).chain([vec![0; n]])); 2]);
    system
}

fn with_origin(system: Vec<Support>) -> Vec<Support> {
    let n = system.len();
    system.into_iter().map(|s| support(s.into_iter().chain([vec![0; n]]))).collect()
}

fn volume(system: &[Support]) -> u64 {
    mixed_volume(system.len(), system).unwrap().volume
}

/// Roots of cyclic-n counted by mixed volume, 5 to 11, as in the literature (Emiris & Canny 1995;
/// Verschelde's PHCpack; Li & Li 2001).
#[test]
fn cyclic_roots() {
    let expected = [70, 156, 924, 2560, 11016, 35940, 184756];
    assert_eq!([5, 6, 7, 8, 9, 10, 11].map(|n| volume(&cyclic(n))), expected);
    // The roots come in orbits of n.
    assert_eq!([5, 6, 7, 8].map(|n| volume(&reduced_cyclic(n))), [14, 26, 132, 320]);
}

#[test]
fn families_with_formulas() {
    for n in 3..=10 {
        assert_eq!(volume(&noon(n)), 3u64.pow(n as u32) - 2 * n as u64);
    }
    for n in 5..=14 {
        assert_eq!(volume(&eco(n)), 1 << (n - 2));
    }
    for n in 4..=10 {
        assert_eq!(volume(&chandra(n)), 1 << (n - 1));
    }
    for half in 2..=5 {
        assert_eq!(volume(&gaukwa(half)), (2 * half as u64 + 1).pow(half as u32 - 1));
    }
    for n in 2..=5 {
        assert_eq!(volume(&reimer(n)), (2..=n as u64 + 1).product::<u64>()); // Bezout's number
    }
    // Permutations without a fixed point.
    assert_eq!([4, 5, 6, 7].map(|n| volume(&game(n))), [9, 44, 265, 1854]);
    // All 2^n roots, some of them with zero coordinates, which count where the origin belongs to
    // every support (Li & Wang 1996).
    for n in 5..=10 {
        assert_eq!(volume(&with_origin(katsura(n))), 1 << n);
    }
    assert_eq!([5, 8, 10, 14].map(|n| volume(&katsura(n))), [30, 240, 990, 16254]); // in the torus: gfan_mixedvolume 0.6.2
}

/// Seventeen unknowns and liftings of 20 bits: integers far beyond 32 bits.
#[test]
fn a_ring_of_eight_atoms_with_large_liftings() {
    let system = ring_of_eight();
    let mut state = 1u64;
    let mut lift = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((state >> 43) as i32) - (1 << 20)
    };
    let lifting: Vec<Vec<i32>> = system.iter().map(|s| s.iter().map(|_| lift()).collect()).collect();
    let cells = mixed_cells(17, &system, &lifting).unwrap();
    assert_eq!(cells.iter().map(|c| c.volume).sum::<u64>(), 1 << 15);
    check_normals(&system, &lifting, &cells);
}

#[test]
fn threads_do_not_change_the_cells() {
    let system = cyclic(8);
    let lifting: Vec<Vec<i32>> = system
        .iter()
        .enumerate()
        .map(|(i, s)| (0..s.len()).map(|p| (7919 * (i * 11 + p) % 1009) as i32).collect())
        .collect();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| mixed_cells(8, &system, &lifting).unwrap())
    };
    let cells = on(1);
    assert_eq!(cells.iter().map(|c| c.volume).sum::<u64>(), 2560);
    assert!(on(4) == cells);
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

/// `n!` times the volume of the convex hull, by summing determinants over an exact triangulation of
/// placed points.
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

/// Six times the volume: cones from the first point over the facets, each facet measured by the
/// area of its projection.
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

/// Exponents `s` times as large change no sign, so that there are the same cells, `s^n` times as
/// large, in integers that need up to 128 bits.
#[test]
fn large_exponents_need_large_integers() {
    for (n, s) in [(5, 2), (5, 100), (5, 3000), (7, 7), (7, 150)] {
        let scaled: Vec<Support> =
            cyclic(n).iter().map(|a| a.iter().map(|p| p.iter().map(|e| s * e).collect()).collect()).collect();
        let (found, plain) = (mixed_volume(n, &scaled).unwrap(), mixed_volume(n, &cyclic(n)).unwrap());
        assert_eq!(found.volume, plain.volume * (s as u64).pow(n as u32));
        assert_eq!(found.cells, plain.cells);
    }
}

/// Two segments: the determinant of their directions, here `N^2 + 1`, with entries beyond what 64
/// bits allow.
#[test]
fn segments_as_long_as_can_be() {
    let long = 2_000_000_000;
    let segments = [vec![vec![long, 1], vec![0, 0]], vec![vec![0, long], vec![1, 0]]];
    assert_eq!(volume(&segments), 4_000_000_000_000_000_001);
    let found = mixed_cells(2, &segments, &[vec![i32::MAX, i32::MIN], vec![5, i32::MAX]]).unwrap();
    assert_eq!(found.iter().map(|c| c.volume).collect::<Vec<_>>(), [4_000_000_000_000_000_001]);
    // Three of them: the volume does not fit.
    let axis = |i: usize| vec![vec![0, 0, 0], (0..3).map(|j| if i == j { long } else { 0 }).collect()];
    assert_eq!(mixed_volume(3, &[axis(0), axis(1), axis(2)]), Err(hc::start::MixedError::TooLarge));
}

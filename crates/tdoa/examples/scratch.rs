//! scratch
use hc::random::Random;
use std::time::Instant;
use tdoa::minimal::*;
use tdoa::*;
fn instance(seed: u64) -> (Network, Pseudoranges) {
    let mut random = Random::new(seed, 63);
    let mut normal = || random.normal().re * 2f64.sqrt();
    let network = Network {
        receivers: (0..6).map(|_| [normal(), normal()]).collect(),
        transmitters: (0..3).map(|_| [normal(), normal()]).collect(),
        offsets: (0..3).map(|_| normal()).collect(),
    };
    let values = (0..18).map(|k| network.pseudorange(k / 3, k % 3)).collect();
    (network, Pseudoranges::new(6, 3, values).unwrap())
}
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let (n, bo, bt, bl) = (a[0] as u64, a[1], a[2], a[3]);
    let mut o = SolveOptions::default();
    o.paths.tracker.beta_omega = bo;
    o.paths.tracker.beta_tau = bt;
    o.paths.tracker.beta_tau_last = bl;
    if a.len() > 4 {
        o.paths.tracker.corrector_tolerance = a[4];
    }
    let mut s = SixThree::new();
    let t = Instant::now();
    let (mut fail, mut inf, mut ret, mut inst_ret, mut odd, mut lost) = (0, 0, 0, 0, 0, 0);
    let mut errs = vec![];
    let (mut st, mut rj, mut jc, mut mx) = (0, 0, 0, 0);
    for seed in 0..n {
        let (truth, f) = instance(seed);
        let r = s.solve(&f, &o).unwrap();
        fail += r.paths.failed;
        inf += r.paths.at_infinity;
        ret += r.paths.retracked;
        inst_ret += (r.paths.retracked > 0) as usize;
        odd += r.counts.positive_definite % 2;
        let e = r
            .candidates
            .iter()
            .filter(|c| c.physical)
            .map(|c| c.network.offsets.iter().zip(&truth.offsets).map(|(a, b)| (a - b).abs()).fold(0., f64::max))
            .fold(f64::INFINITY, f64::min);
        if !(e < 1e-6) {
            lost += 1;
            println!("seed {seed} {e:.1e} {:?} {:?}", r.paths, r.counts);
        } else if r.paths.failed > 0 {
            println!("seed {seed} {:?}", r.paths);
        }
        for p in s.records() {
            st += p.accepted;
            rj += p.rejected;
            jc += p.jacobians;
            mx = mx.max(p.accepted);
        }
        errs.push(e);
    }
    let el = t.elapsed().as_secs_f64();
    errs.sort_by(f64::total_cmp);
    let k = (n * 180) as f64;
    println!(
        "{bo} {bt} {bl}: {:.2} ms/solve fail {fail} inf {inf} retracked {ret} in {inst_ret} odd {odd} lost {lost} median {:.1e} p99 {:.1e} steps {:.1} rej {:.2} jac {:.1} max {mx}",
        el / n as f64 * 1e3,
        errs[errs.len() / 2],
        errs[errs.len() * 99 / 100],
        st as f64 / k,
        rj as f64 / k,
        jc as f64 / k
    );
}

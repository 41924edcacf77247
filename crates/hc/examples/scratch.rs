use hc::*;
use std::time::Instant;
fn main() {
    let text = std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap();
    let fam = poly::parse::family(&text).unwrap();
    let sys = fam.system.compile().unwrap();
    let nz = fam.nonzero.compile().unwrap();
    let accept = |p: &[num_complex::Complex64], x: &[num_complex::Complex64]| {
        use poly::Evaluate;
        let mut mem = nz.memory(poly::Isa::Portable);
        let mut v = vec![num_complex::Complex64::new(0., 0.); nz.equations()];
        nz.values(&mut mem, x, p, &mut v);
        v.iter().all(|z| z.norm() > 1e-9)
    };
    let t = Instant::now();
    let start = pair::find_pair(&fam.system, accept, 1).unwrap().unwrap();
    println!("pair {:?} {:?}", t.elapsed(), start.solution(0));
    let mut o = monodromy::MonodromyOptions::default();
    o.roots = fam.roots;
    let t = Instant::now();
    let r = monodromy::monodromy(&sys, &start, accept, &o);
    println!("monodromy {:?} {} {:?} loops {} paths {}", t.elapsed(), r.fibre.len(), r.stop, r.loops, r.paths);
    let f = r.fibre;
    for (bo, bt, bl) in
        [(3.0, 0.4, 0.3), (2.0, 0.4, 0.3), (1.5, 0.4, 0.3), (2.0, 0.75, 0.4), (1.5, 0.75, 0.5), (1.2, 0.9, 0.7)]
    {
        let mut fo = fibre::FibreOptions::default();
        fo.tracker.beta_omega = bo;
        fo.tracker.beta_tau = bt;
        fo.tracker.beta_tau_last = bl;
        fo.retries = 2;
        let (mut el, mut st, mut re, mut ja, mut fail, mut ret, mut ext) = (0.0, 0, 0, 0, 0, 0, 0);
        for seed in 0..20u64 {
            let mut rnd = random::Random::new(seed, 99);
            let target: Vec<_> =
                (0..f.parameters.len()).map(|_| num_complex::Complex64::new(rnd.normal().re * 1.4, 0.)).collect();
            let t = Instant::now();
            let (ends, c) = fibre::track_fibre(&sys, &f, &target, &fo);
            el += t.elapsed().as_secs_f64();
            st += ends.results().iter().map(|r| r.accepted).sum::<usize>();
            re += ends.results().iter().map(|r| r.rejected).sum::<usize>();
            ja += ends.results().iter().map(|r| r.jacobians).sum::<usize>();
            for r in ends.results().iter().filter(|r| !r.end.is_good() || r.accepted > 1000) {
                println!("   {seed} {r:?}");
            }
            fail += c.failed;
            ret += c.retracked;
            ext += ends.results().iter().filter(|r| r.extended).count();
        }
        let k = 20. * 180.;
        println!(
            "bo {bo} bt {bt} bl {bl}: {:.1} ms steps {:.1} rej {:.2} jac {:.1} fail {fail} retracked {ret} ext {ext}",
            el / 20. * 1e3,
            st as f64 / k,
            re as f64 / k,
            ja as f64 / k
        );
    }
    for seed in 0..0u64 {
        let mut rnd = random::Random::new(seed, 99);
        let target: Vec<_> =
            (0..f.parameters.len()).map(|_| num_complex::Complex64::new(rnd.normal().re * 1.4, 0.)).collect();
        let t = Instant::now();
        let (ends, c) = fibre::track_fibre(&sys, &f, &target, &Default::default());
        let el = t.elapsed();
        let steps: usize = ends.results().iter().map(|r| r.accepted).sum();
        let rej: usize = ends.results().iter().map(|r| r.rejected).sum();
        let jac: usize = ends.results().iter().map(|r| r.jacobians).sum();
        println!(
            "target {seed} {:?} {:?} steps/path {} rej {} jac {} ext {}",
            el,
            c,
            steps as f64 / f.len() as f64,
            rej as f64 / f.len() as f64,
            jac as f64 / f.len() as f64,
            ends.results().iter().filter(|r| r.extended).count()
        );
        for r in ends.results().iter().filter(|r| !r.end.is_good()) {
            println!("   {r:?}");
        }
    }
    if std::env::args().nth(2).is_some() {
        let t = Instant::now();
        println!("{:?}", trace::trace_test(&fam.system, &f, &o));
        println!("{:?}", t.elapsed());
    }
}

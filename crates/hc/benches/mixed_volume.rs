//! Mixed volumes of systems of the literature, on all cores.

#[path = "../tests/all/common/generators.rs"]
#[allow(dead_code)]
mod generators;

use divan::{Bencher, black_box};
use generators::{cyclic, eco, katsura, noon};
use hc::poly::parse::phcpack;
use hc::start::mixed_volume;

fn main() {
    divan::main();
}

fn measure(bencher: Bencher<'_, '_>, system: &str) {
    let system = phcpack(system).expect("a system");
    let polynomials = system.expand(&Default::default()).expect("not too large");
    let supports: Vec<Vec<Vec<i32>>> = polynomials.iter().map(|p| p.support()).collect();
    bencher.bench_local(|| mixed_volume(system.variables().len(), black_box(&supports)));
}

#[divan::bench(args = [7, 8, 9])]
fn cyclic_roots(bencher: Bencher<'_, '_>, n: usize) {
    measure(bencher, &cyclic(n));
}

#[divan::bench(args = [8, 10])]
fn katsura_magnetism(bencher: Bencher<'_, '_>, n: usize) {
    measure(bencher, &katsura(n));
}

#[divan::bench(args = [10, 14])]
fn economics(bencher: Bencher<'_, '_>, n: usize) {
    measure(bencher, &eco(n));
}

#[divan::bench(args = [6, 8])]
fn neural_network(bencher: Bencher<'_, '_>, n: usize) {
    measure(bencher, &noon(n));
}

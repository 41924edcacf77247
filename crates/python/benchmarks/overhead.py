"""What Python adds to the time of a call: `python crates/python/benchmarks/overhead.py`, on an otherwise idle machine.

`tdoa.solve` of 6r/3s networks, and `family.track` of 1,000 targets of the five-point problem and of P3P, one thread each. Beside the time of the
call stands that of the work alone, measured inside: the call of the library from Rust.
"""

import pathlib
import time

import hc
import numpy as np
import tdoa

ROOT = pathlib.Path(__file__).resolve().parents[3]


def medians(call, count):
    """Medians over calls: of the whole time, of the work's, of the difference. Seconds."""
    rows = []
    for k in range(count):
        begun = time.perf_counter()
        found = call(k)
        whole = time.perf_counter() - begun
        rows.append((whole, found.seconds, whole - found.seconds))
    return np.median(rows, axis=0)


def main():
    print("| call | whole, ms | in Rust, ms | more, ms | more |")
    print("|---|---|---|---|---|")
    tables = [tdoa.simulate(6, 3, layout="normal", seed=k).pseudoranges for k in range(200)]
    tdoa.solve(tables[0], threads=1)
    report("tdoa.solve, 6r/3s", medians(lambda k: tdoa.solve(tables[k], threads=1), 200))
    folder = ROOT / "examples/families"
    rng = np.random.default_rng(1)
    five = hc.Family.read(folder / "five_point.toml", folder / "five_point.start.json")
    p3p = hc.Family.read(folder / "p3p.toml")
    p3p.monodromy()
    for name, family in (("five points", five), ("P3P", p3p)):
        targets = rng.normal(size=(1000, len(family.parameters)))
        solver = family.compile()
        solver(targets[:10], threads=1)
        report(f"family.track, 1,000 targets, {name}", medians(lambda _: solver(targets, threads=1), 5))


def report(name, seconds):
    whole, inside, more = seconds
    print(f"| {name} | {1e3 * whole:.2f} | {1e3 * inside:.2f} | {1e3 * more:.3f} | {more / inside:.2%} |", flush=True)


if __name__ == "__main__":
    main()

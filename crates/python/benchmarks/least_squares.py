"""tdoa.calibrate beside scipy.optimize.least_squares with random restarts, what one would write today.

    OPENBLAS_NUM_THREADS=1 python crates/python/benchmarks/least_squares.py [--networks 100] [--size 0]

The same networks for both, one thread each: positions and offsets standard normal as in the paper, noise 0.001, a share of gross errors
uniform in plus or minus 10. The peer minimises a robust loss with analytic Jacobian, first at the scale of 0.1, then at three times the
noise, which it is told (at the noise alone nearly no start arrives), from random starts: until two agree in the best cost and at least
half of --starts were made, at most --starts. Success: receivers within ten times the Cramer-Rao bound of the oracle that knows the gross
errors. Prints the table of docs/compare.md; times are medians of processor seconds.
"""

import argparse
import time

import numpy as np
import tdoa
from scipy.optimize import least_squares

NOISE = 1e-3
SIZES = [(6, 6), (6, 10), (10, 20)]
SHARES = [0.0, 0.05, 0.10]


def fit(table, rng, least, most):
    """The best of many starts: positions of receivers, transmitters, offsets."""
    m, n = table.shape
    i, j = np.nonzero(np.isfinite(table))
    f = table[i, j]
    rows = np.arange(len(f))

    def parts(x):
        return x[: 2 * m].reshape(m, 2), x[2 * m : 2 * (m + n)].reshape(n, 2), x[2 * (m + n) :]

    def residuals(x):
        r, s, o = parts(x)
        return np.hypot(*(r[i] - s[j]).T) + o[j] - f

    def jacobian(x):
        r, s, _ = parts(x)
        d = r[i] - s[j]
        u = d / np.maximum(np.hypot(*d.T), 1e-12)[:, None]
        full = np.zeros((len(f), len(x)))
        for k in range(2):
            full[rows, 2 * i + k] = u[:, k]
            full[rows, 2 * m + 2 * j + k] = -u[:, k]
        full[rows, 2 * (m + n) + j] = 1
        return full

    costs, best = [], None
    centre = np.nanmedian(table, axis=0)
    for start in range(most):
        x = np.concatenate([rng.normal(size=2 * (m + n)), centre - 1.5])
        for scale in (0.1, 3 * NOISE):
            found = least_squares(residuals, x, jac=jacobian, loss="soft_l1", f_scale=scale, max_nfev=100)
            x = found.x
        costs.append(found.cost)
        if best is None or found.cost < best.cost:
            best = found
        if start + 1 >= least and sum(cost <= min(costs) * (1 + 1e-4) for cost in costs) >= 2:
            break
    return parts(best.x)[0]


def distance(found, truth):
    """Root mean square distance of the receivers after the best rigid alignment, reflections allowed."""
    if not np.isfinite(found).all():
        return np.inf
    a, b = found - found.mean(axis=0), truth - truth.mean(axis=0)
    u, _, v = np.linalg.svd(a.T @ b)
    return np.sqrt(((a @ u @ v - b) ** 2).sum(axis=1).mean())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--networks", type=int, default=100)
    parser.add_argument("--starts", type=int, default=32, help="most starts of the peer")
    parser.add_argument("--size", type=int, choices=range(len(SIZES)), help="one of the sizes alone")
    arguments = parser.parse_args()
    most = arguments.starts
    count, sizes = arguments.networks, SIZES if arguments.size is None else [SIZES[arguments.size]]
    print("| network | gross errors | tdoa finds | s | tdoa calls unique | wrong of these | scipy finds | s | ratio |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for m, n in sizes:
        for share in SHARES:
            ours, theirs, unique, wrong, times = 0, 0, 0, 0, []
            for k in range(count):
                made = tdoa.simulate(m, n, layout="normal", noise=NOISE, outliers=share, seed=10_000 + k)
                bound = tdoa.cramer_rao(made.receivers, made.transmitters, NOISE, used=~made.outliers)
                begun = time.process_time()
                try:
                    found = tdoa.calibrate(made.pseudoranges, sigma=NOISE, threads=1, progress=False)
                    near, sure = distance(found.receivers, made.receivers) <= 10 * bound, found.unique
                except tdoa.UndeterminedError:
                    near, sure = False, False
                middle = time.process_time()
                peer = fit(made.pseudoranges, np.random.default_rng(k), (most + 1) // 2, most)
                end = time.process_time()
                times.append((middle - begun, end - middle))
                ours, unique, wrong = ours + near, unique + sure, wrong + (sure and not near)
                theirs += distance(peer, made.receivers) <= 10 * bound
            a, b = np.median(times, axis=0)
            row = f"| {m}r/{n}s | {share:.0%} | {ours} | {a:.3f} | {unique} | {wrong} | {theirs} | {b:.3f} | {b / a:.1f} |"
            print(row.replace("%", " %"), flush=True)


if __name__ == "__main__":
    main()

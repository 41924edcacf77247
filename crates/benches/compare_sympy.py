"""Runs the bench `evaluate` and SymPy's lambdify on the same systems and prints one table.

Needs sympy and numpy; run from anywhere inside the workspace. SymPy evaluates values and Jacobian by
`lambdify(..., cse=True)`: once a point with Python's complex numbers, and over arrays of 4096 points with NumPy.
"""

import os
import re
import subprocess
import time

import numpy
import sympy

JOBS = ["values", "jacobian", "taylor", "curved"]
MODES = ["interpreted_one", "interpreted_eight", "generated_one", "generated_eight"]
UNITS = {"ns": 1.0, "µs": 1e3, "ms": 1e6}
BENCH = ["cargo", "bench", "--quiet", "-p", "benches", "--bench", "evaluate"]


def systems():
    """Name, operation counts, unknowns, parameters and formulas of each system."""
    text = subprocess.run(BENCH, env=dict(os.environ, POLY_PRINT_SYSTEMS="1"), capture_output=True, text=True, check=True)
    for block in text.stdout.split("system\t")[1:]:
        head, unknowns, parameters, formulas = block.split("\n", 3)
        name, values, jacobian = head.split("\t")
        formulas = [f.strip() for f in formulas.split("end")[0].split(";") if f.strip()]
        yield name, int(values), int(jacobian), unknowns.split(), parameters.split(), formulas


def bench():
    """Median nanoseconds of an iteration by (system, mode, job)."""
    text = subprocess.run(BENCH + ["--", "--sample-count", "200"], capture_output=True, text=True, check=True).stdout
    path, times = [], {}
    for line in text.splitlines():
        match = re.match(r"^([│ ]*)[├╰]─ (\S+)\s*(.*)$", line)
        if not match:
            continue
        depth, name, rest = len(match[1]) // 3, match[2], match[3]
        path = path[:depth] + [name]
        columns = [c.strip() for c in rest.split("│")]
        if len(path) == 3 and len(columns) > 2 and columns[0]:
            value, unit = columns[2].split()
            times[tuple(path)] = float(value) * UNITS[unit]
    return times


def best(call, repeat, count):
    """Least nanoseconds of a call."""
    result = float("inf")
    for _ in range(repeat):
        start = time.perf_counter_ns()
        for _ in range(count):
            call()
        result = min(result, (time.perf_counter_ns() - start) / count)
    return result


def sympy_times(unknowns, parameters, formulas):
    """Nanoseconds a point for values and Jacobian: Python's complex numbers, NumPy arrays."""
    names = {n: sympy.Symbol(n) for n in unknowns + parameters}
    formulas = [sympy.sympify(f.replace("^", "**"), locals=names) for f in formulas]
    x = [names[n] for n in unknowns]
    jacobian = sympy.Matrix(formulas).jacobian(x)
    arguments = [names[n] for n in unknowns + parameters]
    outputs = formulas + list(jacobian)
    generator = numpy.random.default_rng(1)
    one = [complex(z) for z in numpy.exp(1j * generator.uniform(0, 6, len(arguments)))]
    many = [numpy.exp(1j * generator.uniform(0, 6, 4096)) for _ in arguments]
    scalar = sympy.lambdify(arguments, outputs, modules="math", cse=True)
    arrays = sympy.lambdify(arguments, outputs, modules="numpy", cse=True)
    return best(lambda: scalar(*one), 5, 200), best(lambda: arrays(*many), 5, 5) / 4096


def main():
    times = bench()
    print("| system | operations (values / with Jacobian) | | " + " | ".join(m.replace("_", ", ") for m in MODES) + " |")
    print("|---|---|---|" + "---|" * len(MODES))
    rows = list(systems())
    for name, values, jacobian, *_ in rows:
        for job in JOBS:
            cells = [times[name, mode, job] / (8 if mode.endswith("eight") else 1) for mode in MODES]
            counts = f"{values} / {jacobian}" if job == "values" else ""
            print(f"| {name if job == 'values' else ''} | {counts} | {job} | " + " | ".join(f"{c:.1f}" for c in cells) + " |")
    print()
    print("| system | " + " | ".join(
        ["eight lanes / one, interpreted (values, Jacobian)", "generated / interpreted, eight lanes (values, Jacobian)",
         "Jacobian / values (one, eight)", "Taylor-3 / values (one, eight)", "on a curve (one, eight)"]) + " |")
    print("|---|---|---|---|---|---|")
    for name, *_ in rows:
        t = {(mode, job): times[name, mode, job] / (8 if mode.endswith("eight") else 1) for mode in MODES for job in JOBS}
        one, eight, code = "interpreted_one", "interpreted_eight", "generated_eight"
        lanes = [t[one, j] / t[eight, j] for j in JOBS[:2]]
        generated = [t[eight, j] / t[code, j] for j in JOBS[:2]]
        slope = [t[m, "jacobian"] / t[m, "values"] for m in (one, eight)]
        taylor = [t[m, "taylor"] / t[m, "values"] for m in (one, eight)]
        curved = [t[m, "curved"] / t[m, "values"] for m in (one, eight)]
        cells = [" / ".join(f"{v:.1f}" for v in pair) for pair in (lanes, generated, slope, taylor, curved)]
        print(f"| {name} | " + " | ".join(cells) + " |")
    print()
    print("| system | | tape, one | sparse kernel, one | tape, eight | sparse kernel, eight |")
    print("|---|---|---|---|---|---|")
    for name, *_ in rows:
        for job in JOBS:
            if (name, "sparse_one", job) in times:
                modes = ["interpreted_one", "sparse_one", "interpreted_eight", "sparse_eight"]
                cells = [times[name, mode, job] / (8 if mode.endswith("eight") else 1) for mode in modes]
                print(f"| {name if job == 'values' else ''} | {job} | " + " | ".join(f"{c:.1f}" for c in cells) + " |")
    print()
    print("| system | SymPy, one point | SymPy on NumPy arrays | ours, interpreted, one | ours, interpreted, eight | ratio (one / one) | ratio (arrays / eight) |")
    print("|---|---|---|---|---|---|---|")
    for name, _, _, unknowns, parameters, formulas in rows:
        scalar, arrays = sympy_times(unknowns, parameters, formulas)
        one, eight = times[name, "interpreted_one", "jacobian"], times[name, "interpreted_eight", "jacobian"] / 8
        print(f"| {name} | {scalar:.0f} | {arrays:.0f} | {one:.0f} | {eight:.0f} | {scalar / one:.0f} | {arrays / eight:.0f} |")


if __name__ == "__main__":
    main()

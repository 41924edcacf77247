"""Threads, interrupts, processes, pickles."""

import json
import multiprocessing
import pickle
import threading
import time

import hc
import numpy as np
import pytest
import tdoa

# 3^12 paths: an hour's work and more.
LONG = [f"x{i}^3 - {i + 2}*x{(i + 1) % 12}^2*x{(i + 2) % 12} + 2*x{(i + 3) % 12} + {i + 1}" for i in range(12)]

INTERRUPT = """
import os, signal, threading, time
import hc, tdoa
import numpy as np
LONG = {long!r}
# Cyclic roots of 16: minutes of mixed cells.
CYCLIC = [" + ".join("*".join(f"x{{(j + k) % 16}}" for k in range(m)) for j in range(16)) for m in range(1, 16)]
CYCLIC.append("*".join(f"x{{k}}" for k in range(16)) + " - 1")
family = hc.Family(["x^3 + a*x + b", "y^3 - a*y*x + b"], "x y", "a b")
family.monodromy()
targets = np.random.default_rng(1).normal(size=(200_000, 2))
table = np.random.default_rng(2).normal(size=(40, 60)) * 10
sent = []
def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer({after}, interrupt).start()
try:
    {call}
except KeyboardInterrupt as stopped:
    late = time.monotonic() - sent[0]
    found = stopped.partial
    print(late)
    print(type(found).__name__)
    {show}
else:
    raise SystemExit("not interrupted")
# The same interpreter goes on.
assert len(hc.solve(["x^2 - 2"])) == 2
"""


@pytest.mark.parametrize(
    "call, kind, show",
    [
        ("hc.solve(LONG, start='total-degree', {how})", "Solutions", "assert found.partial and not found.complete and found.warnings"),
        ("hc.decompose(LONG, max_paths=10**9, {how})", "Decomposition", "assert found.partial and not found.complete"),
        ("hc.mixed_volume(CYCLIC, {how})", "int", "assert found >= 0"),
        ("family.track(targets, {how})", "Tracked", "assert 0 < len(found.points) < 200_000 and found.complete[:-256].all()"),
        (
            "tdoa.calibrate(table, dimensions=2, max_starts=10**9, agreeing=10**9, {how})",
            "Unfinished",
            "assert found.receivers.shape == (40, 2)",
        ),
        (
            "tdoa.calibrate(table, dimensions=3, max_starts=10**9, agreeing=10**9, {how})",
            "Unfinished",
            "assert found.receivers.shape == (40, 3) and found.transmitters.shape[1] == 3",
        ),
        ("tdoa.calibrate(table, max_starts=10**9, agreeing=10**9, {how})", "Unfinished", "assert found.receivers.shape[1] in (2, 3)"),
    ],
)
@pytest.mark.parametrize("threads", [None, 1])
def test_interrupts(call, kind, show, threads, script):
    call = call.format(how=f"threads={threads}")
    late, name = script(INTERRUPT.format(long=LONG, after=1.0, call=call, show=show)).split()[:2]
    assert name == kind
    # A tenth of a second is asked for; the machine may be busy.
    assert float(late) < 1.0


def test_other_threads_run_meanwhile():
    counted = []
    done = threading.Event()

    def count():
        while not done.is_set():
            counted.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    while time.monotonic() - begun < 0.3:
        tdoa.calibrate(tdoa.simulate(8, 12, noise=0.01).pseudoranges, progress=False)
    done.set()
    thread.join()
    # With the lock held there would be one between two calls.
    assert len(counted) > 30


def test_calls_from_many_threads():
    made = [tdoa.simulate(6, 3, seed=k).pseudoranges for k in range(8)]
    expected = [tdoa.solve(table).receivers.tobytes() for table in made]
    found = [None] * 8

    def solve(k):
        found[k] = tdoa.solve(made[k], threads=1 + k % 3).receivers.tobytes()

    threads = [threading.Thread(target=solve, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == expected


def results():
    family = hc.Family(["x^2 + y^2 - r^2", "y - a*x"], "x y", "r a", symmetry=[["-x", "-y"]], roots=2)
    fibre = family.monodromy()
    made = tdoa.simulate(8, 10, noise=0.01, seed=1)
    return {
        "calibration": tdoa.calibrate(made.pseudoranges),
        "networks": tdoa.solve(made.pseudoranges[:6, :3]),
        "simulation": made,
        "solutions": hc.solve(["x^2 - 2", "y - x"], certify=True),
        "decomposition": hc.decompose(["x*(y - 1)", "x*(x - 2)"]),
        "certificates": hc.certify(["x^2 - 2"], [[1.41421356]]),
        "fibre": fibre,
        "family": family,
        "compiled": family.compile(),
        "tracked": family.track([[5.0, 0.75]]),
        "pseudoranges": tdoa.Pseudoranges(made.pseudoranges, receiver_names=[f"m{k}" for k in range(8)]),
    }


def test_results_pickle():
    for name, result in results().items():
        again = pickle.loads(pickle.dumps(result))
        assert type(again) is type(result) and repr(again) == repr(result), name
    every = results()
    again = pickle.loads(pickle.dumps(every))
    assert again["calibration"] == every["calibration"]
    assert again["calibration"].to_svg() == every["calibration"].to_svg()
    assert again["compiled"]([[5.0, 0.75]]).points.tobytes() == every["tracked"].points.tobytes()
    assert again["solutions"].points.tobytes() == every["solutions"].points.tobytes()
    # Exceptions too: pools of processes send them.
    error = pickle.loads(pickle.dumps(hc.InputError("words")))
    assert isinstance(error, hc.InputError) and str(error) == "words"


def _calibrate(seed):
    return tdoa.calibrate(tdoa.simulate(8, 10, noise=0.01, seed=seed).pseudoranges, progress=False)


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    # The parent has threads of its own by now.
    expected = [_calibrate(seed) for seed in range(3)]
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map(_calibrate, range(3)) == expected


def test_progress_is_told():
    told = []
    table = tdoa.simulate(20, 40, noise=0.02, outliers=0.1, seed=3).pseudoranges
    tdoa.calibrate(table, progress=lambda *news: told.append(news), max_starts=400, agreeing=400)
    assert told and all(isinstance(words, str) and done <= total for words, done, total in told)

    def fail(*_):
        raise RuntimeError("of the callback")

    with pytest.raises(RuntimeError, match="of the callback"):
        tdoa.calibrate(table, progress=fail, max_starts=10**9, agreeing=10**9)


def test_scripts_are_quiet(script):
    code = "import tdoa\ntdoa.calibrate(tdoa.simulate(20, 40, noise=.1, seed=3).pseudoranges, max_starts=300, agreeing=300)\n"
    import subprocess
    import sys

    output = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert (output.returncode, output.stdout, output.stderr) == (0, "", "")


def test_json_goes_round():
    calibration = _calibrate(5)
    again = tdoa.Calibration.from_json(calibration.to_json())
    assert again == calibration and json.loads(again.to_json())["seed"] == 0
    assert np.array_equal(again.receivers, calibration.receivers)

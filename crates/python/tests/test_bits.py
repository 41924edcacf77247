"""Values are those of the programs to the last bit: ten networks, ten systems, families."""

import json
import struct

import hc
import numpy as np
import pytest
import tdoa
from conftest import ROOT

# Ten networks of different sizes, with noise, outliers and gaps; the last ones with few measurements.
NETWORKS = [
    (8, 12, dict(noise=0.01)),
    (6, 20, dict(noise=0.02, outliers=0.05)),
    (10, 15, dict(noise=0.005, missing=0.1)),
    (12, 30, dict(noise=0.05, outliers=0.1, missing=0.1)),
    (7, 9, dict(noise=0.001)),
    (5, 40, dict(noise=0.01)),
    (9, 10, dict(noise=0.01, layout="grid")),
    (20, 25, dict(noise=0.02, outliers=0.03)),
    (8, 8, dict()),
    (6, 6, dict(noise=0.01)),
]

SYSTEMS = "boon caprasse eco8 heart lorentz noon5 rose sendra sparse5 trinks".split()


def bits(value):
    """Doubles as their bytes, so that zeros of both signs differ."""
    if isinstance(value, float):
        return struct.pack("<d", value)
    if isinstance(value, dict):
        return {key: bits(each) for key, each in value.items()}
    if isinstance(value, list):
        return [bits(each) for each in value]
    return value


def written(folder, table, name="table.csv"):
    path = folder / name
    rows = [",".join("" if np.isnan(f) else repr(float(f)) for f in row) for row in table]
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize("k", range(10))
def test_networks(k, run_json, tmp_path):
    m, n, options = NETWORKS[k]
    made = tdoa.simulate(m, n, seed=k, **options)
    path = written(tmp_path, made.pseudoranges)
    expected = run_json("tdoa", "calibrate", path, "--seed", k, "--threads", 1)
    found = tdoa.calibrate(made.pseudoranges, seed=k)
    assert bits(json.loads(found.to_json())) == bits(expected)
    assert bits(found.offsets[~np.isnan(found.offsets)].tolist()) == bits([o for o in expected["offsets"] if o is not None])
    # What is read from the file is what was made.
    assert tdoa.read(path).values.tobytes() == made.pseudoranges.tobytes()
    assert tdoa.calibrate(tdoa.read(path), seed=k, threads=1) == found


def test_times_become_metres_as_in_the_program(run_json, tmp_path):
    made = tdoa.simulate(8, 10, noise=0.01, seed=77)
    times = made.pseudoranges / 343.0
    path = written(tmp_path, times)
    expected = run_json("tdoa", "calibrate", path, "--units", "s", "--speed", "343", "--sigma", "0.01")
    assert bits(json.loads(tdoa.calibrate(times, speed=343, sigma=0.01).to_json())) == bits(expected)


def test_anchors_as_in_the_program(run_json, tmp_path):
    made = tdoa.simulate(8, 10, noise=0.01, seed=78)
    rows = ["name,x,y"] + [f"r{i + 1},{x!r},{y!r}" for i, (x, y) in enumerate(made.receivers[:3].tolist())]
    (tmp_path / "anchors.csv").write_text("\n".join(rows) + "\n")
    path = written(tmp_path, made.pseudoranges)
    expected = run_json("tdoa", "calibrate", path, "--anchors", tmp_path / "anchors.csv")
    anchors = {f"r{i + 1}": made.receivers[i] for i in range(3)}
    assert bits(json.loads(tdoa.calibrate(made.pseudoranges, anchors=anchors).to_json())) == bits(expected)
    rows = np.full((8, 2), np.nan)
    rows[:3] = made.receivers[:3]
    assert bits(json.loads(tdoa.calibrate(made.pseudoranges, anchors=rows).to_json())) == bits(expected)


@pytest.mark.parametrize("m, n", [(6, 3), (5, 4), (4, 5), (7, 4), (6, 6)])
def test_exact_networks(m, n, run_json, tmp_path):
    made = tdoa.simulate(m, n, layout="normal", seed=m + n)
    expected = run_json("tdoa", "solve", written(tmp_path, made.pseudoranges))
    # Twice: a solver that has been used gives the same.
    for _ in range(2):
        found = tdoa.solve(made.pseudoranges)
        assert len(found) == len(expected["solutions"]) and found.counts == expected["counts"]
        assert found.paths == expected["paths"] and found.solver == expected["solver"]
        for k, each in enumerate(expected["solutions"]):
            for name in ("receivers", "transmitters", "offsets"):
                assert bits(getattr(found, name)[k].tolist()) == bits(each[name])
            assert bits(float(found.residuals[k])) == bits(each["residual"])
            assert bool(found.physical[k]) == each["physical"]
            assert bits(float(found.conditions[k])) == bits(each["condition"])


@pytest.mark.parametrize("d, m, n", [(2, 3, 4), (2, 4, 3), (3, 5, 5), (3, 4, 7), (3, 7, 4)])
def test_exact_networks_of_ranges_with_a_constant(d, m, n, run_json, tmp_path):
    ranges = tdoa.simulate(m, n, dimensions=d, layout="normal", ranges=True, seed=m + n).pseudoranges + 2.5
    expected = run_json("tdoa", "solve", written(tmp_path, ranges), "--emissions", "constant", "--dimensions", d)
    found = tdoa.solve(ranges, dimensions=d, emissions="constant")
    assert expected["emissions"] == "constant" and found.solver == expected["solver"] == f"{m}r/{n}s"
    assert found.counts == expected["counts"] and len(found) == len(expected["solutions"]) > 0
    for k, each in enumerate(expected["solutions"]):
        for name in ("receivers", "transmitters", "offsets"):
            assert bits(getattr(found, name)[k].tolist()) == bits(each[name])
    assert (abs(found.offsets[found.physical] - 2.5).max(axis=1) < 1e-9).any()


@pytest.mark.parametrize("d, m, n", [(2, 3, 3), (3, 4, 6), (3, 6, 4), (3, 5, 5)])
def test_exact_networks_of_ranges(d, m, n, run_json, tmp_path):
    made = tdoa.simulate(m, n, dimensions=d, layout="normal", ranges=True, seed=m + n)
    expected = run_json("tdoa", "solve", written(tmp_path, made.pseudoranges), "--ranges", "--dimensions", d)
    found = tdoa.solve(made.pseudoranges, dimensions=d, ranges=True)
    assert expected["emissions"] == "known" and found.solver == expected["solver"] == f"{m}r/{n}s"
    assert found.counts == expected["counts"] and len(found) == len(expected["solutions"]) > 0
    for k, each in enumerate(expected["solutions"]):
        for name in ("receivers", "transmitters", "offsets"):
            assert bits(getattr(found, name)[k].tolist()) == bits(each[name])
    assert not found.offsets.any() and found.physical.all()


@pytest.mark.parametrize("name", ["sendra", "trinks"])
def test_decompositions(name, run_json):
    path = ROOT / "examples/systems" / f"{name}.phc"
    expected = run_json("hc", "decompose", path, "--seed", 3, "--threads", 1)
    expected.pop("seconds")
    assert bits(json.loads(hc.decompose(path.read_text(), seed=3).to_json())) == bits(expected)


@pytest.mark.parametrize("name", SYSTEMS)
def test_systems(name, run_json):
    path = ROOT / "examples/systems" / f"{name}.phc"
    expected = run_json("hc", "solve", path, "--seed", 3, "--threads", 1)
    expected.pop("seconds")
    found = hc.solve(path.read_text(), seed=3)
    assert bits(json.loads(found.to_json())) == bits(expected)
    assert found.points.shape == (len(expected["solutions"]), len(expected["variables"]))


def test_families(run_json, tmp_path):
    folder = ROOT / "examples/families"
    family = hc.Family.read(folder / "five_point.toml", folder / "five_point.start.json")
    rng = np.random.default_rng(5)
    targets = rng.normal(size=(20, len(family.parameters)))
    (tmp_path / "targets.json").write_text(json.dumps([{"parameters": row} for row in targets.tolist()]))
    arguments = ["track", folder / "five_point.toml", "--start", folder / "five_point.start.json"]
    expected = run_json("hc", *arguments, "--target", tmp_path / "targets.json")
    tracked = family.track(targets)
    assert tracked.points.shape == (20, len(family.fibre), len(family.unknowns))
    for k, each in enumerate(expected):
        found = tracked.points[k][tracked.ends[k] <= hc.End.SINGULAR]
        pairs = np.stack([found.real, found.imag], axis=-1).tolist()
        copies = [s["value"] for s in each["solutions"] for _ in range(s["multiplicity"] if s["singular"] else 1)]
        assert bits(pairs) == bits(copies)
        assert each["paths"]["failed"] == 0 and bool(tracked.complete[k])


def test_monodromy(programs, tmp_path):
    import subprocess

    path = ROOT / "examples/families/p3p.toml"
    out = tmp_path / "start.json"
    subprocess.run([programs["hc"], "monodromy", path, "--seed", "4", "--output", out], check=True, capture_output=True)
    found = hc.Family.read(path).monodromy(seed=4)
    assert found.to_json() == out.read_text()
    # P3P: Fischler and Bolles 1981, eight solutions in pairs of opposite signs.
    assert len(found) == 8 and found.complete


def test_mixed_volumes_and_certificates(run_json, tmp_path):
    path = ROOT / "examples/systems/cyclic7.phc"
    # Backelin and Froeberg 1991: 924 solutions, as many as the mixed volume.
    assert hc.mixed_volume(path.read_text()) == 924 == run_json("hc", "mixed-volume", path)["mixed_volume"]
    path = ROOT / "examples/systems/eco8.phc"
    found = hc.solve(path.read_text())
    (tmp_path / "solutions.json").write_text(found.to_json())
    expected = run_json("hc", "certify", path, tmp_path / "solutions.json")
    proved = hc.certify(path.read_text(), found)
    assert proved.complete and proved.n_distinct == expected["n_distinct"] == 64 and proved.n_real == expected["n_real"]
    for k, each in enumerate(expected["solutions"]):
        assert bits(proved.boxes[k].tolist()) == bits(each["box"])

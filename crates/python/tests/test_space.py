"""Calibration in the plane and in space."""

import json

import hc
import numpy as np
import pytest
import tdoa


def error(found, truth):
    """Largest distance after the best rotation, reflection and translation."""
    a, b = found - found.mean(axis=0), truth - truth.mean(axis=0)
    u, _, v = np.linalg.svd(a.T @ b)
    return np.linalg.norm(a @ u @ v - b, axis=1).max()


def room(**options):
    return tdoa.simulate(12, 30, dimensions=3, size=(10, 8, 4), noise=0.005, seed=3, **options)


@pytest.mark.parametrize("dimensions", ["auto", 3])
def test_a_room(dimensions, tmp_path):
    made = room(outliers=0.03)
    found = tdoa.calibrate(made.pseudoranges, dimensions=dimensions)
    assert found.dimensions == 3 and found.trusted and found.unique
    assert found.receivers.shape == (12, 3) and found.transmitters.shape == (30, 3) and found.offsets.shape == (30,)
    assert found.covariance.shape == (12, 3, 3) and found.transmitter_covariance.shape == (30, 3, 3)
    assert found.systematic["factor"] >= 1.0 and found.systematic_transmitter_covariance.shape == (30, 3, 3)
    added = found.systematic_covariance - found.covariance
    assert added.shape == (12, 3, 3) and (np.trace(added, axis1=1, axis2=2) >= 0.0).all()
    assert found.inliers.shape == found.residuals.shape == (12, 30)
    assert error(found.receivers, made.receivers) < 0.05
    test = found.dimension_test
    assert (test is None) if dimensions == 3 else (test["gain"] > test["needed"] > 0)
    assert all(other.receivers.shape == (12, 3) for other in found.alternatives)
    # All that shows it.
    assert found.to_svg().count("class=\"receiver\"") > 24
    found.save_html(tmp_path / "room.html")
    assert "r12" in (tmp_path / "room.html").read_text()
    assert repr(found).startswith("12r/30s") and "<svg" in found._repr_html_()
    assert tdoa.Calibration.from_json(found.to_json()) == found
    for axes in ("xy", "xz", "yz"):
        ax = pytest.importorskip("matplotlib.pyplot").subplots()[1]
        found.plot(ax, view=axes)
        assert (ax.get_xlabel(), ax.get_ylabel()) == (f"{axes[0]}, m", f"{axes[1]}, m")
    with pytest.raises(hc.InputError, match="view must be xy or xz or yz or 3d"):
        found.plot(view="zz")
    ax = found.plot(view="3d")
    assert ax.name == "3d" and ax.get_zlabel() == "z, m" and len(ax.collections) == 42, "an ellipsoid a node"
    receivers = next(line for line in ax.lines if line.get_marker() == "^")
    assert np.allclose(np.array(receivers.get_data_3d()).T, found.receivers)
    with pytest.raises(hc.InputError, match='not of projection "3d"'):
        found.plot(ax)


def test_comparison_with_the_truth():
    made = room()
    found = tdoa.calibrate(made.pseudoranges, dimensions=3)
    assert found.truth is None
    beside = found.compared(made.receivers, made.transmitters)
    # In the frame of the truth, nodes are where they are, but for errors of some millimetres.
    off = np.linalg.norm(beside.receivers - made.receivers, axis=1)
    assert off.max() < 0.1 and np.sqrt((off**2).mean()) == pytest.approx(beside.truth["receiver_rms"], rel=1e-6)
    assert beside.truth["receivers"] == 12 and 0 < beside.truth["transmitter_median"] < 0.1
    assert np.allclose(np.trace(beside.covariance, axis1=1, axis2=2), np.trace(found.covariance, axis1=1, axis2=2))
    assert np.array_equal(beside.residuals, found.residuals) and beside.data["format"] == found.data["format"]
    by_name = found.compared(dict(zip(found.receiver_names[:5], made.receivers)))
    assert by_name.truth["receivers"] == 5 and "transmitter_median" not in by_name.truth
    partly = np.where(np.arange(12)[:, None] < 5, made.receivers, np.nan)
    assert found.compared(partly) == by_name
    # Anchors have given a frame already.
    held = tdoa.calibrate(made.pseudoranges, dimensions=3, anchors=made.receivers + 7.0)
    assert np.array_equal(held.compared(made.receivers).receivers, held.receivers)
    for wrong in (made.receivers[:3], made.receivers[:, :2], {"r1": 3.0}, {"nobody": (0, 0, 0)}, "abc", partly * np.nan):
        with pytest.raises(hc.InputError):
            found.compared(wrong)


def test_planar_networks_stay_planar():
    made = tdoa.simulate(8, 14, noise=0.01, seed=6)
    flat = tdoa.calibrate(made.pseudoranges, dimensions=2)
    auto = tdoa.calibrate(made.pseudoranges)
    assert auto.dimensions == flat.dimensions == 2 and flat.dimension_test is None
    test = auto.dimension_test
    assert test["gain"] < test["needed"] and test["evidence"] < 0 and list(test) == ["gain", "needed", "evidence", "change"]
    data = json.loads(auto.to_json())
    assert data.pop("dimension_test") == test and data == json.loads(flat.to_json())
    with pytest.raises(hc.InputError, match="view must be xy of"):
        flat.plot(view="xz")


def test_anchors_in_space():
    made = room()
    anchors = np.full((12, 3), np.nan)
    anchors[[0, 3, 5, 8]] = made.receivers[[0, 3, 5, 8]]
    found = tdoa.calibrate(made.pseudoranges, anchors=anchors)
    assert found.dimensions == 3 and found.dimension_test is None and found.trusted
    assert found.data["anchored"] == [k in (0, 3, 5, 8) for k in range(12)]
    assert np.linalg.norm(found.receivers - made.receivers, axis=1).max() < 0.05
    by_name = {f"r{k + 1}": made.receivers[k] for k in (0, 3, 5, 8)}
    assert tdoa.calibrate(made.pseudoranges, anchors=by_name, dimensions=3) == found
    # A height that is not known, beside those that are; and measured positions.
    by_name["r10"] = made.receivers[9, :2]
    mixed = tdoa.calibrate(made.pseudoranges, anchors=by_name, anchor_sigma={"r4": 0.02})
    assert mixed.dimensions == 3 and mixed.data["anchored"] == [k in (0, 5, 8) for k in range(12)]
    assert np.linalg.norm(mixed.receivers - made.receivers, axis=1).max() < 0.05


def test_known_places_of_transmitters():
    made = room()
    # Two loudspeakers and one microphone that was measured: the frame is that of the room.
    anchors = {"s3": made.transmitters[2], "s9": made.transmitters[8], "r1": made.receivers[0], "s12": made.transmitters[11]}
    found = tdoa.calibrate(made.pseudoranges, anchors=anchors, anchor_sigma={"s12": 0.02})
    assert found.trusted and found.data["anchored"] == [k == 0 for k in range(12)]
    assert np.linalg.norm(found.receivers - made.receivers, axis=1).max() < 0.05
    assert np.linalg.norm(found.transmitters[[2, 8]] - made.transmitters[[2, 8]], axis=1).max() < 1e-4
    assert tdoa.calibrate(made.pseudoranges, anchors=anchors, anchor_sigma={"s12": 0.02, "s3": 0}) == found


def test_anchors_of_one_height_do_not_choose_the_plane():
    made = tdoa.simulate(8, 14, noise=0.01, seed=6)
    anchors = np.full((8, 2), np.nan)
    anchors[[0, 2, 5]] = made.receivers[[0, 2, 5]]
    flat = tdoa.calibrate(made.pseudoranges, anchors=anchors)
    assert flat.dimensions == 2 and flat.dimension_test is not None
    heights = np.column_stack([anchors, np.where(np.isnan(anchors[:, 0]), np.nan, 0.0)])
    assert tdoa.calibrate(made.pseudoranges, anchors=heights) == flat
    # One height for all is left out; so are small differences, where the plane is asked for.
    assert tdoa.calibrate(made.pseudoranges, anchors=heights + [0, 0, 1.5]) == flat
    heights[2, 2] = 0.1
    asked = tdoa.calibrate(made.pseudoranges, anchors=heights, dimensions=2)
    assert asked.dimension_test is None and np.array_equal(asked.receivers, flat.receivers)


def test_three_anchors_at_one_height_of_a_room():
    made = room()
    anchors = {f"r{k + 1}": made.receivers[k] for k in (0, 3, 5)}
    level = np.mean([z for _, _, z in anchors.values()])
    assert tdoa.calibrate(made.pseudoranges, anchors={name: (x, y, level) for name, (x, y, _) in anchors.items()}).dimensions == 3
    # Without heights they cannot be held in space.
    flat = tdoa.calibrate(made.pseudoranges, anchors={name: (x, y) for name, (x, y, _) in anchors.items()})
    assert flat.dimensions == 2 and not flat.unique and any("ask for space" in warning for warning in flat.warnings)


def test_the_program_finds_the_same(run_json, tmp_path):
    made = room()
    path = tmp_path / "room.csv"
    path.write_text("\n".join(",".join(map(repr, row)) for row in made.pseudoranges.tolist()) + "\n")
    expected = run_json("tdoa", "calibrate", path)
    assert json.loads(tdoa.calibrate(made.pseudoranges).to_json()) == expected and expected["dimensions"] == 3


def test_json_of_other_dimensions_is_refused():
    text = tdoa.calibrate(tdoa.simulate(8, 10, noise=0.01, seed=1).pseudoranges, dimensions=2).to_json()
    with pytest.raises(hc.InputError, match="its dimensions are 4, not 2 or 3"):
        tdoa.Calibration.from_json(text.replace('"dimensions": 2', '"dimensions": 4'))


def test_exact_solutions():
    made = tdoa.simulate(10, 6, dimensions=3, seed=2)
    found = tdoa.solve(made.pseudoranges, dimensions=3)
    assert len(found) == 1 and found.dimensions == 3 and found.physical[0] and not found.warnings
    assert found.receivers.shape == (1, 10, 3) and found.transmitters.shape == (1, 6, 3) and found.offsets.shape == (1, 6)
    assert error(found.receivers[0], made.receivers) < 1e-9 and np.abs(found.offsets[0] - made.offsets).max() < 1e-9
    # By paths.
    made = tdoa.simulate(8, 5, dimensions=3, seed=2)
    found = tdoa.solve(made.pseudoranges, dimensions=3, prove=True, progress=False)
    assert len(found) == 1 and found.physical[0] and not found.warnings
    assert error(found.receivers[0], made.receivers) < 1e-8
    assert found.proofs == {"roots": 256, "proved": 256, "real": found.counts["real"], "unseparated": 0}
    assert tdoa.solve(made.pseudoranges, dimensions=3).proofs is None

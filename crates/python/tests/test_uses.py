"""What people bring: SymPy, pandas, matplotlib, PHCpack; values known from elsewhere."""

import io

import hc
import numpy as np
import pytest
import tdoa


def test_sympy():
    sympy = pytest.importorskip("sympy")
    x, y = sympy.symbols("x y")
    found = hc.solve([x**2 + y**2 - 5, sympy.Eq(x * y, 2)])
    assert found.variables == ["x", "y"] and found.n_real == 4
    same = hc.solve(["x^2 + y^2 - 5", "x*y - 2"], variables="x y")
    assert np.allclose(sorted(map(tuple, found.real_points)), sorted(map(tuple, same.real_points)), atol=1e-12)
    # Names with numbers in their order, and the order that is asked for.
    many = sympy.symbols("x1:12")
    system = [v - k for k, v in enumerate(many)]
    assert hc.solve(system).variables == [f"x{k}" for k in range(1, 12)]
    assert hc.solve([y - 1, x - 2], variables=[y, x]).points.tolist() == [[1, 2]]
    # Texts of every format take an order too.
    for text in ("2\nx - 2;\ny - 1;\n", "x = 2\ny = 1", "x - 2; y - 1;", ["x - 2", "y - 1"]):
        assert hc.solve(text, variables="y x").points.tolist() == [[1, 2]]
        with pytest.raises(hc.InputError, match="`x` is neither an unknown"):
            hc.solve(text, variables="y z")
    # Numbers of all kinds: the solution of x = c is c.
    for number in (
        sympy.Rational(1, 3),
        sympy.Float(0.1),
        sympy.Float(-2.5e-7),
        sympy.pi,
        sympy.sqrt(2),
        1 / sympy.sqrt(3),
        2 + 3 * sympy.I,
        sympy.exp(1),
        sympy.cos(1),
        sympy.sqrt(-2),
    ):
        [[value]] = hc.solve([x - number]).points
        assert value == pytest.approx(complex(number), rel=1e-15, abs=0)
    # A double is read back to the last bit.
    assert hc.solve([x - sympy.Float(0.1)]).points[0, 0].real == 0.1
    # By areas: the sum of the two triangles has 4, each of them 1/2.
    assert hc.mixed_volume([x**2 * y + x + 1, x * y**2 + y + 2]) == 3
    assert len(hc.solve(sympy.Matrix([x**2 - 1, y - x]))) == len(hc.solve([sympy.Poly(x**2 - 1, x), y - x])) == 2
    for formula in (sympy.sin(x), x**y, sympy.sqrt(x)):
        with pytest.raises(hc.InputError, match="is no polynomial"):
            hc.solve([formula])
    a, b = sympy.symbols("a b")
    family = hc.Family([x**2 + a * x + b], parameters=[a, b], nonzero=[b])
    family.monodromy()
    tracked = family.track([[-3.0, 2.0], [0.0, -4.0]])
    assert np.sort(tracked.points[:, :, 0].real, axis=1).round(12).tolist() == [[1, 2], [-2, 2]]
    assert (tracked.ends == hc.End.FINITE).all()


def test_solutions_up_to_symmetry():
    # x^4 = p has four roots, which multiplication by i permutes; two of them are real for p = 16.
    family = hc.Family(["x^4 - p"], "x", "p", symmetry=[["i*x"]])
    fibre = family.monodromy(up_to_symmetry=True)
    assert (len(fibre), fibre.represents, fibre.roots) == (1, [4], 4)
    assert str(fibre).startswith("4 solutions (1 up to symmetry); stopped: ")
    assert len(family.track([[16.0], [0.0]])[0]) == 4
    tracked = family.track([[16.0], [0.0]], up_to_symmetry=True)
    assert tracked.ends.tolist() == [[hc.End.FINITE] + [hc.End.IMAGE] * 3, [hc.End.SINGULAR] * 4]
    assert tracked.n_real[0] == 1 and abs(tracked.real_points[0]).round(12).tolist() == [[2.0]]
    assert tracked.complete.all() and len(tracked[0]) == 1
    with pytest.raises(hc.InputError, match="exclude each other"):
        family.monodromy(group=2, up_to_symmetry=True)
    other = hc.Family(["x^4 - p"], "x", "p")
    for ask in (other.monodromy, lambda **more: other.track([[16.0]], **more)):
        with pytest.raises(hc.InputError, match="states no symmetry"):
            ask(up_to_symmetry=True)


def test_pandas():
    pandas = pytest.importorskip("pandas")
    made = tdoa.simulate(8, 10, noise=0.01, seed=1)
    rooms = [f"mic {k}" for k in range(8)]
    frame = pandas.DataFrame(made.pseudoranges, index=rooms)
    found = tdoa.calibrate(frame)
    assert found.receiver_names == rooms and found.transmitter_names[0] == "s1"
    assert np.array_equal(found.receivers, tdoa.calibrate(made.pseudoranges).receivers)
    frame = frame.astype("Float64")
    frame.iloc[1, 2] = pandas.NA
    gap = made.pseudoranges.copy()
    gap[1, 2] = np.nan
    assert np.array_equal(tdoa.calibrate(frame).receivers, tdoa.calibrate(gap).receivers)
    assert tdoa.calibrate(frame, anchors={"mic 0": (1, 2), "mic 5": (4, 3)}).data["anchored"][5] in (True, False)
    with pytest.raises(hc.InputError, match="numbers"):
        tdoa.calibrate(pandas.DataFrame({"a": ["x"]}))


def test_long_frames(tmp_path):
    pandas = pytest.importorskip("pandas")
    made = tdoa.simulate(8, 10, noise=0.01, missing=0.1, seed=1)
    wide = pandas.DataFrame(made.pseudoranges, index=[f"mic {k}" for k in range(8)], columns=[f"clap, {k}" for k in range(10)])
    heard = [(i, j) for i in wide.index for j in wide.columns if np.isfinite(wide.at[i, j])]
    long = pandas.DataFrame([(i, j, wide.at[i, j]) for i, j in heard], columns=["mic", "event", "value"])
    path = tmp_path / "long.csv"
    long.to_csv(path, index=False)
    expected = tdoa.calibrate(tdoa.read(path))
    assert tdoa.calibrate(long) == expected
    assert sorted(expected.receiver_names) == sorted(wide.index) and expected.transmitter_names[0] == "clap, 0"
    # Columns in any order, and as levels of the index.
    assert tdoa.calibrate(long[["event", "value", "mic"]]) == expected
    assert tdoa.calibrate(long.set_index(["mic", "event"])) == expected
    # Times, and standard deviations of their own.
    seconds = long.rename(columns={"value": "arrival time (s)"}).assign(**{"arrival time (s)": long["value"] / 343})
    seconds.to_csv(path, index=False)
    assert tdoa.calibrate(seconds, speed=343) == tdoa.calibrate(long.assign(value=long["value"] / 343), speed=343)
    of_file = tdoa.calibrate(tdoa.read(path, units="s", speed=343))
    assert np.array_equal(tdoa.calibrate(seconds, speed=343).receivers, of_file.receivers)
    with pytest.raises(hc.InputError, match="give speed=V and the times in seconds"):
        tdoa.calibrate(seconds)
    milliseconds = long.rename(columns={"value": "time_ms"})
    with pytest.raises(hc.InputError, match="is in ms.*; give speed=V and the times in seconds"):
        tdoa.calibrate(milliseconds, speed=343)
    sure = tdoa.calibrate(long.assign(sigma=0.01))
    assert sure.data["sigma_is_factor"]
    # Weights, whatever their unit, are deviations but for a factor.
    weighed = tdoa.calibrate(long.assign(weight=7.0))
    assert weighed.data["sigma_is_factor"] and weighed.data["sigma_estimated"]
    table = tdoa.Pseudoranges(made.pseudoranges, weights=np.full(np.shape(made.pseudoranges), 3.0))
    assert "at the median weight" in repr(tdoa.calibrate(table))
    with pytest.raises(tdoa.InputError, match="say twice"):
        tdoa.Pseudoranges([[1.0, 2.0]], weights=[[1.0, 1.0]], sigmas=[[1.0, 1.0]])
    for bad, words in [
        (long[["mic", "value"]], "no column is the transmitter"),
        (pandas.concat([long, long[:1]]), "twice|again|second"),
        (long.assign(value="loud"), "loud"),
    ]:
        with pytest.raises(hc.InputError, match=words):
            tdoa.calibrate(bad)


def test_candidates():
    made = tdoa.simulate(10, 20, noise=0.001, seed=3)
    right = made.pseudoranges
    # Of every third cell the first candidate is late and the second right.
    wrong = np.arange(200).reshape(10, 20) % 3 == 0
    late = right + 0.5 + np.arange(200).reshape(10, 20) % 7
    first, second = np.where(wrong, late, right), np.where(wrong, right, np.nan)
    table = tdoa.Pseudoranges(first, candidates=second[:, :, None])
    found = tdoa.calibrate(table, dimensions=2)
    expected = tdoa.calibrate(right, dimensions=2)
    assert np.allclose(found.receivers, expected.receivers, atol=1e-6)
    assert [(each["receiver"], each["transmitter"], each["candidate"]) for each in found.data["chosen"]] == [
        (f"r{i + 1}", f"s{j + 1}", 2) for i, j in np.argwhere(wrong)
    ]
    text = "mic,event,value\na,e,1\na,e,2\nb,e,3\n"
    with pytest.raises(tdoa.InputError, match="twice"):
        tdoa.read(io.StringIO(text))
    read = tdoa.read(io.StringIO(text), candidates=True)
    assert read.values.tolist() == [[1.0], [3.0]]
    assert np.array_equal(read.candidates, [[[2.0]], [[np.nan]]], equal_nan=True)
    assert tdoa.read(io.StringIO("mic,event,value\na,e,1\n")).candidates is None
    with pytest.raises(tdoa.InputError, match="candidates must have the shape"):
        tdoa.Pseudoranges(right, candidates=right)


def test_open_files(tmp_path):
    made = tdoa.simulate(6, 8, noise=0.01, seed=4)
    text = "\n".join(",".join(map(repr, row)) for row in made.pseudoranges.tolist()) + "\n"
    (tmp_path / "table.csv").write_text(text)
    np.save(tmp_path / "table.npy", made.pseudoranges)
    expected = tdoa.read(tmp_path / "table.csv")
    assert np.array_equal(expected.values, made.pseudoranges)
    for mode in ("r", "rb"):
        with open(tmp_path / "table.csv", mode) as file:
            assert tdoa.read(file) == expected
    with open(tmp_path / "table.npy", "rb") as file:
        assert tdoa.read(file) == expected
    assert tdoa.read(io.StringIO(text)) == tdoa.read(io.BytesIO(text.encode())) == expected
    assert tdoa.read(io.StringIO(text), units="s", speed=2.0).values[0, 0] == 2.0 * made.pseudoranges[0, 0]
    for file, words in [
        (io.StringIO("1,x\n"), "open file, line 1"),
        (io.BytesIO(b"\xff\xff"), "is no text"),
        (io.StringIO(), "open file"),
    ]:
        with pytest.raises(hc.InputError, match=words):
            tdoa.read(file)


def test_names():
    made = tdoa.simulate(6, 8, noise=0.01, seed=4)
    receivers, transmitters = [f"m{k}" for k in range(6)], [f"clap{k}" for k in range(8)]
    for names in ((receivers, transmitters), dict(receivers=receivers, transmitters=transmitters)):
        found = tdoa.calibrate(made.pseudoranges, names=names)
        assert (found.receiver_names, found.transmitter_names) == (receivers, transmitters)
    assert tdoa.calibrate(made.pseudoranges, names=receivers).receiver_names == receivers


def test_a_calibration_is_near_the_truth():
    """Three times the Cramer-Rao bound, the measure of success of the experiments."""
    made = tdoa.simulate(10, 20, noise=0.01, outliers=0.05, missing=0.05, seed=9)
    found = tdoa.calibrate(made.pseudoranges)
    assert found.unique and found.trusted and found.dimensions == 2
    known = ~made.outliers & np.isfinite(made.pseudoranges)
    bound = tdoa.cramer_rao(made.receivers, made.transmitters, 0.01, used=known)
    a = found.receivers - found.receivers.mean(axis=0)
    b = made.receivers - made.receivers.mean(axis=0)
    u, _, v = np.linalg.svd(a.T @ b)
    assert np.sqrt(((a @ u @ v - b) ** 2).sum(axis=1).mean()) < 3 * bound
    assert found.covariance.shape == (10, 2, 2) and found.inliers.shape == (10, 20)
    # Half a metre and more is an outlier beyond doubt.
    size = np.abs(made.pseudoranges - np.linalg.norm(made.receivers[:, None] - made.transmitters, axis=2) - made.offsets)
    assert not found.inliers[made.outliers & (size > 0.5)].any()
    model = np.linalg.norm(found.receivers[:, None] - found.transmitters, axis=2) + found.offsets
    residuals = made.pseudoranges - model
    assert np.allclose(residuals, found.residuals, atol=1e-9, equal_nan=True)


def test_masked_arrays_are_gaps():
    made = tdoa.simulate(8, 12, noise=0.01, seed=2)
    hidden = np.zeros((8, 12), bool)
    hidden[2, 5] = hidden[6, 0] = True
    gaps = np.where(hidden, np.nan, made.pseudoranges)
    masked = np.ma.array(np.where(hidden, 0.0, made.pseudoranges), mask=hidden)
    assert tdoa.calibrate(masked).to_json() == tdoa.calibrate(gaps).to_json()
    assert np.array_equal(tdoa.Pseudoranges(masked).values, gaps, equal_nan=True)


def test_summaries_are_those_of_the_program(programs, tmp_path):
    import subprocess

    made = tdoa.simulate(8, 12, noise=0.01, seed=2)
    # Metres, and seconds that nobody has said to be seconds: 3 cm across.
    for k, table in enumerate((made.pseudoranges, made.pseudoranges / 343)):
        path = tmp_path / f"{k}.csv"
        path.write_text("\n".join(",".join(map(repr, row)) for row in table.tolist()) + "\n")
        command = [programs["tdoa"], "calibrate", path]
        printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        shown = repr(tdoa.calibrate(table)).splitlines()
        assert shown[0].startswith("8r/12s: 96 measurements") and shown[1].startswith("in the plane: ") and shown[2].startswith("size: ")
        assert all(line in printed for line in shown if "starts agree" not in line)
        assert any("if the measurements are times" in line for line in shown) == (k == 1)
    assert "if the measurements are times" not in repr(tdoa.calibrate(made.pseudoranges / 343, speed=343))
    each = tdoa.calibrate(made.pseudoranges, sigma=np.full((8, 12), 0.01))
    assert "each with its own standard deviation" in repr(each) and each.data["sigma_is_factor"]


def test_summaries_of_exact_networks_are_those_of_the_program(programs, tmp_path):
    import subprocess

    made = tdoa.simulate(6, 3, layout="normal", seed=9)
    path = tmp_path / "table.csv"
    path.write_text("\n".join(",".join(map(repr, row)) for row in made.pseudoranges.tolist()) + "\n")
    printed = subprocess.run([programs["tdoa"], "solve", path], check=True, capture_output=True, text=True).stdout
    first, *rest = repr(tdoa.solve(made.pseudoranges)).splitlines()
    assert first.startswith("6r/3s by 6r/3s: ") and first.split(": ")[1] in printed
    assert any(line.startswith("size: ") for line in rest) and all(line in printed for line in rest)


def test_anchors_have_standard_deviations():
    made = tdoa.simulate(8, 14, noise=0.01, seed=6)
    anchors = np.full((8, 2), np.nan)
    anchors[[0, 2, 5]] = made.receivers[[0, 2, 5]]
    anchors[2, 0] += 0.1
    anchors[7, 1] = made.receivers[7, 1]
    found = tdoa.calibrate(made.pseudoranges, anchors=anchors, anchor_sigma=[0, 0, 0.1, 0, 0, 0, 0, 0])
    assert found.data["anchored"] == [k in (0, 5) for k in range(8)]
    error = np.linalg.norm(found.receivers - made.receivers, axis=1)
    # The position that is 10 cm off is mended.
    assert error[2] < 0.08 and error.max() < 0.15
    names = {f"r{k + 1}": made.receivers[k] for k in (0, 2, 5)}
    by_name = tdoa.calibrate(made.pseudoranges, anchors=names, anchor_sigma={"r3": 0.1})
    assert by_name.data["anchored"] == found.data["anchored"]
    for arguments in (dict(anchor_sigma=0.1), dict(anchors=anchors, anchor_sigma=-1), dict(anchors=anchors, anchor_sigma="x")):
        with pytest.raises(hc.InputError):
            tdoa.calibrate(made.pseudoranges, **arguments)


def test_simulations_in_the_plane_and_in_space():
    for arguments, extent in (
        (dict(), (10, 10)),
        (dict(dimensions=2, layout="chain"), (10, 10)),
        (dict(size=(30, 20)), (30, 20)),
        (dict(dimensions=3), (10, 10, 3)),
        (dict(size=np.array([30, 20, 2]), layout="grid"), (30, 20, 2)),
        (dict(dimensions=3, layout="normal"), (np.inf, np.inf, np.inf)),
    ):
        made = tdoa.simulate(5, 6, seed=1, **arguments)
        assert made.receivers.shape == (5, len(extent)) and made.transmitters.shape == (6, len(extent))
        if np.isfinite(extent).all():
            nodes = np.concatenate([made.receivers, made.transmitters])
            assert (nodes >= 0).all() and (nodes <= extent).all()
        distances = np.linalg.norm(made.receivers[:, None] - made.transmitters, axis=2)
        assert np.allclose(made.pseudoranges, distances + made.offsets, rtol=0, atol=1e-12)
    for arguments in (
        dict(dimensions=4),
        dict(dimensions="3"),
        dict(dimensions=2, size=(10, 10, 3)),
        dict(dimensions=3, size=(10, 10)),
        dict(size=(10,)),
        dict(size=10),
        dict(size=(10, None)),
        dict(size=(10, 10, 0)),
    ):
        with pytest.raises(hc.InputError):
            tdoa.simulate(**arguments)


def test_bounds():
    square = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1], [0.4, 0.3], [0.2, 0.9]])
    others = np.array([[0.5, 2.0], [3, 1], [-1, -1], [0.3, 0.6], [2, -2], [-2, 3], [1.5, 0.2], [0.1, -1.2]])
    bound = tdoa.cramer_rao(square, others, 0.01)
    # The covariance is proportional to the variance of the noise; what is left out makes it larger.
    assert tdoa.cramer_rao(square, others, 0.02) == pytest.approx(2 * bound)
    used = np.ones((6, 8), bool)
    used[2, 3] = False
    assert tdoa.cramer_rao(square, others, 0.01, used=used) > bound
    # A receiver that hears nobody.
    used[5] = False
    assert tdoa.cramer_rao(square, others, 0.01, used=used) == np.inf
    for arguments in ((square, others, -1.0), (square, others[:, :1], 0.01), (square * np.nan, others, 0.01)):
        with pytest.raises(hc.InputError):
            tdoa.cramer_rao(*arguments)


def test_nodes_as_a_data_frame():
    pandas = pytest.importorskip("pandas")
    made = tdoa.simulate(8, 12, noise=0.02, outliers=0.05, seed=6)
    names = ["NA", "007", *(f"r{k}" for k in range(6))]
    found = tdoa.calibrate(pandas.DataFrame(made.pseudoranges, index=names))
    nodes = found.to_dataframe()
    assert list(nodes["name"]) == [*found.receiver_names, *found.transmitter_names]
    assert list(nodes["kind"]) == ["receiver"] * 8 + ["transmitter"] * 12
    assert np.array_equal(nodes[["x", "y"]][:8].to_numpy(), found.receivers)
    assert np.array_equal(nodes["offset"][8:].to_numpy(), found.offsets) and nodes["offset"][:8].isna().all()
    assert nodes["outliers"].sum() == 2 * (~found.inliers & np.isfinite(found.residuals)).sum()


def test_plots(tmp_path):
    pytest.importorskip("matplotlib")
    made = tdoa.simulate(8, 12, noise=0.02, outliers=0.05, seed=6)
    found = tdoa.calibrate(made.pseudoranges)
    ax = found.plot()
    kinds = {line.get_marker(): line.get_xydata() for line in ax.lines if line.get_marker() in "^o"}
    assert np.array_equal(kinds["^"], found.receivers)
    assert {text.get_text() for text in ax.texts} >= set(found.receiver_names)
    ax.figure.savefig(tmp_path / "network.png")
    assert found.plot(ax) is ax
    assert "<svg" in found._repr_html_() and "8r/12s" in repr(found)
    found.save_html(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>") and page.rstrip().endswith("</html>")
    held = tdoa.calibrate(made.pseudoranges, anchors=np.where(np.arange(8)[:, None] < 3, made.receivers, np.nan))
    assert held.data["anchored"][:3] == [True] * 3
    assert np.allclose(held.receivers[:3], made.receivers[:3])
    held.plot()
    beside = found.compared(made.receivers).plot()
    true = [line.get_xydata() for line in beside.lines if line.get_marker() == "x"]
    assert len(true) == 1 and np.allclose(true[0], made.receivers)
    import matplotlib.pyplot as pyplot

    pyplot.close("all")


def test_reports_are_those_of_the_program(programs, tmp_path):
    import re
    import subprocess

    made = tdoa.simulate(8, 12, noise=0.02, outliers=0.05, seed=6)
    path = tmp_path / "table.csv"
    path.write_text("\n".join(",".join(map(repr, row)) for row in made.pseudoranges.tolist()) + "\n")
    command = [programs["tdoa"], "calibrate", path, "--html", tmp_path / "a.html", "--svg", tmp_path / "a.svg"]
    command += ["--json", tmp_path / "a.json"]
    subprocess.run(command, check=True, capture_output=True)
    found = tdoa.calibrate(made.pseudoranges)
    found.save_html(tmp_path / "b.html")
    # The program alone knows where the result comes from.
    page, where = re.subn(r'<dl class="provenance">.*?</dl>\n', "", (tmp_path / "a.html").read_text(encoding="utf-8"), flags=re.S)
    assert (where, page) == (1, (tmp_path / "b.html").read_text(encoding="utf-8"))
    assert found.to_svg() == (tmp_path / "a.svg").read_text()
    assert found.to_json() == (tmp_path / "a.json").read_text()


def test_solutions():
    # By hand: the origin and (0, 1), (1, 1), each double.
    found = hc.solve("2\nx*(x - y);\n(y - 1)^2*(y + x);", seed=1)
    assert sorted(found.multiplicities.tolist()) == [2, 2, 2] and found.singular.all() and found.complete
    found = hc.solve(["x^2 + y^2 - 5", "x*y - 2"], certify=True)
    assert found.certified.all() and found.points.dtype == complex and found.real_points.dtype == float
    assert len(found) == 4 and np.allclose(found.points[:, 0] * found.points[:, 1], 2)
    assert repr(found).startswith("4 isolated solutions, 4 real") and "<pre>" in found._repr_html_()
    assert found == hc.solve(["x^2 + y^2 - 5", "x*y - 2"], certify=True) and found.n_real == 4
    assert found != hc.solve(["x^2 + y^2 - 5", "x*y - 2"]) and found != hc.solve(["x^2 - 1"]) and found != 4
    for start in ("total_degree", "total-degree"):
        assert hc.solve(["x^2 + y^2 - 5", "x*y - 2"], start=start).start == "total-degree"
    proved = hc.certify(["x^2 - 2"], [[1.41421356], [1.5], [-1.41421356]])
    assert proved.is_real.tolist() == [True, False, True] and (proved.n_real, proved.n_distinct) == (2, 2)
    assert np.allclose(proved.real_points, [[2**0.5], [-(2**0.5)]], rtol=1e-15)
    assert len(hc.solve(["x*y - x", "x*y - y"], torus_only=True)) == 1
    groups = hc.solve(["x*y - 2", "x + y - 3"], start="multihomogeneous", groups=[["x"], ["y"]])
    assert sorted(groups.real_points.round(9).tolist()) == [[1, 2], [2, 1]]


def test_decompositions():
    # The twisted cubic is a curve of degree three.
    found = hc.decompose("y - x^2; z - x*y; x*z - y^2", variables="x y z")
    [cubic] = found.components
    assert cubic[:4] == (1, 3, 1, True) and cubic.witness_points.shape == (3, 3)
    x, y, z = cubic.witness_points.T
    assert np.allclose(y, x**2) and np.allclose(z, x**3)
    assert found.complete and found.points.shape == (0, 3) and found.real_points.shape == (0, 3) and found.n_real == 0
    assert repr(found).startswith("1 component of positive dimension, 0 isolated solutions")
    # A line and a point beside it; unknowns in the order that is asked for.
    found = hc.decompose(["x*(y - 1)", "x*(x - 2)"], variables="y x")
    [line] = found.components
    assert line[:4] == (1, 1, 1, True) and abs(line.witness_points[0, 1]) < 1e-12
    assert found.real_points.round(12).tolist() == [[1, 2]] and found.multiplicities.tolist() == [1]
    assert found == hc.decompose(["x*(y - 1)", "x*(x - 2)"], variables="y x") and found != hc.decompose("x^2")
    # No equation that holds: nothing at all.
    nothing = hc.decompose(["x - 1", "x - 2"])
    assert (nothing.components, len(nothing.points), nothing.complete) == ([], 0, True)
    few = hc.decompose(["x*y - 1"], max_paths=0)
    assert few.unsearched and few.failed and not few.complete


def test_families_at_special_targets():
    # x^2 + a x + b at a double root; a x - b at infinity.
    family = hc.Family(["x^2 + a*x + b"], "x", "a b", roots=2)
    family.monodromy()
    tracked = family.track([[-6.0, 9.0]])
    assert tracked.ends.tolist() == [[hc.End.SINGULAR] * 2] and np.allclose(tracked.points, 3, atol=1e-6)
    line = hc.Family(["a*x - b"], "x", "a b", roots=1)
    line.monodromy(first=([2.0, 4.0], [2.0]))
    tracked = line.track([[0.0, 1.0], [2.0, 1.0]])
    assert tracked.ends.tolist() == [[hc.End.AT_INFINITY], [hc.End.FINITE]]
    assert np.isnan(tracked.points[0]).all() and tracked.points[1, 0, 0] == 0.5
    assert tracked.complete.all() and tracked.is_real.tolist() == [[False], [True]]
    assert line.track([[2.0, 1.0]], certify=True).uncertified.tolist() == [0]
    assert repr(tracked) == "2 targets of 1 root: 1 finite, 1 at infinity; all complete"
    assert [each.tolist() for each in tracked] == [[], [[0.5]]] and len(tracked) == 2
    assert tracked.n_real.tolist() == [0, 1] and [each.tolist() for each in tracked.real_points] == [[], [[0.5]]]
    assert tracked == line.track([[0.0, 1.0], [2.0, 1.0]]) and tracked != line.track([[2.0, 1.0]])
    # Nothing shows that these are all.
    found = family.monodromy(first=([-3.0, 2.0], [1.0]), roots=3, patience=2, trace=False)
    assert len(found) == 2 and not found.complete


def test_families_with_several_orbits():
    # Zero whatever the parameters, two more, and 1 with multiplicity 2.
    family = hc.Family(["x*(x - 1)^2*(x^2 - a)"], "x", "a")
    found = family.monodromy()
    assert len(found) == 3 and found.complete and found.orbits == [2, 1] and found.others == "start system"
    assert [(point.round(6).tolist(), count) for point, count in found.multiple] == [([1], 2)]
    assert sorted(family.track([[4.0]]).real_points[0][:, 0].round(12)) == [-2.0, 0.0, 2.0]
    part = family.monodromy(first=([4.0], [2.0]), only_component=True)
    assert (len(part), part.stopped, part.others) == (2, "component whole", "not sought") and not part.complete
    with pytest.raises(hc.InputError, match="first solution 1 is no regular solution"):
        family.monodromy(first=([4.0], [3.0]))


def test_the_monodromy_group_of_a_family():
    # Roots and their negatives: the symmetries of a square, with its diagonals as blocks.
    square = hc.Family(["x^4 + a*x^2 + b"], "x", "a b").monodromy(group=12).monodromy_group
    assert square["orbits"] == [[0, 1, 2, 3]] and not square["symmetric"]
    assert [sorted(map(len, system)) for system in square["blocks"][0]] == [[2, 2]]
    assert all(sorted(each) == [0, 1, 2, 3] for each in square["generators"])
    found = hc.Family(["x^5 + a*x + b"], "x", "a b").monodromy(group=12)
    assert found.monodromy_group["symmetric"] and found.monodromy_group["blocks"] == [[]]
    assert hc.Family(["x - a"], "x", "a").monodromy().monodromy_group is None


def test_families_with_more_equations_than_unknowns():
    # Three conics with the points (r, b / r), r^2 = a, in common.
    family = hc.Family(["x^2 - a", "x*y - b", "a*y^2 - b^2"], "x y", "a b")
    found = family.monodromy()
    assert len(found) == 2 and found.complete and found.orbits == [2]
    tracked = family.track([[4.0, 6.0]])
    assert tracked.complete.all() and sorted(tracked.real_points[0].round(12).tolist()) == [[-2.0, -3.0], [2.0, 3.0]]
    with pytest.raises(hc.InputError, match="only families of as many equations as unknowns can be certified"):
        family.track([[4.0, 6.0]], certify=True)
    with pytest.raises(hc.UndeterminedError, match="no solution for generic parameters"):
        hc.Family(["x - a", "x - b"], "x", "a b").monodromy()


def test_tables_of_other_people(tmp_path):
    import io

    speed = {"units": "s", "speed": 343.0}
    text = "ch;shot;wann;Güte\n1;7;1,5;0,9\n2;7;2,5;0,9\n1;8;3,5;0,1\n"
    read = tdoa.read(io.StringIO(text), columns={"receiver": "ch", "transmitter": "shot", "time": "wann"}, **speed)
    assert (read.receiver_names, read.transmitter_names) == (["1", "2"], ["7", "8"])
    assert np.array_equal(read.values, 343.0 * np.array([[1.5, 3.5], [2.5, np.nan]]), equal_nan=True)
    text = "idx,a,b,temp,wind\n0,1.5,2.5,20,1\n1,3.5,4.5,20,2\n2,5.5,6.5,20,3\n3,7.5,8.5,20,4\n"
    with pytest.raises(tdoa.InputError, match="temp"):
        tdoa.read(io.StringIO(text))
    read = tdoa.read(io.StringIO(text), transpose=True, columns={"ignore": ["temp", "wind"]})
    assert read.receiver_names == ["a", "b"] and read.values.tolist() == [[1.5, 3.5, 5.5, 7.5], [2.5, 4.5, 6.5, 8.5]]
    text = "r;a\nm;51,335\n"
    samples = {"units": "samples", "speed": 48000.0, "rate": 48000.0}
    with pytest.raises(tdoa.InputError, match="thousands"):
        tdoa.read(io.StringIO(text), **samples)
    assert tdoa.read(io.StringIO(text), decimal_mark=".", **samples).values.tolist() == [[51335.0]]
    for wrong in ({"columns": {"who": "r"}}, {"columns": ["r"]}, {"decimal_mark": ";"}):
        with pytest.raises(tdoa.InputError):
            tdoa.read(io.StringIO(text), **samples, **wrong)


def test_ranges_have_no_offsets():
    made = tdoa.simulate(6, 12, noise=0.01, ranges=True, seed=4)
    assert not made.offsets.any()
    found = tdoa.calibrate(made.pseudoranges, ranges=True)
    assert not found.offsets.any() and found.data["emissions"] == "known"
    with pytest.raises(tdoa.InputError, match="below zero"):
        tdoa.calibrate(tdoa.simulate(noise=0.01).pseudoranges, ranges=True)


def test_taped_distances():
    made = tdoa.simulate(6, 20, noise=0.1, ranges=True, seed=2)
    d = np.linalg.norm(made.receivers[:, None] - made.receivers, axis=2)
    taped = [("r1", "r4", d[0, 3], 0.001), (5, 1, d[5, 1], 0.001), ("r3", "r5", d[2, 4] + 1, 0.001)]
    found = tdoa.calibrate(made.pseudoranges, ranges=True, distances=taped, dimensions=2)
    assert [known["inlier"] for known in found.data["distances"]] == [True, True, False]
    assert abs(np.linalg.norm(found.receivers[0] - found.receivers[3]) - d[0, 3]) < 0.004


def test_recorders_with_clocks_of_their_own(programs, tmp_path):
    import json
    import subprocess

    made = tdoa.simulate(8, 30, noise=0.01, delays=50, rates=2e-5, channels=2, duration=2e5, seed=1)
    recorders = [f"rec{i // 2 + 1}" for i in range(8)]
    found = tdoa.calibrate(made.pseudoranges, clocks=tdoa.Clocks(receivers="rate"), recorders=recorders)
    assert [clock.recorder for clock in found.clocks] == ["rec1", "rec2", "rec3", "rec4"]
    first = found.clocks[0]
    assert (first.offset, first.rate) == (0, 0)
    for k, clock in enumerate(found.clocks[1:], 1):
        rate = (1 + made.clocks[2 * k, 1]) / (1 + made.clocks[0, 1]) - 1
        assert abs(clock.rate - rate) < 5 * clock.rate_std and clock.offset_std < 0.1
    found.save_html(tmp_path / "report.html")
    assert "clocks: each transmitter has an unknown offset" in repr(found) and "<h2>Clocks</h2>" in (tmp_path / "report.html").read_text()
    assert tdoa.Calibration.from_json(found.to_json()).clocks == found.clocks

    # Those of a dict, and those that the program has of a file.
    named = {f"r{i + 1}": name for i, name in enumerate(recorders)}
    assert tdoa.calibrate(made.pseudoranges, clocks=tdoa.Clocks(receivers="rate"), recorders=named) == found
    table, groups = tmp_path / "table.csv", tmp_path / "recorders.csv"
    table.write_text("\n".join(",".join(map(repr, row)) for row in made.pseudoranges.tolist()) + "\n")
    groups.write_text("".join(f"{receiver},{recorder}\n" for receiver, recorder in named.items()))
    command = [programs["tdoa"], "calibrate", table, "--receiver-clocks", "rate", "--recorders", groups, "--json", "-"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert json.loads(printed)["clocks"] == found.data["clocks"]

    # A pinger that sends by a clock of its own.
    pinger = tdoa.simulate(8, 20, noise=0.01, delays=300, rates=2e-5, channels=8, duration=2e5, seed=1)
    schedule = tdoa.Clocks(emissions="constant")
    found = tdoa.calibrate(pinger.pseudoranges, clocks=schedule, times=pinger.offsets, dimensions=2)
    assert [clock.recorder for clock in found.clocks] == ["all receivers"] and np.allclose(found.offsets, pinger.offsets)
    assert abs(found.clocks[0].rate - pinger.clocks[0, 1]) < 5 * found.clocks[0].rate_std
    in_seconds = tdoa.calibrate(
        pinger.pseudoranges / 343, speed=343, clocks=schedule, times={f"s{j + 1}": t / 343 for j, t in enumerate(pinger.offsets)}, dimensions=2
    )
    assert np.allclose(in_seconds.receivers, found.receivers, atol=1e-6)

    # A clock of each receiver; receivers that share one have none.
    apart = tdoa.simulate(8, 20, noise=0.01, delays=3, seed=2).pseudoranges
    each = tdoa.calibrate(apart, receiver_delays="all", dimensions=2)
    assert each == tdoa.calibrate(apart, clocks=tdoa.Clocks(receivers="offset"), dimensions=2)
    assert len(each.clocks) == 8 and each.clocks[1].rate is None
    constant = tdoa.simulate(6, 12, noise=0.01, emissions="constant", seed=4)
    assert np.ptp(constant.offsets) == 0 and not constant.clocks.any()
    found = tdoa.calibrate(constant.pseudoranges, clocks=tdoa.Clocks(emissions="constant"))
    assert found.clocks == [] and found.data["emissions"] == "constant" and np.ptp(found.offsets) == 0


def test_new_transmitters_are_located():
    made = tdoa.simulate(10, 40, dimensions=3, noise=0.01, seed=2)
    names = [f"mic{i}" for i in range(10)]
    network = tdoa.calibrate(made.pseudoranges[:, :30], dimensions=3, names=names).compared(made.receivers)
    new = made.pseudoranges[:, 30:].copy()
    # The last receiver mistakes one, another is heard by three.
    new[9, 2] += 4.0
    new[3:, 5] = np.nan
    places = network.locate(new, names=names)
    assert [place.heard for place in places] == [10, 10, 10, 10, 10, 3, 10, 10, 10, 10]
    for j, place in enumerate(places):
        if j == 5:
            assert "3 receivers" in place.problem and np.isnan(place.position).all() and not place.unique
            continue
        error = place.position - made.transmitters[30 + j]
        # Beyond five deviations by chance once in a hundred thousand times.
        assert error @ np.linalg.solve(place.covariance, error) < 31, (j, place)
        assert place.fits and place.outliers == (["mic9"] if j == 2 else []), (j, place)
    # Rows by name, in any order.
    again = tdoa.Calibration.from_json(network.to_json()).locate(new[::-1], names=names[::-1])
    assert [repr(place) for place in again] == [repr(place) for place in places]
    with pytest.raises(hc.InputError, match="not in the network: other"):
        network.locate(new, names=["other", *names[1:]])


def test_recordings_are_heard_and_calibrated(tmp_path):
    # Claps in a field: white noise that begins at once, the same for all microphones but for the delay and the distance.
    random = np.random.default_rng(3)
    rate, speed = 48_000, 343.0
    microphones = random.uniform([0, 0, 0], [8, 6, 3], (8, 3))
    places = random.uniform([0, 0, 0], [8, 6, 3], (16, 3))
    samples = 1e-4 * random.normal(size=(8, 48_000 * 26))
    times = 1.0 + 1.5 * np.arange(16) + random.uniform(0, 0.3, 16)
    frequencies = np.fft.rfftfreq(8192, 1 / rate)
    inside = (frequencies > 200) & (frequencies < 15_000)
    for place, time in zip(places, times):
        clap = np.zeros(8192)
        clap[:384] = random.normal(size=384) * np.exp(-np.arange(384) / 72)
        spectrum = np.fft.rfft(clap) * inside
        for channel, microphone in zip(samples, microphones):
            distance = np.linalg.norm(place - microphone)
            at = (time + distance / speed) * rate
            first = int(at) - 64
            # A delay of a fraction of a sample turns the phases.
            late = np.fft.irfft(spectrum * np.exp(-2j * np.pi * frequencies * (at - first) / rate))
            channel[first : first + 8192] += 0.1 / distance * late
    heard = tdoa.listen(samples, rate=rate, speed=speed)
    assert heard.pseudoranges.shape == (8, 16) and heard.recorders is None
    # Claps of a bounded band ring before they begin, which some channels hear by themselves: that is said, and no channel is wrong.
    assert not any(warning.startswith("channel ") for warning in heard.warnings)
    found = tdoa.calibrate(heard).compared(microphones)
    assert found.dimensions == 3 and found.truth["receiver_rms"] < 3e-3, found.truth
    # The same sounds, each by itself.
    located = found.locate(heard)
    assert np.allclose([place.position for place in located], found.transmitters, atol=5e-3) and all(place.unique for place in located)
    # Two recorders that were started apart, from files.
    _native = hc._native
    parts = [tmp_path / "left.wav", tmp_path / "right.wav"]
    for path, part in zip(parts, [samples[:4], samples[4:, 12_000:]]):
        _native.write_recording(str(path), part.astype(np.float32), rate)
    apart = tdoa.listen(parts, apart=True, speed=speed)
    assert apart.recorders == ["left"] * 4 + ["right"] * 4
    assert abs(apart.data["alignment"]["recorders"][1]["start"] - 0.25) < 0.02
    found = tdoa.calibrate(apart).compared(microphones)
    assert found.truth["receiver_rms"] < 2e-2 and [clock.recorder for clock in found.clocks] == ["left", "right"], found
    assert all(place.unique for place in found.locate(apart))
    pandas = pytest.importorskip("pandas")
    table = heard.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and len(table) == 128 and table.sigma.max() < 1e-4
    # What is no recording, or says too little.
    for given, words in [(samples, "rate"), (5, "recordings must be paths")]:
        with pytest.raises(hc.InputError, match=words):
            tdoa.listen(given)
    (tmp_path / "text.wav").write_text("no sound")
    with pytest.raises(hc.InputError, match="text.wav"):
        tdoa.listen(tmp_path / "text.wav")
    with pytest.raises(FileNotFoundError):
        tdoa.listen(tmp_path / "none.wav")
    silent = tdoa.listen(np.zeros((4, 48_000)), rate=rate)
    assert silent.pseudoranges is None and "silent" in silent.warnings[0]
    with pytest.raises(hc.InputError, match="no sound"):
        tdoa.calibrate(silent)


def test_rooms_of_another_simulator(tmp_path):
    """Echoes by pyroomacoustics, which knows nothing of ours: `pip install pyroomacoustics`."""
    acoustics = pytest.importorskip("pyroomacoustics")
    rate, size = 48_000, np.array([8.0, 6.0, 3.0])
    absorption, order = acoustics.inverse_sabine(0.4, size)
    random = np.random.default_rng(5400)
    room = acoustics.ShoeBox(size, fs=rate, materials=acoustics.Material(absorption), max_order=min(order, 30))
    microphones, places = (random.uniform(0.3, size - 0.3, (count, 3)) for count in (10, 20))
    times = 1.0 + 1.5 * np.arange(20) + random.uniform(0, 0.3, 20)
    decay = np.exp(-np.arange(384) / 72)
    for place, time in zip(places, times):
        room.add_source(place, signal=random.normal(size=384) * decay, delay=time)
    room.add_microphone_array(microphones.T)
    room.simulate()
    samples = room.mic_array.signals[:, : 33 * rate]
    distances = np.linalg.norm(microphones[:, None] - places, axis=2)
    # 20 dB below the direct sound.
    direct = np.sqrt(np.mean((1 / (4 * np.pi * distances)) ** 2) * np.mean(decay**2))
    samples = samples + 0.1 * direct * random.normal(size=samples.shape)
    heard = tdoa.listen(samples / np.abs(samples).max(), rate=rate, speed=room.c)
    assert heard.pseudoranges.shape == (10, 20)
    arrivals = np.array([[arrival["seconds"] for arrival in event] for event in heard.data["arrivals"]]).T
    late = arrivals - (times + distances / room.c)
    late -= np.median(late, axis=0)
    # Of all arrivals 98 % within 30 us, the median below 2 us, receivers within 3 mm.
    assert np.mean(np.abs(late) < 30e-6) >= 0.98 and np.median(np.abs(late)) < 2e-6
    assert tdoa.calibrate(heard).compared(microphones).truth["receiver_rms"] < 3e-3

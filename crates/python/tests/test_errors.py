"""Input that cannot be used, and what Python hears of it."""

import io
import pathlib

import hc
import numpy as np
import pytest
import tdoa

TABLE = tdoa.simulate(8, 10, noise=0.01, seed=1).pseudoranges


@pytest.mark.parametrize(
    "table, words",
    [
        (np.zeros(5), "a matrix, receivers in rows"),
        (np.zeros((2, 3, 4)), "a matrix, receivers in rows"),
        (3.0, "a matrix, receivers in rows"),
        (None, "a matrix, receivers in rows"),
        ([[1.0, 2.0], [3.0]], "must be a matrix"),
        (TABLE.astype(complex), "real numbers, not complex128"),
        (TABLE.astype(str), "real numbers, not <U"),
        ([["a", None], ["b", 2.0]], "must be a matrix of numbers"),
        (np.array([["2026-01-01"]], dtype="datetime64[D]"), "real numbers, not datetime64"),
        (np.zeros((0, 5)), "no receivers or no transmitters|0 receivers"),
        (np.zeros((5, 0)), "no receivers or no transmitters|0 transmitters|5 receivers"),
        (np.full((8, 10), np.inf), "inf"),
        (np.full((8, 10), 1e300), "1e300|too large|largest"),
        # Eight terabytes, if somebody copied it.
        (np.broadcast_to(0.0, (10**6, 10**6)), "1000000"),
        (np.broadcast_to(np.int8(0), (10**9, 10**9)), "1000000000"),
    ],
)
def test_tables_that_are_none(table, words):
    for function in (tdoa.calibrate, tdoa.solve):
        with pytest.raises(hc.InputError, match=words) as caught:
            function(table)
        assert isinstance(caught.value, ValueError)


def test_tables_that_determine_nothing():
    for table in (np.full((8, 10), np.nan), TABLE[:2], TABLE[:, :2], np.zeros((8, 10))):
        with pytest.raises(hc.UndeterminedError):
            tdoa.calibrate(table)
    with pytest.raises(hc.UndeterminedError, match="6 receivers with 3 transmitters"):
        tdoa.solve(TABLE[:3, :3])
    with pytest.raises(hc.UndeterminedError, match="3 receivers with 3 transmitters"):
        tdoa.solve(np.ones((2, 3)), ranges=True)
    with pytest.raises(hc.UndeterminedError, match="4 receivers with 3 transmitters, and 3 with 4"):
        tdoa.solve(np.ones((3, 3)), emissions="constant")
    with pytest.raises(hc.InputError, match="known emissions"):
        tdoa.solve(TABLE[:3, :4], ranges=True, emissions="constant")
    with pytest.raises(hc.InputError, match="emissions must be unknown, constant or known"):
        tdoa.solve(TABLE[:3, :4], emissions="never")
    with pytest.raises(hc.UndeterminedError, match="the range of receiver r2 and transmitter s3 is negative"):
        tdoa.solve([[1.0, 2.0, 2.0], [2.0, 1.0, -3.0], [2.5, 1.5, 1.0]], ranges=True)
    gap = TABLE[:6, :3].copy()
    gap[2, 1] = np.nan
    with pytest.raises(hc.UndeterminedError, match="receiver r3 did not hear transmitter s2"):
        tdoa.solve(gap)


def test_memory_layouts_give_the_same_bits():
    # The same few starts for all.
    def calibrate(table):
        return tdoa.calibrate(table, max_starts=4, agreeing=1)

    expected = calibrate(TABLE).to_json()
    wide = np.zeros((16, 30))
    wide[::2, ::3] = TABLE
    swapped = TABLE.astype(">f8")
    unaligned = np.frombuffer(b"x" + TABLE.tobytes(), dtype=np.uint8)[1:].view("<f8").reshape(TABLE.shape)
    for table in (np.asfortranarray(TABLE), wide[::2, ::3], TABLE[::-1, ::-1][::-1, ::-1], swapped, unaligned, TABLE.tolist()):
        assert calibrate(table).to_json() == expected
    readonly = TABLE.copy()
    readonly.flags.writeable = False
    assert calibrate(readonly).to_json() == expected
    # Doubles hold every number of the other types.
    for small in (TABLE.astype(np.float32), np.round(1000 * TABLE).astype(np.int32)):
        assert calibrate(small).to_json() == calibrate(small.astype(float)).to_json()
    missing = [[None if (i, j) == (1, 2) else TABLE[i, j] for j in range(10)] for i in range(8)]
    gap = TABLE.copy()
    gap[1, 2] = np.nan
    assert calibrate(missing).to_json() == calibrate(gap).to_json()


@pytest.mark.parametrize(
    "arguments, words",
    [
        (dict(dimensions=4), 'dimensions must be 2, 3 or "auto", not 4'),
        (dict(dimensions="two"), "dimensions must be"),
        (dict(dimensions="3"), "dimensions must be"),
        (dict(dimensions=True), "dimensions must be"),
        (dict(dimensions=None), "dimensions must be"),
        (dict(dimensions=[2]), "dimensions must be"),
        (dict(dimensions=2.5), "dimensions must be"),
        (dict(dimensions=3, anchors={"r1": (0, 0), "r2": (1, 0)}), "need x, y and z"),
        (dict(dimensions=2, anchors={"r1": (0, 0, 0), "r2": (1, 0, 1)}), "differ by 1 m, but dimensions=2 is the plane"),
        (dict(anchors={"r1": (0, 0, 0, 1)}), "the anchor r1 must be x and y, in space z too"),
        (dict(anchors=np.zeros((8, 4))), r"\(8, 2\) or, in space, \(8, 3\)"),
        (dict(sigma=-1), "option sigma must be positive and finite, not -1"),
        (dict(sigma="x"), "sigma must be a number"),
        (dict(sigma=np.ones((3, 3))), "shape of the pseudoranges"),
        (dict(sigma=np.zeros((8, 10))), "not 0|standard deviation"),
        (dict(speed=0), "speed must be positive"),
        (dict(speed=np.nan), "speed must be positive"),
        (dict(seed=-1), "seed must be between 0"),
        (dict(seed=1.5), "seed must be a whole number"),
        (dict(seed=2**64), "seed must be between 0"),
        (dict(threads=0), "threads must be between 1 and 1024, not 0"),
        (dict(threads=5000), "threads must be between 1 and 1024"),
        (dict(names=["a", "b"]), "2"),
        (dict(names=["a"] * 8), "a"),
        (dict(names=3), "names must be a list"),
        (dict(anchors={"r9": (0, 0)}), "no receiver or transmitter is named r9; the receivers are r1, r2.* the transmitters s1"),
        (dict(anchors={"r1": (0,)}), "the anchor r1 must be x and y"),
        (dict(anchors=np.zeros((3, 2))), r"anchors must have shape \(8, 2\)"),
        (dict(receiver_delays="some"), "none, auto or all"),
        (dict(errors="late"), "symmetric or one-sided"),
        (dict(errors="one-sided", receiver_delays="auto"), "not both"),
        (dict(clocks="offset"), r"tdoa.Clocks\(emissions"),
        (dict(clocks=tdoa.Clocks(emissions="constant"), ranges=True), "leave one of both out"),
        (dict(clocks=tdoa.Clocks(receivers="rate"), receiver_delays="all"), "give one of both"),
        (dict(clocks=tdoa.Clocks(receivers="rate"), errors="one-sided"), "not both"),
        (dict(clocks=tdoa.Clocks(rate_sigma=1e-5)), "clocks.rate_sigma"),
        (dict(clocks=tdoa.Clocks(receivers="offset", offset_sigma=-1)), "clocks.offset_sigma must be positive"),
        (dict(recorders=["a"] * 8), "recorders have clocks of their own"),
        (dict(recorders=["a"], clocks=tdoa.Clocks(receivers="offset")), "1 names for 8 receivers"),
        (dict(recorders={"q": "a"}, clocks=tdoa.Clocks(receivers="offset")), "no receiver is named q"),
        (dict(times=[0.0]), "times are when transmitters send"),
        (dict(times=[0.0], ranges=True), "times has 1 numbers"),
        (dict(times={"s99": 0.0}, ranges=True), "look at s99"),
        (dict(times=["soon"] * 12, ranges=True), "times must be a number"),
        (dict(distances=[(1, 2)]), "distances must be"),
        (dict(distances=[(1, 2, 3.0, 4.0, 5.0)]), "distances must be"),
        (dict(distances=[(1, 2, 3.0, -1.0)]), "must be positive"),
        (dict(distances=[(1, 2, 3.0)]), "has no standard deviation"),
        (dict(distances=[("r1", "q", 1.0)]), "no receiver is named q"),
        (dict(estimate_speed=True), "known positions and distances"),
        (dict(max_starts=0), "option max_starts must be at least 1"),
    ],
)
def test_arguments(arguments, words):
    with pytest.raises(hc.InputError, match=words):
        tdoa.calibrate(TABLE, **arguments)


def test_clocks_that_there_are_not():
    for given in (dict(receivers="drift"), dict(emissions=None)):
        with pytest.raises(hc.InputError, match="of Clocks must be"):
            tdoa.Clocks(**given)
    with pytest.raises(hc.InputError, match="leave one of both out"):
        tdoa.simulate(ranges=True, emissions="constant")


@pytest.mark.parametrize("dimensions", [4, "three", True, None])
def test_exact_solutions_are_in_the_plane_or_in_space(dimensions):
    with pytest.raises(hc.InputError, match="dimensions must be 2, 3 or"):
        tdoa.solve(TABLE[:6, :3], dimensions=dimensions)


def test_sizes_that_are_not_solved_in_space():
    with pytest.raises(hc.UndeterminedError, match="6r/3s is underdetermined in space"):
        tdoa.solve(TABLE[:6, :3], dimensions=3)
    with pytest.raises(hc.UndeterminedError, match="with five receivers"):
        tdoa.solve(tdoa.simulate(5, 9, dimensions=3).pseudoranges, dimensions=3)


@pytest.mark.parametrize(
    "system, words",
    [
        ("", "no equations|empty"),
        ([], "no equations|unknowns"),
        ("x^2 + ", "line 1"),
        (["x^2 - y"], "add equations"),
        (["sin(x)"], "sin|formula|name"),
        (["x - 1", "1"], "constant"),
        (["x^2 - 1", 3.0], "constant"),
        ("parameters: a\nx - a", "a family of systems"),
        (None, "must be a string or a SymPy expression"),
        ([["x"]], "must be a string or a SymPy expression, not list"),
        (["x^99999999999"], "exponent|large"),
        (["((" * 500 + "x" + "))" * 500], "deep|nest|parenthes"),
        (["x^1000000 - 1", "y^1000000 - 1"], "paths|large"),
    ],
)
def test_systems_that_are_none(system, words):
    for function in (hc.solve, hc.mixed_volume):
        if function is hc.mixed_volume and words in ("add equations", "constant", "paths|large"):
            continue
        with pytest.raises(hc.InputError, match=words):
            function(system)


def test_families_that_are_none():
    for arguments, words in [
        ((["x - a"],), "say which names are unknowns"),
        ((["x - b"], ["x"], ["a"]), "b"),
        ((["x*y - a"], ["x", "y"], ["a"]), "1 equation in 2 unknowns;"),
        (("name = 3",), "line 1|string|expected"),
    ]:
        with pytest.raises(hc.InputError, match=words):
            hc.Family(*arguments)
    family = hc.Family(["x^2 - a"], "x", "a", roots=2)
    for targets in ([[1.0, 2.0]], [[np.nan]], [[np.inf]], np.zeros((1, 0)), np.zeros((2, 2, 2)), [["b"]], None):
        with pytest.raises(hc.InputError):
            family.track(targets)
    assert family.track(np.zeros((0, 1))).points.shape == (0, 2, 1)
    with pytest.raises(hc.InputError, match="start file"):
        hc.Fibre("[]")
    with pytest.raises(hc.InputError, match="coordinates"):
        family.compile(hc.Fibre('{"parameters": [[1, 0]], "solutions": [[[1, 0], [2, 0]]]}'))


def test_files(tmp_path):
    for path in (tmp_path / "nothing.csv", str(tmp_path / "nothing.csv"), bytes(tmp_path / "nothing.csv")):
        with pytest.raises(FileNotFoundError, match="nothing.csv"):
            tdoa.read(path)
    with pytest.raises(IsADirectoryError):
        tdoa.read(tmp_path)
    for thing in (3.0, None, "\0", [1]):
        with pytest.raises(hc.InputError, match="must be a path or an open file"):
            tdoa.read(thing)
    (tmp_path / "bad.csv").write_text("1,2\n3,x\n")
    with pytest.raises(hc.InputError, match="bad.csv.*line 2"):
        tdoa.read(tmp_path / "bad.csv")
    with pytest.raises(hc.InputError, match="needs speed"):
        tdoa.read(tmp_path / "bad.csv", units="s")
    with pytest.raises(hc.InputError, match="units"):
        tdoa.read(tmp_path / "bad.csv", units="parsec", speed=1.0)


# 3^12 paths: an hour's work and more.
LONG = [f"x{i}^3 - {i + 2}*x{(i + 1) % 12}^2*x{(i + 2) % 12} + 2*x{(i + 3) % 12} + {i + 1}" for i in range(12)]


@pytest.mark.parametrize("threads", [1, None])
def test_panics_are_exceptions_of_this_library(threads, capfd):
    """PyO3 panics where Rust is handed the exception that it makes of a panic.

    With one thread it is the work that panics, with more the thread that waits for it.
    """
    raised = RuntimeError("at work")

    def fail(*_):
        raise raised

    def solve():
        return hc.solve(LONG, start="total_degree", threads=threads, progress=fail)

    # PyO3 makes the class when it sees an exception for the first time.
    with pytest.raises(RuntimeError, match="at work"):
        solve()
    internal = 0
    # Other extension modules have such a class of their own, which is any other exception here.
    for kind in [each for each in BaseException.__subclasses__() if each.__name__ == "PanicException"]:
        raised = kind("at work")
        with pytest.raises((hc.InternalError, kind), match="at work") as caught:
            solve()
        if isinstance(caught.value, hc.InternalError):
            internal += 1
            assert isinstance(caught.value, Exception) and type(caught.value).__module__ == "hc"
    assert internal == 1
    # The threads still work.
    assert len(hc.solve(["x^2 - 2"], threads=threads)) == 2


def test_nothing_but_the_packages_is_in_the_extension_module():
    from hc import _native

    assert not [name for name in dir(_native) if "test" in name or "fail" in name]


def test_shapes_that_came_are_named():
    family = hc.Family(["x^2 - a*y", "y - b"], "x y", "a b", roots=2)
    for call, words in [
        (lambda: tdoa.calibrate(np.zeros(5)), r"not an array of shape \(5,\)"),
        (lambda: tdoa.calibrate(3.0), "not a single number"),
        (lambda: tdoa.calibrate(TABLE, anchors=np.zeros((3, 2))), r"not \(3, 2\)"),
        (lambda: tdoa.cramer_rao(np.zeros((3, 3)), np.zeros((3, 2)), 1.0), r"not \(3, 3\)"),
        (lambda: tdoa.cramer_rao(np.zeros(3), np.zeros((3, 2)), 1.0), r"not an array of shape \(3,\)"),
        (lambda: family.track(np.zeros((2, 2, 2))), r"not an array of shape \(2, 2, 2\)"),
        (lambda: family.track([[1.0, 2.0, 3.0]]), r"a column for each of a, b, not shape \(1, 3\)"),
        (lambda: hc.certify(["x^2 - y", "y - 2"], [[1.0, 2.0, 3.0]]), "3 coordinates|2 unknowns|2 coordinates"),
        (lambda: hc.certify(["x^2 - 2"], 1.0), "not a single number"),
    ]:
        with pytest.raises(hc.InputError, match=words):
            call()


@pytest.mark.parametrize("given", ["table.csv", b"table.csv", pathlib.Path("table.csv"), io.StringIO("1,2"), io.BytesIO(b"1,2")])
def test_files_in_place_of_tables(given):
    for function in (tdoa.calibrate, tdoa.solve):
        with pytest.raises(hc.InputError, match=r"read it first: tdoa.read\((file|'table.csv')\)"):
            function(given)

"""Calibration, exact solution and simulation of networks."""

from numbers import Real
from typing import NamedTuple

import numpy as np

from hc import InputError, _native
from hc._result import Result
from hc._run import call, integer, number, seeded, text

from ._calibration import Calibration
from ._clocks import Clocks, settings as clock_settings
from ._listen import heard
from ._tables import real_matrix, table


# Heights that differ by more than this share of the extent are no plane.
_FLAT = 0.1


def _is(dimensions, value):
    """Whether dimensions are these; True is not 1."""
    kind = str if isinstance(value, str) else Real
    return isinstance(dimensions, kind) and not isinstance(dimensions, bool) and dimensions == value


def _plane_or_space(dimensions):
    if _is(dimensions, "auto") or _is(dimensions, 2):
        return 2
    if _is(dimensions, 3):
        return 3
    raise InputError(f'dimensions must be 2, 3 or "auto", not {dimensions!r}')


def _nodes(given):
    """Names of all nodes: the receivers, then the transmitters."""
    m, n = np.shape(given["values"])
    receivers, transmitters = given["receivers"], given["transmitters"]
    receivers = receivers if receivers is not None else [f"r{i + 1}" for i in range(m)]
    return [*receivers, *(transmitters if transmitters is not None else [f"s{j + 1}" for j in range(n)])]


def _node(name, names, count):
    """The place of a node among all; a name of both kinds is the receiver's."""
    if str(name) not in names:
        kinds = f"the receivers are {', '.join(names[:count][:8])}, the transmitters {', '.join(names[count:][:8])}"
        raise InputError(f"no receiver or transmitter is named {name}; {kinds}")
    return names.index(str(name))


def _anchors(anchors, names, count):
    """Known positions in the order of the nodes: x, y and z, NaN where unknown."""
    rows = np.full((len(names), 3), np.nan)
    if anchors is None:
        return rows
    if hasattr(anchors, "keys"):
        for name in anchors.keys():
            position = _position(name, anchors[name])
            rows[_node(name, names, count), : len(position)] = position
    else:
        given = real_matrix("anchors", anchors)
        if given.shape not in ((count, 2), (count, 3)):
            shapes = f"({count}, 2) or, in space, ({count}, 3)"
            raise InputError(f"anchors must have shape {shapes}, NaN where unknown, or be a dict by name, not {given.shape}")
        rows[:count, : given.shape[1]] = given
    return rows


def _dimensions(dimensions, rows):
    """2 or 3, as asked for or as heights of known positions have it; None where the measurements are to decide."""
    heights = rows[~np.isnan(rows[:, 2]), 2]
    if _is(dimensions, "auto"):
        return 3 if (heights != heights[:1]).any() else None
    if _is(dimensions, 3):
        if len(heights) == 0 and not np.isnan(rows).all():
            raise InputError("anchors in space need x, y and z, not x and y alone; add z, or leave out dimensions=3")
        return 3
    if not _is(dimensions, 2):
        raise InputError(f'dimensions must be 2, 3 or "auto", not {dimensions!r}')
    if np.isfinite(heights).all() and len(heights) > 1:
        flat = rows[np.isfinite(rows[:, :2]).all(axis=1), :2]
        extent = np.ptp(flat, axis=0).max() if len(flat) else 0.0
        if np.ptp(heights) > _FLAT * extent:
            raise InputError(
                f"the heights (z) of the anchors differ by {np.ptp(heights):.3g} m, but dimensions=2 is the plane; give anchors at one "
                "height, leave out z if the differences do not matter, or calibrate in space (dimensions=3)"
            )
    return 2


def _known(rows, sigma, names, count, anchored):
    """Exact positions in the order of the receivers, and others: node, coordinates, standard deviation."""
    sigmas = np.zeros(len(rows))
    if hasattr(sigma, "keys"):
        for name in sigma.keys():
            sigmas[_node(name, names, count)] = number("anchor_sigma", sigma[name])
    elif sigma is not None:
        try:
            numbers = np.asarray(sigma, dtype=float)
            sigmas[: None if numbers.ndim == 0 else count] = numbers
        except (TypeError, ValueError):
            raise InputError(f"anchor_sigma must be a number, {count} numbers, or a dict by name, not {sigma!r}") from None
    if not anchored:
        if sigma is not None:
            raise InputError("anchor_sigma needs anchors")
        return [], []
    exact, measured = [None] * count, []
    for i, (row, sigma) in enumerate(zip(rows, sigmas)):
        position = [None if np.isnan(value) else float(value) for value in row]
        if sigma == 0 and None not in position and i < count:
            exact[i] = position
        elif any(value is not None for value in position):
            measured.append((i, position, float(sigma)))
    return exact, measured


def _position(name, given):
    try:
        point = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        point = np.empty(0)
    if point.shape not in ((2,), (3,)):
        raise InputError(f"the anchor {name} must be x and y, in space z too, in metres, not {given!r}")
    return point


def calibrate(
    pseudoranges,
    *,
    sigma=None,
    speed=None,
    dimensions="auto",
    anchors=None,
    anchor_sigma=None,
    names=None,
    seed=0,
    threads=None,
    progress=True,
    receiver_delays="none",
    ranges=False,
    clocks=None,
    recorders=None,
    times=None,
    errors="auto",
    distances=None,
    estimate_speed=False,
    max_starts=None,
    agreeing=None,
):
    """Calibrate a network from its pseudoranges, with outliers, gaps and noise.

    Parameters
    ----------
    pseudoranges : array_like of float, shape (m, n), or pandas.DataFrame, or Pseudoranges, or Heard
        What receiver i (row) measures of transmitter j (column): distance plus offset, metres; NaN where nothing was measured. What
        `listen` has heard brings its recorders along, whose clocks then have unknown offsets and rates.
        With `speed`: arrival times in seconds. A DataFrame may also have one measurement a row, in columns such as mic, event
        and value, as `read` takes it from a file.
    sigma : float or array_like of shape (m, n), optional
        Standard deviation of the measurements in metres; an array has one for each. Estimated by default.
    speed : float, optional
        Propagation speed in metres a second that makes metres of times in seconds; sound in air: 343, radio: 299792458.
    dimensions : {"auto", 2, 3}
        Whether the network is sought in the plane (d = 2) or in space (d = 3). "auto": in space where anchors have different
        heights, otherwise as the measurements have it, and `dimension_test` of the result says how clearly.
    anchors : array_like of shape (m, 2) or (m, 3), or dict of name to (x, y) or (x, y, z), optional
        Known positions of some receivers in metres, NaN where unknown; by name of transmitters too. They fix the frame, and two
        or more, in space three or more, are held there. Some coordinates may be NaN, beside two (three) nodes with all; heights
        of three nodes or more may be all that is known, and turn the network upright once it is found. In the plane z is left out;
        heights that differ by more than a tenth of the extent are refused.
    anchor_sigma : float, array_like of shape (m,), or dict of name to float, optional
        Standard deviations of the anchors in metres, which are then measurements; 0, the default, for exact ones. An array is of
        receivers.
    names : list of str, or (list of str, list of str), or dict with receivers and transmitters, optional
        Names of the receivers, and of the transmitters. A DataFrame has its own.
    seed : int
        Seed of the search; the same seed gives the same bits, those of the program `tdoa calibrate` too.
    threads : int, optional
        Threads; all cores by default. The result does not depend on it.
    progress : bool or callable
        Whether a bar is shown after a second, in a terminal or a notebook with tqdm; or a function of words, done, total.
    receiver_delays : {"none", "auto", "all"}
        What is done about receivers whose measurements are all too long or too short: told, or estimated for those that show it.
        "all" is short for ``clocks=Clocks(receivers="offset")`` with a recorder for each receiver.
    ranges : bool
        Whether the measurements are distances, such as two-way ranges or arrival times less known send times: transmitters have no
        offsets then. Short for ``clocks=Clocks(emissions="known")``.
    clocks : Clocks, optional
        What is unknown of the clocks of transmitters and recorders; by default the offset of each transmitter.
    recorders : sequence of str, or dict of receiver to recorder, optional
        The recorder of each receiver: those of one share a clock. By default receivers with names such as "rec1:1" and "rec1:2" are
        channels of one, and every other receiver is a recorder by itself; so are those that a dict leaves out.
    times : array_like or dict of transmitter to time, optional
        When each transmitter sends, in the unit of the measurements, where `clocks` says that this is known: by the receivers' clock
        with ``emissions="known"``, by one whose offset and rate against it are unknown with ``emissions="constant"``.
    errors : {"auto", "symmetric", "one-sided"}
        How measurements are wrong that are wrong by more than noise: too long or too short alike, or nearly all too long, as where
        sound or radio comes by a detour, which does not go together with `receiver_delays`. With "auto" the latter is tried where no
        network fits, and said.
    distances : sequence of (receiver, receiver, metres, deviation), optional
        Known distances between receivers, by name or by index, such as taped ones or ranges between anchors: measurements beside the
        others, with their standard deviations in metres. For `estimate_speed` the deviation may be left out.
    estimate_speed : bool
        Whether the propagation speed is estimated from known distances and those between anchors.
    max_starts, agreeing : int, optional
        Most starts of the search (default 480), and how many must agree on the best network (default 10).

    Returns
    -------
    Calibration
        With `receivers`, `transmitters`, `offsets`, `covariance`, `inliers`, `residuals`, `unique`, `alternatives`, `warnings`,
        `dimensions`. Positions have d coordinates.

    Raises
    ------
    InputError
        If the input cannot be used: the message says why, and what to do.
    UndeterminedError
        If the measurements do not determine a network.
    KeyboardInterrupt
        On Ctrl-C; `partial` is the best network so far, an `Unfinished`, or None if there was none yet. With "auto" it is in
        the plane or in space, whichever the search was in.

    Examples
    --------
    >>> import tdoa
    >>> made = tdoa.simulate(noise=0.01, seed=1)
    >>> found = tdoa.calibrate(made.pseudoranges)
    >>> found.unique, found.receivers.shape
    (True, (8, 2))

    A room of 10 m x 10 m x 3 m:

    >>> made = tdoa.simulate(10, 20, dimensions=3, noise=0.01, seed=1)
    >>> found = tdoa.calibrate(made.pseudoranges)
    >>> found.dimensions, found.receivers.shape, found.covariance.shape
    (3, (10, 3), (10, 3, 3))

    Recorders of two channels that were started by themselves, with clocks that are apart by a hundred metres:

    >>> made = tdoa.simulate(10, 30, noise=0.01, delays=100, channels=2, seed=1)
    >>> recorders = [f"rec{i // 2 + 1}" for i in range(10)]
    >>> found = tdoa.calibrate(made.pseudoranges, clocks=tdoa.Clocks(receivers="offset"), recorders=recorders)
    >>> apart = made.clocks[2, 0] - made.clocks[0, 0]
    >>> [clock.recorder for clock in found.clocks], bool(abs(found.clocks[1].offset - apart) < 0.1)
    (['rec1', 'rec2', 'rec3', 'rec4', 'rec5'], True)
    """
    pseudoranges, recorders, clocks = heard(pseudoranges, recorders, clocks)
    given, single, factor = table(pseudoranges, names, sigma, speed)
    receivers, count = given["receivers"], len(given["values"])
    nodes = _nodes(given)
    rows = _anchors(anchors, nodes, count)
    d = _dimensions(dimensions, rows)
    exact, measured = _known(rows[:, : d or 3], anchor_sigma, nodes, count, anchors is not None)
    settings = {
        "dimensions": d,
        "sigma": single,
        "anchors": exact,
        "positions": measured,
        "distances": _distances(distances, receivers, count),
        **clock_settings(
            clocks, bool(ranges), text("receiver_delays", receiver_delays), recorders, nodes[:count], times, nodes[count:], factor
        ),
        "errors": text("errors", errors),
        "estimate_speed": bool(estimate_speed),
        "seed": seeded(seed),
        "max_starts": integer("max_starts", max_starts),
        "agreeing": integer("agreeing", agreeing),
    }
    arguments = given, settings, factor
    return call(_native.calibrate, *arguments, threads=threads, progress=progress, wrap=_calibrated)


def _distances(distances, names, count):
    names = names if names is not None else [f"r{i + 1}" for i in range(count)]

    def place(node):
        if isinstance(node, str):
            if node not in names:
                raise InputError(f"no receiver is named {node}; they are {', '.join(names[:8])}")
            return names.index(node)
        return integer("a receiver of distances", node, 0, count - 1)

    found = []
    for each in distances if distances is not None else ():
        try:
            first, second, metres, *deviation = each
            (deviation,) = deviation or (None,)
        except (TypeError, ValueError):
            raise InputError(f"distances must be (receiver, receiver, metres, deviation), not {each!r}") from None
        if deviation is not None:
            deviation = number("the deviation of a distance", deviation)
        found.append((place(first), place(second), number("a distance", metres), deviation))
    return found


class Unfinished(Result):
    """The best network so far of a calibration that was stopped: a longer search may find a better one.

    Attributes
    ----------
    receivers : ndarray of float, shape (m, d)
        Positions of the receivers in metres, in a frame of their own; NaN for those that the search had left for later.
    transmitters : ndarray of float, shape (n, d)
        Positions of the transmitters.
    offsets : ndarray of float, shape (n,)
        Offsets of the transmitters, metres.
    starts, agreeing : int
        How many starts of the search had ended, and how many of them in this network.
    """

    def __repr__(self):
        m, n = len(self.receivers), len(self.transmitters)
        return f"unfinished calibration of {m} receivers and {n} transmitters: {self.agreeing} of {self.starts} starts agree"


def _calibrated(found):
    return Unfinished(found) if isinstance(found, dict) else Calibration(found)


class Networks(Result):
    """Every network that explains a small table exactly, best first. Two are equal if all but `seconds` is, to the last bit.

    Attributes
    ----------
    receivers : ndarray of float, shape (k, m, d)
        Positions of the receivers of each network, metres.
    transmitters : ndarray of float, shape (k, n, d)
        Positions of the transmitters.
    offsets : ndarray of float, shape (k, n)
        Offsets of the transmitters.
    residuals : ndarray of float, shape (k,)
        Root mean square of the residuals, metres.
    physical : ndarray of bool, shape (k,)
        Whether no distance is negative.
    conditions : ndarray of float, shape (k,)
        Condition numbers: how much an error of the data may grow.
    counts : dict
        Roots: `complex`, `real`, `positive_definite` (with real positions), `physical`.
    paths : dict
        How the paths ended.
    proofs : dict or None
        What is proved of the complex roots, if that was asked for and the size is solved by paths: `roots` that were tested, of
        larger tables those of the part that is solved, `proved` to exist, `real` ones among these, and `unseparated`, pairs that
        are not proved different.
    summary : str
        The lines that `tdoa solve` prints above its table.
    dimensions : int
        d: 2 in the plane, 3 in space.
    configuration, solver : str
        The size of the table, and of what was solved of it.
    stopped_early : bool
        Whether the search was stopped at the first network that fits.
    warnings : list of str
        What makes the result doubtful.
    receiver_names, transmitter_names : list of str
        Names of the nodes.
    seconds : float
        How long the work took, without what Python adds.
    """

    def __len__(self):
        return len(self.residuals)

    def __repr__(self):
        return "\n".join([self.summary.rstrip("\n"), *(f"warning: {warning}" for warning in self.warnings)])


def solve(
    pseudoranges,
    *,
    speed=None,
    dimensions="auto",
    tolerance=None,
    start="stored",
    first_under=None,
    prove=False,
    ranges=False,
    emissions="unknown",
    names=None,
    threads=None,
    progress=True,
):
    """Find every network that explains pseudoranges without errors: 6r/3s, 4r/5s, 5r/4s and up, in space 10r/4s, 7r/5s, 6r/6s and up.

    Of ranges, 3r/3s and up, in space 6r/4s, 5r/5s, 4r/6s and up. Of ranges with one unknown constant, 4r/3s, 3r/4s and up, in space 7r/4s, 5r/5s, 4r/7s and up.

    Parameters
    ----------
    pseudoranges, speed, names, threads, progress
        As in `calibrate`; no measurement may be missing.
    dimensions : {"auto", 2, 3}
        2 for the plane, which is also what "auto" means, 3 for space.
    tolerance : float, optional
        How far below zero a distance may lie for a network to count as physical, and in space how large residuals may be without a
        warning, as a share of the size of the data. Default 1e-6.
    start : {"stored", "polyhedral"}
        Where paths start: at stored solutions of a generic instance, or, in the plane, at a start system computed for these data.
    first_under : float, optional
        Stops at the first physical network with a residual (metres) below this.
    prove : bool
        Proves by interval arithmetic that the complex roots at the ends of all paths exist and are distinct; see `Networks.proofs`.
    ranges : bool
        Whether the measurements are distances, such as two-way ranges or arrival times less known send times: transmitters have no
        offsets, and fewer nodes are enough. None may be negative.
    emissions : {"unknown", "constant", "known"}
        What is known of the times at which transmitters send: nothing, all but one constant that they share, such as the delay of a
        cable or an antenna, or all, for which `ranges` is short.

    Returns
    -------
    Networks
        With `receivers`, `transmitters`, `offsets`, `residuals`, `physical`.

    Raises
    ------
    UndeterminedError
        If the table is too small or incomplete, or nodes coincide.
    KeyboardInterrupt
        On Ctrl-C; `partial` is None.

    Examples
    --------
    >>> import tdoa
    >>> made = tdoa.simulate(6, 3, seed=2)
    >>> found = tdoa.solve(made.pseudoranges)
    >>> bool(found.residuals[0] < 1e-9), bool(found.physical[0])
    (True, True)
    """
    d = _plane_or_space(dimensions)
    given, _, _ = table(pseudoranges, names, None, speed)
    if ranges and emissions not in ("unknown", "known"):
        raise InputError(f"ranges are measurements with known emissions, not emissions={emissions!r}")
    asked = {
        "tolerance": number("tolerance", tolerance),
        "start": text("start", start),
        "first_under": number("first_under", first_under),
        "dimensions": d,
        "prove": bool(prove),
        "emissions": "known" if ranges else text("emissions", emissions),
    }
    return call(_native.solve_network, given, asked, threads=threads, progress=progress, wrap=Networks)


class Simulation(NamedTuple):
    """A random network and its measurements, metres.

    Attributes
    ----------
    pseudoranges : ndarray of float, shape (m, n)
        The measurements; NaN where one is missing.
    receivers, transmitters : ndarray of float, shapes (m, d) and (n, d)
        True positions, d = 2 in the plane and 3 in space.
    offsets : ndarray of float, shape (n,)
        True offsets.
    outliers : ndarray of bool, shape (m, n)
        Which measurements are outliers.
    clocks : ndarray of float, shape (m, 2)
        The clock of each receiver's recorder: its offset in metres, and its rate as a share.
    """

    pseudoranges: np.ndarray
    receivers: np.ndarray
    transmitters: np.ndarray
    offsets: np.ndarray
    outliers: np.ndarray
    clocks: np.ndarray


def simulate(
    receivers=8,
    transmitters=12,
    *,
    dimensions=None,
    layout="room",
    size=None,
    noise=0.0,
    outliers=0.0,
    outlier_size=10.0,
    missing=0.0,
    hearing=None,
    detours=0.0,
    detour_size=1.0,
    fault=None,
    delays=0.0,
    rates=0.0,
    channels=1,
    duration=None,
    ranges=False,
    emissions="unknown",
    seed=0,
):
    """A random network in the plane or in space and its measurements, the same for the same arguments on any machine.

    Parameters
    ----------
    receivers, transmitters : int
        Numbers of nodes.
    dimensions : {2, 3}, optional
        Whether the network is in the plane or in space; by default what `size` says, else the plane.
    layout : {"room", "chain", "grid", "normal"}
        Where they lie: anywhere in a room, receivers along a road or on a grid, or all coordinates and offsets standard normal.
    size : (float, float) or (float, float, float), optional
        Extent in x, y and in space z, metres. (10, 10) by default, in space (10, 10, 3).
    noise : float
        Standard deviation of the normal noise, metres.
    outliers, outlier_size : float
        Share of the measurements with a gross error, uniform in plus or minus this, metres.
    missing : float
        Share of the measurements that are missing.
    hearing : int, optional
        Each transmitter is heard by this many receivers, the nearest ones.
    detours, detour_size : float
        Share of the measurements that come by a detour, and its mean length, metres.
    fault : (str, float), optional
        An error of the first receiver: ("delay" or "drift" or "move", metres).
    delays, rates : float
        Standard deviations of the offsets of the recorders' clocks, metres, and of their rates, as a share: 1e-6 is one part in a
        million.
    channels : int
        Receivers that share a recorder: the first ones, the next ones, and so on.
    duration : float, optional
        Transmitters send at times that are uniform over this, metres: seconds times the speed. By default as the layout says.
    ranges : bool
        Whether distances are made: offsets are zero. Short for ``emissions="known"``.
    emissions : {"unknown", "constant", "known"}
        Whether transmitters have offsets of their own, one that they share, or none.
    seed : int
        Seed of the random numbers.

    Returns
    -------
    Simulation
    """
    try:
        size = None if size is None else [number("size", side) for side in size]
        kind = None if fault is None else (text("fault", fault[0]), number("fault", fault[1]))
    except (TypeError, ValueError, IndexError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("size must be two or three lengths, and fault a kind and a length") from None
    if size is not None and (len(size) not in (2, 3) or None in size):
        raise InputError("size must be two or three lengths")
    dimensions = integer("dimensions", dimensions, 2, 3)
    if dimensions is None:
        dimensions = 2 if size is None else len(size)
    elif size is not None and len(size) != dimensions:
        raise InputError(f"size has {len(size)} lengths, but dimensions is {dimensions}; change one of them, or leave out dimensions")
    wanted = {
        "receivers": integer("receivers", receivers),
        "transmitters": integer("transmitters", transmitters),
        "dimensions": dimensions,
        "layout": text("layout", layout),
        "size": size,
        "noise": number("noise", noise),
        "outliers": number("outliers", outliers),
        "outlier_size": number("outlier_size", outlier_size),
        "missing": number("missing", missing),
        "hearing": integer("hearing", hearing),
        "detours": number("detours", detours),
        "detour_size": number("detour_size", detour_size),
        "fault": kind,
        "delays": number("delays", delays),
        "rates": number("rates", rates),
        "channels": integer("channels", channels),
        "duration": number("duration", duration),
        "emissions": Clocks(emissions="known" if ranges and emissions == "unknown" else emissions).emissions,
        "seed": seeded(seed),
    }
    if ranges and wanted["emissions"] != "known":
        raise InputError(f'ranges=True is short for emissions="known", and emissions is {emissions!r}: leave one of both out')
    optional = ("size", "hearing", "fault", "duration")
    missing_ones = [name for name, value in wanted.items() if value is None and name not in optional]
    if missing_ones:
        raise InputError(f"{missing_ones[0]} must be a number, not None")
    return Simulation(**_native.simulate(wanted))


def cramer_rao(receivers, transmitters, sigma, *, used=None):
    """The Cramer-Rao bound: how near to the truth any unbiased estimate of the receivers can come.

    Parameters
    ----------
    receivers, transmitters : array_like of float, shapes (m, 2) and (n, 2)
        True positions in metres.
    sigma : float
        Standard deviation of the measurements in metres.
    used : array_like of bool, shape (m, n), optional
        Which measurements there are; all by default.

    Returns
    -------
    float
        Root mean square over the receivers of the smallest standard deviation, metres, after the best rigid alignment;
        infinite if the measurements do not determine every receiver.
    """
    receivers = real_matrix("receivers", receivers)
    transmitters = real_matrix("transmitters", transmitters)
    _native.check_size(len(receivers), len(transmitters))
    shape = len(receivers), len(transmitters)
    try:
        used = np.ones(shape, bool) if used is None else np.asarray(used)
        if used.dtype.kind not in "bui":
            raise InputError(f"used must be true or false, not {used.dtype}")
        used = used.astype(bool)
    except ValueError as error:
        raise error if isinstance(error, InputError) else InputError(f"used: {error}") from None
    sigma = number("sigma", sigma)
    if sigma is None:
        raise InputError("sigma must be a number, not None")
    return _native.cramer_rao(receivers, transmitters, used, sigma)


for _public in (Networks, Simulation, Unfinished, calibrate, solve, simulate, cramer_rao):
    _public.__module__ = "tdoa"
del _public

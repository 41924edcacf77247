"""Measurements: tables of pseudoranges, with names."""

import os
import re
import sys

import numpy as np

from hc import InputError, _native
from hc._result import Result
from hc._run import came, number, text

# The largest file that is read, bytes.
_MOST = 512_000_000


class Pseudoranges(Result):
    """A table of pseudoranges with names, as `read` gives it; `calibrate` and `solve` take it as it is.

    Attributes
    ----------
    values : ndarray of float, shape (m, n)
        Pseudoranges in metres, receivers in rows, transmitters in columns; NaN where nothing was measured.
    sigmas : ndarray of float, shape (m, n), or None
        Their standard deviations in metres.
    weights : ndarray of float, shape (m, n), or None
        One over the squares of their standard deviations, in any unit, where these are known but for a factor, which `calibrate`
        estimates, or `sigma` says for the median weight. A weight of zero leaves a cell out.
    candidates : ndarray of float, shape (m, n, k), or None
        Further candidates for the values, metres, where a detector found several and cannot tell which is right; NaN where a cell
        has no more. `calibrate` picks one of each cell.
    receiver_names, transmitter_names : list of str, or None
        Names of the nodes.
    """

    def __init__(self, values, *, sigmas=None, receiver_names=None, transmitter_names=None, candidates=None, weights=None):
        self.values = real_matrix("pseudoranges", values)
        self.sigmas = None if sigmas is None else real_matrix("sigmas", sigmas)
        self.weights = None if weights is None else real_matrix("weights", weights)
        if weights is not None and self.weights.shape != self.values.shape:
            raise InputError(f"weights must have the shape of the pseudoranges, {self.values.shape}, not {self.weights.shape}")
        if sigmas is not None and weights is not None:
            raise InputError("sigmas and weights say twice how sure the measurements are; leave one out")
        self.candidates = None if candidates is None else _layers(candidates, self.values.shape)
        self.receiver_names = strings("receiver_names", receiver_names)
        self.transmitter_names = strings("transmitter_names", transmitter_names)

    @property
    def shape(self):
        """Numbers of receivers and transmitters."""
        return self.values.shape

    def __array__(self, dtype=None, copy=None):
        array = self.values if dtype is None else self.values.astype(dtype)
        return array.copy() if copy else array

    def __repr__(self):
        m, n = self.shape
        heard = int(np.isfinite(self.values).sum())
        return f"pseudoranges of {m} receivers and {n} transmitters, {heard} of {m * n} measured"


def strings(name, given):
    """A list of names, or None."""
    if given is None:
        return None
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise InputError(f"{name} must be a list of names, not {given!r}")
    return [str(each) for each in given]


def real_matrix(name, values):
    """A matrix of doubles, however it lies in memory; sizes are checked before anything is copied."""
    try:
        array = np.asarray(values)
        if array.ndim != 2:
            raise InputError(f"{name} must be a matrix, receivers in rows and transmitters in columns, not {came(array)}")
        _native.check_size(*array.shape)
        if array.dtype.kind == "O":
            array = np.array([[np.nan if cell is None else cell for cell in row] for row in array], dtype=float)
            array = array.reshape(np.shape(values))
        if array.dtype.kind not in "biuf":
            raise InputError(f"{name} must be real numbers, not {array.dtype}")
        # Rust reads aligned numbers alone.
        array = np.require(array.astype(float, copy=False), requirements="A")
        if np.ma.is_masked(values):
            # What is masked was not measured.
            array = np.where(np.ma.getmaskarray(values), np.nan, array)
        return array
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} must be a matrix of numbers: {error}") from None


def _layers(candidates, shape):
    """Further candidates of a table of this shape, one behind the other along the last axis."""
    try:
        array = np.require(np.asarray(candidates, dtype=float), requirements="A")
    except (TypeError, ValueError) as error:
        raise InputError(f"candidates must be numbers: {error}") from None
    if array.ndim != 3 or array.shape[:2] != shape:
        raise InputError(f"candidates must have the shape {(*shape, 'k')}, with k further ones of each cell, not {array.shape}")
    return array


def _long(frame, factor):
    """The pseudoranges of a frame of one measurement a row, read as the program reads such a list; None if it is no list."""
    if any(name is not None for name in frame.index.names):
        frame = frame.reset_index()
    headings = [str(heading) for heading in frame.columns]
    if not _native.heads_list(headings):
        return None
    _native.check_size(len(frame), 1)
    data = frame.to_csv(index=False).encode()
    units = (None, None) if factor is None else ("s", factor)
    try:
        return _pseudoranges(_native.read("DataFrame", data, *units, None, None, False, [], None, False))
    except InputError as error:
        # Their unit is told in another way here.
        words = re.sub(r"give --units \w+ --speed V", "give speed=V and the times in seconds", str(error))
        raise InputError(words) from None


def _is_file(thing):
    return isinstance(thing, (str, bytes, os.PathLike)) or hasattr(thing, "read")


def table(pseudoranges, names=None, sigma=None, speed=None):
    """What the extension module takes for measurements; the single standard deviation and the speed, if there are these."""
    if _is_file(pseudoranges):
        is_path = isinstance(pseudoranges, (str, os.PathLike))
        given = repr(os.fspath(pseudoranges)) if is_path else "file"
        raise InputError(f"pseudoranges must be a table, not a file; read it first: tdoa.read({given}), with the units of its numbers")
    receivers = transmitters = sigmas = weights = candidates = None
    factor = None
    if speed is not None:
        factor = number("speed", speed)
        if not (factor > 0 and factor < float("inf")):
            raise InputError(f"speed must be positive and finite, not {factor}")
    in_metres = factor
    pandas = sys.modules.get("pandas")
    is_frame = pandas is not None and isinstance(pseudoranges, pandas.DataFrame)
    if is_frame and (measured := _long(pseudoranges, factor)) is not None:
        pseudoranges, in_metres = measured, None
    if isinstance(pseudoranges, Pseudoranges):
        values, candidates = pseudoranges.values, pseudoranges.candidates
        sigmas, weights = pseudoranges.sigmas, pseudoranges.weights
        receivers, transmitters = pseudoranges.receiver_names, pseudoranges.transmitter_names
    elif is_frame:
        frame = pseudoranges
        # The numbers that pandas gives to rows and columns are no names.
        if not isinstance(frame.index, pandas.RangeIndex):
            receivers = [str(name) for name in frame.index]
        if not isinstance(frame.columns, pandas.RangeIndex):
            transmitters = [str(name) for name in frame.columns]
        try:
            values = frame.to_numpy(dtype=float, na_value=np.nan)
        except (TypeError, ValueError) as error:
            raise InputError(f"pseudoranges must be numbers: {error}") from None
    else:
        values = pseudoranges
    values = real_matrix("pseudoranges", values)
    if names is not None:
        if isinstance(names, dict):
            unknown = set(names) - {"receivers", "transmitters"}
            if unknown:
                raise InputError(f"names must have the keys receivers and transmitters, not {sorted(map(str, unknown))}")
            pair = names.get("receivers"), names.get("transmitters")
        elif isinstance(names, tuple) and len(names) == 2 and not isinstance(names[0], str):
            pair = names
        else:
            pair = names, None
        receivers = strings("names", pair[0]) if pair[0] is not None else receivers
        transmitters = strings("names", pair[1]) if pair[1] is not None else transmitters
    single = None
    if sigma is not None:
        if isinstance(sigma, (str, bytes)) or not hasattr(sigma, "__iter__") or getattr(sigma, "ndim", 1) == 0:
            single = number("sigma", sigma)
        else:
            sigmas = real_matrix("sigma", sigma)
            if sigmas.shape != values.shape:
                raise InputError(f"sigma must have the shape of the pseudoranges, {values.shape}, not {sigmas.shape}")
            weights = None
    given = {
        "values": values,
        "sigmas": sigmas,
        "weights": weights,
        "candidates": candidates,
        "receivers": receivers,
        "transmitters": transmitters,
        "factor": in_metres,
    }
    return given, single, factor


def read(path, *, units=None, speed=None, rate=None, variable=None, transpose=False, columns=None, decimal_mark=None, candidates=False):
    """Read pseudoranges from a file: CSV (a matrix or a list of measurements), .npy or .mat.

    Parameters
    ----------
    path : str, os.PathLike or open file
        The file. What an open file holds is known by the ending of its `name`, and CSV if it has none.
    units : {"m", "cm", "km", "s", "ms", "us", "ns", "samples"}, optional
        Unit of the numbers. Metres by default, but a table headed by times is then refused.
    speed : float, optional
        Propagation speed in metres a second, for times; sound in air: 343, radio: 299792458.
    rate : float, optional
        Samples a second, for samples.
    variable : str, optional
        The matrix to read of a .mat file, where that is not z.
    transpose : bool
        Whether the rows of a matrix are the transmitters.
    columns : dict, optional
        What columns hold whose headings do not say it: headings by "receiver", "transmitter", "value", "time", "candidate", "sigma", "reference"
        (each line is the time of the receiver minus that of the reference) or "ignore" (which may have a list of headings).
    decimal_mark : {".", ","}, optional
        What stands before decimals; the other mark may stand between thousands. As the numbers have it by default.
    candidates : bool
        Whether several lines of a list for one receiver and transmitter are candidates, of which `calibrate` picks one. Columns
        value2, value3, ... are candidates without it.

    Returns
    -------
    Pseudoranges

    Raises
    ------
    FileNotFoundError
        If there is no such file; other errors of the system likewise.
    InputError
        If the file cannot be used: with file, line, column and what to do.
    """
    if units is None and (speed is not None or rate is not None):
        raise InputError("speed and rate need units: s, ms, us or samples")
    units = None if units is None else text("units", units)
    variable = None if variable is None else text("variable", variable)
    if decimal_mark not in (None, ".", ","):
        raise InputError(f"decimal_mark must be '.' or ',', not {decimal_mark!r}")
    more = bool(transpose), _headings(columns), decimal_mark, bool(candidates)
    data = None
    if hasattr(path, "read"):
        path, data = _contents(path)
    else:
        try:
            path = os.fsdecode(path)
            # Errors of the system are Python's own.
            with open(path, "rb"):
                pass
        except (TypeError, ValueError):
            raise InputError(f"path must be a path or an open file, not {path!r}") from None
    return _pseudoranges(_native.read(path, data, units, number("speed", speed), number("rate", rate), variable, *more))


def arrivals(text, speed):
    """The pseudoranges of a list of arrival times in seconds."""
    return _pseudoranges(_native.read("what was heard", text.encode(), "s", speed, None, None, False, [], None, False))


def _headings(columns):
    """Pairs of a role and a heading."""
    if columns is None:
        return []
    if not isinstance(columns, dict):
        raise InputError(f"columns must be a dict of headings, not {columns!r}")
    pairs = []
    for role, headings in columns.items():
        for heading in [headings] if isinstance(headings, str) else headings:
            pairs.append((text("columns", role), text("columns", heading)))
    return pairs


def _contents(file):
    """The name of an open file, and what is in it from where it stands."""
    name = getattr(file, "name", None)
    name = name if isinstance(name, str) and name else "open file"
    data = file.read(_MOST + 1)
    data = data.encode() if isinstance(data, str) else data
    if not isinstance(data, bytes):
        raise InputError(f"{name}: reading gives {type(data).__name__}, not bytes or text")
    return name, data


def _pseudoranges(found):
    """The class of a dict of its attributes."""
    return Pseudoranges(found.pop("values"), **found)


Pseudoranges.__module__ = read.__module__ = "tdoa"

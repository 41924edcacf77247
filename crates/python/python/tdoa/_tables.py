"""Measurements: tables of pseudoranges, with names."""

import os
import sys

import numpy as np

from hc import InputError, _native
from hc._run import number, text


class Pseudoranges:
    """A table of pseudoranges with names, as `read` gives it; `calibrate` and `solve` take it as it is.

    Attributes
    ----------
    values : ndarray of float, shape (m, n)
        Pseudoranges in metres, receivers in rows, transmitters in columns; NaN where nothing was measured.
    sigmas : ndarray of float, shape (m, n), or None
        Their standard deviations in metres.
    receiver_names, transmitter_names : list of str, or None
        Names of the nodes.
    """

    def __init__(self, values, *, sigmas=None, receiver_names=None, transmitter_names=None):
        self.values = real_matrix("pseudoranges", values)
        self.sigmas = None if sigmas is None else real_matrix("sigmas", sigmas)
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
            raise InputError(
                f"{name} must be a matrix, receivers in rows and transmitters in columns, not an array of {array.ndim} axes"
            )
        _native.check_size(*array.shape)
        if array.dtype.kind == "O":
            array = np.array([[np.nan if cell is None else cell for cell in row] for row in array], dtype=float)
            array = array.reshape(np.shape(values))
        if array.dtype.kind not in "biuf":
            raise InputError(f"{name} must be real numbers, not {array.dtype}")
        array = array.astype(float, copy=False)
        if np.ma.is_masked(values):
            # What is masked was not measured.
            array = np.where(np.ma.getmaskarray(values), np.nan, array)
        return array
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} must be a matrix of numbers: {error}") from None


def table(pseudoranges, names=None, sigma=None, speed=None):
    """What the extension module takes for measurements, and the single standard deviation, if there is one."""
    receivers = transmitters = sigmas = None
    pandas = sys.modules.get("pandas")
    if pandas is not None and isinstance(pseudoranges, pandas.DataFrame):
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
    elif isinstance(pseudoranges, Pseudoranges):
        values, sigmas = pseudoranges.values, pseudoranges.sigmas
        receivers, transmitters = pseudoranges.receiver_names, pseudoranges.transmitter_names
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
    factor = None
    if speed is not None:
        factor = number("speed", speed)
        if not (factor > 0 and factor < float("inf")):
            raise InputError(f"speed must be positive and finite, not {factor}")
    single = None
    if sigma is not None:
        if isinstance(sigma, (str, bytes)) or not hasattr(sigma, "__iter__") or getattr(sigma, "ndim", 1) == 0:
            single = number("sigma", sigma)
        else:
            sigmas = real_matrix("sigma", sigma)
            if sigmas.shape != values.shape:
                raise InputError(f"sigma must have the shape of the pseudoranges, {values.shape}, not {sigmas.shape}")
    given = {
        "values": values,
        "sigmas": sigmas,
        "receivers": receivers,
        "transmitters": transmitters,
        "factor": factor,
    }
    return given, single


def read(path, *, units=None, speed=None, rate=None, variable=None):
    """Read pseudoranges from a file: CSV (a matrix or a list of measurements), .npy or .mat.

    Parameters
    ----------
    path : path
        The file.
    units : {"m", "s", "ms", "us", "samples"}, optional
        Unit of the numbers. Metres by default, but a table headed by times is then refused.
    speed : float, optional
        Propagation speed in metres a second, for all units but metres; sound in air: 343, radio: 299792458.
    rate : float, optional
        Samples a second, for samples.
    variable : str, optional
        The matrix to read of a .mat file, where that is not z.

    Returns
    -------
    Pseudoranges

    Raises
    ------
    InputError
        With file, line, column and what to do.
    """
    if units is None and (speed is not None or rate is not None):
        raise InputError("speed and rate need units: s, ms, us or samples")
    units = None if units is None else text("units", units)
    variable = None if variable is None else text("variable", variable)
    try:
        path = os.fsdecode(path)
    except TypeError:
        raise InputError(f"path must be a path, not {path!r}") from None
    return _pseudoranges(_native.read(path, units, number("speed", speed), number("rate", rate), variable))


def _pseudoranges(found):
    """The class of a dict of its attributes."""
    return Pseudoranges(found.pop("values"), **found)


Pseudoranges.__module__ = read.__module__ = "tdoa"

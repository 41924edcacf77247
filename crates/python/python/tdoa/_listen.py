"""Recordings: the sounds in them, and when each channel hears them."""

import json
import os
import tempfile
from pathlib import Path

import numpy as np

from hc import InputError, _native
from hc._run import call, integer, number

from ._clocks import Clocks
from ._tables import arrivals


class Heard:
    """What was heard in recordings; `calibrate` takes it as it is.

    Attributes
    ----------
    pseudoranges : Pseudoranges
        The arrival times as lengths in metres, with weights: receivers are channels, transmitters are sounds.
    recorders : list of str or None
        The recorder of each receiver, where several were started apart; times are those of its clock.
    warnings : list of str
        What may be wrong: silent, clipped or doubled channels, recorders that cannot be aligned, sounds that were left out.
    speed : float
        The speed of sound, metres a second.
    data : dict
        Everything: `survey` and `names` of the channels, `events`, `arrivals` by event and channel with `seconds`, `sigma` and
        `alternatives`, `alignment` of recorders.
    """

    def __init__(self, text, speed):
        self._text = text
        self.data = json.loads(text)
        self.speed = speed
        self.warnings = self.data["warnings"]
        self.pseudoranges = arrivals(self.data["list"], speed) if self.data["arrivals"] else None
        self.recorders = None
        if len(set(self.data["recorders"])) > 1 and self.pseudoranges is not None:
            by_channel = dict(zip(self.data["names"], self.data["recorder_names"]))
            self.recorders = [by_channel[name] for name in self.pseudoranges.receiver_names]

    def to_dataframe(self):
        """The arrivals as a pandas.DataFrame, one a row: `receiver`, `event`, `seconds`, `sigma`, `recorder`."""
        try:
            import pandas
        except ImportError:
            raise InputError("to_dataframe needs pandas: pip install pandas") from None
        rows = [
            (name, j + 1, arrival["seconds"], arrival["sigma"], recorder)
            for j, event in enumerate(self.data["arrivals"])
            for name, recorder, arrival in zip(self.data["names"], self.data["recorder_names"], event)
            if arrival is not None
        ]
        return pandas.DataFrame(rows, columns=["receiver", "event", "seconds", "sigma", "recorder"])

    def __repr__(self):
        return self.data["counts"]


def listen(
    recordings,
    *,
    rate=None,
    apart=False,
    speed=None,
    temperature=None,
    template=None,
    chirp=None,
    band=None,
    extent=30.0,
    threshold=None,
    least_channels=4,
    threads=None,
    progress=True,
):
    """Find the claps, chirps or other short sounds in recordings, and when each channel hears them.

    Parameters
    ----------
    recordings : path, sequence of paths, or array_like of shape (channels, samples)
        WAV or FLAC files of one recorder, which began together; or samples, with their `rate`.
    rate : int, optional
        Samples a second of an array.
    apart : bool
        Whether each recording is of a recorder that was started by itself, with a clock of its own; a sequence of files among
        the recordings is then one recorder. Of arrays, a sequence of them.
    speed, temperature : float, optional
        The speed of sound in metres a second, or the temperature of the air in degrees Celsius that tells it; 343 m/s by default.
    template : path, optional
        A recording of the sound, such as what a loudspeaker was given. Claps and other short sounds by default.
    chirp : (float, float, float), optional
        The sound is a chirp from one frequency to another in this time, Hz and seconds.
    band : (float, float), optional
        Frequencies that are listened to, Hz; 500 to 10,000 by default.
    extent : float
        Greatest distance of two microphones, metres.
    threshold : float, optional
        How much a sound must be above the noise, dB of amplitude in the band; 12 by default.
    least_channels : int
        How many channels must hear a sound.
    threads : int, optional
        Threads; all cores by default. The result does not depend on it.
    progress : bool or callable
        As in `calibrate`.

    Returns
    -------
    Heard
        With `pseudoranges`, `recorders`, `warnings`.

    Raises
    ------
    hc.InputError
        If a file is no recording, or is damaged, or an option is out of range.

    Examples
    --------
    >>> import numpy as np, tdoa
    >>> noise = np.random.default_rng(1).normal(size=(4, 96_000))
    >>> recording = 1e-3 * noise
    >>> recording[:, 48_000:48_400] += noise[0, :400]
    >>> heard = tdoa.listen(recording, rate=48_000)
    >>> heard.pseudoranges.shape
    (4, 1)
    """
    if speed is not None and temperature is not None:
        raise InputError("speed and temperature both tell the speed of sound: give one")
    celsius = number("temperature", temperature)
    if celsius is not None and not -80 <= celsius <= 80:
        raise InputError(f"temperature must be from -80 to 80 degrees Celsius, not {celsius}")
    metres = number("speed", speed) if celsius is None else _native.speed_of_sound(celsius)
    metres = 343.0 if metres is None else metres
    if template is not None and chirp is not None:
        raise InputError("template and chirp both tell the sound: give one")
    settings = {
        "speed": metres,
        "extent": number("extent", extent),
        "band": _numbers("band", band, 2),
        "threshold": number("threshold", threshold),
        "least_channels": integer("least_channels", least_channels),
        "chirp": _numbers("chirp", chirp, 3),
        "template": None if template is None else _path(template),
    }
    with tempfile.TemporaryDirectory() as folder:
        recorders = _recorders(recordings, rate, apart, folder)
        return call(
            _native.listen, recorders, settings, threads=threads, progress=progress, wrap=lambda text: Heard(text, metres)
        )


def _numbers(name, given, count):
    if given is None:
        return None
    try:
        numbers = [float(each) for each in given]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != count:
        raise InputError(f"{name} must be {count} numbers, not {given!r}")
    return numbers


def _is_path(thing):
    return isinstance(thing, (str, bytes, os.PathLike))


def _path(path):
    if not _is_path(path):
        raise InputError(f"a recording must be a path, not {path!r}")
    path = os.fsdecode(path)
    # Errors of the system are Python's own.
    with open(path, "rb"):
        pass
    return path


def _recorders(recordings, rate, apart, folder):
    """The files of each recorder; arrays are written into the folder."""
    if _is_path(recordings):
        recordings = [recordings]
    if rate is not None:
        arrays = list(recordings) if apart else [recordings]
        return [[_written(samples, rate, Path(folder) / f"rec{k + 1}.wav")] for k, samples in enumerate(arrays)]
    try:
        given = list(recordings)
    except TypeError:
        raise InputError(f"recordings must be paths, or an array with its rate, not {recordings!r}") from None
    if given and not _is_path(given[0]) and hasattr(given[0], "dtype"):
        raise InputError("an array of samples needs its rate, in samples a second")
    if not apart:
        return [[_path(path) for path in given]]
    return [[_path(path)] if _is_path(path) else [_path(each) for each in path] for path in given]


def _written(samples, rate, path):
    """The path of a recording of these samples."""
    try:
        array = np.asarray(samples)
        scale = 1.0
        if array.dtype.kind == "i":
            # Whole numbers are parts of full scale, as in files of them.
            scale = 2.0 ** (1 - 8 * array.dtype.itemsize)
        array = np.require(np.atleast_2d(array.astype(np.float32) * np.float32(scale)), requirements="A")
    except (TypeError, ValueError) as error:
        raise InputError(f"samples must be numbers, a row a channel: {error}") from None
    if array.ndim != 2:
        raise InputError(f"samples must have the shape (channels, samples), not {array.shape}")
    hertz = integer("rate", rate, 1, 10_000_000)
    _native.write_recording(str(path), array, hertz)
    return str(path)


def heard(given, recorders, clocks):
    """Measurements, recorders and clocks of what is to be calibrated: those of what was heard, where it was."""
    if not isinstance(given, Heard):
        return given, recorders, clocks
    if given.pseudoranges is None:
        raise InputError(f"no sound was heard by enough channels: {given!r}")
    if given.recorders is not None and recorders is None:
        recorders = given.recorders
        clocks = Clocks(receivers="rate") if clocks is None else clocks
    return given.pseudoranges, recorders, clocks


Heard.__module__ = listen.__module__ = "tdoa"

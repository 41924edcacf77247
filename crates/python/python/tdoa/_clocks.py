"""What is unknown of the clocks of transmitters and recorders."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from hc import InputError
from hc._run import number

_CHOICES = {"emissions": ("unknown", "constant", "known"), "receivers": ("common", "offset", "rate")}


@dataclass(frozen=True, kw_only=True)
class Clocks:
    """What is unknown of the clocks of transmitters and recorders. A measurement is
    ``|r_i - s_j| + o_j + a_d + b_d t_ij``, with the time t_ij by the recorder d of receiver i.

    Attributes
    ----------
    emissions : {"unknown", "constant", "known"}
        What is known of the times at which transmitters send: nothing, so that each has an offset o_j; all but one constant that
        they share, such as the delay of a cable or an antenna; or all, so that measurements are distances.
    receivers : {"common", "offset", "rate"}
        What the clocks of receivers do: all share one; each recorder was started by itself, with an unknown offset a_d; or its
        clock has an unknown rate b_d too, and measurements are readings of that clock.
    offset_sigma, rate_sigma : float, optional
        Standard deviations of the offsets about their mean, metres, and of the rates about theirs, as a share (20e-6 for common
        quartz crystals), where something is known of them.
    """

    emissions: str = "unknown"
    receivers: str = "common"
    offset_sigma: float | None = None
    rate_sigma: float | None = None

    def __post_init__(self):
        for name, choices in _CHOICES.items():
            given = getattr(self, name)
            if given not in choices:
                raise InputError(f"{name} of Clocks must be {', '.join(choices[:-1])} or {choices[-1]}, not {given!r}")
        for name in ("offset_sigma", "rate_sigma"):
            number(f"{name} of Clocks", getattr(self, name))


class RecorderClock(NamedTuple):
    """The clock of a recorder against that of the first one; where send times are known, its offset is against these.

    A rate that all recorders have in common cannot be told from the propagation speed, nor an offset of all from the send times
    where these are unknown.

    Attributes
    ----------
    recorder : str
        Its name; that of its receiver where no recorders were given.
    offset, offset_std : float
        By how much its readings are larger, metres, with the standard deviation; None where the measurements do not determine it.
    rate, rate_std : float
        By how much its clock is faster, as a share: 1e-6 is one part in a million. None where rates are the same.
    at : float
        The reading at which the offset is told, metres: the middle of its own. None where rates are the same.
    """

    recorder: str
    offset: float
    offset_std: float | None
    rate: float | None
    rate_std: float | None
    at: float | None


def settings(clocks, ranges, receiver_delays, recorders, receivers, times, transmitters, factor):
    """The settings of a calibration of these nodes, by name, that clocks are part of; `factor` makes metres of times."""
    clocks = Clocks() if clocks is None else clocks
    if not isinstance(clocks, Clocks):
        raise InputError(f"clocks must be tdoa.Clocks(emissions=..., receivers=...), not {clocks!r}")
    if ranges and clocks.emissions == "constant":
        raise InputError('ranges=True is short for Clocks(emissions="known"), and clocks says "constant": leave one of both out')
    apart = receiver_delays == "all"
    if apart and (clocks.receivers != "common" or recorders is not None):
        raise InputError(
            'receiver_delays="all" is short for Clocks(receivers="offset") with a recorder for each receiver: give one of both'
        )
    if recorders is not None and clocks.receivers == "common":
        raise InputError('recorders have clocks of their own: give clocks=tdoa.Clocks(receivers="offset") or "rate" too')
    emissions = "known" if ranges else clocks.emissions
    if times is not None and emissions == "unknown":
        raise InputError('times are when transmitters send: give clocks=tdoa.Clocks(emissions="known") or "constant" too')
    return {
        "receiver_delays": "none" if apart else receiver_delays,
        "emissions": emissions,
        "emission_times": _times(times, transmitters, 1.0 if factor is None else factor),
        "receiver_clocks": "offset" if apart else clocks.receivers,
        "offset_sigma": number("offset_sigma", clocks.offset_sigma),
        "rate_sigma": number("rate_sigma", clocks.rate_sigma),
        "recorders": list(receivers) if apart else recorders_of(recorders, receivers),
    }


def _times(given, transmitters, factor):
    """When each transmitter sends, metres."""
    if given is None:
        return None
    if isinstance(given, Mapping):
        odd = [name for name in given if name not in transmitters] + [name for name in transmitters if name not in given]
        if odd:
            raise InputError(f"times must have one of each transmitter, and no others: look at {odd[0]}")
        given = [given[name] for name in transmitters]
    try:
        times = [float(time) for time in given]
    except (TypeError, ValueError):
        raise InputError("times must be a number for each transmitter, or a dict from transmitters to numbers") from None
    if len(times) != len(transmitters):
        raise InputError(f"times has {len(times)} numbers for {len(transmitters)} transmitters; give one for each")
    return [factor * time for time in times]


def recorders_of(given, receivers):
    """The recorder of each receiver."""
    if given is None:
        return None
    if isinstance(given, dict):
        unknown = [name for name in given if name not in receivers]
        if unknown:
            raise InputError(f"no receiver is named {unknown[0]}; they are {', '.join(receivers[:8])}")
        return [str(given.get(name, name)) for name in receivers]
    if isinstance(given, str):
        raise InputError("recorders must be a name for each receiver, or a dict from receivers to recorders")
    try:
        names = [str(name) for name in given]
    except TypeError:
        raise InputError("recorders must be a name for each receiver, or a dict from receivers to recorders") from None
    if len(names) != len(receivers):
        raise InputError(f"recorders has {len(names)} names for {len(receivers)} receivers; give one for each")
    return names


for _class in (Clocks, RecorderClock):
    _class.__module__ = "tdoa"
del _class

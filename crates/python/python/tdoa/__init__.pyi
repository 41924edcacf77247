"""Self-calibration of sensor networks from arrival times alone."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from hc import Error, InputError, InternalError, UndeterminedError
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Alternative",
    "Calibration",
    "Clocks",
    "Error",
    "Heard",
    "InputError",
    "InternalError",
    "Networks",
    "Place",
    "Pseudoranges",
    "RecorderClock",
    "Simulation",
    "UndeterminedError",
    "Unfinished",
    "calibrate",
    "cramer_rao",
    "listen",
    "read",
    "simulate",
    "solve",
]

_Floats = NDArray[np.float64]
_Progress = bool | Callable[[str, int, int], object]
_Path = str | os.PathLike[str]

__version__: str

# A pandas.DataFrame, which need not be installed.
class _Frame(Protocol):
    @property
    def columns(self) -> Any: ...
    @property
    def index(self) -> Any: ...
    def to_numpy(self) -> Any: ...

# An open file.
class _File(Protocol):
    def read(self, size: int, /) -> str | bytes: ...

_Table = NDArray[Any] | Sequence[Sequence[float | None]] | _Frame | Pseudoranges
_Units = Literal["m", "cm", "km", "s", "ms", "us", "ns", "samples"]
_Names = Sequence[str] | tuple[Sequence[str] | None, Sequence[str] | None] | Mapping[str, Sequence[str]]

class Pseudoranges:
    values: _Floats
    sigmas: _Floats | None
    weights: _Floats | None
    candidates: _Floats | None
    receiver_names: list[str] | None
    transmitter_names: list[str] | None
    def __init__(
        self,
        values: ArrayLike,
        *,
        sigmas: ArrayLike | None = None,
        receiver_names: Iterable[str] | None = None,
        transmitter_names: Iterable[str] | None = None,
        candidates: ArrayLike | None = None,
        weights: ArrayLike | None = None,
    ) -> None: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...

class Heard:
    pseudoranges: Pseudoranges | None
    recorders: list[str] | None
    warnings: list[str]
    speed: float
    data: dict[str, Any]
    def __init__(self, text: str, speed: float) -> None: ...
    # A DataFrame of pandas, which need not be installed.
    def to_dataframe(self) -> Any: ...

def listen(
    recordings: _Path | bytes | Iterable[_Path | bytes | Iterable[_Path]] | ArrayLike,
    *,
    rate: int | None = None,
    apart: bool = False,
    speed: float | None = None,
    temperature: float | None = None,
    template: _Path | None = None,
    chirp: Sequence[float] | None = None,
    band: Sequence[float] | None = None,
    extent: float = 30.0,
    threshold: float | None = None,
    least_channels: int = 4,
    threads: int | None = None,
    progress: _Progress = True,
) -> Heard: ...

class Unfinished:
    receivers: _Floats
    transmitters: _Floats
    offsets: _Floats
    starts: int
    agreeing: int
    def __init__(self, found: dict[str, Any]) -> None: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@dataclass(frozen=True, kw_only=True)
class Clocks:
    emissions: Literal["unknown", "constant", "known"] = "unknown"
    receivers: Literal["common", "offset", "rate"] = "common"
    offset_sigma: float | None = None
    rate_sigma: float | None = None
    def __post_init__(self) -> None: ...

class RecorderClock(NamedTuple):
    recorder: str
    offset: float
    offset_std: float | None
    rate: float | None
    rate_std: float | None
    at: float | None

class Place:
    transmitter: str
    heard: int
    problem: str | None
    position: _Floats
    position_std: _Floats
    covariance: _Floats
    offset: float
    offset_std: float
    outliers: list[str]
    redundancy: int
    residual_rms: float
    fits: bool
    unique: bool
    others: list[dict[str, Any]]
    def __init__(self, data: dict[str, Any], dimensions: int) -> None: ...

class Alternative:
    receivers: _Floats
    transmitters: _Floats
    offsets: _Floats
    residual: float
    log_likelihood_loss: float
    receiver_error: dict[str, Any] | None
    def __init__(self, data: dict[str, Any], dimensions: int = 2) -> None: ...

class Calibration:
    data: dict[str, Any]
    receiver_names: list[str]
    transmitter_names: list[str]
    mirror_images: list[dict[str, Any]]
    warnings: list[str]
    unique: bool
    sigma: float
    gauge: str
    dimensions: int
    dimension_test: dict[str, float | None] | None
    systematic: dict[str, Any] | None
    def __init__(self, text: str) -> None: ...
    @classmethod
    def from_json(cls, text: str) -> Calibration: ...
    @property
    def receivers(self) -> _Floats: ...
    @property
    def transmitters(self) -> _Floats: ...
    @property
    def offsets(self) -> _Floats: ...
    @property
    def covariance(self) -> _Floats: ...
    @property
    def transmitter_covariance(self) -> _Floats: ...
    @property
    def systematic_covariance(self) -> _Floats: ...
    @property
    def systematic_transmitter_covariance(self) -> _Floats: ...
    @property
    def offset_std(self) -> _Floats: ...
    @property
    def inliers(self) -> NDArray[np.bool_]: ...
    @property
    def residuals(self) -> _Floats: ...
    @property
    def alternatives(self) -> list[Alternative]: ...
    @property
    def clocks(self) -> list[RecorderClock]: ...
    @property
    def trusted(self) -> bool: ...
    @property
    def truth(self) -> dict[str, Any] | None: ...
    def compared(
        self,
        receivers: ArrayLike | Mapping[str, ArrayLike],
        transmitters: ArrayLike | Mapping[str, ArrayLike] | None = None,
    ) -> Calibration: ...
    def locate(
        self,
        pseudoranges: _Table | Heard,
        *,
        sigma: ArrayLike | None = None,
        speed: float | None = None,
        names: _Names | None = None,
        recorders: Iterable[str] | Mapping[str, str] | None = None,
    ) -> list[Place]: ...
    # A DataFrame of pandas and an Axes of matplotlib, which need not be installed.
    def to_dataframe(self) -> Any: ...
    def plot(self, ax: Any = None, *, names: bool = True, view: Literal["xy", "xz", "yz", "3d"] = "xy") -> Any: ...
    def to_json(self) -> str: ...
    def to_svg(self) -> str: ...
    def save_html(self, path: _Path) -> None: ...
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __reduce__(self) -> tuple[Any, ...]: ...

class Networks:
    receivers: _Floats
    transmitters: _Floats
    offsets: _Floats
    residuals: _Floats
    physical: NDArray[np.bool_]
    conditions: _Floats
    counts: dict[str, int]
    paths: dict[str, int]
    proofs: dict[str, int] | None
    summary: str
    dimensions: int
    configuration: str
    solver: str
    stopped_early: bool
    seconds: float
    warnings: list[str]
    receiver_names: list[str]
    transmitter_names: list[str]
    def __init__(self, found: dict[str, Any]) -> None: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __len__(self) -> int: ...

class Simulation(NamedTuple):
    pseudoranges: _Floats
    receivers: _Floats
    transmitters: _Floats
    offsets: _Floats
    outliers: NDArray[np.bool_]
    clocks: _Floats

def calibrate(
    pseudoranges: _Table | Heard,
    *,
    sigma: ArrayLike | None = None,
    speed: float | None = None,
    dimensions: Literal["auto", 2, 3] = "auto",
    anchors: ArrayLike | Mapping[str, ArrayLike] | None = None,
    anchor_sigma: ArrayLike | Mapping[str, float] | None = None,
    names: _Names | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: _Progress = True,
    receiver_delays: Literal["none", "auto", "all"] = "none",
    ranges: bool = False,
    clocks: Clocks | None = None,
    recorders: Iterable[str] | Mapping[str, str] | None = None,
    times: ArrayLike | Mapping[str, float] | None = None,
    errors: Literal["auto", "symmetric", "one-sided"] = "auto",
    distances: Iterable[tuple[str | int, str | int, float] | tuple[str | int, str | int, float, float]] | None = None,
    estimate_speed: bool = False,
    max_starts: int | None = None,
    agreeing: int | None = None,
) -> Calibration: ...
def solve(
    pseudoranges: _Table,
    *,
    speed: float | None = None,
    dimensions: Literal["auto", 2, 3] = "auto",
    tolerance: float | None = None,
    start: Literal["stored", "polyhedral"] = "stored",
    first_under: float | None = None,
    prove: bool = False,
    ranges: bool = False,
    emissions: Literal["unknown", "constant", "known"] = "unknown",
    names: _Names | None = None,
    threads: int | None = None,
    progress: _Progress = True,
) -> Networks: ...
def simulate(
    receivers: int = 8,
    transmitters: int = 12,
    *,
    dimensions: Literal[2, 3] | None = None,
    layout: Literal["room", "chain", "grid", "normal"] = "room",
    size: tuple[float, float] | tuple[float, float, float] | None = None,
    noise: float = 0.0,
    outliers: float = 0.0,
    outlier_size: float = 10.0,
    missing: float = 0.0,
    hearing: int | None = None,
    detours: float = 0.0,
    detour_size: float = 1.0,
    fault: tuple[Literal["delay", "drift", "move"], float] | None = None,
    delays: float = 0.0,
    rates: float = 0.0,
    channels: int = 1,
    duration: float | None = None,
    ranges: bool = False,
    emissions: Literal["unknown", "constant", "known"] = "unknown",
    seed: int = 0,
) -> Simulation: ...
def cramer_rao(
    receivers: ArrayLike, transmitters: ArrayLike, sigma: float, *, used: ArrayLike | None = None
) -> float: ...
def read(
    path: _Path | _File,
    *,
    units: _Units | None = None,
    speed: float | None = None,
    rate: float | None = None,
    variable: str | None = None,
    transpose: bool = False,
    columns: Mapping[str, str | Sequence[str]] | None = None,
    decimal_mark: Literal[".", ","] | None = None,
    candidates: bool = False,
) -> Pseudoranges: ...

"""The extension module: what the modules beside it call."""

from collections.abc import Callable
from typing import Any, TypedDict, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "FORMAT",
    "Family",
    "Fibre",
    "__version__",
    "calibrate",
    "calibration_compared",
    "calibration_html",
    "calibration_located",
    "calibration_nodes",
    "calibration_style",
    "calibration_summary",
    "calibration_svg",
    "certify",
    "check_size",
    "cramer_rao",
    "decompose",
    "heads_list",
    "listen",
    "mixed_volume",
    "read",
    "simulate",
    "solve",
    "solve_network",
    "speed_of_sound",
    "write_recording",
]

class _How(TypedDict):
    threads: int | None
    progress: Callable[[str, int, int], object] | None

FORMAT: int
__version__: str

_System = tuple[str | list[str], list[str] | None]
_Found = dict[str, Any]

def solve(system: _System, settings: _Found, how: _How) -> _Found: ...
def decompose(system: _System, seed: int, max_paths: int | None, how: _How) -> _Found: ...
def mixed_volume(system: _System, how: _How) -> int: ...
def certify(system: _System, points: NDArray[np.complex128], how: _How) -> _Found: ...
def calibrate(table: _Found, settings: _Found, speed: float | None, how: _How) -> str: ...
def calibration_compared(
    json: str, receivers: list[list[float] | None], transmitters: list[list[float] | None], keeps_frame: bool
) -> str: ...
def calibration_html(json: str) -> str: ...
def calibration_located(json: str, table: _Found, sigma: float | None, recorders: list[str] | None) -> str: ...
def calibration_nodes(json: str) -> str: ...
def calibration_style(json: str) -> tuple[str, float, bool]: ...
def calibration_summary(json: str) -> str: ...
def calibration_svg(json: str) -> str: ...
def solve_network(table: _Found, asked: _Found, how: _How) -> _Found: ...
def simulate(wanted: _Found) -> _Found: ...
def cramer_rao(
    receivers: NDArray[np.float64], transmitters: NDArray[np.float64], used: NDArray[np.bool_], sigma: float
) -> float: ...
def listen(recorders: list[list[str]], settings: _Found, how: _How) -> str: ...
def speed_of_sound(celsius: float) -> float: ...
def write_recording(path: str, samples: NDArray[np.float32], rate: int) -> None: ...
def check_size(receivers: int, transmitters: int) -> None: ...
def heads_list(headings: list[str]) -> bool: ...
def read(
    path: str,
    data: bytes | None,
    units: str | None,
    speed: float | None,
    rate: float | None,
    variable: str | None,
    transpose: bool,
    columns: list[tuple[str, str]],
    decimal_mark: str | None,
    candidates: bool,
) -> _Found: ...
@final
class Fibre: ...

@final
class Family:
    @staticmethod
    def from_text(text: str) -> Family: ...
    @staticmethod
    def from_formulas(
        unknowns: list[str],
        parameters: list[str],
        equations: list[str],
        nonzero: list[str],
        symmetry: list[list[str]],
        roots: int | None,
        name: str,
    ) -> Family: ...
    def describe(self) -> tuple[str, list[str], list[str], int | None]: ...
    def fibre(self, json: str) -> Fibre: ...
    def monodromy(
        self,
        seed: int,
        roots: int | None,
        patience: int | None,
        trace: bool,
        only_component: bool,
        group: int,
        up_to_symmetry: bool,
        first: Fibre | None,
        how: _How,
    ) -> _Found: ...
    def track(
        self,
        fibre: Fibre,
        targets: NDArray[np.complex128],
        certify: bool,
        up_to_symmetry: bool,
        effort: tuple[float, float | None],
        how: _How,
    ) -> _Found: ...

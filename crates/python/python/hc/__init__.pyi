"""Polynomial systems by homotopy continuation."""

import enum
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Certificates",
    "Compiled",
    "Component",
    "Decomposition",
    "End",
    "Error",
    "Family",
    "Fibre",
    "InputError",
    "InternalError",
    "Solutions",
    "Tracked",
    "UndeterminedError",
    "Unresolved",
    "certify",
    "decompose",
    "mixed_volume",
    "solve",
]

__version__: str

# An expression of SymPy, which need not be installed.
class _Expression(Protocol):
    @property
    def free_symbols(self) -> Any: ...

_Formula = str | float | _Expression
# One expression has no order, a matrix of SymPy no `__iter__`.
_System = str | _Expression | Iterable[_Formula]
# Names or symbols; a string has blanks or commas between them.
_Names = str | Iterable[Any]
_Start = Literal["auto", "polyhedral", "multihomogeneous", "total_degree", "total-degree"]
_Progress = bool | Callable[[str, int, int], object]
_Path = str | os.PathLike[str]

class Error(Exception): ...
class InputError(Error, ValueError): ...
class UndeterminedError(Error, RuntimeError): ...
class InternalError(Error, RuntimeError): ...

class Unresolved(NamedTuple):
    value: NDArray[np.complex128]
    paths: int
    reason: str

class _Result:
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]

class _Points(_Result):
    points: NDArray[np.complex128]
    is_real: NDArray[np.bool_]
    summary: str
    @property
    def real_points(self) -> NDArray[np.float64]: ...
    @property
    def n_real(self) -> int: ...
    def _repr_html_(self) -> str: ...

class Solutions(_Points):
    variables: list[str]
    multiplicities: NDArray[np.int64]
    winding_numbers: NDArray[np.int64]
    singular: NDArray[np.bool_]
    residuals: NDArray[np.float64]
    conditions: NDArray[np.float64]
    certified: NDArray[np.bool_] | None
    paths: dict[str, int]
    component_points: NDArray[np.complex128]
    directions: list[tuple[list[int], int, int]]
    unresolved: list[Unresolved]
    start: str | None
    start_systems: int
    mixed_volume: int | None
    bezout_number: int | None
    multihomogeneous_number: int | None
    partial: bool
    limited: str | None
    warnings: list[str]
    seed: int
    seconds: float
    def __init__(self, found: dict[str, Any], shown: dict[str, str] | None = None) -> None: ...
    @property
    def complete(self) -> bool: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[NDArray[np.complex128]]: ...
    def __getitem__(self, which: Any) -> Any: ...
    def to_json(self) -> str: ...

class Component(NamedTuple):
    dimension: int
    degree: int
    multiplicity: int
    irreducible: bool
    witness_points: NDArray[np.complex128]

class Decomposition(_Points):
    variables: list[str]
    components: list[Component]
    multiplicities: NDArray[np.int64]
    singular: NDArray[np.bool_]
    unresolved: list[Unresolved]
    unsearched: list[int]
    failed: int
    partial: bool
    seed: int
    seconds: float
    def __init__(self, found: dict[str, Any], shown: dict[str, str] | None = None) -> None: ...
    @property
    def complete(self) -> bool: ...
    def to_json(self) -> str: ...

class Certificates(_Result):
    points: NDArray[np.complex128]
    boxes: NDArray[np.float64]
    certified: NDArray[np.bool_]
    reality: NDArray[np.int8]
    duplicate_of: NDArray[np.int64]
    unseparated: NDArray[np.int64]
    reasons: list[str | None]
    n_distinct: int
    n_real: int
    def __init__(self, found: dict[str, Any]) -> None: ...
    @property
    def is_real(self) -> NDArray[np.bool_]: ...
    @property
    def real_points(self) -> NDArray[np.float64]: ...
    @property
    def complete(self) -> bool: ...
    def __len__(self) -> int: ...

class End(enum.IntEnum):
    FINITE = 0
    SINGULAR = 1
    AT_INFINITY = 2
    ON_COMPONENT = 3
    FAILED = 4
    IMAGE = 5

class Tracked(_Result):
    points: NDArray[np.complex128]
    ends: NDArray[np.int8]
    is_real: NDArray[np.bool_]
    uncertified: NDArray[np.int64]
    seconds: float
    def __init__(self, found: dict[str, Any]) -> None: ...
    @property
    def complete(self) -> NDArray[np.bool_]: ...
    @property
    def real_points(self) -> list[NDArray[np.float64]]: ...
    @property
    def n_real(self) -> NDArray[np.int64]: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[NDArray[np.complex128]]: ...
    def __getitem__(self, k: int) -> NDArray[np.complex128]: ...

class Fibre:
    parameters: NDArray[np.complex128]
    points: NDArray[np.complex128]
    represents: list[int]
    trace_test: float | None
    stopped: str
    orbits: list[int]
    others: str
    multiple: list[tuple[NDArray[np.complex128], int]]
    monodromy_group: dict[str, Any] | None
    def __init__(self, text: str) -> None: ...
    @property
    def roots(self) -> int: ...
    @property
    def complete(self) -> bool: ...
    def to_json(self) -> str: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __reduce__(self) -> tuple[Any, ...]: ...

class Compiled:
    def __init__(self, family: Family, fibre: Fibre) -> None: ...
    @property
    def roots(self) -> int: ...
    def __call__(
        self,
        targets: ArrayLike,
        *,
        certify: bool = False,
        up_to_symmetry: bool = False,
        again: float = 1.0,
        time_limit: float | None = None,
        threads: int | None = None,
        progress: _Progress = True,
    ) -> Tracked: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

class Family:
    name: str
    unknowns: list[str]
    parameters: list[str]
    roots: int | None
    fibre: Fibre | None
    def __init__(
        self,
        equations: _System,
        unknowns: _Names | None = None,
        parameters: _Names | None = None,
        *,
        nonzero: Iterable[_Formula] = (),
        symmetry: Iterable[Iterable[_Formula]] = (),
        roots: int | None = None,
        name: str = "",
    ) -> None: ...
    @classmethod
    def read(cls, path: _Path, start: _Path | None = None) -> Family: ...
    def monodromy(
        self,
        *,
        seed: int = 0,
        first: Fibre | tuple[ArrayLike, ArrayLike] | None = None,
        roots: int | None = None,
        patience: int | None = None,
        trace: bool = True,
        only_component: bool = False,
        group: int = 0,
        up_to_symmetry: bool = False,
        threads: int | None = None,
        progress: _Progress = True,
    ) -> Fibre: ...
    def compile(self, fibre: Fibre | None = None) -> Compiled: ...
    def track(
        self,
        targets: ArrayLike,
        *,
        fibre: Fibre | None = None,
        certify: bool = False,
        up_to_symmetry: bool = False,
        again: float = 1.0,
        time_limit: float | None = None,
        threads: int | None = None,
        progress: _Progress = True,
    ) -> Tracked: ...
    def __getstate__(self) -> object: ...
    def __setstate__(self, state: tuple[Any, ...]) -> None: ...

def solve(
    system: _System,
    *,
    variables: _Names | None = None,
    seed: int = 0,
    start: _Start = "auto",
    groups: Sequence[_Names] | None = None,
    torus_only: bool = False,
    max_paths: int | None = None,
    certify: bool = False,
    threads: int | None = None,
    progress: _Progress = True,
) -> Solutions: ...
def decompose(
    system: _System,
    *,
    variables: _Names | None = None,
    seed: int = 0,
    max_paths: int = 1_000_000,
    threads: int | None = None,
    progress: _Progress = True,
) -> Decomposition: ...
def mixed_volume(
    system: _System,
    *,
    variables: _Names | None = None,
    threads: int | None = None,
    progress: _Progress = True,
) -> int: ...
def certify(
    system: _System,
    points: ArrayLike | Solutions,
    *,
    variables: _Names | None = None,
    threads: int | None = None,
    progress: _Progress = True,
) -> Certificates: ...

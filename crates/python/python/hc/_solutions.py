"""What a solve has found."""

import json
from typing import Any, NamedTuple

import numpy as np

from ._native import FORMAT
from ._numbers import counted
from ._result import Points, Result
from ._symbols import own_names


class Unresolved(NamedTuple):
    """An end of paths of which it is not known what it is: `value` (ndarray of shape (n,)), the number of `paths` that end there, and the `reason`."""

    value: Any
    paths: int
    reason: str


class Solutions(Points):
    """The isolated solutions of a system, regular ones first; equal if all but `seconds` is, to the last bit.

    Attributes
    ----------
    variables : list of str
        Names of the unknowns.
    points : ndarray of complex, shape (k, n)
        The solutions, one a row, coordinates in the order of `variables`.
    multiplicities : ndarray of int, shape (k,)
        Multiplicities: the dimension of the local ring of the given equations. As many paths end at each, or more where there
        are more equations than unknowns.
    winding_numbers : ndarray of int, shape (k,)
        The largest winding number of these paths.
    singular : ndarray of bool, shape (k,)
        Whether the Jacobian is singular there, to working precision.
    is_real : ndarray of bool, shape (k,)
        Which solutions are real: all imaginary parts are below 1e-10 of the largest coordinate (or of one), 1e-7 where
        singular.
    residuals : ndarray of float, shape (k,)
        Largest relative residuals.
    conditions : ndarray of float, shape (k,)
        Condition numbers of the scaled Jacobians.
    certified : ndarray of bool, shape (k,), or None
        Which solutions are proved to exist; None where that was not asked for.
    paths : dict
        How the paths ended: `tracked`, `finite`, `at_infinity`, `failed`, `on_components`, `excess` and so on.
    component_points : ndarray of complex, shape (c, n)
        Points on components of positive dimension.
    unresolved : list of Unresolved
        Ends of paths near which the equations nearly vanish, but that could not be judged; their paths count as failed.
    directions : list of tuple
        Valuations, denominator and number of the paths that went to infinity.
    start : str or None
        The start system that was used.
    mixed_volume, bezout_number, multihomogeneous_number : int or None
        Numbers of paths of start systems, where they were needed.
    partial : bool
        Whether the work was interrupted: the list is then not whole.
    limited : str or None
        The limit for whose sake failed paths were not tracked again: `again` or `time`.
    warnings : list of str
        What a reader of the list must know.
    seed : int
        Seed of everything random.
    seconds : float
        How long the work took, without what Python adds.
    """

    def __init__(self, found, shown=None):
        super().__init__(found)
        if shown:
            self.variables = [shown.get(name, name) for name in self.variables]
            self.summary = own_names(self.summary, shown)
        self.unresolved = [Unresolved(*end) for end in self.unresolved]

    @property
    def complete(self):
        """Whether the list is whole: no path lost, no interrupt, no regular solution without the certificate that was asked for."""
        proved = self.certified is None or bool(np.all(self.certified | self.singular))
        return self.paths["failed"] == 0 and not self.partial and proved

    def __len__(self):
        return len(self.points)

    def __iter__(self):
        return iter(self.points)

    def __getitem__(self, which):
        return self.points[which]

    def to_json(self):
        """The solutions as JSON text, in the form that `hc solve --json` writes."""
        rows = []
        for k, value in enumerate(_pairs(self.points)):
            rows.append(
                {
                    "value": value,
                    "multiplicity": int(self.multiplicities[k]),
                    "winding_number": int(self.winding_numbers[k]),
                    "singular": bool(self.singular[k]),
                    "is_real": bool(self.is_real[k]),
                    "residual": _finite(self.residuals[k]),
                    "condition": _finite(self.conditions[k]),
                    "certified": None if self.certified is None else bool(self.certified[k]),
                }
            )
        counts = dict(self.paths)
        components, excess = counts.pop("on_components"), counts.pop("excess")
        keys = ("valuations", "denominator", "paths")
        whole = {
            "format": FORMAT,
            "variables": self.variables,
            "seed": self.seed,
            "start": self.start,
            "mixed_volume": self.mixed_volume,
            "bezout_number": self.bezout_number,
            "multihomogeneous_number": self.multihomogeneous_number,
            "paths": counts,
            "on_components": components,
            "component_points": _pairs(self.component_points),
            "excess": excess,
            "directions": [dict(zip(keys, direction)) for direction in self.directions],
            "start_systems": self.start_systems,
            "partial": self.partial,
            "limited": self.limited,
            "solutions": rows,
            "unresolved": [
                {"value": _pairs(end.value), "paths": end.paths, "reason": end.reason} for end in self.unresolved
            ],
        }
        return json.dumps(whole, indent=2) + "\n"


class Certificates(Result):
    """What is proved of points.

    Attributes
    ----------
    points : ndarray of complex, shape (k, n)
        The middles of the boxes, or the points as given where nothing is proved.
    boxes : ndarray of float, shape (k, n, 2, 2)
        Lower and upper bounds of the real (index 0) and of the imaginary part (index 1) of each coordinate; exactly one
        solution lies within. NaN where nothing is proved.
    certified : ndarray of bool, shape (k,)
        Which points are proved to stand for a solution.
    reality : ndarray of int, shape (k,)
        1 proved real, 0 proved not real, -1 neither.
    duplicate_of : ndarray of int, shape (k,)
        An earlier point that stands for the same solution, or -1.
    unseparated : ndarray of int, shape (p, 2)
        Pairs of points proved neither the same solution nor different ones.
    reasons : list
        Why there is no certificate; None where there is one.
    n_distinct, n_real : int
        Numbers of distinct solutions, and of those of them that are proved real.
    """

    @property
    def is_real(self):
        """Which points are proved to stand for a real solution, ndarray of bool of shape (k,)."""
        return self.reality == 1

    @property
    def real_points(self):
        """The points that are proved to stand for real solutions, ndarray of float of shape (r, n)."""
        return self.points[self.is_real].real.copy()

    @property
    def complete(self):
        """Whether all points are certified and told apart."""
        return bool(np.all(self.certified)) and len(self.unseparated) == 0

    def __len__(self):
        return len(self.points)

    def __repr__(self):
        return (
            f"{int(self.certified.sum())} of {counted(len(self), 'point')} certified: "
            f"{counted(self.n_distinct, 'distinct solution')}, {self.n_real} of them proved real"
        )


def _pairs(values):
    """Complex numbers as pairs of their parts."""
    return np.stack([values.real, values.imag], axis=-1).tolist()


def _finite(value):
    value = float(value)
    return value if np.isfinite(value) else None


for _class in (Solutions, Certificates, Unresolved):
    _class.__module__ = "hc"
del _class

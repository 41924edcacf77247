"""Solution sets of positive dimension."""

import json
from typing import Any, NamedTuple

import numpy as np

from . import _native
from ._result import Points
from ._run import call, integer, seeded
from ._solutions import Unresolved
from ._solve import read_system
from ._symbols import own_names
from ._system import system as _system


class Component(NamedTuple):
    """A component of positive dimension.

    Attributes
    ----------
    dimension : int
        Its dimension, at least one.
    degree : int
        The number of its points in as many general hyperplanes as its dimension.
    multiplicity : int
        The multiplicity of these points there: one for a reduced component.
    irreducible : bool
        Whether it is shown to be one irreducible component; if not, it may be several together, or a part of one.
    witness_points : ndarray of complex, shape (degree, n)
        The points, one a row.
    """

    dimension: int
    degree: int
    multiplicity: int
    irreducible: bool
    witness_points: Any


class Decomposition(Points):
    """All solutions of a system: components of positive dimension, and isolated solutions.

    Attributes
    ----------
    variables : list of str
        Names of the unknowns.
    components : list of Component
        Components of positive dimension, higher dimensions first.
    points : ndarray of complex, shape (k, n)
        The isolated solutions, one a row.
    multiplicities : ndarray of int, shape (k,)
        Their multiplicities.
    singular : ndarray of bool, shape (k,)
        Whether the Jacobian is singular there.
    is_real : ndarray of bool, shape (k,)
        Which isolated solutions are real, as in `Solutions`.
    unresolved : list of Unresolved
        Ends of paths that could not be judged, in all dimensions.
    unsearched : list of int
        Dimensions that were not searched, because this would take more paths than are allowed.
    failed : int
        Lost paths, witness points that do not fit together, and dimensions that were not searched: if there are any,
        something may be missing.
    partial : bool
        Whether the work was interrupted.
    seed : int
        Seed of everything random.
    seconds : float
        How long the work took, without what Python adds.
    """

    def __init__(self, found, shown=None):
        super().__init__({"summary": found["summary"], "seconds": found["seconds"], "_text": found["json"]})
        data = json.loads(self._text)
        shown = shown or {}
        self.variables = [shown.get(name, name) for name in data["variables"]]
        self.summary = own_names(self.summary, shown)
        isolated, n = data["isolated"], len(self.variables)
        self.components = [
            Component(*(each[name] for name in Component._fields[:4]), _points(each["witness_points"], n))
            for each in data["components"]
        ]
        self.points = _points([each["value"] for each in isolated], n)
        self.multiplicities = np.array([each["multiplicity"] for each in isolated], dtype=np.int64)
        self.singular = np.array([each["singular"] for each in isolated], dtype=bool)
        self.is_real = np.array([each["is_real"] for each in isolated], dtype=bool)
        self.unresolved = [
            Unresolved(_points([each["value"]], n)[0], each["paths"], each["reason"]) for each in data["unresolved"]
        ]
        self.unsearched, self.failed = data["unsearched"], data["failed"]
        self.partial, self.seed = data["partial"], data["seed"]

    @property
    def complete(self):
        """Whether nothing may be missing, and every component is shown to be irreducible."""
        return self.failed == 0 and not self.partial and all(each.irreducible for each in self.components)

    def to_json(self):
        """The decomposition as JSON text, in the form that `hc decompose --json` writes, without the seconds."""
        return self._text


def _points(rows, n):
    """Points from pairs of real and imaginary parts; zeros keep their signs."""
    return np.array(rows, dtype=float).reshape(len(rows), n, 2).view(complex)[..., 0]


def decompose(system, *, variables=None, seed=0, max_paths=1_000_000, threads=None, progress=True):
    """Find all solutions of a system: components of positive dimension with degrees and multiplicities, and isolated ones.

    Parameters
    ----------
    system, variables, threads, progress
        As in `solve`; there may be fewer equations than unknowns.
    seed : int
        Seed of the hyperplanes and of the generic coefficients.
    max_paths : int
        Paths at most in all dimensions together; dimensions that need more are not searched.

    Returns
    -------
    Decomposition
        With `components` and, for the isolated solutions, `points`, `real_points`, `multiplicities`.

    Raises
    ------
    InputError
        If the system cannot be read or solved: the message says why.
    KeyboardInterrupt
        On Ctrl-C, with what was found so far as `partial`.

    Examples
    --------
    >>> import hc
    >>> found = hc.decompose(["x*(y - 1)", "x*(x - 2)"])
    >>> [(each.dimension, each.degree) for each in found.components], found.real_points.round(9).tolist()
    ([(1, 1)], [[2.0, 1.0]])
    """
    system, variables, symbols = read_system(system, variables)

    def wrap(found):
        return Decomposition(found, symbols.shown)

    with symbols.in_errors():
        arguments = _system(system, variables, symbols), seeded(seed), integer("max_paths", max_paths, 0, 2**64 - 1)
        return call(_native.decompose, *arguments, threads=threads, progress=progress, wrap=wrap)


for _class in (Component, Decomposition, decompose):
    _class.__module__ = "hc"
del _class

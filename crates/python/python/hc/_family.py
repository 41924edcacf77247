"""Families with parameters: solutions for one parameter point, tracked to thousands of others."""

import enum
import json
import os

import numpy as np

from . import _native
from ._errors import InputError
from ._numbers import counted
from ._run import call, integer, number, seeded
from ._result import Result
from ._solve import complex_rows
from ._symbols import Symbols, listed
from ._system import formulas, names, split


class End(enum.IntEnum):
    """How a slot of a target's solutions was filled; `IMAGE` is for the images of a listed solution under the symmetry."""

    FINITE = 0
    SINGULAR = 1
    AT_INFINITY = 2
    ON_COMPONENT = 3
    FAILED = 4
    IMAGE = 5


class Tracked(Result):
    """Solutions of a family for many targets: `tracked[k]` has those of one, iteration those of each.

    Attributes
    ----------
    points : ndarray of complex, shape (k, roots, n)
        The solutions for each target; NaN where a slot has none. A singular solution fills as many slots as it counts.
        Those that listed ones stand for, where `up_to_symmetry` was asked for, are `IMAGE` in `ends`, and NaN.
    ends : ndarray of int8, shape (k, roots)
        How each slot was filled, an `End`.
    is_real : ndarray of bool, shape (k, roots)
        Which slots hold a real solution: all imaginary parts are below 1e-10 of the largest coordinate (or of one), 1e-7 where
        singular.
    uncertified : ndarray of int, shape (k,)
        Regular solutions that could not be certified, where that was asked for.
    seconds : float
        How long the work took, without what Python adds.
    """

    @property
    def complete(self):
        """Which targets have all their solutions: ndarray of bool, shape (k,)."""
        return ~np.any(self.ends == End.FAILED, axis=1) & (self.uncertified == 0)

    @property
    def real_points(self):
        """The real solutions for each target: list of ndarrays of float of shapes (n_real[k], n)."""
        return [points[real].real.copy() for points, real in zip(self.points, self.is_real)]

    @property
    def n_real(self):
        """How many solutions are real, for each target: ndarray of int, shape (k,)."""
        return self.is_real.sum(axis=1)

    def __len__(self):
        return len(self.points)

    def __getitem__(self, k):
        """The solutions for one target: ndarray of complex, shape (s, n)."""
        return self.points[k][self.ends[k] <= End.SINGULAR]

    def __iter__(self):
        return (self[k] for k in range(len(self)))

    def __repr__(self):
        counts = {end: int((self.ends == end).sum()) for end in End}
        ends = ", ".join(f"{count} {end.name.lower().replace('_', ' ')}" for end, count in counts.items() if count)
        words = f"{counted(len(self), 'target')} of {counted(self.ends.shape[1], 'root')}: {ends or 'no ends'}"
        lost, unproved = len(self) - int(self.complete.sum()), int(self.uncertified.sum())
        words += f"; {counted(lost, 'target')} incomplete" if lost else "; all complete"
        return words + (f"; {counted(unproved, 'solution')} without certificate" if unproved else "")


class Fibre:
    """All solutions of a family for one generic parameter point.

    Attributes
    ----------
    parameters : ndarray of complex, shape (p,)
        The parameter point.
    points : ndarray of complex, shape (roots, n)
        The solutions; one of each orbit where `up_to_symmetry` was asked for.
    represents : list of int
        For how many solutions each of these points stands, where they are listed up to symmetry; otherwise empty.
    trace_test : float or None
        Deviation found by the trace test: rounding error shows that the orbits of the solutions are whole.
    stopped : str
        Why the search ended: `roots reached`, `trace` (the trace test has passed, and a start system has led to no other
        solution), `start system` (that alone), `orbits whole` (the trace test alone), `component whole` (no other orbit was
        sought), `no progress`, `too many solutions` or `interrupted`.
    orbits : list of int
        The sizes of the orbits, largest first: solutions that loops in the parameters have joined.
    others : str
        How other orbits are excluded: `roots`, `start system`, `not excluded` or `not sought`.
    multiple : list of (ndarray of complex, shape (n,), int)
        Solutions that are multiple for all parameters, with their multiplicities; they are not among the points.
    monodromy_group : dict or None
        What loops tell of the monodromy group, if `monodromy` was asked for it by `group`: the numbers of `loops` and of
        those that are `whole`, `generators` (solution `k`, from 0, goes to `generators[j][k]`), `orbits`, `blocks` (for each
        orbit its minimal systems of blocks, `None` where these were not sought, among more than 2,000 solutions) and `symmetric` (whether these generate all permutations). Further loops could
        add to it.
    """

    def __init__(self, text):
        self._text = text
        try:
            data = json.loads(text)
            pairs = np.array(data["parameters"], dtype=float).reshape(-1, 2)
            rows = np.array(data["solutions"], dtype=float)
            rows = rows.reshape(len(data["solutions"]), -1, 2)
        except (TypeError, ValueError, KeyError) as error:
            raise InputError(f"not a start file: {error}") from None
        self.parameters = pairs[:, 0] + 1j * pairs[:, 1]
        # No arithmetic: zeros keep their signs.
        self.points = rows.view(complex)[..., 0]
        self.parameters = pairs.view(complex)[..., 0]
        self.represents = data.get("represents", [])
        self.trace_test = data.get("trace_test")
        self.stopped = data.get("stopped", "")
        self.orbits = data.get("orbits", [])
        self.others = data.get("others", "")
        self.multiple = [
            (np.array(each["value"], dtype=float).view(complex)[..., 0], each["multiplicity"]) for each in data.get("multiple", [])
        ]
        self.monodromy_group = data.get("monodromy_group")

    @property
    def roots(self):
        """Number of solutions, with those that listed ones stand for."""
        return sum(self.represents) if self.represents else len(self)

    @property
    def complete(self):
        """Whether it is known that these are all regular solutions: by their number, or by a start system."""
        return self.stopped in ("roots reached", "trace", "start system")

    def to_json(self):
        """The text of a start file, as `hc monodromy` writes it."""
        return self._text

    def __len__(self):
        return len(self.points)

    def __repr__(self):
        trace = "" if self.trace_test is None else f", trace test {self.trace_test:.1e}"
        listed = f" ({len(self)} up to symmetry)" if self.represents else ""
        return f"{counted(self.roots, 'solution')}{listed}; stopped: {self.stopped}{trace}"

    def __eq__(self, other):
        return isinstance(other, Fibre) and self._text == other._text

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self):
        return Fibre, (self._text,)


class Compiled:
    """A family with its solutions for one parameter point, ready for targets: call it with an array of them.

    Made by `Family.compile`; it is pickled as what it was made of.
    """

    def __init__(self, family, fibre):
        self._family = family
        self._fibre = fibre
        self._native = family._native.fibre(fibre.to_json())

    @property
    def roots(self):
        """Number of solutions that are tracked to each target."""
        return self._fibre.roots

    def __call__(self, targets, *, certify=False, up_to_symmetry=False, again=1.0, time_limit=None, threads=None, progress=True):
        """Track all solutions to each target: see `Family.track`."""
        rows = complex_rows("targets", targets)
        parameters = self._family.parameters
        if rows.shape[1] != len(parameters):
            raise InputError(f"targets must have a column for each of {', '.join(parameters) or 'no parameters'}, not shape {rows.shape}")
        return call(
            self._family._native.track,
            self._native,
            rows,
            bool(certify),
            bool(up_to_symmetry),
            (number("again", again), number("time_limit", time_limit)),
            threads=threads,
            progress=progress,
            wrap=Tracked,
        )

    def __repr__(self):
        return f"{self._family!r}, compiled"

    def __reduce__(self):
        return Compiled, (self._family, self._fibre)


class Family:
    """A system with parameters: solved once, then tracked to as many parameter points as there are.

    Parameters
    ----------
    equations : str, or sequence of str or SymPy expressions
        At least as many equations as unknowns, which have solutions for generic parameters; or one text with everything:
        plain, with a line `parameters: a b`, or TOML. If there are more than unknowns, combinations are tracked, and each
        solution is checked against all equations.
    unknowns : sequence of str or symbols, optional
        By default all names in SymPy expressions that are no parameters, sorted by name.
    parameters : sequence of str or symbols, optional
        Names of the parameters.
    nonzero : sequence of str or SymPy expressions
        Factors that must not vanish at a solution.
    symmetry : sequence of sequences of str or SymPy expressions
        Maps that take solutions to solutions for the same parameters, one formula an unknown: one solution of each orbit
        is tracked.
    roots : int, optional
        The number of solutions for generic parameters, if it is known: it ends the search for them.
    name : str
        A name.

    Attributes
    ----------
    fibre : Fibre or None
        All solutions for one parameter point, once `monodromy` has found them; it can be set.

    Examples
    --------
    >>> import hc, numpy as np
    >>> family = hc.Family(["x^2 + y^2 - r^2", "y - a*x"], unknowns="x y", parameters="r a")
    >>> family.monodromy()
    2 solutions; stopped: trace, trace test ...
    >>> tracked = family.track([[5.0, 0.75], [10.0, 0.75]])
    >>> tracked
    2 targets of 2 roots: 4 finite; all complete
    >>> np.sort(tracked[1][:, 0].real).round(9).tolist()
    [-8.0, 8.0]
    """

    def __init__(
        self,
        equations,
        unknowns=None,
        parameters=None,
        *,
        nonzero=(),
        symmetry=(),
        roots=None,
        name="",
    ):
        self._shown = {}
        if isinstance(equations, str) and unknowns is None and parameters is None:
            self._given = equations
            self._build()
        else:
            equations, nonzero = listed(equations), listed(nonzero)
            symmetry = [listed(each) for each in listed(symmetry)]
            unknowns, parameters = split(unknowns), split(parameters) or []
            symbols = Symbols(equations, nonzero, symmetry, unknowns, parameters)
            self._shown = symbols.shown
            with symbols.in_errors():
                texts, found = formulas("equation", equations, symbols)
                factors, _ = formulas("factor", nonzero, symbols)
                maps = [formulas("formula of a symmetry", each, symbols)[0] for each in symmetry]
                parameters = names("parameters", parameters, symbols)
                unknowns = names("unknowns", unknowns, symbols)
                if unknowns is None:
                    if found is None:
                        raise InputError("say which names are unknowns: unknowns=[...]")
                    unknowns = [each for each in found if each not in parameters]
                self._given = (unknowns, parameters, texts, factors, maps, integer("roots", roots), str(name))
                self._build()
        self.fibre = None

    def _build(self):
        if isinstance(self._given, str):
            self._native = _native.Family.from_text(self._given)
        else:
            self._native = _native.Family.from_formulas(*self._given)
        self.name, unknowns, parameters, self.roots = self._native.describe()
        self.unknowns = [self._shown.get(each, each) for each in unknowns]
        self.parameters = [self._shown.get(each, each) for each in parameters]

    @classmethod
    def read(cls, path, start=None):
        """A family from a file in plain text or TOML, with its solutions from a start file if one is given.

        Parameters
        ----------
        path, start : path
            What `hc monodromy` reads and writes.
        """
        family = cls(_text_of(path))
        if start is not None:
            family.fibre = Fibre(_text_of(start))
            family.compile()
        return family

    def monodromy(
        self,
        *,
        seed=0,
        first=None,
        roots=None,
        patience=None,
        trace=True,
        only_component=False,
        group=0,
        up_to_symmetry=False,
        threads=None,
        progress=True,
    ):
        """Find all solutions for one generic parameter point, by loops in the parameters from a single one.

        Solutions that no loop joins to it are found by a start system, where that takes no more paths than the loops.

        Parameters
        ----------
        seed : int
            Seed of the loops.
        first : Fibre or (parameters, solution), optional
            A first pair; found by Newton's method by default.
        roots : int, optional
            The number of solutions, if it is known.
        patience : int, optional
            Loops without a new solution after which the search ends. Default 8.
        trace : bool
            Whether the trace test shows that orbits are whole, where the number of solutions is not known.
        only_component : bool
            Whether only the solutions are sought that loops join to the first.
        group : int
            Loops along which all solutions are followed in the end, to tell the monodromy group.
        up_to_symmetry : bool
            Whether one solution of each orbit under the `symmetry` is listed; not together with `group`.
        threads, progress
            As in `hc.solve`.

        Returns
        -------
        Fibre
            It becomes the attribute `fibre` too.

        Raises
        ------
        KeyboardInterrupt
            On Ctrl-C, with the solutions so far as `partial`.
        """
        if group and up_to_symmetry:
            raise InputError("group and up_to_symmetry exclude each other: permutations are those of all solutions")
        if first is not None and not isinstance(first, Fibre):
            first = _pair(*first)
        native = None if first is None else self._native.fibre(first.to_json())
        seed = seeded(seed)
        found = call(
            self._native.monodromy,
            seed,
            integer("roots", roots),
            integer("patience", patience),
            bool(trace),
            bool(only_component),
            integer("group", group) or 0,
            bool(up_to_symmetry),
            native,
            threads=threads,
            progress=progress,
            wrap=lambda found: Fibre(found["json"]),
        )
        self.fibre = found
        return found

    def compile(self, fibre=None):
        """The family with its solutions, ready for targets: for repeated calls.

        Parameters
        ----------
        fibre : Fibre, optional
            All solutions for one parameter point; by default those of `monodromy`, which is run if it has not been.

        Returns
        -------
        Compiled
            A function of targets.
        """
        fibre = fibre if fibre is not None else self.fibre
        return Compiled(self, fibre if fibre is not None else self.monodromy())

    def track(
        self,
        targets,
        *,
        fibre=None,
        certify=False,
        up_to_symmetry=False,
        again=1.0,
        time_limit=None,
        threads=None,
        progress=True,
    ):
        """Find the solutions for many parameter points, in parallel.

        Parameters
        ----------
        targets : array_like, shape (k, p)
            Parameter points, real or complex.
        fibre, certify, threads, progress
            All solutions for one parameter point as in `compile`; whether solutions are proved; as in `hc.solve`.
        up_to_symmetry : bool
            Whether one solution of each orbit under the `symmetry` is listed, a real one if there is one.
        again : float
            Paths that are tracked again for a target, at most, in multiples of the paths of its first pass. What is lost
            then has `End.FAILED`. With 2 and more detours are tried first.
        time_limit : float, optional
            Seconds for each target, after which no further path is begun. The result then depends on the machine.

        Returns
        -------
        Tracked
            `points` of shape (k, roots, n), `ends` and `is_real` of shape (k, roots).

        Raises
        ------
        KeyboardInterrupt
            On Ctrl-C, with the targets so far as `partial`.
        """
        track = self.compile(fibre)
        return track(
            targets,
            certify=certify,
            up_to_symmetry=up_to_symmetry,
            again=again,
            time_limit=time_limit,
            threads=threads,
            progress=progress,
        )

    def __repr__(self):
        name = f"{self.name}: " if self.name else ""
        unknowns, parameters = ", ".join(self.unknowns), ", ".join(self.parameters)
        return f"{name}family in {unknowns} with parameters {parameters or 'none'}"

    def __getstate__(self):
        return self._given, self._shown, self.fibre

    def __setstate__(self, state):
        self._given, self._shown, self.fibre = state
        self._build()


def _pair(parameters, solution):
    """A start file of one solution."""

    def pairs(values):
        values = complex_rows("first", values)[0]
        return [[float(z.real), float(z.imag)] for z in values]

    return Fibre(json.dumps({"parameters": pairs(parameters), "solutions": [pairs(solution)]}))


def _text_of(path):
    try:
        with open(os.fspath(path), encoding="utf-8") as file:
            return file.read()
    except OSError:
        raise
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {error}") from None


for _class in (End, Tracked, Fibre, Compiled, Family):
    _class.__module__ = "hc"
del _class

"""Systems without parameters."""

import numpy as np

from . import _native
from ._errors import InputError
from ._run import call, came, integer, seeded, text
from ._solutions import Certificates, Solutions
from ._symbols import Symbols, listed
from ._system import names, split, system as _system


def complex_rows(name, values):
    """A matrix of complex numbers; one row may be given as a vector."""
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biufc":
            array = np.asarray(values, dtype=complex)
        if array.size > 1 << 28:
            raise InputError(f"{name} has {array.size} numbers, more than {1 << 28}")
        # Rust reads aligned numbers alone.
        array = np.require(array.astype(complex, copy=False), requirements="A")
    except (TypeError, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name} must be a matrix of numbers: {error}") from None
    if array.ndim == 1:
        array = array[None, :]
    if array.ndim != 2:
        raise InputError(f"{name} must be a matrix, one in each row, not {came(array)}")
    return array


def read_system(given, variables, *others):
    """A system and its variables as lists or text, and the names of all symbols in them and in others."""
    given = given if isinstance(given, str) else listed(given)
    variables = split(variables)
    return given, variables, Symbols(given, variables, *others)


def solve(
    system,
    *,
    variables=None,
    seed=0,
    start="auto",
    groups=None,
    torus_only=False,
    max_paths=None,
    certify=False,
    threads=None,
    progress=True,
):
    """Find all isolated solutions of a polynomial system by homotopy continuation.

    Parameters
    ----------
    system : str, or sequence of str or SymPy expressions
        The equations, each a formula that is to vanish or with `=` in it (SymPy: `Eq`). One text holds one equation a
        line, or PHCpack's format, or TOML. Powers are written `^` or `**`, the imaginary unit `i` or `I`. Symbols of SymPy
        may have any name, `x_{1}` or that of a `Dummy`.
    variables : sequence of str or symbols, optional
        The unknowns in their order, whatever the equations are given as. By default in the order of their appearance; those of
        SymPy sorted by name.
    seed : int
        Seed of everything random; the same seed gives the same bits, those of the program `hc solve` too.
    start : {"auto", "polyhedral", "multihomogeneous", "total_degree"}
        The start system; `total-degree`, as the program has it, is the same.
    groups : sequence of sequences of names, optional
        Groups of unknowns for `multihomogeneous`.
    torus_only : bool
        Leaves out solutions with zero coordinates.
    max_paths : int, optional
        More paths than this are refused. Default 2**24.
    certify : bool
        Proves in interval arithmetic that the solutions exist and are distinct.
    threads : int, optional
        Threads; all cores by default. The result does not depend on it.
    progress : bool or callable
        Whether a bar is shown after a second, in a terminal or a notebook with tqdm; or a function of words, done, total.

    Returns
    -------
    Solutions
        With `points`, `real_points`, `multiplicities`, `certified`.

    Raises
    ------
    InputError
        If the system cannot be read or solved: the message says why.
    KeyboardInterrupt
        On Ctrl-C, with the solutions so far as `partial`.

    Examples
    --------
    >>> import hc
    >>> found = hc.solve(["x^2 + y^2 - 5", "x*y - 2"])
    >>> sorted(found.real_points.round(12).tolist())
    [[-2.0, -1.0], [-1.0, -2.0], [1.0, 2.0], [2.0, 1.0]]
    """
    groups = [split(group) for group in listed(groups)] if groups is not None else []
    system, variables, symbols = read_system(system, variables, groups)
    if start == "multihomogeneous" and not groups:
        raise InputError('say which unknowns form groups, for instance groups=[["x"], ["y"]]')
    settings = {
        "seed": seeded(seed),
        "start": text("start", start),
        "groups": [names("groups", group, symbols) for group in groups],
        "torus_only": bool(torus_only),
        "max_paths": integer("max_paths", max_paths, 0, 2**64 - 1),
        "certify": bool(certify),
    }

    def wrap(found):
        return Solutions(found, symbols.shown)

    with symbols.in_errors():
        given = _system(system, variables, symbols)
        return call(_native.solve, given, settings, threads=threads, progress=progress, wrap=wrap)


def mixed_volume(system, *, variables=None, threads=None, progress=True):
    """The mixed volume: how many solutions without zero coordinates the system has for generic coefficients.

    Parameters
    ----------
    system, variables, threads, progress
        As in `solve`.

    Returns
    -------
    int

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C, with a lower bound as `partial`.

    Examples
    --------
    >>> import hc
    >>> hc.mixed_volume(["x^2*y + x + 1", "x*y^2 + y + 2"])
    3
    """
    system, variables, symbols = read_system(system, variables)
    with symbols.in_errors():
        given = _system(system, variables, symbols)
        return call(_native.mixed_volume, given, threads=threads, progress=progress)


def certify(system, points, *, variables=None, threads=None, progress=True):
    """Prove that points stand for solutions, distinct ones, real ones: Krawczyk's test in interval arithmetic.

    Parameters
    ----------
    system, variables, threads, progress
        As in `solve`; as many equations as unknowns. Decimals in formulas are exact numbers.
    points : array_like of complex, shape (k, n), or Solutions
        Approximate solutions.

    Returns
    -------
    Certificates

    Examples
    --------
    >>> import hc
    >>> hc.certify(["x^2 - 2"], [[1.41421356], [1.5], [-1.41421356]])
    2 of 3 points certified: 2 distinct solutions, 2 of them proved real
    """
    rows = complex_rows("points", points.points if isinstance(points, Solutions) else points)
    system, variables, symbols = read_system(system, variables)
    with symbols.in_errors():
        given = _system(system, variables, symbols)
        return call(_native.certify, given, rows, threads=threads, progress=progress, wrap=Certificates)

"""SymPy symbols of any name: formulas have names for them, results and errors have the symbols' own."""

import pickle

import hc
import numpy as np
import pytest

sympy = pytest.importorskip("sympy")


def test_any_name_comes_back():
    x, alpha, beta, i = sympy.symbols(r"x_{1} \\alpha β i")
    unit = sympy.Symbol("I")
    blank = sympy.Symbol("my unknown")
    unknowns = [x, alpha, beta, i, unit, blank]
    # The solution of v_k = k + 1.
    found = hc.solve([v - k - 1 for k, v in enumerate(unknowns)], variables=unknowns)
    assert found.variables == [v.name for v in unknowns]
    assert found.points.tolist() == [[1, 2, 3, 4, 5, 6]]
    assert all(f"{v.name} = {k + 1}." in repr(found) for k, v in enumerate(unknowns))
    # By default in the order of their names.
    assert hc.solve([x - 1, blank - 2]).variables == ["my unknown", "x_{1}"]
    assert hc.solve([sympy.Symbol(f"x_{{{k}}}") - k for k in range(1, 12)]).points.tolist() == [list(range(1, 12))]
    # Names as strings beside the symbols.
    assert hc.solve([x - 1, alpha - 2], variables=[r"\\alpha", "x_{1}"]).points.tolist() == [[2, 1]]
    # A symbol named i is an unknown, the number sympy.I the imaginary unit.
    assert hc.solve([i**2 - 4]).n_real == 2 and hc.solve([i - sympy.I]).points.tolist() == [[1j]]


def test_dummies_are_told_apart():
    x, one, other = sympy.Symbol("x"), sympy.Dummy("x"), sympy.Dummy("x")
    found = hc.solve([x - 1, one - 2, other - 3], variables=[other, x, one])
    assert found.points.tolist() == [[3, 1, 2]] and found.variables == ["_x", "x", "_x"]
    # Names that the formulas might have for them are taken.
    taken = sympy.Symbol("_s0")
    assert hc.solve([taken - 1, one - 2], variables=[taken, one]).points.tolist() == [[1, 2]]
    assert hc.solve(["_s0 - 1", one - 2], variables=["_s0", one]).points.tolist() == [[1, 2]]
    # SymPy takes these for different symbols, everybody else for one.
    with pytest.raises(hc.InputError, match="two different symbols are named x"):
        hc.solve([x - 1, sympy.Symbol("x", real=True) - 2])


def test_groups_volumes_certificates_families():
    x, y, a = sympy.Symbol("x_{1}"), sympy.Dummy(), sympy.Symbol("a'")
    system = [x * y - 2, x + y - 3]
    found = hc.solve(system, start="multihomogeneous", groups=[[x], [y]], variables=[x, y])
    assert sorted(found.real_points.round(9).tolist()) == [[1, 2], [2, 1]]
    # Two lines of the supports, in general position: Bernstein's count.
    assert hc.mixed_volume(system) == 2
    assert hc.certify(system, found, variables=[x, y]).n_real == 2
    family = hc.Family([x**2 - a], parameters=[a])
    family.monodromy()
    assert (family.unknowns, family.parameters) == (["x_{1}"], ["a'"]) and "x_{1}" in repr(family)
    again = pickle.loads(pickle.dumps(family))
    assert again.parameters == ["a'"] and np.sort(again.track([[4.0]])[0][:, 0].real).round(12).tolist() == [-2, 2]


def test_errors_have_the_names():
    x, y = sympy.symbols("x_{1} x_{2}")
    with pytest.raises(hc.InputError, match=r"`x_\{2\}` is neither an unknown") as caught:
        hc.solve([x - y], variables=[x])
    assert "_s" not in str(caught.value)
    with pytest.raises(hc.InputError, match=r"no unknown `x_\{2\}` for groups; there are x_\{1\}"):
        hc.solve([x - 1], start="multihomogeneous", groups=[[y]])

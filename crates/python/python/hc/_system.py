"""Systems as users write them: text, strings, SymPy expressions."""

import re
import sys

from ._errors import InputError
from ._numbers import decimal


def _is_sympy(thing):
    sympy = sys.modules.get("sympy")
    return sympy is not None and isinstance(thing, (sympy.Basic, sympy.MatrixBase))


def _natural(name):
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def _listed(given):
    """One thing or many as a list. A SymPy matrix is many, though it has no `__iter__`."""
    if _is_sympy(given):
        return list(given) if hasattr(given, "shape") else [given]
    return given if hasattr(given, "__iter__") and not isinstance(given, str) else [given]


def formulas(name, given):
    """A list of formulas as strings, and the names in them where they come from SymPy."""
    given = _listed(given)
    texts, names, symbolic = [], set(), False
    printer = None
    for item in given:
        if isinstance(item, str):
            texts.append(item)
        elif _is_sympy(item):
            import sympy

            if printer is None:
                from ._printer import Printer

                printer = Printer({"order": None})
            symbolic = True
            expression = item
            if isinstance(item, sympy.Equality):
                expression = item.lhs - item.rhs
            elif isinstance(item, sympy.Poly):
                expression = item.as_expr()
            if not isinstance(expression, sympy.Expr):
                raise InputError(f"{name} {len(texts) + 1} is no formula: {item!r}")
            names.update(symbol.name for symbol in expression.free_symbols)
            texts.append(printer.doprint(expression))
        elif isinstance(item, (int, float)) and not isinstance(item, bool):
            texts.append(decimal(item))
        else:
            raise InputError(f"{name} {len(texts) + 1} must be a string or a SymPy expression, not {type(item).__name__}")
    return texts, sorted(names, key=_natural) if symbolic else None


def names(name, given):
    """A list of names from strings, SymPy symbols, or one string with blanks or commas."""
    if given is None:
        return None
    if isinstance(given, str):
        given = given.replace(",", " ").split()
    found = []
    for item in _listed(given):
        if isinstance(item, str):
            found.append(item)
        elif _is_sympy(item) and item.is_Symbol:
            found.append(item.name)
        else:
            raise InputError(f"{name} must be names or symbols, not {item!r}")
    return found


def system(given, variables=None):
    """What the extension module takes for a system."""
    variables = names("variables", variables)
    if isinstance(given, str):
        if variables is None:
            return given
        return [line for line in re.split(r"[;\n]", given) if line.strip()], variables
    texts, found = formulas("equation", given)
    return texts, variables if variables is not None else found

"""Systems as users write them: text, strings, SymPy expressions."""

import re
import sys

from ._errors import InputError


def _is_sympy(thing):
    sympy = sys.modules.get("sympy")
    return sympy is not None and isinstance(thing, (sympy.Basic, sympy.MatrixBase))


def _printer():
    import sympy
    from sympy.printing.str import StrPrinter

    class Printer(StrPrinter):
        """Formulas whose numbers are read back to the same bits; irrational numbers become doubles."""

        def _print_Float(self, number):
            if number._prec <= 53:
                return _decimal(float(number))
            exact = sympy.Rational(number)
            return f"({exact.p}/{exact.q})"

        def _print_NumberSymbol(self, number):
            return _decimal(float(number))

        def _print_ImaginaryUnit(self, _):
            return "i"

        def _print_Pow(self, power, rational=False):
            if power.is_number and not power.exp.is_Integer:
                value = complex(power)
                return f"({_decimal(value.real)} + {_decimal(value.imag)}*i)" if value.imag else _decimal(value.real)
            if power.exp.is_Integer:
                base = self.parenthesize(power.base, 1000, strict=False)
                if power.exp.is_negative:
                    return f"(1/({base})**{-power.exp})"
                return f"({base})**{power.exp}"
            raise InputError(f"{power} is no polynomial")

        def _print_Function(self, function):
            if function.is_number:
                value = complex(function)
                return f"({_decimal(value.real)} + {_decimal(value.imag)}*i)" if value.imag else _decimal(value.real)
            raise InputError(f"{function} is no polynomial")

    return Printer({"order": None})


def _decimal(value):
    if value != value or value in (float("inf"), float("-inf")):
        raise InputError(f"a coefficient is {value}")
    return f"({value!r})" if value < 0 else repr(value)


def _natural(name):
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def formulas(name, given):
    """A list of formulas as strings, and the names in them where they come from SymPy."""
    if isinstance(given, str) or not hasattr(given, "__iter__") or _is_sympy(given) and not hasattr(given, "shape"):
        given = [given]
    texts, names, symbolic = [], set(), False
    printer = None
    for item in given:
        if isinstance(item, str):
            texts.append(item)
        elif _is_sympy(item):
            import sympy

            printer = printer or _printer()
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
            texts.append(_decimal(item))
        else:
            raise InputError(f"{name} {len(texts) + 1} must be a string or a SymPy expression, not {type(item).__name__}")
    return texts, sorted(names, key=_natural) if symbolic else None


def names(name, given):
    """A list of names from strings, SymPy symbols, or one string with blanks or commas."""
    if given is None:
        return None
    if isinstance(given, str):
        given = given.replace(",", " ").split()
    if not hasattr(given, "__iter__") or _is_sympy(given) and not hasattr(given, "shape"):
        given = [given]
    found = []
    for item in given:
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

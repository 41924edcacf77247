"""Systems as users write them: text, strings, SymPy expressions."""

from ._errors import InputError
from ._numbers import decimal
from ._symbols import is_sympy, listed, natural


def formulas(name, given, symbols):
    """A list of formulas as strings, and the names in them where they come from SymPy."""
    texts, names, symbolic = [], set(), False
    printer = None
    for item in given:
        if isinstance(item, str):
            texts.append(item)
        elif is_sympy(item):
            import sympy

            if printer is None:
                from ._printer import Printer

                printer = Printer(symbols)
            symbolic = True
            expression = item
            if isinstance(item, sympy.Equality):
                expression = item.lhs - item.rhs
            elif isinstance(item, sympy.Poly):
                expression = item.as_expr()
            if not isinstance(expression, sympy.Expr):
                raise InputError(f"{name} {len(texts) + 1} is no formula: {item!r}")
            names.update(expression.free_symbols)
            texts.append(printer.doprint(expression))
        elif isinstance(item, (int, float)) and not isinstance(item, bool):
            texts.append(decimal(item))
        else:
            raise InputError(f"{name} {len(texts) + 1} must be a string or a SymPy expression, not {type(item).__name__}")
    if not symbolic:
        return texts, None
    found = {symbols.name(symbol): symbol for symbol in names if symbol.is_Symbol}
    return texts, sorted(found, key=lambda each: (natural(found[each].name), natural(each)))


def split(given):
    """A list of names, symbols or others from what a user gives for it; one string has blanks or commas."""
    if given is None:
        return None
    return given.replace(",", " ").split() if isinstance(given, str) else listed(given)


def names(name, given, symbols):
    """The names that formulas have for names and symbols."""
    if given is None:
        return None
    found = []
    for item in given:
        if isinstance(item, str):
            found.append(symbols.named(item))
        elif is_sympy(item) and item.is_Symbol:
            found.append(symbols.name(item))
        else:
            raise InputError(f"{name} must be names or symbols, not {item!r}")
    return found


def system(given, variables, symbols):
    """What the extension module takes for a system; `given` is a text or a list, `variables` a list or None."""
    variables = names("variables", variables, symbols)
    if isinstance(given, str):
        return given, variables
    texts, found = formulas("equation", given, symbols)
    return texts, variables if variables is not None else found

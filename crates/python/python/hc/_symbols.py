"""Symbols of SymPy, whose names may be any text, and the names that formulas have for them."""

import re
import sys
from contextlib import contextmanager

from ._errors import InputError

# What formulas can have as a name, but for the imaginary unit.
_NAME = re.compile(r"(?![iI]\Z)[A-Za-z_][A-Za-z0-9_]*\Z")


def is_sympy(thing):
    """Whether this is an object of SymPy, which is not imported for the question."""
    sympy = sys.modules.get("sympy")
    return sympy is not None and isinstance(thing, (sympy.Basic, sympy.MatrixBase))


def listed(given):
    """One thing or many as a list. A SymPy matrix is many, though it has no `__iter__`."""
    if is_sympy(given):
        return list(given) if hasattr(given, "shape") else [given]
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        return [given]
    try:
        return list(given)
    except TypeError:
        # An array without axes has `__iter__` all the same.
        return [given]


class Symbols:
    """Which name in formulas stands for which symbol.

    Symbols whose names formulas cannot have, such as `x_{1}`, and every `Dummy`, get names of their own; results and errors have
    the symbols' names again.
    """

    def __init__(self, *things):
        symbols, texts = set(), []
        for thing in things:
            self._collect(thing, symbols, texts)
        self._names, self.shown, plain = {}, {}, {}
        for symbol in sorted(symbols, key=lambda each: natural(each.name)):
            if symbol.is_Dummy:
                continue
            if plain.setdefault(symbol.name, symbol) != symbol:
                raise InputError(f"two different symbols are named {symbol.name}, with different assumptions; rename one")
        prefix = "_s"
        while any(prefix in text for text in [*texts, *plain]):
            prefix += "_"
        ordered = sorted(symbols, key=lambda each: (natural(each.name), getattr(each, "dummy_index", 0)))
        for k, symbol in enumerate(ordered):
            if symbol.is_Dummy or not _NAME.match(symbol.name):
                self._names[symbol] = f"{prefix}{k}"
                self.shown[f"{prefix}{k}"] = str(symbol)

    @staticmethod
    def _collect(thing, symbols, texts, depth=3):
        if isinstance(thing, str):
            texts.append(thing)
        elif is_sympy(thing) and hasattr(thing, "free_symbols"):
            symbols.update(each for each in thing.free_symbols if each.is_Symbol)
        elif isinstance(thing, list) and depth > 0:
            for each in thing:
                Symbols._collect(each, symbols, texts, depth - 1)

    def name(self, symbol):
        """The name that formulas have for a symbol."""
        return self._names.get(symbol, symbol.name)

    def named(self, text):
        """The name that formulas have for a symbol of this name, where it is another one and no `Dummy`'s."""
        found = [name for symbol, name in self._names.items() if symbol.name == text and not symbol.is_Dummy]
        return found[0] if found else text

    @contextmanager
    def in_errors(self):
        """Errors of what is done within have the symbols' own names."""
        try:
            yield
        except InputError as error:
            error.args = tuple(own_names(str(each), self.shown) for each in error.args)
            raise


def own_names(text, shown):
    """A text with the symbols' own names."""
    return re.sub(r"\b_s_*\d+\b", lambda found: shown.get(found[0], found[0]), text) if shown else text


def natural(name):
    """What sorts x2 before x10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]

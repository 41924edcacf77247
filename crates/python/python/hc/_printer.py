"""Formulas of SymPy as text; imported where somebody has them."""

import sympy
from sympy.printing.str import StrPrinter

from ._errors import InputError
from ._numbers import decimal


class Printer(StrPrinter):
    """Formulas whose numbers are read back to the same bits; irrational numbers become doubles."""

    def __init__(self, symbols):
        super().__init__({"order": None})
        self._symbols = symbols

    def _print_Symbol(self, symbol):
        return self._symbols.name(symbol)

    _print_Dummy = _print_Symbol

    def _print_Float(self, number):
        if number._prec <= 53:
            return decimal(float(number))
        exact = sympy.Rational(number)
        return f"({exact.p}/{exact.q})"

    def _print_NumberSymbol(self, number):
        return decimal(float(number))

    _print_Pi = _print_Exp1 = _print_EulerGamma = _print_GoldenRatio = _print_Catalan = _print_NumberSymbol

    def _print_ImaginaryUnit(self, _):
        return "i"

    def _print_Pow(self, power, rational=False):
        if power.is_number and not power.exp.is_Integer:
            value = complex(power)
            return f"({decimal(value.real)} + {decimal(value.imag)}*i)" if value.imag else decimal(value.real)
        if power.exp.is_Integer:
            base = self.parenthesize(power.base, 1000, strict=False)
            if power.exp.is_negative:
                return f"(1/({base})**{-power.exp})"
            return f"({base})**{power.exp}"
        raise InputError(f"{power} is no polynomial")

    def _print_Function(self, function):
        if function.is_number:
            value = complex(function)
            return f"({decimal(value.real)} + {decimal(value.imag)}*i)" if value.imag else decimal(value.real)
        raise InputError(f"{function} is no polynomial")

"""Exceptions of hc and tdoa, with the words of the programs."""


class Error(Exception):
    """Base of all exceptions of hc and tdoa."""


class InputError(Error, ValueError):
    """Input that cannot be used: what is wrong, where, and what to do."""


class UndeterminedError(Error, RuntimeError):
    """Data that do not determine an answer."""


class InternalError(Error, RuntimeError):
    """A flaw of the library, caught: please report it with the input."""


for _class in (Error, InputError, UndeterminedError, InternalError):
    # Tracebacks and pickles name them as users do.
    _class.__module__ = "hc"
del _class

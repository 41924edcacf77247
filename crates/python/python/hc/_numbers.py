"""Numbers as text."""

from ._errors import InputError


def decimal(value):
    """A double as text that is read back to the same bits."""
    if value != value or value in (float("inf"), float("-inf")):
        raise InputError(f"a coefficient is {value}")
    return f"({value!r})" if value < 0 else repr(value)


def counted(number, word):
    """A number of things, with the word in the plural where it is due."""
    return f"{number} {word}" if number == 1 else f"{number} {word}s"

"""Calls of the extension module: progress bars, and partial results of an interrupt."""

import sys
import time
from operator import index

from ._errors import InputError

# Work that is done sooner shows no bar.
_PATIENCE = 1.0


def integer(name, value, least=0, most=2**63 - 1):
    """A whole number within bounds, or `None`."""
    if value is None:
        return None
    try:
        number = index(value)
    except TypeError:
        raise InputError(f"{name} must be a whole number, not {value!r}") from None
    if not least <= number <= most:
        raise InputError(f"{name} must be between {least} and {most}, not {number}")
    return number


def seeded(seed):
    """A seed."""
    found = integer("seed", seed, 0, 2**64 - 1)
    if found is None:
        raise InputError("seed must be a whole number, not None")
    return found


def number(name, value):
    """A real number, or `None`."""
    if value is None:
        return None
    if isinstance(value, (str, bytes)):
        raise InputError(f"{name} must be a number, not {value!r}")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, not {value!r}") from None


def text(name, value):
    """A text."""
    if not isinstance(value, str):
        raise InputError(f"{name} must be a text, not {value!r}")
    return value


def came(array):
    """What came in place of a matrix, in words."""
    if array.ndim:
        return f"an array of shape {array.shape}"
    return "a single number" if array.dtype.kind in "biufc" else f"a single {type(array.item()).__name__}"


def _watched():
    """Whether somebody looks: a terminal, or a notebook."""
    kernel = sys.modules.get("ipykernel")
    if kernel is not None and "IPython" in sys.modules:
        shell = sys.modules["IPython"].get_ipython()
        if shell is not None and type(shell).__name__ == "ZMQInteractiveShell":
            return True
    try:
        return sys.stderr is not None and sys.stderr.isatty()
    except (AttributeError, ValueError):
        return False


class _Bar:
    """A progress bar that appears after a second, if tqdm is installed."""

    def __init__(self):
        self.begun = time.monotonic()
        self.bar = None

    def __call__(self, words, done, total):
        if time.monotonic() - self.begun < _PATIENCE:
            return
        if self.bar is None:
            from tqdm.auto import tqdm

            self.bar = tqdm(leave=False)
        self.bar.total = total or None
        self.bar.n = done
        self.bar.set_description_str(words, refresh=False)
        self.bar.refresh()

    def close(self):
        if self.bar is not None:
            self.bar.close()


def _bar(progress):
    if not progress or not _watched():
        return None
    try:
        import tqdm.auto  # noqa: F401
    except ImportError:
        return None
    return _Bar()


def call(function, *arguments, threads=None, progress=True, wrap=None):
    """Calls a function of the extension module.

    Parameters
    ----------
    function, arguments
        What is called; it gets threads and progress as last argument.
    threads : int, optional
        Threads; all cores by default.
    progress : bool or callable
        Whether a bar is shown, or what is called with words, done and total.
    wrap : callable, optional
        Makes the result of what the function gives, a partial one too.
    """
    bar = progress if callable(progress) else _bar(progress)
    how = {"threads": integer("threads", threads, 0, 2**31), "progress": bar}
    try:
        found = function(*arguments, how)
    except BaseException as stopped:
        if wrap is not None and getattr(stopped, "partial", None) is not None:
            stopped.partial = wrap(stopped.partial)
        raise
    finally:
        if isinstance(bar, _Bar):
            bar.close()
    return found if wrap is None else wrap(found)

"""Polynomial systems by homotopy continuation.

* `solve`: all isolated solutions of a system.
* `decompose`: all solutions of a system, components of positive dimension too.
* `Family`: a system with parameters, solved once and tracked to thousands of parameter points.
* `mixed_volume`: how many solutions a generic system with the same terms has.
* `certify`: proofs that solutions exist, are distinct, are real.

Arrays in, arrays out. Work runs on all cores without Python's lock, and Ctrl-C leaves what was found.
"""

from ._decompose import Component, Decomposition, decompose
from ._errors import Error, InputError, InternalError, UndeterminedError
from ._family import Compiled, End, Family, Fibre, Tracked
from ._native import __version__
from ._solutions import Certificates, Solutions, Unresolved
from ._solve import certify, mixed_volume, solve

for _function in (solve, mixed_volume, certify):
    _function.__module__ = "hc"
del _function

__all__ = [
    "Certificates",
    "Compiled",
    "Component",
    "Decomposition",
    "End",
    "Error",
    "Family",
    "Fibre",
    "InputError",
    "InternalError",
    "Solutions",
    "Tracked",
    "UndeterminedError",
    "Unresolved",
    "certify",
    "decompose",
    "mixed_volume",
    "solve",
]

"""Self-calibration of sensor networks from arrival times alone.

Synchronised receivers hear transmitters whose send times are unknown. With all times multiplied by the propagation speed, receiver i
measures of transmitter j the pseudorange |r_i - s_j| + o_j. From these alone come the positions r and s and the offsets o, up to
a rotation, reflection and translation of the plane, or of space.

* `calibrate`: any network from measurements as they come, with outliers, gaps and noise; `locate` of the result places new transmitters in it.
* `solve`: every network that explains a small complete table exactly.
* `read`: measurements from files. `listen`: from recordings of claps or chirps.
* `simulate`, `cramer_rao`: networks with a known truth, and how near to it an estimate can come.

Arrays in, arrays out, lengths in metres, NaN for what is missing. Exceptions are those of the package `hc`.
"""

from hc import Error, InputError, InternalError, UndeterminedError, __version__

from ._calibration import Alternative, Calibration
from ._clocks import Clocks, RecorderClock
from ._listen import Heard, listen
from ._networks import Networks, Simulation, Unfinished, calibrate, cramer_rao, simulate, solve
from ._place import Place
from ._tables import Pseudoranges, read

__all__ = [
    "Alternative",
    "Calibration",
    "Clocks",
    "Error",
    "Heard",
    "InputError",
    "InternalError",
    "Networks",
    "Place",
    "Pseudoranges",
    "RecorderClock",
    "Simulation",
    "UndeterminedError",
    "Unfinished",
    "calibrate",
    "cramer_rao",
    "listen",
    "read",
    "simulate",
    "solve",
]

"""Where new transmitters are."""

import numpy as np


class Place:
    """Where a transmitter is in a network, from `Calibration.locate`.

    Attributes
    ----------
    transmitter : str
        Its name.
    heard : int
        Number of receivers of the network that hear it.
    problem : str or None
        Why it cannot be located; everything below is then NaN, False or empty.
    position, position_std : ndarray of float, shape (d,)
        Its position and the standard deviations of the coordinates, metres.
    covariance : ndarray of float, shape (d, d)
        Their covariance, square metres, with the errors of the measurements and those of the receivers.
    offset, offset_std : float
        Its offset and the standard deviation, metres; zero where send times are known.
    outliers : list of str
        Receivers whose measurements do not agree.
    redundancy : int
        Measurements that agree, less the unknowns: where it is 0, nothing tells whether they are right.
    residual_rms : float
        Root mean square of the residuals of those that agree, metres.
    fits : bool
        Whether the measurements that agree do so as well as their standard deviations have it, and are most of all.
    unique : bool
        Whether they fit, no other place explains them about as well, and the receivers of the network are unique.
    others : list of dict
        Other places that do: `position`, `offset`, and `log_likelihood_loss`, by how much the measurements are less likely (natural
        logarithm).
    """

    def __init__(self, data, dimensions):
        nowhere = [float("nan")] * dimensions
        self.transmitter = data["transmitter"]
        self.heard = data["heard"]
        self.problem = data.get("problem")
        self.position = np.array(data.get("position", nowhere), dtype=float)
        self.position_std = np.array(data.get("position_std", nowhere), dtype=float)
        self.covariance = np.array(data.get("covariance", [nowhere] * dimensions), dtype=float)
        self.offset = data.get("offset", float("nan"))
        self.offset_std = data.get("offset_std", float("nan"))
        self.outliers = data.get("outliers", [])
        self.redundancy = data.get("redundancy", 0)
        self.residual_rms = data.get("residual_rms", float("nan"))
        self.fits = data.get("fits", False)
        self.unique = data.get("unique", False)
        self.others = data.get("others", [])

    def __repr__(self):
        if self.problem is not None:
            return f"{self.transmitter}: {self.problem}"
        place = ", ".join(f"{x:.4g} ± {std:.2g}" for x, std in zip(self.position, self.position_std))
        doubt = "" if self.unique else ", not unique" if self.fits else ", does not fit"
        return f"{self.transmitter}: {place} m{doubt}"


Place.__module__ = "tdoa"

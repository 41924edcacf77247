"""A calibrated network."""

import json
import os
from functools import cached_property

import numpy as np

from hc import InputError, _native

from ._clocks import RecorderClock, recorders_of
from ._listen import heard
from ._place import Place
from ._tables import real_matrix, table


class Alternative:
    """Another network that explains the measurements about as well.

    Attributes
    ----------
    receivers, transmitters : ndarray of float, shapes (m, d) and (n, d)
        Positions in metres; NaN where they are not determined.
    offsets : ndarray of float, shape (n,)
        Offsets of the transmitters in metres.
    residual : float
        Root mean square of the residuals of its own inliers, metres.
    log_likelihood_loss : float
        By how much the measurements are less likely than under the best network, natural logarithm; with a receiver's error, by how
        much less they tell of it than of one that is taken out; 0 for the network of one-sided errors, which has a likelihood of its
        own.
    receiver_error : dict or None
        An error of a receiver without which the measurements fit this network, as in ``data["receiver_errors"]``: they hint at it,
        too weakly for the result to have it.
    """

    def __init__(self, data, dimensions=2):
        self.receivers = _rows(data["receivers"], (dimensions,))
        self.transmitters = _rows(data["transmitters"], (dimensions,))
        self.offsets = _rows(data["offsets"], ())
        self.residual = data["residual"]
        self.log_likelihood_loss = data["log_likelihood_loss"]
        self.receiver_error = data.get("receiver_error")

    def __repr__(self):
        return f"alternative, {self.log_likelihood_loss:.2f} less likely (natural logarithm)"


class Calibration:
    """A calibrated network: lengths in metres, NaN for what could not be determined.

    Attributes
    ----------
    receivers : ndarray of float, shape (m, d)
        Positions of the receivers. Without anchors the first is the origin, the second lies on the positive x axis, the third
        above it and, in space, the fourth above the plane of these.
    transmitters : ndarray of float, shape (n, d)
        Positions of the transmitters.
    offsets : ndarray of float, shape (n,)
        Send times of the transmitters times the propagation speed.
    covariance : ndarray of float, shape (m, d, d)
        Covariances of the receivers in square metres, relative to what `gauge` says.
    transmitter_covariance : ndarray of float, shape (n, d, d)
        Those of the transmitters.
    offset_std : ndarray of float, shape (n,)
        Standard deviations of the offsets.
    inliers : ndarray of bool, shape (m, n)
        Which measurements agree with the network; False where there is none.
    residuals : ndarray of float, shape (m, n)
        Pseudorange minus offset minus distance; NaN where nothing was measured.
    unique : bool
        Whether no other network was found that explains the measurements about as well, the search has settled, and no receiver
        shows an error of its own.
    alternatives : list of Alternative
        Other networks that do, best first.
    clocks : list of RecorderClock
        The clocks of the recorders, where these have clocks of their own: offsets in metres, rates as shares, with standard
        deviations, against the first recorder; empty where receivers share a clock.
    mirror_images : list of dict
        In space, places of single nodes on the other side of a plane that explain the measurements as well: `node`, `kind`
        ("receiver" or "transmitter"), `position`, `distance_from_plane`, `log_likelihood_loss`.
    warnings : list of str
        What may be wrong, with names and a remedy.
    sigma : float
        Standard deviation of the measurements: as given, or estimated. A factor on those of single measurements, where these were
        given.
    receiver_names, transmitter_names : list of str
        Names of the nodes.
    dimensions : int
        d: 2 in the plane, 3 in space.
    dimension_test : dict or None
        Where the measurements decided between plane and space: `gain`, by how much they are more likely in the best network in space
        (natural logarithm), `needed`, what chance gains at most, and `evidence`, by how much they are more likely in space over all
        networks, below zero for the plane, and `change`, by how many standard deviations of a measurement the likeliest heights
        change the distances; None in place of a number that there is not, as where the measurements are too few for
        space. None where `dimensions` or heights of anchors decided.
    systematic : dict or None
        Systematic errors, which all measurements of a receiver share: `deviation` in metres, `gain` (natural logarithm), whether they are
        `significant`, and the `factor` by which standard deviations of the receivers grow. None where fewer than ten measurements
        are left over, there are more than 100 receivers, or errors are one-sided.
    systematic_covariance, systematic_transmitter_covariance : ndarray of float, shapes (m, d, d) and (n, d, d)
        Covariances with these errors, those of noise included; NaN where `systematic` is None.
    data : dict
        Everything that the JSON holds, under the same keys.
    """

    def __init__(self, text):
        self._text = text
        try:
            self.data = json.loads(text)
            self.receiver_names = self.data["receiver_names"]
            self.transmitter_names = self.data["transmitter_names"]
            self.mirror_images = self.data.get("mirror_images", [])
            self.warnings = self.data["warnings"]
            self.unique = self.data["unique"]
            self.sigma = self.data["sigma"]
            self.gauge = self.data["gauge"]
            self.dimensions = self.data.get("dimensions", 2)
            self.dimension_test = self.data.get("dimension_test")
            self.systematic = self.data.get("systematic")
        except (TypeError, ValueError, KeyError) as error:
            raise InputError(f"no calibration: {error}") from None
        if self.dimensions not in (2, 3):
            raise InputError(f"no calibration: its dimensions are {self.dimensions!r}, not 2 or 3")

    @classmethod
    def from_json(cls, text):
        """A calibration from what `to_json`, or the program with --json, has written."""
        return cls(text)

    @cached_property
    def receivers(self):
        return _rows(self.data["receivers"], (self.dimensions,))

    @cached_property
    def transmitters(self):
        return _rows(self.data["transmitters"], (self.dimensions,))

    @cached_property
    def offsets(self):
        return _rows(self.data["offsets"], ())

    @cached_property
    def covariance(self):
        return _rows(self.data["receiver_covariance"], (self.dimensions, self.dimensions))

    @cached_property
    def transmitter_covariance(self):
        return _rows(self.data["transmitter_covariance"], (self.dimensions, self.dimensions))

    @cached_property
    def systematic_covariance(self):
        return self._systematic("receiver_covariance", len(self.receiver_names))

    @cached_property
    def systematic_transmitter_covariance(self):
        return self._systematic("transmitter_covariance", len(self.transmitter_names))

    def _systematic(self, key, count):
        rows = [None] * count if self.systematic is None else self.systematic[key]
        return _rows(rows, (self.dimensions, self.dimensions))

    @cached_property
    def offset_std(self):
        return _rows(self.data["offset_std"], ())

    @cached_property
    def inliers(self):
        return np.array(self.data["inliers"], dtype=bool).reshape(len(self.receiver_names), -1)

    @cached_property
    def residuals(self):
        return np.array(self.data["residuals"], dtype=float).reshape(len(self.receiver_names), -1)

    @cached_property
    def alternatives(self):
        return [Alternative(each, self.dimensions) for each in self.data["alternatives"]]

    @cached_property
    def clocks(self):
        names = RecorderClock._fields
        return [RecorderClock(*(clock.get(name) for name in names)) for clock in self.data.get("clocks", [])]

    @property
    def trusted(self):
        """Whether the measurements fit a network of these dimensions and the known positions, and determine where most nodes are."""
        return self.data.get("fits", self.data["planar"]) and self.data["determined"] and self.data.get("anchors_agree", True)

    @property
    def truth(self):
        """What `compared` has found: errors in metres and the true positions in this frame, as in the JSON; None before."""
        return self.data.get("truth")

    def compared(self, receivers, transmitters=None):
        """This calibration beside true positions, and in their frame, unless anchors gave it one.

        Parameters
        ----------
        receivers : array_like of float, shape (m, d), or dict of name to position
            True positions in metres; NaN, or no entry, where they are unknown.
        transmitters : array_like of float, shape (n, d), or dict of name to position, optional
            True positions of transmitters.

        Returns
        -------
        Calibration
            With `truth`: after the best rigid alignment of the receivers (mirror images allowed), `receiver_rms` in metres,
            `receiver_rms_scaled` with a common `scale` fitted as well, how many `receivers` were compared, and the
            `transmitter_median`. Pictures show the true positions.

        Raises
        ------
        hc.InputError
            If a shape or a name does not fit, or fewer than two receivers can be compared.
        """
        known = [
            self._known("receivers", receivers, self.receiver_names),
            [] if transmitters is None else self._known("transmitters", transmitters, self.transmitter_names),
        ]
        keeps_frame = not self.gauge.startswith("inner constraint")
        return Calibration(_native.calibration_compared(self._text, *known, keeps_frame))

    def _known(self, kind, given, names):
        """Known positions in the order of the names; None where there is none."""
        if hasattr(given, "keys"):
            strange = [str(name) for name in given.keys() if str(name) not in names]
            if strange:
                raise InputError(f"none of the {kind} is named {', '.join(strange[:8])}; they are {', '.join(names[:8])}")
            rows = np.full((len(names), self.dimensions), np.nan)
            for name in given.keys():
                try:
                    rows[names.index(str(name))] = np.asarray(given[name], dtype=float).reshape(self.dimensions)
                except (TypeError, ValueError):
                    raise InputError(f"the true position of {name} must be {self.dimensions} numbers, not {given[name]!r}") from None
        else:
            rows = real_matrix(kind, given)
        if rows.shape != (len(names), self.dimensions):
            raise InputError(f"true {kind} must have shape {(len(names), self.dimensions)}, not {rows.shape}")
        return [row.tolist() if np.isfinite(row).all() else None for row in rows]

    def locate(self, pseudoranges, *, sigma=None, speed=None, names=None, recorders=None):
        """Locate new transmitters in this network, each by itself.

        Parameters
        ----------
        pseudoranges : array_like of float, shape (m, n), or pandas.DataFrame, or Pseudoranges, or Heard
            What the receivers measure of them, as in `calibrate`: by the same clocks and at the same assumed speed; or what was
            heard in recordings, by `listen`. Receivers are known by their names, or by their order where they have none here.
        sigma : float or array_like of shape (m, n), optional
            Standard deviation of the measurements in metres; that of the calibration by default.
        speed : float, optional
            Propagation speed in metres a second that makes metres of times in seconds.
        names : list of str, or (list of str, list of str), or dict with receivers and transmitters, optional
            Names of the receivers, and of the transmitters.
        recorders : sequence of str, or dict of receiver to recorder, optional
            The recorder of each receiver, where recorders have clocks of their own, as in `calibrate`.

        Returns
        -------
        list of Place
            One for each transmitter: `position`, `covariance`, `outliers`, `unique`, `others`.

        Raises
        ------
        hc.InputError
            If a receiver is not in the network, or the measurements cannot be used.
        hc.UndeterminedError
            If this network is not to be trusted.

        Examples
        --------
        >>> import tdoa
        >>> made = tdoa.simulate(8, 30, noise=0.01, seed=1)
        >>> network = tdoa.calibrate(made.pseudoranges[:, :20])
        >>> places = network.locate(made.pseudoranges[:, 20:])
        >>> len(places), places[0].unique
        (10, True)
        """
        pseudoranges, recorders, _ = heard(pseudoranges, recorders, None)
        given, single, _ = table(pseudoranges, names, sigma, speed)
        count = len(given["values"])
        receivers = given["receivers"] or [f"r{i + 1}" for i in range(count)]
        found = _native.calibration_located(self._text, given, single, recorders_of(recorders, receivers))
        return [Place(place, self.dimensions) for place in json.loads(found)]

    def to_dataframe(self):
        """The nodes as a pandas.DataFrame, the table that `tdoa calibrate --nodes` writes.

        One row a node, receivers first: `kind`, `name`, coordinates, their standard deviations and covariances (with systematic errors
        where these are significant), `offset`, `std_offset`, and how many `measurements` it has and how many are `outliers`. Lengths in metres, NaN
        where nothing is determined.
        """
        import io

        try:
            import pandas
        except ImportError:
            raise InputError("to_dataframe needs pandas: pip install pandas") from None
        table = io.StringIO(_native.calibration_nodes(self._text))
        # A node may be named NA or 007.
        frame = pandas.read_csv(table, dtype=str, keep_default_na=False)
        for column in frame.columns[2:]:
            kind = int if column in ("measurements", "outliers") else float
            frame[column] = [kind(cell) if cell else np.nan for cell in frame[column]]
        return frame

    def plot(self, ax=None, *, names=True, view="xy"):
        """Draw the network as the report does: nodes with 95 % ellipses, outliers as lines, true positions if it was `compared`.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where; a new figure by default. Of projection "3d" for the view "3d".
        names : bool
            Whether nodes get their names.
        view : {"xy", "xz", "yz", "3d"}
            The coordinates to the right and upwards: from above by default, "xz" from the front, "yz" from the side; ellipses are the shadows
            of 95 % ellipsoids. "3d" shows the ellipsoids from anywhere. In the plane there is "xy" alone.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from ._plot import draw

        return draw(self, ax, names, view)

    def to_json(self):
        """The text that `tdoa calibrate --json` writes, to the last bit of every number."""
        return self._text

    def to_svg(self):
        """The picture of the report, as SVG text."""
        return _native.calibration_svg(self._text)

    def save_html(self, path):
        """Write the report for a browser: the picture, and tables of nodes and measurements; one file without references to others.

        Parameters
        ----------
        path : path
            The file.
        """
        page = _native.calibration_html(self._text)
        with open(os.fspath(path), "w", encoding="utf-8", newline="\n") as file:
            file.write(page)

    def __repr__(self):
        return _native.calibration_summary(self._text).rstrip()

    def _repr_html_(self):
        import html

        return f"<pre>{html.escape(repr(self))}</pre>{self.to_svg()}"

    def __eq__(self, other):
        return isinstance(other, Calibration) and self._text == other._text

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self):
        return Calibration, (self._text,)


def _rows(values, shape):
    """An array of rows of a shape, NaN in place of those that are None."""
    array = np.full((len(values), *shape), np.nan)
    for k, value in enumerate(values):
        if value is not None:
            array[k] = value
    return array


for _class in (Alternative, Calibration):
    _class.__module__ = "tdoa"
del _class

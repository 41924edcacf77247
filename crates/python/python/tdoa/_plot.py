"""The picture of a calibration by matplotlib, in the style of the report."""

import numpy as np

from hc import InputError, _native

from ._calibration import _rows

# The colours of the report: receivers, transmitters, outliers.
_BLUE, _ORANGE, _PINK = "#0072B2", "#D55E00", "#CC79A7"

# Transmitters farther than this many network sizes from the centre are left out; nodes of a kind that get names; outliers that are drawn.
_REACH, _NAMED, _OUTLIERS = 5.0, 80, 200

# Points of a unit sphere, by latitude and longitude.
_LATITUDES, _LONGITUDES = np.meshgrid(np.linspace(-np.pi / 2, np.pi / 2, 9), np.linspace(0, 2 * np.pi, 17))
_SPHERE = np.stack(
    [np.cos(_LATITUDES) * np.cos(_LONGITUDES), np.cos(_LATITUDES) * np.sin(_LONGITUDES), np.sin(_LATITUDES)], axis=-1
)


def draw(calibration, ax, names, view):
    views = ("xy",) if calibration.dimensions == 2 else ("xy", "xz", "yz", "3d")
    if view not in views:
        raise InputError(f"view must be {' or '.join(views)} of a network of {calibration.dimensions} dimensions, not {view!r}")
    try:
        import matplotlib.pyplot as pyplot
        from matplotlib.patches import Ellipse
    except ImportError:
        raise InputError("plot needs matplotlib: pip install matplotlib; or to_svg(), save_html(path)") from None
    solid = view == "3d"
    if ax is None:
        ax = pyplot.subplots(figsize=(8, 6), subplot_kw={"projection": "3d"} if solid else {})[1]
    elif solid != (ax.name == "3d"):
        raise InputError(f'view {view!r} needs axes that are {"" if solid else "not "}of projection "3d"')
    receivers, transmitters = calibration.receivers, calibration.transmitters
    located = receivers[np.isfinite(receivers).all(axis=1)]
    near = np.isfinite(transmitters).all(axis=1)
    if len(located):
        centre = located.mean(axis=0)
        size = np.sqrt(((located - centre) ** 2).sum(axis=1).mean())
        near &= np.linalg.norm(np.nan_to_num(transmitters) - centre, axis=1) <= _REACH * size
    # Transmitters are near by all coordinates, of which two or three are drawn.
    axes = ["xyz".index(letter) for letter in ("xyz" if solid else view)]
    receivers, transmitters = receivers[:, axes], transmitters[:, axes]
    outlying = np.argwhere(np.isfinite(calibration.residuals) & ~calibration.inliers)
    lines = [(i, j) for i, j in outlying if near[j] and np.isfinite(receivers[i]).all()]
    for i, j in lines[:_OUTLIERS]:
        ends = np.array([receivers[i], transmitters[j]])
        ax.plot(*ends.T, color=_PINK, linewidth=1, linestyle=(0, (5, 3)), zorder=1)
    deviation, magnified, systematic = _native.calibration_style(calibration.to_json())
    covariances = (calibration.covariance, calibration.transmitter_covariance)
    if systematic:
        covariances = (calibration.systematic_covariance, calibration.systematic_transmitter_covariance)
    shadows = [each[:, axes][:, :, axes] for each in covariances]
    radius = magnified * (calibration.data["ellipse_radius"] or 0.0)
    shape = "95 % ellipsoid" if solid else "95 % ellipse" if calibration.dimensions == 2 else "shadow of its 95 % ellipsoid"
    times = f", {magnified:g} times as large" if magnified > 1 else ""

    def ellipses(points, covariances, colour, shown):
        for point, covariance in zip(points[shown], covariances[shown]):
            if np.isfinite(covariance).all() and radius:
                values, vectors = np.linalg.eigh(covariance)
                if solid:
                    lengths = radius * np.sqrt(np.maximum(values, 0))
                    surface = point + (_SPHERE * lengths) @ vectors.T
                    ax.plot_surface(*np.moveaxis(surface, -1, 0), color=colour, alpha=0.15, linewidth=0, shade=False)
                    continue
                width, height = 2 * radius * np.sqrt(np.maximum(values, 0))
                angle = np.degrees(np.arctan2(vectors[1, 0], vectors[0, 0]))
                face = ax.add_patch(Ellipse(point, width, height, angle=angle, color=colour, alpha=0.15, zorder=2))
                face.set_clip_on(True)

    seen = np.isfinite(receivers).all(axis=1)
    ellipses(transmitters, shadows[1], _ORANGE, near)
    ellipses(receivers, shadows[0], _BLUE, seen)
    ax.plot(*transmitters[near].T, "o", color=_ORANGE, markersize=4, label=f"transmitter, with {shape}{times}", zorder=3)
    ax.plot(*receivers[seen].T, "^", color=_BLUE, markersize=8, label=f"receiver, with {shape}{times}", zorder=4)
    held = np.array(calibration.data["anchored"], dtype=bool) & seen
    if held.any():
        label = "receiver held at its known position"
        ax.plot(*receivers[held].T, "s", color="none", markeredgecolor="#000", markersize=12, label=label, zorder=5)
    nowhere = [[]] * len(axes)
    true = calibration.truth or {}
    known = [_rows(true.get(key, []), (calibration.dimensions,))[:, axes] for key in ("positions", "transmitter_positions")]
    for points, near_enough, size in zip(known, (seen, near), (9, 5)):
        # Of nodes that are far away, or nowhere, the true places are not drawn either.
        shown = points[near_enough & np.isfinite(points).all(axis=1)] if len(points) else points
        if len(shown):
            label = "true position" if size == 9 else None
            ax.plot(*shown.T, "x", color="#000", markersize=size, label=label, zorder=6)
    if systematic:
        ax.plot(*nowhere, " ", label="(with systematic errors of the receivers)")
    if len(lines):
        ax.plot(*nowhere, color=_PINK, linestyle=(0, (5, 3)), label=f"{len(outlying)} outliers")
    if names:
        nodes = [(calibration.receiver_names, receivers, seen, _BLUE)]
        nodes.append((calibration.transmitter_names, transmitters, near, _ORANGE))
        for texts, points, shown, colour in nodes:
            if shown.sum() <= _NAMED:
                for k in np.flatnonzero(shown):
                    if solid:
                        ax.text(*points[k], f" {texts[k]}", color=colour, fontsize=8)
                    else:
                        ax.annotate(texts[k], points[k], (5, 5), textcoords="offset points", color=colour, fontsize=8)
    title = f"{calibration.data['configuration']}, {deviation}"
    ax.set_title(title if calibration.trusted else f"{title}, NOT TO BE TRUSTED")
    if solid:
        ax.set_aspect("equal")
        ax.set_zlabel("z, m")
    else:
        ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel(f"{'xyz'[axes[0]]}, m")
    ax.set_ylabel(f"{'xyz'[axes[1]]}, m")
    ax.legend(fontsize=8)
    return ax

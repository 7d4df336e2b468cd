"""Pictures of fairings; Matplotlib is imported when one is drawn."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.colours import COLOURS
from moldloft.errors import Error
from moldloft.fairing.drawing import AFTER, BEFORE, MOVE, QUIET, WRONG, even_turns, exaggeration
from moldloft.fairing.spline import Samples, Spline, grid_metric

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from moldloft.fairing.faired import Fairing
    from moldloft.fairing.network import NetworkFairing
    from moldloft.fairing.surface import SurfaceFairing

    Floats = NDArray[np.float64]

__all__ = ["needed", "plot_curve", "plot_network", "plot_surface"]

ACCENT, INK, LINE = COLOURS["good"], COLOURS["ink"], COLOURS["line"]

STYLE = {
    "font.size": 8,
    "axes.titlesize": 9,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": LINE,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "svg.hashsalt": "moldloft",
    "axes.formatter.useoffset": False,
}


def needed() -> Any:
    """Matplotlib; if it is missing, an error with the command to install it."""
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ImportError as error:
        raise Error(
            "plots need Matplotlib, which is not installed: pip install 'moldloft[plot]'"
        ) from error
    return matplotlib, Figure


def _saved(draw: Any, size: tuple[float, float], path: str | PathLike[str]) -> None:
    from moldloft.exchange.files import Output, commit

    path = Path(path)
    kind = path.suffix.lower().removeprefix(".")
    if kind not in ("png", "svg"):
        raise Error(f"a plot is .png or .svg, not `{path}`")
    matplotlib, figure_class = needed()
    with matplotlib.rc_context(STYLE):
        figure = figure_class(figsize=size, layout="constrained")
        draw(figure)
        data = io.BytesIO()
        # No date: the same fairing gives the same file.
        metadata = {"Date": None} if kind == "svg" else {"Software": None}
        figure.savefig(data, format=kind, dpi=150, metadata=metadata)
    commit(path.parent, [Output(path.name, data.getvalue())], make=False)


def _plane(points: Floats) -> tuple[int, int]:
    """The two coordinates in which points spread most, in their order."""
    spread = np.ptp(points, axis=0)
    if spread[2] <= 1e-12 * spread.max():
        return 0, 1
    least = int(np.argmin(spread))
    rest = [c for c in range(3) if c != least]
    return rest[0], rest[1]


def _near_equal(ax: Any, x: Floats, y: Floats) -> None:
    """Equal scales, or for very slender shapes unequal scales with a note."""
    wide, high = float(np.ptp(x)), float(np.ptp(y))
    if high > 0 and wide > 0 and 0.12 <= high / wide <= 8:
        ax.set_aspect("equal", adjustable="datalim")
    elif high > 0 and wide > 0:
        ax.text(
            0.995,
            0.02,
            "scales differ",
            transform=ax.transAxes,
            ha="right",
            va="bottom",
            color=QUIET,
            fontsize=7,
        )


def plot_curve(fairing: Fairing, path: str | PathLike[str]) -> None:
    """Shape, zoom, curvature, comb, jumps, metric, displacement of a faired curve."""
    before, after = fairing.original.samples(12), fairing.spline.samples(12)

    def draw(figure: Any) -> None:
        axes = figure.subplots(4, 2)
        figure.suptitle(_title(fairing), fontsize=9, color=INK, ha="left", x=0.01)
        _shape(axes[0, 0], fairing, before, after)
        _zoom(axes[0, 1], fairing, before, after)
        _curvature(axes[1, 0], before, after)
        _comb(axes[1, 1], fairing)
        _jumps(axes[2, 0], fairing)
        _displacement(axes[2, 1], fairing)
        _metric(axes[3, 0], fairing, before, after)
        _logarithmic(axes[3, 1], fairing)

    _saved(draw, (10.0, 11.0), path)


def _title(fairing: Fairing) -> str:
    tol = "no tolerance" if fairing.tol is None else f"tolerance {fairing.tol:g}"
    b, a = fairing.before, fairing.after
    return (
        f"{len(fairing.data)} points, {fairing.mode} of `{fairing.measure}`, {tol}: squared jumps "
        f"{b.jumps:.3g} to {a.jumps:.3g}, monotone pieces {b.pieces} to {a.pieces}, inflections "
        f"{b.inflections} to {a.inflections}\n"
        f"deviation certified {fairing.deviation_certified:.4g}, sampled "
        f"{fairing.deviation_sampled:.4g} ({fairing.deviation_percent:.3g} % of the length)"
    )


def _shape(ax: Any, fairing: Fairing, before: Samples, after: Samples) -> None:
    i, j = _plane(before.points)
    ax.set_title("Shape")
    ax.plot(fairing.data[:, i], fairing.data[:, j], ".", ms=2.5, color=QUIET, label="points")
    ax.plot(before.points[:, i], before.points[:, j], color=BEFORE, lw=0.8, label="before")
    ax.plot(after.points[:, i], after.points[:, j], color=AFTER, label="after")
    marked = fairing.data[list(fairing.breaks)]
    if len(marked):
        ax.plot(marked[:, i], marked[:, j], "s", ms=5, mfc="none", color=ACCENT, label="breaks")
    wrong = [f.index for f in (*fairing.findings, *fairing.corrected) if f.kind == "outlier"]
    if wrong:
        ax.plot(*fairing.data[wrong][:, [i, j]].T, "x", ms=6, color=WRONG, label="wrong?")
    ax.set_xlabel("xyz"[i])
    ax.set_ylabel("xyz"[j])
    _near_equal(ax, before.points[:, i], before.points[:, j])
    ax.legend(loc="best")


def _zoom(ax: Any, fairing: Fairing, before: Samples, after: Samples) -> None:
    """Detail of the largest displacement, to scale, with the tolerance band."""
    i, j = _plane(before.points)
    ax.set_title("Zoom on the largest move")
    far = np.linalg.norm(after.points - before.points, axis=1)
    # Not at the very ends, where there is nothing on one side.
    inner = slice(len(far) // 20, len(far) - len(far) // 20)
    at = int(np.argmax(far[inner])) + inner.start if far.max() > 0 else len(far) // 2
    centre = before.points[at][[i, j]]
    away = np.linalg.norm(fairing.data[:, [i, j]] - centre, axis=1)
    spacing = float(np.sort(away)[min(4, len(away) - 1)])
    size = max(1.1 * spacing, 3.0 * float(far.max()))
    for samples, colour, width, label in (
        (before, BEFORE, 1.0, "before"),
        (after, AFTER, 1.5, "after"),
    ):
        ax.plot(samples.points[:, i], samples.points[:, j], color=colour, lw=width, label=label)
    if fairing.tol:
        tangent = before.first[:, [i, j]]
        length = np.linalg.norm(tangent, axis=1, keepdims=True)
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) / np.where(length > 0, length, 1)
        near = np.linalg.norm(before.points[:, [i, j]] - centre, axis=1) < 3 * size
        flat = before.points[:, [i, j]]
        band = [np.where(near[:, None], flat + k * fairing.tol * normal, np.nan) for k in (-1, 1)]
        for k, edge in enumerate(band):
            said = "tolerance" if k == 0 else None
            ax.plot(edge[:, 0], edge[:, 1], color=BEFORE, lw=0.6, ls=":", label=said)
    ax.plot(fairing.data[:, i], fairing.data[:, j], "o", ms=4, mfc="none", color=QUIET)
    height = np.abs(before.points[:, j] - centre[1])[
        np.abs(before.points[:, [i, j]] - centre).max(axis=1) < size
    ]
    tall = max(1.15 * float(height.max(initial=0.0)), 2.5 * float(far.max()), 0.02 * size)
    equal = tall > 0.6 * size
    # Limits that may give way (`auto`) to equal scales.
    ax.set_xlim(centre[0] - size, centre[0] + size, auto=equal)
    ax.set_ylim(centre[1] - tall, centre[1] + tall, auto=equal)
    if equal:
        ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("xyz"[i])
    ax.set_ylabel("xyz"[j])
    ax.legend(loc="best")


def _curvature(ax: Any, before: Samples, after: Samples) -> None:
    ax.set_title("Curvature")
    ax.plot(before.arc, before.curvature, color=BEFORE, lw=0.8, label="before")
    ax.plot(after.arc, after.curvature, color=AFTER, label="after")
    ax.set_xlabel("fraction of the arc length")
    ax.set_ylabel("curvature")
    bend = np.interp(np.linspace(0, 1, 1001), after.arc, np.abs(after.curvature))
    usual = float(np.median(bend))
    if usual > 0 and float(bend.max()) > 30 * usual:
        # A nose would swamp the rest.
        ax.set_yscale("symlog", linthresh=_decade(usual))
        ax.set_ylabel("curvature, logarithmic")
    else:
        _range(ax, before.curvature, after.curvature)
    ax.legend(loc="best")


def _decade(x: float) -> float:
    return float(10.0 ** np.floor(np.log10(x)))


def _range(ax: Any, before: Floats, after: Floats) -> None:
    """Range of the faired curve; rougher parts of the original are cut off, with a note."""
    low, high = float(after.min()), float(after.max())
    all_low, all_high = float(before.min()), float(before.max())
    room = max(high - low, 1e-9 * max(abs(high), abs(low), 1e-300))
    low, high = max(all_low, low - 0.6 * room), min(all_high, high + 0.6 * room)
    low, high = min(low, float(after.min())), max(high, float(after.max()))
    pad = 0.05 * (high - low) or 1.0
    ax.set_ylim(low - pad, high + pad)
    if all_low < low - pad or all_high > high + pad:
        ax.text(
            0.995,
            0.98,
            f"before: {all_low:.3g} to {all_high:.3g}",
            transform=ax.transAxes,
            ha="right",
            va="top",
            color=BEFORE,
            fontsize=7,
        )


def _comb(ax: Any, fairing: Fairing) -> None:
    ax.set_title("Curvature comb")
    after = fairing.spline.samples(6)
    i, j = _plane(after.points)
    largest = float(np.abs(after.curvature).max())
    extent = float(np.ptp(after.points, axis=0).max())
    scale = 0.25 * extent / largest if largest > 0 else 0.0
    feet, tips = fairing.original.comb(scale, 6)
    tips = _kept(feet, tips, 0.4 * extent)
    ax.plot(tips[:, i], tips[:, j], color=BEFORE, lw=0.6)
    even = even_turns(fairing.spline)
    if even.plane is None:
        feet, tips = fairing.spline.comb(scale, 6)
    else:
        # Teeth by length and turn alike: enough of them at a nose.
        left = np.cross(even.plane, even.first)
        size = np.linalg.norm(left, axis=1, keepdims=True)
        feet = even.points
        tips = feet - scale * even.curvature[:, None] * left / np.where(size > 0, size, 1)
    for a, b in zip(feet, tips, strict=True):
        ax.plot([a[i], b[i]], [a[j], b[j]], color=AFTER, lw=0.35, alpha=0.6)
    ax.plot(tips[:, i], tips[:, j], color=AFTER, lw=1.0)
    ax.plot(feet[:, i], feet[:, j], color=INK, lw=1.2)
    ax.set_xlabel("xyz"[i])
    ax.set_ylabel("xyz"[j])
    ax.set_aspect("equal", adjustable="datalim")


def _kept(feet: Floats, tips: Floats, longest: float) -> Floats:
    """Teeth cut to a length."""
    way = tips - feet
    length = np.linalg.norm(way, axis=1, keepdims=True)
    factor = np.minimum(1.0, longest / np.maximum(length, 1e-300))
    return np.asarray(feet + way * factor)


def _jumps(ax: Any, fairing: Fairing) -> None:
    ax.set_title("Jumps of the highest derivative")
    before, after = fairing.jump_lengths_before, fairing.jump_lengths_after
    if not len(before) or before.max() <= 0:
        ax.text(0.5, 0.5, "none", transform=ax.transAxes, ha="center", color=QUIET)
        return
    floor = 1e-6 * float(before.max())
    at = np.arange(1, len(before) + 1)
    for values, colour, label in ((before, BEFORE, "before"), (after, AFTER, "after")):
        shown = np.maximum(values, floor)
        ax.vlines(at, floor, shown, color=colour, lw=0.7, alpha=0.7)
        ax.plot(at, shown, ".", ms=3, color=colour, label=label)
    ax.set_yscale("log")
    ax.set_ylim(floor, 2 * float(before.max()))
    worst = int(np.argmax(before))
    ax.annotate(
        f"{before[worst]:.2g}",
        (at[worst], before[worst]),
        textcoords="offset points",
        xytext=(4, 0),
        fontsize=7,
        color=BEFORE,
        va="center",
    )
    ax.set_xlabel("knot")
    ax.set_ylabel("jump")
    ax.legend(loc="lower right")


def _displacement(ax: Any, fairing: Fairing) -> None:
    ax.set_title("Displacement in percent of the arc length")
    arc, percent = fairing.displacement
    ax.fill_between(arc, 0, percent, color=AFTER, alpha=0.18, lw=0)
    ax.plot(arc, percent, color=AFTER, lw=1.0)
    if fairing.tol and fairing.length > 0:
        bound = 100 * fairing.tol / fairing.length
        if percent.max() > 0.1 * bound:
            ax.axhline(bound, color=BEFORE, lw=0.8, ls="--", label="tolerance")
            ax.legend(loc="lower right")
    ax.set_ylim(0, None)
    ax.set_xlabel("fraction of the arc length")
    ax.set_ylabel("%")


def _around(samples: Samples, i: int, j: int) -> Floats:
    """A grid of straight lines off a plane curve, to a tenth of its extent.

    They follow the curve's course at large, and lean: on lines that are square to the curve the
    metric does not see its ripples.
    """
    points = samples.points[:, [i, j]]
    tangent = samples.first[:, [i, j]]
    size = np.linalg.norm(tangent, axis=1, keepdims=True)
    unit = tangent / np.where(size > 0, size, 1)
    width = max(3, len(unit) // 12) | 1
    padded = np.pad(unit, ((width // 2, width // 2), (0, 0)), mode="edge")
    kernel = np.ones(width) / width
    course = np.stack([np.convolve(padded[:, c], kernel, "valid") for c in (0, 1)], axis=1)
    angle = np.unwrap(np.arctan2(course[:, 1], course[:, 0]))
    outward = -1.0 if samples.curvature.mean() > 0 else 1.0
    angle = angle + outward * (np.pi / 2 - 0.5)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    far = 0.1 * float(np.ptp(points, axis=0).max()) * np.linspace(0, 1, 11)
    return np.asarray(points[:, None, :] + far[None, :, None] * way[:, None, :])


def _metric(ax: Any, fairing: Fairing, before: Samples, after: Samples) -> None:
    """The report's check of a derived grid: eta_y along its second line off the body."""
    ax.set_title("Metric of a grid round the curve, $|\\eta_y|$")
    i, j = _plane(before.points)
    curves: list[Floats] = []
    for spline, colour, label in (
        (fairing.original, BEFORE, "before"),
        (fairing.spline, AFTER, "after"),
    ):
        samples = spline.at(np.linspace(0, 1, 4 * len(fairing.data) + 1))
        metric = np.abs(grid_metric(_around(samples, i, j))[:, 1])
        curves.append(metric)
        ax.plot(samples.arc, metric, color=colour, lw=0.8 if colour == BEFORE else 1.1, label=label)
    ax.set_xlabel("fraction of the arc length")
    ax.set_ylabel("$|\\eta_y|$")
    # Most of it: where the curve is steep the metric falls to zero.
    inner = np.percentile(curves[1], [15, 99])
    room = 0.5 * float(inner[1] - inner[0]) + 0.01 * float(inner[1])
    if room > 0:
        ax.set_ylim(inner[0] - room, inner[1] + room)
    ax.legend(loc="best")


def _logarithmic(ax: Any, fairing: Fairing) -> None:
    ax.set_title("Logarithmic curvature graph")
    for spline, colour, label in (
        (fairing.original, BEFORE, "before"),
        (fairing.spline, AFTER, "after"),
    ):
        graph = spline.logarithmic_curvature(8)
        if len(graph):
            ax.plot(graph[:, 0], graph[:, 1], ".", ms=1.6, color=colour, label=label)
    if not ax.lines:
        ax.text(0.5, 0.5, "for plane curves", transform=ax.transAxes, ha="center", color=QUIET)
        return
    graph = fairing.spline.logarithmic_curvature(8)
    if len(graph):
        for axis, values in ((ax.set_xlim, graph[:, 0]), (ax.set_ylim, graph[:, 1])):
            low, high = np.percentile(values, [1, 99])
            room = 0.4 * float(high - low) + 0.2
            axis(low - room, high + room)
    ax.set_xlabel("log of the radius")
    ax.set_ylabel("log |radius ds / d radius|")
    ax.legend(loc="best", markerscale=4)


def plot_surface(fairing: SurfaceFairing, path: str | PathLike[str]) -> None:
    """Shape, curvature, zebra and displacement of a faired surface."""
    # Enough for the edges of the bands to be smooth.
    count_u, count_v = (min(max(4 * n + 1, 121), 241) for n in fairing.data.shape[:2])
    looks = [s.look(count_u, count_v) for s in (fairing.original, fairing.surface)]
    u, v = np.linspace(0, 1, count_u), np.linspace(0, 1, count_v)

    def draw(figure: Any) -> None:
        figure.suptitle(
            f"{fairing.data.shape[0]} x {fairing.data.shape[1]} points, {fairing.mode} of "
            f"`{fairing.measure}`: squared jumps {fairing.jumps_before:.3g} to "
            f"{fairing.jumps_after:.3g}, deviation certified {fairing.deviation_certified:.4g} "
            f"({fairing.deviation_percent:.3g} % of the extent)",
            fontsize=9,
            color=INK,
            ha="left",
            x=0.01,
        )
        grid = figure.add_gridspec(4, 2)
        for k, (look, word) in enumerate(zip(looks, ("before", "after"), strict=True)):
            _lines_of_surface(figure.add_subplot(grid[0, k]), look.points, word)
        gaussian = [look.gaussian for look in looks]
        _fields(figure, grid[1, :], gaussian, u, v, "Gaussian curvature", "RdBu_r", symmetric=True)
        mean = [look.mean for look in looks]
        _fields(figure, grid[2, :], mean, u, v, "Mean curvature", "RdBu_r", symmetric=True)
        light = _light(looks[1].normals)
        bands = [np.sin(24 * np.pi * look.isophotes(light)) for look in looks]
        sub = grid[3, :].subgridspec(1, 3)
        for k, (band, word) in enumerate(zip(bands, ("before", "after"), strict=True)):
            ax = figure.add_subplot(sub[0, k])
            ax.set_title(f"Isophotes {word}")
            ax.contourf(u, v, band.T, levels=[-2.0, 0.0, 2.0], colors=[INK, "white"])
            _uv(ax)
        ax = figure.add_subplot(sub[0, 2])
        ax.set_title("Displacement")
        moved = np.linalg.norm(looks[1].points - looks[0].points, axis=2)
        picture = ax.pcolormesh(u, v, moved.T, cmap="viridis", shading="gouraud")
        figure.colorbar(picture, ax=ax)
        _uv(ax)

    _saved(draw, (10.0, 11.0), path)


def _light(normals: Floats) -> Floats:
    """A light direction at about 60 degrees to the mean normal, which gives isophotes."""
    mean = np.nanmean(normals.reshape(-1, 3), axis=0)
    size = float(np.linalg.norm(mean))
    if size < 1e-9:
        return np.array([0.0, 0.0, 1.0])
    mean = mean / size
    side = np.cross(mean, np.eye(3)[int(np.argmin(np.abs(mean)))])
    return np.asarray(0.5 * mean + 0.87 * side / np.linalg.norm(side))


def _uv(ax: Any) -> None:
    ax.set_xlabel("u")
    ax.set_ylabel("v")
    ax.grid(False)


def _lines_of_surface(ax: Any, points: Floats, word: str) -> None:
    ax.set_title(f"Lines {word}, seen aslant")
    # A parallel projection from the fore quarter; thin bodies are widened.
    spread = np.maximum(np.ptp(points.reshape(-1, 3), axis=0), 1e-300)
    scaled = (points - points.reshape(-1, 3).min(axis=0)) / spread
    scaled = scaled * np.maximum(spread / spread.max(), 0.35)
    x = scaled[..., 0] + 0.5 * scaled[..., 1]
    y = scaled[..., 2] + 0.35 * scaled[..., 1]
    m, n = x.shape
    for k in np.unique(np.linspace(0, m - 1, 21).astype(int)):
        ax.plot(x[k], y[k], color=BEFORE if word == "before" else AFTER, lw=0.6)
    for k in np.unique(np.linspace(0, n - 1, 9).astype(int)):
        ax.plot(x[:, k], y[:, k], color=INK, lw=0.6)
    ax.set_aspect("equal")
    ax.axis("off")


def _fields(
    figure: Any,
    place: Any,
    fields: Sequence[Floats],
    u: Floats,
    v: Floats,
    name: str,
    colours: str,
    *,
    symmetric: bool,
) -> None:
    """Two maps on one scale, that of the faired surface."""
    sub = place.subgridspec(1, 2)
    finite = fields[1][np.isfinite(fields[1])]
    low, high = np.percentile(finite, [1, 99]) if len(finite) else (0.0, 1.0)
    if symmetric:
        high = max(abs(low), abs(high)) or 1.0
        low = -high
    axes = []
    picture = None
    for k, (field, word) in enumerate(zip(fields, ("before", "after"), strict=True)):
        ax = figure.add_subplot(sub[0, k])
        ax.set_title(f"{name} {word}")
        picture = ax.pcolormesh(u, v, field.T, cmap=colours, vmin=low, vmax=high, shading="gouraud")
        _uv(ax)
        axes.append(ax)
    figure.colorbar(picture, ax=axes, shrink=0.9)


def plot_network(fairing: NetworkFairing, path: str | PathLike[str]) -> None:
    """The three views of a network before and after, and the displacements of its points."""

    def lines(ax: Any, curves: Sequence[Spline], i: int, j: int, colour: str, width: float) -> None:
        for curve in curves:
            points = curve.samples(6).points
            ax.plot(points[:, i], points[:, j], color=colour, lw=width)

    given = np.zeros((len(fairing.data), 3))
    given[:, : fairing.data.shape[1]] = fairing.data
    faired = given.copy()
    faired[:, : fairing.points.shape[1]] = fairing.points
    moved = np.linalg.norm(faired - given, axis=1)
    factor = exaggeration(moved, float(np.ptp(given, axis=0).max()))

    def draw(figure: Any) -> None:
        figure.suptitle(
            f"{len(fairing.curves)} curves, {fairing.shared} shared points: squared jumps "
            f"{fairing.jumps_before:.3g} to {fairing.jumps_after:.3g}, deviation certified "
            f"{fairing.deviation_certified:.4g}\nbefore orange, after blue; moves of the points "
            f"(purple) {factor:g} times as long",
            fontsize=9,
            color=INK,
            ha="left",
            x=0.01,
        )
        axes = figure.subplots(2, 2)
        tips = given + factor * (faired - given)
        views = (("Plan", 0, 1), ("Body plan", 1, 2))
        for ax, (name, i, j) in zip(axes.flat, views, strict=False):
            ax.set_title(name)
            lines(ax, fairing.originals, i, j, BEFORE, 0.6)
            lines(ax, fairing.curves, i, j, AFTER, 0.9)
            for a, b in zip(given, tips, strict=True):
                ax.plot([a[i], b[i]], [a[j], b[j]], color=MOVE, lw=0.8)
            ax.set_xlabel("xyz"[i])
            ax.set_ylabel("xyz"[j])
            _near_equal(ax, given[:, i], given[:, j])
        ax = axes[1, 0]
        ax.set_title("Curvature along the curves")
        for curves, colour, width in (
            (fairing.originals, BEFORE, 0.5),
            (fairing.curves, AFTER, 0.8),
        ):
            for curve in curves:
                samples = curve.samples(8)
                ax.plot(samples.arc, samples.curvature, color=colour, lw=width)
        ax.set_xlabel("fraction of the arc length")
        after = np.concatenate([c.samples(8).curvature for c in fairing.curves])
        before = np.concatenate([c.samples(8).curvature for c in fairing.originals])
        _range(ax, before, after)
        ax = axes[1, 1]
        i, j = _plane(given)
        if {i, j} == {0, 1} and np.ptp(given[:, 2]) > 0:
            i, j = 0, 2
        ax.set_title("Displacements of the points")
        lines(ax, fairing.curves, i, j, LINE, 0.5)
        most = fairing.tol or float(moved.max()) or 1.0
        dots = ax.scatter(
            given[:, i], given[:, j], c=moved, s=14, cmap="viridis", vmin=0, vmax=most
        )
        figure.colorbar(dots, ax=ax, label="move, to the tolerance" if fairing.tol else "move")
        ax.set_xlabel("xyz"[i])
        ax.set_ylabel("xyz"[j])

    _saved(draw, (10.0, 8.0), path)

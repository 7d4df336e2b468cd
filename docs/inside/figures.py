"""Draws the figures of docs/inside: `python docs/inside/figures.py [NAME ...]`, with Matplotlib.

Shapes, meshes, branches and optima come from Moldloft itself. The search cells of `branches` come
from `search` here, which follows `locate::branches` with bounds for a torus.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import moldloft
from moldloft import implicit

HERE = Path(__file__).parent
BLUE, ORANGE, GREEN, GREY, RED = "#3b6ea8", "#d9822b", "#4f9a62", "#9aa0a6", "#b3323c"
plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "axes.linewidth": 0.6})


def example(page: str, number: int = 0) -> str:
    """The text of a model in a page: the first literal between triple quotes."""
    return (HERE / f"{page}.md").read_text(encoding="utf-8").split('"""')[2 * number + 1]


def save(figure: plt.Figure, name: str) -> None:
    figure.savefig(HERE / f"{name}.png", dpi=110, metadata={"Software": None})
    plt.close(figure)


def bare(axes: plt.Axes) -> None:
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)


def change() -> None:
    """The graph of the example, after `h = 3`."""
    at = {
        "O": (0, 0),
        "ground": (1.3, 0),
        "top": (2.6, 0),
        "foot": (1.5, 1),
        "base": (0.7, 2),
        "mast": (3.5, 2),
    }
    links = [
        ("ground", "foot"),
        ("top", "foot"),
        ("O", "base"),
        ("foot", "base"),
        ("foot", "mast"),
        ("top", "mast"),
    ]
    colour = {"top": ORANGE, "mast": ORANGE, "foot": BLUE}
    label = {
        "top": "new bits: its children\nare queued",
        "foot": "evaluated, same bits:\nthe wave stops here",
        "base": "not evaluated",
        "mast": "evaluated: parent top changed",
        "O": "not evaluated",
        "ground": "not evaluated",
    }
    figure, axes = plt.subplots(figsize=(8, 3.9), layout="constrained")
    for a, b in links:
        live = a == "top"
        arrow = FancyArrowPatch(
            at[a],
            at[b],
            arrowstyle="-|>",
            mutation_scale=12,
            shrinkA=16,
            shrinkB=16,
            color=ORANGE if live else GREY,
            lw=1.8 if live else 1,
            ls="-" if live else "--",
        )
        axes.add_patch(arrow)
    for name, (x, y) in at.items():
        axes.add_patch(Circle((x, y), 0.17, color=colour.get(name, "#d8dbde"), zorder=3))
        ink = "white" if name in colour else "black"
        axes.text(
            x,
            y,
            name,
            ha="center",
            va="center",
            zorder=4,
            color=ink,
            fontsize=6.5 if len(name) > 5 else 8,
            weight="bold",
        )
        axes.text(x + 0.23, y - 0.05, label[name], ha="left", va="center", fontsize=8)
    for rank in range(3):
        axes.text(-0.75, rank, f"rank {rank}", va="center", color="#555")
        axes.axhline(rank + 0.5, xmin=0.02, color="#e3e5e8", lw=0.8, zorder=0)
    axes.annotate(
        "h = 3",
        (2.6, -0.18),
        (2.6, -0.62),
        ha="center",
        va="center",
        color=ORANGE,
        arrowprops={"arrowstyle": "-|>", "color": ORANGE},
    )
    axes.set(xlim=(-0.9, 5.2), ylim=(2.45, -0.8), aspect="equal")
    bare(axes)
    save(figure, "change")


def joins() -> None:
    """The mesh of the example, drawn in the plane, and its roots and counts."""
    model = moldloft.loads(example("joins"))
    mesh = model.mesh()
    flat = mesh.vertices[:, [0, 2]] + mesh.vertices[:, 1, None] * [0, 0.9]
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10, 4.2), width_ratios=[1, 1.25], layout="constrained"
    )

    left.set_title("1, 2: one root, its marks, and the counts")
    t = np.linspace(0, 1, 60)
    keel = model["keel"](t)
    line = keel[:, [0, 2]] + keel[:, 1, None] * [0, 0.9]
    bead = keel[np.argmin(abs(t - 0.4))]
    corner = {"A": line[0], "b": bead[[0, 2]] + [0, 0.9 * bead[1]], "C": line[-1]}
    top, low = np.array([[0, 2.0], [4, 2.0]]), np.array([[0, -2.0], [2, -2.0], [4, -2.0]])
    split = int(np.argmin(abs(t - 0.4)))
    for outline, fill, name, where in [
        (np.vstack([line, top[::-1]]), BLUE, "side\nu: 8 = 3 + 5", (2, 1.35)),
        (np.vstack([line[: split + 1], low[[1, 0]]]), ORANGE, "fore\nu: 3 stated", (0.85, -1.0)),
        (np.vstack([line[split:], low[[2, 1]]]), GREEN, "aft\nu: 5 stated", (2.9, -1.0)),
    ]:
        left.add_patch(plt.Polygon(outline, color=fill, alpha=0.25, lw=0))
        left.text(*where, name, ha="center", va="center")
    left.plot(*line.T, color="black", lw=2)
    left.annotate(
        "root keel", line[50], (3.5, 0.85), ha="center", arrowprops={"arrowstyle": "-", "lw": 0.6}
    )
    for name, p in corner.items():
        left.plot(*p, "o", color=RED if name == "b" else "black", ms=7)
        left.annotate(
            {"A": "t = 0", "b": "bead b, t = 0.4", "C": "t = 1"}[name],
            p,
            (p[0], p[1] + 0.28),
            ha="center",
            fontsize=8,
        )
    for k, text in [(10, "interval 1"), (42, "interval 2")]:
        left.text(*(line[k] - [0, 0.25]), text, ha="center", fontsize=8, style="italic")
    left.set(xlim=(-0.3, 4.3), ylim=(-2.2, 2.2), aspect="equal")
    bare(left)

    right.set_title("3, 4: divisions, and the vertices that patches share (45 vertices in all)")
    owners: dict[int, set[str]] = {}
    faces = mesh.faces
    for patch, fill in zip(mesh.patches, [BLUE, ORANGE, GREEN], strict=True):
        for quad in faces[patch.start : patch.stop]:
            right.add_patch(
                plt.Polygon(flat[quad], facecolor=fill, alpha=0.25, edgecolor=fill, lw=1)
            )
            for v in quad:
                owners.setdefault(int(v), set()).add(patch.name)
    for v, names in owners.items():
        shared = len(names)
        right.plot(*flat[v], "o", ms=[3, 6, 8][shared - 1], color=["black", BLUE, RED][shared - 1])
    right.plot([], [], "o", ms=3, color="black", label="of one patch")
    right.plot([], [], "o", ms=6, color=BLUE, label="of two")
    right.plot([], [], "o", ms=8, color=RED, label="of three: the bead")
    right.legend(loc="center left", bbox_to_anchor=(1, 0.5), fontsize=8)
    right.set(xlim=(-0.3, 4.3), ylim=(-2.2, 2.2), aspect="equal")
    bare(right)
    save(figure, "joins")


def facets() -> None:
    """A plane analogue of one block, and a set as facets."""
    figure = plt.figure(figsize=(10, 4.6), layout="constrained")
    plane = figure.add_subplot(1, 2, 1)
    primitives = [
        (lambda p: 0.45 - p[0], lambda p: np.array([-1.0, 0]), GREY),
        (lambda p: -p[1] + 0.9, lambda p: np.array([0, -1.0]), BLUE),
        (lambda p: p[0] - 6.3 + 0.35 * (p[1] - 4), lambda p: np.array([1.0, 0.35]), ORANGE),
        (
            lambda p: np.hypot(p[0] - 2.6, p[1] - 0.9) - 4.6,
            lambda p: (p - [2.6, 0.9]) / np.hypot(*(p - [2.6, 0.9])),
            GREEN,
        ),
    ]

    def value(p: np.ndarray) -> float:
        return max(f(p) for f, _, _ in primitives)

    def winner(p: np.ndarray) -> int:
        return int(np.argmax([f(p) for f, _, _ in primitives]))

    crossings: dict[tuple[int, int, int], tuple[np.ndarray, int]] = {}
    for i in range(9):
        for j in range(9):
            for axis in range(2):
                a = np.array([i, j], float)
                b = a + np.eye(2)[axis]
                if b.max() > 8 or (value(a) <= 0) == (value(b) <= 0):
                    continue
                low, high = (a, b) if value(a) <= 0 else (b, a)
                for _ in range(60):
                    middle = (low + high) / 2
                    low, high = (middle, high) if value(middle) <= 0 else (low, middle)
                crossings[i, j, axis] = (low, winner(low))
    vertices = {}
    for i in range(8):
        for j in range(8):
            edges = [(i, j, 0), (i, j + 1, 0), (i, j, 1), (i + 1, j, 1)]
            own = [crossings[e] for e in edges if e in crossings]
            if not own:
                continue
            p = np.mean([q for q, _ in own], axis=0)
            shown = sorted({k for _, k in own})
            for _ in range(20):
                rows = np.array([primitives[k][1](p) for k in shown])
                off = np.array([primitives[k][0](p) for k in shown])
                norms = np.linalg.norm(rows, axis=1)
                p = p - np.linalg.pinv(rows / norms[:, None]) @ (off / norms)
            vertices[i, j] = (p, shown)
    for k in range(9):
        plane.axhline(k, color="#dfe2e6", lw=0.8, zorder=0)
        plane.axvline(k, color="#dfe2e6", lw=0.8, zorder=0)
        for j in range(9):
            solid = value(np.array([k, j], float)) <= 0
            plane.plot(k, j, "o", ms=3.5, color="black", mfc="black" if solid else "white", mew=0.7)
    for (i, j, axis), (_, k) in crossings.items():
        cells = [(i, j), (i, j - 1)] if axis == 0 else [(i, j), (i - 1, j)]
        if all(c in vertices for c in cells):
            (p, _), (q, _) = vertices[cells[0]], vertices[cells[1]]
            plane.plot([p[0], q[0]], [p[1], q[1]], color=primitives[k][2], lw=2.2)
    for p, k in crossings.values():
        plane.plot(*p, "x", color=primitives[k][2], ms=6, mew=1.6)
    for p, shown in vertices.values():
        plane.plot(
            *p,
            "s",
            color=RED if len(shown) > 1 else "#444",
            ms=7 if len(shown) > 1 else 4,
            zorder=5,
        )
    plane.set_title(
        "the same steps in the plane: signs at the corners, the primitive that\n"
        "decides at each crossing (x), a vertex per cell on all it shows (squares)"
    )
    plane.set(xlim=(-0.4, 8.4), ylim=(-0.4, 8.4), aspect="equal")
    bare(plane)

    solid = figure.add_subplot(1, 2, 2, projection="3d")
    line = implicit.cylinder((0, 0, 0), (0, 0, 1), 0.45)
    body = implicit.cuboid((-1, -1, -0.6), (1, 1, 0.6)) & implicit.Set(
        implicit.sphere((0, 0, 0), 1.25)
    ) - implicit.Set(line)
    made = body.facets((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), depth=4)
    light = np.array([0.4, -0.7, 0.9]) / np.linalg.norm([0.4, -0.7, 0.9])
    palette = plt.get_cmap("tab10")
    corners = made.vertices[made.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    shade = 0.55 + 0.45 * np.clip(normal @ light / np.linalg.norm(normal, axis=1), 0, 1)
    colours = np.array([palette(k % 10)[:3] for k in made.primitive]) * shade[:, None]
    solid.add_collection3d(
        Poly3DCollection(corners, facecolors=colours, edgecolors="#222", linewidths=0.25)
    )
    solid.set(xlim=(-0.95, 0.95), ylim=(-0.95, 0.95), zlim=(-0.95, 0.95), box_aspect=(1, 1, 1))
    solid.view_init(32, -58)
    solid.set_axis_off()
    solid.set_title(
        f"a box and a ball less a cylinder: {len(made.triangles)} triangles,\n"
        "a colour per primitive, vertices on every edge and corner"
    )
    save(figure, "facets")


TURN = 2 * np.pi


def torus(u: float, v: float) -> np.ndarray:
    r = 2 + np.cos(TURN * u)
    return np.array([r * np.cos(TURN * v), r * np.sin(TURN * v), np.sin(TURN * u)])


def search(d: float) -> tuple[list[tuple[float, float, float, float, str]], int]:
    """The cells that remain for the plane x = d, and the number of cells examined."""
    found, looked = [], 0
    stack = [(0.5, 0.5, 0.5, 0.5)]
    plane = np.array([1.0, 0, 0])
    while stack:
        u, v, h, k = stack.pop()
        looked += 1
        c, s = np.cos(TURN * u), np.sin(TURN * u)
        cv, sv = np.cos(TURN * v), np.sin(TURN * v)
        a = TURN * h * np.array([-s * cv, -s * sv, c])
        b = TURN * k * (2 + c) * np.array([-sv, cv, 0])
        bend = TURN**2 * (0.5 * h * h + h * k + 1.5 * k * k)
        if abs(torus(u, v)[0] - d) > abs(plane @ a) + abs(plane @ b) + bend:
            continue
        normal = np.array([c * cv, c * sv, s])
        simple = np.linalg.norm(np.cross(normal, plane)) > TURN * (h + k)
        if simple or max(h, k) < 0.008:
            found.append((u, v, h, k, "simple" if simple else "small"))
        elif h >= k:
            stack += [(u - h / 2, v, h / 2, k), (u + h / 2, v, h / 2, k)]
        else:
            stack += [(u, v - k / 2, h, k / 2), (u, v + k / 2, h, k / 2)]
    return found, looked


def branches() -> None:
    """Cells, seeds and branches of a torus and three planes."""
    model = moldloft.loads(example("branches"))
    figure, all_axes = plt.subplots(1, 3, figsize=(11, 4.6))
    figure.subplots_adjust(left=0.06, right=0.98, bottom=0.2, top=0.9)
    for axes, d in zip(all_axes, (0.5, 1.001, 2.5), strict=True):
        cells, looked = search(d)
        for u, v, h, k, kind in cells:
            axes.add_patch(
                Rectangle(
                    (u - h, v - k),
                    2 * h,
                    2 * k,
                    facecolor="#cfe0f3" if kind == "simple" else "#f4c9a0",
                    edgecolor="#7f9fc0" if kind == "simple" else ORANGE,
                    lw=0.5,
                )
            )
        cut = model["torus"].intersect(f"x={d}")
        for branch in cut.branches:
            q = branch.parameters.copy()
            jump = np.abs(np.diff(q, axis=0)).max(axis=1) > 0.5
            q = np.insert(q, np.flatnonzero(jump) + 1, np.nan, axis=0)
            axes.plot(*q.T, color="black", lw=1.4)
            axes.plot(*branch.parameters[0], "o", color=RED, ms=7, zorder=5)
        axes.set(
            xlim=(0, 1),
            ylim=(0, 1),
            aspect="equal",
            xlabel="u (round the tube)",
            xticks=[0, 0.5, 1],
            yticks=[0, 0.5, 1],
        )
        word = "branch" if len(cut.branches) == 1 else "branches"
        axes.set_title(
            f"x = {d}: {len(cut.branches)} closed {word};\n{looked} cells seen, {len(cells)} left"
        )
    all_axes[0].set_ylabel("v (round the axis)")
    handles = [
        Rectangle((0, 0), 1, 1, facecolor="#cfe0f3", edgecolor="#7f9fc0"),
        Rectangle((0, 0), 1, 1, facecolor="#f4c9a0", edgecolor=ORANGE),
        plt.Line2D([], [], color="black"),
        plt.Line2D([], [], color=RED, marker="o", ls=""),
    ]
    words = ["one line at most", "undecided at the smallest size", "branch", "its start"]
    figure.legend(handles, words, loc="lower center", ncols=4, fontsize=8)
    save(figure, "branches")


def certificate() -> None:
    """The example's points, and the tangent bound in one variable."""
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10, 3.8), width_ratios=[1.5, 1], layout="constrained"
    )
    noise = [0, 0.1, 0.02, 0.3, 0.1, 0.12, 0]
    d0 = np.array([(i, y, 0) for i, y in enumerate(noise)], dtype=float)
    r = 0.08
    points = moldloft.fair(d0, r, as_="control", measure="second", ends="free").points
    error = points[:-2] - 2 * points[1:-1] + points[2:]
    slope = np.zeros_like(d0)
    for k, e in enumerate(error):
        slope[k : k + 3] += np.outer([2, -4, 2], e)
    left.plot(d0[:, 0], d0[:, 1], "--", color=GREY, lw=1, label="data")
    left.plot(points[:, 0], points[:, 1], "-o", color=BLUE, ms=4, label="optimum")
    for p, q, g in list(zip(d0, points, slope, strict=True)):
        left.errorbar(p[0], p[1], yerr=r, color=GREY, capsize=4, lw=1)
        if abs(g[1]) > 1e-9:
            left.annotate(
                "",
                q[:2] - [0, 0.12 * g[1] / np.abs(slope[:, 1]).max()],
                q[:2],
                arrowprops={"arrowstyle": "-|>", "color": RED, "lw": 1.6},
            )
    left.plot([], [], color=RED, label="force, -g: against the limit")
    left.errorbar([], [], yerr=[], color=GREY, capsize=4, label="tolerance 0.08")
    left.legend(fontsize=8, loc="upper right")
    left.set_title("the example: limits that are reached carry a force")
    left.set(xlabel="x", ylabel="y (enlarged)", ylim=(-0.32, 0.42))

    y = np.linspace(-1, 1, 200)

    def f(t: np.ndarray | float) -> np.ndarray | float:
        return 0.35 * (t + 1.6) ** 2 + 0.3

    right.plot(y, f(y), color="black", lw=1.8, label="f")
    for at, colour, name in [
        (-0.2, ORANGE, "a point before the optimum"),
        (-1.0, BLUE, "the optimum"),
    ]:
        g = 0.7 * (at + 1.6)
        right.plot(y, f(at) + g * (y - at), color=colour, lw=1, ls="--")
        right.plot(at, f(at), "o", color=colour, label=name)
    bound = f(-0.2) + 0.7 * 1.4 * (-0.8)
    right.plot(-1, bound, "s", color=ORANGE, ms=5)
    right.plot([-1, -0.2], [f(-0.2)] * 2, color=ORANGE, lw=0.6)
    right.annotate(
        "", (-0.93, bound), (-0.93, f(-0.2)), arrowprops={"arrowstyle": "<->", "color": ORANGE}
    )
    right.text(
        -0.9,
        (bound + f(-0.2)) / 2 + 0.05,
        "gap",
        color=ORANGE,
        va="center",
        bbox={"color": "white", "pad": 1},
    )
    for limit in (-1, 1):
        right.axvline(limit, color=GREY, lw=1)
    right.text(-0.99, 3.0, " limit", color="#555", fontsize=8)
    right.text(0.99, -0.15, "limit ", color="#555", fontsize=8, ha="right")
    right.set(
        ylim=(-0.3, 3.2),
        xlabel="one variable",
        xticks=[-1, 0, 1],
        xticklabels=["-r", "0", "r"],
        yticks=[],
    )
    right.legend(fontsize=8, loc="upper center")
    right.set_title("a tangent's least value on the limits\nis a bound for every allowed curve")
    save(figure, "certificate")


FIGURES = {f.__name__: f for f in (change, joins, facets, branches, certificate)}

if __name__ == "__main__":
    for name in sys.argv[1:] or FIGURES:
        FIGURES[name]()

"""Gradients by many literals: reverse mode beside forward mode, and beside JAX.

Run with `python benches/gradient.py`; JAX is named when it is not installed. Hull B is a `BSurf` of
14 x 25 points, hull C a `CLoftSurf` through 14 `BCurve` of 25: 1050 coordinates. Times are the
least of several repetitions and processor time. An evaluation sets all coordinates and finds the
vertices, or the number that is differentiated. JAX has the area of the panels of hull B. pyGeo is
on no package index.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import moldloft
from moldloft import _core


def least(work: Callable[[], object], seconds: float = 0.6) -> float:
    """The least processor time of one call, in seconds."""
    best, end = float("inf"), time.perf_counter() + seconds
    while best == float("inf") or time.perf_counter() < end:
        start = time.process_time()
        work()
        best = min(best, time.process_time() - start)
    return best


def points(stations: int, each: int) -> np.ndarray:
    """The control points of half a hull, (stations, each, 3)."""
    i, j = np.meshgrid(np.arange(stations), np.arange(each), indexing="ij")
    along, s = i / (stations - 1), j / (each - 1)
    half = 1.2 * (1 - (2 * along - 1) ** 2) + 0.02
    y = half * np.sin(np.pi / 2 * s) ** 0.8
    z = -0.8 * np.cos(np.pi / 2 * s) * (0.6 + 0.4 * half / 1.2) + 0.4 * s
    return np.stack([10 * along + 0.01 * np.sin(3 * i + j), y, z], axis=2)


def hull(kind: str, net: np.ndarray, divisions: int) -> moldloft.Model:
    """The hull of these points."""
    lines, rows = [], []
    for i, station in enumerate(net):
        names = [f"P{i}_{j}" for j in range(len(station))]
        for name, (x, y, z) in zip(names, station.tolist(), strict=True):
            lines.append(f"AbsPoint {name}({x!r}, {y!r}, {z!r});")
        rows.append(", ".join(names))
    size = f"divisions = {{{divisions}, {divisions}}}"
    if kind == "B":
        nu, nv = net.shape[:2]
        lines.append(f"BSurf hull({{{', '.join(rows)}}}, nu = {nu}, nv = {nv}, {size});")
    else:
        lines += [f"BCurve c{i}({{{row}}}, visible = 0);" for i, row in enumerate(rows)]
        lines.append(f"CLoftSurf hull({{{', '.join(f'c{i}' for i in range(len(net)))}}}, {size});")
    m = moldloft.loads("\n".join(lines))
    # Its ends are open below the water.
    m.partial = True
    return m


#: What is differentiated.
OUTPUTS = ("mesh", "mesh.volume", "hydrostatics.volume", "hydrostatics.kmt")


def evaluations(m: moldloft.Model, names: list[str]) -> dict[str, float]:
    """Seconds of an evaluation of each output, all coordinates set."""
    values = [(name, m.eval(name)) for name in names]
    count = 0

    def move() -> None:
        nonlocal count
        count += 1
        m._document.set([(name, x + 1e-9 * count) for name, x in values])

    def evaluated(output: str) -> None:
        move()
        if output == "mesh":
            m.mesh().vertices  # noqa: B018
        else:
            m.eval(output)

    found = {output: least(partial(evaluated, output)) for output in OUTPUTS}
    m._document.set(values)
    return found


def compared(kind: str, divisions: int, net: np.ndarray) -> None:
    """Prints times of both modes on a hull."""
    m = hull(kind, net, divisions)
    names = m.literals
    names = [name for name in names if name.startswith("P")]
    vertices = m.mesh().vertices
    w = np.random.default_rng(0).normal(size=vertices.shape).reshape(1, -1)
    evaluation = evaluations(m, names)
    print(f"{kind} {net.shape[0]} x {net.shape[1]}, {len(names)} inputs, {len(vertices)} vertices")
    for what in OUTPUTS:
        weights = w if what == "mesh" else np.ones((1, 1))
        pulled, ahead = _core.vjp(m._document, [(what, weights)], names, "reverse")
        assert not ahead, ahead
        # Forward mode is linear in the inputs.
        some = names[:40]
        pushed, _ = _core.vjp(m._document, [(what, weights)], some, "forward")
        off = np.abs(pulled[0, :40] - pushed[0]).max() / np.abs(pulled).max()
        given = [(what, weights)]
        back = least(partial(_core.vjp, m._document, given, names, "reverse"))
        front = least(partial(_core.vjp, m._document, given, some, "forward"))
        front *= len(names) / len(some)
        print(
            f"  {what:20} evaluation {evaluation[what] * 1e3:8.2f} ms, reverse {back * 1e3:8.2f} ms"
            f" = {back / evaluation[what]:5.1f} evaluations, forward {front * 1e3:9.1f} ms"
            f" ({front / back:5.0f} times), difference {off:.0e}"
        )


def cubic_basis(count: int, places: np.ndarray) -> np.ndarray:
    """Cubic B-spline basis functions of clamped uniform knots at places, (places, count)."""
    knots = np.concatenate([[0] * 3, np.linspace(0, 1, count - 2), [1] * 3])
    t = np.minimum(places, 1 - 1e-15)
    basis = ((knots[:-1] <= t[:, None]) & (t[:, None] < knots[1:])).astype(float)
    for degree in range(1, 4):
        n = len(knots) - 1 - degree
        rise = knots[degree : degree + n] - knots[:n]
        fall = knots[degree + 1 :] - knots[1 : n + 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            up = np.where(rise > 0, (t[:, None] - knots[:n]) / rise, 0.0)
            down = np.where(fall > 0, (knots[degree + 1 :] - t[:, None]) / fall, 0.0)
        basis = up * basis[:, :-1] + down * basis[:, 1:]
    return basis


def beside_jax(divisions: int, net: np.ndarray) -> None:
    """Prints the time of JAX for the gradient of the area of the same panels by the same points."""
    try:
        import jax
    except ImportError:
        print("JAX is not installed: no comparison with it")
        return
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    places = np.linspace(0, 1, divisions + 1)
    bu, bv = (jnp.array(cubic_basis(n, places)) for n in net.shape[:2])
    gauss = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)

    @jax.jit
    @jax.value_and_grad
    def area(p: jax.Array) -> jax.Array:
        x = jnp.einsum("ai,bj,ijc->abc", bu, bv, p)
        a, b, c, d = x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]
        total = 0.0
        for s in gauss:
            along_t = (d + (c - d) * s) - (a + (b - a) * s)
            for t in gauss:
                along_s = (b - a) * (1 - t) + (c - d) * t
                total += 0.25 * jnp.linalg.norm(jnp.cross(along_s, along_t), axis=-1).sum()
        return total

    m = hull("B", net, divisions)
    names = [name for name in m.literals if name.startswith("P")]
    value, gradient = jax.block_until_ready(area(net))
    ours = m.gradient("mesh.area", names)
    off = np.abs(ours - np.asarray(gradient).ravel()).max() / np.abs(ours).max()
    jax_time = least(lambda: jax.block_until_ready(area(net)))
    own_time = least(lambda: m.gradient("mesh.area", names))
    print(
        f"area of B, {len(names)} inputs, {divisions} x {divisions} panels: JAX"
        f" {jax_time * 1e3:.2f} ms, ours {own_time * 1e3:.2f} ms; values differ by"
        f" {abs(value / m.eval('mesh.area') - 1):.0e}, gradients by {off:.0e}"
    )


def resident(word: str) -> int:
    """Bytes of memory of this process: `VmRSS`, or `VmHWM` since it was last reset (Linux)."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(status.split(f"{word}:")[1].split()[0]) << 10


def many(kind: str, divisions: int) -> None:
    """Prints time of reverse mode by 10 080 coordinates, of weights on the mesh, and its memory."""
    m = hull(kind, points(60, 56), divisions)
    names = [name for name in m.literals if name.startswith("P")]
    values = [(name, m.eval(name)) for name in names]
    count = len(m.mesh().vertices)
    given = [("mesh", np.random.default_rng(0).normal(size=(1, 3 * count)))]
    # The first gradient: pages freed by one before would be taken again.
    grown = 0
    if sys.platform == "linux":
        Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")
        before = resident("VmRSS")
        _core.vjp(m._document, given, names, "reverse")
        grown = resident("VmHWM") - before

    def evaluate() -> None:
        m._document.set([(name, x + 1e-9) for name, x in values])
        m.mesh().vertices  # noqa: B018
        m._document.set(values)

    once = least(evaluate) / 2
    back = least(partial(_core.vjp, m._document, given, names, "reverse"))
    print(count, grown, once, back)


def by_many() -> None:
    """Prints times by 10 080 coordinates, and the slope of the memory over the vertices."""
    for kind in "BC":
        found = []
        for divisions in (100, 300):
            words = [sys.executable, __file__, kind, str(divisions)]
            out = subprocess.run(words, check=True, capture_output=True, text=True).stdout
            count, grown, once, back = map(float, out.split())
            found.append((count, grown))
            print(
                f"{kind} 60 x 56, 10080 inputs, {count:.0f} vertices: evaluation {once * 1e3:.2f} "
                f"ms, reverse {back * 1e3:.2f} ms = {back / once:.1f} evaluations, "
                f"{grown / 1e6:.1f} MB",
                flush=True,
            )
        (few, small), (more, large) = found
        print(f"  {(large - small) / (more - few):.0f} bytes for each further vertex", flush=True)


def main() -> None:
    if len(sys.argv) == 3:
        many(sys.argv[1], int(sys.argv[2]))
        return
    net = points(14, 25)
    for divisions in (40, 100):
        for kind in "BC":
            compared(kind, divisions, net)
    beside_jax(40, net)
    by_many()


if __name__ == "__main__":
    main()

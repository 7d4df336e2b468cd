"""The union of bodies that overlap: closed forms, and Manifold on the same panels."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import manifold3d
import numpy as np
import pytest

import moldloft

CASES = 400 if os.environ.get("MOLDLOFT_SOAK") == "1" else 16

BALLS = """
Model info(units = "m t");
AbsPoint A(0, 0, -1); AbsPoint B(0, 0, 1); AbsPoint C(1, 0, -1);
Arc half(A, {1, 0, 0}, B, type = 1); Line axis(A, B); RevSurf ball(half, axis, 0, 2*PI);
CopySurf other(ball, A, C, 1, 1, 1);
"""


def turned(rng: np.random.Generator, k: int) -> str:
    """A body of revolution of any attitude: a ball, a cylinder, or a cone on a cylinder."""
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    centre, radius = rng.uniform(-1, 1, 3), rng.uniform(0.4, 1)
    length = rng.uniform(0.8, 2.4)

    def point(name: str, along: float, out: float) -> str:
        x, y, z = centre + axes[0] * along + axes[1] * out
        return f"AbsPoint {name}{k}({float(x)!r}, {float(y)!r}, {float(z)!r});"

    ends = point("S", -length / 2, 0) + point("E", length / 2, 0) + f"Line axis{k}(S{k}, E{k});"
    sizes = f"divisions = {{{rng.integers(3, 8) * 2}, {rng.integers(6, 24)}}}"
    kind = rng.integers(3)
    if kind == 0:
        ends = point("S", -radius, 0) + point("E", radius, 0) + f"Line axis{k}(S{k}, E{k});"
        profile = point("M", 0, radius) + f"Arc rim{k}(S{k}, M{k}, E{k});"
    else:
        shoulder = length / 2 if kind == 1 else rng.uniform(-0.3, 0.3) * length
        profile = (
            point("P", -length / 2, radius)
            + point("Q", shoulder, radius)
            + f"Line a{k}(S{k}, P{k}); Line b{k}(P{k}, Q{k}); Line c{k}(Q{k}, E{k});"
            + f"PolyCurve rim{k}({{a{k}, b{k}, c{k}}});"
        )
    # Right-handed or not: the mesh turns its faces outward by itself.
    return f"{ends}{profile}RevSurf body{k}(rim{k}, axis{k}, 0, 2*PI, {sizes});"


def manifold(model: moldloft.Model) -> manifold3d.Manifold:
    mesh = model.mesh(whole=True)
    quads = mesh.faces
    threes = np.vstack([quads[:, :3], quads[:, [0, 2, 3]]])
    kept = [len(set(t)) == 3 for t in threes.tolist()]
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(vert_properties=mesh.vertices, tri_verts=threes[kept].astype(np.uint64))
    )
    assert solid.status() == manifold3d.Error.NoError
    return solid


@pytest.mark.parametrize("seed", range(CASES))
def test_unions_of_bodies_have_the_volume_of_manifold(seed: int) -> None:
    rng = np.random.default_rng(seed)
    texts = [turned(rng, k) for k in range(int(rng.integers(2, 6)))]
    solids = [manifold(moldloft.loads(text)) for text in texts]
    wanted = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)
    united = moldloft.loads("\n".join(texts)).united()
    mesh = united.mesh()
    assert mesh.closed and mesh.summary["oriented"] and mesh.summary["outward"]
    assert mesh.volume == pytest.approx(wanted.volume(), rel=1e-12)
    assert mesh.area == pytest.approx(wanted.surface_area(), rel=1e-12)
    assert not united.inner_skins()


def test_two_balls_count_their_common_part_once() -> None:
    model = moldloft.loads(BALLS)
    with pytest.raises(moldloft.ModelError, match=r"m\.united\(\)"):
        model.hydrostatics()
    united = model.united(tolerance=1e-4)
    assert united._document.units() == [("m", 1.0), ("t", 1000.0)]
    under = united.hydrostatics(level=3)
    assert under.volume == pytest.approx(9 / 4 * math.pi, rel=2e-4)
    assert under.wetted_area == pytest.approx(6 * math.pi, rel=2e-4)
    assert united.hydrostatics().volume == pytest.approx(9 / 8 * math.pi, rel=2e-4)


def test_halves_are_united_with_their_images() -> None:
    # A float and a round leg through its deck, both cut by y = 0.
    text = """
    Model info(symmetry = "y");
    AbsPoint A(-3, 0, -1); AbsPoint B(3, 0, -1); AbsPoint C(-3, 2, -1); AbsPoint D(3, 2, -1);
    AbsPoint E(-3, 0, 1); AbsPoint F(3, 0, 1); AbsPoint G(-3, 2, 1); AbsPoint H(3, 2, 1);
    Line ab(A, B); Line cd(C, D); Line ef(E, F); Line gh(G, H);
    RuledSurf bottom(ab, cd); RuledSurf top(ef, gh); RuledSurf side(cd, gh);
    Line ac(A, C); Line eg(E, G); Line bd(B, D); Line fh(F, H);
    RuledSurf aft(ac, eg); RuledSurf fore(bd, fh);
    AbsPoint S(0.3, 0, 0); AbsPoint T(0.3, 0, 4); AbsPoint P(1.3, 0, 0); AbsPoint Q(1.3, 0, 4);
    Line sp(S, P); Line pq(P, Q); Line qt(Q, T); PolyCurve rim({sp, pq, qt}); Line mast(S, T);
    RevSurf leg(rim, mast, 0, PI, divisions = {6, 60});
    """
    model = moldloft.loads(text)
    # Panels of the leg are those of a polygon with 120 corners.
    round_area = 60 * math.sin(math.pi / 60)
    united = model.united()
    assert united.symmetry == "" and united.mesh().closed
    assert united.mesh().volume == pytest.approx(6 * 4 * 2 + 3 * round_area, rel=1e-9)


def test_bodies_without_a_union_are_refused_with_a_place() -> None:
    with pytest.raises(moldloft.Error, match=r"no union: the skin is open at \("):
        moldloft.loads(
            "AbsPoint A(0,0,0); AbsPoint B(1,0,0); AbsPoint C(0,1,0); AbsPoint D(1,1,1);"
            "Line a(A, B); Line b(C, D); RuledSurf sheet(a, b);"
        ).united()
    with pytest.raises(moldloft.ModelError):
        moldloft.loads("AbsPoint A(0,0,0); Line a(A, A);", strict=False).united()


def test_commands_take_the_union(tmp_path: Path) -> None:
    (tmp_path / "balls.sdl").write_text(BALLS, encoding="utf-8")

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "moldloft", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    refused = run("hydro", "balls.sdl")
    assert refused.returncode == 1 and "--united" in refused.stderr
    floats = run("hydro", "balls.sdl", "--united", "--json")
    assert floats.returncode == 0 and '"volume"' in floats.stdout
    built = run("build", "balls.sdl", "--united", "--to", "gdf", "stl")
    assert built.returncode == 0, built.stderr
    mesh = moldloft.read_mesh(tmp_path / "balls.gdf").mesh()
    # A GDF file repeats the corners of each panel.
    assert mesh.volume == pytest.approx(9 / 4 * math.pi, rel=0.15)

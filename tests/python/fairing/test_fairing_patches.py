"""Surfaces with common edges, faired as one; weights and knots of surfaces in files."""

from __future__ import annotations

import json

import numpy as np
import pytest

import moldloft
from moldloft import fairing
from moldloft.fairing.files import read_grids
from moldloft.grids import write_plot3d


def hull(noise=3e-3):
    """Two grids of a hull's side that meet amidships."""
    x, z = np.meshgrid(np.linspace(-1, 1, 15), np.linspace(0, 1, 8), indexing="ij")
    y = (1.2 - x * x) * (0.3 + z - 0.4 * z * z)
    y = y + noise * np.random.default_rng(3).uniform(-1, 1, y.shape)
    grid = np.stack([x, y, z], axis=-1)
    return grid[:8], grid[7:]


def kink(faired):
    """The largest differences of mean and Gaussian curvature across the seam."""
    v = np.linspace(0, 1, 21)
    fore, aft = faired.surfaces[0].look([1.0], v), faired.surfaces[1].look([0.0], v)
    assert np.abs(fore.points - aft.points).max() < 1e-13
    return np.abs(fore.mean - aft.mean).max(), np.abs(fore.gaussian - aft.gaussian).max()


def test_patches_run_on_across_their_seam():
    grids = hull()
    faired = fairing.patches(grids, 0.02, measure="third")
    assert faired.seams == (((0, "u1"), (1, "u0")),)
    assert max(kink(faired)) < 1e-6
    assert faired.deviation_sampled <= faired.deviation_certified <= 0.02 + 1e-12
    assert faired.jumps_after < 0.1 * faired.jumps_before and faired.gap_relative < 1e-6
    assert "1.u1 = 2.u0: continuous curvature" in str(faired)
    loose = fairing.patches(grids, 0.02, measure="third", seams="position")
    assert min(kink(loose)) > 1e-3
    # The same surfaces, the second turned round.
    turned = fairing.patches([grids[0], grids[1][::-1, ::-1]], 0.02, measure="third")
    assert turned.seams == (((0, "u1"), (1, "u1")),)
    assert turned.measure_after == pytest.approx(faired.measure_after, rel=1e-6)
    bent = (grids[0], grids[1] + np.array([0, 0.5, 0]) * (grids[1][:, :, :1]))
    with pytest.raises(moldloft.errors.FairingError, match="cannot hold"):
        fairing.patches(bent, 1e-3)
    for wrong, said in (({"seams": "smooth"}, "seams keep"), ({"as_": "points"}, "`control`")):
        with pytest.raises(moldloft.errors.FairingError, match=said):
            fairing.patches(grids, 0.02, **wrong)


def test_patches_have_tolerances_of_their_own():
    fore, aft = hull()
    each = np.full(aft.shape[:2], 0.02)
    each[5:] = 0.002
    each[5:7, 2:6] = 0.0
    faired = fairing.patches([fore, aft], [0.04, each], measure="third")
    moves = [
        np.linalg.norm(a.control_points - b.control_points, axis=-1)
        for a, b in zip(faired.surfaces, faired.originals, strict=True)
    ]
    assert faired.tol == 0.04 and moves[0][:-1].max() > 0.021
    assert (moves[1] <= each * (1 + 1e-9)).all() and (moves[1][5:7, 2:6] == 0).all()
    assert moves[1][:5].max() > 0.01
    # On the seam the smaller tolerance holds.
    assert moves[0][-1].max() <= 0.02 * (1 + 1e-9) and max(kink(faired)) < 1e-6
    same = fairing.patches([fore, aft], [0.02, 0.02], measure="third")
    assert (same.grids[1] == fairing.patches([fore, aft], 0.02, measure="third").grids[1]).all()
    for wrong, said in (([0.02], "2 surfaces"), ([0.02, [1, 2]], "one tolerance or")):
        with pytest.raises(moldloft.errors.FairingError, match=said):
            fairing.patches([fore, aft], wrong)


def test_blocks_of_a_file_are_faired_as_one(cli, tmp_path):
    fore, aft = hull()
    path, out = tmp_path / "hull.p3d", tmp_path / "faired.p3d"
    write_plot3d(path, [fore, aft])
    reported = json.loads(cli("fair", path, "--tol", "0.02", "-o", out, "--json").stdout)
    assert reported["seams"] == [[[0, "u1"], [1, "u0"]]] and reported["keeps"] == "curvature"
    assert reported["deviation_certified"] <= 0.02 + 1e-12 and reported["gap"] >= 0
    faired = read_grids(out).grids
    assert [g.shape for g in faired] == [fore.shape, aft.shape]
    assert np.abs(faired[0][-1] - faired[1][0]).max() < 1e-6
    one = json.loads(cli("fair", path, "--tol", "0.02", "--block", "2", "--json").stdout)
    assert one["points"] == [8, 8]
    for words, said in (
        (("--mode", "faithful"), "choose one with --block"),
        (("--plot", "x.png"), "choose one with --block"),
        (("--block", "1", "--seams", "tangent"), "--seams: for the blocks"),
    ):
        done = cli("fair", path, "--tol", "0.02", *words, status=1)
        assert said in done.stderr, done.stderr


def test_weights_and_knots_of_surfaces_in_files(cli, tmp_path):
    grid = hull()[0]
    path = tmp_path / "net.p3d"
    write_plot3d(path, [grid])
    weights, knots = tmp_path / "weights.txt", tmp_path / "knots.txt"
    weights.write_text("\n".join(f"{1 + 0.1 * (k % 3)}" for k in range(64)))
    knots.write_text("0 0 0 0 0.1 0.4 0.5 0.8 1 1 1 1\n")
    words = ("--weights", weights, "--knots", knots, "--knots-v", knots)
    reported = json.loads(cli("fair", path, "--tol", "0.02", *words, "--json").stdout)
    assert reported["deviation_certified"] <= 0.02 + 1e-12
    plain = json.loads(cli("fair", path, "--tol", "0.02", "--json").stdout)
    assert reported["measure_before"] != pytest.approx(plain["measure_before"])
    weights.write_text("1 2 3\n")
    done = cli("fair", path, "--tol", "0.02", "--weights", weights, status=1)
    assert "expected 8 x 8 weights, found 3" in done.stderr

"""Points in the wrong order, and files that are no tables."""

from __future__ import annotations

import json
import os
import tracemalloc
import zipfile

import numpy as np
import pytest

import moldloft
from moldloft import _core
from moldloft.errors import FairingError
from moldloft.fairing.files import points_text, read_points
from moldloft.fairing.findings import order_of
from moldloft.fairing.report import Finding

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def said(points, closed=False):
    """Findings about the order, of swapped neighbours too."""
    flat = np.column_stack([points, np.zeros(len(points))])
    found = [Finding.of(row) for row in _core.data_findings(flat, closed)]
    return [f for f in [*found, *order_of(flat, closed)] if f.kind == "order"]


def curve(rng, n):
    t = np.linspace(0, 1, n)
    own = [
        np.column_stack([10 * t, 2 * np.sin(np.pi * t)]),
        np.column_stack([10 * t, 0.5 * t]),
        4 * np.column_stack([np.cos(3 * t), np.sin(3 * t)]),
        np.column_stack([5 * t**2, 3 * t]),
    ][int(rng.integers(4))]
    return own + rng.uniform(-1e-3, 1e-3, own.shape)


def test_orders_of_evenly_spaced_points():
    rng = np.random.default_rng(0)
    cases = 1000 if SOAK else 100
    missed = dict.fromkeys(("second half", "first half", "middle", "exchanged", "shuffled"), 0)
    swapped = 0
    for _ in range(cases):
        n = int(rng.integers(15, 41))
        p, h, third = curve(rng, n), n // 2, n // 3
        assert not said(p)
        wrong = {
            "second half": np.concatenate([p[:h], p[h:][::-1]]),
            "first half": np.concatenate([p[:h][::-1], p[h:]]),
            "middle": np.concatenate([p[:third], p[third : 2 * third][::-1], p[2 * third :]]),
            "exchanged": np.concatenate([p[h:], p[:h]]),
            "shuffled": p[rng.permutation(n)],
        }
        for name, q in wrong.items():
            missed[name] += not said(q)
        i = int(rng.integers(2, n - 3))
        q = p.copy()
        q[[i, i + 1]] = q[[i + 1, i]]
        swapped += not [f for f in said(q) if f.index == i]
    assert max(missed.values()) <= 0.05 * cases, missed
    assert swapped <= 0.05 * cases


def test_rings_that_were_given_as_open():
    a = np.linspace(0, 2 * np.pi, 49)
    ring = np.column_stack([3 * np.cos(a), 2 * np.sin(a)])
    ring[-1] = ring[0]
    assert "a closed curve?" in said(ring)[0].text
    assert not said(ring[:-1], closed=True)
    # An aerofoil ends where it begins, at its trailing edge.
    s = np.linspace(-1, 1, 49)
    x = s * s
    y = 0.2969 * abs(s) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
    foil = np.column_stack([x, np.sign(-s) * 0.6 * y])
    foil[-1] = foil[0]
    assert not said(foil)
    half = np.concatenate([ring[:25], ring[25:40][::-1]])
    assert any("reversed" in f.text for f in moldloft.fair(half, 0.01).findings)


def test_stations_of_a_single_line_stay(cli, tmp_path):
    x = np.arange(12.0)
    rows = [f"{a:g},{2 * np.sin(a / 4) + 0.01 * (-1) ** int(a):.2f}" for a in x]
    (tmp_path / "s.csv").write_text("station,half-breadth\n" + "\n".join(rows) + "\n")
    done = cli("fair", "s.csv", "--tol", "0,02", "-o", "out.csv", "--json")
    assert "offsets move; stations stay" in json.loads(done.stdout)["source_notes"]
    after = read_points(tmp_path / "out.csv").points
    assert (after[:, 0] == x).all()
    assert np.abs(after[:, 1] - read_points(tmp_path / "s.csv").points[:, 1]).max() <= 0.02


OPENFAST = """   {count}   NumCoords         ! The number of coordinates, the reference included
! x-y coordinate of airfoil reference
!  x/c        y/c
0.25       0
! coordinates of airfoil shape
!  x/c        y/c
{rows}
"""


def test_coordinates_of_openfast(tmp_path):
    s = np.linspace(-1, 1, 40)
    foil = np.column_stack([s * s, np.round(-0.1 * s * (1 - s * s), 6)])
    rows = "\n".join(f"{x:.6f}  {y:.6f}" for x, y in foil)
    path = tmp_path / "AF_Coords.txt"
    path.write_text(OPENFAST.format(count=41, rows=rows))
    file = read_points(path)
    assert file.points.shape == (40, 2) and np.abs(file.points - foil).max() < 1e-6
    assert any("reference" in note for note in file.notes)
    assert points_text(file.points, file) == path.read_text()
    path.write_text(OPENFAST.format(count=40, rows=rows))
    with pytest.raises(FairingError, match="expected 40 coordinates"):
        read_points(path)


@pytest.mark.parametrize(
    ("name", "make", "words"),
    [
        ("t.xlsx", lambda p: zipfile.ZipFile(p, "w").writestr("a", "b"), "save its sheet as CSV"),
        ("t.xls", lambda p: p.write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1"), "save its sheet as CSV"),
        ("t.xlsx", lambda p: p.write_text("0,1\n" * 9), "is text and no workbook"),
        ("t.csv", lambda p: zipfile.ZipFile(p, "w").writestr("a", "b"), "is not text"),
        ("t.csv", lambda p: p.write_bytes(b"0,1\n\0\0\n"), "is not text"),
    ],
)
def test_what_is_no_text_is_refused_by_name(tmp_path, name, make, words):
    path = tmp_path / name
    make(path)
    with pytest.raises(FairingError, match=words):
        read_points(path)


def test_dense_noise_is_in_order_and_needs_little_memory():
    """Readings nearer to each other than their noise is wide turn back at each point."""
    n = 60_000
    x = np.linspace(0, 10, n)
    rng = np.random.default_rng(3)
    points = np.column_stack([x, np.sin(x) + rng.uniform(-0.3, 0.3, n)])
    slow = np.column_stack([np.cos(x / 3), np.sin(x / 3)]) + rng.uniform(-2e-3, 2e-3, (n, 2))
    tracemalloc.start()
    assert not order_of(points, False) and not order_of(slow, False)
    assert "out of order" in order_of(points[rng.permutation(n)], False)[0].text
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 100 * points.nbytes, most
    found = moldloft.fair(points, 0.3, as_="fit", motion=(0, 1))
    assert found.findings == () and found.spline.inflections() == 3

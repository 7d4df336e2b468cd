"""The sheet of a fairing: one content as HTML and PDF, to scale, with the table's notation."""

from __future__ import annotations

import hashlib
import re

import numpy as np
import pytest

import moldloft
from moldloft import fairing
from moldloft.errors import Error
from moldloft.fairing.sheet import SheetDetails, SheetTable, sheet, write_sheet
from test_fairing_page import Balanced


def hull_table(path):
    x, z = np.linspace(0, 10, 11), [0.2, 0.4, 0.6, 0.8, 1.0, 1.25]
    rng = np.random.default_rng(0)
    rows = ["waterline (m);" + ";".join(f"{a:g}" for a in x)]
    for w in z:
        y = 0.9 * (1 - (x / 5 - 1) ** 2) * (1 - (1.25 - w) ** 2 / 1.6)
        y = y + rng.uniform(-0.01, 0.01, len(x))
        rows.append(f"{w:g};" + ";".join(f"{v:.2f}" for v in y))
    path.write_text("\n".join(rows) + "\n")


def test_a_table_has_a_sheet_to_sign(cli, tmp_path):
    table = tmp_path / "hull.csv"
    hull_table(table)
    cli("fair", table, "--tol", "0.02", "--sheet", "hull.html", "-o", "out.csv")
    text = (tmp_path / "hull.html").read_text()
    Balanced(text)
    digest = hashlib.sha256(table.read_bytes()).hexdigest()
    stated = (digest, "moldloft fair", "--tol 0.02", "0.02 m", moldloft.__version__, "checked by")
    for fact in (*stated, "station 4", "waterline 0.8", "Lengths are in metres", "1 : 40"):
        assert fact in text.replace("1 : 50", "1 : 40"), fact
    assert "http" not in text and "<script" not in text
    # Moved offsets are marked, as they are written in the table that goes with the sheet.
    before, after = (p.read_text().split("\n") for p in (table, tmp_path / "out.csv"))
    changed = [(a, b) for r, s in zip(before[1:], after[1:], strict=True)
               for a, b in zip(r.split(";"), s.split(";"), strict=True) if a != b]  # fmt: skip
    marked = re.findall(r'<td class="moved">([^<]*)<small>([^<]*)</small>', text)
    assert sorted(marked) == sorted((b, a) for a, b in changed) and len(changed) > 20


def drawn_length(text, title, colour):
    """The length in mm of the longest line of a colour in the drawing with a title."""
    own = next(s for s in text.split("</svg>") if f">{title}</text>" in s)
    width, box = re.search(r'width="([\d.]+)mm".*?viewBox="0 0 ([\d.]+)', own).groups()
    assert float(width) == pytest.approx(float(box), abs=0.06)
    lines = re.findall(rf'<path d="M([^"]*)" fill="none" stroke="{colour}" stroke-width="0.3"', own)
    spans = [np.ptp([float(p.split()[0]) for p in d.split("L")]) for d in lines]
    return max(spans)


@pytest.mark.parametrize(("unit", "mm"), [("m", 1000.0), ("in", 25.4), ("ft", 304.8)])
def test_lines_are_at_the_stated_scale(unit, mm):
    x = np.linspace(0, 7, 15)
    faired = moldloft.fair(np.column_stack([x, np.round(np.sin(x / 3), 2)]), 0.005)
    text = sheet(faired, "A curve", SheetDetails(unit=unit))
    Balanced(text)
    ratio = re.search(r"Lines, (?:1 : ([\d.]+)|([\d.]+) : 1) on A4", text)
    scale = 1 / float(ratio[1]) if ratio[1] else float(ratio[2])
    length = drawn_length(text, "To scale", "#1f5fa8")
    extent = np.ptp(faired.spline.samples(12).points[:, 0])
    assert length == pytest.approx(extent * mm * scale, abs=0.02)
    assert "unit of length is" in sheet(faired, "A curve")


def test_pdf_has_the_same_content_and_the_same_bytes(tmp_path):
    pytest.importorskip("reportlab")
    x = np.linspace(0, 7, 15)
    y = np.round(np.sin(x / 3), 2)
    y[6] += 0.3
    points = np.column_stack([x, y])
    faired = moldloft.fair(points, 0.01)
    table = SheetTable(["a"], ["station 1"], {("a", "station 1"): ("4-5-1", "4-5-2+")})
    found = fairing.suspects(points, 0.01, motion="y", most=3)
    details = SheetDetails([("source", "a.csv")], table, found, "m", True, notes=["a note"])
    paths = [write_sheet(faired, tmp_path / f"{k}.pdf", "Boat", details) for k in "ab"]
    assert paths[0].read_bytes() == paths[1].read_bytes()
    assert paths[0].read_bytes().startswith(b"%PDF") and found[0].index == 6
    html = sheet(faired, "Boat", details)
    for words in ("4-5-2+<small>4-5-1", "a note", "Suspects", found[0].meant_reading):
        assert words in html
    with pytest.raises(Error, match=r"\.html or \.pdf"):
        write_sheet(faired, tmp_path / "a.txt")


def test_curves_of_other_knots_have_a_distance():
    """A shape may ask for knots between the points that the curve before has not."""
    from moldloft.fairing.sheet import _apart

    at = np.linspace(0, 1, 9)
    before = fairing.Spline.interpolate(np.column_stack([at, at**2]))
    after = fairing.Spline.interpolate(np.column_stack([at[::2], at[::2] ** 2 + 0.25]))
    assert _apart(before, after) == pytest.approx(0.25, abs=0.01)


def test_surfaces_have_no_sheet(cli, tmp_path):
    grid = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0), [0.0], indexing="ij"), -1)[:, :, 0]
    with pytest.raises(Error, match="surfaces"):
        sheet(moldloft.fair(grid, 0.1))

"""The stability booklet: the figures of the loading, as HTML and as PDF."""

from __future__ import annotations

import math
import re

import pytest

import moldloft
from moldloft.hydro.booklet import booklet, write_booklet
from moldloft.hydro.stability import Wind
from test_stability import SHIP


@pytest.fixture(scope="module")
def loading():
    ship = moldloft.loads(SHIP)
    hatch = {"hatch": (0, 3, 8)}
    return ship, ship.stability(2583, cg=(0, 0, 4.4), density="salt", openings=hatch)


def tables(page):
    """The cells of the tables of a page, by row."""
    found = []
    for table in re.findall(r"<table>(.*?)</table>", page, re.S):
        rows = re.findall(r"<tr[^>]*>(.*?)</tr>", table, re.S)
        found.append([re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows])
    return found


def test_figures_are_those_of_closed_forms(loading):
    page = booklet(*loading, wind=Wind(250, 5))
    hydrostatics, cross, arms, criteria = tables(page)
    names = [cell.split(" ")[0] for cell in hydrostatics[0]]
    assert all("[" in cell for cell in hydrostatics[0])
    for line in hydrostatics[1:]:
        row = dict(zip(names, map(float, line), strict=True))
        draft = row["draft"]
        # The ship is a box of 60 x 12 x 7.
        assert row["volume"] == pytest.approx(720 * draft, rel=1e-5)
        assert row["displacement"] == pytest.approx(720 * draft * 1.025, rel=1e-5)
        assert row["kmt"] == pytest.approx(draft / 2 + 12 / draft, rel=1e-5)
        assert line[names.index("lcb")] == "0"
    # Wall-sided: GZ = sin(heel) (GM + BM tan(heel)^2 / 2), while neither deck nor bottom emerges.
    gm, bm = 1.75 + 12 / 3.5 - 4.4, 12 / 3.5
    for degrees, gz, _ in (map(float, line) for line in arms[1:7]):
        heel = math.radians(degrees)
        exact = math.sin(heel) * (gm + 0.5 * bm * math.tan(heel) ** 2)
        assert gz == pytest.approx(exact, rel=1e-5, abs=1e-9)
    # KN of the loading's own volume is GZ with the centre of gravity at the keel.
    own = next(line for line in cross[1:] if float(line[0]) == pytest.approx(2520))
    assert float(own[1]) == pytest.approx(
        float(arms[3][1]) + 4.4 * math.sin(math.radians(10)), rel=1e-5
    )
    assert [line[6] for line in criteria[1:]] == ["pass"] * 7
    assert page.count("<svg") == 2 and "hatch" in page


def test_a_failed_clause_and_missing_data_are_marked(loading):
    ship, _ = loading
    high = ship.stability(2583, cg=(0, 0, 5.1), density="salt")
    page = booklet(ship, high)
    assert '<tr class="fail">' in page and '<tr class="missing">' in page


def test_names_are_text(loading):
    assert "<b>" not in booklet(*loading, title="<b>bold</b>")


def test_as_pdf(loading, tmp_path):
    pytest.importorskip("reportlab")
    ship, stability = loading
    paths = [write_booklet(tmp_path / n, ship, stability, title="S") for n in ("a.pdf", "b.pdf")]
    first, second = (path.read_bytes() for path in paths)
    assert first.startswith(b"%PDF-") and b"%%EOF" in first[-10:]
    assert first.count(b"/Type /Page\n") >= 2
    assert first == second


def test_bad_requests(loading, tmp_path):
    with pytest.raises(moldloft.Error, match=r"an .html or .pdf file, not `.doc`"):
        write_booklet(tmp_path / "a.doc", *loading)
    with pytest.raises(moldloft.Error, match="no option `colour`"):
        write_booklet(tmp_path / "a.pdf", *loading, colour="red")
    assert not list(tmp_path.iterdir())

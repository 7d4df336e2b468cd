"""The page of a fairing: every point, pictures to scale, nothing from elsewhere."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import numpy as np
import pytest

import moldloft
from conftest import ROOT
from moldloft import fairing
from moldloft.colours import COLOURS
from moldloft.fairing.drawing import even_turns

DATA = ROOT / "examples" / "fairing"


class Balanced(HTMLParser):
    """Tags that are opened are closed, in order."""

    def __init__(self, text):
        super().__init__()
        self.open = []
        self.cells = 0
        self.feed(text)
        assert [t for t in self.open if t not in ("html",)] == []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta",):
            self.open.append(tag)
        self.cells += tag == "td"

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def paths(html, colour):
    """The coordinates of lines of a colour."""
    found = re.findall(rf'<path d="M([^"]*)" fill="none" stroke="{colour}"', html)
    return [np.array([p.split() for p in d.split("L")], float) for d in found]


def test_a_curve(cli, tmp_path):
    cli("fair", DATA / "naca0012-3.csv", "--tol", "1e-3", "--report", "page.html")
    html = (tmp_path / "page.html").read_text()
    page = Balanced(html)
    points = np.loadtxt(DATA / "naca0012-3.csv", delimiter=",", skiprows=1)
    assert page.cells > 6 * len(points)
    assert html.count("<svg") == 3 and "http" not in html and "<script" not in html
    # The shape is to scale: the blue line of the first picture is the faired curve.
    faired = moldloft.fair(points, 1e-3)
    line = paths(html.split("</svg>")[0], "#1f5fa8")[0]
    truth = faired.spline.samples(12).points[:, :2]
    scale = np.ptp(line, axis=0) / np.ptp(truth, axis=0)
    assert scale[0] == pytest.approx(scale[1], rel=1e-2)
    own = (line[:, 0] - line[0, 0]) / scale[0]
    assert np.abs(own - (truth[:, 0] - truth[0, 0])).max() < 0.02 / scale[0]
    # A nose swamps the rest: a logarithm, and teeth that are cut.
    assert "logarithmic scale" in html and "are cut" in html
    assert html == (tmp_path / "page.html").read_text()
    assert fairing.page(faired, "A") == fairing.page(faired, "A").replace(str(tmp_path), "")
    done = cli("fair", DATA / "naca0012-3.csv", "--tol", "1e-3", "--report", "p.pdf", status=1)
    assert ".html" in done.stderr


def test_straight_lines_and_titles():
    line = np.column_stack([np.arange(9.0), np.zeros(9)])
    html = fairing.page(moldloft.fair(line, 0.1), "<b> & co")
    Balanced(html)
    assert "&lt;b&gt; &amp; co" in html and "is straight" in html


def test_networks_and_surfaces(cli, tmp_path):
    cli("fair", DATA / "lines.csv", "--tol", "0.006", "--along", "0,1,0", "--report", "n.html")
    html = (tmp_path / "n.html").read_text()
    Balanced(html)
    # Three views; combs of the waterlines in plan and of the stations in the body plan.
    assert html.count("<svg") == 7 and "Body plan" in html and "times as" in html
    assert html.count("<figcaption>Curvature combs before") == 2
    cli("fair", DATA / "wigley.p3d", "--tol", "1e-4", "--report", "s.html")
    html = (tmp_path / "s.html").read_text()
    Balanced(html)
    assert html.count("<svg") == 3
    sheet = np.stack([*np.meshgrid(np.arange(6.0), np.arange(6.0), indexing="ij")], -1)
    sheet = np.concatenate([sheet, np.sin(sheet[..., :1]) * np.cos(sheet[..., 1:])], -1)
    other = sheet + np.array([5.0, 0.0, 0.0])
    other[..., 2] = np.sin(other[..., 0]) * np.cos(other[..., 1])
    html = fairing.page(fairing.patches([sheet, other], 0.5))
    Balanced(html)
    assert html.count("<svg") == 6 and "Plan of surface 2" in html


@pytest.mark.parametrize("axes", [(0, 1), (0, 2), (1, 2)])
@pytest.mark.parametrize("back", [False, True])
def test_teeth_of_a_circle_are_outside_and_alike(axes, back):
    """In any view and direction, before and after, in curves and networks."""
    t = np.linspace(0, 1.2, 30)
    noise = np.random.default_rng(1).uniform(-1e-3, 1e-3, (2, 30))
    points = np.zeros((30, 3))
    points[:, axes[0]], points[:, axes[1]] = 3 * np.cos(t) + noise[0], 3 * np.sin(t) + noise[1]
    if back:
        points = points[::-1]
    faired = moldloft.fair(points, 2e-3)
    assert not moldloft.fair(points, 2e-3).findings
    html = fairing.page(faired)
    comb = html.split("</svg>")[2]
    tips, feet = paths(comb, "#1f5fa8")[0], paths(comb, COLOURS["ink"])[0]
    # The centre of the circle through three feet: all teeth point away from it, as long as others.
    a, b, c = feet[0], feet[len(feet) // 2], feet[-1]
    centre = np.linalg.solve(2 * np.array([b - a, c - a]), [b @ b - a @ a, c @ c - a @ a])
    lengths = np.linalg.norm(tips - centre, axis=1) - np.linalg.norm(feet - centre, axis=1)
    assert lengths.min() > 0 and np.ptp(lengths) < 0.3 * lengths.mean()
    net = fairing.network(points, [list(range(30))], 2e-3)
    assert fairing.page(net).count("<figcaption>Curvature combs") == 2


def test_a_nose_has_teeth_enough():
    points = np.loadtxt(DATA / "naca0012-4.csv", delimiter=",", skiprows=1)
    faired = moldloft.fair(points, 1e-4)
    teeth = even_turns(faired.spline)
    tangent = teeth.first / np.linalg.norm(teeth.first, axis=1, keepdims=True)
    turn = np.arccos(np.clip((tangent[1:] * tangent[:-1]).sum(1), -1, 1))
    assert np.degrees(turn.max()) < 5 and len(turn) <= 400


def test_a_page_of_a_table_names_its_lines_and_says_where_it_is_from(tmp_path, capsys):
    from moldloft.cli import main

    x, z = np.linspace(0, 10, 11), [0.2, 0.4, 0.6, 0.8, 1.0, 1.25]
    rng = np.random.default_rng(0)
    rows = ["waterline (m);" + ";".join(f"{a:g}" for a in x)]
    for w in z:
        y = 0.9 * (1 - (x / 5 - 1) ** 2) * (1 - (1.25 - w) ** 2 / 1.6)
        y = y + rng.uniform(-0.01, 0.01, len(x))
        rows.append(f"{w:g};" + ";".join(f"{v:.3f}" for v in y))
    table, sheet = tmp_path / "hull.csv", tmp_path / "hull.html"
    table.write_text("\n".join(rows) + "\n")
    assert main(["fair", str(table), "--tol", "0.01", "--report", str(sheet)]) == 0
    text = sheet.read_text()
    for stated in ("station 4", "waterline 0.8", "<th>unit</th><td>m</td>", "<td>0.01</td>"):
        assert stated in text, stated
    curves = text[text.index("<h2>Curves") : text.index("<h2>Plan")]
    assert curves.count("<tr>") == 1 + 17
    assert moldloft.__version__ in text and "<th>date</th>" in text
    assert main(["fair", str(table), "--tol", "0.01", "--units", "ft"]) != 0
    assert "are in m" in capsys.readouterr().err

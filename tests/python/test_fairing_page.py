"""The page of a fairing: every point, pictures to scale, nothing from elsewhere."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import numpy as np
import pytest

import moldloft
from conftest import ROOT
from moldloft import fairing

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
    assert html.count("<svg") == 3 and "Body plan" in html and "times as" in html
    cli("fair", DATA / "wigley.p3d", "--tol", "1e-4", "--report", "s.html")
    html = (tmp_path / "s.html").read_text()
    Balanced(html)
    assert html.count("<svg") == 3

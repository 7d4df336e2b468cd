"""A font of a few glyphs by fontTools: lines, curves of degree 2 or 3, holes, overlaps, kerning."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fontTools.feaLib.builder import addOpenTypeFeaturesFromString
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.areaPen import AreaPen
from fontTools.pens.t2CharStringPen import T2CharStringPen
from fontTools.pens.ttGlyphPen import TTGlyphPen

#: Height of a capital letter, and units of the em.
CAPITAL, EM = 700, 1000

#: Advances.
ADVANCES = {
    ".notdef": 500,
    "space": 300,
    "H": 700,
    "O": 800,
    "A": 640,
    "V": 640,
    "i": 250,
    "plus": 700,
}

#: Change of the advance between A and V.
KERN = -80


def polygon(pen: Any, *points: tuple[float, float]) -> None:
    pen.moveTo(points[0])
    for p in points[1:]:
        pen.lineTo(p)
    pen.closePath()


def ring(pen: Any, cubic: bool, x: float, y: float, r: float, s: float, way: int) -> None:
    """A closed curve of four pieces with half-axes r and s, anticlockwise if `way` is 1."""
    at = [(x + r, y), (x + r, y + way * s), (x, y + way * s), (x - r, y + way * s), (x - r, y)]
    at += [(x - r, y - way * s), (x, y - way * s), (x + r, y - way * s), (x + r, y)]
    pen.moveTo(at[0])
    for k in (0, 2, 4, 6):
        a, b, c = at[k : k + 3]
        if cubic:
            inner = [(p[0] + 0.56 * (b[0] - p[0]), p[1] + 0.56 * (b[1] - p[1])) for p in (a, c)]
            pen.curveTo(*[(round(u), round(v)) for u, v in inner], c)
        else:
            pen.qCurveTo(b, c)
    pen.closePath()


def draw(name: str, pen: Any, cubic: bool) -> None:
    """The outlines of a glyph; those of TrueType run clockwise, those of CFF anticlockwise."""
    way = 1 if cubic else -1

    def block(*points: tuple[float, float]) -> None:
        polygon(pen, *(points if cubic else points[::-1]))

    if name == "H":
        block(
            (50, 0),
            (200, 0),
            (200, 300),
            (500, 300),
            (500, 0),
            (650, 0),
            (650, 700),
            (500, 700),
            (500, 420),
            (200, 420),
            (200, 700),
            (50, 700),
        )
    elif name == "O":
        ring(pen, cubic, 400, 350, 350, 360, way)
        ring(pen, cubic, 400, 350, 220, 230, -way)
    elif name == "A":
        block((0, 0), (150, 0), (400, 700), (250, 700))
        block((490, 0), (640, 0), (400, 700), (250, 700))
        block((100, 180), (540, 180), (540, 280), (100, 280))
    elif name == "V":
        block((0, 700), (240, 0), (400, 0), (640, 700), (480, 700), (320, 220), (160, 700))
    elif name == "i":
        block((50, 0), (200, 0), (200, 480), (50, 480))
        ring(pen, cubic, 125, 620, 80, 80, way)
    elif name == "plus":
        block((50, 300), (650, 300), (650, 400), (50, 400))
        block((300, 50), (400, 50), (400, 650), (300, 650))


def small_font(path: Path, cubic: bool = False, name: str = "Letters") -> Path:
    """Writes the font: TrueType with quadratic curves, or CFF with cubic ones."""
    order = list(ADVANCES)
    made = FontBuilder(EM, isTTF=not cubic)
    made.setupGlyphOrder(order)
    made.setupCharacterMap({ord({"space": " ", "plus": "+"}.get(g, g)): g for g in order[1:]})
    glyphs: dict[str, Any] = {}
    for glyph in order:
        pen: Any = T2CharStringPen(ADVANCES[glyph], None) if cubic else TTGlyphPen(None)
        draw(glyph, pen, cubic)
        glyphs[glyph] = pen.getCharString() if cubic else pen.glyph()
    if cubic:
        made.setupCFF(name, {"FullName": name}, glyphs, {})
    else:
        made.setupGlyf(glyphs)
    made.setupHorizontalMetrics({g: (ADVANCES[g], 0) for g in order})
    made.setupHorizontalHeader(ascent=800, descent=-200, lineGap=100)
    made.setupNameTable({"familyName": name, "styleName": "Regular", "fullName": name})
    made.setupOS2(sTypoAscender=800, sTypoDescender=-200, sTypoLineGap=100, sCapHeight=CAPITAL)
    made.setupPost()
    addOpenTypeFeaturesFromString(made.font, f"feature kern {{ pos A V {KERN}; }} kern;")
    made.font["head"].created = made.font["head"].modified = 0
    made.font.recalcTimestamp = False
    made.save(path)
    return path


def glyph_area(name: str, cubic: bool = False) -> float:
    """The area of a glyph whose outlines do not overlap, in squares of a capital's height."""
    pen = AreaPen()
    draw(name, pen, cubic)
    return abs(float(pen.value)) / CAPITAL**2

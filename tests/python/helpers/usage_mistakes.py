"""Generators of ordinary mistakes: of the command line, of texts and of Python calls."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

LETTERS = "abcdefghijklmnopqrstuvwxyz"

HULL = """Model info(symmetry = "y", units = "m");
param float beam = 4 in [3, 5];
AbsPoint S1(0, 0, 2);     AbsPoint S2(1, 0, -1);
AbsPoint M1(6, beam/2, 1.5);  AbsPoint M2(6, beam/2, -1);  AbsPoint M3(6, 0, -1.2);
AbsPoint T1(12, beam/3, 1.6); AbsPoint T2(12, 0, 0.2);
Line   stem(S1, S2);
BCurve midship({M1, M2, M3}, degree = 2);
Line   transom(T1, T2);
CLoftSurf hull({stem, midship, transom}, divisions = {4, 6});
"""


def misspelt(word: str, rng: random.Random) -> str:
    """The word with one letter doubled, dropped, exchanged with the next, or another one."""
    while True:
        k = rng.randrange(1, len(word))
        what = rng.randrange(4)
        if what == 0:
            found = word[:k] + word[k] + word[k:]
        elif what == 1:
            found = word[:k] + word[k + 1 :]
        elif what == 2:
            found = word[: k - 1] + word[k] + word[k - 1] + word[k + 1 :]
        else:
            found = word[:k] + rng.choice(LETTERS) + word[k + 1 :]
        if found != word:
            return found


@dataclass
class Call:
    """Words of a command line, and what its answer must be."""

    words: list[str]
    #: What of it must be in the message.
    names: str = ""
    #: What must be suggested.
    meant: str = ""
    status: tuple[int, ...] = (1, 2)
    files: dict[str, bytes] = field(default_factory=dict)
    #: What may be written all the same: pictures of a model of which a part is right.
    drawn: set[str] = field(default_factory=set)


#: Right calls, whose words are then spoilt.
RIGHT = [
    "build hull.sdl --set beam=4.2 --to gdf stl -o out --quality --whole --triangles",
    "build hull.sdl --to png --density salt --sides both --level 0.1 --keep-going --immersed",
    "check hull.sdl --set beam=3.5 --quality --refine 1",
    "eval hull.sdl hull.area midship.length --json",
    "hydro hull.sdl --draft 1.2 --density salt --accuracy 1e-4 --sides both",
    "hydro hull.sdl --table 0.5,1,3 --csv table.csv",
    "hydro hull.sdl --displacement 10 --cg 6,0,0 --density 1.025 --gz 0,20,3",
    "render hull.sdl -o hull.png --size 160x90",
    "graph hull.sdl -o hull.svg",
    "export hull.sdl --html --still -o hull.html",
    "fmt hull.sdl --check",
    "convert hull.sdl --to ms2 -o hull.ms2",
    "convert offsets.csv --curves BCurve -o o.sdl",
    "formats --json",
    "run hull.sdl -o out",
    "fair points.csv --tol 0.01 --measure third --mode optimum --bound data -o faired.csv",
    "sketch plate.skt --json",
    "doc BCurve --json",
    "new boat.sdl",
    "completion bash",
]

#: Values that an option does not take.
WRONG_VALUES = {
    "--set": ["beam", "beam=", "beam=wide", "=3", "beam=nan", "beam=9", "bem=4", "M1=3"],
    "--to": ["gfd", "stll", "x", "GDF2", ""],
    "--density": ["slat", "-1", "0", "nan", "1,025"],
    "--sides": ["bothh", "two"],
    "--level": ["deep", "1,2", "nan"],
    "--refine": ["-1", "1.5", "much"],
    "--draft": ["deep", "nan", "1m"],
    "--accuracy": ["0", "-1", "2", "fine", "nan"],
    "--table": ["1,2", "1,2,3,4", "a,b,c", "0.5,1,0", "0.5,1,2.5", "1"],
    "--gz": ["0,20", "a,20,3", "0,20,-3", "0,20,0"],
    "--displacement": ["-1", "0", "heavy", "nan"],
    "--cg": ["6,0", "6;0;0", "a,b,c", "6,0,0,0", "nan,0,0"],
    "--size": ["160", "160x", "0x90", "axb", "-1x5", "160,90"],
    "--curves": ["BCurv", "Line"],
    "--tol": ["-1", "small", "nan"],
    "--measure": ["thrid", "fourth"],
    "--mode": ["optimun", "best"],
    "--bound": ["dta", "all"],
    "--limit": ["memry=2G", "memory=much", "steps=0", "seconds=-1", "objects", "memory=1K"],
    "--color": ["allways", "yes"],
}

FILES = {
    "hull.sdl": HULL.encode(),
    "offsets.csv": b"station,waterline,half_breadth\n"
    + b"".join(b"%d,%d,%g\n" % (x, z, x * (4 - x) * (2 + z)) for x in range(5) for z in (-1, 0)),
    "points.csv": b"".join(b"%g,%g\n" % (x / 9, (x / 9) ** 2) for x in range(10)),
    "plate.skt": b"SKETCH PLATE\nSTROKE 0 0, 4 0, 4 3, 0 3, 0 0\n",
}

#: Contents that are no model.
FOREIGN = {
    "empty bytes": b"\x00" * 64,
    "picture": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "letters of another code": "größe = 3;\n".encode("latin-1"),
    "prose": b"Dear sirs,\nplease find enclosed the hull.\n",
    "json": b'{"hull": [1, 2, 3]}\n',
    "cut off": HULL.encode()[:-7],
}


def known_options(words: list[str]) -> set[str]:
    from moldloft.cli import whole_parser

    sub = whole_parser([words[0]])._subparsers._group_actions[0].choices[words[0]]
    return set(sub._option_string_actions)


def command_lines(rng: random.Random, count: int) -> Iterator[Call]:
    from moldloft.cli import COMMANDS

    for _ in range(count):
        words = rng.choice(RIGHT).split()
        options = [k for k, word in enumerate(words) if word.startswith("--")]
        valued = [k for k in options if words[k] in WRONG_VALUES]
        what = rng.randrange(10)
        if what == 0:
            meant = words[0]
            words[0] = misspelt(meant, rng)
            if words[0] in COMMANDS:
                continue
            yield Call(words, words[0], meant if len(meant) > 3 else "", (2,))
        elif what == 1 and options:
            k = rng.choice(options)
            meant = words[k]
            words[k] = "--" + misspelt(meant[2:], rng)
            if words[k] in known_options(words) or words[k].startswith("---"):
                continue
            yield Call(words, words[k], meant if len(meant) > 5 else "", (2,))
        elif what in (2, 3) and valued:
            k = rng.choice(valued)
            words[k + 1] = rng.choice(WRONG_VALUES[words[k]])
            # A name that is unknown is named itself.
            names = words[k + 1].partition("=")[0] if words[k] == "--set" else words[k].strip("-")
            yield Call(words, names)
        elif what == 4 and valued:
            # Without its value: the next option, or the end.
            k = rng.choice(valued)
            yield Call(words[: k + 1], words[k], "", (2,))
        elif what == 5 and len(words) > 1 and "." in words[1]:
            meant = words[1]
            stem, dot, suffix = meant.partition(".")
            words[1] = misspelt(stem, rng) + dot + suffix
            if words[0] == "new":
                continue
            yield Call(words, words[1], meant, (1, 2))
        elif what == 6 and len(words) > 1 and words[1].endswith((".sdl", ".skt")):
            if words[0] in ("new", "fair"):
                continue
            drawn = {"hull.png", "hull.svg"} if words[0] in ("render", "graph") else set()
            yield Call(words, files={words[1]: rng.choice(list(FOREIGN.values()))}, drawn=drawn)
        elif what == 7:
            place = rng.randrange(1, len(words) + 1)
            words.insert(place, "--" + rng.choice(["fast", "x9", "ouput"]))
            yield Call(words, "", "", (2,))
        elif what == 8 and words[0] not in ("formats", "completion", "doc", "sketch", "new"):
            # No file at all, or a folder.
            words[1] = "folder"
            yield Call(words, "folder")
        elif (
            what == 9
            and words[1:2] == ["hull.sdl"]
            and words[0] not in ("export", "fmt", "convert")
        ):
            text, name, meant = spoilt_text(rng)
            drawn = {"hull.png", "hull.svg"} if words[0] in ("render", "graph") else set()
            yield Call(words, name, meant, (1,), {"hull.sdl": text.encode()}, drawn)


#: What of the text is misspelt: kinds, arguments, functions, objects, parameters.
WORDS = ["AbsPoint", "BCurve", "CLoftSurf", "degree", "divisions", "symmetry", "beam", "midship"]


def spoilt_text(rng: random.Random) -> tuple[str, str, str]:
    """A program with a mistake, what must be named, and what must be suggested."""
    word = rng.choice(WORDS)
    places = [k for k in range(len(HULL)) if HULL.startswith(word, k)]
    # A name's last use, so that it was declared rightly.
    k = places[-1]
    wrong = misspelt(word, rng)
    return HULL[:k] + wrong + HULL[k + len(word) :], wrong, word


#: Values that are none of a kind.
WRONG = {
    "number": ["a", [1, 2], object(), 1j, b"x", {}],
    "count": [1.5, "3", [1], object(), 1j],
    "text": [3, [1], b"x", object()],
    "row": [3, object(), 1.5],
    "array": ["a", object(), [["x"]], 1j],
    "mapping": [3, "a", [1], object()],
}


def python_calls() -> list[tuple[Callable[..., Any], dict[str, Any], dict[str, str]]]:
    """Functions, arguments that are right, and the kind of each that is to be wrong."""
    import moldloft
    from moldloft import grids, offsets
    from moldloft import implicit as im

    m = moldloft.loads(HULL)
    hull, midship = m["hull"], m["midship"]
    s = im.Set(im.sphere((0, 0, 0), 1))
    o, z = (0, 0, 0), (0, 0, 1)
    points = [(x / 9, (x / 9) ** 2) for x in range(10)]
    water = {"cg": (6, 0, 0), "accuracy": 1e-3}
    return [
        (moldloft.loads, {"text": HULL, "name": "a.sdl"}, {"text": "text", "name": "text"}),
        (moldloft.load, {"path": "hull.sdl", "library": []}, {"path": "row", "library": "row"}),
        (
            m.hydrostatics,
            {"level": 0.1, "trim": 0.0, "gravity": 9.8, "by": ["beam"], **water},
            {"level": "number", "trim": "number", "gravity": "number", "by": "row", "cg": "row"},
        ),
        (
            m.equilibrium,
            {"displacement": 10.0, "density": 1.0, **water},
            {"displacement": "number", "accuracy": "number", "cg": "row"},
        ),
        (m.hydrostatic_table, {"drafts": [0.5, 1.0], "accuracy": 1e-3}, {"drafts": "row"}),
        (
            m.righting_curve,
            {"heels": [0.0, 0.1], "displacement": 10.0, "density": 1.0, **water},
            {"heels": "row", "displacement": "number", "cg": "row"},
        ),
        (
            m.section_areas,
            {"stations": [3.0], "levels": [0.0], "accuracy": 1e-3},
            {"stations": "row", "levels": "row", "accuracy": "number"},
        ),
        (m.panel_figures, {"level": 0.0}, {"level": "number"}),
        (m.jacobian, {"by": ["beam"]}, {"by": "row"}),
        (m.derivative, {"expression": "hull.area", "by": "beam"}, {"expression": "text"}),
        (m.derivatives, {"expressions": ["hull.area"], "by": ["beam"]}, {"expressions": "row"}),
        (m.eval, {"expression": "hull.area"}, {"expression": "text"}),
        (m.encoded, {"format": "stl", "name": "x"}, {"format": "text", "name": "text"}),
        (m.picture, {"width": 64, "height": 48}, {"width": "count", "height": "count"}),
        (m.set, {"values": {"beam": 4.0}}, {"values": "mapping"}),
        (m.convert, {"to": "ms2"}, {"to": "text"}),
        (hull.grid, {"nu": 3, "nv": 4}, {"nu": "count", "nv": "count"}),
        (hull.nearest, {"points": [[1.0, 2, 3]]}, {"points": "array"}),
        (hull.intersect, {"other": "z=0.5"}, {"other": "row"}),
        (midship.nearest, {"points": [[1.0, 2, 3]]}, {"points": "array"}),
        (moldloft.fair, {"points": points, "tol": 0.01}, {"points": "array"}),
        (im.sphere, {"centre": o, "radius": 1.0}, {"centre": "row", "radius": "number"}),
        (
            im.cylinder,
            {"point": o, "direction": z, "radius": 1.0},
            {"point": "row", "direction": "row", "radius": "number"},
        ),
        (im.plane, {"normal": z, "point": o}, {"normal": "row", "point": "row"}),
        (
            im.torus,
            {"point": o, "direction": z, "major": 2.0, "minor": 0.5},
            {"point": "row", "major": "number", "minor": "number"},
        ),
        (im.cuboid, {"low": o, "high": (1, 1, 1)}, {"low": "row", "high": "row"}),
        (im.segment, {"start": o, "end": z}, {"start": "row", "end": "row"}),
        (im.point, {"at": o}, {"at": "row"}),
        (s.mass, {"depth": 3}, {"depth": "count"}),
        (s.facets, {"depth": 3}, {"depth": "count"}),
        (s.member, {"points": [[0, 0, 0]]}, {"points": "array"}),
        (s.nearest, {"point": (2, 0, 0)}, {"point": "row"}),
        (
            s.hits,
            {"start": (2, 0, 0), "direction": (-1, 0, 0), "length": 5.0},
            {"start": "row", "direction": "row", "length": "number"},
        ),
        (s.translated, {"by": (1, 0, 0)}, {"by": "row"}),
        (
            s.turned,
            {"point": o, "direction": z, "angle": 0.3},
            {"point": "row", "direction": "row", "angle": "number"},
        ),
        (s.scaled, {"factor": 2.0, "centre": o}, {"factor": "number", "centre": "row"}),
        (s.offset, {"distance": 0.1}, {"distance": "number"}),
        (s.shell, {"thickness": 0.1}, {"thickness": "number"}),
        (s.bounds, {"accuracy": 1e-2}, {"accuracy": "number"}),
        (s.range, {"low": o, "high": (1, 1, 1)}, {"low": "row", "high": "row"}),
        (grids.encode_plot3d, {"grids": [[[z, o], [o, z]]]}, {"grids": "array"}),
        (offsets.read, {"path": "offsets.csv"}, {"path": "row"}),
        (moldloft.Sketch().run, {"text": "HELP"}, {"text": "text"}),
    ]

"""Damaged inputs for every reader, odd arguments for every public callable, damaged programs, random sets, mutants of
CAD files, by the thousand.

    python tests/python/helpers/campaign.py [--cases 1000000] [--calls 100000] [--programs 100000] [--sets 100000] [--cad 10000]
        [--seconds 10] [--memory 2]

A child process, which may use so many GiB in all, reads one case after the other; a case is named by
its number, and made from it. What is neither done nor refused by a right error within so many seconds
of the processor, or ends the process, is printed, and the exit status is 1. `--show NUMBER` (with
the counts of the other kinds 0) prints one case.
"""

# Seeds are a line each.
# ruff: noqa: E501

from __future__ import annotations

import argparse
import contextlib
import inspect
import io
import json
import math
import mmap
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import nullcontext, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]

#: Beyond the clock's limit a case is ended; a busy machine gets more than the processor's limit.
PATIENCE = 8

#: Numbers on the board that are no cases.
_NOT_YET, _OVER = -2, -1

#: The board: the present case, since when, how many before it were done and refused.
_BOARD = "<qdqq"
_BOARD_SIZE = struct.calcsize(_BOARD)

EXTREMES = (
    "0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "9007199254740993", "99999999999",
    "2147483648", "-0", "\x7f", '"', "{", "\0", "\ufeff", "é", "1e50", "4294967295",
)  # fmt: skip

MODEL = """param float w = 2 in [1, 3]; AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); AbsPoint C(0, 1, 0.3);
AbsPoint D(w, 1, 0); Line l(A, B); Line m(C, D); RuledSurf s(l, m, divisions = {3, 3});
AbsMagnet k(s, 0.5, 0.5); farray a = {1, 2, 3}; Model info(units = "m");
"""

SKETCH = """SKETCH a
SET UNITS M
POINT 1 AT 0 0
POINT 2 AT 400 0
POINT 3 AT 400 300
POINT 4 AT 0 300
LINE 1 FROM 1 TO 2 TYPE X
LINE 2 FROM 2 TO 3 TYPE Y
LINE 3 FROM 3 TO 4 TYPE X
LINE 4 FROM 4 TO 1 TYPE Y
"""


def damaged(rng: random.Random, seeds: list[bytes]) -> bytes:
    """A copy of a seed with a few bytes, words, numbers, lines changed, doubled or left out."""
    data = bytearray(rng.choice(seeds))
    for _ in range(rng.choice((1, 1, 2, 3, 5))):
        if not data:
            break
        at = rng.randrange(len(data))
        end = min(len(data), at + 1 + rng.randrange(40))
        what = rng.randrange(10)
        if what == 0:
            data[at] = rng.randrange(256)
        elif what == 1:
            data[at] ^= 1 << rng.randrange(8)
        elif what == 2:
            del data[at:end]
        elif what == 3:
            to = rng.randrange(len(data))
            data[to:to] = data[at:end]
        elif what == 4:
            del data[at:]
        elif what in (5, 6):
            start, stop = at, at
            while start and (chr(data[start - 1]).isalnum() or data[start - 1] in b"._-"):
                start -= 1
            while stop < len(data) and (chr(data[stop]).isalnum() or data[stop] in b"._-"):
                stop += 1
            data[start:stop] = rng.choice(EXTREMES).encode()
        elif what == 7:
            other = rng.choice(seeds)
            start = rng.randrange(len(other) + 1)
            data[at:end] = other[start : start + 200]
        elif what == 8:
            lines = bytes(data).split(b"\n")
            a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[a], lines[b] = lines[b], lines[a]
            data = bytearray(b"\n".join(lines))
        else:
            # A whole field of a binary file.
            width = rng.choice((4, 8))
            value = rng.choice((0, 1, 0xFFFFFFFF, 0x7FFFFFFF, 1 << 20, rng.getrandbits(32)))
            data[at : at + width] = value.to_bytes(width, rng.choice(("little", "big")))
    return bytes(data)


@dataclass
class Reader:
    """What is read, by what, from what; and how many cases of a thousand are its."""

    share: int
    seeds: list[bytes]
    read: Callable[[bytes], object]


@dataclass
class World:
    """What the readers need: a folder, and models that are made once."""

    folder: Path
    made: dict[str, Any] = field(default_factory=dict)

    def once(self, name: str, make: Callable[[], Any]) -> Any:
        if name not in self.made:
            self.made[name] = make()
        return self.made[name]

    def file(self, name: str, data: bytes) -> Path:
        path = self.folder / name
        path.write_bytes(data)
        return path


def _texts(pattern: str, most: int) -> list[bytes]:
    """Texts of the repository that are not long."""
    found = [
        path.read_bytes()
        for folder in ("examples", "tests/corpus", "tests/old")
        for path in sorted((ROOT / folder).rglob(pattern))
        if path.stat().st_size <= most
    ]
    assert found, pattern
    return found


def _right(diagnostics: Any) -> None:
    for found in diagnostics:
        assert found.id != "internal-error", str(found)


def _model(name: str) -> Callable[[bytes], object]:
    def read(data: bytes) -> None:
        import moldloft

        model = moldloft.loads(data.decode("utf-8", "replace"), name=name, strict=False)
        _right(model.diagnostics)
        if not model.has_errors:
            model.mesh()

    return read


def _sketch(data: bytes) -> None:
    from moldloft import Sketch

    for reply in Sketch().run(data.decode("utf-8", "replace"), strict=False):
        assert "internal-error" not in str(reply)


def readers(world: World) -> dict[str, Reader]:
    """All readers of the package."""
    import numpy as np

    import moldloft
    from moldloft import _core, grids, offsets, overlays, permissions, storage
    from moldloft.fairing import files as tables
    from moldloft.hydro import stability
    from moldloft.storage import journal, locks, sets

    def model() -> moldloft.Model:
        made: moldloft.Model = world.once("model", lambda: moldloft.loads(MODEL))
        return made

    def of_file(name: str, read: Callable[[Path], object]) -> Callable[[bytes], object]:
        return lambda data: read(world.file(name, data))

    def expression(data: bytes) -> None:
        text = data.decode("utf-8", "replace")
        model().eval(text)

    def parameters(data: bytes) -> None:
        name, _, value = data.decode("utf-8", "replace").partition("=")
        try:
            number = float(value)
        except ValueError:
            return
        try:
            model().set({name: number})
            model().mesh()
        finally:
            model().set({"w": 2})

    def message(data: bytes) -> None:
        make = lambda: _core.Session("m.sdl", MODEL, None, [])  # noqa: E731
        session = world.once("session", make)
        for line in data.decode("utf-8", "replace").splitlines():
            frame = session.answer(line)
            assert frame[:4] == b"MLFT" and b"internal-error" not in frame
        if len(world.made) > 2 and random.random() < 0.01:
            del world.made["session"]

    def record(name: str) -> Callable[[bytes], object]:
        """A file of ours that lies beside the outputs: the write goes on, and reaches nothing else."""

        def read(data: bytes) -> None:
            folder = world.folder / "records"
            folder.mkdir(exist_ok=True)
            (folder / name).write_bytes(data)
            sets._swept.clear()
            storage.commit(folder, [storage.Output("a", b"1")])
            permissions.write_outputs(folder, {"b.txt": b"2"}, sources=(), force=True)
            assert (folder / "a").read_bytes() == b"1"

        return read

    def lines(data: bytes) -> None:
        journal.read(world.file("j.skt.journal", data))

    def owner(data: bytes) -> None:
        path = world.file("lock", data)
        file = os.open(path, os.O_RDONLY)
        try:
            locks._owner(file) if hasattr(locks, "_owner") else None
        finally:
            os.close(file)

    points = b"x,y,z\n0,0,0\n1,0.5,2\n2,0.75,3\n3,0.9,4\n"
    foil = b"NACA 0012\n1.0 0.0013\n0.5 0.0529\n0.0 0.0\n0.5 -0.0529\n1.0 -0.0013\n"
    lednicer = b"FOIL\n3. 3.\n\n0 0\n.5 .05\n1 0\n\n0 0\n.5 -.05\n1 0\n"
    table = b"station,half-breadth at 0,half-breadth at 1\n0,0,1\n1,1,2\n2,0.5,1\n"
    grid = np.random.default_rng(1).random((4, 3, 3))
    plots = []
    for layout in ("text", "stream", "records"):
        for multi in (False, True):
            variant = grids.Plot3DVariant(layout, multi=multi, double=layout == "text" or multi)
            plots.append(grids.encode_plot3d([grid, grid] if multi else [grid], variant))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        written = {
            ending: list(model().encoded(ending, "a").values())
            for ending in ("stl", "obj", "gdf", "ply", "off", "glb", "3mf", "vtp")
        }
    stl = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
    binary = bytes(80) + (2).to_bytes(4, "little") + struct.pack("<12fH", *range(12), 0) * 2
    obj = b"o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2//1 4//1 3//1\nf -1 -2 -3 -4\n"
    ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    vtk = b"# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n"
    gdf = b"hull\n1.0 9.81\n0 1\n1\n0 0 0 1 0 0 1 0 -1 0 0 -1\n"
    mar = b"2 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n0 0 0 0\n1 2 3 4\n0 0 0 0\n"
    dxf = b"0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n1\n21\n1\n31\n0\n0\nARC\n8\n0\n10\n0\n20\n0\n40\n1\n50\n0\n51\n90\n0\nENDSEC\n0\nEOF\n"
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M0 0 C1 1 2 2 3 0 A1 1 0 0 1 5 5 Z"/><circle cx="1" cy="1" r="1"/></svg>'
    rules = json.dumps(
        {"name": "x", "source": "y", "clauses": [{"kind": "gm", "name": "a", "least": 0.15}]}
    ).encode()
    records = [
        json.dumps({"version": 1, "token": "0" * 16, "files": [
            {"name": "a", "existed": True, "digest": "0" * 64}]}).encode(),
        json.dumps({"version": 1, "files": {"b.txt": "0" * 64}}).encode(),
    ]  # fmt: skip
    messages = [
        b'{"kind":"open","id":1}\n{"kind":"ping","id":1}',
        b'{"kind":"set","id":2,"values":{"w":2.5}}\n{"kind":"hover","id":3,"at":12}',
        b'{"kind":"write","id":2,"from":0,"to":3,"text":"x"}\n{"kind":"open","id":1}',
        b'{"kind":"complete","id":3,"at":14}\n{"kind":"mesh","id":4}',
        b'{"kind":"drag_begin","id":5,"object":"C"}\n{"kind":"drag_to","id":6,"to":[0,1,2]}\n{"kind":"drag_end","id":7}',
        b'{"kind":"evaluate","id":8,"text":"w*2"}\n{"kind":"inspect","id":9,"object":"s","u":0.5,"v":0.5}',
        b'{"kind":"section","id":1,"axis":"z","at":0.1}\n{"kind":"measure","id":2,"points":[[0,0,0],[1,1,1]]}',
        b'{"kind":"rename","id":1,"at":14,"to":"v"}\n{"kind":"definition","id":2,"at":60}',
        b'{"kind":"export","id":1,"format":"stl"}\n{"kind":"formats","id":2}\n{"kind":"hydrostatics","id":3}',
    ]
    expressions = [
        b"w + 2*sin(w)^2", b"A", b"l(0.5).x", b"s(0.25, 0.75)", b"l.length + s.area", b"a[2:4] + {1, 2, 3}",
        b"where(a > 0.5, a, -a)", b"max(a, 0)", b'{1, {2, 3}, "x"}', b"|B - A| < 3 and not (w == 2)",
        b"interp({0, 1}, {2, 3}, a)", b"distance(l, m)", b"a[1:5:2] .* a", b"mesh.area", b"k.y",
    ]  # fmt: skip
    small = [*_texts("*.sdl", 1_500), MODEL.encode()]
    model_files = [moldloft.loads(MODEL).convert("ms2").encode()]
    every = {
        "program": Reader(70, small, _model("m.sdl")),
        "model file": Reader(60, [*model_files, *_texts("*.ms2", 6_000)], _model("m.ms2")),
        "sketch": Reader(70, _texts("*.skt", 4_000), _sketch),
        "expression": Reader(150, expressions, expression),
        "set": Reader(50, [b"w=2.5", b"A.x=1", b"w=1e9", b"s=3", b"a=2"], parameters),
        "points": Reader(60, [points], of_file("a.csv", grids.read_points)),
        "aerofoil": Reader(60, [foil, lednicer], of_file("a.dat", grids.read_aerofoil)),
        "plot3d": Reader(60, plots, of_file("a.p3d", grids.read_plot3d)),
        "fair points": Reader(50, [points, foil, table], of_file("a.csv", tables.read_points)),
        "fair numbers": Reader(20, [b"1\n2\n3 4\n"], of_file("a.txt", tables.read_numbers)),
        "fair grid": Reader(20, plots, of_file("a.p3d", tables.read_grids)),
        "offsets": Reader(50, [table], of_file("a.csv", offsets.read)),
        "rules": Reader(20, [rules], of_file("a.json", stability._rule)),
        "message": Reader(60, messages, message),
        "journal": Reader(20, [b"moldloft journal 1\n0 abc LINE A B\n"], lines),
        "record of a set": Reader(10, records, record(sets.RECORD)),
        "record of outputs": Reader(10, records, record(permissions.RECORD)),
        "owner": Reader(10, [b'{"pid": 1, "host": "a", "since": 1.0}'], owner),
    }
    off = b"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n3 0 1 2\n4 0 1 3 2\n"
    layers: dict[str, list[bytes]] = {
        "stl": [stl, binary], "obj": [obj], "ply": [ply], "vtk": [vtk], "gdf": [gdf], "mar": [mar],
        "off": [off], "glb": [], "3mf": [], "vtp": [],
        "dxf": [dxf], "svg": [svg], "xyz": [points.replace(b"x,y,z\n", b"").replace(b",", b" ")],
        "csv": [points, table],
    }  # fmt: skip
    for ending, seeds in layers.items():
        seeds = [*seeds, *(d for d in written.get(ending, []) if len(d) < 20_000)]
        every[ending] = Reader(15, seeds, of_file(f"a.{ending}", overlays.read))
    blocks = [
        np.random.default_rng(2).random((2, 6, 3)),
        np.random.default_rng(3).random((3, 4, 3)),
    ]
    cgns = [
        grids.write_cgns(world.folder / f"{k}.cgns", [b], ["a"]).read_bytes()
        for k, b in enumerate(blocks)
    ]
    every["cgns"] = Reader(30, cgns, of_file("a.cgns", grids.read_cgns))
    for name, seeds, read in binary_files(world):
        every[name] = Reader(30, seeds, of_file(name, read))
    return every


def binary_files(world: World) -> Iterator[tuple[str, list[bytes], Callable[[Path], object]]]:
    """Name, seeds and reader of fonts and of meshes of Rhino, where their packages are installed."""
    import moldloft
    from moldloft import overlays

    try:
        from small_font import small_font
    except ImportError:
        pass
    else:
        program = world.file("letters.sdl", b'list c = text_outlines("HOAVi+", "a.ttf");')
        fonts = [
            small_font(world.folder / "seed.ttf", cubic).read_bytes() for cubic in (False, True)
        ]
        yield "a.ttf", fonts, lambda _: moldloft.load(program)
    try:
        import rhino3dm
    except ImportError:
        return
    file, mesh = rhino3dm.File3dm(), rhino3dm.Mesh()
    for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
        mesh.Vertices.Add(x, y, 0)
    mesh.Faces.AddFace(0, 1, 2, 3)
    file.Objects.AddMesh(mesh)
    seed = world.folder / "seed.3dm"
    file.Write(str(seed), 6)
    yield "a.3dm", [seed.read_bytes()], overlays.read


def values(rng: random.Random) -> Any:
    """An argument that is right for something, or for nothing."""
    import numpy as np

    nan, inf = math.nan, math.inf
    some = np.random.default_rng(1).random
    pool: list[Callable[[], Any]] = [
        lambda: rng.choice([None, 0, 1, -1, 2, 3, 7, 10**9, 2**31, 2**63, 10**30, 10**400, True]),
        lambda: rng.choice([0.5, nan, inf, -inf, 1e300, 1e-300, -0.0, 5.0, 0.1, 1e51]),
        lambda: rng.choice(["", "hull", "beam", "P21", "MC1", "\0", "\ud800", "é😀", "a" * 10**5]),
        lambda: rng.choice(["hull(.5,.5)", "x", "gdf", "stl", "optimum", "curve", "y", "1/0", "m"]),
        lambda: rng.choice(
            [b"", b"\xff" * 100, [], {}, (), [1, 2, 3], [nan, 0, 0], (0.0, 0.0, 1.0)]
        ),
        lambda: rng.choice([[5, 5], (10, 10), [["a"]], {"beam": nan}, {"beam": 9}, {"x": "y"}]),
        lambda: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 5]],
        lambda: rng.choice([np.zeros(0), np.zeros((0, 3)), np.zeros((5, 3)), np.full((4, 3), nan)]),
        lambda: rng.choice([some((7, 3)), some((6, 5, 3)), some((4, 4, 4, 3)), some((7, 3))[::2]]),
        lambda: rng.choice([np.asfortranarray(some((7, 3))), np.full((4, 3), 1e300), some(11)]),
        lambda: rng.choice(
            [np.zeros((3, 3), dtype=complex), np.zeros(3, dtype=object), np.array(["a"])]
        ),
        lambda: rng.choice(
            [np.array(0.5), np.float32(0.25), np.int8(3), np.arange(9, dtype=np.uint64)]
        ),
        lambda: np.broadcast_to(0.5, (10**5,)),
        lambda: rng.choice([object(), len, iter([1, 2]), {1, 2}, 1j, range(5)]),
    ]
    return rng.choice(pool)()


def callables(world: World) -> list[tuple[str, str, Callable[[], Any]]]:
    """Whose, its name, and what makes the one that it is called on."""
    import numpy as np

    import moldloft
    from moldloft import fairing, functions, grids, implicit, kinds, offsets, overlays
    from moldloft.hydro import stability

    text = (ROOT / "examples" / "sailboat" / "hull.sdl").read_text()
    t = np.linspace(0, 1, 9)

    def hull() -> Any:
        return moldloft.loads(text)

    def part(name: str) -> Callable[[], Any]:
        return lambda: hull()[name]

    def sketch() -> Any:
        made = moldloft.Sketch()
        made.run(SKETCH)
        return made

    def ball() -> Any:
        return implicit.sphere((0, 0, 0), 1)

    owners: dict[str, Callable[[], Any]] = {
        "model": hull, "hull": part("hull"), "MC1": part("MC1"), "P21": part("P21"),
        "mesh": lambda: hull().mesh(), "sketch": sketch,
        "hydrostatics": lambda: hull().hydrostatics(), "field": ball,
        "set": lambda: implicit.Set(ball()) if callable(implicit.Set) else ball(),
        "faired": lambda: moldloft.fair(np.c_[t, np.sin(t)], 0.1),
        "patch": lambda: hull().mesh().patches[0],
        "fairing": lambda: fairing, "implicit": lambda: implicit, "grids": lambda: grids,
        "moldloft": lambda: moldloft, "offsets": lambda: offsets, "overlays": lambda: overlays,
        "stability": lambda: stability, "functions": lambda: functions, "kinds": lambda: kinds,
    }  # fmt: skip
    # What is about the process, or waits for a person.
    left_out = {"limits", "view", "main", "import_module", "TYPE_CHECKING"}
    found = []
    for name, make in owners.items():
        try:
            owner = make()
        except Exception as error:
            raise AssertionError(f"{name} cannot be made: {error!r}") from error
        names = getattr(owner, "__all__", None) or dir(owner)
        for member in sorted(names):
            hidden = member.startswith("_") and member not in (
                "__getitem__",
                "__call__",
                "__contains__",
            )
            if hidden or member in left_out:
                continue
            try:
                value = getattr(owner, member)
            except Exception:
                continue
            if callable(value) and not inspect.ismodule(value):
                if isinstance(value, type) and issubclass(value, BaseException):
                    continue
                found.append((name, member, make))
    return found


def call(world: World, rng: random.Random, note: Callable[[str], None]) -> None:
    """One call with odd arguments."""
    import moldloft

    owner, member, make = rng.choice(world.once("callables", lambda: callables(world)))
    if rng.random() < 0.05:
        world.made.pop(owner, None)
    function = getattr(world.once(owner, make), member)
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (ValueError, TypeError):
        parameters = []
    places = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    keys = [p.name for p in parameters if p.kind is p.KEYWORD_ONLY]
    count = max(0, len(places or [0, 1]) - rng.choice((0, 0, 0, 1, -1)))
    arguments = [values(rng) for _ in range(count)]
    named = {key: values(rng) for key in keys if rng.random() < 0.4}
    note(f"{owner}.{member}{(arguments, named)!r}"[:400])
    inside = moldloft.Builder() if owner == "kinds" else nullcontext()
    with inside:
        function(*arguments, **named)


def program_texts() -> list[str]:
    """Programs: those of the corpus, sound ones more often, the libraries, the examples in the array language."""
    texts = []
    for path in sorted((ROOT / "tests" / "corpus" / "run").glob("*.sdl")):
        for case in path.read_text(encoding="utf-8").split("#### ")[1:]:
            lines = case.splitlines()[1:]
            text = "\n".join(line for line in lines if not line.startswith("#"))
            texts += [text] * (1 if "#> error" in case else 4)
    for folder in ("crates/lang/sdl", "examples/missile", "examples/wing"):
        texts += [p.read_text(encoding="utf-8") for p in sorted((ROOT / folder).glob("*.sdl"))]
    return texts


#: What is put into programs besides their own words.
INSERTED = (
    "1e9", "-1", "0", "1/0", '""', "{", "}", "(", ")", ";", "[", "]", ".x", ".d1", "for (i = 1:3)", "A", "|", "while (1)",
    "returned", "{1, 2, 3}", "foreach (q in a)", "1e308", "function f", "...", ":", "sqrt(-1)", "sort(a)", "tfi(s)",
    "farray a[1e6]", "surface s[300, 300]", "block b[9, 9, 9]", "ieee();", "return", "break;", "where(a > 0, a, 1)",
)  # fmt: skip


def _sort(word: str) -> str:
    """What may stand for a word without a change of grammar."""
    if word.isdigit():
        return "number"
    if word.isidentifier():
        return "name"
    return "operator" if word in "+-*/^<>" else word


def damaged_program(world: World, rng: random.Random, note: Callable[[str], None]) -> None:
    """One program with words changed, run, read off and differentiated."""
    import moldloft

    texts = world.once("programs", program_texts)
    text = rng.choice(texts)
    if rng.random() < 0.3:
        text += "\n" + rng.choice(texts)
    words = re.findall(r"\w+|\s+|.", text, re.DOTALL) or [" "]
    # Half of them keep their grammar: numbers, names and operators become others.
    mild = rng.random() < 0.5
    for _ in range(rng.choice((1, 1, 2, 3, 6))):
        at, other = rng.randrange(len(words)), rng.randrange(len(words))
        if mild:
            like = [k for k, word in enumerate(words) if _sort(word) == _sort(words[at])]
            numbers = rng.random() < 0.5 and words[at].isdigit()
            words[at] = (
                rng.choice(("0", "1", "2", "3", "7", "60", "1000"))
                if numbers
                else words[rng.choice(like)]
            )
            continue
        what = rng.randrange(6)
        if what == 0:
            del words[at]
        elif what == 1:
            words[at], words[other] = words[other], words[at]
        elif what == 2:
            words.insert(at, rng.choice(INSERTED))
        elif what == 3:
            words[at] = rng.choice(INSERTED)
        elif what == 4:
            words[at] = words[other]
        else:
            words[at:at] = words[other : other + rng.randrange(30)]
        words = words or [" "]
    text = "".join(words)
    note(text[:20_000])
    model = moldloft.loads(text, strict=False)
    wrong = [d for d in model.diagnostics if d.id == "internal-error"]
    if wrong:
        raise AssertionError(str(wrong[0]))
    named = list(model.params)[:1]
    for name in ("x", "a", "c", "s"):
        try:
            model.eval(name)
            for parameter in named:
                model.derivative(f"max(|{name}|)", parameter)
        except moldloft.Error as error:
            if "internal-error" in str(error):
                raise
    if model.has_errors:
        raise moldloft.Error("refused")


def random_set(rng: random.Random, note: Callable[[str], None]) -> None:
    """The body of a random set, by the limits that users have by default."""
    import moldloft
    import odd_sets

    text = odd_sets.program(rng)
    note(text[:20_000])
    model = moldloft.loads(text, strict=False)
    _right(model.diagnostics)
    if model.has_errors:
        raise moldloft.Error("refused")
    model.mesh()


def cad_mutant(world: World, rng: random.Random, note: Callable[[str], None]) -> None:
    """A mutant of a STEP or IGES file, read as users read it."""
    import cad_mutants
    from moldloft.cad.importing import imported

    path = cad_mutants.mutant(rng, world.once("cad", cad_mutants.seeds), world.folder)
    note(path.suffix)
    _, model, _ = imported(path)
    _right(model.diagnostics)


def cases(kind: str, world: World) -> Callable[[int, Callable[[str], None]], str]:
    """What runs a case by its number and names whose it is."""
    if kind == "sets":

        def one_set(number: int, note: Callable[[str], None]) -> str:
            random_set(random.Random(f"set {number}"), note)
            return "set"

        return one_set
    if kind == "cad":

        def one_mutant(number: int, note: Callable[[str], None]) -> str:
            cad_mutant(world, random.Random(f"cad {number}"), note)
            return "cad"

        return one_mutant
    if kind == "calls":

        def one_call(number: int, note: Callable[[str], None]) -> str:
            call(world, random.Random(f"call {number}"), note)
            return "call"

        return one_call
    if kind == "programs":

        def one_program(number: int, note: Callable[[str], None]) -> str:
            damaged_program(world, random.Random(f"program {number}"), note)
            return "program"

        return one_program
    every = readers(world)
    names = [name for name, reader in every.items() for _ in range(reader.share)]

    def one(number: int, note: Callable[[str], None]) -> str:
        rng = random.Random(f"case {number}")
        name = rng.choice(names)
        reader = every[name]
        data = damaged(rng, reader.seeds)
        note(f"{name}: {data[:3000]!r}")
        reader.read(data)
        return name

    return one


def processor() -> float:
    """Seconds of the processor of this process and its children, ended ones and those at work."""
    spent = os.times()
    total = time.process_time() + spent.children_user + spent.children_system
    for tasks in Path("/proc/self/task").glob("*/children"):
        # Threads and children may end meanwhile.
        with contextlib.suppress(OSError):
            for child in tasks.read_text().split():
                fields = Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()
                total += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return total


def work(kind: str, first: int, count: int, memory: int, seconds: float, board: str) -> None:
    """The child: cases one after the other, the present one's number on the board."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (memory << 30, memory << 30))
    warnings.simplefilter("ignore")
    import moldloft

    moldloft.limits(memory=memory << 29)
    # Bodies of sets and CAD files have bounds of their own by default.
    if kind not in ("sets", "cad"):
        moldloft.limits(seconds=seconds / 2)
    if kind == "programs":
        moldloft.limits(steps=1_000_000)
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    with tempfile.TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as name:
        os.chdir(name)
        world = World(Path(name))
        with Path(board).open("r+b") as file, mmap.mmap(file.fileno(), _BOARD_SIZE) as shown:
            said = io.StringIO()
            with redirect_stdout(said), redirect_stderr(said):
                run = cases(kind, world)
            counts = [0, 0]
            slowest = 0.0
            for number in range(first, first + count):
                shown[:_BOARD_SIZE] = struct.pack(_BOARD, number, time.monotonic(), *counts)
                text: list[str] = []
                begun = processor()
                fault = ""
                try:
                    with redirect_stdout(said), redirect_stderr(said):
                        run(number, text.append)
                    outcome = "done"
                except moldloft.Error as error:
                    outcome = "refused"
                    if "internal-error" in str(error):
                        fault = str(error)
                except TypeError as error:
                    outcome = "refused"
                    if kind != "calls":
                        fault = f"TypeError: {error}"
                except BaseException as error:
                    outcome = "fault"
                    fault = f"{type(error).__name__}: {error}"
                took = processor() - begun
                slowest = max(slowest, took)
                if took > seconds:
                    fault = fault or f"{took:.1f} s"
                if not fault:
                    counts[outcome == "refused"] += 1
                said.seek(0)
                said.truncate()
                if fault:
                    print(
                        json.dumps(["fault", number, fault[:600], (text or [""])[0]]), file=answers
                    )
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
            shown[:_BOARD_SIZE] = struct.pack(_BOARD, _OVER, 0, *counts)
            print(json.dumps(["end", slowest, peak]), file=answers)


@dataclass
class Outcome:
    """What became of the cases."""

    done: int = 0
    refused: int = 0
    slowest: float = 0
    #: Megabytes.
    peak: int = 0
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{self.done + self.refused + len(self.faults)} cases: {self.done} done, "
            f"{self.refused} refused, {len(self.faults)} faults; slowest {self.slowest:.1f} s, at most {self.peak} MB"
        )


KINDS = {"readers": "cases", "calls": "calls", "programs": "programs", "sets": "sets", "cad": "cad"}
"""Kinds of cases, with the options of their counts."""

SECONDS = {"sets": 20.0}
"""Seconds of the processor of a case, where they are not 10."""


def _batches(first: int, count: int, size: int) -> Iterator[tuple[int, int]]:
    for at in range(first, first + count, size):
        yield at, min(size, first + count - at)


def campaign(
    kind: str, first: int, count: int, *, memory: int = 2, seconds: float = 10, size: int = 20_000
) -> Outcome:
    """Runs cases of a kind (:data:`KINDS`) in children and gathers what became of them."""
    found = Outcome()
    waiting = list(_batches(first, count, size))
    environment = {**os.environ, "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as name:
        board = Path(name) / "board"
        while waiting:
            at, many = waiting.pop(0)
            board.write_bytes(struct.pack(_BOARD, _NOT_YET, time.monotonic(), 0, 0))
            words = [kind, at, many, memory, seconds, board]
            answers = Path(name) / "answers"
            with (Path(name) / "said").open("w+b") as said, answers.open("wb") as out:
                child = subprocess.Popen(
                    [sys.executable, __file__, "--work", *map(str, words)],
                    stdout=out, stderr=said, env=environment,
                )  # fmt: skip
                late = ""
                while child.poll() is None:
                    time.sleep(0.05)
                    number, since, *_ = struct.unpack(_BOARD, board.read_bytes())
                    if number != _OVER and time.monotonic() - since > PATIENCE * seconds + 20:
                        late = "no end"
                        child.kill()
                ended = False
                for line in answers.read_text().splitlines():
                    message = json.loads(line)
                    if message[0] == "fault":
                        found.faults.append(f"{kind} {message[1]}: {message[2]}\n    {message[3]}")
                    else:
                        ended = True
                        found.slowest = max(found.slowest, message[1])
                        found.peak = max(found.peak, message[2])
                said.seek(0)
                words_of_it = said.read().decode(errors="replace")
            number, _, done, refused = struct.unpack(_BOARD, board.read_bytes())
            found.done += done
            found.refused += refused
            if "panicked at" in words_of_it and ended:
                found.faults.append(f"{kind} {at}..{at + many}: {words_of_it[:800]}")
            if not ended:
                # That case ended it; those after it are still to come.
                assert number >= 0, words_of_it[-3000:]
                why = late or f"the process ended ({child.returncode}): {words_of_it[-600:]}"
                found.faults.append(f"{kind} {number}: {why}")
                if number + 1 < at + many:
                    waiting.insert(0, (number + 1, at + many - number - 1))
    return found


def main() -> int:
    """Runs the campaigns."""
    if sys.argv[1:2] == ["--work"]:
        kind, first, count, memory, seconds, board = sys.argv[2:]
        work(kind, int(first), int(count), int(memory), float(seconds), board)
        return 0
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cases", type=int, default=1_000_000)
    parser.add_argument("--calls", type=int, default=100_000)
    parser.add_argument("--programs", type=int, default=100_000)
    parser.add_argument("--sets", type=int, default=100_000)
    parser.add_argument("--cad", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--memory", type=int, default=2, help="GiB in all")
    parser.add_argument(
        "--seconds", type=float, help="of the processor, for each case; default 10, sets 20"
    )
    parser.add_argument("--show", type=int, help="the number of a case to run here")
    options = parser.parse_args()
    if options.show is not None:
        with tempfile.TemporaryDirectory() as name:
            world = World(Path(name))
            os.chdir(name)
            shown = next(k for k, option in KINDS.items() if getattr(options, option))
            cases(shown, world)(options.show, print)
        return 0
    faults = 0
    for kind, option in KINDS.items():
        if count := getattr(options, option):
            seconds = options.seconds or SECONDS.get(kind, 10)
            found = campaign(kind, options.first, count, memory=options.memory, seconds=seconds)
            print(f"{kind}: {found}", *found.faults, sep="\n", flush=True)
            faults += len(found.faults)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

"""Hashes of every result: run it before and after a change that must keep all bits, and compare.

    python tests/same_bits.py [PATTERN ...] > before.txt
    ...                                     > after.txt;  diff before.txt after.txt

One line for each result: a hash, and what it is of. Models: vertices, faces, files in all
formats, hydrostatics, derivatives. Corpus: what programs print, and the places of their
diagnostics. Sketches: points, measures and exports. Fairings: points and figures. It uses the
public interface alone; words of messages are left out, so that they may be improved.
"""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import moldloft

ROOT = Path(__file__).resolve().parents[1]
FORMATS = [
    *("gdf", "gdf-high", "nemoh", "hydrostar", "hams", "aqwa", "stl", "3mf", "obj", "ply", "glb"),
    *("vtp", "vts", "p3d", "cgns", "volume-p3d", "volume-vts", "volume-vtu", "volume-cgns"),
    *("blockmesh", "offsets", "svg", "png", "sdl", "ms2"),
]
FAIRINGS = {
    "naca": "naca0012-4.csv --tol 2e-4",
    "naca-third": "naca0012-3.csv --tol 1e-3 --measure third",
    "section": "section.csv --tol 0.005 --breaks auto",
    "circle": "circle.csv --tol 1e-3 --closed --as fit",
    "waisted": "waisted-noise.csv --tol 0.01",
    "waisted-faithful": "waisted-4.csv --tol 0.01 --mode faithful",
    "lines": "lines.csv --tol 0.01",
    "wigley": "wigley.p3d --tol 0.002",
    "wigley-passes": "wigley.p3d --tol none --passes 3",
}


def plain(value: Any) -> Any:
    """The value as what JSON holds, with every digit."""
    if isinstance(value, np.ndarray):
        return [str(value.dtype), value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
    if isinstance(value, float | np.floating):
        return float(value).hex()
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, bytes):
        return hashlib.sha256(value).hexdigest()
    return repr(value)


def places(diagnostics: Any) -> list[Any]:
    """Ids and places of diagnostics, without their words."""
    found = [d.to_dict() for d in diagnostics]
    keys = ("line", "column", "end_line", "end_column")
    return [(d["id"], d["severity"], [(d["primary"] or {}).get(k) for k in keys]) for d in found]


def of_model(path: Path, folder: Path) -> Iterator[tuple[str, Any]]:
    """Everything that a model is asked for."""
    model = moldloft.load(path, strict=False)
    yield "diagnostics", places(model.diagnostics)
    yield "printed", model.printed
    yield "written", model.written
    yield (
        "variables",
        {k: v for k, v in model.variables.items() if isinstance(v, float | np.ndarray)},
    )
    yield "objects", model.objects
    yield "text", model.text
    mesh = model.mesh()
    yield "vertices", mesh.vertices
    for question in ("summary", "faces"):
        yield question, attempt(lambda q=question: getattr(mesh, q))
    yield "hydrostatics", attempt(lambda: model.hydrostatics(level=0.1).as_dict())
    names = [name for name, p in model.params.items() if not p.whole][:3]
    if names and len(mesh.vertices):
        yield "jacobian", attempt(lambda: model.jacobian(names))
    for name in names[:1]:
        p = model.params[name]
        if p.low is not None and p.high is not None:
            model.set({name: p.low + 0.25 * (p.high - p.low)})
            yield f"{name} at a quarter", attempt(lambda: model.mesh().vertices)
            model.set({name: p.default})
    for format in FORMATS:
        yield format, attempt(lambda f=format: files(model, folder, f))


def files(model: moldloft.Model, folder: Path, format: str) -> Any:
    """The files of a format, without the lines that may name a version or a format's words."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        model.write(Path(place) / "x", format=format)
        return {p.name: content(p) for p in sorted(Path(place).rglob("*")) if p.is_file()}


def content(path: Path) -> bytes:
    """A file's bytes, without versions."""
    data = path.read_bytes()
    return re.sub(rb"(?i)moldloft[ -]?v?[0-9][0-9.]*", b"moldloft", data)


def of_program(text: str) -> Iterator[tuple[str, Any]]:
    """What a program of the corpus prints and writes, and where it is wrong."""
    model = moldloft.loads(text, strict=False)
    yield "diagnostics", places(model.diagnostics)
    yield "printed", model.printed
    yield "written", model.written
    yield (
        "variables",
        {k: v for k, v in model.variables.items() if isinstance(v, float | np.ndarray)},
    )
    yield "objects", model.objects


def of_sketch(path: Path) -> Iterator[tuple[str, Any]]:
    """What a sketch is, and what it is when its first dimension has changed."""
    from moldloft.shapes.sketches import Sketch

    sketch = Sketch.load(path)

    def state() -> Any:
        return [
            sketch.points,
            sketch.labels,
            sketch.volume,
            sketch.area,
            sketch.centroid,
            sketch.text,
        ]

    yield "state", state()
    yield "gradient", attempt(lambda: sketch.gradient().volume)
    with tempfile.TemporaryDirectory() as place:
        for ending in ("svg", "stl", "obj", "json", "skt", "dxf", "gdf"):
            yield (
                ending,
                attempt(lambda e=ending: Path(sketch.export(Path(place) / f"x.{e}")).read_bytes()),
            )
    for name, value in sketch.dimensions.items():
        if value:
            sketch[name] = value * 1.01
            yield f"{name} grown", attempt(state)
            break


def of_fairing(command: str, folder: Path) -> Iterator[tuple[str, Any]]:
    """The figures and the points of a fairing by the command."""
    name, *rest = command.split()
    out = folder / ("faired.vts" if name.endswith("p3d") else "faired.csv")
    done = subprocess.run(
        [sys.executable, "-m", "moldloft", "fair", str(ROOT / "examples/fairing" / name), *rest,
         "--json", "-o", str(out)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    data = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    data = {k: v for k, v in data.items() if isinstance(v, float | int | list)}
    data = {k: v for k, v in data.items() if k not in ("seconds", "files")}
    yield "figures", data
    yield "file", out.read_bytes() if out.exists() else None


def attempt(question: Any) -> Any:
    """The answer, or that there is none."""
    try:
        return question()
    except moldloft.Error:
        return "refused"


def cases() -> Iterator[tuple[str, Iterator[tuple[str, Any]]]]:
    """Every case by its name."""
    folder = Path(tempfile.mkdtemp())
    for path in sorted((ROOT / "examples").glob("*/*.sdl")):
        yield f"examples/{path.parent.name}/{path.name}", of_model(path, folder)
    for path in sorted((ROOT / "examples").glob("*/*.ms2")):
        yield f"examples/{path.parent.name}/{path.name}", of_model(path, folder)
    for path in sorted((ROOT / "examples/sketch").glob("*.skt")):
        yield f"sketch/{path.name}", of_sketch(path)
    for name, command in FAIRINGS.items():
        yield f"fair/{name}", of_fairing(command, folder)
    for path in sorted((ROOT / "tests/corpus").rglob("*.sdl")):
        for part in re.split(r"(?m)^#### ", path.read_text())[1:]:
            title, _, text = part.partition("\n")
            text = "\n".join(line for line in text.splitlines() if not re.match(r"#[=><?!]", line))
            yield f"corpus/{path.relative_to(ROOT / 'tests/corpus')}: {title}", of_program(text)


def main(patterns: list[str]) -> None:
    """Prints the hashes of the cases whose names hold one of the patterns, or of all."""
    warnings.simplefilter("ignore")
    for name, results in cases():
        if patterns and not any(pattern in name for pattern in patterns):
            continue
        try:
            for what, value in results:
                text = json.dumps(plain(value), sort_keys=True)
                print(hashlib.sha256(text.encode()).hexdigest()[:16], name, what, flush=True)
        except moldloft.Error as refused:
            print("refused", name, type(refused).__name__, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

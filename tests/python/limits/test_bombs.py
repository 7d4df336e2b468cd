"""Texts that ask for too much: each is done or refused by name, quickly and in little memory."""

# A text each.
# ruff: noqa: E501

from __future__ import annotations

import base64
import io
import json
import os
import struct
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest

resource = pytest.importorskip("resource", reason="limits of a process")

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

P4 = "AbsPoint A(0, 0, 0);\nAbsPoint B(1, 0, 0);\nAbsPoint C(1, 1, 0);\nAbsPoint D(0, 1, 0);\n"
S = P4 + "Line l(A, B); Line n(D, C); "

BOMBS = {
    "div 1e9": (S + "RuledSurf s(l, n, divisions = {1000000000, 1000000000});", "build"),
    "div 3e4 sq": (S + "RuledSurf s(l, n, divisions = {30000, 30000});", "build"),
    "div 1e4 sq": (S + "RuledSurf s(l, n, divisions = {10000, 10000});", "build"),
    "range 1e12": ("farray a = 1:1000000000000;", "check"),
    "for 1e12": ("for (i = 1:1000000000000) { float x = i; }", "check"),
    "for objs 1e7": ("for (i = 1:10000000) AbsPoint p(i, 0, 0);", "check"),
    "array 1e10": ("surface s[100000, 100000];", "check"),
    "array 3e4^2": ("surface s[30000, 30000]; s = s + 1;", "check"),
    "array 1e4^2 x20": (
        "surface s[10000, 10000]; " + " ".join(f"surface t{i}[10000, 10000];" for i in range(20)),
        "check",
    ),
    "array 0": ("farray a[0]; surface s[0, 5]; curve c = a; print sum(a), max(a), c[1];", "check"),
    "array neg": ("farray a[-5]; surface s[3, -1];", "check"),
    "array nan": ("farray a[0/0]; farray b[1e300];", "check"),
    "uniform 1e12": ("farray a = uniform(0, 1, 1000000000000);", "check"),
    "uniform 2e9": ("farray a = uniform(0, 1, 2000000000);", "check"),
    "parens 1e6": ("float x = " + "(" * 10**6 + "1" + ")" * 10**6 + ";", "check"),
    "braces 1e6": ("float x = " + "{" * 10**6 + "1" + "}" * 10**6 + ";", "check"),
    "blocks 1e6": ("{" * 10**6 + "}" * 10**6, "check"),
    "minus 1e6": ("float x = " + "-" * 10**6 + "1;", "check"),
    "bars 1e6": ("float x = " + "|" * 10**6 + "1;", "check"),
    "plus 1e6": ("float x = " + "+".join(["1"] * 10**6) + ";", "check"),
    "power 1e5": ("float x = " + "^".join(["1"] * 10**5) + ";", "check"),
    "index 1e5": ("farray a[3]; float x = a" + "[1" * 10**5 + "]" * 10**5 + ";", "check"),
    "dots 1e5": ("float x = a" + ".b" * 10**5 + ";", "check"),
    "if 1e5": ("if (1) " * 10**5 + "float x = 1;", "check"),
    "else if 1e5": ("float x = 1; if (x > 2) x = 1; " + "else if (x > 2) x = 2; " * 10**5, "check"),
    "calls 1e5": ("float x = " + "sin(" * 10**5 + "1" + ")" * 10**5 + ";", "check"),
    "loop print": ("while (1) print 1;", "run"),
    "loop string": ('text s = "a"; while (1) s = s + s;', "check"),
    "loop write": (
        'f = open("a.txt", "w"); while (1) write(f, "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx");',
        "run",
    ),
    "string 1e8": ('print "' + "a" * 10**8 + '";', "check"),
    "name 1e7": ("float " + "a" * 10**7 + " = 1;", "check"),
    "comment 1e8": ("#" + "a" * 10**8, "check"),
    "lines 1e7": ("\n" * 10**7, "check"),
    "semis 1e7": (";" * 10**7, "check"),
    "errors 1e5": ("AbsPoint P(1, q, 3);\n" * 10**5, "check"),
    "errors tokens": ("@" * 10**6, "check"),
    "number digits": ("float x = " + "9" * 10**6 + ";", "check"),
    "exponent": ("float x = 1e" + "9" * 10**5 + "; float y = 1e-" + "9" * 10**5 + ";", "check"),
    "recursion": ("subroutine f(float n) { f(n); f(n); } f(1);", "check"),
    "recursion exp": (
        "function float f(float n) { return f(n - 1) + f(n - 1); } float x = f(60);",
        "check",
    ),
    "sets 1e5": (
        "AbsPoint O(0,0,0); set s = nothing(); for (i = 1:100000) s = s | set(sphere({i, 0, 0}, 0.6)); SetBody b(s, {0,-1,-1}, {100000, 1, 1}, depth = 5);",
        "build",
    ),
    "sets line 1e4": (
        "set s = "
        + " | ".join(f"set(sphere({{{i}, 0, 0}}, 0.6))" for i in range(10000))
        + "; SetBody b(s, {0,-1,-1}, {10000, 1, 1}, depth = 6);",
        "build",
    ),
    "sets double": (
        "set s = set(sphere({0,0,0}, 1)); for (i = 1:60) s = s & (s | set(sphere({i/60., 0, 0}, 1))); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 6);",
        "build",
    ),
    "field double": (
        "field f = sphere({0,0,0}, 1); for (i = 1:60) f = f*f + f; set s = set(f); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 6);",
        "build",
    ),
    "setbody depth 12": (
        "set s = set(sphere({0,0,0}, 1)); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 12);",
        "build",
    ),
    "setbody depth 30": (
        "set s = set(sphere({0,0,0}, 1)); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 30);",
        "build",
    ),
    "setbody thin noise": (
        "set s = set(sin(1e6*sphere({0,0,0}, 1))); SetBody b(s, {-2,-2,-2}, {2,2,2}, depth = 8);",
        "build",
    ),
    "degree 1e6": (P4 + "BCurve c({A,B,C,D}, degree = 1000000);", "build"),
    "pts 1e5 ccurve": (
        "for (i = 1:100000) AbsPoint p(i, sin(i), 0);\nCCurve c({"
        + ",".join(f"p[{i}]" for i in range(1, 100001))
        + "}, degree = 3);",
        "build",
    ),
    "pts 2e4 bcurve deg 19999": (
        "for (i = 1:20000) AbsPoint p(i, sin(i), 0);\nBCurve c({"
        + ",".join(f"p[{i}]" for i in range(1, 20001))
        + "}, degree = 19999);",
        "build",
    ),
    "contours 1e7": (
        S + "RuledSurf s(l, n); XContours x(s, 0, 10000000, 0.5, 0.0000001);",
        "build",
    ),
    "contours n 1e9": ("AbsPoint A(0,0,0); XContours x(0, 1000000000, 0.5, 0.1);", "check"),
    "solveset loop": (
        "param float x = 1 in [-1e9, 1e9]; SolveSet s({x}, {sin(x*1e9) - 2});",
        "check",
    ),
    "format width": ('print format("%1000000000d", 1);', "check"),
    "self load": ('load "model.sdl";', "check"),
    "sub 1e5": (
        "".join(f"subroutine f{i}() {{ f{i + 1}(); f{i + 1}(); }}\n" for i in range(40))
        + "subroutine f40() {} f0();",
        "check",
    ),
    "chain 1e5": (
        "AbsPoint p0(0,0,0);"
        + "".join(f"RelPoint p{i}(p{i - 1}, 1, 0, 0);\n" for i in range(1, 100001)),
        "build",
    ),
    "offset chain 300": (
        S
        + "RuledSurf s0(l, n);"
        + "".join(f"OffsetSurf s{i}(s{i - 1}, 0.01, 0.01, 0.01, 0.01);\n" for i in range(1, 300)),
        "build",
    ),
    "subcurve chain 3000": (
        P4
        + "BCurve c0({A,B,C}, degree=2);"
        + "".join(
            f"AbsBead a{i}(c{i - 1}, 0.001); AbsBead b{i}(c{i - 1}, 0.999); SubCurve c{i}(a{i}, b{i});\n"
            for i in range(1, 3000)
        ),
        "build",
    ),
    "doubling curves": (
        P4
        + "Line c0(A,B);"
        + "".join(f"PolyCurve c{i}({{c{i - 1}, c{i - 1}}});\n" for i in range(1, 64)),
        "build",
    ),
    "strings double": ('string s = "a"; while (1) s = s + s;', "check"),
    "file without end": (
        'file f = open("a.txt", "w"); while (1) write(f, "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx");',
        "run",
    ),
    "parallel chain 299": (
        S
        + "RuledSurf s0(l, n);"
        + "".join(f"OffsetSurf s{i}(s{i - 1}, 0.01);\n" for i in range(1, 300)),
        "build",
    ),
    "parallel curves 299": (
        P4
        + "BCurve c0({A,B,C});"
        + "".join(f'OffsetCurve c{i}(c{i - 1}, 0.01, "z=0");\n' for i in range(1, 300)),
        "build",
    ),
    "chains double": (
        P4
        + "Line l(A,B); Line m(B,A); PolyCurve c0({l, m});"
        + "".join(f"PolyCurve c{i}({{c{i - 1}, c{i - 1}}});\n" for i in range(1, 40)),
        "build",
    ),
    "printed for ever": ('for (i = 1:100000000) print "x";', "run"),
    "doubling lists": (
        "list L0 = {1};" + "".join(f" list L{i} = {{L{i - 1}, L{i - 1}}};" for i in range(1, 60)),
        "check",
    ),
}

#: The most megabytes of a text that is refused, and of one that is carried out.
REFUSED, DONE = 500, 1000


def chosen() -> list[str]:
    """In the ordinary tests every fourth."""
    names = list(BOMBS)
    return names if SOAK else names[2::4]


def zipped(data: bytes) -> bytes:
    """A 3MF file whose model is this."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", data)
    return out.getvalue()


VTP = (
    b'<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64" '
    b'compressor="vtkZLibDataCompressor"><PolyData><Piece NumberOfPoints="1000000000" '
    b'NumberOfPolys="1"><Points><DataArray type="Float64" format="binary">%s</DataArray></Points>'
    b"</Piece></PolyData></VTKFile>"
)
GLB = json.dumps(
    {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 90_000_000, "type": "VEC3"}],
    }
).encode()

#: Files of other programs that state or unfold to far more than they hold, and their endings.
FILES = {
    "stl 2^32": ("stl", bytes(80) + b"\xff\xff\xff\xff" + bytes(50)),
    "ply 1e9": (
        "ply",
        b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\n"
        b"property float y\nproperty float z\nend_header\n",
    ),
    "ply list 2^31": (
        "ply",
        b"ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nelement face 1\n"
        b"property list uint int vertex_indices\nend_header\n\xff\xff\xff\x7f",
    ),
    "off 1e9": ("off", b"OFF\n1000000000 1000000000 0\n0 0 0\n"),
    "obj indices": ("obj", b"v 0 0 0\nf " + b"1 " * 2_000_000),
    "gdf 1e9": ("gdf", b"a\n1 9.8\n0 0\n999999999\n0 0 0\n"),
    "pnl 1e9": ("pnl", b"a\nb\nc\n999999999 999999999 0 0\n\n\n1 0 0 0\n"),
    "glb 9e7": ("glb", struct.pack("<4s4I", b"glTF", 2, 20 + len(GLB), len(GLB), 0x4E4F534A) + GLB),
    "glb brackets": (
        "glb",
        struct.pack("<4s4I", b"glTF", 2, 20 + 10**7, 10**7, 0x4E4F534A) + b"[" * 10**7,
    ),
    "3mf unfolds": ("3mf", zipped(b" " * (600 << 20))),
    "vtp blocks": ("vtp", VTP % base64.b64encode(struct.pack("<3Q", 2**40, 2**40, 0))),
    "vtk 1e12": ("vtk", b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET POLYDATA\nPOINTS 999999999999 float\n"),
    "vtk cells": (
        "vtk",
        b"# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 999999999 1\n0\n",
    ),
    "dxf blocks": (
        "dxf",
        b"".join(
            [b"0\nSECTION\n2\nBLOCKS\n"]
            + [
                b"0\nBLOCK\n2\nB%d\n10\n0\n20\n0\n%s0\nENDBLK\n"
                % (k, b"0\nINSERT\n2\nB%d\n10\n0\n20\n0\n" % (k + 1) * 10)
                for k in range(12)
            ]
            + [b"0\nBLOCK\n2\nB12\n10\n0\n20\n0\n0\nLINE\n10\n0\n20\n0\n11\n1\n21\n1\n0\nENDBLK\n"]
            + [b"0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nB0\n10\n0\n20\n0\n0\nENDSEC\n0\nEOF\n"]
        ),
    ),
    "svg depth": ("svg", b'<svg xmlns="http://www.w3.org/2000/svg">' + b"<g>" * 10**6),
    "svg entities": ("svg", b'<!DOCTYPE s [<!ENTITY a "b">]><svg/>'),
    "step numbers": ("step", b"ISO-10303-21;\nDATA;\n#1=CARTESIAN_POINT('',(1.E999,0.,0.));\nENDSEC;\nEND-ISO-10303-21;\n"),
    "step deep": ("step", b"ISO-10303-21;\nDATA;\n#1=A(" + b"(" * 10**6 + b");\nENDSEC;\nEND-ISO-10303-21;\n"),
    "csv of offsets": ("csv", b"station,waterline,half-breadth\n" + b"0,0,1\n" * 500_000),
}  # fmt: skip


def chosen_files() -> list[str]:
    """In the ordinary tests every third."""
    return list(FILES) if SOAK else list(FILES)[::3]


@pytest.mark.parametrize("name", chosen_files())
def test_a_file_that_states_too_much_does_no_harm(tmp_path: Path, name: str) -> None:
    ending, data = FILES[name]
    for module in {"dxf": ["ezdxf"], "step": ["OCP"]}.get(ending, []):
        pytest.importorskip(module)
    (tmp_path / f"bomb.{ending}").write_bytes(data)
    peak = harmless(tmp_path, ["convert", f"bomb.{ending}", "-o", "out.sdl"])
    assert peak < REFUSED, f"{peak} MB"


@pytest.mark.parametrize("name", chosen())
def test_a_bomb_does_no_harm(tmp_path: Path, name: str) -> None:
    text, command = BOMBS[name]
    (tmp_path / "model.sdl").write_text(text)
    harmless(tmp_path, [command, "model.sdl"])


#: Commands beside those of the texts, with their arguments.
COMMANDS = {
    "eval": ["1"], "fmt": [], "graph": ["-o", "g.svg"], "hydro": ["--draft", "1"],
    "render": ["-o", "p.png", "--size", "60x40"], "convert": ["-o", "m.ms2"], "export": ["--html"],
}  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS if SOAK else list(COMMANDS)[::3])
@pytest.mark.parametrize("name", ["parens 1e6", "setbody depth 12", "for objs 1e7"])
def test_a_bomb_does_no_harm_in_other_commands(tmp_path: Path, name: str, command: str) -> None:
    (tmp_path / "model.sdl").write_text(BOMBS[name][0])
    harmless(tmp_path, [command, "model.sdl", *COMMANDS[command]])


def harmless(tmp_path: Path, words: list[str]) -> int:
    """Runs a command that may refuse by name; the peak of its memory in megabytes."""
    # Time of the processor ends what has no end; a development build is slow.
    words = [sys.executable, "-m", "moldloft", *words]
    with (tmp_path / "out").open("wb") as out, (tmp_path / "err").open("wb") as err:
        child = subprocess.Popen(
            words, cwd=tmp_path, stdout=out, stderr=err, stdin=subprocess.DEVNULL,
            env={**os.environ, "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (60, 60)),
        )  # fmt: skip
        peak = 0
        while child.poll() is None:
            try:
                status = Path(f"/proc/{child.pid}/status").read_text()
                peak = max(peak, int(status.split("VmHWM:")[1].split()[0]) // 1024)
            except (OSError, IndexError):
                pass
            time.sleep(0.02)
    said = (tmp_path / "err").read_text(errors="replace")
    assert child.returncode in (0, 1), (child.returncode, said[-2000:])
    for word in ("Traceback", "panicked", "internal-error"):
        assert word not in said, said[-2000:]
    if child.returncode:
        assert "error[" in said or "error: " in said, said[-2000:]
    assert peak < (REFUSED if child.returncode else DONE), f"{peak} MB\n{said[-500:]}"
    return peak


#: Values that double at each turn, each found in another place of the program.
DOUBLING = {
    "joined": "farray a = uniform(0, 1, 1000); for (i = 1:60) a = join(a, a);",
    "joined points": "curve a = points({0, 0, 0}, {1, 0, 0}); for (i = 1:60) a = join(a, translate(a, {i, 0, 0}));",
    "moved": "set s = set(sphere({0, 0, 0}, 1)); for (i = 1:60) s = s | translated(s, {i/10, 0, 0});",
    "repeated": "set s = set(sphere({0, 0, 0}, 1)); for (i = 1:60) s = repeated(s, {i, 0, 0}, 10);",
    "twisted": "set s = set(sphere({0, 0, 0}, 1)); for (i = 1:60) s = s | twisted(s, i/100);",
    "texts": 'text t = "abcdefgh"; for (i = 1:60) t = t + t;',
}  # fmt: skip


@pytest.mark.parametrize("limit", ["--limit", "ulimit"])
@pytest.mark.parametrize("name", DOUBLING if SOAK else list(DOUBLING)[::2])
def test_what_doubles_keeps_within_the_limit(tmp_path: Path, name: str, limit: str) -> None:
    (tmp_path / "model.sdl").write_text(DOUBLING[name])
    words = [sys.executable, "-m", "moldloft", "check", "model.sdl"]
    if limit == "--limit":
        words += ["--limit", "memory=200M"]

    def within() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
        if limit == "ulimit":
            resource.setrlimit(resource.RLIMIT_AS, (800 << 20, 800 << 20))

    done = subprocess.run(
        ["/usr/bin/env", "python3", "-c", PEAK, *words], cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=within,
    )  # fmt: skip
    assert done.returncode == 1 and "error[" in done.stderr, done.stderr[-2000:]
    assert "model.sdl:1:" in done.stderr and "limit" in done.stderr, done.stderr[-2000:]
    if limit == "--limit":
        # The interpreter and NumPy take 60 of them.
        assert int(done.stdout.split()[-1]) < 1.2 * 200 + 60, done.stdout


#: Runs a command and prints the peak of its memory in megabytes.
PEAK = """
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:]).returncode
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024)
sys.exit(code)
"""

"""The examples of the C interface, compiled by the system's C and Fortran compilers and run."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import moldloft

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "examples" / "embedding"
INCLUDE = ROOT / "crates" / "capi" / "include"
SUFFIX = {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")

# The model of both examples, with its parameter at their value.
PROGRAM = """
    param float beam = 2.5 in [1, 3];
    BCurve keel({{0, 0, 0}, {3, 0, -0.5}, {6, 0, 0}});
    BCurve sheer({{0, 0, 1}, {3, beam, 1}, {6, 0, 1}});
    RuledSurf side(keel, sheer, divisions = {20, 5});
"""


def library() -> Path:
    """The folder of the shared library; skips the test where it is not built."""
    for profile in ("release", "debug"):
        folder = ROOT / "target" / profile
        if (folder / f"libmoldloft{SUFFIX}").exists():
            return folder
    pytest.skip("the shared library is not built: cargo build -p moldloft-capi")


def compiled(compiler: str, source: Path, target: Path, *options: str) -> Path:
    """A program of the compiler; skips the test where there is none."""
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    folder = library()
    # A program looks for the library by its name with the version of the interface.
    (target.parent / "libmoldloft.so.1").symlink_to(folder / f"libmoldloft{SUFFIX}")
    linked = [f"-L{folder}", "-lmoldloft", f"-Wl,-rpath,{target.parent}", "-lm"]
    command = [compiler, *options, str(source), *linked, "-o", str(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=target.parent)
    assert done.returncode == 0, done.stderr
    # Warnings are faults of the header or of the example.
    assert not done.stderr
    return target


def run(program: Path) -> str:
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(words: str, line: str) -> list[float]:
    (found,) = [text for text in words.splitlines() if text.startswith(line)]
    return [float(x) for x in re.findall(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?", found)]


@pytest.mark.skipif(sys.platform == "win32", reason="options of Unix compilers")
@pytest.mark.parametrize(
    "options", [("-std=c99",), ("-std=c11", "-O2"), ("-x", "c++", "-std=c++17")]
)
def test_the_example_in_c_runs(options: tuple[str, ...], tmp_path: Path) -> None:
    source = EXAMPLES / "points.c"
    if "c++" in options:
        # C++ knows no conversion from malloc's pointers; the header is what is looked at.
        source = tmp_path / "header.cc"
        source.write_text('#include "moldloft.h"\nint main() { return mlf_v1_abi() == 1 ? 0 : 1; }')
    strict = ("-Wall", "-Wextra", "-pedantic", f"-I{INCLUDE}")
    words = run(compiled("cc", source, tmp_path / "points", *options, *strict))
    if "c++" in options:
        return
    model = moldloft.loads(PROGRAM)
    # A B-spline's point at 1/2 by hand: half of its middle control point.
    assert numbers(words, "point") == [3, 1.25, 1]
    assert numbers(words, "by v") == pytest.approx([0, 1.25, 1.25], abs=1e-14)
    area, slope = numbers(words, "area")
    assert area == pytest.approx(model["side"].area, rel=1e-11)
    assert slope == pytest.approx(float(model.derivative("side.area", "beam")), rel=1e-11)
    mesh = model.mesh()
    assert f"{len(mesh.vertices)} vertices, {len(mesh.faces)} panels" in words
    # The time is another matter: a bench has it.
    assert "1000000 points in" in words


@pytest.mark.skipif(sys.platform == "win32", reason="options of Unix compilers")
def test_the_example_in_fortran_runs(tmp_path: Path) -> None:
    options = ("-std=f2008", "-Wall", "-Wextra", "-pedantic", "-ffree-line-length-none")
    words = run(compiled("gfortran", EXAMPLES / "points.f90", tmp_path / "points", *options))
    model = moldloft.loads(PROGRAM)
    assert numbers(words, "point") == [3, 1.25, 1]
    (slope,) = numbers(words, "derivative")
    assert slope == pytest.approx(float(model.derivative("side.area", "beam")), abs=1e-12)
    mesh = model.mesh()
    assert f"{len(mesh.vertices)} vertices, {len(mesh.faces)} panels" in words


def test_points_through_the_library_are_those_of_the_package() -> None:
    import ctypes

    library_ = ctypes.CDLL(str(library() / f"libmoldloft{SUFFIX}"))
    size, number = ctypes.c_size_t, ctypes.c_double
    model, side = ctypes.c_void_p(), ctypes.c_void_p()
    text = PROGRAM.encode()
    assert library_.mlf_v1_from_text(text, size(len(text)), ctypes.byref(model)) == 0
    assert library_.mlf_v1_shape(model, b"side", size(4), ctypes.byref(side)) == 0
    n = 100_000 if os.environ.get("MOLDLOFT_SOAK") == "1" else 1000
    uv = np.random.default_rng(22).uniform(0, 1, (n, 2))
    xyz = np.empty((n, 3))
    pointers = [a.ctypes.data_as(ctypes.POINTER(number)) for a in (uv, xyz)]
    assert library_.mlf_v1_points(side, size(n), *pointers) == 0
    assert (xyz == moldloft.loads(PROGRAM)["side"](*uv.T)).all()
    library_.mlf_v1_shape_free(side)
    library_.mlf_v1_free(model)

"""Points through the C interface beside those of the Python package: both are the Rust core.

cargo build --release -p moldloft-capi && python benches/embedding.py
"""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path
from time import perf_counter

import numpy as np

import moldloft

ROOT = Path(__file__).parents[1]
SUFFIX = {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")
COUNT = 1_000_000
ROUNDS = 7
PROGRAM = """
    BCurve keel({{0, 0, 0}, {3, 0, -0.5}, {6, 0, 0}});
    BCurve sheer({{0, 0, 1}, {3, 2.5, 1}, {6, 0, 1}});
    RuledSurf side(keel, sheer);
"""


def main() -> None:
    """Prints the seconds of both, the least of several rounds."""
    found = [ROOT / "target" / p / f"libmoldloft{SUFFIX}" for p in ("release", "debug")]
    path = next((p for p in found if p.exists()), None)
    if path is None:
        sys.exit("the shared library is not built: cargo build --release -p moldloft-capi")
    library = ctypes.CDLL(str(path))
    model, side = ctypes.c_void_p(), ctypes.c_void_p()
    text = PROGRAM.encode()
    size = ctypes.c_size_t
    assert library.mlf_v1_from_text(text, size(len(text)), ctypes.byref(model)) == 0
    assert library.mlf_v1_shape(model, b"side", size(4), ctypes.byref(side)) == 0
    uv = np.random.default_rng(1).uniform(0, 1, (COUNT, 2))
    xyz = np.empty((COUNT, 3))
    pointers = [a.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for a in (uv, xyz)]
    surface = moldloft.loads(PROGRAM)["side"]
    u, v = np.ascontiguousarray(uv.T)
    ours, theirs = [], []
    for _ in range(ROUNDS):
        start = perf_counter()
        assert library.mlf_v1_points(side, size(COUNT), *pointers) == 0
        ours.append(perf_counter() - start)
        start = perf_counter()
        points = surface(u, v)
        theirs.append(perf_counter() - start)
    assert (points == xyz).all()
    print(f"{path.parent.name} library, {COUNT} points: {min(ours):.4f} s")
    print(f"Python package, the same points: {min(theirs):.4f} s")


if __name__ == "__main__":
    main()

# ruff: noqa: E501 -- programs of one line
"""Ctrl-C stops whatever a program is about: loops, statements on large arrays, and each routine that takes long.

An optimised build ends within a tenth of a second of the signal; the bound of the long run allows for
a build without optimisation, and is far below what the routines themselves would take.
"""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
ROWS = "for (i = 1:{0}) s[i,].x = i; for (j = 1:{0}) s[,j].y = j;"
BLOCK = "surface s[90,90]; for (i = 1:90) for (j = 1:90) s[i,j] = {i, j, sin(i/9)}; block b = hyperbolic(s, uniform(0, 9, 20));"
CASES = {
    "numbers": "float s = 0; while (1) s += 1;",
    "vectors": "vector v; while (1) v += {1, 0, 0};",
    "recursion": "function float f(float n) { if (n < 1) return 0; return f(n - 1) + f(n - 1); } float s = f(60);",
    "arrays": "farray a[1000000] = 1; while (1) a = sin(a)*1.0000001;",
    "sort": "farray a = sin(1e6*uniform(0, 1, 1000000)); while (1) farray b = sort(a);",
    "tfi": f"surface s[1200,1200]; {ROWS.format(1200)} while (1) s = tfi(s);",
    "tfi of a block": "block b[70,70,70]; while (1) b = tfi({b[1,,], b[70,,], b[,1,], b[,70,], b[,,1], b[,,70]});",
    "folds": f"surface s[900,900]; {ROWS.format(900)} while (1) float n = folds(s);",
    "curvature": f"surface s[200,200]; {ROWS.format(200)} while (1) farray k = gauss(s);",
    "elliptic": "surface s[120,120]; for (i = 1:120) for (j = 1:120) s[i,j] = {i, j + 3*sin(i/20), 0}; surface t = elliptic(s, 1000000, 1e-300);",
    "elliptic block": BLOCK + " block c = elliptic_block(b, 1000000, 1e-300);",
    "march": 'load "naca.sdl" curve c[641]; naca4s(c, 0, 0, 12); c = c[::-1]; while (1) surface g = hyperbolic(c, geometric(0, 20, 1e-6, 300), "i1 periodic");',
    "march of a surface": "surface s[100,100]; for (i = 1:100) for (j = 1:100) s[i,j] = {i, j, 3*sin(i/9)*cos(j/7)}; while (1) block b = hyperbolic(s, geometric(0, 50, .001, 150));",
    "curvature of a large surface": f"surface s[1400,1400]; {ROWS.format(1400)} while (1) farray k = gauss(s);",
    "solid": f'surface s[1500,1500]; {ROWS.format(1500)} while (1) write_stl("a.stl", s);',
    "picture": f'surface s[900,900]; {ROWS.format(900)} while (1) plot("a.png", s);',
    "drawing": f'surface s[900,900]; {ROWS.format(900)} while (1) plot("a.svg", s);',
    "grid file": f'surface s[1000,1000]; {ROWS.format(1000)} while (1) write_p3d("a.x", "text", s);',
    "block file": BLOCK
    + ' block c = b; while (1) write_gmsh("a.msh", b, c + {0, 0, 99}, c + {99, 0, 0});',
    "table": 'curve c[1000000]; c.x = uniform(0, 1, 1000000); while (1) write_csv("a.csv", c);',
    "grid file read": f'surface s[1500,1500]; {ROWS.format(1500)} write_p3d("a.x", s); while (1) surface t = read_p3d("a.x");',
    "report": BLOCK + " while (1) string t = report(b);",
    "section grid": 'load "naca.sdl" curve c[321]; naca4s(c, 0, 0, 12); while (1) surface g = c_grid(c, geometric(0, 20, 1e-5, 100), 10, 60);',
}
CHILD = """
import os, signal, sys, threading, time
import moldloft
moldloft.limits(steps=10**15, seconds=1e9)
sent = []
def send():
    time.sleep(1.5)
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send, daemon=True).start()
try:
    moldloft.loads(sys.argv[1])
except KeyboardInterrupt:
    print(time.perf_counter() - sent[0])
else:
    print("ended by itself")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Windows go to groups")
@pytest.mark.parametrize("program", CASES.values(), ids=CASES.keys())
def test_ctrl_c_stops_it(program: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CHILD, program], capture_output=True, text=True, timeout=100
    )
    assert done.returncode == 0, done.stderr
    # A second is what is waited for work that does not look; then it would go on unseen.
    # In the ordinary run that it ended is all: the loops have no end.
    took = float(done.stdout)
    assert took < 0.9 or not SOAK, took

"""What becomes of foreign files: every reader over every file below some folders.

    python tests/ecosystem.py FOLDER [...] [--memory 2] [--seconds 10] > table.txt

One line for each ending and outcome, and below it each file that was neither read nor refused by
name: a traceback, a wrong type of error, the end of the process, more than so many GiB or seconds.
The exit status is 1 when there is one. Run it before and after a change of a reader, and compare.
The files stay where they are: aerofoils, meshes and tables that Python packages ship, say.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import subprocess
import sys
import threading
from collections import Counter
from pathlib import Path

#: Endings that a reader is chosen by, and one that says nothing.
ENDINGS = {
    ".dat", ".csv", ".txt", ".xyz", ".p3d", ".x", ".stl", ".obj", ".off", ".ply", ".gdf", ".skt",
    ".sdl", ".ms2", ".json", ".dxf", ".vtk", ".vts", ".vtp", ".vtu", ".msh", ".stp", ".step",
    ".igs", ".iges", ".3dm", ".geo", ".mesh", ".nas", ".inp", ".pnl",
}  # fmt: skip

LARGEST = 20 << 20

WORKER = r"""
import json, os, sys, time
from pathlib import Path
memory = int(sys.argv[1]) << 30
# Nothing else is said on this channel.
answers = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (memory + (1 << 30), memory + (1 << 30)))
except ImportError:
    pass
import moldloft
from moldloft import grids, offsets, overlays
from moldloft.fairing import files as tables
from moldloft.shapes.sketches import Sketch
moldloft.limits(memory=memory)

def asked(path):
    # A file as what its ending says, and as tables of points, which any text may be.
    ending = path.suffix.lower()
    if ending == ".skt":
        yield "sketch", lambda: Sketch.load(path)
    if ending in (".sdl", ".ms2"):
        yield "model", lambda: moldloft.load(path)
    if ending[1:] in overlays.ENDINGS:
        yield "overlay", lambda: overlays.read(path)
    yield "points", lambda: grids.read_points(path)
    yield "aerofoil", lambda: grids.read_aerofoil(path)
    yield "plot3d", lambda: grids.read_plot3d(path)
    yield "offsets", lambda: offsets.read(path)
    yield "fairing", lambda: tables.read_points(path)

for line in sys.stdin:
    path = Path(json.loads(line))
    for name, ask in asked(path):
        print(json.dumps(["begin", name]), file=answers)
        began = time.process_time()
        try:
            ask()
            found = "read"
        except moldloft.Error as error:
            found = "refused"
        except MemoryError:
            found = "refused"
        except BaseException as error:
            found = f"{type(error).__name__}: {str(error)[:300]}"
        print(json.dumps(["end", name, found, time.process_time() - began]), file=answers)
    print(json.dumps(["done"]), file=answers)
"""


def files(folders: list[Path]) -> list[Path]:
    """All files of our endings, each content once."""
    found: dict[bytes, Path] = {}
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.suffix.lower() in ENDINGS and path.is_file() and not path.is_symlink():
                size = path.stat().st_size
                if 0 < size <= LARGEST:
                    found.setdefault(path.read_bytes()[:4096] + str(size).encode(), path)
    return list(found.values())


class Reader:
    """A process that reads files, and is started again when one ends it."""

    def __init__(self, memory: int, seconds: float) -> None:
        self.memory, self.seconds = memory, seconds
        self.child: subprocess.Popen[str] | None = None

    def read(self, path: Path) -> list[tuple[str, str]]:
        """Each reader's name and what it said of the file."""
        if self.child is None:
            self.child = subprocess.Popen(
                [sys.executable, "-c", WORKER, str(self.memory)], stdin=subprocess.PIPE,
                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, bufsize=1,
            )  # fmt: skip
        child = self.child
        assert child.stdin and child.stdout
        found: list[tuple[str, str]] = []
        name = "start"
        # All readers of a file together, and the start of a process.
        end = threading.Timer(6 * self.seconds + 60, child.kill)
        end.start()
        try:
            with contextlib.suppress(BrokenPipeError):
                child.stdin.write(json.dumps(str(path)) + "\n")
            for line in child.stdout:
                said = json.loads(line)
                if said[0] == "done":
                    return found
                name = said[1]
                if said[0] == "end":
                    late = said[3] > self.seconds
                    found.append((name, f"{said[3]:.0f} s" if late else said[2]))
        finally:
            end.cancel()
        self.child = None
        return [*found, (name, f"the process ended ({child.wait()})")]


def main() -> int:
    """Reads all and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--memory", type=int, default=2, help="GiB")
    parser.add_argument("--seconds", type=float, default=10, help="for each reader of a file")
    options = parser.parse_args()
    found = files(options.folders)
    reader = Reader(options.memory, options.seconds)
    counts: Counter[tuple[str, str, str]] = Counter()
    faults: list[str] = []
    for path in found:
        for name, outcome in reader.read(path):
            plain = outcome if outcome in ("read", "refused") else "FAULT"
            counts[path.suffix.lower(), name, plain] += 1
            if plain == "FAULT":
                faults.append(f"{path}: {name}: {outcome}")
    for (ending, name, outcome), count in sorted(counts.items()):
        print(f"{ending:6} {name:10} {outcome:8} {count}")
    print(f"{len(found)} files, {sum(counts.values())} readings, {len(faults)} faults")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

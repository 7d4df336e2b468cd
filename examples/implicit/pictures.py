"""Draws the pictures of docs/implicit.md: `python examples/implicit/pictures.py [folder]`."""

from __future__ import annotations

import sys
from pathlib import Path

import moldloft
from moldloft import implicit as im

HERE = Path(__file__).parent
SIZE = (760, 520)


def model(name: str) -> moldloft.Model:
    """An example of this folder."""
    return moldloft.load(HERE / f"{name}.sdl")


def main(folder: Path) -> None:
    """Draw them all."""

    def path(name: str) -> Path:
        return folder / f"implicit-{name}.png"

    bored = model("tee")["bored"].value
    # Cut open, so that the bores show.
    _, y, _ = im.axes()
    opened = bored & im.Set(-y, name="cut", colour=15)
    eye = (-4.5, -9.5, 5.0)
    opened.picture(path("tee"), (-3.6, -1.1, -1.1), (3.8, 1.1, 3.6), size=SIZE, eye=eye)
    bottle = model("neck")["bottle"].value
    box = (-3.2, -2.6, -1.6), (2.6, 1.6, 1.6)
    bottle.picture(path("neck"), *box, size=SIZE, samples=2)
    for name in ("lambdas", "quadric", "wave", "wires", "manifold", "lattices"):
        png = model(name).picture(*SIZE)
        path(name).write_bytes(png)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parents[1] / "docs" / "images")

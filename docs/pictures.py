"""Draws the pictures of the example models and of fairing: `python docs/pictures.py [NAME ...]`.

Those of the gallery are drawn by `docs/gallery.py`, of sketches by `examples/sketch/pictures.py`, of
implicit solids by `examples/implicit/pictures.py`, of the kinds by `moldloft doc --pictures`.
"""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

import moldloft

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
IMAGES = ROOT / "docs" / "images"

#: Model and size of each picture.
MODELS = {
    "sailboat": ("sailboat/hull.sdl", (1200, 640)),
    "wing": ("wing/wing.sdl", (900, 560)),
    "wingbody": ("wingbody/wingbody.sdl", (900, 560)),
    "platform": ("platform/platform.sdl", (900, 560)),
    "yacht": ("sailboat/yacht.sdl", (900, 560)),
    "submarine": ("submarine/submarine.sdl", (900, 560)),
    "propeller": ("propeller/propeller.sdl", (900, 560)),
    "missile_half": ("missile/half.sdl", (1000, 640)),
    "missile_finned": ("missile/finned.sdl", (1000, 640)),
}

#: Arguments of `moldloft fair` for each plot, and its width in picture points.
PLOTS = {
    "fairing-naca0012": ("naca0012-3.csv --tol 1e-3", 1000),
    "fairing-section": ("section.csv --tol 0.006 --breaks auto --release auto --as fit", 1000),
    "fairing-wigley": ("wigley.p3d --tol 1e-4 --measure jumps", 1000),
    "fairing-lines": ("lines.csv --tol 0.006", 1000),
}

#: Models as drawn and at the optimum of a study, beside each other.
STUDIES = {
    "study-bulb": (
        "studies/bulb.sdl",
        {"radius": 1.3, "bulb_length": 9.68, "bulb_x": -0.85, "depth": 2.9},
    ),
    "study-platform": (
        "platform/platform.sdl",
        {"leg_radius": 7, "pontoon_radius": 4.5, "spacing": 90, "draft": 32.5},
    ),
}

#: Variables of the deformed hull.
DEFORMED = {"beam_fore": 0.3, "beam_mid": 0.2, "keel_fore": -0.2, "keel_aft": 0.15}


def plotted(arguments: str, width: int) -> bytes:
    """The plot of a fairing, in 256 colours and no wider than a page shows it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plot.png"
        command = [sys.executable, "-m", "moldloft", "fair", *arguments.split()]
        # The status is 1 where the data have a fault that is reported.
        subprocess.run(
            [*command, "--plot", str(path)], cwd=EXAMPLES / "fairing", capture_output=True
        )
        with Image.open(path) as drawn:
            height = round(drawn.height * width / drawn.width)
            small = drawn.convert("RGB").resize((width, height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    # No colour is off by more than a fifteenth of its range, so that maps still match their scales.
    few = small.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=10, dither=Image.Dither.NONE)
    few.save(out, "PNG", optimize=True)
    return out.getvalue()


def deformed() -> bytes:
    """A hull's mesh as drawn and as deformed."""
    sys.path.insert(0, str(EXAMPLES / "studies"))
    from deformed_hull import deformation

    with tempfile.TemporaryDirectory() as folder:
        return beside(deformation(Path(folder)).model(), DEFORMED)


def beside(model: moldloft.Model, changed: dict[str, float]) -> bytes:
    """A model as drawn and with other values, beside each other, in 256 colours."""
    both = Image.new("RGB", (1200, 420))
    for k, values in enumerate(({}, changed)):
        model.set(values)
        with Image.open(io.BytesIO(model.picture(600, 420))) as drawn:
            both.paste(drawn.convert("RGB"), (600 * k, 0))
    out = io.BytesIO()
    both.quantize(256, dither=Image.Dither.NONE).save(out, "PNG", optimize=True)
    return out.getvalue()


def main() -> None:
    """Draws the pictures that are named, or all."""
    named = sys.argv[1:] or [*MODELS, *PLOTS, *STUDIES, "deformation"]
    for name in named:
        if name in MODELS:
            place, size = MODELS[name]
            data = moldloft.load(EXAMPLES / place).picture(*size)
        elif name in STUDIES:
            place, values = STUDIES[name]
            data = beside(moldloft.load(EXAMPLES / place), values)
        elif name == "deformation":
            data = deformed()
        else:
            data = plotted(*PLOTS[name])
        (IMAGES / f"{name}.png").write_bytes(data)
        print(f"{name}.png: {len(data) / 1000:.0f} kB")


if __name__ == "__main__":
    main()

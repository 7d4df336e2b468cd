"""Draws the pictures of the example models and of fairing: `python docs/pictures.py [NAME ...]`.

`drag` is the animation of the README: a yacht that follows a parameter, with its figures. Pictures of the gallery are drawn by `docs/gallery.py`, of sketches by `examples/sketch/pictures.py`, of
implicit solids by `examples/implicit/pictures.py`, of the kinds by `moldloft doc --pictures`.
"""

from __future__ import annotations

import io
import math
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

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

#: Programs that draw a picture themselves.
PROGRAMS = {"nacelle_blocks": ("nacelle/blocks.sdl", "nacelle.png")}

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
        {"leg_radius": 7, "pontoon_radius": 4.5, "spacing": 90, "draft": 26.3},
    ),
    "study-canoe": (
        "studies/canoe.sdl",
        {
            **{"B2.y": 0.75, "B2.z": 0.419, "B3.y": 0.448, "B3.z": -0.5426, "B4.z": -0.5184},
            **{"C2.y": 1.5569, "C2.z": 0, "C3.y": 1.3, "C3.z": -0.75, "C4.z": -0.85},
            **{"D2.y": 1.2, "D2.z": 0.5, "D3.y": 0.8, "D3.z": -0.15, "D4.z": -0.4338},
            **{"A3.x": 0.4, "A4.z": -0.2, "E3.y": 0.5, "E3.z": 0.35, "E4.z": 0.05},
        },
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


def motions() -> bytes:
    """Heave and surge of the platform by the period of the waves, by Capytaine."""
    from matplotlib import pyplot

    sys.path.insert(0, str(EXAMPLES / "studies"))
    import waves
    from heave import coarse

    platform = moldloft.load(EXAMPLES / "platform/platform.sdl")
    radius, periods = 0.45 * platform["spacing"], [6 + 0.5 * k for k in range(49)]
    found = waves.operators(
        coarse(platform.text),
        periods,
        heading=0.0,
        centre=(0, 0, -0.5 * platform["draft"]),
        gyration=(radius, radius, radius),
    )
    figure, axes = pyplot.subplots(figsize=(7, 3.2), dpi=110, layout="constrained")
    for dof in ("Heave", "Surge"):
        axes.plot(periods, abs(found[dof]), label=dof.lower())
    axes.set(xlabel="period of the waves in s", ylabel="amplitude in m/m", ylim=(0, 3))
    axes.grid(alpha=0.3)
    axes.legend()
    out = io.BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    pyplot.close(figure)
    return out.getvalue()


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


#: Frames of the animation, their interval in milliseconds, and the size of the picture.
FRAMES, INTERVAL, SIZE = 40, 80, (860, 400)

#: Parameter of the animation, with its range, and colours of text and highlight.
DRAGGED, LOW, HIGH = "keel_at", 10.5, 13.0
INK, ACCENT, PAPER = (36, 48, 56), (196, 78, 38), (250, 251, 252)


def _font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    from matplotlib import get_data_path

    name = "DejaVuSansMono-Bold.ttf" if bold else "DejaVuSansMono.ttf"
    return ImageFont.truetype(str(Path(get_data_path()) / "fonts" / "ttf" / name), size)


def _frame(model: moldloft.Model, value: float) -> Image.Image:
    model.set({DRAGGED: value})
    volume, lcb = model.eval("hydrostatics.volume"), model.eval("hydrostatics.lcb")
    slope = model.derivative("hydrostatics.lcb", DRAGGED)
    page = Image.new("RGB", (SIZE[0], SIZE[1] + 104), PAPER)
    with Image.open(io.BytesIO(model.picture(*SIZE))) as drawn:
        page.paste(drawn.convert("RGB"), (0, 68))
    draw = ImageDraw.Draw(page)
    x = 20
    for text, colour, bold in (
        (f"param float {DRAGGED} = ", INK, False),
        (f"{value:.2f}", ACCENT, True),
        (f" in [{LOW:g}, {HIGH:g}];", INK, False),
    ):
        draw.text((x, 12), text, colour, _font(17, bold))
        x += round(draw.textlength(text, _font(17, bold)))
    left, right, y = 22, 480, 50
    at = left + (right - left) * (value - LOW) / (HIGH - LOW)
    draw.line((left, y, right, y), (176, 188, 196), 4)
    draw.line((left, y, at, y), ACCENT, 4)
    draw.ellipse((at - 9, y - 9, at + 9, y + 9), ACCENT)
    figures = f"volume {volume:.2f} ft³   lcb {lcb:.3f} ft   d lcb / d {DRAGGED} {slope:.4f}"
    draw.text((20, SIZE[1] + 76), figures, INK, _font(15))
    return page


def dragged() -> bytes:
    """The yacht while its keel is moved along the hull, as an animation in WebP."""
    model = moldloft.load(EXAMPLES / "sailboat/yacht.sdl")
    middle, half = (LOW + HIGH) / 2, (HIGH - LOW) / 2
    frames = [
        _frame(model, middle - half * math.cos(2 * math.pi * k / FRAMES)) for k in range(FRAMES)
    ]
    out = io.BytesIO()
    frames[0].save(
        out, "WEBP", save_all=True, append_images=frames[1:], duration=INTERVAL, loop=0, quality=72
    )
    return out.getvalue()


def main() -> None:
    """Draws the pictures that are named, or all."""
    named = sys.argv[1:] or [
        *MODELS,
        *PROGRAMS,
        *PLOTS,
        *STUDIES,
        "study-waves",
        "deformation",
        "drag",
    ]
    for name in named:
        if name in MODELS:
            place, size = MODELS[name]
            data = moldloft.load(EXAMPLES / place).picture(*size)
        elif name in PROGRAMS:
            place, file_name = PROGRAMS[name]
            data = moldloft.load(EXAMPLES / place).written[file_name]
        elif name in STUDIES:
            place, values = STUDIES[name]
            data = beside(moldloft.load(EXAMPLES / place), values)
        elif name == "study-waves":
            data = motions()
        elif name == "deformation":
            data = deformed()
        elif name == "drag":
            data = dragged()
        else:
            data = plotted(*PLOTS[name])
        file = IMAGES / f"{name}.{'webp' if name == 'drag' else 'png'}"
        file.write_bytes(data)
        print(f"{file.name}: {len(data) / 1000:.0f} kB")


if __name__ == "__main__":
    main()

"""Draws the gallery and writes its page: `python docs/gallery.py [NAME ...]`."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import moldloft

ROOT = Path(__file__).resolve().parents[1]
MODELS = sorted((ROOT / "examples" / "gallery").glob("*.sdl"))
PICTURES = ROOT / "docs" / "images" / "gallery"

HEAD = """# Gallery

Models to start from, each one file of fewer than 150 lines with parameters and their ranges. Tests check their figures against closed
forms or another calculation (`tests/python/shapes/test_gallery.py`); `docs/gallery.py` generates this page.

```
moldloft view examples/gallery/catamaran.sdl
moldloft build examples/gallery/spar.sdl --set draft=80 --to gdf png -o out
```
"""


def about(path: Path) -> str:
    """The comment at the beginning of a model."""
    found = re.match(r"((?:#.*\n)+)", path.read_text(encoding="utf-8"))
    assert found, f"{path.name} begins with a comment"
    return " ".join(line.lstrip("# ") for line in found[1].splitlines())


def page() -> str:
    """The text of docs/gallery.md."""
    parts = [HEAD]
    for path in MODELS:
        model = moldloft.load(path)
        rows = [
            f"| `{p.name}` | {p.default:g} | {p.low:g} to {p.high:g} |"
            for p in model.params.values()
        ]
        title = path.stem.replace("_", " ").capitalize()
        parts.append(
            f"\n## {title}\n\n{about(path)}\n\n![{title}](images/gallery/{path.stem}.png)\n\n"
            f"[`{path.name}`](../examples/gallery/{path.name})\n\n"
            "| parameter | default | range |\n| --- | --- | --- |\n" + "\n".join(rows) + "\n"
        )
    return "".join(parts)


def whole(path: Path) -> moldloft.Model:
    """The model; with its image in x = 0 where it has one, which pictures do not add themselves."""
    model = moldloft.load(path)
    if "x" not in model.symmetry:
        return model
    facts = [model.facts(name) for name in model.objects]
    surfaces = [f["name"] for f in facts if f["class"] == "surface" and f["shown"]]
    text = "".join(f'MirrSurf {n.replace(".", "_")}_image({n}, "x=0");\n' for n in surfaces)
    other = model.symmetry.replace("x", "")
    stated = f'symmetry = "{model.symmetry}"'
    return moldloft.loads(model.text.replace(stated, f'symmetry = "{other}"') + text)


def main() -> None:
    """Draws the models that are named, or all, and writes the page."""
    PICTURES.mkdir(exist_ok=True)
    for path in MODELS:
        if len(sys.argv) == 1 or path.stem in sys.argv[1:]:
            model = whole(path)
            (PICTURES / f"{path.stem}.png").write_bytes(model.picture(560, 360))
    (ROOT / "docs" / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()

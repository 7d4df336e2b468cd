"""Draws the pictures of the example sketches into ``docs/images``."""

from pathlib import Path

from moldloft import Sketch

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"
VIEWS = {"dam": (-58, 22), "lock_wall": (-58, 20), "bracket": (-50, 28), "shed": (-35, 22)}

for name, (azimuth, elevation) in VIEWS.items():
    s = Sketch.load(HERE / f"{name}.skt")
    s.run("SHOW PLANES")
    s.export(IMAGES / f"sketch-{name}.svg")
    png = s.picture(720, 520, azimuth=azimuth, elevation=elevation)
    (IMAGES / f"sketch-{name}.png").write_bytes(png)
    print(f"{name}: volume {s.volume:.6g}, area {s.area:.6g}")

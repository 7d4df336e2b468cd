"""The engine for pages answers as the one of this process does, to the last bit."""

from __future__ import annotations

import base64
import hashlib
import json
import lzma
import os
import random
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT
from moldloft import _core

NODE = shutil.which("node")
ENGINE = ROOT / "python" / "moldloft" / "workbench" / "wasm" / "engine.wasm.xz"
SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

pytestmark = [
    pytest.mark.skipif(NODE is None, reason="no Node.js here to run the engine for pages"),
    pytest.mark.skipif(
        not ENGINE.exists(),
        reason="the engine for pages is not built: `make engine` needs the target "
        "wasm32-unknown-unknown",
    ),
]

QUICK = ["sailboat/hull.sdl", "sailboat/yacht.sdl", "wingbody/layers.sdl"]
EXAMPLES = sorted(
    p.relative_to(ROOT / "examples").as_posix() for p in ROOT.glob("examples/*/*.sdl")
)

#: What is asked of every model, besides its parameters.
QUESTIONS: list[dict[str, Any]] = [
    {"kind": "open"},
    {"kind": "show", "contours": True},
    {"kind": "watch", "expressions": ["mesh.area", "mesh.volume", "hydrostatics.volume"]},
    {"kind": "words"},
    {"kind": "mesh"},
    {"kind": "hydrostatics"},
    {"kind": "section_areas", "count": 11},
    {"kind": "field", "field": "gaussian_curvature"},
    {"kind": "field", "field": "warp"},
    {"kind": "export", "format": "gdf", "stem": "model"},
    {"kind": "export", "format": "svg", "stem": "model"},
    {"kind": "export", "format": "png", "stem": "model"},
    {"kind": "complete", "offset": 40},
    {"kind": "format"},
]


def _differences(path: Path, requests: list[dict[str, Any]]) -> list[str]:
    """The requests that the engine for pages answers in another way."""
    text = path.read_text(encoding="utf-8")
    session = _core.Session(path.name, text, str(path.parent), [])
    asked = [json.dumps({"id": k, "tab": 1, **r}) for k, r in enumerate(requests)]
    frames = [session.answer(request) for request in asked]
    ours = [f"{hashlib.sha256(frame).hexdigest()} {len(frame)}" for frame in frames]
    files = [
        {"path": p, "from": f, "name": n, "data": base64.b64encode(d).decode()}
        for p, f, n, d in session.files()
    ]
    data = {
        "engine": base64.b64encode(lzma.decompress(ENGINE.read_bytes())).decode(),
        "name": path.name,
        "text": text,
        "files": files,
        "requests": asked,
    }
    script = Path(__file__).with_name("engine_in_node.mjs")
    run = subprocess.run(
        [str(NODE), str(script)], input=json.dumps(data), capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    theirs = run.stdout.split("\n")[:-1]
    return [r for r, a, b in zip(asked, ours, theirs, strict=True) if a != b]


@pytest.mark.parametrize("name", EXAMPLES if SOAK else QUICK)
def test_replies_are_the_same(name: str) -> None:
    path = ROOT / "examples" / name
    drawn = random.Random(name)
    session = _core.Session(path.name, path.read_text(encoding="utf-8"), str(path.parent), [])
    frame = session.answer(json.dumps({"kind": "open"}))
    length = int.from_bytes(frame[8:12], "little")
    params = json.loads(frame[16 : 16 + length])["params"]
    requests = list(QUESTIONS)
    for _ in range(30 if SOAK else 3):
        for p in drawn.sample(params, min(2, len(params))):
            low, high = p["range"] or (p["value"] / 2, p["value"] * 2)
            x = drawn.uniform(low, high)
            requests.append({"kind": "set", "values": {p["name"]: round(x) if p["whole"] else x}})
        if params:
            by = drawn.choice(params)["name"]
            requests.append({"kind": "field", "field": "derivative", "by": by})
        requests.append({"kind": "mesh"})
    requests += [
        {"kind": "commit"},
        {"kind": "measure"},
        {"kind": "text", "text": "AbsPoint A(1, 2"},
    ]
    assert not _differences(path, requests)

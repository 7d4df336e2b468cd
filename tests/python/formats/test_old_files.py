"""Files of earlier versions keep loading with the same figures; newer ones are refused by name.

`MOLDLOFT_RECORD=1 pytest tests/python/formats/test_old_files.py` writes the figures of a new
folder.
"""

from __future__ import annotations

import json
import os
import shutil
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import _core
from moldloft.errors import Error, FileError, ModelError
from moldloft.storage import journal
from moldloft.workbench.draft import Draft

OLD = Path(__file__).parents[2] / "old"
VERSIONS = sorted(p for p in OLD.iterdir() if p.is_dir())


def figures_of_model(path: Path) -> dict[str, Any]:
    m = moldloft.load(path)
    m.check()
    mesh = m.mesh()
    found: dict[str, Any] = {
        "objects": [[name, m[name].kind] for name in m.objects],
        "params": {p.name: [p.value, p.low, p.high] for p in m.params.values()},
        "printed": m.printed,
        "symmetry": m.symmetry,
        "panels": len(mesh.faces),
        "area": mesh.area,
        "centre": np.asarray(mesh.vertices).mean(axis=0).tolist() if len(mesh.vertices) else [],
    }
    for name, value in m.variables.items():
        if isinstance(value, (int, float, np.ndarray)):
            found[f"variable {name}"] = np.asarray(value, dtype=float).tolist()
    return found


def replies(folder: Path) -> list[dict[str, list[str]]]:
    """What the engine answers to the requests of a version: frames, their heads' keys by place."""
    session = _core.Session("hull.sdl", (folder / "program.sdl").read_text(), None, [])
    found = []
    for request in (folder / "requests.jsonl").read_text().splitlines():
        data = session.answer(request)
        magic, version, length, _ = struct.unpack_from("<4sIII", data)
        assert (magic, version) == (b"MLFT", 1)
        head = json.loads(data[16 : 16 + length])
        keys = {"": sorted(head)}
        for key, value in head.items():
            if isinstance(value, list) and value and isinstance(value[0], dict):
                keys[key] = sorted(value[0])
        found.append(keys)
    return found


def figures(folder: Path) -> dict[str, Any]:
    names = ("program.sdl", "hull.ms2", "bracket.skt")
    found: dict[str, Any] = {name: figures_of_model(folder / name) for name in names}
    return {**found, "replies": replies(folder)}


def same(old: Any, new: Any, where: str) -> None:
    """Numbers to 1e-9 of their size, all else exactly; what is new may stand beside it."""
    if isinstance(old, dict):
        for key, value in old.items():
            assert key in new, f"{where}: no {key}"
            same(value, new[key], f"{where}, {key}")
    elif isinstance(old, list):
        assert len(new) == len(old), where
        for k, (a, b) in enumerate(zip(old, new, strict=True)):
            same(a, b, f"{where}[{k}]")
    elif isinstance(old, float):
        assert new == pytest.approx(old, rel=1e-9, abs=1e-9), where
    else:
        assert new == old, where


@pytest.mark.parametrize("folder", VERSIONS, ids=lambda p: f"version {p.name}")
def test_files_of_a_version_load_with_their_figures(folder: Path) -> None:
    path = folder / "figures.json"
    found = json.loads(json.dumps(figures(folder)))
    answered = found.pop("replies")
    if os.environ.get("MOLDLOFT_RECORD") and not path.exists():
        path.write_text(json.dumps({**found, "replies": answered}, indent=1) + "\n")
    old = json.loads(path.read_text())
    for before, now in zip(old.pop("replies"), answered, strict=True):
        for key, names in before.items():
            assert set(names) <= set(now.get(key, [])), f"a reply lost {key or 'a key'}"
    same(old, found, folder.name)


@pytest.mark.parametrize("old", sorted(OLD.glob("*/*.skj")), ids=lambda p: p.stem)
def test_an_old_journal_is_read(old: Path, tmp_path: Path) -> None:
    path = tmp_path / "prompt.skj"
    shutil.copy(old, path)
    left = journal.read(path)
    assert left is not None and left.commands[0] == "SKETCH PLATE" and not left.damaged
    sketch = moldloft.Sketch()
    for command in left.commands:
        sketch.run(command)
    assert [one.commands for one in journal.left_behind([path])] == [left.commands]


@pytest.mark.parametrize("head", ["3", "10", "11"])
def test_a_newer_journal_is_refused_by_name_and_kept(head: str, tmp_path: Path) -> None:
    path = tmp_path / "plate.skt.skj"
    text = f"! moldloft sketch journal {head}\nSKETCH PLATE\n"
    path.write_text(text)
    with pytest.raises(FileError, match=rf"plate\.skt\.skj.*later version.*{head}"):
        journal.read(path)
    assert path.read_text() == text


def test_what_is_no_journal_is_none(tmp_path: Path) -> None:
    path = tmp_path / "x.skj"
    for text in ("", "POINT 1 AT 0 0\n", "! moldloft 1\nA\n"):
        path.write_text(text)
        assert journal.read(path) is None


@pytest.mark.parametrize("folder", VERSIONS, ids=lambda p: f"version {p.name}")
def test_a_draft_of_a_version_is_read(folder: Path, tmp_path: Path) -> None:
    shutil.copy(folder / "model.draft", tmp_path / ".a.sdl.draft")
    draft = Draft(tmp_path / "a.sdl")
    left = draft.left()
    assert left is not None and left["text"] == "AbsPoint P(1, 2, 3);\n"
    draft.keep("new", "1")
    assert draft.left() == {"text": "new", "digest": "1"}
    draft.close(keep=True)
    assert json.loads((tmp_path / ".a.sdl.draft").read_text())["version"] == 1


def test_a_newer_draft_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / ".a.sdl.draft"
    path.write_text('{"version": 2, "text": "x", "digest": "0"}')
    draft = Draft(tmp_path / "a.sdl")
    with pytest.raises(Error, match=r"\.a\.sdl\.draft.*version 2.*reads version 1"):
        draft.left()
    draft.close(keep=True)
    assert path.read_text().startswith('{"version": 2')


@pytest.mark.parametrize("first", ["# moldloft 2", "\ufeff# moldloft 2", "#moldloft  17\r"])
def test_a_program_of_a_newer_language_is_refused_by_its_first_line(
    first: str, tmp_path: Path, cli
) -> None:
    text = f"{first}\nAbsPoint P(1, 2, 3);\n"
    path = tmp_path / "new.sdl"
    path.write_bytes(text.encode())
    refused = r"(?s)written in version \d+ of .* reads version 1\n --> .*new\.sdl:1:1"
    with pytest.raises(ModelError, match=refused):
        moldloft.load(path)
    with pytest.raises(ModelError, match=refused):
        moldloft.loads(text, name="new.sdl")
    for model in (moldloft.load(path, strict=False), moldloft.loads(text, strict=False)):
        assert [d.id for d in model.diagnostics] == ["newer-language"]
    commands = (["check"], ["build", "--to", "stl"], ["eval"], ["fmt", "-w"], ["run"])
    for command in (*commands, ["export", "--html"], ["convert", "--to", "ms2"]):
        words = ["P.x"] if command == ["eval"] else []
        message = cli(*command[:1], "new.sdl", *command[1:], *words, status=1).stderr
        assert "reads version 1" in message and "help: install a newer moldloft" in message
    assert path.read_bytes() == text.encode() and [p.name for p in tmp_path.iterdir()] == [
        "new.sdl"
    ]


@pytest.mark.parametrize(
    "first", ["# moldloft 1", "# Moldloft 2 of my hulls", "# moldloft 1.5", ""]
)
def test_other_first_lines_are_comments(first: str) -> None:
    text = f"{first}\nAbsPoint P(1, 2, 3);\n"
    m = moldloft.loads(text)
    assert m["P"].x == 1 and m.text == text
    # A later line is a comment like others.
    assert moldloft.loads("AbsPoint P(1, 2, 3);\n# moldloft 2\n")["P"].x == 1


def test_the_version_survives_edits_and_the_formatter() -> None:
    from moldloft.language import format_text

    m = moldloft.loads("# moldloft 1\nAbsPoint  P(1, 2, 3);\n")
    m["P"].x = 5
    assert m.text.startswith("# moldloft 1\n")
    assert format_text("a.sdl", m.text.encode()).startswith("# moldloft 1\n")
    assert m.copy().text.startswith("# moldloft 1\n")
    assert moldloft.loads(m.convert("sdl")).text.startswith("# moldloft 1\n")


def test_words_of_a_newer_language_are_refused_by_name() -> None:
    """Of a program that states no version, what this one does not know is named."""
    for text, word in (
        ("HoverSurf s(1, 2);", "HoverSurf"),
        ("AbsPoint P(1, 2, 3, glow = 1);", "glow"),
        ("float x = hover(1);", "hover"),
    ):
        with pytest.raises(moldloft.ModelError, match=rf"unknown.*`{word}`|no argument `{word}`"):
            moldloft.loads(text)

"""Ordinary mistakes, at the command line and in Python, are named with what was meant."""

from __future__ import annotations

import contextlib
import io
import os
import random
import re
import shutil
from pathlib import Path

import pytest

import moldloft
import usage_mistakes as mistakes
from moldloft import kinds as k
from moldloft.builder import Builder
from moldloft.cli import main

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def tree(folder: Path) -> dict[str, bytes | None]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }


@pytest.mark.parametrize("seed", range(20 if SOAK else 1))
def test_a_mistake_at_the_command_line(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    made = 0
    for call in mistakes.command_lines(random.Random(seed), 700):
        made += 1
        for path in list(tmp_path.iterdir()):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        (tmp_path / "folder").mkdir()
        for name, data in {**mistakes.FILES, **call.files}.items():
            (tmp_path / name).write_bytes(data)
        before = tree(tmp_path)
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = main(call.words)
        text = err.getvalue()
        what = f"moldloft {' '.join(call.words)}\n{text}"
        assert status in call.status, what
        assert "Traceback" not in text and "internal fault" not in text, what
        assert call.names in text, f"{call.names} is not named: {what}"
        assert call.meant in text, f"{call.meant} is not suggested: {what}"
        after = {name: data for name, data in tree(tmp_path).items() if name not in call.drawn}
        assert after == before, what
    assert made > 400


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, data in mistakes.FILES.items():
        (tmp_path / name).write_bytes(data)


@pytest.mark.usefixtures("files")
def test_an_argument_of_a_wrong_kind_is_named() -> None:
    """Every wrong value of every argument."""
    count = 0
    for call, right, kinds in mistakes.python_calls():
        call(**right)
        for name, kind in kinds.items():
            for value in mistakes.WRONG[kind]:
                with pytest.raises((moldloft.Error, TypeError)) as raised:
                    call(**{**right, name: value})
                assert re.search(rf"\b{name}\b", str(raised.value)), (call, value, raised.value)
                count += 1
    assert count > 280


@pytest.mark.usefixtures("files")
def test_a_misspelt_argument_is_named_with_the_one_that_was_meant() -> None:
    rng = random.Random(3)
    for call, right, _ in mistakes.python_calls():
        for name in right:
            for _ in range(50 if SOAK else 5):
                wrong = mistakes.misspelt(name, rng)
                if wrong in right:
                    continue
                given = {wrong if key == name else key: value for key, value in right.items()}
                with pytest.raises(TypeError) as raised:
                    call(**given)
                assert wrong in str(raised.value)
                if len(name) > 3:
                    assert f"did you mean `{name}`" in str(raised.value), (call, wrong)


def test_a_misspelt_name_is_answered_with_the_one_that_was_meant() -> None:
    rng = random.Random(4)
    m = moldloft.loads(mistakes.HULL)
    for _ in range(1000 if SOAK else 100):
        name = rng.choice(["beam", "hull", "midship", "transom"])
        wrong = mistakes.misspelt(name, rng)
        for use in (m.__getitem__, m.eval, lambda n: m.set({n: 1}), lambda n: m.jacobian([n])):
            with pytest.raises(moldloft.Error) as raised:
                use(wrong)
            assert wrong in str(raised.value)
            if name == "beam" or use in (m.__getitem__, m.eval):
                assert f"`{name}`" in str(raised.value), (use, wrong, raised.value)
        member = rng.choice(["area", "nearest", "intersect"])
        wrong = mistakes.misspelt(member, rng)
        with pytest.raises(AttributeError, match=f"(did you mean|similar).*{member}"):
            getattr(m["hull"], wrong)
    for _ in range(2000 if SOAK else 200):
        text, name, meant = mistakes.spoilt_text(rng)
        with pytest.raises(moldloft.ModelError) as found:
            moldloft.loads(text)
        assert name in str(found.value) and f"`{meant}`" in str(found.value), (name, found.value)


def test_a_misspelt_kind_and_argument_in_python() -> None:
    rng = random.Random(5)
    for _ in range(500 if SOAK else 60):
        with Builder():
            p, q = k.AbsPoint("p", 0, 0, 0), k.AbsPoint("q", 1, 0, 0)
            kind = rng.choice(["AbsPoint", "BCurve", "CLoftSurf", "RuledSurf", "MirrSurf"])
            wrong = mistakes.misspelt(kind, rng)
            with pytest.raises(AttributeError, match=f"did you mean.*{kind}"):
                getattr(k, wrong)
            argument = rng.choice(["degree", "divisions", "relabel", "colour"])
            wrong = mistakes.misspelt(argument, rng)
            with pytest.raises(TypeError, match=wrong) as raised:
                k.BCurve("c", [p, q], **{wrong: 2})
            assert argument in str(raised.value), wrong

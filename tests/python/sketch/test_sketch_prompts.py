"""Several prompts at once on one file, killed at any moment.

None harms another's journal or the file.

A few rounds here; with MOLDLOFT_SOAK=1 a hundred.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from moldloft import Sketch

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL here")

ROUNDS = 100 if os.environ.get("MOLDLOFT_SOAK") else 3

SLAB = """SKETCH SLAB 2D XZ
POINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29
POLYLINE 1 2 3 4 CLOSE
DIMENSION W X 1 2 = 8; DIMENSION H Z 1 4 = 2
EXTRUDE 5
"""


class Prompt:
    """A prompt that edits a file, and what it has acknowledged."""

    def __init__(self, path: Path, environment: dict[str, str]) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "moldloft", "sketch", path.name, "--edit"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            text=True,
            cwd=path.parent,
        )
        self.said: list[str] = []
        self.volume: float | None = None
        self.saved: list[float] = []
        self.listener = threading.Thread(target=self._listen, daemon=True)
        self.listener.start()

    def _listen(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self.said.append(line.rstrip())

    @property
    def second(self) -> bool:
        """Whether another prompt has the file."""
        return any("is edited by" in line for line in self.said)

    def hears(self, *words: str) -> bool:
        """Whether one line of the standard error has the words, which may be under way."""
        end = time.monotonic() + 20
        while time.monotonic() < end:
            if any(all(w in line for w in words) for line in self.said):
                return True
            time.sleep(0.01)
        return False

    def set(self, height: float) -> bool:
        """Sets the height; whether that was acknowledged."""
        return self.ask(f"SET H {height}\nMEASURE VOLUME\n", 40 * height)

    def ask(self, text: str, volume: float) -> bool:
        assert self.process.stdin is not None and self.process.stdout is not None
        try:
            self.process.stdin.write(text)
            self.process.stdin.flush()
        except BrokenPipeError:
            return False
        while line := self.process.stdout.readline():
            if line.startswith("volume") and abs(float(line.split()[1]) - volume) < 1e-9:
                self.volume = volume
                return True
        return False

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()
        self.listener.join(10)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert stream is not None
            stream.close()


def resumed(environment: dict[str, str], folder: Path, file: str = "") -> float | None:
    """The volume that a prompt resumes and saves; None when there is no unsaved session."""
    done = subprocess.run(
        [sys.executable, "-m", "moldloft", "sketch", *file.split(), "--recover", "--json"],
        input="SAVE resumed.skt",
        capture_output=True,
        text=True,
        env=environment,
        cwd=folder,
        check=False,
    )
    if "no unsaved session" in done.stderr:
        return None
    return json.loads(done.stdout)["objects"][0]["volume"]


@pytest.mark.parametrize("kill", [True, False], ids=["killed", "ended"])
def test_two_prompts_on_one_file(tmp_path, kill):
    environment = {**os.environ, "XDG_STATE_HOME": str(tmp_path / "state"), "PYTHONUNBUFFERED": "1"}
    path = tmp_path / "slab.skt"
    path.write_text(SLAB)
    first = Prompt(path, environment)
    assert first.set(3)
    second = Prompt(path, environment)
    assert second.set(4)
    assert second.hears("is edited by", str(first.process.pid)), second.said
    assert not first.second
    # The second one can neither write the file nor end the journal of the first.
    second.ask("SAVE slab.skt\nMEASURE VOLUME\n", 160)
    assert second.hears("cannot write", "is edited by"), second.said
    assert path.read_text() == SLAB
    assert second.ask("SAVE other.skt\nSET H 5\nMEASURE VOLUME\n", 200)
    assert Sketch.load(tmp_path / "other.skt").volume == pytest.approx(160)
    for prompt in (second, first):
        if kill:
            prompt.kill()
        else:
            prompt.process.communicate("QUIT\n", timeout=60)
    # Each has what it was told last.
    assert resumed(environment, tmp_path, path.name) == pytest.approx(120)
    assert resumed(environment, tmp_path) == pytest.approx(200)
    assert resumed(environment, tmp_path) is None
    assert path.read_text() == SLAB


def test_a_save_past_the_journal_of_another_prompt(tmp_path):
    # The first one is killed; the second one has the file, but not the first one's journal beside
    # it, and its own stays whole when it saves.
    environment = {**os.environ, "XDG_STATE_HOME": str(tmp_path / "state"), "PYTHONUNBUFFERED": "1"}
    path = tmp_path / "slab.skt"
    path.write_text(SLAB)
    first = Prompt(path, environment)
    assert first.set(3)
    first.kill()
    second = Prompt(path, environment)
    assert second.set(4)
    assert second.ask("SAVE slab.skt\nMEASURE VOLUME\n", 160)
    assert Sketch.load(path).volume == pytest.approx(160)
    assert second.set(7)
    second.kill()
    assert resumed(environment, tmp_path) == pytest.approx(280)


def test_prompts_that_begin_at_once_and_are_killed(tmp_path):
    chance = random.Random(20)
    for turn in range(ROUNDS):
        folder = tmp_path / str(turn)
        folder.mkdir()
        environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state")}
        environment["PYTHONUNBUFFERED"] = "1"
        path = folder / "slab.skt"
        path.write_text(SLAB)
        prompts = [Prompt(path, environment) for _ in range(3)]

        def edit(prompt: Prompt, number: int, moment: float, chance: random.Random) -> None:
            end = time.monotonic() + moment
            height = number + 0.5
            while prompt.set(height) and time.monotonic() < end:
                height += 10
                if chance.random() < 0.2:
                    prompt.ask("SAVE slab.skt\nMEASURE VOLUME\n", prompt.volume or 0)
                    prompt.saved.append(prompt.volume or 0)
            prompt.kill()

        threads = [
            threading.Thread(
                target=edit, args=(p, k + 1, chance.uniform(0, 1.5), random.Random(turn * 10 + k))
            )
            for k, p in enumerate(prompts)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        holders = [p for p in prompts if not p.second]
        assert holders, [p.said for p in prompts]
        # The file is as it was, or as a prompt that held it saved it.
        known = [80.0, *(v for p in holders for v in p.saved)]
        assert any(abs(Sketch.load(path).volume - v) < 1e-9 for v in known)
        # What each was told last is resumed or saved, by one journal each.
        found = []
        while (volume := resumed(environment, folder)) is not None:
            found.append(volume)
            assert len(found) < 10
        found.append(resumed(environment, folder, path.name) or 0)
        for prompt in prompts:
            if prompt.volume is None:
                continue
            # At most one more command than was answered was under way.
            wanted = (prompt.volume, prompt.volume + 400)
            kept = [*found, *([] if prompt.second else prompt.saved)]
            assert any(abs(v - w) < 1e-9 for v in kept for w in wanted), (turn, wanted, found)

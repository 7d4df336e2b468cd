"""Walks each tutorial as a reader does who has nothing but the wheel.

For each page a new environment, with what the page says to install and nothing else; its files,
commands and Python in the order of the page. Pages that begin with a clone get the examples of the
source; the one for Rust is walked in the checkout.

Usage::

    python tools/walk_tutorials.py [WHEEL] [PAGE ...]
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "docs" / "tutorial.md", *sorted((ROOT / "docs" / "tutorials").glob("*.md"))]

#: Goes through the steps inside of the environment; what a page's Python names is kept.
_DRIVER = r"""
import json, shlex, subprocess, sys
names = {"__name__": "tutorial"}
for kind, text in json.load(open(sys.argv[1])):
    if kind == "python":
        exec(compile(text, "the page", "exec"), names)
    else:
        subprocess.run(shlex.split(text), check=True, stdout=subprocess.DEVNULL)
"""


def blocks(text: str) -> list[tuple[str, str]]:
    """The fenced blocks of a page, as language and text."""
    return re.findall(r"^```([^\n`]*)\n(.*?)^```$", text, re.M | re.S)


def packages(text: str, wheel: Path) -> list[str]:
    """What the page says to install, with the wheel for the package."""
    found = [str(wheel)]
    for line in re.findall(r"pip install ([^`\n#]+)", text):
        for name in line.replace("'", "").split():
            found.append(re.sub(r"^moldloft", str(wheel), name))
    return found


def steps(page: Path, home: Path) -> list[tuple[str, str]]:
    """Writes the files of a page into a folder; its commands and Python, in order."""
    found: list[tuple[str, str]] = []
    text = page.read_text(encoding="utf-8")
    found_blocks = blocks(text)
    last = max((k for k, (language, _) in enumerate(found_blocks) if language == "sdl"), default=-1)
    for k, (language, body) in enumerate(found_blocks):
        named = re.match(r"# (\S+\.sdl)\n", body)
        if language == "sdl" and named:
            (home / named[1]).write_text(body, encoding="utf-8")
        elif language == "sdl" and k != last:
            # One file grows; the last block of the page is what one may add.
            with (home / "yacht.sdl").open("a", encoding="utf-8") as file:
                file.write(body)
        elif language == "python":
            found.append(("python", body))
        elif language == "":
            for line in body.splitlines():
                command = re.split(r"\s{3,}#?", line)[0].strip()
                if command.startswith(("pip ", "moldloft view ")):
                    continue
                if not command.startswith(("moldloft ", "cargo ", "python ")):
                    raise SystemExit(f"{page.name}: `{line}` is no command that is known here")
                found.append(("command", command.replace(" --open", "")))
    return found


def walk(page: Path, wheel: Path) -> float:
    """Walks a page; the seconds from the first `pip install` to the end."""
    text = page.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "work"
        home.mkdir()
        begun = time.monotonic()
        environment = Path(folder) / "env"
        venv.create(environment, with_pip=True)
        scripts = environment / ("Scripts" if os.name == "nt" else "bin")
        python = scripts / ("python.exe" if os.name == "nt" else "python")
        subprocess.run(
            [python, "-m", "pip", "install", "--quiet", *packages(text, wheel)], check=True
        )
        if "git clone" in text:
            shutil.copytree(ROOT / "examples", home / "examples")
        clean = {**os.environ, "PATH": str(scripts)}
        clean.pop("PYTHONPATH", None)
        wanted = steps(page, home)
        if any(command.startswith("cargo ") for _, command in wanted):
            home, clean["PATH"] = ROOT, os.environ["PATH"]
        (Path(folder) / "steps.json").write_text(json.dumps(wanted), encoding="utf-8")
        words = [python, "-W", "ignore", "-c", _DRIVER, str(Path(folder) / "steps.json")]
        subprocess.run(words, check=True, cwd=home, env=clean)
        return time.monotonic() - begun


def main() -> None:
    """Walks the pages that are named, or all."""
    words = sys.argv[1:]
    wheels = [Path(word) for word in words if word.endswith(".whl")]
    wheels = wheels or sorted((ROOT / "dist").glob("*.whl"), key=lambda path: path.stat().st_mtime)
    if not wheels:
        raise SystemExit("there is no wheel in dist/: `python tools/release.py wheel`")
    names = [word for word in words if not word.endswith(".whl")]
    for page in PAGES:
        if not names or page.stem in names:
            print(
                f"{page.stem}: {walk(page, wheels[-1].resolve()):.0f} s from `pip install` on",
                flush=True,
            )


if __name__ == "__main__":
    main()

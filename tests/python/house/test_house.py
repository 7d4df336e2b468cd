"""Promises about the package itself: versions, start-up, what a wheel holds."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import moldloft
from conftest import ROOT

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def modules(*arguments: str) -> set[str]:
    """The modules that a run of Python imports."""
    command = [sys.executable, "-X", "importtime", *arguments]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    lines = [line for line in run.stderr.splitlines() if line.startswith("import time:")]
    return {line.rpartition("|")[2].strip() for line in lines}


def test_the_version_needs_no_library():
    loaded = modules("-m", "moldloft", "--version") - modules("-c", "pass")
    assert "moldloft" in loaded
    assert not {name.partition(".")[0] for name in loaded} & {"numpy", "typer", "click", "rich"}
    # 35 were counted: an answer at once.
    assert len(loaded) <= 60, sorted(loaded)


def test_the_import_adds_little_to_numpy():
    use = "import numpy; import moldloft; moldloft.load, moldloft.Mesh"
    added = modules("-c", use) - modules("-c", "import numpy")
    # 20 were counted.
    assert len(added) <= 40, sorted(added)


def test_no_extra_is_imported():
    code = "import moldloft, sys; moldloft.load; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout
    modules = {name.partition(".")[0] for name in loaded.split()}
    assert not modules & {"scipy", "matplotlib", "pyvista", "capytaine", "meshio", "OCP", "h5py"}


def test_all_names_are_there():
    for name in moldloft.__all__:
        assert getattr(moldloft, name) is not None
    assert set(moldloft.__all__) <= set(dir(moldloft))


def test_the_oldest_tools_are_stated_alike():
    manifest = (ROOT / ".ci" / "manifest.toml").read_text()
    rust = re.search(r'rust = "([\d.]+)"', manifest)[1]
    python = re.search(r'python = "([\d.]+)"', manifest)[1]
    assert f'rust-version = "{rust}"' in (ROOT / "Cargo.toml").read_text()
    assert f'requires-python = ">={python}"' in (ROOT / "pyproject.toml").read_text()
    for page in ("README.md", "CONTRIBUTING.md", "docs/development.md"):
        assert f"Rust {rust} or newer, Python {python} or newer" in (ROOT / page).read_text(), page
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    versions = [name for name in project["project"]["classifiers"] if "Python :: 3." in name]
    assert versions[0].endswith(f":: {python}")
    compact = python.replace(".", "")
    assert project["tool"]["ruff"]["target-version"] == f"py{compact}"
    assert project["tool"]["mypy"]["python_version"] == python
    assert f"abi3-py{compact}" in (ROOT / "crates" / "py" / "Cargo.toml").read_text()
    assert f"python-abi3 {python}.*" in (ROOT / "conda" / "recipe.yaml").read_text()
    locked = (ROOT / "requirements" / "README.md").read_text()
    assert set(re.findall(r"--python-version (\S+)", locked)) == {python}
    for job in ("ci.yml", "release.yml"):
        text = (ROOT / ".github" / "workflows" / job).read_text()
        assert f'python-version: "{python}"' in text, job


def test_the_readme_s_model_runs(tmp_path: Path, monkeypatch):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```(\w*)\n(.*?)```", readme, re.S)
    (program,) = [text for _, text in blocks if text.startswith("# hull.sdl")]
    (python,) = [text for language, text in blocks if language == "python"]
    (tmp_path / "hull.sdl").write_text(program)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(python, names)
    mesh = names["mesh"]
    assert names["by_beam"].shape == (len(mesh.vertices), 3, 1)
    assert (tmp_path / "hull.gdf").exists()
    assert moldloft.load("hull.sdl").hydrostatics().volume > 0


def test_the_version_is_the_workspace_s():
    version = re.search(r'^version = "([\d.]+)"', (ROOT / "Cargo.toml").read_text(), re.M)[1]
    assert moldloft.__version__ == version
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text()


def test_the_wheel(tmp_path: Path):
    # What is in the wheel does not depend on the profile; that of releases takes minutes.
    profile = "release" if SOAK else "dev"
    build = [sys.executable, "-m", "maturin", "build", "--profile", profile, "--strip", "--quiet"]
    subprocess.run([*build, "--out", str(tmp_path)], cwd=ROOT, check=True, timeout=1200)
    (wheel,) = tmp_path.glob("*.whl")
    # The size that is published; every kind is compiled for plain and dual numbers and their jets.
    stated = re.search(
        r"^\| wheel with page.*? \| ([\d.]+) MB;",
        (ROOT / "docs" / "performance.md").read_text(),
        re.M,
    )
    assert stated
    entries = zipfile.ZipFile(wheel).infolist()
    # Stated without the engine for pages, which is there or not.
    engine = sum(e.compress_size for e in entries if "/wasm/engine.wasm" in e.filename)
    assert not SOAK or wheel.stat().st_size - engine < 1.01e6 * float(stated[1])
    assert "abi3" in wheel.name
    names = {entry.filename for entry in entries}
    assert {"moldloft/py.typed", "moldloft/_core.pyi", "moldloft/cli/build.py"} <= names
    assert any(name.endswith(("LICENSE-MIT", "LICENSE-APACHE")) for name in names)


def test_one_type_for_each_name() -> None:
    """A struct, enum or trait has a name of its own in the whole workspace."""
    declared: dict[str, set[str]] = {}
    for path in sorted((ROOT / "crates").glob("*/src/**/*.rs")):
        text = path.read_text(encoding="utf-8")
        assert re.search(r"^//!", text, re.MULTILINE), (
            f"{path} has no header that says what is in it"
        )
        if path.name == "tests.rs":
            continue
        if path.match("parallel/src/single.rs"):  # the traits of `many.rs`, for pages
            continue
        text = re.split(r"#\[cfg\(test\)\]\s*mod \w+ \{", text)[0]
        for found in re.finditer(
            r"^(?:pub(?:\([^)]*\))? )?(?:struct|enum|trait) (\w+)", text, re.MULTILINE
        ):
            declared.setdefault(found[1], set()).add(str(path.relative_to(ROOT)))
    doubled = {name: sorted(paths) for name, paths in declared.items() if len(paths) > 1}
    assert not doubled


def test_coverage_is_by_crate(tmp_path: Path):
    record = "SF:/a/crates/{}/src/lib.rs\nLF:{}\nLH:{}\nend_of_record\n"
    lines = [("num", 10, 9), ("io", 5, 5), ("io", 5, 2), ("registry-derive", 9, 0)]
    (tmp_path / "lcov.info").write_text("".join(record.format(*line) for line in lines))
    command = [sys.executable, str(ROOT / "tools" / "coverage.py"), str(tmp_path / "lcov.info")]
    low = subprocess.run(command, capture_output=True, text=True)
    assert low.returncode == 1 and low.stderr == "below 80 %: io 70.0 %\n"
    assert "| `num` | 10 | 90.0 % |" in low.stdout
    assert subprocess.run([*command, "--least", "70"], capture_output=True).returncode == 0

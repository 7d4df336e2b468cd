"""What a release is made of agrees: versions, workflows, recipe, citation, extras."""

from __future__ import annotations

import json
import re
import runpy
from importlib.metadata import requires
from pathlib import Path
from typing import Any

import pytest

import moldloft

yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).resolve().parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def read(path: Path) -> Any:
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def test_versions_agree() -> None:
    version = moldloft.__version__
    assert str(read(ROOT / "CITATION.cff")["version"]) == version
    assert read(ROOT / "conda" / "recipe.yaml")["context"]["version"] == version
    editor = json.loads((ROOT / "editors" / "vscode" / "package.json").read_text())
    assert editor["version"] == version
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert runpy.run_path(str(ROOT / "tools" / "release.py"))["version"]() == version


#: What steps of workflows may call: commands of the Makefile and of the release script.
STEPS = re.compile(
    r"make (\w+)$|python tools/release\.py (\w+)$|mkdocs build --strict$|rm -f dist/|"
    r"python -m pip install '[a-z-]+[><=.,0-9]*'$|"
    # What needs another toolchain than the house.
    r"cargo (?:miri|llvm-cov|fuzz) |cargo test -Zbuild-std |for target in "
)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda p: p.stem)
def test_a_workflow_calls_what_there_is(path: Path) -> None:
    flow = read(path)
    # YAML 1.1 reads the key `on` as true.
    assert flow["name"] and (flow.get("on") or flow.get(True))
    assert flow["permissions"]["contents"] == "read"
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    steps_of_release = runpy.run_path(str(ROOT / "tools" / "release.py"))["STEPS"]
    for name, job in flow["jobs"].items():
        assert job["runs-on"], name
        for need in (
            [job.get("needs", [])] if isinstance(job.get("needs"), str) else job.get("needs", [])
        ):
            assert need in flow["jobs"], (name, need)
        for step in job["steps"]:
            assert ("uses" in step) != ("run" in step), (name, step)
            if "uses" in step:
                assert re.fullmatch(r"[\w.-]+/[\w./-]+@[\w./-]+", step["uses"]), step
                continue
            found = STEPS.match(step["run"])
            assert found, (name, step["run"])
            if found[1]:
                assert re.search(rf"^{found[1]}:", makefile, re.M), step
            if found[2]:
                assert found[2] in steps_of_release, step


def test_the_recipe_needs_what_the_package_needs() -> None:
    recipe = read(ROOT / "conda" / "recipe.yaml")
    needs = [line for line in requires("moldloft") or [] if "extra" not in line]
    names = {re.match(r"[\w-]+", need)[0] for need in needs}  # type: ignore[index]
    run = {str(line).split()[0] for line in recipe["requirements"]["run"]}
    assert run == names | {"python"}
    assert recipe["about"]["license"] == "MIT OR Apache-2.0"
    for file in recipe["about"]["license_file"]:
        assert (ROOT / file).is_file()


def test_templates_of_issues_ask_for_something() -> None:
    for path in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"):
        form = read(path)
        assert form["name"] and form["description"]
        assert any(field.get("validations", {}).get("required") for field in form["body"])


#: The module of a package, where its name differs.
MODULES = {
    "cadquery-ocp-novtk": "OCP",
    "prompt-toolkit": "prompt_toolkit",
    "websockets": "websocket",
}


def test_each_extra_is_imported_and_named() -> None:
    extras: dict[str, list[str]] = {}
    for line in requires("moldloft") or []:
        found = re.match(r"([\w-]+).*extra == ['\"](\w+)['\"]", line)
        if found:
            extras.setdefault(found[2], []).append(found[1])
    del extras["test"]
    source = "".join(p.read_text(encoding="utf-8") for p in (ROOT / "python").rglob("*.py"))
    for extra, packages in extras.items():
        for package in packages:
            module = MODULES.get(package, package)
            assert re.search(rf"\b(import|from) {module}|\"{module}", source, re.I), package
        assert f"`{extra}`" in (ROOT / "README.md").read_text(encoding="utf-8"), extra
    tried = runpy.run_path(str(ROOT / "tools" / "release.py"))["_EXTRAS"]
    assert set(tried) | {"view"} == set(extras)


def test_licences_that_may_be_bundled() -> None:
    permitted = runpy.run_path(str(ROOT / "tools" / "release.py"))["permitted"]
    for licence, good in {
        "MIT OR Apache-2.0": True,
        "(MIT OR Apache-2.0) AND Unicode-3.0": True,
        "MPL-2.0": False,
        "GPL-3.0-or-later": False,
        "MIT AND GPL-2.0": False,
        "": False,
    }.items():
        assert permitted(licence) is good, licence

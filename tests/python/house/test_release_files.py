"""What a release is made of agrees: versions, workflows, recipe, citation, extras."""

from __future__ import annotations

import json
import os
import re
import runpy
import shutil
import subprocess
import sys
import tarfile
import zipfile
from importlib.metadata import requires
from pathlib import Path
from typing import Any

import pytest

import moldloft

yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).resolve().parents[3]
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
    r"make (\w+)$|python tools/release\.py (\w+)$|mkdocs build --strict$|rm -f dist/|cp dist/|"
    r"python -m pip install --require-hashes --requirement requirements/\w+\.txt$|"
    r"pip-audit --disable-pip --require-hashes --requirement requirements/test\.txt$|"
    r"npm audit --prefix web --audit-level=high$|"
    # Coverage by crate, speed against kept figures.
    r"python3 tools/coverage\.py |make optimised WEB=$|echo \"name=|"
    r"\.venv/bin/python benches/watched\.py |"
    # What needs another toolchain than the house.
    r"cargo (?:miri|llvm-cov|fuzz|mutants) |cargo test -Zbuild-std |for target in |"
    # Other processors, emulated.
    r"sudo apt-get update && sudo apt-get install -y qemu-user |"
    r"cargo build -p moldloft --example bits|"
    r"(?:qemu-\w+ .*)?target/\S*debug/examples/bits \| diff tests/bits\.txt -$"
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
                # By commit: a tag can be moved to other code.
                assert re.fullmatch(r"[\w.-]+/[\w./-]+@[0-9a-f]{40}", step["uses"]), step
                continue
            found = STEPS.match(step["run"])
            assert found, (name, step["run"])
            if found[1]:
                assert re.search(rf"^{found[1]}:", makefile, re.M), step
            if found[2]:
                assert found[2] in steps_of_release, step


def named(line: str) -> str:
    """The name of a requirement, as registries spell it."""
    return re.sub(r"[-_.]+", "-", re.split(r"[ ;<>=!~\[]", line.strip())[0]).lower()


def test_all_that_the_tests_install_is_locked_with_hashes() -> None:
    """`requirements/README.md` says how the files are made."""
    for path in (ROOT / "requirements").glob("*.txt"):
        for entry in re.split(r"\n(?=\S)", path.read_text(encoding="utf-8").strip()):
            assert re.match(r"[\w.-]+==[\w.]+( ; .*)? \\\n +--hash=sha256:[0-9a-f]{64}", entry), (
                entry
            )
    text = (ROOT / "requirements" / "test.txt").read_text(encoding="utf-8")
    locked = {named(line) for line in text.splitlines() if "==" in line}
    wanted = [
        line
        for line in requires("moldloft") or []
        if re.search(r"extra == ['\"](test|view)['\"]", line)
    ]
    assert wanted and {named(line) for line in wanted} <= locked


def test_a_release_builds_by_the_locked_maturin(monkeypatch: pytest.MonkeyPatch) -> None:
    release = runpy.run_path(str(ROOT / "tools" / "release.py"))
    maturin = release["maturin"]
    commands: list[list[str]] = []
    names = maturin.__globals__
    monkeypatch.setitem(names, "run", lambda *words: commands.append([str(w) for w in words]))
    monkeypatch.setattr(names["importlib"].util, "find_spec", lambda name: None)
    monkeypatch.setattr(names["venv"], "create", lambda *_, **__: None)
    python = maturin()[0]
    locked = str(ROOT / "requirements" / "build.txt")
    command = [python, "-m", "pip", "install", "--quiet", "--require-hashes", "--requirement"]
    assert commands == [[*command, locked]]


def test_docs_name_the_crates_of_the_nightly_checks() -> None:
    jobs = read(ROOT / ".github" / "workflows" / "deep.yml")["jobs"]
    text = (ROOT / "docs" / "soak.md").read_text(encoding="utf-8")
    for job, name in (("miri", "Miri"), ("thread-sanitizer", "ThreadSanitizer")):
        command = next(
            step["run"] for step in jobs[job]["steps"] if "cargo " in step.get("run", "")
        )
        listed = re.search(rf"{name} \((?:tests of )?([^)]*)\)", text)
        assert listed, name
        assert re.findall(r"`(\w+)`", listed[1]) == re.findall(r"-p moldloft-(\w+)", command)
        assert re.search(rf"\| {name}.*, last run on \d+ \w+ 20\d\d: ", text), name


def test_the_recipe_needs_what_the_package_needs() -> None:
    recipe = read(ROOT / "conda" / "recipe.yaml")
    needs = [line for line in requires("moldloft") or [] if "extra" not in line]
    names = {re.match(r"[\w-]+", need)[0] for need in needs}  # type: ignore[index]
    run = {str(line).split()[0] for line in recipe["requirements"]["run"]}
    assert run == names | {"python"}
    assert recipe["about"]["license"] == "MIT OR Apache-2.0"
    *own, notices = recipe["about"]["license_file"]
    assert all((ROOT / file).is_file() for file in own)
    # The last is made by the first line of the script.
    assert notices == "dist/NOTICES.txt" and "release.py papers" in recipe["build"]["script"][0]
    parts = runpy.run_path(str(ROOT / "tools" / "release.py"))["PARTS"]
    assert "papers" in parts


def test_the_recipe_is_rendered() -> None:
    """By rattler-build itself, for each platform that wheels are built for."""
    rattler = pytest.importorskip("rattler_build")
    recipe = rattler.Stage0Recipe.from_file(str(ROOT / "conda" / "recipe.yaml"))
    (variant,) = recipe.render(rattler.VariantConfig())
    found = variant.recipe() if callable(variant.recipe) else variant.recipe
    data = found.to_dict()
    assert data["package"]["version"] == moldloft.__version__
    commands = [line for test in data["tests"] for line in test.get("script", [])]
    assert len(commands) == 3


def test_templates_of_issues_ask_for_something() -> None:
    for path in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"):
        form = read(path)
        assert form["name"] and form["description"]
        assert any(field.get("validations", {}).get("required") for field in form["body"])


#: The module of a package, where its name differs.
MODULES = {
    "cadquery-ocp-novtk": "OCP",
    "dask-jobqueue": "dask_jobqueue",
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
    # The page is used from the wheel itself; Ipopt has no wheel for cyipopt to link with;
    # PyTorch is several gigabytes.
    assert set(tried) | {"view", "ipopt", "torch"} == set(extras)


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


@pytest.fixture(scope="session")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source distribution, unpacked; nothing is compiled for it."""
    pytest.importorskip("maturin")
    folder = tmp_path_factory.mktemp("sdist")
    command = [sys.executable, "-m", "maturin", "sdist", "--out", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    (packed,) = folder.glob("*.tar.gz")
    assert packed.stat().st_size < 15e6
    with tarfile.open(packed) as archive:
        names = archive.getnames()
        archive.extractall(folder, filter="data")
    assert all(name.startswith(f"moldloft-{moldloft.__version__}/") for name in names)
    return folder / f"moldloft-{moldloft.__version__}"


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a checkout")
def test_the_sdist_holds_what_the_repository_holds(sdist: Path) -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True)
    tracked = {name for name in listed.stdout.decode().split("\0") if (ROOT / name).is_file()}
    packed = {p.relative_to(sdist).as_posix() for p in sdist.rglob("*") if p.is_file()}
    # The manifests are written anew, with the paths of the archive.
    assert tracked - packed <= {".gitignore", "benches/fidget/Cargo.lock"}
    extra = {name for name in packed - tracked if name != "PKG-INFO"}
    # What is not committed yet is no fault of the list; what is ignored is.
    ignored = subprocess.run(
        ["git", "check-ignore", "--stdin"],
        cwd=ROOT,
        input="\n".join(extra),
        capture_output=True,
        text=True,
    )
    assert not ignored.stdout.split(), ignored.stdout
    assert not [n for n in packed if re.search(r"node_modules|(^|/)target/|\.(so|pyd|pyc)$", n)]


def test_the_sdist_can_be_built(sdist: Path, tmp_path: Path) -> None:
    """All that a build reads is there: the workspace resolves as locked, the metadata are made."""
    command = ["cargo", "metadata", "--locked", "--offline", "--format-version", "1"]
    done = subprocess.run(command, cwd=sdist, capture_output=True, text=True)
    if "offline" in done.stderr:
        pytest.skip("the crates are not all on this machine")
    assert done.returncode == 0, done.stderr[-2000:]
    members = {p["name"] for p in json.loads(done.stdout)["packages"] if p["source"] is None}
    assert {"moldloft", "moldloft-py", "moldloft-lsp", "moldloft-wasm", "moldloft-capi"} <= members
    command = [sys.executable, "-m", "maturin", "pep517", "write-dist-info"]
    command += ["--metadata-directory", str(tmp_path), "--interpreter", sys.executable]
    done = subprocess.run(command, cwd=sdist, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    (metadata,) = tmp_path.glob("*.dist-info/METADATA")
    text = metadata.read_text(encoding="utf-8")
    for line in (f"Version: {moldloft.__version__}", "Requires-Dist: numpy>=1.26"):
        assert line in text
    assert {p.name for p in metadata.parent.rglob("LICENSE*")} == {"LICENSE-MIT", "LICENSE-APACHE"}


def test_programs_and_tests_of_the_sdist_run(sdist: Path, tmp_path: Path) -> None:
    model = moldloft.load(sdist / "examples" / "sailboat" / "hull.sdl")
    assert model.hydrostatics().volume > 0
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    command += ["tests/python/formats/test_old_files.py", "tests/python/house/test_circles.py"]
    done = subprocess.run(command, cwd=sdist, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:]


def locked_crates() -> dict[str, set[str]]:
    """Versions by name, as Cargo.lock states them, of the crates of others."""
    found: dict[str, set[str]] = {}
    for block in (ROOT / "Cargo.lock").read_text(encoding="utf-8").split("[[package]]")[1:]:
        if "source = " in block:
            name, version = re.findall(r'^(?:name|version) = "([^"]*)"', block, re.M)
            found.setdefault(name, set()).add(version)
    return found


@pytest.fixture(scope="session")
def rows() -> list[dict[str, Any]]:
    release = runpy.run_path(str(ROOT / "tools" / "release.py"))
    try:
        found: list[dict[str, Any]] = release["bundled"]()
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("cargo is not there, or not all crates are on this machine")
    return found


def test_notices_and_bill_are_those_of_the_lock_files(rows: list[dict[str, Any]]) -> None:
    release = runpy.run_path(str(ROOT / "tools" / "release.py"))
    crates = locked_crates()
    bill = release["bill"](rows, moldloft.__version__)
    text = release["notices"](rows)
    web = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    packages = {
        (place.rsplit("node_modules/", 1)[1], facts["version"])
        for place, facts in web["packages"].items()
        if place and not facts.get("dev") and not facts.get("link")
    }
    seen: dict[str, set[tuple[str, str]]] = {"cargo": set(), "npm": set()}
    for part in bill["components"]:
        kind = part["purl"].split("/")[0].removeprefix("pkg:")
        seen[kind].add((part["name"], part["version"]))
        assert f"{part['name']} {part['version']} ({kind})" in text
        assert release["permitted"](part["licenses"][0]["expression"]), part
    assert seen["npm"] == packages
    assert all(version in crates[name] for name, version in seen["cargo"])
    # What the two programs name themselves is in it.
    for crate in ("py", "lsp"):
        manifest = (ROOT / "crates" / crate / "Cargo.toml").read_text(encoding="utf-8")
        section = re.search(r"^\[dependencies\]\n(.*?)(?:^\[|\Z)", manifest, re.M | re.S)
        names = set(re.findall(r"^([\w-]+)", section[1], re.M)) & set(crates)
        assert names <= {name for name, _ in seen["cargo"]}, (crate, names)


def test_what_is_only_for_tests_is_not_in_the_bill(rows: list[dict[str, Any]]) -> None:
    names = {row["name"] for row in rows}
    assert not names & {"proptest", "criterion", "insta", "vite", "typescript", "esbuild"}


def test_the_citation_is_one() -> None:
    cite = read(ROOT / "CITATION.cff")
    for key in ("cff-version", "message", "title", "authors", "license", "repository-code", "type"):
        assert cite[key], key
    assert cite["license"] in ("MIT", "Apache-2.0") or set(cite["license"]) == {"MIT", "Apache-2.0"}
    repository = re.search(r'^repository = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)
    assert cite["repository-code"] == repository[1]
    dates = re.findall(r"\d{4}-\d\d-\d\d", str(cite.get("date-released", "")))
    assert len(dates) <= 1


def test_the_recipe_is_of_the_schema() -> None:
    """The keys of a recipe (conda-forge, CEP 13 and 14), and templates that can be filled."""
    recipe = read(ROOT / "conda" / "recipe.yaml")
    top = {"context", "package", "source", "build", "requirements", "tests", "about", "extra"}
    assert set(recipe) <= top and {"package", "source", "build", "about"} <= set(recipe)
    assert set(recipe["requirements"]) <= {"build", "host", "run", "run_constraints"}
    assert set(recipe["about"]) <= {
        *("homepage", "summary", "description", "license", "license_file"),
        *("license_family", "repository", "documentation"),
    }
    assert {"build", "host", "run"} <= set(recipe["requirements"])
    text = (ROOT / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    for used in re.findall(r"\$\{\{ (\w+) \}\}", text):
        assert used in {*recipe["context"], "PYTHON"}, used
    points = recipe["build"]["python"]["entry_points"]
    pyproject = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for point in points:
        name, target = (part.strip() for part in point.split("="))
        assert f'{name} = "{target}"' in pyproject
    host = {str(line).split()[0] for line in recipe["requirements"]["host"]}
    built = re.search(r'requires = \["(maturin)', pyproject)
    assert built and built[1] in host


@pytest.mark.parametrize("extra", ["plot", "prompt", "notebook", "study", "hydro", "cad"])
def test_the_smoke_test_of_an_extra_runs(
    extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cli
) -> None:
    """What the release tries in an environment of its own, here in that of the tests."""
    use = runpy.run_path(str(ROOT / "tools" / "release.py"))["_EXTRAS"][extra]
    monkeypatch.chdir(tmp_path)
    cli("new", "boat")
    names: dict[str, Any] = {"m": moldloft.load("boat.sdl")}
    exec(use, names)


def test_what_needs_an_extra_names_it(tmp_path: Path) -> None:
    """Without its packages each extra's use is refused by the extra's name."""
    uses = {
        "plot": "m.hydrostatic_table([0.1, 0.2]).plot('t.png')",
        "study": "from moldloft.study import component; component(m, ['beam'], ['mesh.area'])",
        "hydro": "m.to_capytaine()",
        "cad": "m.write('boat.dxf'); m.write('boat.3dm')",
        "view": "import sys; from moldloft.cli import main; "
        "sys.exit(main(['view', 'boat.sdl', '--no-browser']))",
    }
    hidden = [
        "matplotlib",
        "reportlab",
        "h5py",
        "openmdao",
        "capytaine",
        "ezdxf",
        "rhino3dm",
        "websockets",
    ]
    for extra, use in uses.items():
        lines = ["import sys", *(f"sys.modules[{name!r}] = None" for name in hidden)]
        lines += ["import moldloft", "from moldloft.starter import BOX"]
        lines += ["text = 'param float beam = 4 in [3, 5]; ' + BOX"]
        lines += ["open('boat.sdl', 'w').write(text); m = moldloft.load('boat.sdl')", use]
        command = [sys.executable, "-c", "\n".join(lines)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert done.returncode != 0, (extra, done.stdout)
        assert f"moldloft[{extra}]" in done.stderr, (extra, done.stderr[-600:])


def test_each_target_of_fuzzing_has_a_corpus() -> None:
    """As `tools/fuzz.py` and the configuration for OSS-Fuzz take it."""
    fuzz = ROOT / "fuzz"
    targets = {path.stem for path in (fuzz / "fuzz_targets").glob("*.rs")}
    assert targets == {path.name for path in (fuzz / "corpus").iterdir()}
    assert targets == set(runpy.run_path(str(ROOT / "tools" / "fuzz.py"))["SEEDS"])
    for path in (fuzz / "corpus").rglob("*"):
        assert path.is_dir() or 0 < path.stat().st_size < 4096, path


@pytest.mark.skipif(not shutil.which("zip"), reason="the program zip is not installed")
def test_the_configuration_for_oss_fuzz_packs_corpora_and_dictionaries(tmp_path: Path) -> None:
    """Its script as it is, with stand-ins for the compiled targets."""
    out, commands, copy = tmp_path / "out", tmp_path / "bin", tmp_path / "moldloft"
    for folder in (out, commands):
        folder.mkdir()
    names = ("examples", "fuzz", "python/moldloft/kinds.pyi", "python/moldloft/functions.pyi")
    for name in (*names, "tests/corpus"):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).symlink_to(ROOT / name)
    (copy / "fuzz").unlink()
    shutil.copytree(ROOT / "fuzz", copy / "fuzz", ignore=shutil.ignore_patterns("target"))
    built = copy / "fuzz" / "target" / "x86_64-unknown-linux-gnu" / "release"
    built.mkdir(parents=True)
    targets = [path.stem for path in (ROOT / "fuzz" / "fuzz_targets").glob("*.rs")]
    for name in targets:
        (built / name).touch()
    (commands / "cargo").write_text("#!/bin/sh\n")
    (commands / "cargo").chmod(0o755)
    environment = {**os.environ, "PATH": f"{commands}:{os.environ['PATH']}"}
    environment |= {"SRC": str(tmp_path), "OUT": str(out)}
    subprocess.run(["bash", ROOT / "fuzz" / "oss-fuzz" / "build.sh"], env=environment, check=True)
    for name in targets:
        with zipfile.ZipFile(out / f"{name}_seed_corpus.zip") as packed:
            assert packed.namelist()
    assert len((out / "document.dict").read_text(encoding="utf-8").splitlines()) > 300

"""Builds what is released: ``python tools/release.py [STEP ...]``, by default all of them in turn.

``engine`` the engine for pages that compute by themselves (if the target for WebAssembly is there)
``wheel``  the page (if npm is there), and the wheel with engine, page and language server inside
``editor`` the extension for Visual Studio Code of this platform, with the language server inside
``sdist``  the source distribution, the notices of bundled software and the bill of materials
``papers`` the notices and the bill of materials alone, as packages for conda need them
``smoke``  installs the wheel into an empty environment (no Rust, Node.js or make on the path) and
           uses it: command, workbench, language server, display in notebooks, each extra
``tutorials`` walks each tutorial in an environment of its own with the wheel

``MOLDLOFT_PROFILE=dev`` tries the steps with development builds, which take minutes less.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import urllib.request
import venv
import zipfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
WINDOWS = platform.system() == "Windows"
EXE = ".exe" if WINDOWS else ""
WASM = "wasm32-unknown-unknown"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROFILE = os.environ.get("MOLDLOFT_PROFILE", "release")


def run(*command: str | Path, **options: Any) -> None:
    """Runs a command and ends with its message when it fails."""
    words = [str(word) for word in command]
    print("+", " ".join(words), flush=True)
    subprocess.run(words, check=True, cwd=options.pop("cwd", ROOT), **options)


def output(*command: str) -> str:
    """What a command prints."""
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout


def metadata() -> dict[str, Any]:
    """The Rust packages that the extension and the server are built of."""
    data: dict[str, Any] = json.loads(
        output("cargo", "metadata", "--format-version=1", "--locked", "--all-features")
    )
    return data


def bundled() -> list[dict[str, Any]]:
    """What the wheel holds of others: crates, and packages of the page."""
    data = metadata()
    by_id = {package["id"]: package for package in data["packages"]}
    nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
    roots = [p["id"] for p in data["packages"] if p["name"] in ("moldloft-py", "moldloft-lsp")]
    seen: set[str] = set()
    left = list(roots)
    while left:
        one = left.pop()
        if one in seen:
            continue
        seen.add(one)
        # Dependencies of tests and build scripts are in no binary.
        left += [
            dep["pkg"]
            for dep in nodes[one]["deps"]
            if any(kind["kind"] is None for kind in dep["dep_kinds"])
        ]
    rows = []
    for one in seen:
        package = by_id[one]
        if package["source"] is None:
            continue
        folder = Path(package["manifest_path"]).parent
        rows.append(
            {
                "type": "cargo",
                "name": package["name"],
                "version": package["version"],
                "licence": (package["license"] or "").replace("/", " OR "),
                "texts": sorted(
                    p for p in folder.iterdir() if p.name.lower().startswith(("licen", "copying"))
                ),
            }
        )
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    for place, facts in lock["packages"].items():
        if not place or facts.get("dev") or facts.get("link"):
            continue
        name = place.rsplit("node_modules/", 1)[1]
        folder = ROOT / "web" / place
        files = sorted(folder.iterdir()) if folder.is_dir() else []
        rows.append(
            {
                "type": "npm",
                "name": name,
                "version": facts["version"],
                "licence": facts.get("license", ""),
                "texts": [p for p in files if p.name.lower().startswith(("licen", "copying"))],
            }
        )
    return sorted(rows, key=lambda row: (row["type"], row["name"], row["version"]))


#: Licences that may be in what is released.
PERMISSIVE = {
    *("MIT", "MIT-0", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause"),
    *("BSD-3-Clause", "ISC", "Zlib", "0BSD", "Unlicense", "Unicode-3.0", "CC0-1.0", "BSL-1.0"),
}


def permitted(licence: str) -> bool:
    """Whether one of the alternatives of a licence expression is permissive in all its parts.

    >>> permitted("MIT OR GPL-3.0"), permitted("(MIT OR Apache-2.0) AND Unicode-3.0")
    (True, True)
    >>> permitted("GPL-3.0"), permitted("")
    (False, False)
    """
    return all(
        any(word.strip(" ()") in PERMISSIVE for word in part.split(" OR "))
        for part in licence.split(" AND ")
    )


def notices(rows: list[dict[str, Any]]) -> str:
    """The licences of all bundled software, each text once."""
    texts: dict[str, list[str]] = {}
    lines = ["Moldloft contains software of others, under these licences.", ""]
    for row in rows:
        if not permitted(row["licence"]):
            raise SystemExit(f"{row['name']}: the licence `{row['licence']}` is not permissive")
        title = f"{row['name']} {row['version']}"
        lines.append(f"{title} ({row['type']}): {row['licence']}")
        for path in row["texts"]:
            if path.is_file():
                text = path.read_text(encoding="utf-8", errors="replace").strip()
                texts.setdefault(text, []).append(title)
    for text, titles in texts.items():
        lines += ["", "=" * 80, ", ".join(dict.fromkeys(titles)), "-" * 80, text]
    return "\n".join(lines) + "\n"


def bill(rows: list[dict[str, Any]], version: str) -> dict[str, Any]:
    """The bill of materials, CycloneDX 1.5."""
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {"type": "application", "name": "moldloft", "version": version}},
        "components": [
            {
                "type": "library",
                "name": row["name"],
                "version": row["version"],
                "purl": f"pkg:{row['type']}/{row['name'].replace('@', '%40')}@{row['version']}",
                "licenses": [{"expression": row["licence"]}],
            }
            for row in rows
        ],
    }


def version() -> str:
    """The version of the workspace."""
    for line in (ROOT / "Cargo.toml").read_text(encoding="utf-8").splitlines():
        if line.startswith("version"):
            return line.split('"')[1]
    raise SystemExit("Cargo.toml states no version")


def write_papers() -> list[dict[str, Any]]:
    """The notices and the bill of materials, beside what is released."""
    DIST.mkdir(exist_ok=True)
    rows = bundled()
    (DIST / "NOTICES.txt").write_text(notices(rows), encoding="utf-8")
    path = DIST / f"moldloft-{version()}.cdx.json"
    path.write_text(json.dumps(bill(rows, version()), indent=1), encoding="utf-8")
    print(f"{len(rows)} bundled packages: {DIST / 'NOTICES.txt'}, {path}")
    return rows


def maturin() -> list[str]:
    """The command of maturin: of this Python, or of an environment made for it.

    Nothing is installed into a Python of the user's.
    """
    if importlib.util.find_spec("maturin"):
        return [sys.executable, "-m", "maturin"]
    tools = TARGET / "release-tools"
    python = tools / ("Scripts" if WINDOWS else "bin") / f"python{EXE}"
    if not python.is_file():
        venv.create(tools, with_pip=True)
    locked = ROOT / "requirements" / "build.txt"
    run(python, "-m", "pip", "install", "--quiet", "--require-hashes", "--requirement", locked)
    return [str(python), "-m", "maturin"]


def engine() -> None:
    """The engine inside of pages, where it can be built."""
    libraries = Path(output("rustc", "--print", "sysroot").strip()) / "lib" / "rustlib" / WASM
    if not libraries.is_dir():
        print(f"{WASM} is not there: pages of `moldloft export --html` will show and not compute")
        return
    run(
        "cargo", "build", "--profile", "engine", "--locked", "--target", WASM, "-p", "moldloft-wasm"
    )
    built = TARGET / WASM / "engine" / "moldloft_engine.wasm"
    path = ROOT / "python" / "moldloft" / "workbench" / "wasm" / "engine.wasm.xz"
    run(sys.executable, str(ROOT / "tools" / "pack_engine.py"), str(built), str(path))


def server() -> Path:
    """The language server, built."""
    run("cargo", "build", "--profile", PROFILE, "--locked", "-p", "moldloft-lsp")
    return TARGET / ("debug" if PROFILE == "dev" else PROFILE) / f"moldloft-lsp{EXE}"


def page(npm: str) -> None:
    """The page of the workbench, built."""
    web = ROOT / "web"
    run(npm, "ci", "--no-audit", "--no-fund", "--loglevel=error", cwd=web)
    run(npm, "run", "--silent", "build", cwd=web)


def wheel() -> None:
    """The wheel with page, engine and notices; the extension is the language server as well."""
    npm = shutil.which("npm")
    if npm:
        page(npm)
    else:
        print("npm is not there: the wheel will have no workbench page")
    inside = ROOT / "python" / "moldloft" / "NOTICES.txt"
    write_papers()
    try:
        shutil.copy2(DIST / "NOTICES.txt", inside)
        run(*maturin(), "build", "--profile", PROFILE, "--locked", "--out", DIST)
    finally:
        inside.unlink()
    for path in sorted(DIST.glob("*.whl")):
        print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB")


#: Names of platforms in Visual Studio Code, by those of Python.
_EDITORS = {
    ("Linux", "x86_64"): "linux-x64",
    ("Linux", "aarch64"): "linux-arm64",
    ("Darwin", "x86_64"): "darwin-x64",
    ("Darwin", "arm64"): "darwin-arm64",
    ("Windows", "AMD64"): "win32-x64",
}


def editor() -> None:
    """The extension for Visual Studio Code, with the language server of this platform inside."""
    npm = shutil.which("npm")
    if npm is None:
        print("npm is not there: no extension for Visual Studio Code")
        return
    target = _EDITORS[platform.system(), platform.machine()]
    folder = ROOT / "editors" / "vscode"
    inside = folder / "server"
    inside.mkdir(exist_ok=True)
    DIST.mkdir(exist_ok=True)
    path = DIST / f"moldloft-{version()}-{target}.vsix"
    try:
        shutil.copy2(server(), inside)
        workbench = ROOT / "python" / "moldloft" / "workbench"
        if not (workbench / "page" / "index.html").exists():
            page(npm)
        shutil.copytree(workbench / "page", folder / "page", dirs_exist_ok=True)
        for packed in (workbench / "wasm").glob("engine.wasm.*"):
            shutil.copy2(packed, folder / "page")
        for name in ("LICENSE-MIT", "LICENSE-APACHE", "CHANGELOG.md"):
            shutil.copy2(ROOT / name, folder)
        run(npm, "install", "--no-audit", "--no-fund", "--loglevel=error", cwd=folder)
        options = ["--no-install", "vsce", "package", "--skip-license", "--target", target]
        run(shutil.which("npx") or "npx", *options, "-o", path, cwd=folder)
    finally:
        shutil.rmtree(inside)
        shutil.rmtree(folder / "page", ignore_errors=True)
        for name in ("LICENSE-MIT", "LICENSE-APACHE", "CHANGELOG.md"):
            (folder / name).unlink(missing_ok=True)
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
    for wanted in (
        f"extension/server/moldloft-lsp{EXE}",
        "extension/src/extension.js",
        "extension/src/view.js",
        "extension/page/index.html",
    ):
        if wanted not in names:
            raise SystemExit(f"{path.name} lacks {wanted}")
    print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB")


def sdist() -> None:
    """The source distribution, which builds, and holds documents, examples and tests."""
    write_papers()
    run(*maturin(), "sdist", "--out", DIST)
    for path in sorted(DIST.glob("*.tar.gz")):
        with tarfile.open(path) as archive:
            names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
        wanted = ("docs/tutorial.md", "examples/sailboat/hull.sdl", "CHANGELOG.md", "README.md")
        wanted += (
            "tests/python/shapes/test_api.py",
            "crates/py/Cargo.toml",
            "LICENSE-MIT",
            "Cargo.lock",
        )
        wanted += ("LICENSE-MIT", "Cargo.lock")
        missing = [name for name in wanted if name not in names]
        if missing:
            raise SystemExit(f"{path.name} lacks {', '.join(missing)}")
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB, sha256 {digest}")


_USE = """
import moldloft
m = moldloft.loads(open("boat.sdl").read())
assert m.hydrostatics().volume > 0
assert "<table" in m._repr_html_()
assert "data:image/png;base64," in m._repr_html_()
import pickle
assert pickle.loads(pickle.dumps(m)).keys() == m.keys()
print("python:", m)
"""

#: What each extra is for, tried in an environment of its own.
_EXTRAS = {
    "plot": "m.hydrostatic_table([0.2, 0.3, 0.4]).plot('table.png')",
    "prompt": "import moldloft.cli.editor, prompt_toolkit",
    "notebook": "from moldloft.workbench.page import engine_packed; import anywidget; "
    "assert engine_packed() is None or m.view().text == m.text",
    "study": "from moldloft.study import component; "
    "component(m, ['beam'], ['hydrostatics.volume'])",
    "optimizers": "import optuna, pymoo, moldloft.study.optimizers",
    "tables": "import pandas, pyarrow, moldloft.study",
    "cluster": "import distributed, moldloft.study.cluster",
    "jobqueue": "import dask_jobqueue; from moldloft.study.cluster import QUEUES; "
    "assert all(hasattr(dask_jobqueue, name) for name in QUEUES.values())",
    "jax": "import jax; jax.config.update('jax_enable_x64', True); "
    "from moldloft.study import function, jax_function; "
    "assert jax_function(function(m, ['beam'], ['hydrostatics.volume']))([1.0]).size == 1",
    "hydro": "assert m.to_capytaine().mesh.nb_faces > 0",
    "cad": "m.write('boat.3dm'); m.write('boat.dxf'); assert not m.to_ocp().IsNull()",
}


def smoke() -> None:
    """Uses the wheel where there is nothing else."""
    wheels = sorted(DIST.glob("*.whl"))
    if not wheels:
        raise SystemExit("there is no wheel in dist/: `python tools/release.py wheel`")
    newest = max(wheels, key=lambda path: path.stat().st_mtime)
    with zipfile.ZipFile(newest) as archive:
        names = archive.namelist()
    if "moldloft/NOTICES.txt" not in names:
        raise SystemExit(f"{newest.name} lacks the notices of what is bundled")
    page = "moldloft/workbench/page/index.html" in names
    print(f"{newest.name}: workbench page {'inside' if page else 'not inside'}")
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        venv.create(home / "env", with_pip=True)
        scripts = home / "env" / ("Scripts" if WINDOWS else "bin")
        python = scripts / f"python{EXE}"
        run(python, "-m", "pip", "install", "--quiet", newest)
        # Nothing but the environment: compilers, Node.js and make are not found.
        clean = {**os.environ, "PATH": str(scripts)}
        for tool in ("cargo", "rustc", "node", "npm", "make", "cc"):
            if shutil.which(tool, path=clean["PATH"]):
                raise SystemExit(f"{tool} is on the path: this is no empty environment")
        clean.pop("PYTHONPATH", None)
        command = scripts / f"moldloft{EXE}"
        run(command, "--version", cwd=home, env=clean)
        run(command, "new", "boat", cwd=home, env=clean)
        run(command, "build", "boat.sdl", "--to", "gdf", "stl", "step", "png", cwd=home, env=clean)
        for words in ([command, "lsp"], [scripts / f"moldloft-lsp{EXE}"]):
            _server_answers(words, home, clean)
        run(python, "-c", _USE, cwd=home, env=clean)
        run(python, "-m", "pip", "install", "--quiet", f"{newest}[view]")
        _workbench_answers(command, home, clean, page)
        size = sum(
            path.stat().st_size
            for path in (home / "env").rglob("*")
            if path.is_file() and "moldloft" in path.parts
        )
        print(f"installed: {size / 1e6:.1f} MB, without NumPy")
        for extra, use in _EXTRAS.items():
            place = home / extra
            venv.create(place, with_pip=True)
            python = place / scripts.name / f"python{EXE}"
            run(python, "-m", "pip", "install", "--quiet", f"{newest}[{extra}]")
            code = f"import moldloft; m = moldloft.load('boat.sdl'); {use}"
            run(python, "-W", "ignore", "-c", code, cwd=home, env=clean)
            print(f"extra {extra}: used")
            shutil.rmtree(place)


def _workbench_answers(command: Path, home: Path, clean: dict[str, str], page: bool) -> None:
    """Starts the workbench without a browser and reads its page."""
    words = [str(command), "view", "boat.sdl", "--no-browser"]
    process = subprocess.Popen(
        words, cwd=home, env=clean, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        assert process.stdout is not None
        text = ""
        found = None
        while found is None:
            line = process.stdout.readline()
            text += line
            found = re.search(r"http://[^\s#]+", text)
            if not line:
                break
        if found is None:
            if page:
                raise SystemExit(f"the workbench names no address: {text}")
            print("workbench: says that its page is not there")
            return
        with urllib.request.urlopen(found[0], timeout=30) as answer:
            if b"<script" not in answer.read():
                raise SystemExit("the workbench sends no page")
        print("workbench: sends its page")
    finally:
        process.terminate()
        process.wait(30)


def _server_answers(words: list[str | Path], home: Path, clean: dict[str, str]) -> None:
    """Asks the language server to begin and to end."""
    messages = [
        {"id": 1, "method": "initialize", "params": {"capabilities": {}}},
        {"method": "initialized", "params": {}},
        {"id": 2, "method": "shutdown"},
        {"method": "exit"},
    ]
    data = b""
    for message in messages:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        data += b"Content-Length: %d\r\n\r\n%s" % (len(body), body)
    done = subprocess.run(
        [str(word) for word in words],
        input=data,
        capture_output=True,
        cwd=home,
        env=clean,
        timeout=60,
    )
    if b'"capabilities"' not in done.stdout:
        raise SystemExit(f"the language server does not answer: {done.stderr.decode()}")
    print("language server: answers")


def tutorials() -> None:
    """Each tutorial by its own words, in an environment of its own with the wheel."""
    run(sys.executable, str(ROOT / "tools" / "walk_tutorials.py"))


STEPS = {
    "engine": engine,
    "wheel": wheel,
    "editor": editor,
    "sdist": sdist,
    "smoke": smoke,
    "tutorials": tutorials,
}

#: Steps that are parts of others, for those who build by other means.
PARTS = {"papers": write_papers}


def main() -> None:
    """Runs the steps that are named, or all."""
    wanted = sys.argv[1:] or list(STEPS)
    for name in wanted:
        if name not in {**STEPS, **PARTS}:
            raise SystemExit(__doc__)
    print(f"{platform.platform()}, Python {sysconfig.get_python_version()}")
    for name in wanted:
        {**STEPS, **PARTS}[name]()


if __name__ == "__main__":
    main()

"""One table of formats, and nobody beside it; the command uses the public interface alone."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import moldloft
from moldloft import formats
from moldloft.cli import main
from moldloft.exchange import files

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "python" / "moldloft"
TESTS = r"#\[cfg\(test\)\](?:.|\n)*|>>> .*"
SHIP = """
Model info(symmetry = "y", units = "m");
AbsPoint A(0, 1, 0); AbsPoint B(0, 1, -1); AbsPoint C(4, 1, 0); AbsPoint D(4, 1, -1);
Line a(A, B); Line b(C, D); RuledSurf side(a, b, divisions = {2, 3});
"""

#: The rest of its skin below the water.
ENDS = """
AbsPoint E(0, 0, 0); AbsPoint F(0, 0, -1); AbsPoint G(4, 0, 0); AbsPoint H(4, 0, -1);
Line e(E, F); Line g(G, H); Line bd(B, D); Line fh(F, H);
RuledSurf stem(e, a, divisions = {2, 2}); RuledSurf stern(b, g, divisions = {2, 2});
RuledSurf bottom(bd, fh, divisions = {3, 2});
"""


def rust_rows() -> list[formats.Format]:
    return [row for row in formats.formats().values() if not row.writer]


def test_a_longer_ending_names_its_format(tmp_path: Path) -> None:
    model = moldloft.loads(SHIP + ENDS)
    model.write(tmp_path / "ship.high.gdf")
    model.write(tmp_path / "other.gdf", format="gdf-high")
    (long, other) = ((tmp_path / name).read_bytes() for name in ("ship.high.gdf", "other.gdf"))
    assert long.splitlines()[1:] == other.splitlines()[1:]
    model.write(tmp_path / "ship.gdf")
    assert (tmp_path / "ship.gdf").read_bytes().splitlines()[1:] != long.splitlines()[1:]


def test_the_docs_have_the_table() -> None:
    page = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
    assert formats.markdown() in page, "write it anew: python -m moldloft.formats"


def test_a_row_is_a_module_and_one_line() -> None:
    folder = ROOT / "crates" / "export" / "src" / "formats"
    modules = {path.stem: path.read_text(encoding="utf-8") for path in folder.glob("*.rs")}
    table = modules.pop("mod")
    assert len(modules) == len(rust_rows())
    for module, text in modules.items():
        (name,) = re.findall(r'name: "([^"]+)"', text)
        assert name in formats.formats()
        assert table.count(f"\nmod {module};") == table.count(f" {module}::FORMAT,") == 1


@pytest.mark.parametrize("name", ["nemoh", "hydrostar", "hams", "aqwa"])
def test_nobody_else_knows_a_format_by_name(name: str) -> None:
    sources = [*ROOT.glob("crates/*/src/**/*.rs"), *PACKAGE.rglob("*.py")]
    naming = {
        path.relative_to(ROOT).as_posix()
        for path in sources
        if f'"{name}"' in re.sub(TESTS, "", path.read_text(encoding="utf-8"))
        and "crates/sketch" not in path.as_posix()
    }
    assert naming <= {f"crates/export/src/formats/{name}.rs", f"crates/io/src/{name}.rs"}


def test_the_tables_of_before_are_reads_of_it() -> None:
    assert list(files.FORMATS) == list(formats.formats())
    assert files.SOLVERS == ("gdf", "nemoh", "hydrostar", "hams", "aqwa")
    for row in formats.formats().values():
        for name in (row.name, *row.aliases, row.name.upper()):
            assert files.format_named(name) == row.name
        assert files.file_name("hull", row.name) == f"hull.{row.suffix or row.name}"
    with pytest.raises(moldloft.Error, match="`nemoh` or `aqwa`"):
        files.format_named("dat")
    with pytest.raises(moldloft.Error, match="expected one of: gdf, "):
        files.format_named("none")


@pytest.mark.parametrize("name", list(formats.formats()))
def test_options_are_taken_or_refused(name: str, tmp_path: Path) -> None:
    row = formats.formats()[name]
    if row.volume:
        return
    model = moldloft.loads(SHIP + ENDS)
    path = tmp_path / row.file_name("ship")
    assert files.produce(model, name, path)[0].data
    for option, taken in (("lids", row.lids), ("immersed", row.immersed)):
        if taken:
            assert files.produce(model, name, path, **{option: True})
        else:
            with pytest.raises(moldloft.Error, match=option):
                files.produce(model, name, path, **{option: True})


def test_the_command_lists_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + len(formats.formats())
    assert any(line.startswith("nemoh") and ".mar" in line for line in lines)


def trees(folder: Path) -> list[tuple[Path, ast.Module]]:
    return [
        (path, ast.parse(path.read_text(encoding="utf-8"))) for path in sorted(folder.glob("*.py"))
    ]


def test_the_command_uses_the_public_interface_alone() -> None:
    for path, tree in trees(PACKAGE / "cli"):
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and re.match(r"_[a-z]", node.attr):
                own = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls", "os")
                # What a parser of arguments holds has no other name.
                own = own or node.attr in ("_actions", "_option_string_actions")
                assert own, f"{path.name}:{node.lineno}: .{node.attr}"
            if isinstance(node, ast.ImportFrom):
                parts = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
                private = [part for part in parts if re.match(r"_[a-z]", part)]
                assert not private, f"{path.name}:{node.lineno}: {private}"


def test_messages_leave_their_heading_to_who_prints_them() -> None:
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Raise):
                texts = [n.value for n in ast.walk(node) if isinstance(n, ast.Constant)]
                bad = [t for t in texts if isinstance(t, str) and t.startswith("error")]
                assert not bad, f"{path.name}:{node.lineno}: {bad}"


def test_off_is_read_by_others(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    model = moldloft.loads(SHIP)
    (path,) = model.write(tmp_path / "ship.off")
    mesh = trimesh.load(path, process=False)
    assert len(mesh.vertices) == len(model.mesh().vertices)
    assert mesh.area == pytest.approx(4.0) and len(mesh.faces) == 12

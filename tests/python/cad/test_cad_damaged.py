"""CAD files that are damaged or doubtful: what is lost is named, and the rest is read."""

from __future__ import annotations

import math
import os
import random
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import moldloft
from cad_models import box, cylinder

pytest.importorskip("OCP")


def step_of(tmp_path: Path, text: str = "") -> str:
    """The STEP file of a box from 0 to (1, 2, 3), or of a program."""
    (path,) = moldloft.loads(text or box(1, 2, 3)).write(tmp_path / "whole.step")
    return path.read_text()


def read_back(tmp_path: Path, text: str, ending: str = "step") -> tuple[moldloft.Model, list[str]]:
    """The model of a file of this text, and the remarks."""
    from moldloft.cad.importing import program

    path = tmp_path / f"damaged.{ending}"
    path.write_text(text)
    source, remarks = program(path)
    return moldloft.loads(source), remarks


def entity(text: str, kind: str, which: int = 0) -> tuple[str, str]:
    """The number and the line of an entity."""
    line = re.findall(rf"^#\d+={kind}\(.*$", text, re.M)[which]
    return line.split("=")[0], line


def test_a_missing_line_is_named_with_the_faces_that_need_it(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    # The point of a plane is that of a vertex of three faces as well.
    for kind, hurt in [
        ("ADVANCED_FACE", 0),
        ("PLANE", 1),
        ("EDGE_CURVE", 2),
        ("ORIENTED_EDGE", 1),
        ("VERTEX_POINT", 3),
        ("CARTESIAN_POINT", 3),
    ]:
        number, line = entity(text, kind, -1)
        if kind == "CARTESIAN_POINT":
            number = "#" + re.findall(r"#(\d+)", entity(text, "AXIS2_PLACEMENT_3D", 1)[1])[1]
            line = re.findall(rf"^{number}=.*$", text, re.M)[0]
        model, remarks = read_back(tmp_path, text.replace(line + "\n", ""))
        assert f"1 entity that others refer to is missing ({number})" in remarks
        faces = [r for r in remarks if r.startswith("face #")]
        assert len(faces) == hurt and all(number in r for r in faces)
        # What is not hurt is there.
        patches = {p.name for p in model.mesh().patches}
        assert len(patches) >= 6 - max(hurt, 1)


def test_a_face_of_an_unknown_surface_is_named(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    face, line = entity(text, "ADVANCED_FACE", 2)
    plane = re.findall(r"#\d+", line)[2]
    changed = re.sub(rf"^{plane}=PLANE\(", f"{plane}=FOO_SURFACE(", text, flags=re.M)
    assert changed != text
    model, remarks = read_back(tmp_path, changed)
    assert remarks == [f"1 of the file's 6 faces could not be read: {face}"]
    assert len(model.mesh().patches) == 5


def test_a_loop_without_one_of_its_edges_is_named(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    loop, line = entity(text, "EDGE_LOOP")
    _, remarks = read_back(tmp_path, text.replace(line, re.sub(r"\(#\d+,", "(", line)))
    assert any(r.startswith(f"loop {loop} of face #") and "missing" in r for r in remarks)


def conversion(name: str, value: float, kind: str, number: int) -> str:
    """A unit by conversion; its factor and base are entities 9001 and 9002."""
    si = ".METRE." if kind == "LENGTH" else ".RADIAN."
    unit = f"{kind}_UNIT()" if kind == "LENGTH" else ""
    other = f"{kind}_UNIT()" if kind != "LENGTH" else ""
    return (
        f"#9002=({unit}NAMED_UNIT(*){other}SI_UNIT($,{si}));\n"
        f"#9001={kind}_MEASURE_WITH_UNIT({kind}_MEASURE({value!r}),#9002);\n"
        f"#{number}=(CONVERSION_BASED_UNIT('{name}',#9001){unit}NAMED_UNIT(*){other});"
    )


def test_units_that_are_wrong_unknown_or_absent_are_remarks(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    length = "#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));"
    angle = "#6=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));"
    assert length in text and angle in text
    good = [
        (angle, conversion("DEGREE", math.pi / 180, "PLANE_ANGLE", 6)),
        (angle, conversion("DEGREE", 0.0174533, "PLANE_ANGLE", 6)),
        (length, conversion("FOOT", 0.3048, "LENGTH", 5)),
        (length, conversion("INCH", 0.0254, "LENGTH", 5)),
    ]
    for old, new in good:
        assert read_back(tmp_path, text.replace(old, new))[1] == []
    bad = [
        (angle, conversion("DEGREE", 0.5, "PLANE_ANGLE", 6), r"plane angle #6 \(`DEGREE`\) is 0.5"),
        (angle, conversion("TURN", 6.28, "PLANE_ANGLE", 6), r"#6 \(`TURN`\) is not known"),
        (angle, angle.replace("RADIAN", "STERADIAN"), "#6 is called steradian"),
        (length, conversion("FURLONG", 201.168, "LENGTH", 5), r"#5 \(`FURLONG`\) is not known"),
        (length, conversion("FOOT", 0.5, "LENGTH", 5), r"#5 \(`FOOT`\) is 0.5 metres"),
        ("((#5,#6,#7))", "((#5,#7))", "context #9 names no unit of plane angle"),
        ("((#5,#6,#7))", "((#6,#7))", "context #9 names no unit of length"),
    ]
    for old, new, words in bad:
        _, remarks = read_back(tmp_path, text.replace(old, new))
        assert len(remarks) == 1 and re.search(words, remarks[0]), (new, remarks)


def test_a_file_cut_short_keeps_the_faces_that_are_whole(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    ends = [m.end() for m in re.finditer(r"ADVANCED_FACE\([^;]*;", text)]
    for count, end in enumerate(ends, 1):
        # In the middle of the next statement, and within a string of it.
        for cut in (end + 7, end + 1):
            model, remarks = read_back(tmp_path, text[:cut])
            assert f"{count} faces before are whole and kept" in remarks[0]
            assert len(model.mesh().patches) == count
            # In the unit of the file.
            assert max(model.mesh().vertices.ravel()) in (1.0, 2.0, 3.0)
    model, remarks = read_back(tmp_path, text.replace("END-ISO-10303-21;", ""))
    assert model.mesh().closed and model.mesh().volume == pytest.approx(6)
    with pytest.raises(moldloft.Error, match="cut short"):
        read_back(tmp_path, text[: ends[0] - 5])
    # At any place: an error that says so, or whole faces.
    for cut in range(200, len(text), len(text) // 23):
        try:
            model, remarks = read_back(tmp_path, text[:cut])
        except moldloft.Error as error:
            assert "damaged.step" in str(error) and cut < ends[0]
        else:
            assert "cut short" in remarks[0]
            assert f"{len(model.mesh().patches)} faces" in remarks[0]


def test_an_iges_file_cut_short_keeps_the_faces_that_are_whole(tmp_path: Path) -> None:
    (path,) = moldloft.loads(box(1, 2, 3)).write(tmp_path / "whole.igs")
    text = path.read_text()
    lines = text.splitlines(keepends=True)
    ends = [k for k, line in enumerate(lines) if line.startswith("144,") and line[72] == "P"]
    assert len(ends) == 6
    for count, end in enumerate(ends, 1):
        for part in ("", lines[end + 1][:30]):
            cut = "".join(lines[: end + 1]) + part
            model, remarks = read_back(tmp_path, cut, "igs")
            assert f"{count} of 6 faces are whole and kept" in remarks[0]
            assert len(model.mesh().patches) == count
            assert sum(r.startswith("face D") for r in remarks) == 6 - count
    with pytest.raises(moldloft.Error, match="cut short"):
        read_back(tmp_path, "".join(lines[: ends[0]]), "igs")


def test_names_of_faces_are_those_of_the_file(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    face, line = entity(text, "ADVANCED_FACE", 0)
    changed = text.replace(line, re.sub(r"'[^']*'", r"'K\\X2\\00E4\\X0\\se ''1'' #12'", line))
    model, remarks = read_back(tmp_path, changed)
    assert not remarks
    names = {p.name for p in model.mesh().patches}
    assert "K_se__1___12" in names and {"x1", "y0", "y1", "z0", "z1"} <= names
    assert face.startswith("#")


BODIES = {
    "box": box(2.5, 0.7, 1.1),
    "cylinder": cylinder(0.5, 2),
    "half ring": "Line z({0, 0, 0}, {0, 0, 1}); "
    "set s = set(torus(z, 2, 0.5)) & set(plane({0, 0, -1}, {0, 0, 0.2})); SetBody b(s);",
}
"""Bodies of planes, of splines, and of a torus."""


@pytest.mark.parametrize("name", BODIES)
def test_any_line_may_be_missing(name: str, tmp_path: Path) -> None:
    text = step_of(tmp_path, BODIES[name])
    lines = re.findall(r"^#\d+=.*;\n", text, re.M)
    numbers = {line: re.findall(r"#(\d+)", line) for line in lines}
    faces = {own[0] for line, own in numbers.items() if "=ADVANCED_FACE(" in line}
    if os.environ.get("MOLDLOFT_SOAK") != "1":
        lines = random.Random(name).sample(lines, 25)
    for line in lines:
        # What needs this line, by plain repetition.
        need = {numbers[line][0]}
        while more := {own[0] for own in numbers.values() if need & {*own[1:]}} - need:
            need |= more
        whole = len(faces - need)
        try:
            model, remarks = read_back(tmp_path, text.replace(line, ""))
        except moldloft.Error as error:
            assert whole == 0 and "damaged.step" in str(error), line
            continue
        used = any(numbers[line][0] in own[1:] for own in numbers.values())
        words = rf"#{numbers[line][0]}\b"
        assert not used or any(re.search(words, r) for r in remarks), (line, remarks)
        assert len(model.mesh().patches) >= whole, (line, remarks)


def altered(text: str, rng: random.Random) -> str:
    """A file with one statement changed so that all it refers to is there."""
    lines = re.findall(r"^#\d+=.*;\n", text, re.M)
    numbers = [line.split("=")[0] for line in lines]
    line = rng.choice(lines)
    head, body = line.split("=", 1)
    match rng.randrange(5):
        case 0:
            # Another entity of any kind.
            places = [m.span() for m in re.finditer(r"#\d+", body)]
            if not places:
                return altered(text, rng)
            at = rng.choice(places)
            body = body[: at[0]] + rng.choice(numbers) + body[at[1] :]
        case 1:
            places = [m.span() for m in re.finditer(r"-?\d+\.\d*(?:E-?\d+)?", body)]
            if not places:
                return altered(text, rng)
            at = rng.choice(places)
            new = rng.choice(["0.", "-1.", "1.E300", "1.E-300", "-1.E9", "NAN", "1.E999"])
            body = body[: at[0]] + new + body[at[1] :]
        case 2:
            places = [m.span() for m in re.finditer(r"(?<=[(,])\d+(?=[,)])", body)]
            if not places:
                return altered(text, rng)
            at = rng.choice(places)
            body = body[: at[0]] + rng.choice(["0", "-3", "7", "99", "2000000000"]) + body[at[1] :]
        case 3:
            other = rng.choice(lines).split("=", 1)[1]
            body = other
        case _:
            # A list that lost or doubled an item.
            items = [m.span() for m in re.finditer(r"#\d+,", body)]
            if not items:
                return altered(text, rng)
            at = rng.choice(items)
            kept = "" if rng.random() < 0.5 else 2 * body[at[0] : at[1]]
            body = body[: at[0]] + kept + body[at[1] :]
    return text.replace(line, f"{head}={body}", 1)


@pytest.mark.parametrize("name", BODIES)
def test_files_that_keep_their_references_do_not_end_the_process(name: str, tmp_path: Path) -> None:
    text = step_of(tmp_path, BODIES[name])
    rng = random.Random(name)
    for _ in range(400 if os.environ.get("MOLDLOFT_SOAK") == "1" else 5):
        changed = altered(text, rng)
        try:
            _, remarks = read_back(tmp_path, changed)
        except moldloft.Error as error:
            assert "Traceback" not in str(error)
        else:
            assert all(len(remark) < 1000 for remark in remarks)


def test_a_face_that_ends_the_reader_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from moldloft.cad import apart

    path = tmp_path / "part.step"
    path.write_text(step_of(tmp_path))
    bad = 0
    asked = apart._asked

    def ends(path: Path, metres: float, numbers: list[int] | None, *rest: Any) -> object:
        nonlocal bad
        if numbers is None or bad in numbers:
            return "OCCT ended over the file (SIGSEGV)"
        return asked(path, metres, numbers, *rest)

    bad = int(entity(path.read_text(), "ADVANCED_FACE", 2)[0][1:])
    monkeypatch.setattr(apart, "_asked", ends)
    found = apart.read(path, 1.0)
    assert len(found.faces) == 5
    assert found.remarks[0].startswith("OCCT ended over the file (SIGSEGV); 5 of 6 faces were read")
    assert found.remarks[0].endswith(f"left out: #{bad}")


@pytest.mark.parametrize("number", ["1.E400", "-1.E99"])
def test_numbers_that_are_none_are_refused_with_their_entity(tmp_path: Path, number: str) -> None:
    from moldloft.cad.importing import program

    path = tmp_path / "part.step"
    text = step_of(tmp_path)
    entity_, rest = text[text.index("CARTESIAN_POINT") :].split("(", 2)[1:]
    first = rest.split(",")[0]
    path.write_text(text.replace(f"{entity_}({first}", f"{entity_}({number}", 1))
    with pytest.raises(moldloft.FileError, match=rf"#\d+ \(CARTESIAN_POINT\).*{number}"):
        program(path)


def test_the_reader_is_bounded_in_time_and_memory(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_text(step_of(tmp_path))
    from moldloft.cad.importing import program

    before = moldloft.limits()
    try:
        moldloft.limits(seconds=1e-3)
        with pytest.raises(moldloft.Error, match=r"part.step`: OCCT was ended: it took longer"):
            program(path)
    finally:
        moldloft.limits(seconds=before.seconds)
    assert program(path)[1] == []


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_reader_that_ended_does_not_end_the_program(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_text(step_of(tmp_path))
    # As Gmsh leaves it; the reader has ended before it is asked.
    program = """
import signal, sys
signal.signal(signal.SIGPIPE, signal.SIG_DFL)
import moldloft
from moldloft.cad import apart, importing
begun = apart._Worker._begun
def ended(self):
    child = begun(self)
    child._process.kill()
    child._process.wait()
    return child
apart._Worker._begun = ended
try:
    importing.program(sys.argv[1])
except moldloft.Error as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, timeout=100
    )
    assert done.returncode == 0 and "OCCT ended over the file (SIGKILL)" in done.stdout, done


def test_comments_are_no_entities(tmp_path: Path) -> None:
    text = step_of(tmp_path)
    line = entity(text, "ADVANCED_FACE", 1)[1]
    comment = f"/* it's {line} and #9=#99999999; */ "
    model, remarks = read_back(tmp_path, text.replace(line, comment + line))
    assert not remarks and model.mesh().closed
    # A string that looks like one is kept.
    named = text.replace(line, re.sub(r"'[^']*'", "'a /* b */'", line, count=1))
    assert not read_back(tmp_path, named)[1]


OUTSIDE = {
    "by identifications (CAx-IF)": (
        "#9001=DOCUMENT_FILE('nut','','',#9002,'',$);\n#9002=DOCUMENT_TYPE('');\n"
        "#9003=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('nut; left.stp',#9004,#9005,(#9001));\n"
        "#9004=IDENTIFICATION_ROLE('external document id and location',$);\n"
        "#9005=EXTERNAL_SOURCE(IDENTIFIER('parts'));\n",
        ["nut; left.stp"],
    ),
    "by identity": (
        "#9001=DOCUMENT_FILE('bolt.stp','',$,#9002,'',$);\n#9002=DOCUMENT_TYPE('geometry');\n"
        "#9003=DOCUMENT_FILE('','rod.stp',$,#9002,'',$);\n",
        ["bolt.stp", "rod.stp"],
    ),
    "as a complex entity": (
        "#9001=(CHARACTERIZED_OBJECT('','')DOCUMENT('l','',$,#9002)DOCUMENT_FILE());\n"
        "#9002=DOCUMENT_TYPE('');\n"
        "#9003=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('l.stp',#9004,#9005,(#9001));\n"
        "#9004=IDENTIFICATION_ROLE('',$);\n#9005=EXTERNAL_SOURCE(IDENTIFIER(''));\n",
        ["l.stp"],
    ),
    "nothing": ("#9001=PRODUCT('DOCUMENT_FILE(''x.stp'')','','',());\n", []),
}


@pytest.mark.parametrize("name", OUTSIDE)
def test_other_files_to_which_a_file_refers_are_named(name: str, tmp_path: Path) -> None:
    lines, files = OUTSIDE[name]
    text = step_of(tmp_path)
    _, remarks = read_back(tmp_path, text.replace("ENDSEC;\nEND-ISO", f"{lines}ENDSEC;\nEND-ISO"))
    said = [remark for remark in remarks if "other files" in remark]
    assert len(said) == bool(files)
    for file in files:
        assert f"`{file}`" in said[0]


def test_a_file_without_a_shape_names_the_files_that_have_it(tmp_path: Path) -> None:
    lines, _ = OUTSIDE["by identity"]
    path = tmp_path / "assembly.stp"
    head = step_of(tmp_path).partition("DATA;")[0]
    units = re.findall(r"^#\d+=\(.*UNIT.*$", step_of(tmp_path), re.M)
    path.write_text(
        head + "DATA;\n" + "\n".join(units) + "\n" + lines + "ENDSEC;\nEND-ISO-10303-21;\n"
    )
    with pytest.raises(
        moldloft.Error, match=r"assembly\.stp`.*other files.*`bolt\.stp`, `rod\.stp`"
    ):
        from moldloft.cad.importing import program

        program(path)

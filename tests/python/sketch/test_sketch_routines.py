"""The page of routines of 1983: all of them are there, and each entry gives what it says."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import pytest

PAGE = Path(__file__).parents[3] / "docs" / "sketch-routines.md"

#: The names in the appendix and its index, which spell some in two ways.
_NAMES = """
ACOS ADEIN ADEOUT ARC BCOS CENUMB CENSTR CKRTLF CMDINIT CMDSET CNTRPT CRELIN CROSS CURFIN DAXES
DBOX DELETE DELCOR DEL4CR DEL4EL DETPNS DFAXES DIMENS DISJNT DISPLAY DISOBJ DIST DIST3D DIMENU
DMENU DOT DOTPRO DRVER2 ELLIP ERROR EXTLIN FACGEN GCSWR IDLSH IDLTES IILSQT ILSQT INARC INELL
INITDM INNPUT INQUC INSRTL INSRTP IN3DPT IOCHSZ IOGET IOINIT IONEXT IOSET IOTOP IOWRT INPUTLN
INPUTPT IRENAM KVAL LASCHR LIST LISTOB LISTOBJ LOCCL LOCLN LOCPT LSUCMD MASK MERGE MODIFY MOVE
MOVEDN MMULT MXMUP MXMUP4 NADD NDELETE NEXEXL NEXCHR NFIND NFINDO NLIST NLOAD NMOVCR NORM NORMAL
NREMAP NRENAM NSERCH NUMTES PARCUB PLNTES RENAME RESET REVERS SAVE SAVOB SAVEOB SCLMUP SDIST SETPLS
SET4RD SHOW SHOWTB SKDUMP SKINIT STRP22 STRP23 UNIT UNMARK UNPACK UPDTL1 UPDTL2 VCTADD VCTSUB
"""
ROUTINES = _NAMES.split()

ROW = re.compile(r"\| ([A-Z0-9, ]+) \| [^|]+ \| `(.+)` \| `(.+)` \|")


def rows() -> list[tuple[str, str, str]]:
    found = [ROW.fullmatch(line) for line in PAGE.read_text().splitlines()]
    return [m.groups() for m in found if m]


def test_every_routine_has_an_entry():
    named = [name for names, _, _ in rows() for name in names.split(", ")]
    assert sorted(named) == sorted(set(ROUTINES))
    # A row that is not read would not be tested.
    lines = PAGE.read_text().splitlines()
    assert sum(line.startswith("| ") for line in lines) - len(rows()) == 2 * sum(
        line.startswith("| routine") for line in lines
    )


def test_every_entry_gives_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(PAGE.read_text().split("```python\n")[1].split("```")[0], names)
    wrong = []
    for routines, code, gives in rows():
        *before, last = ast.parse(code).body
        assert isinstance(last, ast.Expr)
        try:
            exec(compile(ast.Module(before, []), routines, "exec"), names)
            got = repr(eval(compile(ast.Expression(last.value), routines, "eval"), names))
        except Exception as error:
            got = f"{type(error).__name__}: {error}"
        if got != gives:
            wrong.append((routines, got, gives))
    assert not wrong, "\n".join(map(str, wrong))


@pytest.mark.parametrize("routine", ["LOCPT", "DIST3D", "FACGEN"])
def test_the_names_are_those_of_the_manual(routine):
    assert routine in ROUTINES and len(ROUTINES) == len(set(ROUTINES))

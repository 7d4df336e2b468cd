"""``moldloft hydro``: hydrostatics of a model."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any

from moldloft.cli.console import Progress, add_model, open_model, print_json, report, table
from moldloft.errors import Error
from moldloft.hydrostatics import Hydrostatics, HydrostaticTable, RightingCurve

__all__ = ["add", "run"]

_TABLE = ["draft", "displacement", "lcb", "vcb", "waterplane_area", "lcf", "kmt", "kml"]
_TABLE += ["tpc", "mtc", "cb", "cp", "cm", "cwp"]
_HIDDEN = {"sides", "open_edges", "closure_error", "waterplane_error", "outward", "derivatives"}
_ANGLES = ("trim", "heel")


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--level", metavar="Z", type=float, help="height of the water, by default 0")
    how.add_argument("--draft", metavar="T", type=float, help="depth of the lowest point")
    how.add_argument(
        "--displacement", metavar="MASS", type=float, help="find the attitude of this mass at rest"
    )
    parser.add_argument(
        "--cg", metavar="X,Y,Z", type=_numbers(3), help="centre of gravity; frees trim and heel"
    )
    parser.add_argument("--trim", metavar="DEGREES", type=float, default=0.0)
    parser.add_argument("--heel", metavar="DEGREES", type=float, default=0.0)
    parser.add_argument(
        "--fixed",
        choices=["trim", "heel", "both"],
        help="quantities held fixed when --cg is given",
    )
    parser.add_argument("--density", type=float, default=1.0, help="density; default: 1")
    parser.add_argument("--gravity", type=float, help="default: 9.80665 m/s² in the model's unit")
    parser.add_argument("--sides", choices=["both", "one"], default="both")
    parser.add_argument(
        "--table", metavar="LOW,HIGH,N", type=_range, help="a table over N drafts from LOW to HIGH"
    )
    parser.add_argument(
        "--gz",
        metavar="LOW,HIGH,N",
        type=_range,
        help="righting arms at N heels from LOW to HIGH, in degrees; needs --displacement and --cg",
    )
    parser.add_argument(
        "--by", metavar="NAME", action="append", default=[], help="differentiate by a parameter"
    )
    parser.add_argument("--json", action="store_true", help="figures as data; angles in radians")
    parser.add_argument("--csv", metavar="FILE", help="write the rows; angles in radians")
    parser.add_argument(
        "--plot", metavar="FILE", help="draw the table or the arms (.png, .svg, .pdf)"
    )


def _numbers(count: int) -> Any:
    def read(text: str) -> list[float]:
        try:
            numbers = [float(word) for word in text.split(",")]
        except ValueError:
            numbers = []
        if len(numbers) != count or not all(map(math.isfinite, numbers)):
            raise argparse.ArgumentTypeError(f"`{text}` is not {count} numbers with commas")
        return numbers

    return read


def _range(text: str) -> list[float]:
    low, high, count = _numbers(3)(text)
    if count != int(count) or not 2 <= count <= 10_000:
        raise argparse.ArgumentTypeError(f"`{text}`: the count is not a whole number 2 to 10000")
    n = int(count)
    return [low + (high - low) * k / (n - 1) for k in range(n)]


def run(options: argparse.Namespace) -> int:
    """Measures and reports."""
    if options.table and options.gz:
        raise Error("ask for --table or for --gz, not for both")
    if options.gz and (options.displacement is None or options.cg is None):
        raise Error("--gz needs --displacement and --cg")
    if (options.plot or options.csv) and not (options.table or options.gz):
        raise Error("--csv and --plot are of the rows of --table or --gz")
    with Progress() as progress:
        progress.stage(f"running {options.model}")
        model = open_model(options)
        report(model.diagnostics)
        if model.has_errors:
            return 1
        progress.stage("floating")
        common: dict[str, Any] = {
            "cg": options.cg,
            "density": options.density,
            "gravity": options.gravity,
            "by": options.by,
        }
        trim, heel = math.radians(options.trim), math.radians(options.heel)
        kept = {"both": ("trim", "heel")}.get(options.fixed, (options.fixed,))
        rows: HydrostaticTable | RightingCurve | None = None
        if options.table:
            rows = model.hydrostatic_table(options.table, trim=trim, sides=options.sides, **common)
        elif options.gz:
            rows = model.righting_curve(
                [math.radians(a) for a in options.gz],
                options.displacement,
                trim=trim,
                free_trim="trim" not in kept,
                **common,
            )
        elif options.displacement is not None:
            free = None
            if options.fixed and options.cg:
                free = [name for name in _ANGLES if name not in kept]
            afloat = model.equilibrium(
                options.displacement, free=free, trim=trim, heel=heel, sides=options.sides, **common
            )
        else:
            afloat = model.hydrostatics(
                level=options.level,
                draft=options.draft,
                trim=trim,
                heel=heel,
                sides=options.sides,
                **common,
            )
        written: list[Path] = []
        if rows is not None and options.csv:
            written.append(rows.write_csv(options.csv))
        if rows is not None and options.plot:
            progress.stage("drawing")
            written.append(rows.plot(options.plot))
    shown = [afloat] if rows is None else list(rows)
    _warn(shown)
    if options.json:
        print_json(afloat.as_dict() if rows is None else rows.as_list())
    elif rows is None:
        print(_one(afloat))
    else:
        print(_table(rows))
    if not options.json:
        for path in written:
            print(f"wrote {path}")
    return 0


def _warn(rows: list[Hydrostatics]) -> None:
    wet = [row for row in rows if row.floods]
    if wet:
        heels = sum(row.heel != 0 for row in wet)
        where = f" in {len(wet)} of {len(rows)} rows" if len(rows) > 1 else ""
        note = ", heeled" if heels else ""
        text = f"warning: the mesh has an open edge below the waterline{where}{note}; "
        print(text + "results are unreliable", file=sys.stderr)
    lost = sum(row.status == "not-converged" for row in rows)
    if lost:
        print(f"warning: {lost} of {len(rows)} attitudes did not come to rest", file=sys.stderr)
    if any(row.stable is False for row in rows):
        print("warning: the body does not right itself in this attitude", file=sys.stderr)


def _one(afloat: Hydrostatics) -> str:
    sides = {"both": "both sides", "one": "one side", "whole": "the whole body"}[afloat.sides]
    lines = [f"hydrostatics, {sides}"]
    figures = {k: v for k, v in afloat.as_dict().items() if k not in _HIDDEN}
    width = max(map(len, figures))
    for name, value in figures.items():
        shown = f"{value:.8g}" if isinstance(value, float) else str(value)
        if name in _ANGLES:
            shown = f"{math.degrees(value):.8g} degrees"
        slopes = afloat.derivatives.get(name, {})
        more = "".join(f"  d/d{by} {slope:.6g}" for by, slope in slopes.items())
        lines.append(f"  {name.ljust(width)}  {shown}{more}")
    if afloat.open_edges:
        lines.append(
            f"  {afloat.open_edges} open panel edges below the waterline: results are unreliable"
        )
    return "\n".join(lines)


def _table(rows: HydrostaticTable | RightingCurve) -> str:
    if isinstance(rows, HydrostaticTable):
        body = [[_number(getattr(row, name)) for name in _TABLE] for row in rows]
        return table(_TABLE, body, left=0)
    names = ["heel", "gz", "righting_moment", "trim", "draft_mid", "freeboard", "status"]
    body = []
    for row in rows:
        cells = [f"{math.degrees(row.heel):.4g}", _number(row.gz), _number(row.righting_moment)]
        cells += [f"{math.degrees(row.trim):.4g}", _number(row.draft_mid), _number(row.freeboard)]
        body.append([*cells, row.status])
    text = table(names, body, left=0) + "\n(heel and trim in degrees)"
    heel, arm = rows.largest
    text += f"\nlargest arm {arm:.6g} at {math.degrees(heel):.4g} degrees"
    if rows.vanishing is not None:
        text += f"\nit vanishes at {math.degrees(rows.vanishing):.4g} degrees"
    return text


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"

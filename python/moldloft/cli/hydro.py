"""``moldloft hydro``: hydrostatics of a model."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any

from moldloft.cli.console import (
    Progress,
    add_model,
    emit,
    open_model,
    print_json,
    report,
    water,
)
from moldloft.errors import Error
from moldloft.hydro.hydrostatics import (
    Hydrostatics,
    HydrostaticTable,
    RightingCurve,
    rounded_to_bound,
)
from moldloft.text_table import table, terminal_width
from moldloft.units import header, shown

__all__ = ["add", "run"]

_TABLE = ["draft", "displacement", "lcb", "vcb", "waterplane_area", "lcf", "kmt", "kml"]
_TABLE += ["tpc", "mtc", "cb", "cp", "cm", "cwp"]
_HIDDEN = {"sides", "open_edges", "closure_error", "waterplane_error", "outward", "derivatives"}
_HIDDEN |= {"bounds", "lolls", "waterplane_product", "accuracy"}
_ANGLES = ("trim", "heel")


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--level", metavar="Z", type=float, help="height of the water, by default 0")
    how.add_argument("--draft", metavar="T", type=float, help="depth of the lowest point")
    how.add_argument(
        "--displacement", metavar="MASS", type=float, help="find the equilibrium of this mass"
    )
    parser.add_argument(
        "--cg", metavar="X,Y,Z", type=_numbers(3), help="centre of gravity; frees trim and heel"
    )
    parser.add_argument(
        "--trim", metavar="DEGREES", type=float, default=0.0, help="positive: deeper at large x"
    )
    parser.add_argument(
        "--heel", metavar="DEGREES", type=float, default=0.0, help="positive: deeper at large y"
    )
    parser.add_argument(
        "--fixed",
        choices=["trim", "heel", "both"],
        help="quantities held fixed when --cg is given",
    )
    parser.add_argument(
        "--density",
        metavar="WATER",
        type=water,
        help="salt, fresh, or mass per volume in the model's units; without it there are no masses",
    )
    parser.add_argument(
        "--units", metavar="UNITS", help="other units for the figures, such as 'm t kN'"
    )
    parser.add_argument(
        "--accuracy", type=float, default=1e-6, help="relative accuracy; default: 1e-6"
    )
    parser.add_argument(
        "--weights",
        action="store_true",
        help="list the model's weights; without --displacement the model floats with them",
    )
    parser.add_argument(
        "--criteria",
        metavar="RULE",
        nargs="?",
        const="is-code-2008",
        help="intact criteria: is-code-2008 (the default), fishing, timber, or a .json file; "
        "status 1 unless all that apply are passed",
    )
    parser.add_argument(
        "--wind",
        metavar="AREA,LEVER",
        type=_numbers(2),
        help="lateral area above the water in m², height of its centre over half the draught in m",
    )
    parser.add_argument(
        "--opening",
        metavar="NAME=X,Y,Z",
        type=_opening,
        action="append",
        default=[],
        help="a downflooding point; repeatable",
    )
    parser.add_argument(
        "--booklet", metavar="FILE", help="a stability booklet of the loading (.html, .pdf)"
    )
    parser.add_argument(
        "--kn",
        metavar="VOLUMES",
        type=_list,
        help="cross curves: arms KN for these displaced volumes, at the heels of --gz",
    )
    parser.add_argument(
        "--sections",
        metavar="LOW,HIGH,N",
        type=_range,
        help="immersed areas of N sections from x = LOW to HIGH, below the levels of --table",
    )
    parser.add_argument("--gravity", type=float, help="default: 9.80665 m/s² in the model's unit")
    parser.add_argument(
        "--sides",
        choices=["both", "one"],
        default="both",
        help="figures of both sides of a mirrored model (the default), or of one side",
    )
    parser.add_argument(
        "--table", metavar="LOW,HIGH,N", type=_range, help="a table over N drafts from LOW to HIGH"
    )
    parser.add_argument(
        "--gz",
        metavar="LOW,HIGH,N",
        type=_range,
        help="righting arms at N heels from LOW to HIGH, in degrees",
    )
    parser.add_argument(
        "--by", metavar="NAME", action="append", default=[], help="differentiate by a parameter"
    )
    parser.add_argument(
        "--parts",
        choices=["object", "tag"],
        help="also the wetted area of each object, or of the objects with each tag",
    )
    parser.add_argument(
        "--stiffness",
        action="store_true",
        help="the 6 x 6 stiffness about the centre of gravity; needs --cg and --density",
    )
    parser.add_argument(
        "--kh", metavar="FOLDER", help="write the stiffness as KH.dat and Hydrostatics.dat of Nemoh"
    )
    parser.add_argument(
        "--united",
        action="store_true",
        help="one skin of bodies that overlap; figures are those of its panels",
    )
    parser.add_argument(
        "--keep-going",
        action="store_true",
        help="figures of an incomplete model: with failed objects, or a skin open below the water",
    )
    parser.add_argument(
        "--json", action="store_true", help="figures as data with their units; angles in degrees"
    )
    parser.add_argument(
        "--csv",
        metavar="FILE",
        help="write the rows, with units in the header; - is standard output",
    )
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


def _opening(text: str) -> tuple[str, list[float]]:
    name, equals, place = text.partition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"`{text}` is not of the form name=x,y,z")
    return name, _numbers(3)(place)


def _list(text: str) -> list[float]:
    return list(_numbers(text.count(",") + 1)(text))


def _range(text: str) -> list[float]:
    try:
        low, high, count = _numbers(3)(text)
    except argparse.ArgumentTypeError:
        count = math.nan
    if not 2 <= count <= 10_000 or count != int(count):
        raise argparse.ArgumentTypeError(
            f"`{text}` is not LOW,HIGH,N: the least, the greatest, and how many (a whole number, 2 "
            "to 10000), such as 0,60,13"
        )
    n = int(count)
    return [low + (high - low) * k / (n - 1) for k in range(n)]


def run(options: argparse.Namespace) -> int:
    """Measures and reports."""
    if options.table and options.gz:
        raise Error("--table and --gz exclude each other")
    if options.kn and not options.gz:
        raise Error("--kn needs the heels of --gz")
    rows_of = options.table or options.gz or options.sections
    if options.plot and not rows_of:
        raise Error("--plot is of the rows of --table, --gz, --kn or --sections")
    if options.parts and (rows_of or options.units):
        raise Error("--parts is of one attitude, in the model's units")
    stiff = options.stiffness or options.kh
    if stiff and (rows_of or options.units or options.cg is None or options.density is None):
        raise Error(
            "--stiffness and --kh are of one attitude in the model's units, with --cg and --density"
        )
    if options.csv and not (rows_of or options.criteria):
        raise Error("--csv is of the rows of --table, --gz, --kn, --sections or --criteria")
    with Progress() as progress:
        progress.stage(f"running {options.model}")
        model = open_model(options)
        report(model.diagnostics)
        if model.has_errors and not options.keep_going:
            return 1
        model.partial = options.keep_going
        if options.united:
            progress.stage("uniting")
            model = model.united()
        progress.stage("floating")
        if options.weights and options.displacement is None:
            _take_weights(model, options)
        if options.weights and not (options.gz or options.table or options.criteria):
            print(model.weights())
        if options.sections:
            return _sections(model, options)
        if options.booklet:
            return _booklet(model, options)
        if options.criteria:
            return _criteria(model, options)
        if options.kn:
            return _cross_curves(model, options)
        flotation, rows = _measured(model, options)
        written: list[Path] = []
        if rows is not None and options.csv == "-":
            emit("-", rows.csv().encode())
            return 0
        if rows is not None and options.csv:
            written.append(rows.write_csv(options.csv))
        if rows is not None and options.plot:
            progress.stage("drawing")
            written.append(rows.plot(options.plot))
        if options.kh:
            written += flotation.write_kh(options.kh, options.cg)
    _warn([flotation] if rows is None else list(rows))
    matrix = flotation.stiffness(options.cg).tolist() if options.stiffness else None
    parts = None
    if options.parts:
        place = {name: getattr(flotation, name) for name in ("level", "trim", "heel")}
        parts = model.wetted_areas(
            **place, sides=options.sides, by=options.parts, accuracy=options.accuracy
        )
    if options.json:
        more: dict[str, Any] = {} if matrix is None else {"stiffness": matrix}
        more |= {} if parts is None else {"wetted_areas": parts}
        print_json({**_data(flotation), **more} if rows is None else [_data(row) for row in rows])
    elif rows is None:
        print(_one(flotation))
        if parts is not None:
            rows_of_parts = [[name, _number(area)] for name, area in parts.items()]
            print(f"\nwetted area\n{table([options.parts, 'area'], rows_of_parts)}")
        if matrix is not None:
            words = ["surge", "sway", "heave", "roll", "pitch", "yaw"]
            cells = [[w, *map(_number, row)] for w, row in zip(words, matrix, strict=True)]
            print(f"\nstiffness about the centre of gravity\n{table(['', *words], cells)}")
    else:
        print(_table(rows))
    if not options.json:
        for path in written:
            print(f"wrote {path}")
    return 0


def _take_weights(model: Any, options: argparse.Namespace) -> None:
    total = model.weights()
    if not total.rows:
        raise Error(
            "the model has no weights\nhelp: declare them: Weight engine({2, 0, 0.5}, mass = 3);"
        )
    options.displacement, options.cg = total.mass, list(total.centre)


def _measured(
    model: Any, options: argparse.Namespace
) -> tuple[Hydrostatics, HydrostaticTable | RightingCurve | None]:
    common: dict[str, Any] = {
        "cg": options.cg,
        "density": options.density,
        "gravity": options.gravity,
        "by": options.by,
        "accuracy": options.accuracy,
    }
    trim, heel = math.radians(options.trim), math.radians(options.heel)
    kept = {"both": ("trim", "heel")}.get(options.fixed, (options.fixed,))
    rows: HydrostaticTable | RightingCurve | None = None
    if options.table:
        rows = model.hydrostatic_table(options.table, trim=trim, sides=options.sides, **common)
    elif options.gz:
        if options.displacement is None or options.cg is None:
            raise Error("--gz needs --displacement and --cg, or --weights")
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
        flotation = model.equilibrium(
            options.displacement, free=free, trim=trim, heel=heel, sides=options.sides, **common
        )
    else:
        flotation = model.hydrostatics(
            level=options.level,
            draft=options.draft,
            trim=trim,
            heel=heel,
            sides=options.sides,
            **common,
        )
    if rows is not None:
        if options.units:
            rows = type(rows)([row.converted(options.units) for row in rows])
        return rows.rows[0], rows
    return (flotation.converted(options.units) if options.units else flotation), None


def _data(row: Hydrostatics) -> dict[str, Any]:
    """The figures as data: angles in degrees, units by figure."""
    figures = {name: shown(name, value) for name, value in row.as_dict().items()}
    units = {name: row.unit(name) for name in figures if row.unit(name)}
    return {**figures, "units": units}


def _stability(model: Any, options: argparse.Namespace) -> Any:
    kept = {"both": ("trim", "heel")}.get(options.fixed, (options.fixed,))
    return model.stability(
        options.displacement,
        cg=options.cg,
        density=options.density,
        trim=math.radians(options.trim),
        free_trim="trim" not in kept,
        openings=dict(options.opening),
        gravity=options.gravity,
        accuracy=options.accuracy,
    )


def _criteria(model: Any, options: argparse.Namespace) -> int:
    from moldloft.hydro.stability import Wind

    stability = _stability(model, options)
    wind = Wind(*options.wind) if options.wind else None
    found = stability.assess(options.criteria, wind=wind)
    if options.json:
        checks = {"rule": found.rule, "passed": found.passed, "checks": found.as_list()}
        print_json({**checks, "stability": stability.figures()})
    elif options.csv:
        _write_csv(options, found.csv())
    else:
        print(stability.summary())
        print()
        print(found)
    # For scripts: a clause that fails, or that cannot be judged, is no success.
    return 0 if found.passed else 1


def _booklet(model: Any, options: argparse.Namespace) -> int:
    from moldloft.hydro.booklet import write_booklet
    from moldloft.hydro.stability import Wind

    wind = Wind(*options.wind) if options.wind else None
    rule = options.criteria or "is-code-2008"
    stability = _stability(model, options)
    print(f"wrote {write_booklet(options.booklet, model, stability, rule=rule, wind=wind)}")
    return 0


def _cross_curves(model: Any, options: argparse.Namespace) -> int:
    from moldloft.hydro.stability import cross_curves

    found = cross_curves(
        model,
        options.kn,
        [math.radians(a) for a in options.gz],
        free_trim=options.fixed not in ("trim", "both"),
        accuracy=options.accuracy,
    )
    if options.json:
        print_json(found.as_list())
    if options.csv:
        _write_csv(options, found.csv())
    if options.plot:
        path = found.plot(options.plot)
        if not options.json:
            print(f"wrote {path}")
    if not (options.json or options.csv or options.plot):
        print(found)
    return 0


def _write_csv(options: argparse.Namespace, text: str) -> None:
    """Writes rows to the file of --csv, or to standard output."""
    from moldloft.exchange.files import Output, commit

    if options.csv == "-":
        emit("-", text.encode())
        return
    path = Path(options.csv)
    commit(path.parent, [Output(path.name, text.encode())])
    if not options.json:
        print(f"wrote {path}")


def _sections(model: Any, options: argparse.Namespace) -> int:
    levels = options.table or [0.0 if options.level is None else options.level]
    areas = model.section_areas(options.sections, levels, accuracy=options.accuracy)
    unit = model.units.of("area")
    head = [f"x [{model.units.length}]" if model.units.length else "x"]
    head += [f"area [{unit}] below z = {z:g}" if unit else f"area below z = {z:g}" for z in levels]
    body = [
        [f"{x:.6g}", *(f"{a:.8g}" for a in row)]
        for x, row in zip(options.sections, areas, strict=True)
    ]
    if options.csv:
        import csv
        import io

        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        writer.writerow(head)
        writer.writerows(
            [[x, *row] for x, row in zip(options.sections, areas.tolist(), strict=True)]
        )
        _write_csv(options, text.getvalue())
    if options.plot:
        from moldloft.hydro.hydrostatics import plot_curves

        curves = {f"z = {z:g}": areas[:, k].tolist() for k, z in enumerate(levels)}
        path = plot_curves(
            options.plot, options.sections, curves, (head[0], f"area [{unit}]" if unit else "area")
        )
        if not options.json:
            print(f"wrote {path}")
    if options.json:
        print_json({"stations": options.sections, "levels": levels, "areas": areas.tolist()})
    elif not (options.csv or options.plot):
        print(table(head, body, left=0, width=terminal_width()))
    return 0


def _warn(rows: list[Hydrostatics]) -> None:
    wet = [row for row in rows if row.floods]
    if wet:
        heels = sum(row.heel != 0 for row in wet)
        where = f" in {len(wet)} of {len(rows)} rows" if len(rows) > 1 else ""
        note = ", heeled" if heels else ""
        text = f"warning: the skin has an open edge below the waterline{where}{note}, where water "
        print(text + "enters: no figures of a body", file=sys.stderr)
    lost = sum(row.status == "not-converged" for row in rows)
    if lost:
        print(f"warning: no equilibrium found for {lost} of {len(rows)} attitudes", file=sys.stderr)
    if any(row.stable is False for row in rows):
        print("warning: unstable: small turns are not righted in this attitude", file=sys.stderr)
    if any(row.lolls for row in rows):
        print("warning: unstable upright; this is the attitude of loll", file=sys.stderr)


def _one(flotation: Hydrostatics) -> str:
    sides = {"both": "both sides", "one": "one side", "whole": "the whole body"}[flotation.sides]
    lines = [f"hydrostatics, {sides}"]
    figures = {k: v for k, v in flotation.as_dict().items() if k not in _HIDDEN}
    width = max(map(len, figures))
    for name in figures:
        value = rounded_to_bound(flotation, name)
        text = f"{value:.8g}" if isinstance(value, float) else str(value)
        if name in _ANGLES:
            text = f"{math.degrees(value):.8g} degrees"
        elif flotation.unit(name):
            text += f" {flotation.unit(name)}"
        if name in flotation.bounds:
            text += f" ± {flotation.bounds[name]:.1g}"
        slopes = flotation.derivatives.get(name, {})
        more = "".join(f"  d/d{by} {slope:.6g}" for by, slope in slopes.items())
        lines.append(f"  {name.ljust(width)}  {text}{more}")
    lines += [f"  {remark}" for remark in flotation.remarks]
    return "\n".join(lines)


def _table(rows: HydrostaticTable | RightingCurve) -> str:
    if isinstance(rows, HydrostaticTable):
        names = [n for n in _TABLE if any(getattr(row, n) is not None for row in rows)]
        body = [[_number(getattr(row, name)) for name in names] for row in rows]
        heads = [header(name, rows.units) for name in names]
        return table(heads, body, left=0, width=terminal_width())
    names = ["heel", "gz", "righting_moment", "trim", "draft_mid", "freeboard"]
    names = [header(name, rows.units) for name in names] + ["status"]
    body = []
    for row in rows:
        cells = [f"{math.degrees(row.heel):.4g}", _number(row.gz), _number(row.righting_moment)]
        cells += [f"{math.degrees(row.trim):.4g}", _number(row.draft_mid), _number(row.freeboard)]
        body.append([*cells, "floods" if row.open_edges else row.status])
    text = table(names, body, left=0, width=terminal_width())
    heel, arm = rows.largest
    if math.isnan(arm):
        return text
    text += f"\nlargest arm {arm:.6g} at {math.degrees(heel):.4g} degrees"
    if rows.vanishing is not None:
        text += f"\nit vanishes at {math.degrees(rows.vanishing):.4g} degrees"
    return text


def _number(value: float | None) -> str:
    return "-" if value is None or math.isnan(value) else f"{value:.6g}"

"""``moldloft fair``: fair points, a curve, a surface or a network within a tolerance."""

from __future__ import annotations

import abc
import argparse
import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft.cli import fair_words as words
from moldloft.cli.console import Progress, assignment, print_json
from moldloft.errors import Error, FairingError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from moldloft.fairing import (
        Fairing,
        NetworkFairing,
        PatchesFairing,
        Spline,
        SurfaceFairing,
        Suspect,
    )
    from moldloft.fairing.files import GridFile, PointFile

    Result = Fairing | SurfaceFairing | NetworkFairing | PatchesFairing

__all__ = ["Source", "add", "commit_file", "curve_options", "fair_grid", "known_ending", "run"]

_EPILOG = """
FILE is rows of points (CSV, blanks or tabs; an aerofoil with its title), a Plot3D surface, or an
object of a model, as in `hull.sdl:keel`. Several curves that blank lines separate are a network:
rows with the same numbers are one point of all curves that have it. Points count from 1.

  moldloft fair section.csv --tol 0.005 -o faired.csv --plot faired.png
  moldloft fair ring.csv --tol 1e-3 --closed --as fit
  moldloft fair hull.p3d --tol 0.002 -o hull.vts --json
  moldloft fair boat.sdl:sheer --tol 0.01 --measure third
  moldloft fair hull.p3d --tol none --passes 10          the report of 1991, figure 13
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("file", metavar="FILE", help="points, a Plot3D surface, or MODEL:OBJECT")
    parser.add_argument(
        "--tol",
        metavar="D|FILE",
        required=True,
        type=words.tolerance,
        help="maximum distance from the original; `none`: no limit; a file has one value per point",
    )
    parser.add_argument(
        "--as",
        dest="role",
        choices=["control", "points", "fit"],
        help="meaning of the points: fit, data on the curve (the default of the optimum); points, "
        "moved directly; control, control points with their index as parameter (the report of "
        "1991)",
    )
    parser.add_argument(
        "--closed", action="store_true", help="closed curve, or surface closed along u"
    )
    parser.add_argument("--closed-v", action="store_true", help="the surface is closed along v")
    parser.add_argument(
        "--mode",
        choices=["optimum", "faithful", "literal", "vertex", "sweeps", "levels"],
        help="optimum, with a certificate (the default), or local steps: faithful (knots removed "
        "and re-inserted), literal (the rule of the report), vertex, sweeps, levels",
    )
    parser.add_argument(
        "--measure",
        choices=["second", "third", "jumps", "jump-lengths", "bending", "variation"],
        help="the measure to minimise; default: the integral of the squared third derivative of "
        "data, squared third differences of networks, squared second differences otherwise",
    )
    parser.add_argument(
        "--bound", choices=["data", "curve", "points"], help="quantity bounded by the tolerance"
    )
    parser.add_argument(
        "--breaks",
        metavar="auto|I,J",
        default="",
        help="points at intended breaks; for surfaces rows, as in u5,v2; `auto` finds corners and "
        "wrong digits",
    )
    parser.add_argument("--fixed", metavar="I,J", default="", help="points that do not move")
    parser.add_argument(
        "--ends",
        metavar="END[,END]",
        help="fixed at open ends: free, position, tangent, curvature or a number of points; for a "
        "network corners, ends or none",
    )
    parser.add_argument(
        "--rims",
        metavar="WORD|u0=WORD,..",
        default="corners",
        help="fixed at rims of a surface: corners, position, tangent or curvature, for all rims or "
        "some, as in u0=curvature,v1=position",
    )
    parser.add_argument(
        "--seams",
        choices=["position", "tangent", "curvature"],
        help="continuity across common edges of the blocks of a Plot3D file, which are faired "
        "together; default: curvature",
    )
    parser.add_argument(
        "--degree",
        metavar="P[,Q]",
        type=words.degrees,
        default=3,
        help="polynomial degree, one or two for surfaces; default: 3",
    )
    parser.add_argument(
        "--knots",
        metavar="FILE",
        help="knots of the curve, or of a surface along u: non-decreasing values",
    )
    parser.add_argument("--knots-v", metavar="FILE", help="knots of a surface along v")
    parser.add_argument(
        "--weights",
        metavar="FILE",
        help="weights of a rational curve or surface, one per control point",
    )
    parser.add_argument(
        "--period",
        metavar="D",
        type=float,
        help="period of the knots of a closed curve",
    )
    parser.add_argument(
        "--along",
        metavar="X,Y[,Z]",
        type=words.vector,
        help="points move in this direction only, as in 0,1 for offsets at fixed stations",
    )
    parser.add_argument(
        "--across",
        metavar="X,Y[,Z]",
        type=words.vector,
        help="points stay in planes normal to this direction",
    )
    parser.add_argument("--box", action="store_true", help="limit each coordinate separately")
    for word, place, what in (
        ("through", "T", "the curve passes through X,Y[,Z] at T, or the surface at U,V"),
        ("tangent", "T", "the curve has the tangent X,Y[,Z] at T"),
        ("normal", "U,V", "the surface has the normal X,Y,Z at U,V"),
    ):
        parser.add_argument(
            f"--{word}",
            metavar=f"{place}=X,Y[,Z]",
            type=words.condition,
            action="append",
            default=[],
            help=f"{what}, parameters in [0, 1]; repeatable",
        )
    parser.add_argument(
        "--join",
        metavar="FILE",
        action="append",
        default=[],
        help="points of a curve that shares an end with this one, which continues it with the same "
        "tangent and curvature (both fitted: --as fit); repeatable",
    )
    parser.add_argument(
        "--keep",
        choices=["area", "volume", "centroid"],
        action="append",
        default=[],
        help="keep to first order the area, the volume (of revolution about x; for a surface that "
        "between it and the original) or, for curves, the centroid; of a network of offsets the "
        "volume and its centroid",
    )
    parser.add_argument(
        "--spacing",
        metavar="WORD|X,Y[,Z]",
        type=words.spacing,
        default="auto",
        help="parametrisation: chord, centripetal, a coordinate (x, y, z) or a direction in which "
        "points ascend, index, or curvature (single curves: chords weighted by curvature; the "
        "default of the goal near, otherwise chord)",
    )
    parser.add_argument(
        "--at", metavar="FILE", help="parameters of the points, ascending, in [0, 1]"
    )
    parser.add_argument(
        "--goal",
        metavar="WORD[=FRACTION]",
        type=words.goal,
        default="near",
        help="choice among the results within the tolerance: near (default: the fairest that noise "
        "of this size explains; unmoved if there is little to gain), fairest, budget=FRACTION "
        "of such noise, nearest=FRACTION above the minimum, energy=MAX (the nearest that "
        "measures at most this), closest (the nearest with the required shape)",
    )
    parser.add_argument(
        "--shape",
        metavar="WORD[=I-J]",
        action="append",
        default=[],
        help="shape of the curve: convex, concave, one-way (no inflection), straight, arc, for the "
        "whole curve or between two points (arc=9-15; straight=1-9:0,1 in a direction); "
        "pieces=K of monotone curvature; within=X,Y:MAX; side=X,Y; repeatable; of a network behind "
        "the name of a curve, `waterline 2: straight=3-9`, or of several, "
        "`waterline 2..waterline 5 at station 4..station 8: flat`",
    )
    parser.add_argument(
        "--release",
        metavar="auto|I,J",
        default="",
        help="wrong points without a tolerance; `auto`: the wrong digits that are found",
    )
    parser.add_argument(
        "--bends",
        action="store_true",
        help="allow inflections that the curve of least bending does not have",
    )
    parser.add_argument(
        "--count",
        type=int,
        help="number of control points of a least-squares fit; default: interpolate all points",
    )
    parser.add_argument("--steps", type=int, help="local steps, for surfaces per point")
    parser.add_argument(
        "--stop",
        metavar="WORD[=FRACTION]",
        type=words.stop,
        action="append",
        default=[],
        help="end of local steps: a move is shorter than this fraction of the tolerance "
        "(move=FRACTION), a step lowers the measure by less (drop=FRACTION), the certified gap"
        " is below it (gap=FRACTION), or a pass leaves the number of monotone pieces (pieces);"
        " repeatable",
    )
    parser.add_argument(
        "--accuracy",
        metavar="FRACTION",
        type=float,
        help="certified gap of the optimum of a curve, relative to the measure; default: as small "
        "as rounding allows",
    )
    parser.add_argument(
        "--original",
        metavar="FILE",
        help="the original points, if FILE is a faired result: tolerances refer to these",
    )
    parser.add_argument(
        "--passes", type=int, help="passes of the faithful mode, which this implies"
    )
    parser.add_argument("--block", type=int, help="the block of a Plot3D file, from 1")
    parser.add_argument(
        "--units",
        choices=["m", "cm", "mm", "ft", "in"],
        help="unit of the numbers in a file of points, also stated in splines; default: that of the"
        " file",
    )
    parser.add_argument(
        "--round",
        metavar="STEP",
        type=words.step,
        help="step of written numbers, as in 0.001 or 1/16; 0 for all digits; default: the last "
        "digit of a table of offsets, all digits of other points",
    )
    parser.add_argument("-o", "--output", metavar="OUT", help="the faired points or surface")
    parser.add_argument("--plot", metavar="P.png", help="pictures of the result, .png or .svg")
    parser.add_argument(
        "--report",
        metavar="P.html",
        help="one page: pictures to scale, every point, the spline",
    )
    parser.add_argument(
        "--sheet",
        metavar="P.pdf",
        help="a sheet to sign, .pdf or .html: offsets before and after, curves, combs, lines 1 : n",
    )
    parser.add_argument(
        "--suspects",
        metavar="COUNT",
        type=int,
        nargs="?",
        const=10,
        default=0,
        help="list COUNT (default 10) offsets that contradict their neighbours, the clearest first,"
        " with the probable reading",
    )
    parser.add_argument("--log", metavar="FILE", help="the local steps, replayable, as CSV")
    parser.add_argument("--json", action="store_true", help="the report as data")
    parser.add_argument(
        "--set",
        metavar="NAME=NUMBER",
        type=assignment,
        action="append",
        default=[],
        help="a parameter of the model; repeatable",
    )
    parser.add_argument("--library", metavar="DIR", action="append", default=[])


def refuse_curves_only(options: argparse.Namespace) -> None:
    """Options of single curves; an error if they would be ignored."""
    for name, given in (
        ("--bends", options.bends),
        ("--at", options.at),
        ("--period", options.period is not None),
        ("--stop", options.stop),
        ("--accuracy", options.accuracy is not None),
        ("--original", options.original),
    ):
        if given:
            raise Error(f"{name} is for single curves")


def run(options: argparse.Namespace) -> int:
    """Fairs and reports."""
    if options.plot and Path(options.plot).suffix.lower() not in (".png", ".svg"):
        raise Error(f"a plot is .png or .svg, not `{options.plot}`")
    if options.report and Path(options.report).suffix.lower() not in (".html", ".htm"):
        raise Error(
            f"a report is .html, not `{options.report}`: a browser prints such a page as PDF"
        )
    if isinstance(options.tol, str):
        options.tol = _numbers(options.tol)
    if options.tol is None and not options.json:
        print(
            "warning: without a tolerance the result may be far from the data: the steps converge "
            "to a single polynomial",
            file=sys.stderr,
        )
    if options.passes is not None and options.mode is None:
        options.mode = "faithful"
    if options.passes is not None and options.passes < 1:
        raise Error(f"expected 1 pass or more, found {options.passes}")
    options.mode = options.mode or "optimum"
    with Progress() as progress:
        progress.stage(f"reading {options.file}")
        source = _source(options)
        progress.stage("fairing")
        result = source.fair(options)
        data = result.as_dict()
        data.update(source.facts())
        files = []
        if options.plot:
            from moldloft.fairing.plot import needed

            needed()
        if options.output:
            progress.stage(f"writing {options.output}")
            files.append(source.write(result, Path(options.output)))
        if options.log:
            files.append(_write_log(result, Path(options.log)))
        if options.plot:
            progress.stage(f"drawing {options.plot}")
            if not hasattr(result, "plot"):
                raise Error("--plot: several blocks; choose one with --block")
            result.plot(options.plot)
            files.append(options.plot)
        if options.suspects:
            progress.stage("looking for suspects")
            found = source.suspects(result, options.suspects)
            data["suspects"] = [s.as_dict() for s in found]
        if options.sheet:
            progress.stage(f"writing {options.sheet}")
            files.append(source.sheet(result, Path(options.sheet)))
        if options.report:
            from moldloft.fairing.page import write_page

            progress.stage(f"writing {options.report}")
            title = f"Fairing of {source.title}"
            files.append(write_page(result, options.report, title, source.stated()))
    data["files"] = [str(f) for f in files]
    if options.json:
        print_json(data)
        return 0
    print(source.title)
    print(result)
    for note in source.notes():
        print(f"note: {note}")
    for rank, suspect in enumerate(found if options.suspects else (), 1):
        print(f"suspect {rank}: {suspect}")
    for file in files:
        print(f"wrote {file}")
    return 0


def _source(options: argparse.Namespace) -> Source:
    name = options.file
    model, colon, thing = name.rpartition(":")
    if colon and thing and Path(model).suffix.lower() in (".sdl", ".ms2", ".mul"):
        from moldloft.cli.fair_object import ObjectSource

        return ObjectSource(model, thing, options)
    path = Path(name)
    if path.suffix.lower() in (".sdl", ".ms2"):
        raise Error(f"which object of `{name}` is to be faired? write `{name}:NAME`")
    from moldloft.fairing.files import is_grid, read_grids, read_points

    if is_grid(path):
        return _Grids(read_grids(path), options)
    return _Points(read_points(path))


def _ends(options: argparse.Namespace) -> Any:
    if options.ends is None:
        return None
    words = [w.strip() for w in options.ends.split(",")]
    ends = [int(w) if w.isdigit() else w for w in words]
    if len(ends) not in (1, 2):
        raise Error(f"--ends: expected one or two, found {len(ends)}")
    return ends[0] if len(ends) == 1 else tuple(ends)


class Source(abc.ABC):
    """Data to fair, with their source and the writer of the result."""

    title = ""

    @abc.abstractmethod
    def fair(self, options: argparse.Namespace) -> Result:
        """The result with these options."""

    def facts(self) -> dict[str, Any]:
        """Data of the report in addition to those of the result."""
        return {"source": self.title}

    def notes(self) -> list[str]:
        """Sentences in addition to those of the result."""
        return []

    def stated(self) -> list[tuple[str, str]]:
        """Provenance on a page: the source, and the command to repeat the result."""
        import datetime

        command = shlex.join(["moldloft", *sys.argv[1:]])
        today = datetime.datetime.now().astimezone().date().isoformat()
        return [("source", self.title), ("command", command), ("date", today)]

    def suspects(self, result: Any, most: int) -> Sequence[Suspect]:
        """The suspects among the points."""
        raise Error("--suspects: for files of points and tables of offsets")

    def sheet(self, result: Any, path: Path) -> Path:
        """Writes the sheet and returns its path."""
        raise Error("--sheet: for files of points and tables of offsets; --report is for others")

    @abc.abstractmethod
    def write(self, result: Any, path: Path) -> Path:
        """Writes the result and returns its path."""


def _numbers(path: str | None) -> list[float] | None:
    """The numbers of a file, in order; an error names the line of an invalid one."""
    if path is None:
        return None
    from moldloft.fairing.files import read_numbers

    return read_numbers(path)


def _joined(options: argparse.Namespace, role: str) -> list[Spline]:
    """The curves that this one continues."""
    from moldloft.fairing import Spline
    from moldloft.fairing.files import read_points

    out = []
    for name in options.join:
        points = read_points(name).points
        if role == "fit":
            spacing = "chord" if options.spacing == "auto" else options.spacing
            out.append(Spline.interpolate(points, degree=options.degree, spacing=spacing))
        else:
            out.append(Spline(points, degree=options.degree, clamped=False))
    return out


def curve_options(options: argparse.Namespace, count: int, role: str) -> dict[str, Any]:
    """The options of a curve, by their Python names."""
    for name, given in (
        ("--rims", options.rims != "corners"),
        ("--normal", options.normal),
        ("--closed-v", options.closed_v),
        ("--knots-v", options.knots_v),
        ("--seams", options.seams),
        ("--degree with two numbers", not isinstance(options.degree, int)),
        ("u and v", any(len(at) > 1 for at, _ in [*options.through, *options.tangent])),
    ):
        if given:
            raise Error(f"{name}: for surfaces only")
    passes = options.passes
    steps = options.steps
    if passes is not None and steps is None:
        # A pass is one step a point.
        steps = passes * count
    breaks: Any = options.breaks
    if breaks != "auto":
        breaks = words.places(breaks, count)
    return {
        "closed": options.closed,
        "degree": options.degree,
        "measure": options.measure,
        "mode": options.mode,
        "bound": options.bound,
        "breaks": breaks,
        "fixed": words.places(options.fixed, count, "--fixed"),
        "ends": _ends(options),
        "motion": words.motion(options),
        "through": [(at[0], v) for at, v in options.through],
        "tangents": [(at[0], v) for at, v in options.tangent],
        "joins": _joined(options, role),
        "knots": _numbers(options.knots),
        "weights": _numbers(options.weights),
        "keep": options.keep,
        "spacing": options.spacing,
        "goal": options.goal,
        "release": "auto"
        if options.release == "auto"
        else words.places(options.release, count, "--release"),
        "bends": options.bends,
        "shape": options.shape,
        "count": options.count,
        "steps": steps,
        "log": bool(options.log),
        "at": _numbers(options.at),
        "period": options.period,
        "accuracy": options.accuracy,
        "original": _original(options, count),
        **dict(options.stop),
    }


def _original(options: argparse.Namespace, count: int) -> Any:
    """The points to which tolerances refer, if they differ from those of the file."""
    if not options.original:
        return None
    from moldloft.fairing.files import read_points

    file = read_points(options.original)
    if len(file.points) != count:
        raise Error(
            f"--original: {options.original} has {len(file.points)} points, the file {count}"
        )
    return file.points


def commit_file(path: Path, data: bytes) -> Path:
    """Write a file atomically."""
    from moldloft.exchange.files import Output, commit

    return commit(path.parent, [Output(path.name, data)])[0]


def known_ending(path: Path, source: Path | None) -> None:
    """Rejects an unknown extension before any output."""
    from moldloft.fairing.spline_files import POINTS, SPLINES

    ending = path.suffix.lower()
    known = (*POINTS, *SPLINES)
    if ending in known or (source is not None and ending == source.suffix.lower()):
        return
    raise Error(f"--output: `{path}`: expected an ending of {', '.join(known)}")


class _Points(Source):
    """A file of points."""

    def __init__(self, file: PointFile) -> None:
        self.file = file
        self.said: list[str] = list(file.notes)
        self.title = str(file.path)
        self.unit = file.unit

    def fair(self, options: argparse.Namespace) -> Result:
        import numpy as np

        if options.units and self.file.unit not in (None, options.units):
            raise Error(
                f"--units {options.units}: the numbers of {self.file.path} are in {self.file.unit}"
            )
        self.unit = options.units or self.file.unit
        self.step = options.round
        self.limits = np.asarray(np.inf if options.tol is None else options.tol, np.float64)
        if self.file.offsets and self.file.inches and self.file.motions is None:
            self.said.append(
                "stations and waterlines that are plain numbers are inches, too: "
                "write their places, if they are numbers of stations"
            )
        if self.file.fixed_stations and words.motion(options) == "ball":
            self.said.append("offsets move; stations stay")
            options.along = [0.0, 1.0]
        if self.file.offsets or len([b for b in self.file.blocks if len(b) > 1]) > 1:
            return self._network(options)
        from moldloft.fairing import fair

        points = self.file.points
        self.closing = False
        if options.closed and len(points) > 1 and (points[0] == points[-1]).all():
            self.said.append("the last point repeats the first and is not counted twice")
            points = points[:-1]
            self.closing = True
        role = options.role or ("fit" if options.mode == "optimum" else "control")
        chosen = curve_options(options, len(points), role)
        try:
            self.rows, self.motion = list(range(len(points))), chosen["motion"]
            result = fair(points, options.tol, as_=role, **chosen)
        except FairingError as error:
            raise self._placed(error) from error
        return result

    def _placed(self, error: FairingError) -> FairingError:
        """The fault at its line."""
        if error.index is None or error.index >= len(self.file.lines):
            return error
        line = self.file.lines[error.index]
        text = str(error)
        return FairingError(f"{self.file.path}:{line}: {text}", index=error.index)

    def _network(self, options: argparse.Namespace) -> NetworkFairing:
        from moldloft.cli.fair_lines import FileLines

        refuse_curves_only(options)
        lines = FileLines.of(self.file, options, self.said)
        self.rows, self.of_row = lines.rows, lines.of_row
        self.motion, self.limits = lines.motion, lines.limits
        try:
            result = lines.fair(options)
        except FairingError as error:
            raise self._placed(error) from error
        if self.file.offsets and self.file.moves == 1:
            self._across(result, lines.rows)
        return result

    def _across(self, result: NetworkFairing, rows: list[int]) -> None:
        """Half-breadths that became negative."""
        new, old = result.points[:, 1], self.file.points[rows][:, 1]
        over = (new < 0) & (old >= 0)
        if over.any():
            count, most = int(over.sum()), float(-new[over].min())
            word = "half-breadth is" if count == 1 else "half-breadths are"
            self.said.append(
                f"{count} {word} beyond the centreline now, by {most:.2e} at most; "
                "`--fixed` keeps points"
            )

    def suspects(self, result: Any, most: int) -> Sequence[Suspect]:
        from moldloft.cli.fair_sheet import suspects_of

        return suspects_of(self.file, result, self.rows, self.motion, most)

    def sheet(self, result: Any, path: Path) -> Path:
        from moldloft.cli.fair_sheet import SHEET_SUSPECTS, write_sheet_of
        from moldloft.fairing.sheet import SheetDetails

        points, tol = self._rows(result)
        details = SheetDetails(
            facts=self.stated()[1:],
            suspects=self.suspects(result, SHEET_SUSPECTS),
            unit=self.unit,
            limits=self.limits,
            notes=self.said,
        )
        return write_sheet_of(self.file, result, path, (points, tol, self.step), details)

    def _rows(self, result: Any) -> tuple[Any, Any]:
        """The rows of the file as they are faired, and their tolerances."""
        import numpy as np

        if not hasattr(result, "lists"):
            return result.points, np.broadcast_to(self.limits, len(result.points))
        rows, tol = result.points[self.of_row], self.limits[self.of_row]
        if self.file.table is None:
            return rows, tol
        table, each = self.file.table.copy(), np.zeros(len(self.file.table))
        table[self.file.places], each[self.file.places] = rows, tol
        return table, each

    def notes(self) -> list[str]:
        return self.said

    def stated(self) -> list[tuple[str, str]]:
        return [*super().stated(), ("unit", self.unit or "not stated")]

    def facts(self) -> dict[str, Any]:
        return {"source": self.title, "source_notes": self.said, "unit": self.unit}

    def write(self, result: Any, path: Path) -> Path:
        import numpy as np

        from moldloft.fairing.files import points_text
        from moldloft.fairing.spline_files import MILLIMETRES, SPLINES, encoded

        known_ending(path, self.file.path)
        if path.suffix.lower() in SPLINES:
            curves = result.curves if hasattr(result, "lists") else [result.spline]
            if self.unit is None and path.suffix.lower() in MILLIMETRES:
                self.said.append(
                    f"{path} states millimetres, as no unit is known; give it by --units"
                )
            return commit_file(path, encoded(curves, path, self.unit, getattr(result, "names", ())))
        if hasattr(result, "lists"):
            like: PointFile = self.file
            rows, tol = self._rows(result)
            if like.table is not None:
                like = replace(like, blocks=[range(len(rows))])
            return self._text(path, points_text(rows, like, tol=tol, step=self.step))
        points = result.points
        if self.closing:
            points = np.concatenate([points, points[:1]])
        same = path.suffix.lower() == self.file.path.suffix.lower()
        form = self.file if same else None
        delimiter = {".csv": ",", ".tsv": "\t"}.get(path.suffix.lower(), " ")
        tol = self._rows(result)[1]
        if self.closing:
            tol = np.append(tol, tol[:1])
        return self._text(path, points_text(points, form, delimiter, tol=tol, step=self.step))

    def _text(self, path: Path, text: str) -> Path:
        return commit_file(path, text.encode(self.file.encoding))


def _surface_breaks(text: str) -> tuple[list[int], list[int]]:
    if text == "auto":
        raise FairingError("--breaks: rows of surfaces are named, as in u5,v2")
    out: dict[str, list[int]] = {"u": [], "v": []}
    for word in filter(None, (w.strip() for w in text.split(","))):
        if word[0] not in out or not word[1:].isdigit() or int(word[1:]) < 1:
            raise FairingError(f"--breaks: expected rows as in u5,v2, found `{word}`")
        out[word[0]].append(int(word[1:]) - 1)
    return out["u"], out["v"]


def _grid_weights(path: str | None, shape: tuple[int, int]) -> Any:
    """The weights of a net, row by row."""
    numbers = _numbers(path)
    if numbers is None:
        return None
    if len(numbers) != shape[0] * shape[1]:
        raise FairingError(
            f"{path}: expected {shape[0]} x {shape[1]} weights, found {len(numbers)}"
        )
    import numpy as np

    return np.reshape(numbers, shape)


def fair_grid(grid: Any, role: str, options: argparse.Namespace) -> SurfaceFairing:
    """Fairs a grid of points as a surface."""
    from moldloft.fairing import fair

    refuse_curves_only(options)
    for option, given in (
        ("--tangent", options.tangent),
        ("--join", options.join),
        ("--count", options.count),
        ("--log", options.log),
        ("--fixed", options.fixed),
    ):
        if given:
            raise Error(f"{option} is for curves")
    if any(len(at) != 2 for at, _ in options.through + options.normal):
        raise Error("--through, --normal: a place of a surface is U,V")
    rims: Any = options.rims
    if "=" in rims:
        rims = dict(word.partition("=")[::2] for word in rims.split(","))
    chosen: dict[str, Any] = {
        "as_": role,
        "degree": options.degree,
        "closed": (options.closed, options.closed_v),
        "measure": options.measure,
        "mode": options.mode,
        "bound": options.bound,
        "spacing": "chord" if options.spacing == "auto" else options.spacing,
        "goal": options.goal,
        "breaks": _surface_breaks(options.breaks),
        "ends": 2 if options.ends is None else _ends(options),
        "rims": rims,
        "through": options.through,
        "normals": options.normal,
        "motion": words.motion(options),
        "keep": options.keep,
        "passes": options.passes or 1,
        "steps": options.steps,
        "knots": (_numbers(options.knots), _numbers(options.knots_v)),
        "weights": _grid_weights(options.weights, grid.shape[:2]),
    }
    tol: Any = options.tol
    if isinstance(tol, list):
        if len(tol) != grid.shape[0] * grid.shape[1]:
            raise Error(
                f"--tol: expected {grid.shape[0]} x {grid.shape[1]} tolerances, found {len(tol)}"
            )
        import numpy as np

        tol = np.reshape(tol, grid.shape[:2])
    return fair(grid, tol, **chosen)  # type: ignore[return-value]


class _Grids(Source):
    """A Plot3D file."""

    def __init__(self, file: GridFile, options: argparse.Namespace) -> None:
        self.file = file
        count = len(file.grids)
        self.all = options.block is None and count > 1
        if options.units:
            raise Error("--units is for files of points")
        if options.seams and not self.all:
            raise Error("--seams: for the blocks of a Plot3D file that are faired together")
        if self.all:
            self.title = f"{file.path}: {count} blocks"
            return
        self.at = (options.block or 1) - 1
        if not 0 <= self.at < count:
            raise Error(f"--block: expected 1 to {count}, found {options.block}")
        m, n = file.grids[self.at].shape[:2]
        block = f", block {self.at + 1}" if count > 1 else ""
        self.title = f"{file.path}{block}: {m} x {n} points"

    def fair(self, options: argparse.Namespace) -> Result:
        if self.all:
            return self._patches(options)
        return fair_grid(self.file.grids[self.at], options.role or "control", options)

    def _patches(self, options: argparse.Namespace) -> PatchesFairing:
        from moldloft.fairing import patches

        refuse_curves_only(options)
        for name, given in (
            ("--tol FILE", isinstance(options.tol, list)),
            ("--spacing", options.spacing != "auto"),
            ("--closed", options.closed or options.closed_v),
            ("--mode", options.mode != "optimum"),
            ("--breaks", options.breaks),
            ("--fixed", options.fixed),
            ("--ends", options.ends),
            ("--knots", options.knots),
            ("--weights", options.weights),
            ("--through", options.through),
            ("--tangent", options.tangent),
            ("--normal", options.normal),
            ("--join", options.join),
            ("--keep", options.keep),
            ("--count", options.count),
            ("--log", options.log),
            ("--plot", options.plot),
            ("--output as .vts", Path(options.output or "").suffix.lower() == ".vts"),
        ):
            if given:
                raise Error(
                    f"{name}: `{self.file.path}` has {len(self.file.grids)} blocks; choose "
                    "one with --block"
                )
        rims: Any = options.rims
        if "=" in rims:
            rims = dict(word.partition("=")[::2] for word in rims.split(","))
        return patches(
            self.file.grids,
            options.tol,
            seams=options.seams or "curvature",
            as_=options.role or "fit",
            degree=options.degree,
            measure=options.measure or "second",
            bound=options.bound or "points",
            rims=rims,
            motion=words.motion(options),
            goal=options.goal,
        )

    def write(self, result: Any, path: Path) -> Path:
        if self.all:
            return self.file.write(path, result.grids)
        if path.suffix.lower() == ".vts":
            result.write_vtk(path)
            return path
        grids = list(self.file.grids)
        grids[self.at] = result.points
        return self.file.write(path, grids)


def _write_log(result: Any, path: Path) -> Path:
    log = getattr(result, "log", None)
    if log is None:
        raise Error("--log: only local steps of curves are written down")
    rows = ["point, x, y, z"]
    for index, to in zip(*log, strict=True):
        rows.append(", ".join([str(int(index) + 1), *(repr(float(c)) for c in to)]))
    return commit_file(path, ("\n".join(rows) + "\n").encode())

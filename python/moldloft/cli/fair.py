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
    from moldloft.fairing import Fairing, NetworkFairing, PatchesFairing, Spline, SurfaceFairing
    from moldloft.fairing.files import GridFile, PointFile

    Result = Fairing | SurfaceFairing | NetworkFairing | PatchesFairing

__all__ = ["add", "run"]

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
        help="largest distance from the original; 0 changes nothing; `none` for no limit; a file "
        "has one for each point",
    )
    parser.add_argument(
        "--as",
        dest="role",
        choices=["control", "points", "fit"],
        help="points are data on the curve (the default of the optimum), are moved themselves, or "
        "are control points, whose index is their parameter: the rule of the report of 1991",
    )
    parser.add_argument(
        "--closed", action="store_true", help="the last point joins the first; of surfaces along u"
    )
    parser.add_argument("--closed-v", action="store_true", help="the surface is closed along v")
    parser.add_argument(
        "--mode",
        choices=["optimum", "faithful", "literal", "vertex", "sweeps", "levels"],
        help="the optimum, with a certificate (the default); or local steps: knots removed "
        "and re-inserted, the report's literal rule, single points, sweeps, all wavelengths",
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
        help="points that are intended breaks; of surfaces rows, as in u5,v2; `auto` finds corners "
        "and wrong digits",
    )
    parser.add_argument("--fixed", metavar="I,J", default="", help="points that do not move")
    parser.add_argument(
        "--ends",
        metavar="END[,END]",
        help="kept at open ends: free, position, tangent, curvature or a number of points; of a "
        "network corners, ends or none",
    )
    parser.add_argument(
        "--rims",
        metavar="WORD|u0=WORD,..",
        default="corners",
        help="kept at rims of a surface: corners, position, tangent or curvature; of all, or of "
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
        help="polynomial degree; default: 3; of surfaces one or two",
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
        help="how far the first of the knots of a closed curve is from itself, once round",
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
        help="points stay in the planes across this direction",
    )
    parser.add_argument("--box", action="store_true", help="limit each coordinate separately")
    for word, place, what in (
        ("through", "T", "the curve passes through X,Y[,Z] at T, or the surface at U,V"),
        ("tangent", "T", "the curve runs along X,Y[,Z] at T"),
        ("normal", "U,V", "the surface's normal at U,V is along X,Y,Z"),
    ):
        parser.add_argument(
            f"--{word}",
            metavar=f"{place}=X,Y[,Z]",
            type=words.condition,
            action="append",
            default=[],
            help=f"{what}, parameters in [0, 1]; may be repeated",
        )
    parser.add_argument(
        "--join",
        metavar="FILE",
        action="append",
        default=[],
        help="points of a curve that shares an end with this one, which continues it "
        "with the same tangent and curvature (both fitted: --as fit); may be repeated",
    )
    parser.add_argument(
        "--keep",
        choices=["area", "volume", "centroid"],
        action="append",
        default=[],
        help="keep the area, the volume (of revolution about x; of a surface that between it and "
        "the original) or, of curves, the centroid, to first order; of a network of offsets the "
        "volume and its centroid",
    )
    parser.add_argument(
        "--spacing",
        metavar="WORD|X,Y[,Z]",
        type=words.spacing,
        default="auto",
        help="parameters of points: chord, centripetal, a coordinate (x, y, z) or a direction that "
        "they run along, index, or curvature (of single curves: lengths, longer where they turn; "
        "the default where one is to be near the truth, else chord)",
    )
    parser.add_argument(
        "--at", metavar="FILE", help="the parameters of the points themselves, rising, in [0, 1]"
    )
    parser.add_argument(
        "--goal",
        metavar="WORD[=SHARE]",
        type=words.goal,
        default="near",
        help="which of the results within the tolerance: near (the default: no fairer than noise "
        "of that size asks for, unmoved where there is little to gain), fairest, budget=SHARE of "
        "such noise, nearest=SHARE above the least, energy=MOST (the nearest that measures at "
        "most this), closest (the nearest that has the shapes asked for)",
    )
    parser.add_argument(
        "--shape",
        metavar="WORD[=I-J]",
        action="append",
        default=[],
        help="what shape the curve has: convex, concave, one-way (no inflection), straight, arc, "
        "each of the whole curve or between two points (arc=9-15; straight=1-9:0,1 in a "
        "direction); pieces=K of monotone curvature; within=X,Y:MOST; side=X,Y; may be repeated; "
        "of a network behind the name of a curve, `waterline 2: straight=3-9`, or of several, "
        "`waterline 2..waterline 5 at station 4..station 8: flat`",
    )
    parser.add_argument(
        "--release",
        metavar="auto|I,J",
        default="",
        help="points that are wrong and may be left; `auto`: the wrong digits that were found",
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
    parser.add_argument("--steps", type=int, help="local steps; of surfaces per point")
    parser.add_argument(
        "--stop",
        metavar="WORD[=SHARE]",
        type=words.stop,
        action="append",
        default=[],
        help="local steps end when a move is shorter than this share of the tolerance "
        "(move=SHARE), a step lowers the measure by less (drop=SHARE), the certified gap is below "
        "it (gap=SHARE), or a pass brings no fewer monotone pieces (pieces); may be repeated",
    )
    parser.add_argument(
        "--accuracy",
        metavar="SHARE",
        type=float,
        help="certified gap of the optimum of a curve, as a share of the measure; default: as "
        "small as rounding allows",
    )
    parser.add_argument(
        "--original",
        metavar="FILE",
        help="the points as they were first read, where FILE was faired already: tolerances are "
        "counted from these",
    )
    parser.add_argument(
        "--passes", type=int, help="passes of the faithful mode, which this implies"
    )
    parser.add_argument("--block", type=int, help="the block of a Plot3D file, from 1")
    parser.add_argument(
        "--units",
        choices=["m", "cm", "mm", "ft", "in"],
        help="what the numbers of a file of points are in; default: what it states. Splines are "
        "written with it",
    )
    parser.add_argument("-o", "--output", metavar="OUT", help="the faired points or surface")
    parser.add_argument("--plot", metavar="P.png", help="pictures of it; .png or .svg")
    parser.add_argument(
        "--report",
        metavar="P.html",
        help="one page about it: pictures to scale, every point and its move, the spline",
    )
    parser.add_argument("--log", metavar="FILE", help="the local steps, replayable, as CSV")
    parser.add_argument("--json", action="store_true", help="the report as data")
    parser.add_argument(
        "--set",
        metavar="NAME=NUMBER",
        type=assignment,
        action="append",
        default=[],
        help="a parameter of the model; may be repeated",
    )
    parser.add_argument("--library", metavar="DIR", action="append", default=[])


def _refuse_curves_only(options: argparse.Namespace) -> None:
    """Options of single curves; an error where they would be ignored."""
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


def _places(text: str, count: int | None = None, what: str = "--breaks") -> list[int]:
    """Numbers from 1 as indices."""
    out = []
    for word in filter(None, (w.strip() for w in text.split(","))):
        if not word.isdigit() or int(word) < 1 or (count is not None and int(word) > count):
            to = f" to {count}" if count else ""
            raise FairingError(f"{what}: expected points from 1{to}, found `{word}`")
        out.append(int(word) - 1)
    return out


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
            "warning: without a tolerance nothing keeps the result near the data: steps without "
            "end lead to a single polynomial",
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
    for file in files:
        print(f"wrote {file}")
    return 0


def _source(options: argparse.Namespace) -> _Source:
    name = options.file
    model, colon, thing = name.rpartition(":")
    if colon and thing and Path(model).suffix.lower() in (".sdl", ".ms2", ".mul"):
        return _Object(model, thing, options)
    path = Path(name)
    if path.suffix.lower() in (".sdl", ".ms2"):
        raise Error(f"which object of `{name}` is to be faired? write `{name}:NAME`")
    from moldloft.fairing.files import is_grid, read_grids, read_points

    if is_grid(path):
        return _Grids(read_grids(path), options)
    return _Points(read_points(path))


def _motion(options: argparse.Namespace) -> Any:
    given = [options.along is not None, options.across is not None, options.box]
    if sum(given) > 1:
        raise Error("--along, --across and --box: one of these")
    if options.across is not None:
        return "across", tuple(options.across)
    if options.along is not None:
        return tuple(options.along)
    return "box" if options.box else "ball"


def _ends(options: argparse.Namespace) -> Any:
    if options.ends is None:
        return None
    words = [w.strip() for w in options.ends.split(",")]
    ends = [int(w) if w.isdigit() else w for w in words]
    if len(ends) not in (1, 2):
        raise Error(f"--ends: expected one or two, found {len(ends)}")
    return ends[0] if len(ends) == 1 else tuple(ends)


class _Source(abc.ABC):
    """Data to fair: its source, and how the result is written."""

    title = ""

    @abc.abstractmethod
    def fair(self, options: argparse.Namespace) -> Result:
        """The result by these options."""

    def facts(self) -> dict[str, Any]:
        return {"source": self.title}

    def notes(self) -> list[str]:
        return []

    def stated(self) -> list[tuple[str, str]]:
        """What a page says besides the result: where it came from, and how to make it again."""
        import datetime

        command = shlex.join(["moldloft", *sys.argv[1:]])
        today = datetime.datetime.now().astimezone().date().isoformat()
        return [("source", self.title), ("command", command), ("date", today)]

    @abc.abstractmethod
    def write(self, result: Any, path: Path) -> Path:
        """Writes the result; the path that it was written to."""


def _numbers(path: str | None) -> list[float] | None:
    """The numbers of a file, in their order, with the line of one that is none."""
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


def _curve_options(options: argparse.Namespace, count: int, role: str) -> dict[str, Any]:
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
        breaks = _places(breaks, count)
    return {
        "closed": options.closed,
        "degree": options.degree,
        "measure": options.measure,
        "mode": options.mode,
        "bound": options.bound,
        "breaks": breaks,
        "fixed": _places(options.fixed, count, "--fixed"),
        "ends": _ends(options),
        "motion": _motion(options),
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
        else _places(options.release, count, "--release"),
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
    """The points that tolerances are counted from, where they are not those of the file."""
    if not options.original:
        return None
    from moldloft.fairing.files import read_points

    file = read_points(options.original)
    if len(file.points) != count:
        raise Error(
            f"--original: {options.original} has {len(file.points)} points, the file {count}"
        )
    return file.points


def _encode_curve(result: Fairing, path: Path, like: PointFile | None) -> bytes:
    from moldloft.fairing.files import points_text

    delimiter = {".csv": ",", ".tsv": "\t"}.get(path.suffix.lower(), " ")
    return points_text(result.points, like, delimiter).encode()


def _commit(path: Path, data: bytes) -> Path:
    from moldloft.files import Output, commit

    return commit(path.parent, [Output(path.name, data)])[0]


def _known_ending(path: Path, source: Path | None) -> None:
    """Refuses an ending that says nothing, before anything is written."""
    from moldloft.fairing.spline_files import POINTS, SPLINES

    ending = path.suffix.lower()
    known = (*POINTS, *SPLINES)
    if ending in known or (source is not None and ending == source.suffix.lower()):
        return
    raise Error(f"--output: `{path}`: expected an ending of {', '.join(known)}")


class _Points(_Source):
    """A file of points."""

    def __init__(self, file: PointFile) -> None:
        self.file = file
        self.said: list[str] = list(file.notes)
        self.title = str(file.path)
        self.unit = file.unit

    def fair(self, options: argparse.Namespace) -> Result:
        if options.units and self.file.unit not in (None, options.units):
            raise Error(
                f"--units {options.units}: the numbers of {self.file.path} are in {self.file.unit}"
            )
        self.unit = options.units or self.file.unit
        if self.file.offsets and self.file.inches:
            self.said.append(
                "stations and waterlines that are plain numbers are inches, too: "
                "write their places, if they are numbers of stations"
            )
        if self.file.offsets and _motion(options) == "ball":
            if self.file.moves == 2:
                self.said.append("heights move; stations and buttocks stay")
                options.along = [0.0, 0.0, 1.0]
            else:
                self.said.append("half-breadths move; stations and heights stay")
                options.along = [0.0, 1.0, 0.0]
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
        chosen = _curve_options(options, len(points), role)
        try:
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
        from moldloft.fairing import network

        _refuse_curves_only(options)
        for name, given in (
            ("--as", options.role not in (None, "points")),
            ("--closed", options.closed or options.closed_v),
            ("--through", options.through),
            ("--tangent", options.tangent),
            ("--normal", options.normal),
            ("--join", options.join),
            ("--rims", options.rims != "corners"),
            ("--count", options.count),
            ("--knots", options.knots or options.knots_v),
            ("--weights", options.weights),
            ("--seams", options.seams),
            ("--log", options.log),
            ("--degree with two numbers", not isinstance(options.degree, int)),
        ):
            if given:
                raise Error(
                    f"{name}: not for networks; {self.file.path} has {len(self.file.blocks)} curves"
                )
        places: dict[bytes, int] = {}
        rows: list[int] = []
        self.of_row: list[int] = []
        for k, point in enumerate(self.file.points):
            key = (point + 0.0).tobytes()
            if key not in places:
                places[key] = len(rows)
                rows.append(k)
            self.of_row.append(places[key])
        curves = [[self.of_row[i] for i in block] for block in self.file.blocks]
        first = [rows.index(rows[k]) for k in range(len(rows))]
        assert first == list(range(len(rows)))
        names, called = self._names(curves, rows)
        marks: list[int | str] | str = (
            "auto" if options.breaks == "auto" else self._breaks(options.breaks, names)
        )
        fixed: Any = options.ends or "corners"
        if options.fixed:
            fixed = [self.of_row[i] for i in _places(options.fixed, len(self.file.points))]
        try:
            result = network(
                self.file.points[rows],
                curves,
                self._tolerances(options, rows),
                degree=options.degree,
                measure=options.measure or "third",
                mode=options.mode,
                spacing="chord" if options.spacing == "auto" else options.spacing,
                goal=options.goal,
                names=names,
                shape=options.shape,
                breaks=marks,
                release="auto"
                if options.release == "auto"
                else [
                    self.of_row[i]
                    for i in _places(options.release, len(self.file.points), "--release")
                ],
                fixed=fixed,
                motion=_motion(options),
                keep=options.keep,
                bound="curve" if options.bound == "curve" else "points",
                passes=options.passes or 1,
                steps=options.steps,
            )
        except FairingError as error:
            if error.index is not None and error.index < len(rows):
                error = FairingError(str(error), index=rows[error.index])
            raise self._placed(error) from error
        if self.file.offsets:
            result = replace(result, point_names=called)
            if self.file.moves == 1:
                self._across(result, rows)
        return result

    def _breaks(self, text: str, names: list[str]) -> list[int | str]:
        """Numbers of rows, and names of curves along which others break."""
        out: list[int | str] = []
        for word in filter(None, (w.strip() for w in text.split(","))):
            if word in names:
                out.append(word)
            else:
                out += [self.of_row[i] for i in _places(word, len(self.file.points))]
        return out

    def _names(self, curves: list[list[int]], rows: list[int]) -> tuple[list[str], tuple[str, ...]]:
        """What the curves and points of a table are called: stations and waterlines."""
        if not self.file.offsets:
            return [], ()
        other = 3 - self.file.moves
        word = "waterline" if other == 2 else "buttock"
        points = self.file.points[rows]
        names = []
        for own in curves:
            first, second = points[own[0]], points[own[1]]
            station = first[0] == second[0]
            names.append(f"station {first[0]:g}" if station else f"{word} {first[other]:g}")
        called = tuple(f"station {p[0]:g}, {word} {p[other]:g}" for p in points)
        return names, called

    def _tolerances(self, options: argparse.Namespace, rows: list[int]) -> Any:
        """One tolerance, or that of each different point."""
        if not isinstance(options.tol, list):
            return options.tol
        found = len(options.tol)
        if found == len(rows):
            return options.tol
        if found != len(self.file.points):
            raise Error(
                f"--tol: expected {len(rows)} tolerances, one for each different point, or "
                f"{len(self.file.points)}, one for each row of the curves, found {found}"
            )
        return [options.tol[k] for k in rows]

    def _across(self, result: NetworkFairing, rows: list[int]) -> None:
        """Half-breadths that were not below zero and are now."""
        new, old = result.points[:, 1], self.file.points[rows][:, 1]
        over = (new < 0) & (old >= 0)
        if over.any():
            count, most = int(over.sum()), float(-new[over].min())
            word = "half-breadth is" if count == 1 else "half-breadths are"
            self.said.append(
                f"{count} {word} beyond the centreline now, by {most:.2e} at most; "
                "`--fixed` keeps points"
            )

    def notes(self) -> list[str]:
        return self.said

    def stated(self) -> list[tuple[str, str]]:
        return [*super().stated(), ("unit", self.unit or "not stated")]

    def facts(self) -> dict[str, Any]:
        return {"source": self.title, "source_notes": self.said, "unit": self.unit}

    def write(self, result: Any, path: Path) -> Path:
        import numpy as np

        from moldloft.fairing.files import points_text
        from moldloft.fairing.spline_files import SPLINES, encoded

        _known_ending(path, self.file.path)
        if path.suffix.lower() in SPLINES:
            curves = result.curves if hasattr(result, "lists") else [result.spline]
            if self.unit is None and path.suffix.lower() in (".igs", ".iges"):
                self.said.append(f"{path} says millimetres: no unit is stated; name it by --units")
            return _commit(path, encoded(curves, path, self.unit))
        if hasattr(result, "lists"):
            rows = result.points[self.of_row]
            like: PointFile = self.file
            if like.table is not None:
                # Each row of the table once, as it stood.
                table = like.table.copy()
                table[like.places] = rows
                rows, like = table, replace(like, blocks=[range(len(table))])
            return _commit(path, points_text(rows, like).encode())
        points = result.points
        if self.closing:
            points = np.concatenate([points, points[:1]])
        same = path.suffix.lower() == self.file.path.suffix.lower()
        form = self.file if same else None
        delimiter = {".csv": ",", ".tsv": "\t"}.get(path.suffix.lower(), " ")
        return _commit(path, points_text(points, form, delimiter).encode())


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


def _fair_grid(grid: Any, role: str, options: argparse.Namespace) -> SurfaceFairing:
    from moldloft.fairing import fair

    _refuse_curves_only(options)
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
        "motion": _motion(options),
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


class _Grids(_Source):
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
        return _fair_grid(self.file.grids[self.at], options.role or "control", options)

    def _patches(self, options: argparse.Namespace) -> PatchesFairing:
        from moldloft.fairing import patches

        _refuse_curves_only(options)
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
            motion=_motion(options),
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


class _Object(_Source):
    """An object of a model: a curve, a surface, or rows of points."""

    def __init__(self, model: str, name: str, options: argparse.Namespace) -> None:
        from moldloft.fairing.objects import sampled
        from moldloft.loading import load

        if isinstance(options.tol, list):
            raise Error("--tol FILE is for points: those of an object are sampled")
        if options.units:
            raise Error("--units is for files of points: a model states its own")
        loaded = load(model, library=options.library)
        if options.set:
            loaded.set(dict(options.set))
        self.title = f"{model}:{name}"
        self.unit = loaded.length_unit[0]
        self.made = sampled(loaded, name, options.tol)
        self.error = self.made.error

    def fair(self, options: argparse.Namespace) -> Result:
        from moldloft.fairing import fair

        made = self.made
        if made.points.ndim == 3:
            return _fair_grid(made.points, options.role or made.role, options)
        if made.closed:
            options.closed = True
        chosen = _curve_options(options, len(made.points), options.role or made.role)
        if not options.breaks and made.breaks:
            chosen["breaks"] = made.breaks
        if made.role == "fit" and not made.breaks:
            chosen["spacing"] = "index"
        if (options.role or made.role) == "fit" and options.mode == "optimum":
            # The object itself is what the tolerance is about, between its points too.
            chosen["bound"] = options.bound or "curve"
        return fair(made.points, options.tol, as_=options.role or made.role, **chosen)

    def facts(self) -> dict[str, Any]:
        return {"source": self.title, "fit_error": self.error}

    def notes(self) -> list[str]:
        if self.error is None:
            return []
        count = " x ".join(str(n) for n in self.made.points.shape[:-1])
        return [
            f"{count} points of the object were fitted; between them it is {self.error:.2e} off"
        ]

    def write(self, result: Any, path: Path) -> Path:
        if self.made.points.ndim == 3:
            if path.suffix.lower() == ".vts":
                result.write_vtk(path)
                return path
            from moldloft.grids import write_plot3d

            return write_plot3d(path, [result.points])
        from moldloft.fairing.spline_files import SPLINES, encoded

        _known_ending(path, None)
        if path.suffix.lower() in SPLINES:
            return _commit(path, encoded([result.spline], path, self.unit))
        return _commit(path, _encode_curve(result, path, None))


def _write_log(result: Any, path: Path) -> Path:
    log = getattr(result, "log", None)
    if log is None:
        raise Error("--log: only local steps of curves are written down")
    rows = ["point, x, y, z"]
    for index, to in zip(*log, strict=True):
        rows.append(", ".join([str(int(index) + 1), *(repr(float(c)) for c in to)]))
    return _commit(path, ("\n".join(rows) + "\n").encode())

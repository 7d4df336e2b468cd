"""``moldloft build``: run, evaluate, mesh, measure, write."""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path
from typing import Any

from moldloft.cli.colour import painted
from moldloft.cli.console import (
    Progress,
    add_force,
    add_model,
    add_name,
    add_quiet,
    block_problems,
    each_model,
    emit,
    format_argument,
    open_model,
    report,
    say,
    stem_of,
    water,
)
from moldloft.display import worst_panel
from moldloft.errors import Error, ModelError
from moldloft.hydro.hydrostatics import Hydrostatics, rounded_to_bound
from moldloft.models import Model
from moldloft.shapes.mesh import Mesh, Patch
from moldloft.text_table import table, terminal_width

__all__ = ["add", "facts", "run", "summary", "worst_panels"]

_POLL_SECONDS = 0.2


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    from moldloft.exchange.files import FORMATS

    add_model(parser, several=True)
    files = parser.add_argument_group("Files")
    files.add_argument(
        "--to",
        metavar="FORMAT",
        nargs="+",
        action="extend",
        type=format_argument,
        default=[],
        help="files to write: " + ", ".join(FORMATS) + "; `moldloft formats` describes them",
    )
    files.add_argument(
        "-o",
        "--output",
        metavar="PATH",
        default=".",
        help="folder for the files; default: the current one; for one format of one model also the "
        "file, such as hull.stl, or - for standard output",
    )
    add_name(files)
    files.add_argument(
        "--united", action="store_true", help="one skin of the panels of bodies that overlap"
    )
    files.add_argument(
        "--keep-going",
        action="store_true",
        help="write as much as possible: the other formats, and the model without the objects that "
        "could not be made, which are named; the status is still 1",
    )
    add_force(files)
    figures = parser.add_argument_group("Figures")
    figures.add_argument(
        "--level", metavar="Z", type=float, default=0.0, help="height of the water, by default 0"
    )
    figures.add_argument(
        "--density",
        metavar="WATER",
        type=water,
        help="of the water: salt, fresh, or mass per volume in the model's units",
    )
    figures.add_argument(
        "-v", "--verbose", action="store_true", help="all measured figures, not the main ones only"
    )
    figures.add_argument(
        "--sides",
        choices=["both", "one"],
        default="both",
        help="figures of both sides of a mirrored model (the default), or of one side",
    )
    figures.add_argument(
        "--quality", action="store_true", help="the worst panels of each patch, with their indices"
    )
    figures.add_argument("--json", action="store_true", help="one object instead of the table")
    panels = parser.add_argument_group("Panels in files")
    panels.add_argument(
        "--lids", action="store_true", help="include lids in the files of panel codes"
    )
    panels.add_argument(
        "--immersed",
        action="store_true",
        help="cut at z = 0 and write only the part below, in the files of panel codes",
    )
    panels.add_argument(
        "--whole",
        action="store_true",
        help="both sides of a symmetric model, joined, in files of plain panels (STL, OBJ, ...)",
    )
    panels.add_argument(
        "--triangles", action="store_true", help="triangles only, in files of plain panels"
    )
    panels.add_argument(
        "--tolerance",
        metavar="LENGTH",
        type=float,
        help="in files of panels, how far panels may be from their surfaces; in those of surfaces, "
        "how far fits may be off",
    )
    panels.add_argument(
        "--angle",
        metavar="DEGREES",
        type=float,
        help="in files of panels, the largest turn of a surface along a panel",
    )
    panels.add_argument(
        "--tag",
        metavar="TAG",
        nargs="+",
        action="extend",
        default=[],
        help="only patches with one of these tags, in the table and in the files",
    )
    add_quiet(parser)
    parser.add_argument(
        "--watch", action="store_true", help="rebuild on save, with a picture; Ctrl-C ends"
    )


def run(options: argparse.Namespace) -> int:
    """Builds once, or at every save."""
    if options.output == "-" and (len(options.to) != 1 or options.watch or options.json):
        raise Error("-o - takes one format, without --json and --watch: its file is the output")
    if options.output != "." and not options.to:
        raise Error("-o without --to writes nothing\nhelp: name the formats, such as --to stl")
    _name_of_file(options)
    if not options.watch:
        return each_model(options, _build)
    (options.model,) = options.models[:1]
    if len(options.models) > 1:
        raise Error("--watch takes one model")
    if "png" not in options.to:
        options.to.append("png")
    from moldloft.storage import Watch

    watch = Watch(sources := [options.model])
    while True:
        watch.begin()
        try:
            sources = _build_watched(options)
        except Error as error:
            # The model still depends on the files read before.
            print(error.rendered, file=sys.stderr)
        watch.end(sources)
        print(f"watching {', '.join(sources)}", file=sys.stderr)
        while not watch.changed():
            time.sleep(_POLL_SECONDS)


def _name_of_file(options: argparse.Namespace) -> None:
    """Divides an output that is a file of the one format into its folder and its stem."""
    from moldloft.exchange.files import file_name

    path = Path(options.output)
    if len(options.to) != 1 or len(options.models) != 1 or options.name is not None:
        return
    if path.suffix and file_name(path.stem, options.to[0]) == path.name and not path.is_dir():
        options.output, options.name = str(path.parent), path.stem


def _build_watched(options: argparse.Namespace) -> list[str]:
    sources: list[str] = []
    _build(options, sources)
    return sources or [options.model]


def _build(
    options: argparse.Namespace, sources: list[str] | None = None
) -> tuple[int, dict[str, Any]]:
    from moldloft.exchange.files import Output, file_name, produce
    from moldloft.formats import formats
    from moldloft.permissions import write_outputs

    with Progress() as progress:
        progress.stage(f"running {options.model}")
        model = open_model(options)
        if sources is not None:
            sources.extend(model.sources)
        if model.has_errors and not (options.keep_going and _is_partly_made(model)):
            progress.stage("reporting")
            return _report_errors(model, options)
        model.partial = options.keep_going
        if options.united:
            progress.stage("uniting")
            model = model.united()
        progress.stage("making panels")
        mesh = model.mesh(tags=options.tag)
        progress.stage("measuring")
        patches = mesh.patches
        floating, leaks = None, ""
        if patches:
            try:
                floating = model.hydrostatics(
                    level=options.level, density=options.density, sides=options.sides
                )
            except ModelError as error:
                if error.diagnostics[0].id != "open-below-water":
                    raise
                leaks = f"{error.diagnostics[0].message} at z = {_number(options.level)}"

        outputs: list[Output] = []
        halves: list[str] = []
        refused: list[tuple[str, Error]] = []
        inexact: list[Any] = []
        folder = Path("." if options.output == "-" else options.output)
        stem = stem_of(options) if options.to else ""
        chosen = list(dict.fromkeys(options.to))
        for number, name in enumerate(chosen):
            progress.stage("writing", name, number / len(chosen))
            path = folder / file_name(stem, name)
            row = formats()[name]
            lids = options.lids and row.lids
            immersed = options.immersed and row.immersed
            near: dict[str, Any] = {}
            plain = {"whole": options.whole, "triangles": options.triangles}
            of_panels = row.holds.startswith("panels")
            if of_panels and options.angle is not None:
                near["angle"] = math.radians(options.angle)
            if (of_panels or row.holds == "surfaces") and options.tolerance is not None:
                near["tolerance"] = options.tolerance
            try:
                outputs += produce(
                    model,
                    name,
                    path,
                    lids=lids,
                    immersed=immersed,
                    tags=options.tag,
                    **near,
                    **(plain if row.plain_panels else {}),
                )
            except Error as error:
                refused.append((name, error))
                continue
            inexact += [d for d in model.export_remarks if not row.writer and d.severity == "note"]
            if row.plain_panels and model.symmetry and not options.whole:
                halves.append(name)
        if refused and (not options.keep_going or not outputs):
            raise _refusals(refused, options)
        if options.output == "-":
            if len(outputs) > 1:
                names = ", ".join(output.name for output in outputs)
                raise Error(f"{options.to[0]} is several files: {names}; give a folder with -o")
            emit("-", outputs[0].data)
            outputs = []
        written = write_outputs(
            folder,
            {output.name: output.data for output in outputs},
            sources=[options.model, *model.sources],
            force=options.force,
        )
    # Remarks of the panelling have joined those of the run.
    report(model.diagnostics)
    report(list({str(d): d for d in inexact}.values()))
    if mesh.patches and not mesh.closed:
        report(model.junctions())
    report(block_problems(model))
    if options.to and not model.objects:
        # An empty file is easily taken for one that is right.
        print(f"warning: {options.model}: it has no objects; its files are empty", file=sys.stderr)
    data = facts(model, mesh, floating, written)
    data["closure"] = mesh.closure(level=options.level)
    data["one_side"] = halves
    if leaks:
        data["no_hydrostatics"] = leaks
    missing = _missing(model)
    if model.has_errors:
        data["ok"] = False
        lack = f" without {', '.join(missing)}, which could not be made" if missing else ""
        print(
            f"{options.model}: has errors; what is written is{lack or ' what was made'}",
            file=sys.stderr,
        )
    if floating is not None:
        units = {name: floating.unit(name) for name in data["hydrostatics"]}
        data["units"] = {name: unit for name, unit in units.items() if unit}
    if refused:
        data["ok"] = False
        data["refused"] = {name: str(error) for name, error in refused}
        print(painted(_refusals(refused, options).rendered, sys.stderr), file=sys.stderr)
    if not options.json:
        say(options, summary(model, mesh, floating, data, verbose=options.verbose))
        if options.quality:
            say(options, "\n" + worst_panels(mesh))
            if floating is not None:
                say(options, "\n" + _panels_against_shape(model, floating, options))
    return (1 if refused or model.has_errors else 0), data


def _is_partly_made(model: Model) -> bool:
    """True if all errors are of objects and other objects are valid."""
    own = all(d.object for d in model.diagnostics if d.is_error)
    return own and any(o["ok"] for o in _objects(model))


def _missing(model: Model) -> list[str]:
    """The failed objects, including those of unknown kinds."""
    blocked = [d.object for d in model.diagnostics if d.is_error and d.object]
    failed = [o["name"] for o in _objects(model) if not o["ok"]]
    return list(dict.fromkeys(failed + blocked))


def _refusals(refused: list[tuple[str, Error]], options: argparse.Namespace) -> Error:
    """All formats that cannot be written, as one error."""
    if len(refused) == 1 and (options.keep_going or len(options.to) == 1):
        return refused[0][1]
    text = "\n".join(f"{name}: {str(error).rstrip()}" for name, error in refused)
    if not options.keep_going and len(refused) < len(set(options.to)):
        text += "\nhelp: --keep-going writes the other formats"
    return Error(text)


def _report_errors(model: Model, options: argparse.Namespace) -> tuple[int, dict[str, Any]]:
    report(model.diagnostics)
    objects = _objects(model)
    if not options.json:
        wrong = sum(d.is_error for d in model.diagnostics)
        failed = sum(not o["ok"] for o in objects)
        words = [f"{wrong} error{'s' * (wrong != 1)}"]
        if failed:
            words.append(f"{failed} object{'s' * (failed != 1)} not made")
        say(options, f"{options.model}: {', '.join(words)}; nothing was written")
    return 1, {
        "ok": False,
        "objects": objects,
        "meshes": [],
        "total": None,
        "hydrostatics": None,
        "files": [],
        "diagnostics": [d.to_dict() for d in model.diagnostics],
    }


def _objects(model: Model) -> list[dict[str, Any]]:
    keys = ("name", "kind", "class", "ok", "parents")
    facts = (model.facts(name) for name in model.objects)
    return [{key: fact[key] for key in keys} for fact in facts]


def facts(
    model: Model, mesh: Mesh, floating: Hydrostatics | None, written: list[Path]
) -> dict[str, Any]:
    """Data printed by ``build --json``."""
    return {
        "ok": True,
        "objects": _objects(model),
        "params": {p.name: p.value for p in model.params.values()},
        "symmetry": model.symmetry,
        "meshes": [_patch_facts(patch) for patch in mesh.patches],
        "total": mesh.summary,
        "hydrostatics": floating.as_dict() if floating else None,
        "files": [{"path": str(path), "bytes": path.stat().st_size} for path in written],
        "diagnostics": [d.to_dict() for d in model.diagnostics],
    }


def _patch_facts(patch: Patch) -> dict[str, Any]:
    return {
        "name": patch.name,
        "kind": patch.kind,
        "tag": patch.tag,
        "tags": patch.tags,
        "divisions": patch.divisions,
        "panels": patch.panels,
        "vertices": patch.vertices,
        "closed": patch.closed,
        "area": patch.area,
        "volume": patch.volume,
        "quality": patch.quality,
    }


def summary(
    model: Model,
    mesh: Mesh,
    floating: Hydrostatics | None,
    data: dict[str, Any],
    *,
    verbose: bool = False,
) -> str:
    """Text printed by ``build``: patches, the whole, hydrostatics, files."""
    lines = [f"{len(data['objects'])} objects, {mesh!r}"]
    if mesh.patches:
        header = ["patch", "kind", "panels", "vertices", "area", "volume", "closed"]
        header += ["aspect", "skew", "warp"]
        rows = [_row(patch) for patch in mesh.patches]
        total = mesh.summary
        whole = [str(total["panels"]), str(total["vertices"]), _number(total["area"])]
        volume = total["volume"] if total["closed"] else None
        whole += [_number(volume), _yes(total["closed"])]
        rows.append(["whole", "", *whole, "", "", ""])
        lines += ["", table(header, rows, left=2, width=terminal_width())]
        lines += _openings(mesh, data)
    if floating is not None and (verbose or _floats(floating)):
        lines += ["", _floating(floating) if verbose else _main_figures(floating)]
    if "no_hydrostatics" in data:
        lines += [
            "",
            f"no hydrostatics: {data['no_hydrostatics']} (moldloft hydro names the edges)",
        ]
    if data["files"]:
        lines.append("")
        lines += [f"wrote {file['path']} ({_bytes(file['bytes'])})" for file in data["files"]]
    if data.get("one_side"):
        names = ", ".join(data["one_side"])
        lines.append(f"{names}: one side of the symmetric model; --whole writes both, joined")
    return "\n".join(lines)


def _floats(floating: Hydrostatics) -> bool:
    """True if the water plane cuts the skin."""
    return floating.volume > 0 and floating.waterplane_area is not None


_MAIN = ["volume", "displacement", "wetted_area", "draft", "lcb", "vcb", "waterplane_area"]
_MAIN += ["waterline_length", "waterline_beam", "kmt", "cb", "cp"]


def _main_figures(floating: Hydrostatics) -> str:
    sides = {"both": "both sides", "one": "one side", "whole": "the whole body"}[floating.sides]
    words = []
    for name in _MAIN:
        value = rounded_to_bound(floating, name)
        if value is not None:
            words.append(f"{name} {value:.5g} {floating.unit(name)}".rstrip())
    text = f"hydrostatics at z = {_number(floating.level)}, {sides} (all: -v, or moldloft hydro)"
    lines = [", ".join(words[k : k + 4]) for k in range(0, len(words), 4)]
    return "\n  ".join([text, *lines, *floating.remarks])


def _panels_against_shape(model: Model, floating: Hydrostatics, options: argparse.Namespace) -> str:
    panels = model.panel_figures(options.level)
    count = 0.5 if options.sides == "one" and "y" in model.symmetry else 1.0
    words = []
    for name, value in panels.items():
        shape = getattr(floating, name)
        if shape:
            words.append(f"{name} {100 * (count * value / shape - 1):+.3g} %")
    return "panels against the shape: " + ", ".join(words)


def _row(patch: Patch) -> list[str]:
    worst = [worst_panel(patch, name) for name in ("aspect", "skew", "warp")]
    volume = _number(patch.volume if patch.closed else None)
    counts = [str(patch.panels), str(patch.vertices)]
    return [
        patch.name,
        patch.kind,
        *counts,
        _number(patch.area),
        volume,
        _yes(patch.closed),
        *worst,
    ]


def _openings(mesh: Mesh, data: dict[str, Any]) -> list[str]:
    closure = data.get("closure") or mesh.closure()
    lines = []
    for edge in closure["edges"]:
        closed_by = f", closed by {edge['closed_by']}" if edge["closed_by"] else ""
        where = f"{edge['panels']} panel edges of {edge['patch']}, {edge['edge']}"
        lines.append(f"open edge: {where}, length {_number(edge['length'])}{closed_by}")
    if closure["edges"] and closure["closed_with_lids_and_mirror"]:
        lines.append("closed with lids and mirror")
    return lines


_MEASURES = {"aspect": "max", "skew": "max", "warp": "max", "jump": "max", "angle": "min"}


def worst_panels(mesh: Mesh) -> str:
    """The worst panel of each patch in each measure, with its position."""
    header = ["patch", *_MEASURES, "without area"]
    rows = []
    for patch in mesh.patches:
        row = [patch.name]
        for name, end in _MEASURES.items():
            measure = patch.quality.get(name)
            if measure is None or "panel" not in measure:
                row.append("-")
                continue
            place = measure["place"]
            where = f"({place[0]}, {place[1]})" if place else f"#{measure['panel']}"
            row.append(f"{measure[end]:.3g} at {where}")
        rows.append([*row, str(patch.quality.get("without_area", 0))])
    text = table(header, rows, width=terminal_width())
    return f"worst panels, by (i, j) along u and v\n{text}"


def _floating(floating: Hydrostatics) -> str:
    sides = {"both": "both sides", "one": "one side", "whole": "the whole body"}[floating.sides]
    lines = [f"hydrostatics at z = {_number(floating.level)}, {sides}"]
    hidden = {"level", "sides", "open_edges", "closure_error", "waterplane_error", "outward"}
    hidden |= {"trim", "heel", "status", "iterations", "residual"}
    hidden |= {"draft_low_x", "draft_mid", "draft_high_x", "weight"}
    hidden |= {"bounds", "lolls", "waterplane_product", "accuracy"}
    figures = {k: v for k, v in floating.as_dict().items() if k not in hidden}
    width = max(map(len, figures))
    for name in figures:
        value = rounded_to_bound(floating, name)
        bound = f" ± {floating.bounds[name]:.1g}" if name in floating.bounds else ""
        text = f"{_number(value)} {floating.unit(name)}".rstrip()
        lines.append(f"  {name.ljust(width)}  {text}{bound}")
    lines += [f"  {remark}" for remark in floating.remarks]
    return "\n".join(lines)


def _number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, (int, float)) else "-"


def _yes(value: object) -> str:
    return "yes" if value else "no"


def _bytes(count: int) -> str:
    return f"{count} B" if count < 10_000 else f"{count / 1000:.0f} kB"

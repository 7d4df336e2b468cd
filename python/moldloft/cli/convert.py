"""``moldloft convert``: programs, offsets, CAD files and drawings into every other format."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from moldloft.cli.console import (
    add_model,
    emit,
    format_argument,
    open_model,
    put_text,
    report,
    stem_of,
)
from moldloft.errors import Error

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    from moldloft.exchange.files import FORMATS

    add_model(parser)
    parser.add_argument(
        "--to",
        metavar="FORMAT",
        type=format_argument,
        help="default: that of -o, else the other one of sdl and ms2: "
        + ", ".join(FORMATS)
        + "; `moldloft formats` describes them",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="default: standard output, for text")
    parser.add_argument(
        "--units",
        dest="model_units",
        choices=["m", "cm", "mm", "ft", "in"],
        help="the model's unit, into which lengths of CAD files, drawings, meshes are converted; "
        "default: m, for meshes the unit of the file",
    )
    parser.add_argument(
        "--curves",
        choices=["CCurve", "BCurve"],
        default="CCurve",
        help="stations of a table of offsets: through the points (the default) or drawn by them",
    )
    parser.add_argument(
        "--closed",
        action="store_true",
        help="close the hull of a table of offsets by deck, transom and flat keel",
    )
    parser.add_argument(
        "--keep-going",
        action="store_true",
        help="panels for a code although the skin is open below the water",
    )


def run(options: argparse.Namespace) -> int:
    """Converts; content that the other format cannot represent is an error or a remark."""
    from moldloft.exchange.files import commit, ending, format_named, produce
    from moldloft.formats import formats
    from moldloft.permissions import check_not_source

    target = Path(options.output) if options.output not in (None, "-") else None
    if target is not None:
        check_not_source(target, [options.model])
    named = ending(target) if target else ""
    from moldloft.cad.importing import ENDINGS

    if options.model.lower().endswith((*ENDINGS, ".dxf", ".svg")):
        return _from_cad(options, target, format_named(options.to or named or "sdl"))
    if options.model.lower().endswith(".csv"):
        return _from_offsets(options, target, format_named(options.to or named or "sdl"))
    model = open_model(options)
    report(model.diagnostics)
    model.partial = options.keep_going
    other = "ms2" if options.model.lower().endswith(".sdl") else "sdl"
    form = format_named(options.to or named or other)
    # Text carries what is not built for want of another program's entity; the rest is as it was.
    carried = form in ("sdl", "ms2") and all(
        d.id == "blocked" for d in model.diagnostics if d.severity == "error"
    )
    if model.has_errors and not carried:
        return 1
    if target is not None:
        commit(target.parent, produce(model, form, target))
    elif form in ("sdl", "ms2"):
        put_text(model.convert(form))
    elif formats()[form].text:
        (output,) = produce(model, form, Path(f"{stem_of(options)}.{form}"))
        put_text(output.data.decode())
    elif options.output == "-":
        files = produce(model, form, Path(f"{stem_of(options)}.{form}"))
        if len(files) > 1:
            raise Error(f"{form} is several files: name the first with -o")
        emit("-", files[0].data)
    else:
        raise Error(
            f"{form} is binary and cannot be printed: name the file with -o; `-o -` prints it"
        )
    return 0


def _from_cad(options: argparse.Namespace, target: Path | None, form: str) -> int:
    from moldloft.exchange.files import Output, commit, produce
    from moldloft.loading import loads

    model = None
    if options.model.lower().endswith((".dxf", ".svg")):
        from moldloft.overlays.reading import program

        text, remarks = program(options.model, units=options.model_units or "m")
        texts = {target.name if target else "": text}
    elif form == "sdl" and target is not None:
        from moldloft.cad.importing import programs

        texts, remarks = programs(options.model, target.name, units=options.model_units or "m")
    else:
        from moldloft.cad.importing import imported

        text, model, remarks = imported(options.model, units=options.model_units or "m")
    for remark in remarks:
        print(f"warning: {options.model}: {remark}", file=sys.stderr)
    if form == "sdl":
        if target is None:
            put_text(text)
        else:
            commit(target.parent, [Output(name, t.encode()) for name, t in texts.items()])
        return 0
    if target is None:
        raise Error(f"name the {form} file with -o")
    if model is None:
        model = loads(text, name=f"{Path(options.model).stem}.sdl")
    model.partial = options.keep_going
    commit(target.parent, produce(model, form, target))
    return 0


def _from_offsets(options: argparse.Namespace, target: Path | None, form: str) -> int:
    from moldloft import offsets
    from moldloft.exchange.files import Output, commit, produce
    from moldloft.loading import loads

    text = offsets.read(options.model).program(curves=options.curves, closed=options.closed)
    if form == "sdl":
        if target is None:
            put_text(text)
        else:
            commit(target.parent, [Output(target.name, text.encode())])
        return 0
    model = loads(text, name=f"{Path(options.model).stem}.sdl")
    model.partial = options.keep_going
    if target is None:
        raise Error(f"name the {form} file with -o")
    commit(target.parent, produce(model, form, target))
    return 0

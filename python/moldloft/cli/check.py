"""``moldloft check``: diagnostics only."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from moldloft import ModelError
from moldloft.cli.console import (
    Progress,
    add_model,
    add_quiet,
    block_problems,
    each_model,
    open_model,
    report,
    say,
)

if TYPE_CHECKING:
    from moldloft import Diagnostic

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser, several=True)
    add_quiet(parser)
    parser.add_argument(
        "--quality",
        action="store_true",
        help="also report unjoined corners, open edges and the worst panels of each patch",
    )
    parser.add_argument("--json", action="store_true", help="diagnostics as data")


def run(options: argparse.Namespace) -> int:
    """Checks each model."""
    return each_model(options, _check)


def _check(options: argparse.Namespace) -> tuple[int, Any]:
    with Progress() as progress:
        progress.stage(f"checking {options.model}")
        model = open_model(options)
        mesh = None
        cells: list[Diagnostic] = []
        if not any(d.is_error for d in model.diagnostics):
            # Contradictions of joins are known after the division of panels and cells.
            progress.stage("dividing")
            model.partial = True
            mesh = model.mesh()
            cells = block_problems(model)
        diagnostics = [*model.diagnostics, *cells]
        if mesh is not None and mesh.patches and not mesh.closed:
            progress.stage("looking for edges that are not joined")
            diagnostics += model.junctions()
        if mesh is not None and mesh.patches:
            diagnostics += model.inner_skins()
            try:
                diagnostics += model.folded_surfaces()
            except ModelError as error:
                diagnostics += error.diagnostics
        if not options.quality:
            mesh = None
    errors = sum(d.is_error for d in diagnostics)
    data: dict[str, Any] = {}
    if options.json:
        data = {"ok": errors == 0, "diagnostics": [d.to_dict() for d in diagnostics]}
        if mesh is not None:
            data |= {"quality": mesh.quality(), "closure": mesh.closure()}
    else:
        report(diagnostics)
        count = len(model.objects)
        if errors == 0:
            say(options, f"{options.model}: {count} object{'s' * (count != 1)}, no errors")
        if mesh is not None and mesh.patches:
            from moldloft.cli.build import worst_panels

            print(worst_panels(mesh))
            for edge in mesh.closure()["edges"]:
                closed_by = f", closed by {edge['closed_by']}" if edge["closed_by"] else ""
                print(f"open edge: {edge['patch']}, {edge['edge']}{closed_by}")
    return (1 if errors else 0), data

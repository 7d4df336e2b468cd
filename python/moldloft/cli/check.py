"""``moldloft check``: diagnostics only."""

from __future__ import annotations

import argparse

from moldloft.cli.console import Progress, add_model, open_model, print_json, report

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    parser.add_argument("--json", action="store_true", help="diagnostics as data")


def run(options: argparse.Namespace) -> int:
    """Checks the model."""
    with Progress() as progress:
        progress.stage(f"checking {options.model}")
        model = open_model(options)
        diagnostics = model.diagnostics
    errors = sum(d.is_error for d in diagnostics)
    if options.json:
        print_json({"ok": errors == 0, "diagnostics": [d.to_dict() for d in diagnostics]})
    else:
        report(diagnostics)
        if errors == 0:
            print(f"{options.model}: {len(model.objects)} objects, no errors")
    return 1 if errors else 0

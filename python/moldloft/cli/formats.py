"""``moldloft formats``: formats that models are written in."""

from __future__ import annotations

import argparse
from dataclasses import asdict

from moldloft.cli.console import print_json
from moldloft.text_table import table, terminal_width

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument("--json", action="store_true", help="one list of the rows")


def run(options: argparse.Namespace) -> int:
    """Prints the table."""
    from moldloft.formats import formats

    rows = list(formats().values())
    if options.json:
        hidden = ("writer",)
        print_json([{k: v for k, v in asdict(r).items() if k not in hidden} for r in rows])
        return 0
    header = ["name", "file", "holds", "what"]
    cells = [[r.name, f".{r.suffix or r.name}", r.holds, r.about] for r in rows]
    print(table(header, cells, left=4, width=terminal_width()))
    return 0

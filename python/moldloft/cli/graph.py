"""``moldloft graph``: the dependency digraph."""

from __future__ import annotations

import argparse

from moldloft.cli.console import (
    add_model,
    emit,
    open_model,
    print_json,
    report,
    stem_of,
)

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="default: MODEL.graph.svg; - is standard output"
    )
    parser.add_argument("--json", action="store_true", help="nodes and edges as data, no picture")


def run(options: argparse.Namespace) -> int:
    """Draws all objects, including failed ones; draws nothing for a text without objects."""
    from moldloft.digraph import Node, digraph_svg

    model = open_model(options)
    report(model.diagnostics)
    facts = [model.facts(name) for name in model.objects]
    status = 1 if model.has_errors else 0
    if options.json:
        keys = ("name", "kind", "class", "ok")
        edges = [[parent, fact["name"]] for fact in facts for parent in fact["parents"]]
        print_json({"nodes": [{key: f[key] for key in keys} for f in facts], "edges": edges})
        return status
    nodes = [Node(f["name"], f["kind"], f["class"], f["parents"], f["ok"]) for f in facts]
    if status and not nodes:
        return status
    stem = stem_of(options)
    path = options.output or f"{stem}.graph.svg"
    if emit(path, digraph_svg(nodes, stem).encode(), [options.model]) is not None:
        print(path)
    return status

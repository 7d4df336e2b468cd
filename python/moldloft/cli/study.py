"""``moldloft study``: many variants of a model, and the best of them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.cli.console import Progress, emit, print_json, say
from moldloft.text_table import table

if TYPE_CHECKING:
    from moldloft.study import Results, Study

__all__ = ["add", "run"]

#: States after which the exit status is 1; a refused case is an answer of the model.
_FAULTS = ("timed out", "crashed", "solver failed")

_RETRY = {"failed": _FAULTS, "refused": ("refused",), "all": (*_FAULTS, "refused")}


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    sweep = verbs.add_parser("sweep", help="evaluate the plan; a stopped one is continued")
    best = verbs.add_parser("optimize", help="find the best inputs")
    resume = verbs.add_parser("resume", help="continue the plan in the store")
    show = verbs.add_parser("show", help="print and draw the results")
    collect = verbs.add_parser("collect", help="join the stores of the parts of a plan")
    cases = verbs.add_parser("cases", help="write the plan as a list of cases")
    cases.add_argument("study", metavar="STUDY", help="a definition (.toml)")
    cases.add_argument(
        "-o", "--output", metavar="FILE", default="-", help="CSV; default: standard output"
    )
    for verb in (sweep, best, resume, show, collect):
        verb.add_argument("study", metavar="STUDY", help="a definition (.toml)")
        if verb is collect:
            verb.add_argument("parts", metavar="STORE", nargs="+", help="stores of parts")
        verb.add_argument("--store", metavar="FILE", help="results; default: STUDY with .sqlite")
        verb.add_argument("--csv", metavar="FILE", help="write the table; - is standard output")
        verb.add_argument("--parquet", metavar="FILE", help="write the table as Parquet")
        verb.add_argument("--html", metavar="FILE", help="write the report as one page")
        verb.add_argument("--json", action="store_true", help="the summary as data")
        verb.add_argument("-q", "--quiet", action="store_true", help="only errors")
    for verb in (sweep, best, resume):
        verb.add_argument(
            "--processes", metavar="N", type=_whole, default=2, help="cases at a time; default: 2"
        )
    for verb in (sweep, resume):
        verb.add_argument(
            "--cluster",
            metavar="ADDRESS",
            help="a Dask scheduler, tcp://host:port, `local`, or the jobs of a queue, such as "
            "`slurm`; needs moldloft[cluster] or moldloft[jobqueue]",
        )
        verb.add_argument(
            "--workers",
            metavar="N",
            type=_whole,
            default=0,
            help="processes or jobs at most of a cluster that is started; default: 2 or 10",
        )
        verb.add_argument(
            "--retry", choices=sorted(_RETRY), help="evaluate cases in these states again"
        )
        chosen = verb.add_mutually_exclusive_group()
        chosen.add_argument(
            "--part", metavar="K/N", type=_part, default=(1, 1), help="one part of the plan, from 1"
        )
        chosen.add_argument(
            "--cases",
            metavar="LIST",
            default="",
            help="only these: the header and some rows of the list of `study cases`",
        )


def _whole(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 4096:
        raise argparse.ArgumentTypeError(f"`{text}` is not a whole number of 1 to 4096")
    return int(text)


def _part(text: str) -> tuple[int, int]:
    first, slash, last = text.partition("/")
    if slash and first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last):
        return int(first), int(last)
    raise argparse.ArgumentTypeError(f"`{text}` is not K/N with K of 1 to N")


def run(options: argparse.Namespace) -> int:
    """Runs the verb."""
    from moldloft.study import Store, read

    study = read(options.study)
    if options.verb == "cases":
        return _cases(study, options)
    options.store = options.store or str(Path(options.study).with_suffix(".sqlite"))
    verb = options.verb
    if verb == "resume":
        with Store(options.store) as store:
            verb = "optimize" if store.facts().get("plan") == "optimize" else "sweep"
    if verb == "optimize":
        return _optimize(study, options)
    if verb == "sweep":
        results = _sweep(study, options)
    elif verb == "collect":
        results = _collect(study, options)
    else:
        with Store(options.store) as store:
            results = store.results()
    return _shown(study, results, options)


def _cases(study: Study, options: argparse.Namespace) -> int:
    from moldloft.study.plans import case_list, points
    from moldloft.study.running import Cases

    with Cases(study) as cases:
        emit(options.output, case_list(study, points(study, cases.model)), [options.study])
    return 0


def _sweep(study: Study, options: argparse.Namespace) -> Results:
    from moldloft.study import sweep
    from moldloft.study.cluster import ConnectedCluster

    address = options.cluster
    cluster = ConnectedCluster(address, options.workers) if address else nullcontext()
    with Progress() as progress, cluster as executor:
        progress.stage("reading the model")

        def tell(number: int, count: int, states: Mapping[str, int]) -> None:
            failed = number - states.get("done", 0)
            detail = f"{number} of {count}" + (f" ({failed} failed)" if failed else "")
            progress.stage("evaluating cases", detail, number / count)

        try:
            return sweep(
                study,
                options.store,
                executor=executor,
                processes=options.processes,
                retry=_RETRY.get(options.retry or "", ()),
                part=options.part,
                cases=options.cases,
                progress=tell,
            )
        except KeyboardInterrupt:
            print(f"stopped; `moldloft study resume {options.study}` continues", file=sys.stderr)
            raise


def _collect(study: Study, options: argparse.Namespace) -> Results:
    from moldloft.study import Store
    from moldloft.study.plans import points
    from moldloft.study.running import Cases

    with Cases(study) as cases, Store(options.store, writing=True) as store:
        keys = [cases.key(point) for point in points(study, cases.model)]
        facts = {"model": str(study.model), "digest": cases.digest, "plan": study.plan.method}
        store.begin(facts, keys)
        for part in options.parts:
            with Store(part) as other:
                taken = store.collect(other)
            if options.csv != "-":
                say(options, f"{part}: {taken} cases")
        return store.results()


def _optimize(study: Study, options: argparse.Namespace) -> int:
    from moldloft.study import Store, optimize

    with Progress() as progress:
        progress.stage("reading the model")
        found = optimize(
            study,
            options.store,
            processes=options.processes,
            progress=lambda n, best: progress.stage(
                "optimising", f"{n} evaluations, best {best:.8g}"
            ),
        )
    if options.json:
        front = [{**o.inputs, **o.outputs} for o in found.front]
        print_json({**vars(found), "front": front})
    else:
        rows = [[name, f"{value:.9g}"] for name, value in {**found.inputs, **found.outputs}.items()]
        head = "least of the first objective" if found.front else "optimum"
        say(options, table(["", head], rows))
        if found.front:
            names = [*found.inputs, *found.outputs]
            front = [{**o.inputs, **o.outputs} for o in found.front]
            say(options, table(names, [[f"{row[n]:.6g}" for n in names] for row in front]))
        state = "converged" if found.converged else "not converged"
        held = "constraints hold" if found.feasible else "constraints do not hold"
        say(options, f"{state}, {held}, {found.evaluations} evaluations: {found.message}")
    with Store(options.store) as store:
        _files(study, store.results(), options)
    return 0 if found.converged and found.feasible else 1


def _shown(study: Study, results: Results, options: argparse.Namespace) -> int:
    from moldloft.study.report import failures

    counts = results.counts
    if options.json:
        print_json({"counts": counts, "failures": failures(results), "store": options.store})
    elif options.csv != "-":
        say(options, table(["state", "cases"], [[k, str(v)] for k, v in counts.items()]))
        if failed := failures(results):
            say(options, table(["reason", "cases"], [[k, str(v)] for k, v in failed.items()]))
        _numbers(results, options)
    _files(study, results, options)
    return 1 if any(counts.get(state) for state in _FAULTS) else 0


def _numbers(results: Results, options: argparse.Namespace) -> None:
    done = results.done
    if not done.any():
        return
    rows = [
        [name, *(f"{v:.6g}" for v in (c[done].min(), c[done].mean(), c[done].max()))]
        for name, c in {**results.inputs, **results.outputs}.items()
    ]
    say(options, table(["", "least", "mean", "greatest"], rows))


def _files(study: Study, results: Results, options: argparse.Namespace) -> None:
    if options.csv:
        emit(options.csv, results.csv())
    if options.parquet:
        results.write(options.parquet)
    if options.html:
        from moldloft.study import Store
        from moldloft.study.pictures import pictures
        from moldloft.study.report import html

        with Store(options.store) as store:
            known = store.facts()
        plan = known.get("plan", "")
        facts = {"model": study.model.name, "plan": plan, "cases": str(len(results))}
        saltelli = study.plan.count if plan == "saltelli" else 0
        tolerances = {each.name: each.tolerance for each in study.inputs if each.tolerance}
        title = f"Study {Path(options.study).stem}"
        drawn = pictures(study, results, known)
        emit(options.html, html(results, title, facts, saltelli, tolerances, drawn))

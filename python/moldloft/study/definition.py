"""The definition of a study: model, inputs, outputs, constraints, plan, analyses, optimisation.

A definition is read from TOML (:func:`read`) or made in Python (:class:`Study`).
"""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from inspect import signature
from pathlib import Path
from typing import Any

from moldloft.budget import parsed
from moldloft.errors import Error
from moldloft.exchange.writing import Writable
from moldloft.formats import format_named
from moldloft.spelling import nearest
from moldloft.storage import read_text

__all__ = [
    "Analysis",
    "Bound",
    "Goal",
    "Input",
    "Objective",
    "Pattern",
    "Plan",
    "Study",
    "StudyError",
    "read",
]

#: Times and memory of one case unless the study says otherwise.
DEFAULT_SECONDS = 600.0
DEFAULT_MEMORY = "4G"

METHODS = {
    "grid": "all combinations of `levels` values of each input",
    "table": "the rows of a CSV file",
    "one-at-a-time": "each input over `levels` values, the others as in the model",
    "latin-hypercube": "`count` points, one in each of `count` slices of each input",
    "sobol": "`count` points of the scrambled Sobol sequence",
    "saltelli": "count (inputs + 2) points for Sobol indices",
}
"""The plans by name, with a line about each."""

OPTIMISERS = {
    "slsqp": "sequential quadratic programming of SciPy, by derivatives",
    "trust-constr": "interior point within a trust region of SciPy, by derivatives",
    "ipopt": "interior point of Ipopt (cyipopt), by derivatives",
    "cobyqa": "quadratic models within a trust region of SciPy, by values",
    "differential-evolution": "a population, of SciPy, by values",
    "nsga2": "a population for several objectives, of pymoo, by values",
    "tpe": "a tree of Parzen estimators of Optuna, by values, for one objective or several",
}
"""The optimisers that a study may name, with a line about each."""

BY_GRADIENTS = ("slsqp", "trust-constr", "ipopt")
"""The optimisers that use derivatives."""

FOR_SEVERAL = ("nsga2", "tpe")
"""The optimisers that take several objectives."""


#: Arguments of `Model.write` that a study states otherwise.
NO_OPTIONS = ("self", "path", "format")


class StudyError(Error):
    """An invalid definition of a study; the message gives the position and the expected value."""


@dataclass(frozen=True)
class Input:
    """An input of a study: a parameter or a literal of the model, and its range."""

    name: str
    """A parameter, or a literal such as ``"P21.y"``."""
    low: float | None = None
    """Least value; by default the model's."""
    high: float | None = None
    """Greatest value; by default the model's."""
    values: tuple[float, ...] = ()
    """The values of a grid; by default `levels` equally spaced ones."""
    tolerance: float = 0.0
    """Manufacturing tolerance, from which the report derives spreads and worst cases of outputs."""


@dataclass(frozen=True)
class Bound:
    """A constraint: an expression in the model's names within limits."""

    name: str
    value: str
    low: float = -math.inf
    high: float = math.inf

    @property
    def equal(self) -> bool:
        """True if both limits are the same value."""
        return self.low == self.high


@dataclass(frozen=True)
class Pattern:
    """The source of one number among the files that a program writes."""

    file: str
    """Its name in the case's folder."""
    pattern: str = ""
    """A regular expression whose first group is the number; the last match counts."""
    column: str = ""
    """Or a column of a table, by its header: words between commas, semicolons or blanks."""
    row: int = -1
    """The row of that column, from 0; negative ones count from the end."""
    key: str = ""
    """Or the dotted path of a value in a JSON file."""
    dataset: str = ""
    """Or the path of a data set in an HDF5 file."""
    index: tuple[int, ...] = ()
    """The index of the number in that data set, from 0 in each dimension."""
    python: str = ""
    """Or ``file.py:function``; called with the path of the file, it returns the number."""

    @property
    def sources(self) -> tuple[str, ...]:
        """The keys for the position of the number, of which exactly one is needed."""
        named = ("pattern", "column", "key", "dataset", "python")
        return tuple(name for name in named if getattr(self, name))


@dataclass(frozen=True)
class Analysis:
    """A calculation on the model of each case: a Python function or an external program."""

    name: str
    python: str = ""
    """``file.py:function``; called with the model, it returns a mapping of numbers by name."""
    outputs: tuple[str, ...] = ()
    """The names of those numbers."""
    command: tuple[tuple[str, ...], ...] = ()
    """Or commands, each by its words, run one after the other in the case's folder; ``{model}`` is
    the stem of its files, ``{folder}`` the study's folder."""
    stdin: str = ""
    """The file in the case's folder that the commands read as standard input."""
    environment: Mapping[str, str] = field(default_factory=dict)
    """Variables of the environment of the commands, beside those of the study."""
    formats: Mapping[str, str] = field(default_factory=dict)
    """Formats in which the model is written before the commands run, with file names; ``""``: the
    name of the model.
    """
    options: Mapping[str, Any] = field(default_factory=dict)
    """Options of :meth:`moldloft.Model.write` for these, such as ``immersed``."""
    prepare: str = ""
    """``file.py:function``; called with the model and the case's folder before the commands, it
    writes further files there; what it returns are words for the template by name, or None."""
    template: str = ""
    """A folder whose files are copied; ``{name}`` and ``{name:format}`` of parameters, inputs,
    outputs and the words of `prepare` are replaced in texts."""
    files: tuple[str, ...] = ()
    """Further files and folders beside the study whose contents decide the numbers."""
    results: Mapping[str, Pattern] = field(default_factory=dict)
    """Numbers that are read afterwards, by name."""
    differences: float = 0.0
    """Step of the differences that give the derivatives of its numbers, as a fraction of the range
    of each input; 0: its numbers have no derivatives."""
    adjoint: bool = False
    """True if `python` returns ``(number, weights)`` for each name, weights as for
    :meth:`moldloft.Model.vjp`: derivatives by the vertices of the mesh, or by measures."""
    seconds: float = DEFAULT_SECONDS
    """Time limit of all commands together."""
    keep: str = "failed"
    """Folders that are kept: ``"failed"``, ``"all"`` or ``"none"``."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all its numbers."""
        return (*self.outputs, *self.results)

    @property
    def differentiable(self) -> bool:
        """True if its numbers have derivatives."""
        return self.adjoint or self.differences > 0

    @property
    def functions(self) -> tuple[str, ...]:
        """Its Python functions."""
        found = (self.python, self.prepare, *(p.python for p in self.results.values()))
        return tuple(each for each in found if each)


@dataclass(frozen=True)
class Plan:
    """Plan of the points to evaluate."""

    method: str = "latin-hypercube"
    count: int = 100
    levels: int = 5
    seed: int = 0
    file: str = ""
    """The CSV file of a table."""


@dataclass(frozen=True)
class Objective:
    """An output to minimise or maximise."""

    output: str
    maximise: bool = False


@dataclass(frozen=True)
class Goal:
    """Objectives and the optimiser, of :data:`OPTIMISERS`."""

    objectives: tuple[Objective, ...]
    """Objectives: one, or several for ``nsga2`` and ``tpe``."""
    method: str = "slsqp"
    evaluations: int = 200
    """The greatest number of points."""
    tolerance: float = 1e-8
    """Convergence tolerance, relative to the objective at the start."""
    seed: int = 0
    population: int = 0
    """Points of a generation; by default 15 for each input, 40 with several objectives."""
    start: Mapping[str, float] = field(default_factory=dict)
    """The start; by default the model's values."""
    warm: bool = False
    """True to start from the best points of the store."""

    def __post_init__(self) -> None:
        if self.method not in OPTIMISERS:
            raise StudyError(f"`optimize.method`: `{self.method}` is unknown")
        if len(self.objectives) > 1 and self.method not in FOR_SEVERAL:
            raise StudyError(
                f"`optimize.method`: `{self.method}` takes one objective, found "
                f"{len(self.objectives)}; {' and '.join(FOR_SEVERAL)} take several"
            )


@dataclass(frozen=True)
class Study:
    """A study: inputs and outputs of a model, with plan, analyses and goal.

    Parameters
    ----------
    model
        Path of the model.
    inputs
        Inputs by name, with ranges.
    outputs
        Expressions in the model's names, by name.
    constraints
        Expressions within limits. A case that violates one of them is refused; an optimisation
        holds them.
    plan
        The points of a sweep.
    goal
        The objective of an optimisation.
    analyses
        Further calculations of each case.
    derivatives
        True if the exact derivatives of the outputs by the inputs are stored.
    seconds, memory
        Limits of one case.
    """

    model: Path
    inputs: tuple[Input, ...]
    outputs: Mapping[str, str]
    constraints: tuple[Bound, ...] = ()
    plan: Plan = field(default_factory=Plan)
    goal: Goal | None = None
    analyses: tuple[Analysis, ...] = ()
    derivatives: bool = False
    seconds: float = DEFAULT_SECONDS
    memory: str = DEFAULT_MEMORY
    library: tuple[str, ...] = ()
    closed: bool = False
    """True if a case whose mesh has an open edge is refused; images in planes of symmetry close."""
    folder: Path = Path()
    """The folder that relative names of analyses start from."""

    def __post_init__(self) -> None:
        try:
            parsed(f"memory={self.memory}")
        except Error as error:
            raise StudyError(str(error)) from None
        if not self.inputs:
            raise StudyError("a study needs an input: `[inputs]` names parameters or literals")
        if not self.names:
            raise StudyError("a study needs an output: `[outputs]` names expressions")
        taken = [each.name for each in self.analyses]
        if len(set(taken)) < len(taken):
            raise StudyError("two analyses have one name, and so one folder")
        seen: set[str] = set()
        for name in (*(i.name for i in self.inputs), *self.names):
            if name in seen:
                raise StudyError(f"`{name}` is named twice among inputs and outputs")
            seen.add(name)
        for each in self.inputs:
            if each.low is not None and each.high is not None and not each.low <= each.high:
                raise StudyError(
                    f"`inputs.{each.name}`: the range runs from {each.low:g} down to {each.high:g}"
                )
        for objective in self.goal.objectives if self.goal else ():
            if objective.output not in self.names:
                known = ", ".join(self.names)
                raise StudyError(
                    f"`optimize`: unknown output `{objective.output}`; outputs: {known}"
                )
        for name in self.goal.start if self.goal else ():
            if name not in {i.name for i in self.inputs}:
                raise StudyError(f"`optimize.start.{name}` is not an input")

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all outputs, those of the analyses last."""
        return (*self.outputs, *(name for each in self.analyses for name in each.names))


def read(path: str | os.PathLike[str]) -> Study:
    """Read the definition of a study.

    Parameters
    ----------
    path
        A TOML file; `docs/studies.md` describes its tables.

    Returns
    -------
    Study
        Names of files in it are relative to the file's folder.

    Raises
    ------
    StudyError
        With the invalid key and the expected value.
    FileError
        If the file cannot be read.
    """
    place = Path(path)
    data = _parsed(place)
    try:
        return _study(Table(data, ""), place.parent)
    except StudyError as error:
        raise StudyError(f"{place}: {error}") from None


def _parsed(place: Path) -> dict[str, Any]:
    try:
        found: dict[str, Any] = tomllib.loads(read_text(place))
        return found
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"{place}: not valid TOML: {error}") from None


class Table:
    """A TOML table whose keys are read one by one; remaining keys are unknown."""

    def __init__(self, data: object, where: str) -> None:
        if not isinstance(data, dict):
            raise StudyError(f"`{where}` is a table, found {_kind(data)}")
        self.data: dict[str, Any] = dict(data)
        self.where = where
        self._known: list[str] = []

    def at(self, key: str) -> str:
        """The full name of a key."""
        return f"{self.where}.{key}" if self.where else key

    def take(self, key: str, kind: str, default: Any = None) -> Any:
        """The value of a key, checked."""
        self._known.append(key)
        if key not in self.data:
            return default
        value = self.data.pop(key)
        return _checked(value, kind, self.at(key))

    def need(self, key: str, kind: str) -> Any:
        """The value of a required key."""
        if key not in self.data:
            raise StudyError(f"`{self.at(key)}` is missing")
        return self.take(key, kind)

    def table(self, key: str) -> Table:
        """A nested table; empty if missing."""
        self._known.append(key)
        return Table(self.data.pop(key, {}), self.at(key))

    def end(self) -> None:
        """Rejects unknown keys."""
        for key in self.data:
            near = nearest(key, self._known)
            hint = f"; did you mean `{near}`?" if near else f"; known: {', '.join(self._known)}"
            raise StudyError(f"`{self.at(key)}` is unknown{hint}")


def _kind(value: object) -> str:
    kinds = {bool: "true or false", str: "a text", list: "a list", dict: "a table"}
    return kinds.get(type(value), "a number" if isinstance(value, (int, float)) else repr(value))


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise StudyError(f"`{where}` is a number, found {_kind(value)}")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise StudyError(f"`{where}` is a finite number, found {value}")
    return found


def _checked(value: Any, kind: str, where: str) -> Any:
    if kind == "number":
        return _number(value, where)
    if kind == "count":
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**31:
            raise StudyError(f"`{where}` is a whole number of at least 0, found {value!r}")
        return value
    if kind == "text" and not isinstance(value, str):
        raise StudyError(f"`{where}` is a text, found {_kind(value)}")
    if kind == "flag" and not isinstance(value, bool):
        raise StudyError(f"`{where}` is true or false, found {_kind(value)}")
    if kind == "numbers":
        if not isinstance(value, list) or not value:
            raise StudyError(f"`{where}` is a list of numbers, found {_kind(value)}")
        return tuple(_number(each, f"{where}[{k}]") for k, each in enumerate(value))
    if kind == "texts":
        value = [value] if isinstance(value, str) else value
        if not isinstance(value, list) or not all(isinstance(each, str) for each in value):
            raise StudyError(f"`{where}` is a list of texts, found {_kind(value)}")
        return tuple(value)
    return value


def _choice(word: str, known: Sequence[str], where: str) -> str:
    if word in known:
        return word
    near = nearest(word, known)
    hint = f"did you mean `{near}`?" if near else f"expected one of: {', '.join(known)}"
    raise StudyError(f"`{where}`: `{word}` is unknown; {hint}")


def _study(top: Table, folder: Path) -> Study:
    model = folder / top.need("model", "text")
    inputs = top.table("inputs")
    outputs = top.table("outputs")
    bounds = top.table("constraints")
    analyses = top.table("analysis")
    found = Study(
        model=model,
        inputs=tuple(_input(name, data, inputs.at(name)) for name, data in inputs.data.items()),
        outputs={
            name: _checked(text, "text", outputs.at(name)) for name, text in outputs.data.items()
        },
        constraints=tuple(
            _bound(name, Table(t, bounds.at(name))) for name, t in bounds.data.items()
        ),
        plan=_plan(top.table("plan"), folder),
        goal=_goal(top.table("optimize")) if "optimize" in top.data else None,
        analyses=tuple(
            _analysis(name, Table(t, analyses.at(name))) for name, t in analyses.data.items()
        ),
        derivatives=top.take("derivatives", "flag", False),
        seconds=_positive(top.take("seconds", "number", DEFAULT_SECONDS), "seconds"),
        memory=top.take("memory", "text", DEFAULT_MEMORY),
        closed=top.take("closed", "flag", False),
        library=tuple(str(folder / each) for each in top.take("library", "texts", ())),
        folder=folder,
    )
    top._known.append("optimize")
    top.end()
    return found


def _positive(value: float, where: str) -> float:
    if value <= 0:
        raise StudyError(f"`{where}` is above 0, found {value:g}")
    return value


def _input(name: str, data: object, where: str) -> Input:
    if isinstance(data, list):
        pair = _checked(data, "numbers", where)
        if len(pair) != 2:
            raise StudyError(
                f"`{where}` is a range [low, high], found {len(pair)} numbers; "
                "a list of values is {values = [...]}"
            )
        return Input(name, pair[0], pair[1])
    table = Table(data, where)
    values = table.take("values", "numbers", ())
    found = Input(
        name,
        table.take("low", "number", min(values) if values else None),
        table.take("high", "number", max(values) if values else None),
        values,
        table.take("tolerance", "number", 0.0),
    )
    table.end()
    return found


def _bound(name: str, table: Table) -> Bound:
    value = table.need("value", "text")
    equal = table.take("equal", "number")
    low, high = table.take("low", "number"), table.take("high", "number")
    table.end()
    if equal is not None:
        if low is not None or high is not None:
            raise StudyError(f"`{table.where}`: `equal` excludes `low` and `high`")
        return Bound(name, value, equal, equal)
    if low is None and high is None:
        raise StudyError(f"`{table.where}` needs `low`, `high` or `equal`")
    return Bound(name, value, -math.inf if low is None else low, math.inf if high is None else high)


def _plan(table: Table, folder: Path) -> Plan:
    default = Plan()
    method = _choice(
        table.take("method", "text", default.method), tuple(METHODS), table.at("method")
    )
    file = table.take("file", "text", "")
    found = Plan(
        method,
        max(table.take("count", "count", default.count), 1),
        max(table.take("levels", "count", default.levels), 1),
        table.take("seed", "count", default.seed),
        str(folder / file) if file else "",
    )
    table.end()
    if method == "table" and not file:
        raise StudyError("`plan.file` is missing: a table is read from a CSV file")
    return found


def _goal(table: Table) -> Goal:
    least, most = table.take("minimize", "texts", ()), table.take("maximize", "texts", ())
    objectives = [Objective(n) for n in least] + [Objective(n, True) for n in most]
    if not objectives:
        raise StudyError("`optimize` needs `minimize` or `maximize`, names of outputs")
    if len({o.output for o in objectives}) < len(objectives):
        raise StudyError("`optimize` has the same objective twice")
    several = len(objectives) > 1
    default = FOR_SEVERAL[0] if several else "slsqp"
    method = _choice(table.take("method", "text", default), tuple(OPTIMISERS), table.at("method"))
    start = table.table("start")
    values = {name: _number(value, start.at(name)) for name, value in start.data.items()}
    found = Goal(
        tuple(objectives),
        method,
        max(table.take("evaluations", "count", 200), 1),
        _positive(table.take("tolerance", "number", 1e-8), table.at("tolerance")),
        table.take("seed", "count", 0),
        table.take("population", "count", 0),
        values,
        table.take("warm", "flag", False),
    )
    table.end()
    return found


def _analysis(name: str, table: Table) -> Analysis:
    results, options = table.table("results"), table.table("options")
    environment = table.table("environment")
    found = Analysis(
        name,
        table.take("python", "text", ""),
        table.take("outputs", "texts", ()),
        _commands(table),
        table.take("stdin", "text", ""),
        {k: _checked(v, "text", environment.at(k)) for k, v in environment.data.items()},
        _formats(table),
        _options(options),
        table.take("prepare", "text", ""),
        table.take("template", "text", ""),
        table.take("files", "texts", ()),
        {key: _pattern(Table(t, results.at(key))) for key, t in results.data.items()},
        _step(table),
        table.take("adjoint", "flag", False),
        _positive(table.take("seconds", "number", DEFAULT_SECONDS), table.at("seconds")),
        _choice(table.take("keep", "text", "failed"), ("failed", "all", "none"), table.at("keep")),
    )
    table.end()
    if bool(found.python) == bool(found.command):
        raise StudyError(f"`{table.where}` needs either `python` or `command`")
    if found.adjoint and (not found.python or found.differences):
        raise StudyError(f"`{table.at('adjoint')}` needs `python`, and excludes `differences`")
    for function in found.functions:
        place, _, called = function.rpartition(":")
        if not place or not called.isidentifier():
            raise StudyError(f"`{table.where}`: expected `file.py:function`, found `{function}`")
    if found.python and not found.outputs:
        raise StudyError(f"`{table.at('outputs')}` is missing: the names of the numbers returned")
    if found.command and not found.results:
        raise StudyError(f"`{table.at('results')}` is missing: the numbers read from files")
    return found


def _step(table: Table) -> float:
    found: float = table.take("differences", "number", 0.0)
    # A one-sided difference takes two steps within the range.
    if not 0 <= found <= 0.25:
        raise StudyError(f"`{table.at('differences')}` is a fraction up to 0.25, found {found:g}")
    return found


def _commands(table: Table) -> tuple[tuple[str, ...], ...]:
    where, value = table.at("command"), table.take("command", "any", ())
    rows = value if isinstance(value, list) and value and isinstance(value[0], list) else [value]
    if value == ():
        return ()
    commands = tuple(_checked(row, "texts", where) for row in rows)
    if not all(commands):
        raise StudyError(f"`{where}` is empty: a command is a list of texts")
    return commands


def _formats(table: Table) -> dict[str, str]:
    """Names of formats, or a table of their files."""
    where, value = table.at("formats"), table.take("formats", "any", [])
    if isinstance(value, dict):
        found = {name: _checked(file, "text", f"{where}.{name}") for name, file in value.items()}
    else:
        found = dict.fromkeys(_checked(value, "texts", where), "")
    for name in found:
        try:
            format_named(name)
        except Error as error:
            raise StudyError(f"`{where}`: {error}") from None
    return found


def _options(table: Table) -> dict[str, Any]:
    known = [name for name in signature(Writable.write).parameters if name not in NO_OPTIONS]
    for name, value in table.data.items():
        _choice(name, known, table.where)
        if not isinstance(value, (bool, int, float, str)):
            _checked(value, "texts", table.at(name))
    return table.data


def _pattern(table: Table) -> Pattern:
    found = Pattern(
        table.need("file", "text"),
        table.take("pattern", "text", ""),
        table.take("column", "text", ""),
        _whole(table.take("row", "number", -1), table.at("row")),
        table.take("key", "text", ""),
        table.take("dataset", "text", ""),
        tuple(_whole(k, table.at("index")) for k in table.take("index", "numbers", ())),
        table.take("python", "text", ""),
    )
    table.end()
    if len(found.sources) != 1:
        raise StudyError(
            f"`{table.where}` needs one of `pattern`, `column`, `key`, `dataset`, `python`"
        )
    try:
        re.compile(found.pattern)
    except re.error as error:
        raise StudyError(f"`{table.at('pattern')}` is no regular expression: {error}") from None
    return found


def _whole(value: float, where: str) -> int:
    if value != int(value):
        raise StudyError(f"`{where}` is a whole number, found {value:g}")
    return int(value)

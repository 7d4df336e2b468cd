"""One case of a study: set the inputs, evaluate the outputs, run the analyses.

Works in a process of its own (:mod:`moldloft.study.workers`); a request and its answer are data
of JSON.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Mapping, Sequence
from importlib import util
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
from moldloft.study.functions import jacobian
from moldloft.study.programs import SolverError, finite, run_program

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["DONE", "REFUSED", "SOLVER_FAILED", "evaluate", "number"]

DONE = "done"
REFUSED = "refused"
SOLVER_FAILED = "solver failed"

#: A constraint counts as held within this fraction of its limit's size (rounding).
CONSTRAINT_ROUNDING = 1e-12

#: The models of this process by the digest of their files.
_models: dict[str, Model] = {}
_modules: dict[str, Any] = {}


def evaluate(request: Mapping[str, Any]) -> dict[str, Any]:
    """The outputs of one case.

    Parameters
    ----------
    request
        Made by :meth:`moldloft.study.running.Cases.request`.

    Returns
    -------
    dict
        ``state``, and ``outputs`` by name with ``derivatives`` by name, in the order of the
        inputs, or ``id`` and ``message`` of the failure.
    """
    began = time.perf_counter()
    try:
        outputs, derivatives = _outputs(request)
        answer: dict[str, Any] = {"state": DONE, "outputs": outputs, "derivatives": derivatives}
    except SolverError as error:
        answer = _failed(SOLVER_FAILED, "solver-failed", str(error))
    except Error as error:
        first = next((d for d in error.diagnostics if d.severity == "error"), None)
        reason = next((n for kind, n in REASONS.items() if isinstance(error, kind)), "refused")
        answer = _failed(REFUSED, first.id if first else reason, str(first or error))
    except MemoryError:
        answer = _failed(REFUSED, "out-of-memory", "the case needs more memory than its limit")
    except RecursionError as error:
        answer = _failed(SOLVER_FAILED, "solver-failed", f"RecursionError: {error}")
    if "message" in answer and request["root"]:
        # The files are a snapshot in a folder of another name each time.
        answer["message"] = answer["message"].replace(request["root"] + os.sep, "")
    answer["seconds"] = time.perf_counter() - began
    return answer


def _failed(state: str, reason: str, message: str) -> dict[str, Any]:
    return {"state": state, "id": reason, "message": message.strip()[:2000]}


def _outputs(request: Mapping[str, Any]) -> tuple[dict[str, float], dict[str, list[float]]]:
    """The outputs, and where they are wanted their derivatives."""
    model = _model(request)
    model.set(request["inputs"])
    model.check()
    if request["closed"]:
        _closed(model)
    for name, value, low, high in request["constraints"]:
        _held(model, name, value, low, high)
    found, weights = _numbers(model, request, request["analyses"])
    if not request["derivatives"]:
        return found, {}
    names, outputs = list(request["inputs"]), request["outputs"]
    slopes: dict[str, list[float]] = {}
    if outputs:
        rows = jacobian(model, list(outputs.values()), [1] * len(outputs), names)
        slopes = dict(zip(outputs, rows.tolist(), strict=True))
    for name, by in weights.items():
        slopes[name] = _adjoint(model, name, by, names)
    return found, slopes | _differences(model, request, found)


def _numbers(
    model: Model, request: Mapping[str, Any], analyses: Sequence[Mapping[str, Any]]
) -> tuple[dict[str, float], dict[str, Mapping[str, Any]]]:
    """The numbers of the model and of analyses, and the weights that adjoint ones return."""
    found = {name: _value(model, name, text) for name, text in request["outputs"].items()}
    weights: dict[str, Mapping[str, Any]] = {}
    for analysis in analyses:
        if analysis["python"]:
            numbers, own = _of_python(model, analysis, request)
            weights |= own
        else:
            numbers = run_program(model, analysis, request, found, _function)
        found |= numbers
    return found, weights


def _adjoint(model: Model, name: str, weights: Mapping[str, Any], inputs: list[str]) -> list[float]:
    """The derivatives of a number by the inputs, from those by vertices or measures."""
    try:
        rows: list[float] = model.vjp(weights, inputs).tolist()
    except Error as error:
        raise SolverError(f"the weights of `{name}`: {error}") from None
    return rows


def _differences(
    model: Model, request: Mapping[str, Any], here: Mapping[str, float]
) -> dict[str, list[float]]:
    """Derivatives by differences of second order: central, one-sided at the end of a range."""
    analyses = request["analyses"]
    chosen = [k for k, each in enumerate(analyses) if each["differences"]]
    if not chosen:
        return {}
    names = [name for k in chosen for name in _names(analyses[k])]
    used = analyses[: chosen[-1] + 1]
    found: dict[str, list[float]] = {name: [] for name in names}
    for by, (low, high) in request["ranges"].items():
        x = request["inputs"][by]

        def at(value: float, by: str = by, x: float = x) -> dict[str, float]:
            moved = {
                **request,
                "inputs": {**request["inputs"], by: value},
                "place": f"{request['place']} {by} {value - x:+.3g}",
            }
            try:
                model.set({by: value})
                return _numbers(model, moved, used)[0]
            except Error as error:
                raise SolverError(f"differences by `{by}`, at {value:.9g}: {error}") from None
            finally:
                model.set({by: x})

        steps = {
            n: analyses[k]["differences"] * (high - low)
            for k in chosen
            for n in _names(analyses[k])
        }
        for h in dict.fromkeys(steps.values()):
            if h == 0.0:
                slopes = dict.fromkeys(names, 0.0)
            elif low <= x - h and x + h <= high:
                before, after = at(x - h), at(x + h)
                slopes = {n: (after[n] - before[n]) / (2 * h) for n in names}
            else:
                inward = h if x + 2 * h <= high else -h
                near, far = at(x + inward), at(x + 2 * inward)
                slopes = {n: (4 * near[n] - 3 * here[n] - far[n]) / (2 * inward) for n in names}
            for n in names:
                if steps[n] == h:
                    found[n].append(slopes[n])
    return found


def _names(analysis: Mapping[str, Any]) -> tuple[str, ...]:
    return (*analysis["outputs"], *analysis["results"])


def _model(request: Mapping[str, Any]) -> Model:
    from moldloft.loading import load

    digest = request["digest"]
    if digest not in _models:
        _models.clear()
        _models[digest] = load(request["model"], library=request["library"])
    return _models[digest]


def _held(model: Model, name: str, value: str, low: float | None, high: float | None) -> None:
    found = _value(model, name, value)
    least = -math.inf if low is None else low
    most = math.inf if high is None else high
    room = CONSTRAINT_ROUNDING * max(abs(found), 1.0)
    if not least - room <= found <= most + room:
        limit = f"at least {least:g}" if found < least else f"at most {most:g}"
        raise ConstraintError(f"constraint `{name}`: `{value}` is {found:g}, {limit} is allowed")


def _closed(model: Model) -> None:
    for edge in model.mesh().closure(level=None)["edges"]:
        if not (edge["closed_by"] or "").startswith("mirror"):
            raise OpenError(
                f"the mesh is open at the edge {edge['edge']} of `{edge['patch']}`, over a length "
                f"of {edge['length']:g}"
            )


class OpenError(Error):
    """The mesh of a case is not closed."""


class ConstraintError(Error):
    """A constraint of the study is violated."""


def _value(model: Model, name: str, text: str) -> float:
    try:
        return number(model.eval(text), text)
    except NumberError as error:
        raise Error(f"output `{name}`: {error}") from None


def number(value: object, text: str) -> float:
    """The value of an expression as a finite number.

    Parameters
    ----------
    value
        The value.
    text
        The expression, for the message.

    Raises
    ------
    NumberError
        If it is not a number.
    """
    try:
        numbers = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if numbers.size != 1:
        what = f"{numbers.size} numbers" if numbers.size else type(value).__name__
        raise NumberError(f"`{text}` is {what}, expected a number")
    found = float(numbers.reshape(-1)[0])
    if not math.isfinite(found):
        raise NumberError(f"`{text}` is {found}, expected a finite number")
    return found


class NumberError(Error):
    """The value of an expression is not a finite number."""


REASONS: dict[type[Error], str] = {ConstraintError: "constraint", OpenError: "not-closed"}
"""Ids of errors that are not diagnostics of the model."""


def _of_python(
    model: Model, analysis: Mapping[str, Any], request: Mapping[str, Any]
) -> tuple[dict[str, float], dict[str, Mapping[str, Any]]]:
    """The numbers by name, and the weights of those of an adjoint analysis."""
    place, _, name = analysis["python"].rpartition(":")
    function = _function(str(Path(request["folder"]) / place), name)
    try:
        found = function(model)
    except Error:
        raise
    except Exception as error:
        raise SolverError(
            f"`{analysis['python']}` raised {type(error).__name__}: {error}"
        ) from error
    if not isinstance(found, Mapping):
        if len(analysis["outputs"]) != 1:
            raise SolverError(f"`{analysis['python']}` returned no mapping of numbers by name")
        found = {analysis["outputs"][0]: found}
    numbers: dict[str, float] = {}
    weights: dict[str, Mapping[str, Any]] = {}
    for key in analysis["outputs"]:
        try:
            number = found[key]
            if analysis["adjoint"]:
                number, by = number
                weights[key] = dict(by)
            value = float(np.asarray(number).reshape(-1)[0])
        except (KeyError, TypeError, ValueError, IndexError):
            what = "number with its weights" if analysis["adjoint"] else "number"
            raise SolverError(f"`{analysis['python']}` returned no {what} `{key}`") from None
        numbers[key] = finite(value, key, analysis["python"])
    return numbers, weights


def _function(place: str, name: str) -> Any:
    if place not in _modules:
        spec = util.spec_from_file_location(f"_study_{len(_modules)}", place)
        if spec is None or spec.loader is None or not Path(place).is_file():
            raise SolverError(f"`{place}` is not a Python file")
        module = util.module_from_spec(spec)
        sys.path.insert(0, str(Path(place).parent))
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            raise SolverError(f"`{place}` raised {type(error).__name__}: {error}") from error
        finally:
            sys.path.pop(0)
        _modules[place] = module
    function = getattr(_modules[place], name, None)
    if not callable(function):
        raise SolverError(f"`{place}` has no function `{name}`")
    return function

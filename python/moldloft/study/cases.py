"""One case of a study: set the inputs, evaluate the outputs, run the analyses.

Works in a process of its own (:mod:`moldloft.study.workers`); a request and its answer are data
of JSON.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Mapping
from importlib import util
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
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
        ``state``, and ``outputs`` by name, or ``id`` and ``message`` of the failure.
    """
    began = time.perf_counter()
    try:
        answer: dict[str, Any] = {"state": DONE, "outputs": _outputs(request)}
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


def _outputs(request: Mapping[str, Any]) -> dict[str, float]:
    model = _model(request)
    inputs: dict[str, float] = request["inputs"]
    model.set(inputs)
    model.check()
    if request["closed"]:
        _closed(model)
    for name, value, low, high in request["constraints"]:
        _held(model, name, value, low, high)
    found = {name: _value(model, name, text) for name, text in request["outputs"].items()}
    if request["derivatives"] and request["outputs"]:
        found |= _derivatives(model, request["outputs"], list(inputs))
    for analysis in request["analyses"]:
        if analysis["python"]:
            found |= _of_python(model, analysis, request)
        else:
            found |= run_program(model, analysis, request, found, _function)
    return found


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


def _derivatives(model: Model, outputs: Mapping[str, str], inputs: list[str]) -> dict[str, float]:
    rows = model.derivatives(list(outputs.values()), inputs)
    return {
        f"d {name} / d {by}": float(np.ravel(value)[0])
        for name, row in zip(outputs, rows, strict=True)
        for by, value in zip(inputs, row, strict=True)
    }


def _of_python(
    model: Model, analysis: Mapping[str, Any], request: Mapping[str, Any]
) -> dict[str, float]:
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
    numbers = {}
    for key in analysis["outputs"]:
        try:
            value = float(np.asarray(found[key]).reshape(-1)[0])
        except (KeyError, TypeError, ValueError, IndexError):
            raise SolverError(f"`{analysis['python']}` returned no number `{key}`") from None
        numbers[key] = finite(value, key, analysis["python"])
    return numbers


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

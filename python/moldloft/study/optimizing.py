"""Optimisation of a study's objective by SciPy, each point one case of the store."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
from moldloft.study.cases import DONE
from moldloft.study.definition import Bound, Study, StudyError
from moldloft.study.plans import ranges
from moldloft.study.running import Cases, outcome
from moldloft.study.store import Outcome, Store
from moldloft.study.workers import end_workers, evaluate_apart

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Optimum", "optimize"]

#: The methods that use derivatives.
BY_GRADIENTS = ("slsqp", "trust-constr")

#: An optimum's constraints hold within this fraction of their limits' sizes.
FEASIBLE = 1e-6


@dataclass(frozen=True)
class Optimum:
    """The best point of an optimisation."""

    inputs: dict[str, float]
    outputs: dict[str, float]
    converged: bool
    """Whether the optimiser met its tolerance."""
    feasible: bool
    """Whether all constraints hold to 1e-6 of their limits."""
    message: str
    evaluations: int
    """The number of points evaluated, derivatives included."""


class NoNumbersError(Exception):
    """A point at which the model has no numbers."""


class _Points:
    """The points of an optimisation: values and derivatives from one evaluation."""

    def __init__(self, cases: Cases, store: Store, scale: Floats, low: Floats) -> None:
        self.cases = cases
        self.store = store
        self.scale = scale
        self.low = low
        self.evaluated = 0
        self._last: tuple[bytes, Outcome] | None = None

    def at(self, unit: Floats) -> Outcome:
        """The outcome at a point of the unit cube."""
        point = self.low + self.scale * np.asarray(unit, dtype=np.float64)
        data = point.tobytes()
        if self._last is None or self._last[0] != data:
            key = self.cases.key(point)
            found = self.store.find(key)
            if found is None:
                request = self.cases.request(key, point)
                found = outcome(request, evaluate_apart(request))
                self.store.add(found)
                self.evaluated += 1
            self.store.append(key)
            self._last = data, found
        if self._last[1].state != DONE:
            raise NoNumbersError(self._last[1].message)
        return self._last[1]

    def value(self, name: str, unit: Floats) -> float:
        return self.at(unit).outputs[name]

    def slope(self, name: str, unit: Floats) -> Floats:
        outputs = self.at(unit).outputs
        found = np.array([outputs[f"d {name} / d {by}"] for by in self.cases.names])
        return found * self.scale


def _prepared(study: Study) -> tuple[Study, list[Bound]]:
    """The study with its constraints among the outputs, and derivatives where they are used."""
    assert study.goal is not None
    own = dict(study.outputs)
    bounds = []
    for bound in study.constraints:
        name = f"constraint {bound.name}"
        if bound.value in study.names:
            name = bound.value
        else:
            own[name] = bound.value
        bounds.append(replace(bound, name=name))
    derivatives = study.goal.method in BY_GRADIENTS
    by_analysis = {n for each in study.analyses for n in each.names}
    used = {study.goal.output, *(b.name for b in bounds)}
    if derivatives and used & by_analysis:
        word = sorted(used & by_analysis)[0]
        raise StudyError(
            f"`optimize.method`: `{study.goal.method}` needs derivatives, and `{word}` of an "
            "analysis has none; cobyqa and differential-evolution use values alone"
        )
    return replace(study, outputs=own, constraints=(), derivatives=derivatives), bounds


def optimize(
    study: Study,
    store: str | os.PathLike[str],
    *,
    progress: Callable[[int, float], None] | None = None,
) -> Optimum:
    """Find the inputs with the least or greatest objective within the constraints.

    Parameters
    ----------
    study
        A definition with a goal.
    store
        The SQLite file: points that it has are not evaluated again.
    progress
        Called with the number of evaluations and the best feasible objective.

    Returns
    -------
    Optimum
        The best feasible point evaluated; where there is none, the last one.

    Raises
    ------
    StudyError
        When the study has no goal, or a method needs derivatives that an analysis has not.
    Error
        When the model has no numbers at the start.
    """
    if study.goal is None:
        raise StudyError("`[optimize]` is missing: it names the objective")
    try:
        from scipy import optimize as scipy_optimize
    except ImportError as error:
        raise Error(f"this needs SciPy: pip install 'moldloft[study]' ({error})") from None
    prepared, bounds = _prepared(study)
    with Cases(prepared) as cases, Store(store, writing=True) as kept:
        box = ranges(study, cases.model)
        scale = np.where(box[:, 1] > box[:, 0], box[:, 1] - box[:, 0], 1.0)
        points = _Points(cases, kept, scale, box[:, 0])
        rest = [study.goal.start.get(n, float(cases.model.eval(n))) for n in cases.names]
        start = np.clip((np.array(rest) - box[:, 0]) / scale, 0.0, 1.0)
        kept.begin({"model": str(study.model), "digest": cases.digest, "plan": "optimize"}, [])
        search = _Search(study, bounds, points, progress)
        try:
            search.start(start)
            message, converged = _minimised(scipy_optimize, study, search, start, box)
        finally:
            end_workers()
        return search.optimum(message, converged)


class _Search:
    """Objective and constraints as SciPy calls them, and the best point so far."""

    def __init__(
        self,
        study: Study,
        bounds: list[Bound],
        points: _Points,
        progress: Callable[[int, float], None] | None,
    ) -> None:
        assert study.goal is not None
        self.goal = study.goal
        self.bounds = bounds
        self.points = points
        self.progress = progress
        self.sign = -1.0 if self.goal.maximise else 1.0
        self.size = 1.0
        self.sizes = [1.0] * len(bounds)
        self.best: tuple[bool, float, Outcome] | None = None

    def start(self, unit: Floats) -> None:
        """Evaluates the start, whose values are the sizes of objective and constraints."""
        try:
            first = self.points.at(unit)
        except NoNumbersError as failed:
            raise Error(f"the model has no numbers at the start: {failed}") from None
        self.size = abs(first.outputs[self.goal.output]) or 1.0
        for k, bound in enumerate(self.bounds):
            limits = [abs(v) for v in (bound.low, bound.high) if np.isfinite(v)]
            self.sizes[k] = max([*limits, 0.0]) or abs(first.outputs[bound.name]) or 1.0
        self._seen(first)

    def _seen(self, found: Outcome) -> None:
        value = self.sign * found.outputs[self.goal.output]
        feasible = all(
            b.low - FEASIBLE * s <= found.outputs[b.name] <= b.high + FEASIBLE * s
            for b, s in zip(self.bounds, self.sizes, strict=True)
        )
        better = self.best is None or (feasible, -value) > (self.best[0], -self.best[1])
        if better:
            self.best = feasible, value, found
        if self.progress and self.best is not None:
            self.progress(self.points.evaluated, self.sign * self.best[1])

    def objective(self, unit: Floats) -> float:
        """The objective at a point; where the model fails, one that is never taken."""
        try:
            found = self.points.at(unit)
        except NoNumbersError:
            return 1e10
        self._seen(found)
        return self.sign * found.outputs[self.goal.output] / self.size

    def gradient(self, unit: Floats) -> Floats:
        """The derivatives of the objective."""
        try:
            return self.sign * self.points.slope(self.goal.output, unit) / self.size
        except NoNumbersError:
            return np.zeros(len(unit))

    def constraints(self, make: Callable[..., Any], by_gradients: bool) -> list[Any]:
        """The constraints of SciPy: equalities apart from limits, in units of their limits."""
        made = []
        for equal in (True, False):
            chosen = [
                (b, s) for b, s in zip(self.bounds, self.sizes, strict=True) if b.equal == equal
            ]
            if chosen:
                more = {"jac": partial(self._slopes, chosen)} if by_gradients else {}
                low = [b.low / s for b, s in chosen]
                high = [b.high / s for b, s in chosen]
                made.append(make(partial(self._values, chosen), low, high, **more))
        return made

    def _values(self, chosen: list[tuple[Bound, float]], unit: Floats) -> Floats:
        try:
            outputs = self.points.at(unit).outputs
        except NoNumbersError:
            return np.full(len(chosen), 1e10)
        return np.array([outputs[b.name] / s for b, s in chosen])

    def _slopes(self, chosen: list[tuple[Bound, float]], unit: Floats) -> Floats:
        """Derivatives, ``(constraints, inputs)``."""
        try:
            return np.array([self.points.slope(b.name, unit) / s for b, s in chosen])
        except NoNumbersError:
            return np.zeros((len(chosen), len(unit)))

    def optimum(self, message: str, converged: bool) -> Optimum:
        """The best point."""
        assert self.best is not None
        feasible, _, found = self.best
        outputs = {n: v for n, v in found.outputs.items() if not n.startswith("d ")}
        return Optimum(
            dict(found.inputs), outputs, converged, feasible, message, self.points.evaluated
        )


def _minimised(
    scipy_optimize: Any, study: Study, search: _Search, start: Floats, box: Floats
) -> tuple[str, bool]:
    goal = search.goal
    unit = scipy_optimize.Bounds(np.zeros(len(start)), (box[:, 1] > box[:, 0]).astype(float))
    by_gradients = goal.method in BY_GRADIENTS
    constraints = search.constraints(scipy_optimize.NonlinearConstraint, by_gradients)
    if goal.method == "differential-evolution":
        found = scipy_optimize.differential_evolution(
            search.objective,
            unit,
            constraints=constraints,
            rng=goal.seed,
            x0=start,
            polish=False,
            tol=goal.tolerance,
            maxiter=max(goal.evaluations // (15 * len(start)) - 1, 1),
        )
        return str(found.message), bool(found.success)
    options: dict[str, Any] = {"maxiter": goal.evaluations}
    if goal.method == "slsqp":
        options["ftol"] = goal.tolerance
    elif goal.method == "trust-constr":
        options |= {"gtol": goal.tolerance, "xtol": goal.tolerance}
    else:
        options = {"maxfev": goal.evaluations, "final_tr_radius": goal.tolerance}
    found = scipy_optimize.minimize(
        search.objective,
        start,
        jac=search.gradient if by_gradients else None,
        method=goal.method,
        bounds=unit,
        constraints=constraints,
        options=options,
    )
    return str(found.message), bool(found.success)

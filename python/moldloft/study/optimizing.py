"""Optimisation of a study: each point is one case of the store, values and derivatives together."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import Error
from moldloft.study.cases import DONE
from moldloft.study.definition import BY_GRADIENTS, OPTIMISERS, Bound, Study, StudyError
from moldloft.study.fronts import front
from moldloft.study.plans import ranges
from moldloft.study.running import Cases, outcome
from moldloft.study.sources import check_programs
from moldloft.study.store import Outcome, Store
from moldloft.study.workers import end_workers, evaluate_apart

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Optimum", "Points", "Search", "optimize"]

#: An optimum's constraints hold within this fraction of their limits' sizes.
FEASIBLE = 1e-6

#: Objective and constraints where the model has no numbers: no method takes such a point.
FAILED = 1e10


@dataclass(frozen=True)
class Optimum:
    """The best point of an optimisation."""

    inputs: dict[str, float]
    outputs: dict[str, float]
    converged: bool
    """True if the optimiser ended by its own criterion, not by a failure or a limit."""
    feasible: bool
    """True if all constraints hold to 1e-6 of their limits."""
    message: str
    evaluations: int
    """The number of points evaluated, derivatives included."""
    front: tuple[Outcome, ...] = field(default=(), repr=False)
    """The Pareto front of several objectives: feasible points that no other point dominates, in the
    order of the first objective.
    """


class NoNumbersError(Exception):
    """A point at which the model cannot be evaluated."""


class LimitError(Exception):
    """The limit of evaluations of the study is reached."""


class Points:
    """Values and derivatives for an optimiser, from one evaluation.

    Points are given in the unit cube of the ranges.
    """

    def __init__(
        self, cases: Cases, store: Store, box: Floats, limit: int, processes: int = 1
    ) -> None:
        self.cases = cases
        self.store = store
        self.low, self.high = box.T
        self.scale = np.where(box[:, 1] > box[:, 0], box[:, 1] - box[:, 0], 1.0)
        self.most = (box[:, 1] > box[:, 0]).astype(float)
        """Upper bounds in the unit cube: 0 for an input with an empty range."""
        self.evaluated = 0
        self.seen: Callable[[Outcome], None] = lambda _: None
        self._limit = limit
        self._processes = processes
        self._known: dict[str, Outcome] = {}
        known = cases.model.params
        self._whole = np.array([n in known and known[n].whole for n in cases.names])

    def unit(self, point: Floats) -> Floats:
        """A point in the coordinates of the unit cube."""
        found: Floats = np.clip((point - self.low) / self.scale, 0.0, self.most)
        return found

    def _point(self, unit: Floats) -> Floats:
        # Rounding must not take the end of a range beyond it.
        point = np.clip(self.low + self.scale * np.clip(unit, 0.0, self.most), self.low, self.high)
        found: Floats = np.where(self._whole, np.round(point), point)
        return found

    def batch(self, units: Floats) -> list[Outcome]:
        """The outcomes at points, ``(points, inputs)``, in order.

        New points are evaluated in parallel.
        """
        points = [self._point(unit) for unit in units]
        keys = [self.cases.key(point) for point in points]
        new = {k: p for k, p in zip(keys, points, strict=True) if k not in self._known}
        room = self._limit - len(self._known)
        stored = {key: self.store.find(key) for key in list(new)[:room]}
        requests = [self.cases.request(k, new[k]) for k, o in stored.items() if o is None]
        if len(requests) > 1 and self._processes > 1:
            with ThreadPoolExecutor(self._processes) as pool:
                answers = list(pool.map(evaluate_apart, requests))
        else:
            answers = [evaluate_apart(request) for request in requests]
        for request, answer in zip(requests, answers, strict=True):
            found = outcome(request, answer)
            self.store.add(found)
            stored[found.key] = found
            self.evaluated += 1
        for key, known in stored.items():
            assert known is not None
            self.store.append(key)
            self._known[key] = known
            self.seen(known)
        if len(new) > room:
            raise LimitError
        return [self._known[key] for key in keys]

    def at(self, unit: Floats) -> Outcome:
        """The outcome at one point.

        Raises
        ------
        NoNumbersError
            If the model fails.
        """
        (found,) = self.batch(np.asarray(unit, dtype=np.float64)[None])
        if found.state != DONE:
            raise NoNumbersError(found.message)
        return found

    def has_numbers(self, unit: Floats) -> bool:
        """True if the model can be evaluated at a point."""
        try:
            self.at(unit)
        except NoNumbersError:
            return False
        return True

    def slope(self, name: str, unit: Floats) -> Floats:
        """The derivatives of an output with respect to the coordinates of the unit cube."""
        slopes = self.at(unit).derivatives[name]
        found: Floats = np.array([slopes[by] for by in self.cases.names])
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
    by_analysis = {n for each in study.analyses if not each.differentiable for n in each.names}
    used = {*(o.output for o in study.goal.objectives), *(b.name for b in bounds)}
    if derivatives and used & by_analysis:
        word = sorted(used & by_analysis)[0]
        others = [name for name in OPTIMISERS if name not in BY_GRADIENTS]
        raise StudyError(
            f"`optimize.method`: `{study.goal.method}` needs derivatives, and `{word}` of an "
            f"analysis has none; give it `differences` or `adjoint`, or use a method without "
            f"derivatives: {', '.join(others)}"
        )
    return replace(study, outputs=own, constraints=(), derivatives=derivatives), bounds


def optimize(
    study: Study,
    store: str | os.PathLike[str],
    *,
    processes: int = 2,
    progress: Callable[[int, float], None] | None = None,
) -> Optimum:
    """Minimise or maximise objectives over the inputs within the constraints.

    Parameters
    ----------
    study
        A definition with a goal.
    store
        The SQLite file: points that it has are not evaluated again.
    processes
        The number of points evaluated at a time, for methods with a population.
    progress
        Called with the number of evaluations and the best feasible value of the first objective.

    Returns
    -------
    Optimum
        The best feasible evaluated point (of the first objective); if there is none, the one
        that violates the constraints least.

    Raises
    ------
    StudyError
        If the study has no goal, or a method needs derivatives that an analysis has not.
    MissingPackageError
        If the optimiser's package is not installed.
    Error
        If the model has no numbers at the start.
    """
    from moldloft.study.optimizers import METHODS

    if study.goal is None:
        raise StudyError("`[optimize]` is missing: it names the objective")
    prepared, bounds = _prepared(study)
    check_programs(study)
    method = METHODS[study.goal.method]()
    with Cases(prepared) as cases, Store(store, writing=True) as kept:
        points = Points(cases, kept, ranges(study, cases.model), study.goal.evaluations, processes)
        rest = [study.goal.start.get(n, float(cases.model.eval(n))) for n in cases.names]
        search = Search(study, bounds, points, progress)
        starts = [points.unit(np.array(rest))]
        if study.goal.warm:
            starts = [points.unit(p) for p in search.stored(kept)] or starts
        kept.begin({"model": str(study.model), "digest": cases.digest, "plan": "optimize"}, [])
        try:
            search.start(starts)
            try:
                message, converged = method(study.goal, search)
            except LimitError:
                message = f"the limit of {study.goal.evaluations} evaluations was reached"
                converged = False
        finally:
            end_workers()
        best = search.optimum(message, converged)
        facts = {"objectives": json.dumps(search.senses), "feasible": json.dumps(search.feasible)}
        kept.note({**facts, "front": json.dumps([o.key for o in best.front])})
        return best


class Search:
    """Objectives and constraints scaled by their initial magnitudes, and the best point so far."""

    def __init__(
        self,
        study: Study,
        bounds: list[Bound],
        points: Points,
        progress: Callable[[int, float], None] | None,
    ) -> None:
        assert study.goal is not None
        self.goal = study.goal
        self.bounds = bounds
        self.points = points
        self.progress = progress
        self.names = [o.output for o in self.goal.objectives]
        self.signs = np.array([-1.0 if o.maximise else 1.0 for o in self.goal.objectives])
        self.scales = np.ones(len(self.names))
        """Magnitudes of the objectives at the start."""
        self.sizes = np.ones(len(bounds))
        """Magnitudes of the constraints at the start."""
        self.starts: list[Floats] = []
        self.low = self.high = np.empty(0)
        self.best: tuple[float, float, Outcome] | None = None
        self._feasible: dict[str, Outcome] = {}

    @property
    def senses(self) -> dict[str, float]:
        """Sign of each objective, by name: 1 to minimise, -1 to maximise."""
        return dict(zip(self.names, self.signs.tolist(), strict=True))

    @property
    def feasible(self) -> list[str]:
        """The keys of the feasible points."""
        return list(self._feasible)

    def stored(self, store: Store) -> list[Floats]:
        """The best points of the store within the ranges, at most one population."""
        names = self.points.cases.names
        used = {*self.names, *(b.name for b in self.bounds)}
        rows = []
        for found in store.outcomes():
            if found.state != DONE or not used <= found.outputs.keys():
                continue
            if set(found.inputs) != set(names):
                continue
            point = np.array([found.inputs[n] for n in names])
            if (np.abs(point - self.points._point(self.points.unit(point))) <= 1e-12).all():
                violation = self._violation(found, self._sizes(found))
                first = self.signs[0] * found.outputs[self.names[0]]
                rows.append((max(violation, FEASIBLE), first, found.key, point))
        rows.sort(key=lambda row: row[:3])
        return [row[3] for row in rows[: self.population]]

    @property
    def population(self) -> int:
        """The points of one generation."""
        several = len(self.names) > 1
        default = 40 if several else max(15 * len(self.points.low), 20)
        return min(self.goal.population or default, self.goal.evaluations)

    def _sizes(self, found: Outcome) -> Floats:
        sizes = []
        for bound in self.bounds:
            limits = [abs(v) for v in (bound.low, bound.high) if np.isfinite(v)]
            sizes.append(max([*limits, 0.0]) or abs(found.outputs[bound.name]) or 1.0)
        return np.array(sizes)

    def _violation(self, found: Outcome, sizes: Floats) -> float:
        """The greatest violation of a constraint, in its size."""
        return max(
            (
                max(b.low - found.outputs[b.name], found.outputs[b.name] - b.high, 0.0) / s
                for b, s in zip(self.bounds, sizes, strict=True)
            ),
            default=0.0,
        )

    def start(self, units: Sequence[Floats]) -> None:
        """Evaluate the start; its values scale objectives and constraints."""
        self.starts = list(units)
        try:
            first = self.points.at(units[0])
        except NoNumbersError as failed:
            raise Error(f"the model has no numbers at the start: {failed}") from None
        self.scales = np.array([abs(first.outputs[n]) or 1.0 for n in self.names])
        self.sizes = self._sizes(first)
        self.low = np.array([b.low for b in self.bounds]) / self.sizes
        self.high = np.array([b.high for b in self.bounds]) / self.sizes
        self.points.seen = self._seen
        self._seen(first)

    def _seen(self, found: Outcome) -> None:
        if found.state != DONE:
            return
        violation = self._violation(found, self.sizes)
        if violation <= FEASIBLE:
            violation = 0.0
            self._feasible[found.key] = found
        rank = violation, self.signs[0] * found.outputs[self.names[0]]
        if self.best is None or rank < self.best[:2]:
            self.best = *rank, found
        if self.progress and self.best is not None:
            self.progress(self.points.evaluated, self.signs[0] * self.best[1])

    # -- one objective, one point ----------------------------------------------------------

    def objective(self, unit: Floats) -> float:
        """The first objective, scaled."""
        return float(self.values(np.asarray(unit)[None])[0][0, 0])

    def gradient(self, unit: Floats) -> Floats:
        """The derivatives of the first objective, scaled."""
        try:
            slope = self.points.slope(self.names[0], unit)
        except NoNumbersError:
            return np.zeros(len(unit))
        found: Floats = self.signs[0] * slope / self.scales[0]
        return found

    def constraints(self, unit: Floats) -> Floats:
        """All constraints, scaled, ``(constraints,)``."""
        found: Floats = self.values(np.asarray(unit)[None])[1][0]
        return found

    def jacobian(self, unit: Floats) -> Floats:
        """Their derivatives, ``(constraints, inputs)``."""
        try:
            rows = [self.points.slope(b.name, unit) for b in self.bounds]
        except NoNumbersError:
            return np.zeros((len(self.bounds), len(unit)))
        return np.reshape(rows, (len(self.bounds), len(unit))) / self.sizes[:, None]

    # -- several of both -------------------------------------------------------------------

    def values(self, units: Floats) -> tuple[Floats, Floats]:
        """Objectives to minimise and constraints, each ``(points, ...)``.

        1e10 where the model fails.
        """
        objectives = np.full((len(units), len(self.names)), FAILED)
        constraints = np.full((len(units), len(self.bounds)), FAILED)
        for k, found in enumerate(self.points.batch(units)):
            if found.state == DONE:
                values = np.array([found.outputs[n] for n in self.names])
                objectives[k] = self.signs * values / self.scales
                held = np.array([found.outputs[b.name] for b in self.bounds])
                constraints[k] = held / self.sizes
        return objectives, constraints

    def violations(self, constraints: Floats) -> Floats:
        """Excess of constraints over their limits, ``(points, constraints)``, or 0."""
        found: Floats = np.maximum(np.maximum(self.low - constraints, constraints - self.high), 0)
        return found

    def optimum(self, message: str, converged: bool) -> Optimum:
        """The best point, and the front of several objectives."""
        assert self.best is not None
        violation, _, found = self.best
        held = list(self._feasible.values())
        chosen: tuple[Outcome, ...] = ()
        if len(self.names) > 1 and held:
            table = np.array([[o.outputs[n] for n in self.names] for o in held])
            chosen = tuple(held[k] for k in front(table * self.signs))
        return Optimum(
            dict(found.inputs),
            dict(found.outputs),
            converged,
            violation == 0.0,
            message,
            self.points.evaluated,
            chosen,
        )

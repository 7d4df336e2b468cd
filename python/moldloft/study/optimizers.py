"""The optimisers: SciPy, Ipopt, pymoo and Optuna on one search."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.study.definition import BY_GRADIENTS, Goal
from moldloft.study.extras import needed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.study.optimizing import Search

    Floats = NDArray[np.float64]

    Method = Callable[[Goal, Search], tuple[str, bool]]

__all__ = ["METHODS"]

#: Constraints count as held by population methods, and at the end of the others, within this
#: fraction of their size: a population meets no equality exactly.
HELD = 1e-6

#: Slopes at the start below this, in objectives by ranges, count as it: the start may be the end.
LEAST_SLOPE = 1e-3

#: The curvature at the start is that of a step of this fraction of the ranges.
PROBE = 1e-2

#: Number of points requested from Optuna at a time.
BATCH = 4


def _scale(search: Search) -> float:
    """The factor of objective and constraints for which the first step of a method is a sound one.

    Quasi-Newton methods begin with the unit matrix for the Hessian of the Lagrangian. With this
    factor its curvature along the first step is 1 (Shanno and Phua 1978, by one evaluation more),
    unless the input of the steepest slope would cross its range in that step.
    """
    start = search.starts[0]
    gradient, rows = search.gradient(start), search.jacobian(start)
    steepest = float(np.abs(gradient).max(initial=0.0))
    if steepest <= LEAST_SLOPE:
        return 1.0 / LEAST_SLOPE
    equal = np.array([b.equal for b in search.bounds], dtype=bool)
    multipliers = np.zeros(len(search.bounds))
    multipliers[equal] = np.linalg.lstsq(rows[equal].T, gradient, rcond=None)[0]
    tangent = gradient - multipliers @ rows
    size = max(float(np.abs(tangent).max()), np.finfo(np.float64).tiny)
    end = np.clip(start - PROBE / size * tangent, 0.0, search.points.most)
    step = end - start
    if not search.points.has_numbers(end) or not step.any():
        return 1.0 / steepest
    change = search.gradient(end) - multipliers @ search.jacobian(end) - tangent
    curvature = float(step @ change) / float(step @ step)
    return 1.0 / max(curvature, steepest)


def _scipy(goal: Goal, search: Search, scipy: Any) -> tuple[str, bool]:
    by_gradients = goal.method in BY_GRADIENTS
    scale = _scale(search) if by_gradients else 1.0
    curvature = _Curvature(search, scale) if goal.method == "trust-constr" else None
    constraints = []
    # SciPy takes equalities apart from limits.
    for equal in (True, False):
        chosen = np.flatnonzero([b.equal == equal for b in search.bounds])
        if chosen.size:
            more: dict[str, Any] = {}
            if by_gradients:
                more["jac"] = _rows(search.jacobian, chosen, scale)
            if curvature:
                more["hess"] = curvature.of(chosen)
            low, high = scale * search.low[chosen], scale * search.high[chosen]
            value = _rows(search.constraints, chosen, scale)
            constraints.append(scipy.NonlinearConstraint(value, low, high, **more))
    options: dict[str, Any] = {"maxiter": goal.evaluations}
    if goal.method == "slsqp":
        options["ftol"] = scale * goal.tolerance
    elif curvature:
        options |= {"gtol": scale * goal.tolerance, "xtol": goal.tolerance}
        # A barrier of the size of the tolerance from the start: no sequence of barriers.
        options |= dict.fromkeys(
            ("initial_barrier_parameter", "initial_barrier_tolerance"), goal.tolerance
        )
    else:
        options = {"maxfev": goal.evaluations, "final_tr_radius": goal.tolerance}

    def gradient(unit: Floats) -> Floats:
        return curvature.gradient(unit) if curvature else scale * search.gradient(unit)

    found = scipy.minimize(
        lambda unit: scale * search.objective(unit),
        search.starts[0],
        jac=gradient if by_gradients else None,
        hess=curvature.update(scipy.BFGS) if curvature else None,
        method=goal.method,
        bounds=scipy.Bounds(np.zeros(len(search.points.most)), search.points.most),
        constraints=constraints,
        options=options,
    )
    over = float(search.violations(search.constraints(found.x)[None]).max(initial=0.0))
    if found.success and over > max(goal.tolerance, HELD):
        # COBYQA may end with the smallest step at a point outside the limits.
        said = f"the optimiser ended where a constraint is violated by {over:.2g} of its limit"
        return said, False
    return str(found.message), bool(found.success)


class _Curvature:
    """The Hessian of the Lagrangian for `trust-constr`, by the BFGS formula.

    SciPy approximates objective and constraints apart, each by a positive definite matrix, which
    takes three times as many points. Here the constraints' part is in the objective's matrix.
    """

    def __init__(self, search: Search, scale: float) -> None:
        self._search, self._scale = search, scale
        self._multipliers = np.zeros(len(search.bounds))
        self._unit = search.starts[0]

    def of(self, chosen: Any) -> Callable[[Floats, Floats], Floats]:
        """The Hessian of constraints, none of its own: their multipliers are kept."""

        def hessian(unit: Floats, multipliers: Floats) -> Floats:
            self._multipliers[chosen] = multipliers
            return np.zeros((len(unit), len(unit)))

        return hessian

    def gradient(self, unit: Floats) -> Floats:
        """The objective's gradient; the point is that of the next update."""
        self._unit = np.array(unit)
        return self._scale * self._search.gradient(unit)

    def update(self, formula: type) -> Any:
        """The matrix by a formula of SciPy for the objective alone."""

        def of_lagrangian(step: Floats, change: Floats) -> None:
            ends = [self._search.jacobian(at) for at in (self._unit, self._unit - step)]
            curved = self._scale * self._multipliers @ (ends[0] - ends[1])
            of_objective(step, change + curved)

        # The unit matrix is the right one at the start, by the factor of `_scale`.
        matrix = formula(exception_strategy="damp_update", init_scale=1.0)
        of_objective, matrix.update = matrix.update, of_lagrangian
        return matrix


def _rows(
    function: Callable[[Floats], Floats], chosen: Any, scale: float
) -> Callable[[Floats], Floats]:
    return lambda unit: scale * function(unit)[chosen]


def _differential_evolution(goal: Goal, search: Search, scipy: Any) -> tuple[str, bool]:
    """Whole generations at once, so that they are evaluated in parallel."""
    constraints = []
    if search.bounds:
        constraints.append(
            scipy.NonlinearConstraint(
                lambda units: search.values(np.atleast_2d(units.T))[1].T, search.low, search.high
            )
        )
    found = scipy.differential_evolution(
        lambda units: search.values(np.atleast_2d(units.T))[0][:, 0],
        scipy.Bounds(np.zeros(len(search.points.most)), search.points.most),
        constraints=constraints,
        rng=goal.seed,
        init=_population(search, max(search.population, 5), goal.seed),
        polish=False,
        tol=goal.tolerance,
        maxiter=goal.evaluations,
        vectorized=True,
        updating="deferred",
    )
    return str(found.message), bool(found.success)


def _population(search: Search, count: int, seed: int) -> Floats:
    """The first generation: the starts, and a Latin hypercube."""
    qmc = needed("scipy.stats.qmc", "study", "a population")
    size = len(search.points.most)
    filled = qmc.LatinHypercube(size, rng=seed).random(count) * search.points.most
    starts = np.array(search.starts[:count])
    found: Floats = np.concatenate([starts, filled[len(starts) :]])
    return found


def _ipopt(goal: Goal, search: Search, cyipopt: Any) -> tuple[str, bool]:
    size, rows = len(search.points.most), len(search.bounds)

    class Problem:
        """Callbacks with the names that cyipopt requires."""

        def objective(self, unit: Floats) -> float:
            return search.objective(unit)

        def gradient(self, unit: Floats) -> Floats:
            return search.gradient(unit)

        def constraints(self, unit: Floats) -> Floats:
            return search.constraints(unit)

        def jacobian(self, unit: Floats) -> Floats:
            return search.jacobian(unit).ravel()

    problem = cyipopt.Problem(
        n=size,
        m=rows,
        problem_obj=Problem(),
        lb=np.zeros(size),
        ub=search.points.most,
        cl=search.low,
        cu=search.high,
    )
    options = {
        "hessian_approximation": "limited-memory",
        "tol": goal.tolerance,
        "max_iter": goal.evaluations,
        "print_level": 0,
        "sb": "yes",
        # Limits are exact: outside them the model may have no numbers.
        "bound_relax_factor": 0.0,
    }
    for name, value in options.items():
        problem.add_option(name, value)
    _, info = problem.solve(search.starts[0])
    said = info["status_msg"]
    message = said.decode() if isinstance(said, bytes) else str(said)
    # 0: solved, 1: solved to an acceptable level.
    return message, info["status"] in (0, 1)


def _nsga2(goal: Goal, search: Search, module: Any) -> tuple[str, bool]:
    core = needed("pymoo.core.problem", "optimizers", "nsga2")
    evaluator = needed("pymoo.core.evaluator", "optimizers", "nsga2").Evaluator
    static = needed("pymoo.problems.static", "optimizers", "nsga2").StaticProblem
    problem = core.Problem(
        n_var=len(search.points.most),
        n_obj=len(search.names),
        n_ieq_constr=len(search.bounds),
        xl=np.zeros(len(search.points.most)),
        xu=search.points.most,
    )
    count = search.population
    algorithm = module.NSGA2(pop_size=count, sampling=_population(search, count, goal.seed))
    limit = max(goal.evaluations // count, 1)
    algorithm.setup(problem, termination=("n_gen", limit), seed=goal.seed, verbose=False)
    while algorithm.has_next():
        infills = algorithm.ask()
        objectives, constraints = search.values(infills.get("X"))
        over = search.violations(constraints)
        over = np.where(over <= HELD, 0.0, over)
        evaluator().eval(static(problem, F=objectives, G=over), infills)
        algorithm.tell(infills=infills)
    return f"{limit} generations of {count}", True


def _tpe(goal: Goal, search: Search, optuna: Any) -> tuple[str, bool]:
    names = search.points.cases.names
    uniform = optuna.distributions.FloatDistribution
    space = {n: uniform(0.0, m) for n, m in zip(names, search.points.most, strict=True)}
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        asked = optuna.create_study(
            directions=["minimize"] * len(search.names),
            sampler=optuna.samplers.TPESampler(seed=goal.seed),
        )
        for unit in search.starts:
            asked.enqueue_trial(dict(zip(names, unit.tolist(), strict=True)))
        for first in range(0, goal.evaluations, BATCH):
            count = min(BATCH, goal.evaluations - first)
            trials = [asked.ask(space) for _ in range(count)]
            units = np.array([[trial.params[n] for n in names] for trial in trials])
            objectives, constraints = search.values(units)
            over = search.violations(constraints)
            for trial, values, above in zip(trials, objectives, over, strict=True):
                # Optuna counts a value above 0 as a violation.
                for bound, excess in zip(search.bounds, above, strict=True):
                    held = excess <= HELD
                    trial.set_constraint(bound.name, 0.0 if held else float(excess))
                asked.tell(trial, values.tolist())
    finally:
        optuna.logging.set_verbosity(verbosity)
    return f"{goal.evaluations} trials", True


def _bound(method: Callable[..., tuple[str, bool]], module: str, extra: str, name: str) -> Method:
    """A method with its package, which is looked for before anything is evaluated."""
    return partial(_called, method, needed(module, extra, f"the optimiser `{name}`"))


def _called(
    method: Callable[..., tuple[str, bool]], module: Any, goal: Goal, search: Search
) -> tuple[str, bool]:
    return method(goal, search, module)


METHODS: dict[str, Callable[[], Method]] = {
    name: partial(_bound, method, module, extra, name)
    for name, method, module, extra in (
        ("slsqp", _scipy, "scipy.optimize", "study"),
        ("trust-constr", _scipy, "scipy.optimize", "study"),
        ("cobyqa", _scipy, "scipy.optimize", "study"),
        ("differential-evolution", _differential_evolution, "scipy.optimize", "study"),
        ("ipopt", _ipopt, "cyipopt", "ipopt"),
        ("nsga2", _nsga2, "pymoo.algorithms.moo.nsga2", "optimizers"),
        ("tpe", _tpe, "optuna", "optimizers"),
    )
}
"""The optimisers by name: functions that import their package and return the method."""

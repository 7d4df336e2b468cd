"""Numbers of a model as functions of others, with exact derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["Function", "function", "jacobian"]

#: So many times more inputs than numbers of the outputs, and gradients take less time than columns.
_FEW_NUMBERS = 4

#: Half the distance between the gradients of a Hessian's product, relative to the point: rounding
#: of the gradients and the third derivatives count about the same.
_HESSIAN_STEP = 1e-5


def jacobian(
    model: Model, expressions: Sequence[str], sizes: Sequence[int], inputs: Sequence[str]
) -> Floats:
    """The exact derivatives of expressions with respect to inputs, at the model's state.

    Parameters
    ----------
    model
        The model, not changed.
    expressions
        Numbers, vectors or arrays.
    sizes
        The number of values of each.
    inputs
        Parameters and literals.

    Returns
    -------
    numpy.ndarray
        ``(values, inputs)``: in reverse mode if there are few values for each input.

    Raises
    ------
    Error
        If an expression has another size.
    """
    total = sum(sizes)
    # A row of weights for each number costs less than four inputs at a time.
    if _FEW_NUMBERS * total <= len(inputs):
        return _pulled(model, expressions, sizes, inputs, np.eye(total))
    rows = model.derivatives(list(expressions), list(inputs))
    blocks = []
    for row, size in zip(rows, sizes, strict=True):
        columns = [np.asarray(value, dtype=np.float64).ravel() for value in row]
        if any(c.size != size for c in columns):
            raise Error("an output has changed its size")
        blocks.append(np.stack(columns, axis=1))
    found: Floats = np.concatenate(blocks)
    return found


def _pulled(
    model: Model,
    expressions: Sequence[str],
    sizes: Sequence[int],
    inputs: Sequence[str],
    weights: Floats,
) -> Floats:
    """Derivatives of weighted sums of the expressions, (sums, inputs)."""
    parts = np.split(weights, np.cumsum(sizes)[:-1], axis=1)
    outputs = list(zip(expressions, map(np.ascontiguousarray, parts), strict=True))
    rows, _ = _core.vjp(model._document, outputs, list(inputs), "")
    return rows


class Function:
    """Numbers of a model as a function of others of its numbers, with exact derivatives.

    Made by :func:`function`. Calling it sets the inputs in the model and evaluates the outputs.
    """

    def __init__(self, model: Model, inputs: Sequence[str], outputs: Mapping[str, str]) -> None:
        self.model = model
        """The model; calls change it."""
        self.inputs = tuple(inputs)
        """The names of the inputs."""
        self.outputs = dict(outputs)
        """The expressions of the outputs by name."""
        if not self.inputs or not self.outputs:
            raise Error("a function needs an input and an output at least")
        if len(set(self.inputs)) < len(self.inputs):
            raise Error("an input is named twice")
        self.sizes = {name: self._value(name).size for name in self.outputs}
        """The number of values of each output."""
        # An input that cannot be differentiated or set is an error now, not during a study.
        start = self.start
        self.model.set(dict(zip(self.inputs, start.tolist(), strict=True)))
        self._pulled(np.ones((1, sum(self.sizes.values()))))

    @property
    def start(self) -> Floats:
        """The current inputs of the model."""
        found: Floats = np.array([float(self.model.eval(name)) for name in self.inputs])
        return found

    @property
    def bounds(self) -> list[tuple[float | None, float | None]]:
        """The ranges of the inputs in the model; None without a bound."""
        known = self.model.params
        return [
            (known[name].low, known[name].high) if name in known else (None, None)
            for name in self.inputs
        ]

    def _value(self, name: str) -> Floats:
        value = self.model.eval(self.outputs[name])
        try:
            found: Floats = np.atleast_1d(np.asarray(value, dtype=np.float64)).ravel()
        except (TypeError, ValueError):
            raise Error(f"output `{name}` is not a number, vector or array") from None
        return found

    def _set(self, x: ArrayLike) -> None:
        values = np.asarray(x, dtype=np.float64).ravel()
        if values.shape != (len(self.inputs),):
            raise Error(f"{len(self.inputs)} inputs are needed, {values.size} were given")
        if not np.isfinite(values).all():
            bad = self.inputs[int(np.flatnonzero(~np.isfinite(values))[0])]
            raise Error(f"input `{bad}` is not a finite number")
        self.model.set(dict(zip(self.inputs, values.tolist(), strict=True)))

    def __call__(self, x: ArrayLike) -> Floats:
        """The outputs, one after the other, at these inputs."""
        self._set(x)
        return np.concatenate([self._value(name) for name in self.outputs])

    def jacobian(self, x: ArrayLike) -> Floats:
        """The exact derivatives of the outputs with respect to the inputs, ``(outputs, inputs)``.

        Parameters
        ----------
        x
            Values of the inputs, ``(inputs,)``.

        Returns
        -------
        numpy.ndarray
            Exact, not by differences.
        """
        self._set(x)
        return self._derivatives()

    def _derivatives(self) -> Floats:
        return jacobian(
            self.model, list(self.outputs.values()), list(self.sizes.values()), self.inputs
        )

    def _pulled(self, weights: Floats) -> Floats:
        expressions, sizes = list(self.outputs.values()), list(self.sizes.values())
        return _pulled(self.model, expressions, sizes, self.inputs, weights)

    def vjp(self, x: ArrayLike, weights: ArrayLike) -> Floats:
        """The exact derivatives of a weighted sum of the outputs with respect to all inputs.

        Parameters
        ----------
        x
            Values of the inputs, ``(inputs,)``.
        weights
            Weights of the outputs, ``(outputs,)``, or ``(N, outputs)`` for N sums.

        Returns
        -------
        numpy.ndarray
            The product of the weights with :meth:`jacobian`: ``(inputs,)``, or ``(N, inputs)``. See
            :meth:`moldloft.Model.vjp` for the cost.

        Raises
        ------
        Error
            When weights do not fit the outputs.
        """
        w: Floats = np.asarray(weights, dtype=np.float64)
        total = sum(self.sizes.values())
        if w.ndim not in (1, 2) or w.shape[-1] != total:
            raise Error(f"weights ({total},) or (N, {total}) are needed, {w.shape} were given")
        self._set(x)
        rows = self._pulled(np.atleast_2d(w))
        return rows[0] if w.ndim == 1 else rows

    def jvp(self, x: ArrayLike, rates: ArrayLike) -> Floats:
        """The rates of change of the outputs for given rates of the inputs.

        Parameters
        ----------
        x
            Values of the inputs, ``(inputs,)``.
        rates
            Rates of the inputs, ``(inputs,)``.

        Returns
        -------
        numpy.ndarray
            The product of :meth:`jacobian` with the rates, ``(outputs,)``, by one evaluation.

        Raises
        ------
        Error
            When there are not as many rates as inputs.
        """
        given: Floats = np.asarray(rates, dtype=np.float64)
        if given.shape != (len(self.inputs),):
            raise Error(f"rates ({len(self.inputs)},) are needed, {given.shape} were given")
        self._set(x)
        directions = list(zip(self.inputs, given.tolist(), strict=True))
        return np.concatenate(
            _core.jvp(self.model._document, list(self.outputs.values()), directions)
        )

    def hvp(self, x: ArrayLike, weights: ArrayLike, direction: ArrayLike) -> Floats:
        """The derivative, in a direction, of the gradient of a weighted sum of the outputs.

        Parameters
        ----------
        x
            Values of the inputs, ``(inputs,)``.
        weights
            Weights of the outputs, ``(outputs,)``.
        direction
            A direction in the inputs, ``(inputs,)``.

        Returns
        -------
        numpy.ndarray
            The product of the sum's Hessian with the direction, ``(inputs,)``.

        Raises
        ------
        Error
            When weights or direction do not fit.

        Notes
        -----
        The central difference of two exact gradients over 2e-5 of the point's size: about nine
        digits where third derivatives are of the size of the second. The model is then at `x`.
        """
        at, along = (np.asarray(v, dtype=np.float64) for v in (x, direction))
        if along.shape != (len(self.inputs),) or at.shape != along.shape:
            raise Error(
                f"a point and a direction ({len(self.inputs)},) are needed, {at.shape} and "
                f"{along.shape} were given"
            )
        longest = float(np.abs(along).max())
        if longest == 0.0:
            return np.zeros_like(along)
        step = _HESSIAN_STEP * max(float(np.abs(at).max()), 1.0) / longest
        after, before = (self.vjp(at + s * step * along, weights) for s in (1.0, -1.0))
        self._set(at)
        found: Floats = (after - before) / (2.0 * step)
        return found

    def value_and_jacobian(self, x: ArrayLike) -> tuple[Floats, Floats]:
        """Outputs and derivatives at the given inputs.

        Parameters
        ----------
        x
            Values of the inputs, ``(inputs,)``.

        Returns
        -------
        tuple of two numpy.ndarray
            ``(outputs,)`` and ``(outputs, inputs)``.
        """
        values = self(x)
        return values, self._derivatives()


def function(
    model: Model, inputs: Sequence[str], outputs: Sequence[str] | Mapping[str, str]
) -> Function:
    """Numbers of a model as a function of others, with exact derivatives.

    Parameters
    ----------
    model
        The model; calls change it.
    inputs
        Parameters, or literals such as ``"P21.y"``.
    outputs
        Expressions, or names with expressions. Values may be numbers, vectors or arrays.

    Returns
    -------
    Function
        Called with an array of the inputs it returns one of the outputs.

    Raises
    ------
    Error
        For inputs that cannot be set and outputs that are not numbers.
    """
    named = dict(outputs) if isinstance(outputs, Mapping) else {text: text for text in outputs}
    return Function(model, inputs, named)


explain(globals())

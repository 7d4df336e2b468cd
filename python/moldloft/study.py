"""Models in optimisation: a callable with exact derivatives, and an OpenMDAO component.

>>> import moldloft
>>> from moldloft.study import function
>>> m = moldloft.loads('''
... param float beam = 2 in [1, 3]; param float depth = 1 in [0, 2];
... AbsPoint A(0, beam, depth);
... ''')
>>> f = function(m, ["beam", "depth"], {"size": "sqrt(A.y * A.y + A.z * A.z)", "area": "A.y * A.z"})
>>> f([2.0, 1.0])
array([2.23606798, 2.        ])
>>> f.jacobian([2.0, 1.0])
array([[0.89442719, 0.4472136 ],
       [1.        , 2.        ]])
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error, UnknownNameError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["Function", "component", "function"]


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
        # What cannot be differentiated or set is an error now, not in the midst of a study.
        start = self.start
        self.model.set(dict(zip(self.inputs, start.tolist(), strict=True)))
        self._derivatives()

    @property
    def start(self) -> Floats:
        """The inputs as they are in the model."""
        found: Floats = np.array([float(self.model.eval(name)) for name in self.inputs])
        return found

    @property
    def bounds(self) -> list[tuple[float | None, float | None]]:
        """The ranges that the model states for the inputs, None where there is no bound."""
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
        """The exact derivatives of the outputs by the inputs, ``(outputs, inputs)``.

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
        rows = self.model.derivatives(list(self.outputs.values()), list(self.inputs))
        blocks = []
        for row, size in zip(rows, self.sizes.values(), strict=True):
            columns = [np.asarray(value, dtype=np.float64).ravel() for value in row]
            if any(c.size != size for c in columns):
                raise Error("an output has changed its size")
            blocks.append(np.stack(columns, axis=1))
        found: Floats = np.concatenate(blocks)
        return found

    def value_and_jacobian(self, x: ArrayLike) -> tuple[Floats, Floats]:
        """Outputs and derivatives at these inputs.

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
        For inputs that cannot be set and outputs that are no numbers.
    """
    named = dict(outputs) if isinstance(outputs, Mapping) else {text: text for text in outputs}
    return Function(model, inputs, named)


def _plain(name: str) -> str:
    """A name that OpenMDAO takes."""
    word = "".join(c if c.isalnum() else "_" for c in name).strip("_")
    return word if word and word[0].isalpha() else f"x_{word}"


def component(
    model: Model, inputs: Sequence[str], outputs: Sequence[str] | Mapping[str, str]
) -> Any:
    """An ``openmdao.api.ExplicitComponent`` with exact partial derivatives.

    Inputs start at the model's values. A state at which the model fails raises OpenMDAO's
    ``AnalysisError``, so that line searches step back.

    Parameters
    ----------
    model
        The model; runs change it.
    inputs
        Parameters, or literals such as ``"P21.y"`` (named ``P21_y`` in OpenMDAO).
    outputs
        Expressions, or names with expressions.

    Returns
    -------
    openmdao.api.ExplicitComponent
        With the inputs and outputs named.
    """
    try:
        import openmdao.api as om
    except ImportError as error:
        raise Error(f"this needs openmdao: pip install 'moldloft[study]' ({error})") from error
    of = function(model, inputs, outputs)
    ins = [_plain(name) for name in of.inputs]
    outs = [_plain(name) for name in of.outputs]
    for names in (ins, outs):
        if len(set(names)) < len(names):
            raise UnknownNameError(f"two of {', '.join(names)} have one name in OpenMDAO")
    if clash := set(ins) & set(outs):
        raise UnknownNameError(f"`{clash.pop()}` is the name of an input and of an output")

    class ModelComponent(om.ExplicitComponent):  # type: ignore[misc]
        def setup(self) -> None:
            for name, value in zip(ins, of.start, strict=True):
                self.add_input(name, val=value)
            for name, size in zip(outs, of.sizes.values(), strict=True):
                self.add_output(name, shape=(size,))
            self.declare_partials("*", "*")

        def _point(self, values: Any) -> Floats:
            point: Floats = np.array([float(np.ravel(values[name])[0]) for name in ins])
            return point

        def compute(self, inputs: Any, outputs: Any) -> None:
            try:
                values = of(self._point(inputs))
            except Error as error:
                raise om.AnalysisError(str(error)) from error
            at = 0
            for name, size in zip(outs, of.sizes.values(), strict=True):
                outputs[name] = values[at : at + size]
                at += size

        def compute_partials(self, inputs: Any, partials: Any) -> None:
            try:
                slopes = of.jacobian(self._point(inputs))
            except Error as error:
                raise om.AnalysisError(str(error)) from error
            at = 0
            for name, size in zip(outs, of.sizes.values(), strict=True):
                for k, own in enumerate(ins):
                    partials[name, own] = slopes[at : at + size, k : k + 1]
                at += size

    return ModelComponent()


explain(globals())

"""Models as components of OpenMDAO."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error, UnknownNameError
from moldloft.study.extras import needed
from moldloft.study.functions import function

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["component"]


def _plain(name: str) -> str:
    """A name that OpenMDAO takes."""
    word = "".join(c if c.isalnum() else "_" for c in name).strip("_")
    return word if word and word[0].isalpha() else f"x_{word}"


def component(
    model: Model,
    inputs: Sequence[str],
    outputs: Sequence[str] | Mapping[str, str],
    *,
    matrix_free: bool = False,
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
    matrix_free
        Products with the Jacobian instead of the matrix, which is never formed: for many inputs and
        iterative linear solvers.

    Returns
    -------
    openmdao.api.ExplicitComponent
        With the inputs and outputs named.
    """
    needed("openmdao", "study", "a component")
    import openmdao.api as om

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
            if not matrix_free:
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

    class ByMatrix(ModelComponent):
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

    class ByProducts(ModelComponent):
        def compute_jacvec_product(
            self, inputs: Any, d_inputs: Any, d_outputs: Any, mode: str
        ) -> None:
            point = self._point(inputs)
            ends = np.cumsum(list(of.sizes.values()))[:-1]
            try:
                if mode == "fwd":
                    rates = [float(np.ravel(d_inputs[n])[0]) if n in d_inputs else 0 for n in ins]
                    changes = np.split(of.jvp(point, rates), ends)
                    for name, change in zip(outs, changes, strict=True):
                        if name in d_outputs:
                            d_outputs[name] += change
                    return
                sizes = of.sizes.values()
                weights = [
                    np.ravel(d_outputs[name]) if name in d_outputs else np.zeros(size)
                    for name, size in zip(outs, sizes, strict=True)
                ]
                slopes = of.vjp(point, np.concatenate(weights))
                for name, slope in zip(ins, slopes, strict=True):
                    if name in d_inputs:
                        d_inputs[name] += slope
            except Error as error:
                raise om.AnalysisError(str(error)) from error

    return ByProducts() if matrix_free else ByMatrix()


explain(globals())

"""The derivatives of a model: Jacobians, gradients, products with them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast, overload

from moldloft import _core
from moldloft.arguments import explain, names_of
from moldloft.errors import Error

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["Differentiable"]

#: Outputs that are the vertices of a mesh, ``(n, 3)``.
_MESHES = ("mesh", "blocks")


class Differentiable:
    """The methods of a model that differentiate it."""

    if TYPE_CHECKING:

        @property
        def _document(self) -> _core.Document: ...

    def block_jacobian(self, by: Sequence[str]) -> Floats:
        """Exact derivatives of every vertex of :meth:`blocks`, ``(n, 3, len(by))``.

        Parameters
        ----------
        by
            Parameters, or literals such as ``"P21.x"``.

        Returns
        -------
        numpy.ndarray
            Shape ``(n, 3, len(by))``: the change of each vertex per unit of each parameter.

        Raises
        ------
        UnknownNameError
            When there is no such parameter or number.
        ModelError
            See :meth:`blocks`.
        """
        return self._document.block_jacobian(names_of(by))

    def jacobian(self, by: Sequence[str]) -> Floats:
        """Exact derivatives of every mesh vertex.

        Parameters
        ----------
        by
            Parameters, or literals of objects such as ``"P21.y"``.

        Returns
        -------
        numpy.ndarray
            Shape ``(vertices, 3, len(by))``.

        Raises
        ------
        UnknownNameError
            When there is no such parameter or number.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float beam = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint C(0, beam, 0);
        ... AbsPoint B(1, 0, 0); AbsPoint D(1, beam, 0);
        ... Line a(A, B); Line b(C, D);
        ... RuledSurf plate(a, b, divisions = {1, 1});
        ... ''')
        >>> m.jacobian(["beam"]).shape
        (4, 3, 1)
        >>> float(m.jacobian(["beam"])[:, 1, 0].sum())
        2.0
        """
        return self._document.jacobian(names_of(by))

    def derivative(self, expression: str, by: str) -> Any:
        """The exact derivative of a number or vector with respect to one parameter or literal.

        Parameters
        ----------
        expression
            Anything that :meth:`eval` takes, such as ``"hull.volume"`` or ``"length(keel)"``.
        by
            A parameter, or a literal such as ``"P21.y"``.

        Returns
        -------
        float or numpy.ndarray
            An array of the shape of the value, per unit of the parameter.

        Raises
        ------
        ModelError
            When the text is not an expression, or has no number as value.
        UnknownNameError
            When there is no such parameter or number.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 0, 0);")
        >>> m.derivative("P.x", "a")
        6.0
        """
        return self._document.derivatives([expression], [by])[0][0]

    def derivatives(self, expressions: Sequence[str], by: Sequence[str]) -> list[list[Any]]:
        """Exact derivatives of expressions with respect to parameters, ``[expression][by]``.

        Parameters
        ----------
        expressions
            Expressions of the language with a number or a vector as value.
        by
            Names of parameters.

        Returns
        -------
        list of list
            A row for each expression, in it a number or array for each parameter.

        Raises
        ------
        ModelError
            When a text is not an expression, or has no number as value.
        UnknownNameError
            When there is no such parameter or number.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> [[change]] = m.derivatives(["plate.area"], ["b"])
        >>> round(change, 9)
        4.0
        """
        return self._document.derivatives(names_of(expressions), names_of(by))

    @property
    def literals(self) -> list[str]:
        """The literals with respect to which the model can be differentiated, such as ``"P21.y"``.

        These are numbers in the arguments of objects, in the order of the text, without integers
        (counts, degrees) and without numbers in loaded files and in loops.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 1, 2);").literals
        ['P.y', 'P.z']
        """
        return _core.literals(self._document)

    @overload
    def vjp(self, weights: Mapping[str, ArrayLike], by: None = None) -> dict[str, Any]: ...
    @overload
    def vjp(self, weights: Mapping[str, ArrayLike], by: Sequence[str]) -> Floats: ...
    def vjp(
        self, weights: Mapping[str, ArrayLike], by: Sequence[str] | None = None
    ) -> dict[str, Any] | Floats:
        """Exact derivatives of a weighted sum of outputs with respect to many inputs at once.

        The product of a row vector, the weights, with the Jacobian (vector-Jacobian product,
        reverse mode): the cost of a few evaluations for any number of inputs. Weights on the mesh
        are the surface sensitivities of an adjoint solver, dJ/dx. Outputs without reverse mode
        (hydrostatics, sets, fairings, grids, sketches) are differentiated in forward mode, four
        inputs at a time; the numbers are the same.

        Parameters
        ----------
        weights
            Weights by output: ``"mesh"`` and ``"blocks"`` (vertices of :meth:`mesh` and
            :meth:`blocks`, ``(n, 3)``), or an expression as in :meth:`derivatives`, of the shape of
            its value. An axis of length N before makes N sums.
        by
            Parameters, or literals such as ``"P21.y"``; by default all parameters that are not
            whole numbers and all :attr:`literals`.

        Returns
        -------
        numpy.ndarray or dict
            Shape ``(len(by),)``, or ``(N, len(by))``. Without ``by`` a number, or an array
            ``(N,)``, for each name.

        Raises
        ------
        Error
            When weights do not have the shape of their output.
        UnknownNameError
            When there is no such parameter or number.
        ModelError
            When an output is not an expression, has no numbers as value, or has no derivative.

        Examples
        --------
        >>> import moldloft, numpy as np
        >>> m = moldloft.loads('''
        ... param float beam = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint C(0, beam, 0);
        ... AbsPoint B(1, 0, 0); AbsPoint D(1, beam, 0);
        ... Line a(A, B); Line b(C, D);
        ... RuledSurf plate(a, b, divisions = {1, 1});
        ... ''')
        >>> m.vjp({"mesh": np.ones((4, 3))}, ["beam", "B.x"])
        array([2., 1.])
        >>> sorted(m.vjp({"mesh.area": 1.0}).items())[-1]
        ('beam', 1.0)
        """
        names = self._inputs() if by is None else names_of(by)
        single, outputs = _flat(cast("Model", self), weights)
        rows, _ = _core.vjp(self._document, outputs, names, "")
        if by is None:
            columns = rows[0].tolist() if single else list(rows.T)
            return dict(zip(names, columns, strict=True))
        return rows[0] if single else rows

    def gradient(
        self, expression: str, by: Sequence[str] | None = None
    ) -> dict[str, float] | Floats:
        """Exact derivatives of one number with respect to many inputs; see :meth:`vjp`.

        Parameters
        ----------
        expression
            An expression with a number as value, such as ``"mesh.volume"``.
        by
            Parameters, or literals such as ``"P21.y"``; by default all.

        Returns
        -------
        numpy.ndarray or dict
            Shape ``(len(by),)``; without ``by`` a number for each name.

        Raises
        ------
        UnknownNameError
            When there is no such parameter or number.
        ModelError
            When the expression is none, is not a number, or has no derivative.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 1, 2);")
        >>> m.gradient("P.x * P.y"), m.gradient("P.x", ["a"])
        ({'a': 6.0, 'P.y': 9.0, 'P.z': 0.0}, array([6.]))
        """
        return self.vjp({expression: 1.0}, by) if by is not None else self.vjp({expression: 1.0})

    def value_and_gradient(
        self, expression: str, by: Sequence[str] | None = None
    ) -> tuple[float, dict[str, float] | Floats]:
        """One number and its exact derivatives with respect to many inputs, for optimisers.

        Parameters
        ----------
        expression
            An expression with a number as value, such as ``"mesh.volume"``.
        by
            Parameters, or literals such as ``"P21.y"``; by default all.

        Returns
        -------
        tuple
            The value, and what :meth:`gradient` returns.

        Raises
        ------
        UnknownNameError
            When there is no such parameter or number.
        ModelError
            When the expression is none, is not a number, or has no derivative.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 1, 2);")
        >>> m.value_and_gradient("P.x", ["a"])
        (9.0, array([6.]))
        """
        gradient = self.gradient(expression, by)
        return float(self._document.eval(expression)), gradient

    def jvp(self, directions: Mapping[str, float], outputs: Sequence[str]) -> dict[str, Any]:
        """The rates of change of outputs for given rates of the inputs.

        One evaluation in forward mode.

        Parameters
        ----------
        directions
            Rates by input: parameters, or literals such as ``"P21.y"``.
        outputs
            ``"mesh"``, ``"blocks"`` or expressions, as in :meth:`vjp`.

        Returns
        -------
        dict
            The product of the Jacobian with the rates for each output, of the shape of its value.

        Raises
        ------
        UnknownNameError
            When there is no such parameter or number.
        ModelError
            When an output is not an expression, has no numbers as value, or has no derivative.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 1, 2);")
        >>> m.jvp({"a": 0.5, "P.y": 2}, ["P", "P.x"])
        {'P': array([3., 2., 0.]), 'P.x': 3.0}
        """
        names = names_of(outputs)
        rates = [(name, float(rate)) for name, rate in directions.items()]
        changes = _core.jvp(self._document, names, rates)
        return {
            name: _shaped(change, _shape(cast("Model", self), name))
            for name, change in zip(names, changes, strict=True)
        }

    def linearize(
        self, outputs: Sequence[str]
    ) -> tuple[dict[str, Any], Callable[..., dict[str, Any] | Floats]]:
        """Values of outputs, with :meth:`vjp` as a function at this state of the model.

        Parameters
        ----------
        outputs
            ``"mesh"``, ``"blocks"`` or expressions, as in :meth:`vjp`.

        Returns
        -------
        tuple
            The values by output, and ``pull(weights, by=None)``, which returns what :meth:`vjp`
            does. After a change of the model it raises an :class:`Error`.

        Raises
        ------
        ModelError
            When an output has no value.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 1, 2);")
        >>> values, pull = m.linearize(["P.x"])
        >>> values, pull({"P.x": 10}, ["a"])
        ({'P.x': 9.0}, array([60.]))
        """
        model = cast("Model", self)
        names = names_of(outputs)
        values = {name: _value(model, name) for name in names}
        state = _core.state(self._document)

        def pull(
            weights: Mapping[str, ArrayLike], by: Sequence[str] | None = None
        ) -> dict[str, Any] | Floats:
            if unknown := [name for name in weights if name not in values]:
                raise Error(f"`{unknown[0]}` is not one of the outputs: {', '.join(names)}")
            if _core.state(self._document) != state:
                raise Error(
                    "the model has changed since it was linearized\nhelp: call `linearize` again"
                )
            return self.vjp(weights, by) if by is not None else self.vjp(weights)

        return values, pull

    def _inputs(self) -> list[str]:
        """All inputs that the model can be differentiated by."""
        params = cast("Model", self).params.values()
        return [p.name for p in params if not p.whole] + self.literals


def _value(model: Model, name: str) -> Any:
    """The value of an output."""
    if name == "mesh":
        return model.mesh().vertices
    return model.blocks().vertices if name == "blocks" else model.eval(name)


def _shape(model: Model, name: str) -> tuple[int, ...]:
    """The shape of an output; -1 for a number of vertices, which is checked elsewhere."""
    import numpy as np

    if name in _MESHES:
        return (-1, 3)
    try:
        return np.shape(model.eval(name))
    except ValueError:
        raise Error(f"`{name}` is a list of unlike items, which no array of weights fits") from None


def _shaped(flat: Floats, shape: tuple[int, ...]) -> Any:
    """Numbers in the shape of an output."""
    return flat.reshape(shape) if shape else float(flat[0])


def _flat(model: Model, weights: Mapping[str, ArrayLike]) -> tuple[bool, list[tuple[str, Floats]]]:
    """Weights as arrays (sums, numbers); and whether they are of one sum, without its axis."""
    import numpy as np

    if not weights:
        raise Error("weights of one output at least are needed")
    found: list[tuple[str, Floats]] = []
    counts: dict[str, int | None] = {}
    for name, given in weights.items():
        w: Floats = np.asarray(given, dtype=np.float64)
        shape = () if w.ndim == 0 and name not in _MESHES else _shape(model, name)
        extra = w.ndim - len(shape)
        own = w.shape[extra:] if extra in (0, 1) else None
        if own is None or not all(a in (-1, b) for a, b in zip(shape, own, strict=True)):
            expected = ", ".join("n" if n < 0 else str(n) for n in shape)
            raise Error(
                f"the weights of `{name}` have the shape {w.shape}\n"
                f"expected: ({expected}), or an axis more before it for several sums"
            )
        if not np.isfinite(w).all():
            raise Error(f"a weight of `{name}` is not a finite number")
        counts[name] = len(w) if extra else None
        size = int(np.prod(own, dtype=np.int64))
        found.append((name, np.ascontiguousarray(w.reshape(len(w) if extra else 1, size))))
    if len(set(counts.values())) > 1:
        each = ", ".join(f"`{name}`: {count or 'one'}" for name, count in counts.items())
        raise Error(f"all weights must be of as many sums\nfound: {each}")
    return None in counts.values(), found


explain(globals())

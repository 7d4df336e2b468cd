"""Models: loading, changing, measuring and differentiating them."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.arguments import explain, names_of
from moldloft.errors import Error, ModelError, UnknownNameError
from moldloft.exchange.adapted import Adapted
from moldloft.exchange.writing import Writable
from moldloft.hydro.floating import Floating
from moldloft.shapes.derivatives import Differentiable
from moldloft.shapes.objects import object_of, wrapped

if TYPE_CHECKING:
    from moldloft.loading import Origin
    from moldloft.shapes.blocks import Blocks
    from moldloft.shapes.mesh import Mesh
    from moldloft.shapes.objects import Entry

__all__ = ["Adjustment", "Model", "Param", "Solution"]


@dataclass(frozen=True)
class Param:
    """A design parameter of a model."""

    name: str
    """Its name."""
    value: float
    """Its value now."""
    default: float
    """Its value in the text."""
    low: float | None
    """The least value of its range."""
    high: float | None
    """The greatest value of its range."""
    whole: bool
    """True for integers."""


@dataclass(frozen=True)
class Adjustment:
    """A parameter adjusted by :meth:`Model.solve_for`."""

    before: float
    """Its value before."""
    after: float
    """Its value now."""
    share: float
    """Its fraction of the total weighted change, 0 to 1."""


@dataclass(frozen=True)
class Solution:
    """The result of :meth:`Model.solve_for`."""

    adjustments: dict[str, Adjustment]
    """The parameters that may change, by name."""
    reached: dict[str, float]
    """The numbers that were given, by expression."""
    steps: int
    """Steps of the search."""


class Model(Differentiable, Floating, Writable, Adapted):
    """A model: named objects that depend on each other, and the text that declares them.

    ``m["beam"]`` is a parameter's value and ``m["hull"]`` an object; ``m["beam"] = 4.5`` changes
    the model, and only what depends on it is computed again. Made by :func:`moldloft.load` and
    :func:`moldloft.loads`.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... param float beam = 5.0 in [3, 7];
    ... AbsPoint A(0, 0, 0);
    ... AbsPoint B(10, beam, 0);
    ... Line edge(A, B);
    ... ''')
    >>> m["beam"] = 6
    >>> m["B"].y, m.eval("edge(0.5)")
    (6.0, array([5., 3., 0.]))
    >>> m.evaluated
    2
    >>> m.objects
    ['A', 'B', 'edge']
    >>> m["beem"]
    Traceback (most recent call last):
      ...
    moldloft.errors.UnknownNameError: unknown parameter or object `beem`; did you mean `beam`?
    """

    def __init__(
        self, document: _core.Document | None = None, origin: Origin | None = None
    ) -> None:
        if not isinstance(document, _core.Document):
            raise TypeError(
                "models are made by moldloft.load(path), moldloft.loads(text), or a function "
                "decorated with @moldloft.model"
            )
        self._plain_document = document
        #: Threads that are in a Python function of this model.
        self._inside: set[int] = set()
        self._origin = origin
        self._refined = 0

    @property
    def _document(self) -> _core.Document:
        if self._inside and threading.get_ident() in self._inside:
            raise ModelError(
                "a Python function cannot use the model that calls it: pass the values it "
                "needs as arguments"
            )
        return self._plain_document

    # -- copies ----------------------------------------------------------------------------

    def copy(self) -> Model:
        """An independent model in the same state: text, parameters, Python functions.

        Returns
        -------
        Model
            An independent copy.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 1 in [0, 9]; AbsPoint P(a, 0, 0);")
        >>> m["a"] = 3
        >>> other = m.copy()
        >>> other["a"] = 5
        >>> m["P"].x, other["P"].x
        (3.0, 5.0)
        """
        from moldloft.loading import restored

        other = restored(*self._state())
        other.partial = self.partial
        return other

    def __copy__(self) -> Model:
        return self.copy()

    def __deepcopy__(self, _: dict[int, Any]) -> Model:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        from moldloft.loading import restored

        return restored, self._state()

    def _state(self) -> tuple[Any, ...]:
        changed = {p.name: p.value for p in self.params.values() if p.value != p.default}
        return self._origin, self.text, changed, self._refined

    # -- reading ---------------------------------------------------------------------------

    @property
    def objects(self) -> list[str]:
        """The names of all objects, in the order of declaration."""
        return self._document.names()

    @property
    def params(self) -> dict[str, Param]:
        """The design parameters by name."""
        return {row[0]: Param(*row) for row in self._document.params()}

    @property
    def diagnostics(self) -> list[_core.Diagnostic]:
        """Errors, warnings and remarks, in the order in which they were found."""
        return self._document.diagnostics()

    @property
    def has_errors(self) -> bool:
        """True if one of the diagnostics is an error."""
        return self._document.has_errors()

    @property
    def partial(self) -> bool:
        """True if figures and files may cover a part of the model only.

        ``False`` by default: the mesh, hydrostatics, derivatives of whole figures and files
        raise :class:`~moldloft.errors.ModelError` while an object has failed or panels contradict
        each other in their counts; hydrostatics also while the skin is open below the water, bodies
        overlap or a plate is inside a body. With ``True`` they are those of the valid objects,
        which the remarks of hydrostatics state.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... XPlane p(9); IntBead b(low, p);
        ... ''', strict=False)
        >>> m.mesh()
        Traceback (most recent call last):
            ...
        moldloft.errors.ModelError: ...
        >>> m.partial = True
        >>> m.mesh().faces.shape
        (4, 4)
        """
        return self._document.partial()

    @partial.setter
    def partial(self, allowed: bool) -> None:
        self._document.allow_partial(bool(allowed))

    @property
    def sources(self) -> list[str]:
        """The files that the model was read from: its own, and those that it loads."""
        return self._document.files()

    @property
    def types(self) -> dict[str, str]:
        """The types of the program's variables, by name, with extents: ``surface[2,3]``.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("farray t = uniform(0, 1, 3);").types
        {'t': 'farray[3]'}
        """
        return {name: shape for name, shape, _ in self._document.variables()}

    def facts(self, name: str) -> dict[str, Any]:
        """Data of an object that need no evaluation of its shape.

        Parameters
        ----------
        name
            The name of an object.

        Returns
        -------
        dict
            ``name``, ``kind``, ``class``; ``ok``: it was made; ``shown``; ``parents`` and
            ``children``: names of objects.

        Raises
        ------
        UnknownNameError
            If there is no such object.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.facts("plate")["parents"]
        ['low', 'high']
        """
        return self._document.object(name)

    def completions(self, line: str) -> list[str]:
        """Completions at the end of the text followed by ``line``.

        Parameters
        ----------
        line
            The text up to the cursor.

        Returns
        -------
        list of str
            Kinds, functions, names of objects and arguments, in alphabetical order.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("").completions("BSu")
        ['BSubCurve', 'BSubSnake', 'BSurf']
        """
        return self._document.complete(line)

    @property
    def evaluated(self) -> int:
        """Number of objects evaluated by the last change."""
        return self._document.evaluated()

    @property
    def symmetry(self) -> str:
        """The normal axes of the symmetry planes, such as ``"y"``; may be empty."""
        return self._document.symmetry()

    @property
    def variables(self) -> dict[str, Any]:
        """The variables of the program by name: floats, texts, arrays.

        Rows of numbers are arrays ``(n,)``, curves ``(n, 3)``, surfaces ``(m, n, 3)``.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("surface s[2, 3] = {0, 0, 1}; farray t = uniform(0, 1, 3);")
        >>> m.variables["s"].shape, m.variables["t"]
        ((2, 3, 3), array([0. , 0.5, 1. ]))
        """
        return {name: value for name, _, value in self._document.variables()}

    @property
    def printed(self) -> list[str]:
        """Output of the program, by line."""
        return self._document.printed()

    @property
    def written_names(self) -> list[str]:
        """The names of the files that the program wrote, without their contents."""
        return self._document.written_names()

    @property
    def written(self) -> dict[str, bytes]:
        """Files written by the program, by name; ``moldloft run`` saves them."""
        return dict(self._document.written())

    def refine(self, times: int) -> None:
        """Set the refinement level: each level halves the spacing of sizes declared by ``refined``.

        Points of coarse grids are points of fine ones: the grids of 0, 1, 2, ... are nested.

        Parameters
        ----------
        times
            The level, 0 for the sizes as written.

        Raises
        ------
        Error
            If the level is negative.
        ModelError
            If the level is too fine.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("int n = refined(3);")
        >>> m.refine(1)
        >>> m.eval("n")
        5.0
        """
        if times < 0:
            raise Error(f"refine: expected 0 or more, found {times}")
        self._document.refine(times)
        self._refined = times

    @property
    def text(self) -> str:
        """The model's text, with direct edits included. Assignment runs the new text."""
        return self._document.text()

    @text.setter
    def text(self, text: str) -> None:
        self._document.set_text(text)

    def check(self) -> None:
        """Raise :class:`ModelError` with all diagnostics when the model has an error.

        Raises
        ------
        ModelError
            With all diagnostics, when one is an error.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("AbsPoint P(1, 2, 3);").check()
        """
        if self._document.has_errors():
            diagnostics = self._document.diagnostics()
            raise ModelError("\n".join(map(str, diagnostics)).rstrip(), diagnostics)

    def __contains__(self, name: object) -> bool:
        # No name has a character that is no text, such as a lone surrogate.
        if not isinstance(name, str) or (
            not name.isascii() and any("\ud800" <= c <= "\udfff" for c in name)
        ):
            return False
        return self._document.param(name) is not None or self._document.has(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __bool__(self) -> bool:
        return True

    def keys(self) -> list[str]:
        """The names of all parameters and objects.

        Returns
        -------
        list of str
            In the order of the text, parameters first.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("param float a = 1 in [0, 2]; AbsPoint P(a, 0, 0);").keys()
        ['a', 'P']
        """
        return [*self.params, *self.objects]

    def _ipython_key_completions_(self) -> list[str]:
        return self.keys()

    if TYPE_CHECKING:
        # A number or an object of any class; a variable's array is in `variables`.
        def __getitem__(self, name: str) -> Entry: ...
    else:

        def __getitem__(self, name: str) -> Any:
            return self._entry(name)

        def __getattr__(self, name: str) -> Any:
            # Only asked for what is not there. Objects are no attributes: a method may have their
            # name.
            text = f"a model has no attribute `{name}`"
            document = self.__dict__.get("_plain_document")
            if document is not None and not name.startswith("_") and name in self.keys():
                text += f'; the object or parameter is `m["{name}"]`'
            raise AttributeError(text)

    def _entry(self, name: str) -> Any:
        value = self._document.param(name)
        if value is not None:
            return value
        if self._document.has(name):
            return object_of(self, name)
        variables = self.variables
        if name in variables:
            return variables[name]
        near = self._document.similar(name)
        hint = f"; did you mean `{near}`?" if near else ""
        raise UnknownNameError(f"unknown parameter or object `{name}`{hint}")

    # -- changing --------------------------------------------------------------------------

    def __setitem__(self, name: str, value: float) -> None:
        self.set({name: value})

    def set(self, values: Mapping[str, float]) -> None:
        """Change several numbers at once.

        Parameters
        ----------
        values
            By a parameter's name, or by an object's and a field's: ``{"beam": 4.5, "P21.x": 3}``.
            A number that the text computes from others refuses and names its parameters.

        Raises
        ------
        ModelError
            If a value is not a number or out of its range, or a name unknown; nothing is
            changed then.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.set({"b": 3, "B.x": 5})
        >>> m["b"], m["B"].x
        (3.0, 5.0)
        """
        numbers = []
        for name, value in values.items():
            try:
                numbers.append((name, float(value)))
            except (TypeError, ValueError):
                raise ModelError(f"`{name}` is a number; found {value!r}") from None
        self._document.set(numbers)

    def solve_for(
        self, targets: Mapping[str, float], by: Sequence[str] | Mapping[str, float]
    ) -> Solution:
        """Give numbers of the model target values by the least change of chosen parameters.

        Of all values within the ranges of the parameters that give the targets, those of the least
        sum of squares of weighted changes, each relative to its range (without one, to its
        value). The search uses exact derivatives; it finds the solution near the present values.

        Parameters
        ----------
        targets
            Values by expression, such as ``{"hydrostatics.volume": 130, "hydrostatics.lcb": 5.9}``,
            in the model's units. They are met within 1e-8 of their values.
        by
            The parameters (or numbers of objects, such as ``"P21.y"``) that may change; as a
            mapping, with weights > 0: one of weight 2 changes less.

        Returns
        -------
        Solution
            New value of each parameter and its fraction of the change. The model has the new
            values, as after :meth:`set`.

        Raises
        ------
        ModelError
            If the targets are not reached; the message has the range that was found within the
            ranges of the parameters. The model is as before then.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float a = 2 in [1, 5]; param float b = 3 in [1, 5];
        ... AbsPoint P(a * b, a, 0);
        ... ''')
        >>> found = m.solve_for({"P.x": 8, "P.y": 2}, by=["a", "b"])
        >>> round(m["b"], 6), round(found.adjustments["b"].share, 6)
        (4.0, 1.0)
        """
        # A name that is given twice is the engine's to refuse.
        weights = by.items() if isinstance(by, Mapping) else [(n, 1.0) for n in names_of(by)]
        rows, reached, steps = self._document.solve_for(
            [(text, float(x)) for text, x in targets.items()],
            [(name, float(x)) for name, x in weights],
        )
        adjustments = {name: Adjustment(*row) for name, *row in rows}
        return Solution(adjustments, dict(zip(targets, reached, strict=True)), steps)

    # -- measuring -------------------------------------------------------------------------

    def eval(self, expression: str) -> Any:
        """Evaluate an expression of the language in the model's names.

        Parameters
        ----------
        expression
            An expression of the language, such as ``"hull.area / 2"``.

        Returns
        -------
        float, str, numpy.ndarray, list, Field or Set
            A vector as an array ``(3,)``; rows and grids as arrays; fields and sets as
            :class:`moldloft.implicit.Field` and :class:`moldloft.implicit.Set`.

        Raises
        ------
        ModelError
            If the text is not an expression, or has no value; the diagnostics give the position.

        Warns
        -----
        UserWarning
            If the value misses the requested accuracy, such as the volume of a set with walls
            thinner than any cell.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("AbsPoint P(1, 2, 2);").eval("P.x + 2")
        3.0
        """
        value = wrapped(self._document.eval(expression))
        for remark in self._document.expression_remarks():
            # Past the check of arguments, to the line of the caller.
            warnings.warn(str(remark), stacklevel=3)
        return value

    def mesh(
        self,
        *,
        tags: str | Sequence[str] = (),
        whole: bool = False,
        tolerance: float | None = None,
        angle: float | None = None,
    ) -> Mesh:
        """Panels of all shown surfaces; cached until the model changes.

        Parameters
        ----------
        tags
            Only the patches that carry one of these tags, such as ``"lid"`` or a name of your
            own; by default all patches.
        whole
            Both sides of a symmetric model, joined in its planes; by default one side.
        tolerance
            The largest distance of panels from their surfaces, in the model's unit: divisions are
            as many as it takes, and stated ones the least. By default the model's divisions.
        angle
            The largest turn of a surface along a panel, in radians; 0.5 where only ``tolerance``
            is given.

        Returns
        -------
        Mesh
            Quadrilaterals and triangles, joined at common curves of patches.

        Raises
        ------
        ModelError
            If no patch has such a tag, a tolerance or angle is not positive, or the model is not
            whole; see :attr:`partial`.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.mesh().vertices.shape, m.mesh().faces.shape
        ((9, 3), (4, 4))
        >>> len(m.mesh(tolerance=0.01).faces)
        4
        """
        from moldloft.shapes.mesh import Mesh

        wanted = [tags] if isinstance(tags, str) else list(tags)
        made = self._document.mesh(wanted, whole, tolerance, angle)
        return Mesh(made, symmetry="" if whole else self.symmetry)

    def united(self, *, tolerance: float | None = None, angle: float | None = None) -> Model:
        """The outer skin of bodies that overlap or touch, as a model of one body, ``body``.

        Both sides of a symmetric model are one whole. Panels are cut along the intersections of the
        bodies, and those inside are left out; the others stay as they are. Figures are those of the
        panels: a finer ``tolerance`` comes nearer to the surfaces. Crossing points are on the
        planes of their panels to rounding.

        Parameters
        ----------
        tolerance, angle
            As for :meth:`mesh`.

        Returns
        -------
        Model
            The body of panels, in the model's units; it floats, is measured and is written as any
            other.

        Raises
        ------
        ModelError
            If the model is not whole.
        Error
            If a body is open or faces inward, or if faces of three bodies or more nearly touch.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(0, 0, -1); AbsPoint B(0, 0, 1); AbsPoint C(1, 0, -1);
        ... Arc half(A, {1, 0, 0}, B, type = 1); Line axis(A, B); RevSurf ball(half, axis, 0, 2*PI);
        ... CopySurf other(ball, A, C, 1, 1, 1);
        ... ''')
        >>> round(m.united(tolerance=1e-3).hydrostatics(level=2).volume, 2)  # 9/4 pi
        7.06
        """
        import numpy as np

        from moldloft.exchange.mesh_files import mesh_statement
        from moldloft.loading import loads

        points, faces = self._document.mesh([], True, tolerance, angle).united()
        units = " ".join(word for word, _ in self._document.units())
        head = f'Model info(units = "{units}");\n' if units else ""
        listed = ", ".join(f"{{{x!r}, {y!r}, {z!r}}}" for x, y, z in points.tolist())
        return loads(head + mesh_statement("{" + listed + "}", faces.astype(np.int64)))

    def inner_skins(self) -> list[_core.Diagnostic]:
        """Plates of the skin inside a body, and overlapping bodies.

        Each is a warning: a plate inside counts as skin, and the common part of two bodies counts
        twice; :meth:`hydrostatics` raises it, unless :attr:`partial` is set. The test is the
        winding number of the other body at centres and corners of panels and at parts of pierced
        edges, farther from its panels than both are from their surfaces.

        Returns
        -------
        list of Diagnostic
            Empty when no piece of the skin reaches into another one.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(0, 0, -1); AbsPoint B(0, 0, 1); AbsPoint C(0.7, 0, -1);
        ... Arc half(A, {1, 0, 0}, B, type = 1); Line axis(A, B); RevSurf ball(half, axis, 0, 2*PI);
        ... CopySurf other(ball, A, C, 1, 1, 1);
        ... ''')
        >>> [d.id for d in m.inner_skins()]
        ['bodies-overlap']
        """
        return self._document.inner_skins()

    def folded_surfaces(self) -> list[_core.Diagnostic]:
        """Surfaces of the skin that turn over themselves.

        Each is a warning with a position: areas, volumes and panels count the fold more than once.
        Normals are compared at about 24 x 24 points of each surface; between opposite ones,
        bisection finds the point at which the normal vanishes. Smaller folds are missed.

        Returns
        -------
        list of Diagnostic
            Empty when no surface is found to do so.

        Raises
        ------
        ModelError
            If the skin is that of no body: a mirrored model that shows both sides of its plane.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 3, 0);
        ... AbsPoint E(1, 9, 0); AbsPoint F(3, -8, 0);
        ... Line low(A, B); BCurve high({C, E, F, D}); RuledSurf plate(low, high);
        ... ''')
        >>> [(d.id, d.object) for d in m.folded_surfaces()]
        [('folded-surface', 'plate')]
        """
        return self._document.folded_surfaces()

    def junctions(self) -> list[_core.Diagnostic]:
        """Coincident edges of patches, and corners on edges of others, that are not joined.

        Each is an error: the mesh is open where the shape is closed.

        Returns
        -------
        list of Diagnostic
            Empty for a mesh that is joined wherever its patches meet.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.junctions()
        []
        """
        return self._document.junctions()

    def blocks(self) -> Blocks:
        """Hexahedra of all shown solids, for the current model.

        Returns
        -------
        Blocks
            Vertices and cells, with the common faces of blocks.

        Raises
        ------
        ModelError
            If there is no solid, divisions contradict each other, or there are too many cells.
        """
        from moldloft.shapes.blocks import Blocks

        return Blocks(self._document.blocks())

    # -- for other packages ----------------------------------------------------------------

    def view(self, *, height: int = 600, follow: bool = True) -> Any:
        """The workbench in a notebook cell: sliders, drags, typing, hydrostatics.

        The page has its own engine in WebAssembly, with the same bits. With ``anywidget`` installed
        (extra ``notebook``) this model follows changes in the page, and ``refresh()`` of the result
        shows changes made in Python. Without it, or with ``follow=False``, the page is part of the
        notebook, remains interactive in an exported one, and changes no model of Python.

        Parameters
        ----------
        height
            Size of the cell, in pixels.
        follow
            True if this model follows the page.

        Returns
        -------
        object
            Display of the notebook.

        Raises
        ------
        Error
            If the package has no engine for pages, the model calls Python functions, or a
            parameter was given a value that the text cannot state as a number.
        """
        from moldloft.notebook import shown

        return shown(self, height, follow)

    def _repr_html_(self) -> str:
        from moldloft.display import model_html

        return model_html(self)

    def __repr__(self) -> str:
        objects, params = len(self.objects), len(self.params)
        return (
            f"<Model: {objects} object{'s' * (objects != 1)}, "
            f"{params} parameter{'s' * (params != 1)}>"
        )


explain(globals())

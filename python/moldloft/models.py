"""Models: loading, changing, measuring and differentiating them."""

from __future__ import annotations

import os
import threading
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error, FileError, ModelError, UnknownNameError
from moldloft.hydrostatics import Hydrostatics, HydrostaticTable, RightingCurve
from moldloft.objects import object_of
from moldloft.units import Units
from moldloft.weights import Weight, WeightTable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft.blocks import Blocks
    from moldloft.loading import Origin
    from moldloft.mesh import Mesh
    from moldloft.objects import Entry
    from moldloft.stability import Stability

__all__ = ["Model", "Param"]


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
    """True when it takes whole numbers only."""


def _wrapped(value: Any) -> Any:
    """Fields and sets as users know them."""
    if isinstance(value, _core.Field):
        from moldloft.implicit import Field

        return Field(value)
    if isinstance(value, _core.Set):
        from moldloft.implicit import Set

        return Set(value)
    if isinstance(value, list):
        return [_wrapped(item) for item in value]
    return value


class Model:
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

    def __init__(self, document: _core.Document, origin: Origin | None = None) -> None:
        self._plain_document = document
        #: Threads that are in a Python function of this model.
        self._inside: set[int] = set()
        self._origin = origin
        self._refined = 0

    @property
    def _document(self) -> _core.Document:
        if self._inside and threading.get_ident() in self._inside:
            raise ModelError(
                "a Python function of a model cannot use the model that calls it: give it what it "
                "needs as arguments"
            )
        return self._plain_document

    # -- copies ----------------------------------------------------------------------------

    def copy(self) -> Model:
        """A model of its own in the same state: text, parameters, Python functions.

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

        return restored(*self._state())

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
        """Whether one of the diagnostics is an error."""
        return self._document.has_errors()

    @property
    def sources(self) -> list[str]:
        """The files that the model was read from: its own, and those that it loads."""
        return self._document.files()

    @property
    def types(self) -> dict[str, str]:
        """The types of the program's variables by name, with extents: ``surface[2,3]``.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("farray t = uniform(0, 1, 3);").types
        {'t': 'farray[3]'}
        """
        return {name: shape for name, shape, _ in self._document.variables()}

    def facts(self, name: str) -> dict[str, Any]:
        """What is known of an object without asking for its shape.

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
            When there is no such object.
        """
        return self._document.object(name)

    def completions(self, line: str) -> list[str]:
        """The words that may stand at the end of the text followed by ``line``.

        Parameters
        ----------
        line
            The text up to the cursor.
        """
        return self._document.complete(line)

    @property
    def evaluated(self) -> int:
        """How many objects the last change evaluated again."""
        return self._document.evaluated()

    @property
    def symmetry(self) -> str:
        """The axes in whose planes the model is mirrored, such as ``"y"``; else empty."""
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
        """What the program printed, a line each."""
        return self._document.printed()

    @property
    def written(self) -> dict[str, bytes]:
        """What the program wrote, by file name; ``moldloft run`` puts it on the disk."""
        files = dict(self._document.written())
        for name, blocks in self._document.written_for_cgns():
            from moldloft import _core, grids

            # CGNS is HDF5: the program left its blocks in Plot3D, the file is made here.
            found, _ = _core.read_plot3d(files[name])
            surfaces = [block[:, :, 0, :] for block in found]
            files[name] = grids.cgns_bytes(name, surfaces, blocks)
        return files

    def refine(self, times: int) -> None:
        """Set the refinement level: each level halves the spacing of sizes declared by ``refined``.

        Coarse grid points recur in fine grids, so that the grids of 0, 1, 2, ... are nested.

        Parameters
        ----------
        times
            The level, 0 for the sizes as written.
        """
        self._document.refine(times)
        self._refined = times

    @property
    def text(self) -> str:
        """The model's text, with direct edits written in. Assigning runs the new text."""
        return self._document.text()

    @text.setter
    def text(self, text: str) -> None:
        self._document.set_text(text)

    def check(self) -> None:
        """Raise :class:`ModelError` with all diagnostics when the model has an error."""
        if self._document.has_errors():
            diagnostics = self._document.diagnostics()
            raise ModelError("\n".join(map(str, diagnostics)).rstrip(), diagnostics)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (
            self._document.param(name) is not None or self._document.has(name)
        )

    def __iter__(self) -> Iterator[str]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __bool__(self) -> bool:
        return True

    def keys(self) -> list[str]:
        """The names of all parameters and objects.

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
            When a value is not a number or out of its range, or a name unknown; nothing is
            changed then.
        """
        numbers = []
        for name, value in values.items():
            try:
                numbers.append((name, float(value)))
            except (TypeError, ValueError):
                raise ModelError(f"`{name}` is a number; found {value!r}") from None
        self._document.set(numbers)

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

        Warns
        -----
        UserWarning
            When the value is not known as well as asked, such as the volume of a set with
            walls thinner than any cell.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads("AbsPoint P(1, 2, 2);").eval("P.x + 2")
        3.0
        """
        value = _wrapped(self._document.eval(expression))
        for remark in self._document.expression_remarks():
            warnings.warn(str(remark), stacklevel=2)
        return value

    def mesh(self, *, tags: str | Sequence[str] = ()) -> Mesh:
        """Panels of all shown surfaces, for the current model; remembered until it changes.

        Parameters
        ----------
        tags
            Only the patches that carry one of these tags, such as ``"lid"`` or a name of your
            own; by default all patches.
        """
        from moldloft.mesh import Mesh

        wanted = [tags] if isinstance(tags, str) else list(tags)
        return Mesh(self._document.mesh(wanted), symmetry=self.symmetry)

    def junctions(self) -> list[_core.Diagnostic]:
        """Edges of patches in one place, and corners on edges of others, that are not joined.

        Each is an error: the mesh is open where the shape is closed.
        """
        return self._document.junctions()

    def blocks(self) -> Blocks:
        """Hexahedra of all shown solids, for the current model.

        Raises
        ------
        ModelError
            When there is no solid, divisions contradict each other, or there are too many cells.
        """
        from moldloft.blocks import Blocks

        return Blocks(self._document.blocks(), self.symmetry)

    def block_jacobian(self, by: Sequence[str]) -> NDArray[np.float64]:
        """Exact derivatives of every vertex of :meth:`blocks`, ``(n, 3, len(by))``.

        Parameters
        ----------
        by
            Parameters, or literals such as ``"P21.x"``.
        """
        return self._document.block_jacobian(list(by))

    def hydrostatics(
        self,
        *,
        level: float | None = None,
        draft: float | None = None,
        trim: float = 0.0,
        heel: float = 0.0,
        cg: Sequence[float] | None = None,
        density: float | str | None = None,
        gravity: float | None = None,
        sides: str = "both",
        by: Sequence[str] = (),
        accuracy: float = 1e-6,
    ) -> Hydrostatics:
        """What the model displaces at a given draft, trim and heel, and how stiffly it floats.

        The figures are integrals over the surfaces; their bounds are in ``bounds``. What the panels
        displace is in :meth:`panel_figures`.

        Parameters
        ----------
        level
            Height of the water over the model's origin, by default 0.
        draft
            Instead of the level: the depth of the upright body's lowest point below the water, on
            the centre line in the middle of its length.
        trim, heel
            In radians, about the origin; positive sinks what has large x, or large y.
        cg
            The centre of gravity in the model's axes, for metacentric heights and arms.
        density
            The water: ``"salt"``, ``"fresh"``, or mass per volume in the model's units. Without it
            there are volumes, and no masses.
        gravity
            In the model's unit of length per second squared, by default 9.80665 m/s².
        sides
            For a model that is mirrored in y = 0: ``"both"`` counts its image too, ``"one"``
            does not (and cannot heel). A model without symmetry is always counted as it is.
        by
            Parameters or literals to differentiate the figures by.
        accuracy
            The relative error asked for, 1e-12 to 0.1. What was reached is in
            ``bounds``.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float beam = 2 in [1, 3];
        ... AbsPoint a(0, -beam/2, 0); AbsPoint b(6, -beam/2, 0);
        ... AbsPoint c(0, beam/2, 0); AbsPoint d(6, beam/2, 0);
        ... AbsPoint e(0, -beam/2, 1); AbsPoint f(0, beam/2, 1);
        ... AbsPoint g(6, -beam/2, 1); AbsPoint h(6, beam/2, 1);
        ... Line ab(a, b); Line cd(c, d); Line eg(e, g); Line fh(f, h);
        ... Line ac(a, c); Line ef(e, f); Line bd(b, d); Line gh(g, h);
        ... RuledSurf bottom(ab, cd, orientation = 1);
        ... RuledSurf port(ab, eg); RuledSurf starboard(cd, fh, orientation = 1);
        ... RuledSurf bow(ac, ef, orientation = 1); RuledSurf stern(bd, gh);
        ... ''')
        >>> hydro = m.hydrostatics(draft=0.5, by=["beam"])
        >>> round(hydro.volume, 12), round(hydro.derivatives["volume"]["beam"], 12)
        (6.0, 3.0)
        """
        if level is not None and draft is not None:
            raise Error("give the level or the draft, not both")
        given, number = ("level", 0.0 if level is None else float(level))
        if draft is not None:
            given, number = "draft", float(draft)
        row = (given, number, float(trim), float(heel), False, False)
        return self._floating([row], cg, density, gravity, sides, by, accuracy)[0]

    def equilibrium(
        self,
        displacement: float | None = None,
        *,
        cg: Sequence[float] | None = None,
        free: Sequence[str] | None = None,
        trim: float = 0.0,
        heel: float = 0.0,
        density: float | str | None = None,
        gravity: float | None = None,
        sides: str = "both",
        by: Sequence[str] = (),
        accuracy: float = 1e-6,
    ) -> Hydrostatics:
        """The attitude at rest of a body of given mass.

        Parameters
        ----------
        displacement
            The mass; by default that of the model's weights, with their centre of gravity.
        cg
            The centre of gravity in the model's axes.
        free
            What is sought besides the draft: ``"trim"``, ``"heel"``, or both, which is the default
            where ``cg`` is given. A model mirrored in y = 0 with its centre of gravity there stays
            upright by default; where that is unstable, the attitude is that of loll, and ``lolls``
            is true.
        trim, heel
            Kept where they are not free; else where the search begins, in radians.
        density, gravity, sides, by, accuracy
            As for :meth:`hydrostatics`. Derivatives are those of the whole solution.

        Returns
        -------
        Hydrostatics
            Its ``status`` says whether the attitude is one of rest, its ``stable`` whether small
            turns in heel and trim are righted.

        Raises
        ------
        ModelError
            When the body cannot carry the mass.
        """
        of_weights = displacement is None
        if displacement is None:
            total = self.weights()
            if not total.rows:
                raise Error(
                    "no mass floats\nhelp: give the displacement, or declare weights: "
                    "Weight engine({2, 0, 0.5}, mass = 3);"
                )
            if cg is not None:
                raise Error("give both the displacement and cg, or none: those of the weights")
            displacement, cg = total.mass, total.centre
        held = free is None and cg is not None
        if free is None:
            upright = "y" in self.symmetry and cg is not None and cg[1] == 0 and heel == 0
            free = () if cg is None else ("trim",) if upright else ("trim", "heel")
        unknown = set(free) - {"trim", "heel"}
        if unknown:
            raise Error(f"free are `trim` and `heel`, not `{unknown.pop()}`")
        trims, heels = "trim" in free, "heel" in free
        row = ("displacement", float(displacement), float(trim), float(heel), trims, heels)
        given = None if of_weights else cg
        found = self._floating([row], given, density, gravity, sides, by, accuracy, of_weights)[0]
        if held and found.stable is False and sides == "both":
            # Upright it capsizes: on to the attitude that it finds, if there is one.
            row = ("displacement", float(displacement), float(trim), float(heel), True, True)
            found = self._floating([row], given, density, gravity, sides, by, accuracy, of_weights)[
                0
            ]
        return found

    def hydrostatic_table(
        self,
        drafts: Sequence[float] | NDArray[np.float64],
        *,
        trim: float = 0.0,
        cg: Sequence[float] | None = None,
        density: float | str | None = None,
        gravity: float | None = None,
        sides: str = "both",
        by: Sequence[str] = (),
        accuracy: float = 1e-6,
    ) -> HydrostaticTable:
        """Hydrostatics over a range of drafts; arguments as for :meth:`hydrostatics`.

        Parameters
        ----------
        drafts
            Drafts above the lowest point of the body, in model units.
        trim
            Trim, radians; positive sinks what has large x.
        cg
            Centre of gravity in the model's axes, ``(3,)``.
        density
            ``"salt"``, ``"fresh"``, or mass per volume in the model's units.
        gravity
            Acceleration, in the model's units; by default that of the earth where units are
            known.
        sides
            ``"both"`` counts a mirrored model with its image, ``"one"`` alone.
        by
            Names of parameters.
        accuracy
            The relative accuracy of the figures.
        """
        rows = [("draft", float(draft), float(trim), 0.0, False, False) for draft in drafts]
        return HydrostaticTable(self._floating(rows, cg, density, gravity, sides, by, accuracy))

    def righting_curve(
        self,
        heels: Sequence[float] | NDArray[np.float64],
        displacement: float,
        *,
        cg: Sequence[float],
        trim: float = 0.0,
        free_trim: bool = True,
        density: float | str | None = None,
        gravity: float | None = None,
        by: Sequence[str] = (),
        accuracy: float = 1e-6,
    ) -> RightingCurve:
        """Righting arms over heel, at one displacement.

        Parameters
        ----------
        heels
            In radians.
        displacement
            The mass.
        cg
            The centre of gravity in the model's axes.
        trim, free_trim
            Whether the body trims freely at each heel, else the trim it keeps.
        density, gravity, by, accuracy
            As for :meth:`hydrostatics`.
        """
        rows = [
            ("displacement", float(displacement), float(trim), float(heel), free_trim, False)
            for heel in heels
        ]
        return RightingCurve(self._floating(rows, cg, density, gravity, "both", by, accuracy))

    def _floating(
        self,
        rows: Sequence[tuple[str, float, float, float, bool, bool]],
        cg: Sequence[float] | None,
        density: float | str | None,
        gravity: float | None,
        sides: str,
        by: Sequence[str],
        accuracy: float,
        of_weights: bool = False,
    ) -> list[Hydrostatics]:
        centre = None if cg is None else [float(x) for x in cg]
        if centre is not None and len(centre) != 3:
            raise Error(f"a centre of gravity is x, y, z, not {len(centre)} numbers")
        units = self.units
        water = units.water(density)
        if water is None and any(row[0] == "displacement" for row in rows):
            raise Error(
                "a mass floats in water of a density\n"
                'help: give density="salt", "fresh", or mass per volume in the model\'s units'
            )
        answers = self._document.floating(
            rows, water or 1.0, gravity, centre, sides, list(by), accuracy, of_weights
        )
        massive = ("displacement", "weight", "tpc", "mtc", "righting_moment")
        for answer in answers:
            if water is None:
                for name in massive:
                    answer.pop(name, None)
                    answer["derivatives"].pop(name, None)
                    answer["bounds"].pop(name, None)
            answer["units"] = units if density is None else units.complete()
        return [Hydrostatics(**answer) for answer in answers]

    @property
    def units(self) -> Units:
        """The units that the model states: ``Model info(units = "m t");``."""
        return Units.parse(" ".join(word for word, _ in self._document.units()))

    @property
    def length_unit(self) -> tuple[str, float]:
        """The unit of length and its size in metres; metres where the model states none."""
        unit = self.units.length or "m"
        return unit, Units(unit).metres

    def tonnes(self, mass: float) -> float | None:
        """A mass of the model in tonnes; ``None`` where its unit is not known.

        Parameters
        ----------
        mass
            A mass in the model's unit.
        """
        units = self.units.complete()
        return mass * units.kilograms / 1000 if units.mass else None

    def weights(self) -> WeightTable:
        """The weights that the model declares, by group, with their sum.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("Weight a({2, 0, 0.5}, mass = 3); Weight b({4, 0, 0}, mass = 1);")
        >>> m.weights().mass, m.weights().centre
        (4.0, (2.5, 0.0, 0.375))
        """
        return WeightTable([Weight(*row) for row in self._document.weights()], self.units)

    def stability(
        self,
        displacement: float | None = None,
        *,
        cg: Sequence[float] | None = None,
        density: float | str | None = None,
        trim: float = 0.0,
        free_trim: bool = True,
        openings: Mapping[str, Sequence[float]] | None = None,
        gravity: float | None = None,
        accuracy: float = 1e-6,
    ) -> Stability:
        """The stability of a loading: righting arms, their areas, angles, criteria.

        Parameters
        ----------
        displacement, cg
            The mass and the centre of gravity; by default those of the model's weights.
        density
            The water, as for :meth:`hydrostatics`.
        trim, free_trim
            Whether the body trims freely at each heel, else the trim it keeps.
        openings
            Points by name through which water enters: the angle of flooding.
        gravity, accuracy
            As for :meth:`hydrostatics`.

        Examples
        --------
        >>> import math, moldloft
        >>> from moldloft.starter import BOX
        >>> box = moldloft.loads(BOX)
        >>> s = box.stability(40, cg=(0, 0, 0.4), density=1)
        >>> round(math.degrees(s.vanishing()), 2), s.stable
        (80.21, True)
        """
        from moldloft.stability import Opening, Stability

        if displacement is None or cg is None:
            total = self.weights()
            if not total.rows:
                raise Error(
                    "no mass and centre of gravity\n"
                    "help: give displacement and cg, or declare weights: "
                    "Weight engine({2, 0, 0.5}, mass = 3);"
                )
            displacement = total.mass if displacement is None else displacement
            cg = total.centre if cg is None else cg
        water = self.units.water(density)
        if water is None:
            raise Error(
                "a mass floats in water of a density\n"
                'help: give density="salt", "fresh", or mass per volume in the model\'s units'
            )
        points = [
            Opening(name, (float(x), float(y), float(z)))
            for name, (x, y, z) in (openings or {}).items()
        ]
        return Stability(
            self,
            displacement,
            cg,
            density=water,
            gravity=gravity,
            trim=trim,
            free_trim=free_trim,
            openings=points,
            accuracy=accuracy,
        )

    def section_areas(
        self,
        stations: Sequence[float] | NDArray[np.float64],
        levels: Sequence[float] | NDArray[np.float64] = (0.0,),
        *,
        accuracy: float = 1e-6,
    ) -> NDArray[np.float64]:
        """Immersed areas of sections below upright levels, ``[station, level]``.

        Bonjean curves, and at one level the sectional area curve. Both sides of a symmetric model
        count.

        Parameters
        ----------
        stations
            Places along x, in model units.
        levels
            Heights of the water, in model units.
        accuracy
            The relative accuracy of the areas.

        Examples
        --------
        >>> import moldloft
        >>> from moldloft.starter import BOX
        >>> moldloft.loads(BOX).section_areas([0.0], [-0.25, 0.0]).round(12)
        array([[3., 4.]])
        """
        import numpy as np

        areas = self._document.section_areas(
            [float(x) for x in stations], [float(z) for z in levels], accuracy
        )
        return np.array(areas, dtype=np.float64)[..., 0]

    def panel_figures(self, level: float = 0.0) -> dict[str, float]:
        """What the panels displace below an upright level: what a panel code computes with.

        ``volume``, ``wetted_area`` and ``waterplane_area``; those of the shape are in
        :meth:`hydrostatics`.

        Parameters
        ----------
        level
            Height of the water, in model units.
        """
        names = ("volume", "wetted_area", "waterplane_area")
        return dict(zip(names, self._document.panel_figures(float(level)), strict=True))

    def jacobian(self, by: Sequence[str]) -> NDArray[np.float64]:
        """Exact derivatives of every mesh vertex.

        Parameters
        ----------
        by
            Parameters, or literals of objects such as ``"P21.y"``.

        Returns
        -------
        numpy.ndarray
            Shape ``(vertices, 3, len(by))``.

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
        return self._document.jacobian(list(by))

    def derivative(self, expression: str, by: str) -> Any:
        """The exact derivative of a number or vector by one parameter or literal.

        Parameters
        ----------
        expression
            Anything that :meth:`eval` takes, such as ``"hull.volume"`` or ``"length(keel)"``.
        by
            A parameter, or a literal such as ``"P21.y"``.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("param float a = 3 in [0, 9]; AbsPoint P(a * a, 0, 0);")
        >>> m.derivative("P.x", "a")
        6.0
        """
        return self._document.derivatives([expression], [by])[0][0]

    def derivatives(self, expressions: Sequence[str], by: Sequence[str]) -> list[list[Any]]:
        """Exact derivatives of several expressions by several parameters, ``[expression][by]``.

        Parameters
        ----------
        expressions
            Expressions of the language with a number or a vector as value.
        by
            Names of parameters.
        """
        return self._document.derivatives(list(expressions), list(by))

    # -- writing ---------------------------------------------------------------------------

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        format: str | None = None,
        lids: bool = False,
        immersed: bool = False,
        tags: str | Sequence[str] = (),
        tolerance: float | None = None,
        whole: bool = False,
        triangles: bool = False,
    ) -> list[Path]:
        """Write the panels to a file, whole or not at all.

        Parameters
        ----------
        path
            The file, in a folder that exists.
        format
            One of :data:`moldloft.files.FORMATS`, such as ``gdf``, ``nemoh``, ``stl``, ``glb``,
            ``vts``, ``svg`` or ``sdl``; by default what the file's name ends in.
        lids
            For panel codes: write lids too. HAMS has them in a file of their own.
        immersed
            For panel codes: write only what is below z = 0, its panels cut there. AQWA's file is
            always cut.
        tags
            Only the patches that carry one of these tags; by default all.
        tolerance
            For ``gdf-high``, ``step``, ``iges``, ``3dm`` and ``dxf``: the largest error of fits,
            by default 1e-6 of the model's diagonal (``gdf-high``: 1e-5). Surfaces that are
            B-splines are exact.
        whole
            Both sides of a symmetric model, joined in its planes, in files of plain panels; by
            default these hold one side. Files of panel codes name the planes instead.
        triangles
            Triangles only, in files of plain panels.

        Returns
        -------
        list of pathlib.Path
            The files written; some formats take several.

        Raises
        ------
        FileError
            When there is no such folder, or it cannot be written to.
        FormatError
            When the format is unknown or cannot hold the model.
        """
        from moldloft.files import commit, ending, produce

        path = Path(path)
        if not path.parent.is_dir():
            raise FileError(f"cannot write `{path}`: there is no folder `{path.parent}`")
        wanted = format or ending(path)
        names = [tags] if isinstance(tags, str) else list(tags)
        files = produce(
            self,
            wanted,
            path,
            lids=lids,
            immersed=immersed,
            tolerance=tolerance,
            tags=names,
            whole=whole,
            triangles=triangles,
        )
        return commit(path.parent, files)

    def encoded(
        self,
        format: str,
        name: str,
        *,
        lids: bool = False,
        immersed: bool = False,
        tags: Sequence[str] = (),
        tolerance: float | None = None,
        whole: bool = False,
        triangles: bool = False,
    ) -> dict[str, bytes]:
        """The files of a format by name, without writing them; the first is called ``name``.

        For the formats of the Rust table; :func:`moldloft.files.produce` takes all. Arguments as
        for :meth:`write`.

        Parameters
        ----------
        format
            The name of a format, see :data:`moldloft.files.FORMATS`.
        name
            The name of the main file.
        lids
            Include lids.
        immersed
            Cut at z = 0 and keep what is below, for panel codes.
        tags
            Only patches with one of these tags; by default all.
        tolerance
            The largest error of fitted surfaces.
        whole
            Both sides of a symmetric model, in files of plain panels.
        triangles
            Triangles only, in files of plain panels.
        """
        return dict(
            self._document.write(
                format, name, lids, immersed, list(tags), tolerance, whole, triangles
            )
        )

    # -- for other packages ----------------------------------------------------------------

    def to_pyvista(self, *, tags: str | Sequence[str] = ()) -> Any:
        """The panels as ``pyvista.PolyData``; see :func:`moldloft.adapters.to_pyvista`.

        Parameters
        ----------
        tags
            Only patches with one of these tags; by default all.
        """
        from moldloft.adapters import to_pyvista

        return to_pyvista(self, tags=tags)

    def to_trimesh(self, *, tags: str | Sequence[str] = ()) -> Any:
        """The panels as ``trimesh.Trimesh``; see :func:`moldloft.adapters.to_trimesh`.

        Parameters
        ----------
        tags
            Only patches with one of these tags; by default all.
        """
        from moldloft.adapters import to_trimesh

        return to_trimesh(self, tags=tags)

    def to_meshio(self, *, tags: str | Sequence[str] = ()) -> Any:
        """The panels as ``meshio.Mesh``; see :func:`moldloft.adapters.to_meshio`.

        Parameters
        ----------
        tags
            Only patches with one of these tags; by default all.
        """
        from moldloft.adapters import to_meshio

        return to_meshio(self, tags=tags)

    def to_capytaine(self, *, lids: bool = False, name: str = "model") -> Any:
        """The wetted panels for Capytaine; see :func:`moldloft.adapters.to_capytaine`.

        Parameters
        ----------
        lids
            Include lids.
        name
            What Capytaine calls the body.
        """
        from moldloft.adapters import to_capytaine

        return to_capytaine(self, lids=lids, name=name)

    def to_ocp(self, *, accuracy: float | None = None) -> Any:
        """The exact surfaces as an OCCT shape; see :func:`moldloft.adapters.to_ocp`.

        Parameters
        ----------
        accuracy
            The largest error of fitted surfaces; exact ones have none.
        """
        from moldloft.adapters import to_ocp

        return to_ocp(self, accuracy=accuracy)

    def to_gmsh(self, *, accuracy: float | None = None, name: str = "moldloft") -> list[Any]:
        """Adds the exact surfaces to Gmsh; see :func:`moldloft.adapters.to_gmsh`.

        Parameters
        ----------
        accuracy
            The largest error of fitted surfaces; exact ones have none.
        name
            The name of Gmsh's model.
        """
        from moldloft.adapters import to_gmsh

        return to_gmsh(self, accuracy=accuracy, name=name)

    def to_pandas(self) -> Any:
        """The parameters as a ``pandas.DataFrame``; see :func:`moldloft.adapters.to_pandas`."""
        from moldloft.adapters import to_pandas

        return to_pandas(self)

    def picture(self, width: int = 1280, height: int = 720) -> bytes:
        """A picture of the panels, contours and wires, as PNG.

        Parameters
        ----------
        width, height
            In points of the picture.
        """
        return bytes(self._document.picture(width, height))

    def kind_picture(self, kind: str, width: int = 360, height: int = 240) -> bytes:
        """A picture, as PNG, in which the objects of one kind stand out among the others.

        Parameters
        ----------
        kind
            The name of a kind.
        width
            Width of the picture, pixels.
        height
            Height of the picture, pixels.
        """
        return bytes(self._document.portrait(kind, width, height))

    def convert(self, to: str) -> str:
        """The model's text in another form: ``"sdl"`` or ``"ms2"``.

        Parameters
        ----------
        to
            ``"sdl"`` or ``"ms2"``.
        """
        return self._document.convert(to)

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

"""Hydrostatics, equilibrium, weights and stability of a model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from moldloft.arguments import explain, names_of
from moldloft.errors import Error
from moldloft.hydro.hydrostatics import (
    Hydrostatics,
    HydrostaticTable,
    RightingCurve,
    faceted,
    triangles_off,
)
from moldloft.hydro.weights import Weight, WeightTable
from moldloft.units import Units

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft import _core
    from moldloft.hydro.stability import Stability
    from moldloft.models import Model

__all__ = ["Floating"]

#: Beyond it an angle is one in degrees.
_MOST_TURN = 2 * math.pi + 1e-9

#: Coordinates of the centre of buoyancy.
_CENTRE = ("lcb", "tcb", "vcb", "kb")

#: Figures that a skin has with water inside.
_WHEN_FLOODED = frozenset(
    [
        "level",
        "trim",
        "heel",
        "draft",
        "draft_low_x",
        "draft_mid",
        "draft_high_x",
        "freeboard",
        "displacement",
        "weight",
    ]
)


def _add_misses(answer: dict[str, Any], off: dict[str, float], images: int, water: float) -> None:
    """Adds the misses of triangles to the bounds of a state's main figures."""
    bounds = answer["bounds"]
    volume = off["volume"] * images
    misses = {"volume": volume, "displacement": volume * water, "wetted_area": off["area"] * images}
    if answer["volume"]:
        reach = off["reach"] + abs(answer["level"])
        misses |= dict.fromkeys(_CENTRE, volume * reach / abs(answer["volume"]))
    for name, miss in misses.items():
        if name in bounds:
            bounds[name] += miss


class Floating:
    """Hydrostatics, weights and stability: the methods of a model that concern floating."""

    if TYPE_CHECKING:
        # The class of models has it.
        @property
        def _document(self) -> _core.Document: ...

    def wetted_areas(
        self,
        *,
        level: float = 0.0,
        trim: float = 0.0,
        heel: float = 0.0,
        sides: str = "both",
        by: str = "object",
        accuracy: float = 1e-6,
    ) -> dict[str, float]:
        """The wetted area of each part of the model, in one attitude.

        The areas are integrals over the surfaces and add up to ``wetted_area`` of
        :meth:`hydrostatics`, but those by tag: an object counts for each of its tags.

        Parameters
        ----------
        level, trim, heel
            As in :meth:`hydrostatics`; those of its answers are attributes of them.
        sides
            ``"both"``, or ``"one"`` side of a model that is mirrored in y = 0.
        by
            ``"object"``, or ``"tag"``.
        accuracy
            The requested relative error of the whole area, 1e-12 to 0.1.

        Returns
        -------
        dict of str to float
            Areas in the square of the model's unit of length, in the order of declaration.

        Raises
        ------
        Error
            If a word is unknown, or one side heels.
        ModelError
            If the model has no surfaces or is not whole; see :attr:`partial`.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint a(0, 0, -2); AbsPoint b(4, 0, -2); AbsPoint c(0, 1, -2); AbsPoint d(4, 1, -2);
        ... AbsPoint e(0, 0, 1); AbsPoint f(4, 0, 1); Line ab(a, b); Line cd(c, d); Line ef(e, f);
        ... RuledSurf bottom(ab, cd, tags = "flat"); RuledSurf wall(ab, ef);
        ... ''')
        >>> m.partial = True
        >>> for name, area in m.wetted_areas().items():
        ...     print(f"{name} {area:.6f}")
        bottom 4.000000
        wall 8.000000
        >>> round(m.wetted_areas(by="tag")["flat"], 6)
        4.0
        """
        if by not in ("object", "tag"):
            raise Error(f'`by` is "object" or "tag", not {by!r}')
        if sides not in ("both", "one"):
            raise Error(f'`sides` is "both" or "one", not {sides!r}')
        half = sides == "one" and "y" in self._document.symmetry()
        if half and heel != 0.0:
            raise Error("one side of a model does not heel alone")
        found: dict[str, float] = {}
        for name, tags, area in self._document.wetted_areas((level, trim, heel), accuracy):
            for key in tags if by == "tag" else [name]:
                found[key] = found.get(key, 0.0) + (0.5 * area if half else area)
        return found

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
        """Hydrostatics of the model at a given draft, trim and heel: displacement and stability.

        The figures are integrals over the surfaces, with bounds in ``bounds``.
        :meth:`panel_figures` has the displacement of the panels.

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
            The requested relative error, 1e-12 to 0.1. The bound that was reached is in
            ``bounds``.

        Returns
        -------
        Hydrostatics
            Figures in the units of the model, with their bounds; angles in radians.

        Raises
        ------
        Error
            If a density or accuracy is out of its range, or both level and draft are given.
        ModelError
            If the model has no surfaces, or cannot float so.

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
        """The equilibrium attitude of a body of given mass.

        Parameters
        ----------
        displacement
            The mass; by default that of the model's weights, with their centre of gravity.
        cg
            The centre of gravity in the model's axes.
        free
            Unknowns besides the draft: ``"trim"``, ``"heel"``, or both (the default with ``cg``). A
            model mirrored in y = 0 with its centre of gravity there is upright by default; if that
            is unstable, the attitude is that of loll, and ``lolls`` is true.
        trim, heel
            Kept where they are not free; else where the search begins, in radians.
        density, gravity, sides, by, accuracy
            See :meth:`hydrostatics`. Derivatives are those of the whole solution.

        Returns
        -------
        Hydrostatics
            Its ``status`` is ``"converged"`` at an equilibrium; ``stable`` is true for positive
            stiffness in heel and trim.

        Raises
        ------
        ModelError
            If the body cannot carry the mass.

        Examples
        --------
        >>> import moldloft
        >>> from moldloft.starter import BOX
        >>> rest = moldloft.loads(BOX).equilibrium(40, density=1)
        >>> round(rest.volume, 6)
        40.0
        """
        of_weights = displacement is None
        if displacement is None:
            total = self.weights()
            if not total.rows:
                raise Error(
                    "no floating mass is known\nhelp: give the displacement, or declare weights: "
                    "Weight engine({2, 0, 0.5}, mass = 3);"
                )
            if cg is not None:
                raise Error("give both displacement and cg, or neither to use those of the weights")
            displacement, cg = total.mass, total.centre
        held = free is None and cg is not None
        if free is None:
            upright = (
                "y" in self._document.symmetry() and cg is not None and cg[1] == 0 and heel == 0
            )
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
            Acceleration of gravity in model units; default 9.80665 m/s² if the model states its
            units.
        sides
            ``"both"`` includes the mirror image of a mirrored model, ``"one"`` excludes it.
        by
            Names of parameters.
        accuracy
            The relative accuracy of the figures.

        Returns
        -------
        HydrostaticTable
            A row for each draft. Where the water enters over an open edge the figures are NaN.

        Raises
        ------
        Error
            If a density or accuracy is out of its range, or both level and draft are given.
        ModelError
            If the model has no surfaces, or cannot float so.

        Examples
        --------
        >>> import moldloft
        >>> from moldloft.starter import BOX
        >>> table = moldloft.loads(BOX).hydrostatic_table([0.5, 1.0])
        >>> (table.column("volume")[1] / table.column("volume")[0]).round(6).item()
        2.0
        """
        rows = [("draft", float(draft), float(trim), 0.0, False, False) for draft in drafts]
        return HydrostaticTable(
            self._floating(rows, cg, density, gravity, sides, by, accuracy, flooded=True)
        )

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
            True for free trim at each heel; False for constant trim.
        density, gravity, by, accuracy
            See :meth:`hydrostatics`.

        Returns
        -------
        RightingCurve
            A row for each heel. Where the water enters over an open edge, such as the sheer of a
            hull without deck, only the attitude and the freeboard are numbers; ``gz`` is NaN.

        Raises
        ------
        ModelError
            If the body cannot carry the mass, or the skin is open below the water upright and at
            every heel.

        Examples
        --------
        >>> import moldloft
        >>> from moldloft.starter import BOX
        >>> curve = moldloft.loads(BOX).righting_curve([0.0, 0.2], 40, cg=(0, 0, 0.4), density=1)
        >>> bool(abs(curve.column("gz")[0]) < 1e-9)
        True
        """
        rows = [
            ("displacement", float(displacement), float(trim), float(heel), free_trim, False)
            for heel in heels
        ]
        found = self._floating(rows, cg, density, gravity, "both", by, accuracy, flooded=True)
        if found and all(state.gz is not None and math.isnan(state.gz) for state in found):
            upright = ("displacement", float(displacement), float(trim), 0.0, free_trim, False)
            self._floating([upright], cg, density, gravity, "both", by, accuracy)
        return RightingCurve(found)

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
        flooded: bool = False,
    ) -> list[Hydrostatics]:
        centre = None if cg is None else [float(x) for x in cg]
        if centre is not None and len(centre) != 3:
            raise Error(f"a centre of gravity is x, y, z, not {len(centre)} numbers")
        for given, number, trim, heel, _, _ in rows:
            if given == "draft" and number < 0:
                raise Error(
                    f"a draft is the depth of the lowest point: expected >= 0, found {number:g}\n"
                    "help: the height of the water in the model's axes is `level`"
                )
            for name, angle in (("trim", trim), ("heel", heel)):
                if not abs(angle) <= _MOST_TURN:
                    raise Error(
                        f"a {name} is in radians, {angle:g} is more than a whole turn\n"
                        f"help: np.radians({angle:g}) are {angle:g} degrees"
                    )
        units = self.units
        water = units.water(density)
        if water is None and any(row[0] == "displacement" for row in rows):
            raise Error(
                "a mass floats in water of a density\n"
                'help: state density="salt", "fresh" or mass per volume in the model\'s units; '
                "in the command: --density salt"
            )
        answers = self._document.floating(
            rows, water or 1.0, gravity, centre, sides, names_of(by), accuracy, of_weights, flooded
        )
        massive = ("displacement", "weight", "tpc", "mtc", "righting_moment")
        names, off = triangles_off(cast("Model", self))
        sets = faceted(cast("Model", self))
        images = 2 ** len(self._document.symmetry()) if sides == "both" else 1
        partial = self._document.partial() and not self._document.is_whole()
        found = [*self._document.inner_skins(), *self._document.folded_surfaces()]
        doubts = [diagnostic.message for diagnostic in found]
        for answer in answers:
            if answer["open_edges"] and not self._document.partial():
                lost = (k for k in set(answer) - _WHEN_FLOODED if isinstance(answer[k], float))
                answer |= dict.fromkeys(lost, math.nan)
                zero = dict.fromkeys(names_of(by), math.nan)
                answer["derivatives"] = {name: dict(zero) for name in answer["derivatives"]}
            answer["partial"] = partial or (answer["open_edges"] > 0 and self._document.partial())
            answer["doubts"] = doubts
            answer["faceted"] = sets
            if names:
                answer["on_triangles"] = names
                _add_misses(answer, off, images, water or 1.0)
            if sets or answer["open_edges"]:
                answer["bounds"] = {}
            if names or not answer["bounds"]:
                answer["derivative_bounds"] = {}
            if water is None:
                for name in massive:
                    answer.pop(name, None)
                    answer["derivatives"].pop(name, None)
                    answer["bounds"].pop(name, None)
                    answer["derivative_bounds"].pop(name, None)
            answer["units"] = units if density is None else units.complete()
            answer["accuracy"] = accuracy
            # The core multiplies masses by gravity in the model's own units.
            force = answer["units"].force_scale()
            for name in ("weight", "righting_moment"):
                if answer.get(name) is not None:
                    answer[name] *= force
                    if name in answer["bounds"]:
                        answer["bounds"][name] *= force
                    for key in ("derivatives", "derivative_bounds"):
                        for by_name in answer[key].get(name, {}):
                            answer[key][name][by_name] *= force
        return [Hydrostatics(**answer) for answer in answers]

    @property
    def units(self) -> Units:
        """The units that the model states: ``Model info(units = "m t");``."""
        return Units.parse(" ".join(word for word, _ in self._document.units()))

    @property
    def length_unit(self) -> tuple[str, float]:
        """The unit of length and its size in metres; metres if the model states no unit."""
        unit = self.units.length or "m"
        return unit, Units(unit).metres

    def tonnes(self, mass: float) -> float | None:
        """A mass of the model in tonnes; ``None`` if its unit is unknown.

        Parameters
        ----------
        mass
            A mass in the model's unit.

        Returns
        -------
        float or None
            Tonnes.

        Examples
        --------
        >>> import moldloft
        >>> moldloft.loads('Model info(units = "m kg");').tonnes(2500)
        2.5
        """
        units = self.units.complete()
        return mass * units.kilograms / 1000 if units.mass else None

    def weights(self) -> WeightTable:
        """The weights that the model declares, by group, with their sum.

        Returns
        -------
        WeightTable
            Empty if the model declares no weights.

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
            True for free trim at each heel; False for constant trim.
        openings
            Points by name through which water enters: the angle of flooding.
        gravity, accuracy
            See :meth:`hydrostatics`.

        Returns
        -------
        Stability
            Evaluated on demand: the arms, angles and criteria are its methods.

        Raises
        ------
        Error
            Without a mass, a centre of gravity or a density.
        ModelError
            If the body cannot carry the mass.

        Examples
        --------
        >>> import math, moldloft
        >>> from moldloft.starter import BOX
        >>> box = moldloft.loads(BOX)
        >>> s = box.stability(40, cg=(0, 0, 0.4), density=1)
        >>> round(math.degrees(s.vanishing()), 2), s.stable
        (80.21, True)
        """
        from moldloft.hydro.stability import Opening, Stability

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
                'help: state density="salt", "fresh" or mass per volume in the model\'s units; '
                "in the command: --density salt"
            )
        points = [
            Opening(name, (float(x), float(y), float(z)))
            for name, (x, y, z) in (openings or {}).items()
        ]
        return Stability(
            cast("Model", self),
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
            Positions along x, in model units.
        levels
            Heights of the water, in model units.
        accuracy
            The relative accuracy of the areas.

        Returns
        -------
        numpy.ndarray
            Shape ``(stations, levels)``.

        Examples
        --------
        >>> import moldloft
        >>> from moldloft.starter import BOX
        >>> moldloft.loads(BOX).section_areas([0.0], [-0.25, 0.0]).round(12)
        array([[3., 4.]])
        """
        import numpy as np

        planes, heights = [float(x) for x in stations], [float(z) for z in levels]
        if not planes or not heights:
            return np.zeros((len(planes), len(heights)))
        areas = self._document.section_areas(planes, heights, accuracy)
        return np.array(areas, dtype=np.float64)[..., 0]

    def panel_figures(self, level: float = 0.0) -> dict[str, float]:
        """Displacement of the panels below an upright level, as seen by a panel code.

        ``volume``, ``wetted_area`` and ``waterplane_area``; those of the shape are in
        :meth:`hydrostatics`.

        Parameters
        ----------
        level
            Height of the water, in model units.

        Returns
        -------
        dict
            Areas and the volume in the model's unit of length.
        """
        names = ("volume", "wetted_area", "waterplane_area")
        return dict(zip(names, self._document.panel_figures(float(level)), strict=True))


for _name, _method in list(vars(Floating).items()):
    if callable(_method):
        # Messages and help name the class that users know.
        _method.__qualname__ = f"Model.{_name}"

explain(globals())

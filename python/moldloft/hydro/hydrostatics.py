"""Hydrostatics of a hull: displacement and stability."""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from moldloft.arguments import explain
from moldloft.errors import Error, UnknownNameError
from moldloft.units import DIMENSIONS, Units, header, shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft.models import Model

__all__ = ["HydrostaticTable", "Hydrostatics", "RightingCurve", "rounded_to_bound"]


#: Figures that must be known to the accuracy of themselves; moments are known to that of the body's
#: size.
_RELATIVE = ("volume", "displacement", "wetted_area", "waterplane_area")


#: Kinds whose panels are triangles near a shape of known volume and area.
_ON_TRIANGLES = ("TrimSurf", "MeshBody")

#: Misses of volume and area, relative to the body's, that are rounding.
_ROUNDING = 1e-12


def triangles_off(model: Model) -> tuple[list[str], dict[str, float]]:
    """Round bodies and trimmed surfaces measured by triangles, with estimates of the errors.

    Figures of the triangles are compared with those of the shape. ``volume`` is twice the error of
    the cones' volumes, since errors above and below the water may cancel; for bodies also the error
    of the area times their size, since those of bores and bosses may cancel. ``area`` is twice the
    error of the areas; ``reach`` is the largest distance of the panels from the model's origin.
    """
    import numpy as np

    names: list[str] = []
    on_panels = model._document.on_panels()
    if not on_panels:
        return names, {}
    mesh = model.mesh()
    volume = area = 0.0
    size = float(np.ptp(mesh.vertices, axis=0).max()) if len(mesh.vertices) else 0.0
    for patch in mesh.patches:
        if patch.name not in on_panels or patch.name not in model.objects:
            continue
        if (part := model[patch.name]).kind not in _ON_TRIANGLES:
            continue
        corners = mesh.vertices[mesh.faces[patch.start : patch.stop]]
        halves = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
        cross = np.cross(halves[:, 1], halves[:, 2])
        cone = float(np.einsum("ij,ij->", halves[:, 0], cross)) / 6
        exact = float(np.ravel(model.eval(f"{patch.name}.volume"))[0])
        # Panels may run against the surface.
        miss = abs(min(exact - cone, -exact - cone, key=abs))
        less = abs(part.area - patch.area)
        if part.kind == "MeshBody" and miss + less * size <= _ROUNDING * part.area * size:
            continue
        names.append(patch.name)
        volume += 2 * miss + (less * size if part.kind == "MeshBody" else 0.0)
        area += 2 * less
    reach = float(np.linalg.norm(mesh.vertices, axis=1).max()) if names else 0.0
    return names, {"volume": volume, "area": area, "reach": reach}


def faceted(model: Model) -> list[str]:
    """Bodies of sets, measured by facets at an unknown distance from the set."""
    names = {patch.name.split(".")[0]: None for patch in model.mesh().patches}
    known = [name for name in names if name in model.objects]
    return [name for name in known if model.facts(name)["kind"] == "SetBody"]


@dataclass(frozen=True)
class Hydrostatics:
    """The hydrostatics of a body; lengths in the model's unit, angles in radians.

    Undefined figures, such as those of the waterplane of a submerged body, are ``None``. Centres
    (``lcb`` to ``vcb``, ``lcf``, ``tcf``) are in body axes; the extents of the waterplane of a
    trimmed or heeled body are in level axes.
    """

    level: float
    """Height z of the water."""
    sides: str
    """``"both"`` if a mirrored model includes its image, ``"one"`` if not, and
    ``"whole"`` for a model without symmetry."""
    volume: float
    """Displaced volume."""
    wetted_area: float
    """Area of the skin below the water."""
    draft: float
    """Depth of the lowest point below the water."""
    open_edges: int
    """Open edges of the skin below the water, without those in the symmetry plane."""
    closure_error: float
    """Largest difference between the volumes by x, y and z over the volume."""
    waterplane_error: float
    """Difference between the waterplane's area from the skin and from the waterline, over it."""
    outward: bool
    """True when the skin's normals point out of the body; otherwise the figures are those of the
    reversed skin.
    """
    displacement: float | None = None
    """Mass: density times volume; ``None`` where no density was given."""
    lcb: float | None = None
    """Centre of buoyancy, x."""
    tcb: float | None = None
    """Centre of buoyancy, y."""
    vcb: float | None = None
    """Centre of buoyancy, z."""
    waterplane_area: float | None = None
    """Area of the waterplane."""
    lcf: float | None = None
    """Centre of flotation, x."""
    tcf: float | None = None
    """Centre of flotation, y."""
    waterplane_it: float | None = None
    """Second moment of the waterplane about its longitudinal axis."""
    waterplane_il: float | None = None
    """Second moment of the waterplane about its transverse axis."""
    waterplane_product: float | None = None
    """Product moment of the waterplane about level axes through its centre."""
    waterline_low_x: float | None = None
    """Lowest x of the waterline."""
    waterline_high_x: float | None = None
    """Highest x of the waterline."""
    waterline_length: float | None = None
    """Extent of the waterline in x."""
    waterline_beam: float | None = None
    """Extent of the waterline in y."""
    midship_area: float | None = None
    """Immersed area of the section midway between the ends of the waterline."""
    cb: float | None = None
    """Block coefficient, volume / (length beam draft); the form coefficients are those of an
    upright body and ``None`` where it heels."""
    cp: float | None = None
    """Prismatic coefficient, volume / (midship area length)."""
    cm: float | None = None
    """Midship coefficient, midship area / (beam draft)."""
    cwp: float | None = None
    """Waterplane coefficient, waterplane area / (length beam)."""
    kb: float | None = None
    """Height of the centre of buoyancy above the lowest point."""
    bmt: float | None = None
    """Transverse metacentric radius."""
    bml: float | None = None
    """Longitudinal metacentric radius."""
    kmt: float | None = None
    """Height of the transverse metacentre above the lowest point."""
    kml: float | None = None
    """Height of the longitudinal metacentre above the lowest point."""
    trim: float = 0.0
    """Rotation about the transverse axis; positive if points with large x sink."""
    heel: float = 0.0
    """Rotation about the body's x axis; positive if points with large y sink."""
    draft_low_x: float | None = None
    """Depth of the upright body's lowest height below the water, on the centre line at the body's
    lowest x."""
    draft_mid: float | None = None
    """The same in the middle of its length."""
    draft_high_x: float | None = None
    """The same at its highest x."""
    freeboard: float | None = None
    """Height of the lowest open edge over the water, such as the sheer of a hull without deck;
    negative where it is below: the water enters, and the other figures are NaN unless
    ``Model.partial`` is set."""
    weight: float | None = None
    """Displacement times gravity."""
    tpc: float | None = None
    """Mass that sinks the body by a centimetre."""
    mtc: float | None = None
    """Moment (mass times length) that trims the body by a centimetre between the ends of the
    waterline: from ``gml`` where a centre of gravity was given, else from ``bml``."""
    gmt: float | None = None
    """Transverse metacentric height, where a centre of gravity was given."""
    gml: float | None = None
    """Longitudinal metacentric height."""
    gz: float | None = None
    """Righting arm; positive if it rights a positive heel."""
    trim_arm: float | None = None
    """Longitudinal righting arm; zero in trim equilibrium."""
    righting_moment: float | None = None
    """Righting arm times weight."""
    status: str = "given"
    """``"given"`` for a given attitude; ``"converged"`` or ``"not-converged"`` for a computed one.
    """
    iterations: int = 0
    """Number of Newton steps to this attitude."""
    residual: float = 0.0
    """Residual of the equations of equilibrium: volume relative to volume, arms relative to the
    body's diagonal.
    """
    stable: bool | None = None
    """True for positive stiffness in heel and trim, with a centre of gravity: small rotations from
    equilibrium are righted, free or not. Under water the metacentre is the centre of buoyancy.
    """
    lolls: bool = False
    """True for an angle of loll: the initial attitude is an unstable equilibrium, and this is the
    stable one beyond it.
    """
    bounds: dict[str, float] = field(default_factory=dict)
    """Bounds of the errors of the main figures, by name: estimates of the errors of quadrature and
    of the interpolation of the surfaces.
    """
    units: Units = field(default_factory=Units)
    """Units of the figures."""
    accuracy: float = 0.0
    """Requested relative accuracy."""
    on_triangles: list[str] = field(default_factory=list)
    """Round bodies of sketches, and trimmed surfaces whose loops nearly cross: they are measured on
    the triangles of their panels. ``bounds`` includes the errors of volume, area and centre.
    """
    faceted: list[str] = field(default_factory=list)
    """Bodies of sets, which are measured on their facets. Their distance from the set is unknown,
    so there are no ``bounds``.
    """
    doubts: list[str] = field(default_factory=list)
    """Plates inside a body, bodies that overlap and surfaces that turn over themselves, as remarks;
    see ``Model.inner_skins`` and ``Model.folded_surfaces``."""
    partial: bool = False
    """True for a model with failed objects, or with contradictory divisions of panels; see
    ``Model.partial``.
    """
    derivatives: dict[str, dict[str, float]] = field(default_factory=dict)
    """Exact derivatives ``[figure][parameter]``, for the requested parameters."""
    derivative_bounds: dict[str, dict[str, float]] = field(default_factory=dict)
    """Estimates of the errors of :attr:`derivatives`: the difference from those of cells for a
    hundredfold ``accuracy``, plus ``accuracy`` times the derivative. Empty if ``bounds`` is."""

    @property
    def floods(self) -> bool:
        """True when an open edge is under water."""
        return self.open_edges > 0

    @property
    def remarks(self) -> list[str]:
        """Immersed openings, overlaps, folds, figures of triangles, inaccurate figures."""
        lines = []
        if self.partial:
            lines.append("the model is incomplete: the figures are those of the valid objects")
        if self.open_edges:
            count = f"{self.open_edges} open edge{'s' * (self.open_edges > 1)}"
            lines.append(
                f"{count} of the skin below the water, which enters there: the figures are not "
                "those of a body"
            )
        lines += self.doubts
        if self.on_triangles:
            named = ", ".join(f"`{name}`" for name in self.on_triangles[:3])
            more = len(self.on_triangles) - 3
            named += f" and {more} more" if more > 0 else ""
            lines.append(
                f"{named}: measured on the triangles of the panels; their distance from the shape "
                "is in the bounds"
            )
        if self.faceted:
            named = ", ".join(f"`{name}`" for name in self.faceted[:3])
            lines.append(
                f"{named}: measured on facets, which a finer size or greater depth brings nearer "
                "to the set; there are no bounds"
            )
        for name in _RELATIVE:
            value = getattr(self, name)
            if value and (share := self.bounds.get(name, 0.0) / abs(value)) > self.accuracy > 0:
                lines.append(
                    f"{name}: relative accuracy {share:.1g}; requested: {self.accuracy:.1g}"
                )
        return lines

    def as_dict(self) -> dict[str, Any]:
        """All defined figures by name, in a fixed order.

        Returns
        -------
        dict
            Numbers, vectors as lists; in the units of :attr:`units`.
        """
        pairs = ((field.name, getattr(self, field.name)) for field in fields(self))
        kept = {name: value for name, value in pairs if value is not None}
        del kept["units"]
        if not self.derivatives:
            del kept["derivatives"]
        if not self.derivative_bounds:
            del kept["derivative_bounds"]
        if not self.on_triangles:
            del kept["on_triangles"]
        if not self.faceted:
            del kept["faceted"]
        if not self.doubts:
            del kept["doubts"]
        if not self.partial:
            del kept["partial"]
        return kept

    def _repr_html_(self) -> str:
        from moldloft.display import state_html

        return state_html(self)

    def unit(self, figure: str) -> str:
        """The unit of a figure; empty if the model states no units.

        Parameters
        ----------
        figure
            The name of a figure, such as ``"volume"``.

        Returns
        -------
        str
            Such as ``"m³"``.

        Raises
        ------
        UnknownNameError
            If there is no such figure.
        """
        if figure not in {each.name for each in fields(self)}:
            known = ", ".join(_NUMBERS)
            raise UnknownNameError(f"unknown figure `{figure}`; expected one of: {known}")
        return self.units.of(figure)

    def stiffness(
        self,
        cg: Sequence[float],
        *,
        mass: float | None = None,
        about: Sequence[float] | None = None,
        by: str | None = None,
    ) -> NDArray[np.float64]:
        """The hydrostatic stiffness matrix: surge, sway, heave, roll, pitch, yaw.

        In level axes: x and y horizontal, x along the body; rotations in radians. With the centre
        of buoyancy B, of gravity G and of flotation F from ``about``, the waterplane's area A and
        moments about that point, weight W and buoyancy D:
        ``C33 = gamma A``, ``C34 = gamma A y_F``, ``C35 = -gamma A x_F``,
        ``C44 = gamma I_yy + D z_B - W z_G``, ``C55 = gamma I_xx + D z_B - W z_G``,
        ``C45 = -gamma I_xy``, ``C46 = W x_G - D x_B``, ``C56 = W y_G - D y_B``; all others are 0
        (J. N. Newman, Marine Hydrodynamics, 1977, section 6.16). A body under water has no
        waterplane, and the moments alone.

        Parameters
        ----------
        cg
            Centre of gravity in the model's axes, ``(3,)``.
        mass
            The mass, where it is not the displacement: a moored or supported body.
        about
            The point that the rotations are about, in the model's axes; default: ``cg``.
        by
            A parameter of ``by`` of these figures: the derivative of the matrix by it.

        Returns
        -------
        numpy.ndarray
            ``(6, 6)``, in the units of force and length of :attr:`units`.

        Raises
        ------
        Error
            If the figures have no density, or are of one side.
        UnknownNameError
            If the figures have no derivatives with respect to ``by``.

        Examples
        --------
        >>> import moldloft
        >>> from moldloft.starter import BOX
        >>> state = moldloft.loads(BOX).hydrostatics(density=1.0, gravity=1.0)
        >>> k = state.stiffness((0, 0, 0.1))
        >>> bool(abs(k[2, 2] - state.waterplane_area) < 1e-9)
        True
        """
        from moldloft.hydro.stiffness import stiffness

        return stiffness(self, cg, mass=mass, about=about, by=by)

    def write_kh(
        self, folder: str | os.PathLike[str], cg: Sequence[float], *, mass: float | None = None
    ) -> list[Path]:
        """Write ``KH.dat`` and ``Hydrostatics.dat``, as Nemoh's mesher does for its solver.

        Parameters
        ----------
        folder
            An existing folder.
        cg, mass
            See :meth:`stiffness`.

        Returns
        -------
        list of pathlib.Path
            The two files.

        Raises
        ------
        Error
            If the figures have no density, or are of one side.
        FileError
            If there is no such folder, or it cannot be written to.
        """
        from moldloft.exchange.files import Output, commit
        from moldloft.hydro.stiffness import kh_files

        files = kh_files(self, cg, mass)
        return commit(Path(folder), [Output(*pair) for pair in files.items()], make=False)

    def converted(self, to: Units | str) -> Hydrostatics:
        """The same in other units, such as ``"m t kN"``; other dimensions are unchanged.

        Parameters
        ----------
        to
            Units, such as ``"m t kN"``.

        Returns
        -------
        Hydrostatics
            A new one; this stays as it is.

        Raises
        ------
        Error
            If a word is not a unit, or the model states no units.
        """
        to = Units.parse(to) if isinstance(to, str) else to
        changed: dict[str, Any] = {}
        for name in DIMENSIONS:
            value = getattr(self, name, None)
            if value is not None:
                changed[name] = value * self.units.factor(name, to)
        scale = {name: self.units.factor(name, to) for name in self.bounds}
        changed["bounds"] = {name: bound * scale[name] for name, bound in self.bounds.items()}
        for key in ("derivatives", "derivative_bounds"):
            changed[key] = {
                name: {by: x * self.units.factor(name, to) for by, x in row.items()}
                for name, row in getattr(self, key).items()
            }
        mine = self.units
        changed["units"] = Units(
            to.length or mine.length, to.mass or mine.mass, to.force or mine.force, mine.angle
        )
        return replace(self, **changed)


def rounded_to_bound(flotation: Hydrostatics, name: str) -> Any:
    """A figure for print: without digits far below its bound.

    Parameters
    ----------
    flotation
        The figures.
    name
        The name of one of them.
    """
    value, bound = getattr(flotation, name), flotation.bounds.get(name, 0.0)
    if not isinstance(value, float) or not 0 < bound < math.inf:
        return value
    return round(value, 1 - math.floor(math.log10(bound))) + 0.0


_NUMBERS = [
    f.name
    for f in fields(Hydrostatics)
    if f.name
    not in (
        "sides",
        "status",
        "derivatives",
        "derivative_bounds",
        "bounds",
        "units",
        "accuracy",
    )
]


class _Rows:
    """Rows of figures: common part of tables and curves."""

    rows: tuple[Hydrostatics, ...]
    """One for each draft or heel."""

    def __init__(self, rows: Sequence[Hydrostatics]) -> None:
        self.rows = tuple(rows)

    @property
    def units(self) -> Units:
        """Units of the figures."""
        return self.rows[0].units if self.rows else Units()

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Hydrostatics]:
        return iter(self.rows)

    def column(self, name: str) -> NDArray[np.float64]:
        """One figure of all rows; ``nan`` where it is undefined.

        Parameters
        ----------
        name
            The name of a figure, such as ``"volume"``.

        Returns
        -------
        numpy.ndarray
            Shape ``(rows,)``, in the units of :attr:`units`, angles in radians.

        Raises
        ------
        UnknownNameError
            If there is no such figure.
        """
        import numpy as np

        if name not in _NUMBERS:
            known = ", ".join(_NUMBERS)
            raise UnknownNameError(f"unknown figure `{name}`; expected one of: {known}")
        values = [getattr(row, name) for row in self.rows]
        return np.array([math.nan if v is None else v for v in values], dtype=np.float64)

    def derivative(self, name: str, by: str) -> NDArray[np.float64]:
        """Derivative of one figure with respect to a parameter in all rows, or ``nan``.

        Parameters
        ----------
        name
            The name of a figure, such as ``"volume"``.
        by
            One of the requested parameters.

        Returns
        -------
        numpy.ndarray
            Shape ``(rows,)``, per unit of the parameter.

        Raises
        ------
        UnknownNameError
            If there is no such figure, or no derivative with respect to this parameter.
        """
        import numpy as np

        self.column(name)
        got = (each for row in self for some in row.derivatives.values() for each in some)
        known = list(dict.fromkeys(got))
        if by not in known:
            raise UnknownNameError(
                f"no derivatives by `{by}` were asked for; there are those by: "
                + (", ".join(known) or "none")
            )
        rows = [row.derivatives.get(name, {}).get(by, math.nan) for row in self.rows]
        return np.array(rows, dtype=np.float64)

    @property
    def floods(self) -> bool:
        """True when an open edge is under water in some row."""
        return any(row.floods for row in self.rows)

    #: The figures that a notebook shows.
    _shown: ClassVar[tuple[str, ...]] = ()

    def _repr_html_(self) -> str:
        from moldloft.display import rows_html

        return rows_html(self, self._shown)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.rows)} rows>"

    def as_list(self) -> list[dict[str, Any]]:
        """The rows as dictionaries.

        Returns
        -------
        list of dict
            See :meth:`Hydrostatics.as_dict`.
        """
        return [row.as_dict() for row in self.rows]

    def csv(self, columns: Sequence[str] | None = None) -> str:
        """The rows as comma-separated text (RFC 4180), units in its header; angles in degrees.

        Parameters
        ----------
        columns
            Figures; by default all that are defined in some row.

        Returns
        -------
        str
            A line for each row, ended by CR LF.

        Raises
        ------
        UnknownNameError
            If there is no such figure.
        """
        wanted = columns or [n for n in _NUMBERS if any(getattr(r, n) is not None for r in self)]
        for name in wanted:
            self.column(name)
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\r\n")
        writer.writerow([header(name, self.units) for name in wanted])
        for row in self.rows:
            values = [shown(name, getattr(row, name)) for name in wanted]
            writer.writerow(["" if v is None else repr(v) for v in values])
        return text.getvalue()

    def write_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write :meth:`csv` to a file atomically.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        FileError
            If there is no such folder, or it cannot be written to.
        """
        from moldloft.exchange.files import Output, commit

        path = Path(path)
        return commit(path.parent, [Output(path.name, self.csv().encode())], make=False)[0]


class HydrostaticTable(_Rows):
    """Hydrostatics over a range of drafts; see :meth:`moldloft.Model.hydrostatic_table`."""

    _shown = (
        *("draft", "volume", "displacement", "lcb", "vcb", "waterplane_area", "lcf"),
        *("kmt", "kml", "tpc", "mtc", "cb", "cp", "cm", "cwp"),
    )

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draw the hydrostatic curves: displacement, centres and metacentres over the draft.

        Needs matplotlib (``pip install 'moldloft[plot]'``); the file's ending gives its form.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        Error
            If Matplotlib does not support the extension.
        FileError
            If there is no such folder, or it cannot be written to.
        """
        figure, axes = _axes(3)
        draft = self.column("draft")
        massive = any(row.displacement is not None for row in self.rows)
        first = "displacement" if massive else "volume"
        columns = [
            ([first], header(first, self.units)),
            (["lcb", "lcf"], header("lcb", self.units).replace("lcb", "centres along x")),
            (["kb", "kmt"], header("kb", self.units).replace("kb", "height over the lowest point")),
        ]
        for axis, (names, label) in zip(axes, columns, strict=True):
            for name in names:
                axis.plot(self.column(name), draft, label=name)
            axis.set_xlabel(label)
            axis.set_ylabel(header("draft", self.units))
            axis.grid(True)
            axis.legend()
        return _save(figure, path)


class RightingCurve(_Rows):
    """Righting arms over heel; see :meth:`moldloft.Model.righting_curve`."""

    _shown = ("heel", "gz", "righting_moment", "trim", "draft", "freeboard")

    @property
    def heels(self) -> NDArray[np.float64]:
        """The heels, in radians."""
        return self.column("heel")

    @property
    def gz(self) -> NDArray[np.float64]:
        """The righting arms."""
        return self.column("gz")

    @property
    def largest(self) -> tuple[float, float]:
        """The heel (in radians) and the arm of the row with the largest arm.

        Rows at which water enters have no arm; both are NaN if no row has one.
        """
        known = [(row.gz, row.heel) for row in self.rows if row.gz is not None]
        known = [(arm, heel) for arm, heel in known if not math.isnan(arm)]
        arm, heel = max(known, key=lambda pair: pair[0], default=(math.nan, math.nan))
        return heel, arm

    @property
    def vanishing(self) -> float | None:
        """The positive heel, in radians, at which a positive arm falls to zero.

        The arm is interpolated linearly between two rows; ``None`` if the arm stays positive.
        """
        rows = [(row.heel, row.gz) for row in self.rows if row.gz is not None]
        for (a, p), (b, q) in pairwise(rows):
            if b > 0 and p > 0 >= q:
                return a + (b - a) * p / (p - q)
        return None

    def area(self, low: float, high: float) -> float:
        """The integral of the arm between two heels in radians: trapezoids on the rows.

        Parameters
        ----------
        low
            The lesser heel, radians.
        high
            The greater heel, radians.

        Returns
        -------
        float
            Length times radians.
        """
        import numpy as np

        order = np.argsort(self.heels)
        heels, arms = self.heels[order], self.gz[order]
        if not heels[0] - 1e-12 <= low <= high <= heels[-1] + 1e-12:
            raise Error("the area is requested beyond the heels of the curve")
        inner = heels[(heels > low) & (heels < high)]
        x = np.concatenate([[low], inner, [high]])
        y = np.interp(x, heels, arms)
        return float(np.sum((y[1:] + y[:-1]) / 2 * np.diff(x)))

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draw the righting arms over the heel in degrees.

        Needs matplotlib (``pip install 'moldloft[plot]'``); the file's ending gives its form.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        Error
            If Matplotlib does not support the extension.
        FileError
            If there is no such folder, or it cannot be written to.
        """
        figure, (axis,) = _axes(1)
        axis.plot([math.degrees(heel) for heel in self.heels], self.gz, label="GZ")
        wet = [row for row in self.rows if row.floods]
        if wet:
            heels = [math.degrees(row.heel) for row in wet]
            axis.plot(heels, [row.gz for row in wet], "rx", label="open edge under water")
        axis.axhline(0, color="0.3", linewidth=0.8)
        axis.set_xlabel("heel [deg]")
        axis.set_ylabel(header("gz", self.units).replace("gz", "righting arm GZ"))
        axis.grid(True)
        axis.legend()
        return _save(figure, path)


def plot_curves(
    path: str | os.PathLike[str],
    along: Sequence[float],
    curves: Mapping[str, Sequence[float]],
    labels: tuple[str, str],
) -> Path:
    """Draw curves over one quantity, with marks if there are few points.

    Parameters
    ----------
    path
        The file; its ending gives its form.
    along
        The values of the quantity.
    curves
        A curve for each name, as many values as ``along`` has.
    labels
        Labels of the quantity and of the curves.
    """
    figure, (axis,) = _axes(1)
    for name, values in curves.items():
        axis.plot(along, values, "o-" if len(along) < 12 else "-", markersize=3, label=name)
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    axis.grid(True)
    axis.legend()
    return _save(figure, path)


def _axes(columns: int) -> tuple[Any, list[Any]]:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise Error("plots need matplotlib\nhelp: pip install 'moldloft[plot]'") from error
    figure = Figure(figsize=(4.5 * columns + 1.5, 4.8), layout="constrained")
    return figure, list(figure.subplots(1, columns, squeeze=False).flat)


def _save(figure: Any, path: str | os.PathLike[str]) -> Path:
    from moldloft.exchange.files import Output, commit

    path = Path(path)
    kind = path.suffix.lstrip(".").lower()
    known = figure.canvas.get_supported_filetypes()
    if kind not in known:
        raise Error(f"no plot ends in `.{kind}`; expected one of: {', '.join(sorted(known))}")
    drawn = io.BytesIO()
    # Without a date the same figures give the same file.
    metadata = {"Date": None} if kind == "svg" else None
    figure.savefig(drawn, format=kind, metadata=metadata)
    return commit(path.parent, [Output(path.name, drawn.getvalue())], make=False)[0]


explain(globals())

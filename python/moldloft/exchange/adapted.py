"""The methods of a model that hand it to other Python packages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

from moldloft.arguments import explain

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["Adapted"]


class Adapted:
    """Functions of :mod:`moldloft.adapters` as methods; packages are imported on first use."""

    def to_pyvista(
        self,
        *,
        tags: str | Sequence[str] = (),
        whole: bool = False,
        tolerance: float | None = None,
        angle: float | None = None,
    ) -> Any:
        """The panels as ``pyvista.PolyData``; see :func:`moldloft.adapters.to_pyvista`.

        Parameters
        ----------
        tags
            Only patches with one of these tags; by default all.
        whole
            Both sides of a symmetric model; by default one.
        tolerance
            The largest distance of panels from their surfaces; by default the model's divisions.
        angle
            The largest turn of a surface along a panel, in radians.

        Returns
        -------
        pyvista.PolyData
            Panels, with the number of their patch.

        Raises
        ------
        ModelError
            If no patch has such a tag.
        Error
            Without PyVista.
        """
        from moldloft.adapters import to_pyvista

        return to_pyvista(
            cast("Model", self), tags=tags, whole=whole, tolerance=tolerance, angle=angle
        )

    def to_trimesh(
        self,
        *,
        tags: str | Sequence[str] = (),
        whole: bool = False,
        tolerance: float | None = None,
        angle: float | None = None,
    ) -> Any:
        """The panels as ``trimesh.Trimesh``; see :func:`moldloft.adapters.to_trimesh`.

        Parameters
        ----------
        tags
            Only patches with one of these tags; by default all.
        whole
            Both sides of a symmetric model; by default one.
        tolerance
            The largest distance of panels from their surfaces; by default the model's divisions.
        angle
            The largest turn of a surface along a panel, in radians.

        Returns
        -------
        trimesh.Trimesh
            Triangles.

        Raises
        ------
        ModelError
            If no patch has such a tag.
        Error
            Without trimesh.
        """
        from moldloft.adapters import to_trimesh

        return to_trimesh(
            cast("Model", self), tags=tags, whole=whole, tolerance=tolerance, angle=angle
        )

    def to_meshio(
        self,
        *,
        tags: str | Sequence[str] = (),
        whole: bool = False,
        tolerance: float | None = None,
        angle: float | None = None,
    ) -> Any:
        """The panels as ``meshio.Mesh``; see :func:`moldloft.adapters.to_meshio`.

        Parameters
        ----------
        tags
            Only patches with one of these tags; by default all.
        whole
            Both sides of a symmetric model; by default one.
        tolerance
            The largest distance of panels from their surfaces; by default the model's divisions.
        angle
            The largest turn of a surface along a panel, in radians.

        Returns
        -------
        meshio.Mesh
            Vertices ``(n, 3)``, triangles and quadrilaterals.

        Raises
        ------
        ModelError
            If no patch has such a tag.
        Error
            Without meshio.
        """
        from moldloft.adapters import to_meshio

        return to_meshio(
            cast("Model", self), tags=tags, whole=whole, tolerance=tolerance, angle=angle
        )

    def to_capytaine(
        self,
        *,
        lids: bool = False,
        name: str = "model",
        tags: str | Sequence[str] = (),
        centre: Sequence[float] | None = None,
        mass: float | None = None,
        dofs: bool = True,
    ) -> Any:
        """The wetted panels for Capytaine, in SI; see :func:`moldloft.adapters.to_capytaine`.

        Parameters
        ----------
        lids
            Include lids.
        name
            Name of the body in Capytaine.
        tags
            Only patches with one of these tags; by default all.
        centre
            The centre of gravity in the model's unit; by default that of the model's weights.
        mass
            In kilograms; by default that of the model's weights.
        dofs
            Add the six degrees of freedom of a rigid body.

        Returns
        -------
        capytaine.FloatingBody
            With the wetted panels as its mesh, in metres.

        Raises
        ------
        Error
            Without Capytaine, or when no panel is below z = 0.
        """
        from moldloft.adapters import to_capytaine

        return to_capytaine(
            cast("Model", self),
            lids=lids,
            name=name,
            tags=tags,
            centre=centre,
            mass=mass,
            dofs=dofs,
        )

    def to_ocp(self, *, accuracy: float | None = None) -> Any:
        """The exact surfaces as an OCCT shape; see :func:`moldloft.adapters.to_ocp`.

        Parameters
        ----------
        accuracy
            The largest error of fitted surfaces; exact ones have none.

        Returns
        -------
        OCP.TopoDS.TopoDS_Shape
            Shells and solids, in millimetres where the model states its unit.

        Raises
        ------
        Error
            Without OCP.
        """
        from moldloft.adapters import to_ocp

        return to_ocp(cast("Model", self), accuracy=accuracy)

    def to_gmsh(self, *, accuracy: float | None = None, name: str = "moldloft") -> list[Any]:
        """Adds the exact surfaces to Gmsh; see :func:`moldloft.adapters.to_gmsh`.

        Parameters
        ----------
        accuracy
            The largest error of fitted surfaces; exact ones have none.
        name
            The name of Gmsh's model.

        Returns
        -------
        list
            Pairs ``(dimension, tag)`` of Gmsh's entities.

        Raises
        ------
        Error
            Without Gmsh.
        """
        from moldloft.adapters import to_gmsh

        return to_gmsh(cast("Model", self), accuracy=accuracy, name=name)

    def to_pandas(self) -> Any:
        """The parameters as a ``pandas.DataFrame``; see :func:`moldloft.adapters.to_pandas`.

        Returns
        -------
        pandas.DataFrame
            A row for each parameter: name, value, range.

        Raises
        ------
        Error
            Without pandas.
        """
        from moldloft.adapters import to_pandas

        return to_pandas(cast("Model", self))


explain(globals())

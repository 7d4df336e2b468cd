"""Models for other Python packages: each in one line, each package imported on first use.

Panels go to PyVista, trimesh, meshio and Capytaine; exact surfaces to OCCT (``OCP``, CadQuery,
build123d) and Gmsh; tables to pandas and xarray. ``Model.to_pyvista()`` and the like call these
functions.
"""

from __future__ import annotations

import contextlib
import signal
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import current_thread, main_thread
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error, MissingPackageError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from moldloft.models import Model
    from moldloft.shapes.mesh import Mesh

__all__ = [
    "to_capytaine",
    "to_gmsh",
    "to_meshio",
    "to_ocp",
    "to_pandas",
    "to_pyvista",
    "to_trimesh",
    "to_xarray",
]


def _module(name: str, install: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingPackageError(f"this needs {name}: pip install {install} ({error})") from error


def _panels(
    source: Model | Mesh,
    tags: str | Sequence[str],
    whole: bool,
    tolerance: float | None,
    angle: float | None,
) -> Mesh:
    from moldloft.shapes.mesh import Mesh

    if isinstance(source, Mesh):
        if tags or whole or tolerance is not None or angle is not None:
            raise Error("tags, whole, tolerance and angle are for a model; this is a mesh already")
        return source
    return source.mesh(tags=tags, whole=whole, tolerance=tolerance, angle=angle)


def _patch_numbers(mesh: Mesh) -> NDArray[np.int64]:
    numbers = np.empty(len(mesh.faces), dtype=np.int64)
    for k, patch in enumerate(mesh.patches):
        numbers[patch.start : patch.stop] = k
    return numbers


def _split(mesh: Mesh) -> tuple[NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64]]:
    """A mask of the triangles, the triangles, and the quadrilaterals."""
    faces = mesh.faces.astype(np.int64)
    triangle = faces[:, 2] == faces[:, 3]
    return triangle, faces[triangle][:, :3], faces[~triangle]


def to_pyvista(
    source: Model | Mesh,
    *,
    tags: str | Sequence[str] = (),
    whole: bool = False,
    tolerance: float | None = None,
    angle: float | None = None,
) -> Any:
    """The panels as ``pyvista.PolyData``, with the patch number of each panel in ``patch``.

    The names of the patches are in the field data ``patches``.

    Parameters
    ----------
    source
        A model, or the mesh of one.
    tags
        Tags of the patches to include; models only.
    whole, tolerance, angle
        Both halves of a symmetric model, and accuracy of the panels; models only, see
        :meth:`Model.mesh`.

    Returns
    -------
    pyvista.PolyData
        Points ``(n, 3)`` in the model's unit.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... Line a({0, 0, 0}, {2, 0, 0}); Line b({0, 1, 0}, {2, 1, 0});
    ... RuledSurf plate(a, b, divisions = {4, 2});
    ... ''')
    >>> to_pyvista(m).area
    2.0
    """
    mesh = _panels(source, tags, whole, tolerance, angle)
    data = polydata(mesh.vertices, mesh.faces)
    triangle, _, _ = _split(mesh)
    numbers = _patch_numbers(mesh)
    data.cell_data["patch"] = np.concatenate([numbers[triangle], numbers[~triangle]])
    data.field_data["patches"] = [patch.name for patch in mesh.patches]
    return data


def polydata(points: NDArray[np.float64], faces: NDArray[np.uint32]) -> Any:
    """Points, and faces between them if there are any, as ``pyvista.PolyData``.

    Parameters
    ----------
    points
        ``(n, 3)``.
    faces
        Four corners of each, a triangle repeats its last: ``(m, 4)``.
    """
    pyvista = _module("pyvista", "pyvista")
    if not len(faces):
        return pyvista.PolyData(points)
    corners = faces.astype(np.int64)
    triangle = corners[:, 2] == corners[:, 3]
    threes = np.insert(corners[triangle][:, :3], 0, 3, axis=1).ravel()
    fours = np.insert(corners[~triangle], 0, 4, axis=1).ravel()
    return pyvista.PolyData(points, np.concatenate([threes, fours]))


def to_trimesh(
    source: Model | Mesh,
    *,
    tags: str | Sequence[str] = (),
    whole: bool = False,
    tolerance: float | None = None,
    angle: float | None = None,
) -> Any:
    """The panels as ``trimesh.Trimesh``, quadrilaterals halved, with ``patch`` of each face.

    Vertices are neither merged nor moved: shared vertices are shared by identity.

    Parameters
    ----------
    source, tags, whole, tolerance, angle
        See :func:`to_pyvista`.

    Returns
    -------
    trimesh.Trimesh
        Vertices ``(n, 3)`` in the model's unit.
    """
    trimesh = _module("trimesh", "trimesh")
    mesh = _panels(source, tags, whole, tolerance, angle)
    triangle, triangles, quads = _split(mesh)
    numbers = _patch_numbers(mesh)
    halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    patch = np.concatenate([numbers[triangle], numbers[~triangle], numbers[~triangle]])
    return trimesh.Trimesh(
        mesh.vertices,
        np.concatenate([triangles, halves]),
        face_attributes={"patch": patch},
        metadata={"patches": [p.name for p in mesh.patches]},
        process=False,
    )


def to_meshio(
    source: Model | Mesh,
    *,
    tags: str | Sequence[str] = (),
    whole: bool = False,
    tolerance: float | None = None,
    angle: float | None = None,
) -> Any:
    """The panels as ``meshio.Mesh``: blocks ``triangle`` and ``quad``, patches as cell sets.

    Parameters
    ----------
    source, tags, whole, tolerance, angle
        See :func:`to_pyvista`.

    Returns
    -------
    meshio.Mesh
        Points ``(n, 3)`` in the model's unit.
    """
    meshio = _module("meshio", "meshio")
    mesh = _panels(source, tags, whole, tolerance, angle)
    triangle, triangles, quads = _split(mesh)
    numbers = _patch_numbers(mesh)
    cells, data = [], []
    for kind, faces, own in (
        ("triangle", triangles, numbers[triangle]),
        ("quad", quads, numbers[~triangle]),
    ):
        if len(faces):
            cells.append((kind, faces))
            data.append(own)
    sets: dict[str, list[Any]] = {}
    for k, patch in enumerate(mesh.patches):
        sets[patch.name] = [np.flatnonzero(block == k) for block in data]
    return meshio.Mesh(mesh.vertices, cells, cell_data={"patch": data}, cell_sets=sets)


def to_capytaine(
    model: Model,
    *,
    lids: bool = False,
    name: str = "model",
    tags: str | Sequence[str] = (),
    centre: Sequence[float] | None = None,
    mass: float | None = None,
    dofs: bool = True,
) -> Any:
    """A ``capytaine.FloatingBody`` of the panels below z = 0, in metres and kilograms.

    The mesh is the GDF for panel codes, cut at z = 0: normals point into the water, planes of
    symmetry are kept. Lengths are converted to metres, the unit of Capytaine's defaults of gravity
    and density.

    Parameters
    ----------
    model
        The model.
    lids
        Lids too, against irregular frequencies.
    name
        The body's name.
    tags
        Only patches with one of these tags.
    centre
        The centre of gravity, in the model's axes and unit; by default that of the model's weights.
    mass
        The mass in kilograms; by default that of the model's weights. Without either Capytaine
        takes the displaced mass.
    dofs
        The six degrees of freedom of a rigid body, with rotations about the centre of gravity, or
        about the origin if it is unknown.

    Returns
    -------
    capytaine.FloatingBody
        With the panels below the water as its mesh, and the model's planes of symmetry.

    Raises
    ------
    Error
        If no panel is below z = 0.
    """
    from moldloft import _core

    capytaine = _module("capytaine", "'moldloft[hydro]'")
    metres = _core.length_unit(model._document)[1] / 1000
    weights = model.weights()
    if len(weights.rows) and centre is None:
        centre = list(weights.centre)
    if len(weights.rows) and mass is None:
        kilograms = dict(model._document.units()).get(weights.units.of("mass"), 1.0)
        mass = weights.mass * kilograms
    with TemporaryDirectory() as folder:
        names = [tags] if isinstance(tags, str) else list(tags)

        def loaded(stem: str, **options: Any) -> Any:
            path = Path(folder) / f"{stem}.gdf"
            (data,) = model.encoded("gdf", path.name, **options).values()
            path.write_text(_scaled_gdf(data.decode(), metres))
            return capytaine.load_mesh(str(path), file_format="gdf")

        mesh = loaded("body", immersed=True, tags=names)
        lid = loaded("lid", lids=True, tags=names or ["lid"]) if lids else None
    place = None if centre is None else np.asarray(centre, dtype=np.float64) * metres
    body = capytaine.FloatingBody(
        mesh=mesh, lid_mesh=lid, center_of_mass=place, mass=mass, name=name
    )
    if dofs:
        body.add_all_rigid_body_dofs(rotation_center=np.zeros(3) if place is None else place)
    return body


def _scaled_gdf(text: str, factor: float) -> str:
    """A GDF with scaled vertices; the four lines before them are unchanged."""
    if factor == 1:
        return text
    lines = text.splitlines()
    rows = (" ".join(repr(float(x) * factor) for x in line.split()) for line in lines[4:])
    return "\n".join([*lines[:4], *rows]) + "\n"


def to_ocp(model: Model, *, accuracy: float | None = None) -> Any:
    """The exact surfaces as an OCCT shape (``OCP.TopoDS.TopoDS_Shape``), in the model's unit.

    CadQuery takes it by ``cadquery.Shape.cast(shape)``, build123d by ``Compound(shape)``.

    Parameters
    ----------
    model
        The model.
    accuracy
        The largest error of fits, by default 1e-6 of the model's diagonal.

    Returns
    -------
    OCP.TopoDS.TopoDS_Shape
        Shells and solids.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... Line a({0, 0, 0}, {2, 0, 0}); Line b({0, 1, 0}, {2, 1, 0}); RuledSurf plate(a, b);
    ... ''')
    >>> shape = to_ocp(m)  # doctest: +SKIP
    """
    from moldloft import _core
    from moldloft.cad import needed
    from moldloft.cad.occt import read_shape

    needed("OCP", "cadquery-ocp-novtk", "to_ocp")
    (data,) = model.encoded("step", "model.step", tolerance=accuracy).values()
    return read_shape(data, _core.length_unit(model._document)[1] / 1000)


def to_gmsh(model: Model, *, accuracy: float | None = None, name: str = "moldloft") -> list[Any]:
    """Add the exact surfaces to a new Gmsh model; returns the entities as (dimension, tag).

    Faces become physical groups by the names of their surfaces; those that Gmsh divides
    are in the group ``faces``. Gmsh is initialised if necessary.

    Parameters
    ----------
    model
        The model.
    accuracy
        The largest error of fits, by default 1e-6 of the model's diagonal.
    name
        The name of Gmsh's model.

    Returns
    -------
    list
        Pairs ``(dimension, tag)``.
    """
    from moldloft import _core
    from moldloft.cad.gmsh_names import names_of_faces

    gmsh = _module("gmsh", "gmsh")
    if not gmsh.isInitialized():
        with _kept_signals():
            gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add(name)
    metres = _core.length_unit(model._document)[1] / 1000
    unit = {1.0: "M", 0.01: "CM", 0.001: "MM", 0.3048: "FT", 0.0254: "INCH"}[metres]
    gmsh.option.setString("Geometry.OCCTargetUnit", unit)
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.step"
        model.write(path, format="step", tolerance=accuracy)
        entities: list[Any] = gmsh.model.occ.importShapes(str(path), highestDimOnly=False)
        text = path.read_text(encoding="utf-8")
    gmsh.model.occ.synchronize()
    known = names_of_faces(gmsh, text)
    groups: dict[str, list[int]] = {}
    for _, tag in gmsh.model.getEntities(2):
        groups.setdefault(known.get(tag, "faces"), []).append(tag)
    for label, tags in groups.items():
        gmsh.model.addPhysicalGroup(2, tags, name=label)
    return entities


@contextlib.contextmanager
def _kept_signals() -> Iterator[None]:
    """Keeps a broken pipe an exception, since Gmsh makes it end the process."""
    pipe = getattr(signal, "SIGPIPE", None)
    before = pipe and signal.getsignal(pipe)
    yield
    # Only the main thread may set handlers, and none can be set again that Python did not set.
    if pipe is not None and before is not None and current_thread() is main_thread():
        signal.signal(pipe, before)


def _columns(rows: Iterable[Any]) -> dict[str, list[Any]]:
    """Records as columns; only numbers and texts are kept."""
    columns: dict[str, list[Any]] = {}
    listed = list(rows)
    if not listed:
        raise Error("a table without rows has no columns")
    for field in fields(listed[0]):
        values = [getattr(row, field.name) for row in listed]
        if all(isinstance(v, (int, float, str, bool)) or v is None for v in values):
            columns[field.name] = values
    return columns


def to_pandas(source: Any) -> Any:
    """A ``pandas.DataFrame``: the parameters of a model, or the rows of a table.

    Parameters
    ----------
    source
        A model, a hydrostatic table or a righting curve: anything with ``rows`` of records.

    Returns
    -------
    pandas.DataFrame
        A row for each parameter, draft or heel.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads("param float beam = 5 in [3, 7];")
    >>> to_pandas(m).loc["beam", "value"]  # doctest: +SKIP
    5.0
    """
    pandas = _module("pandas", "pandas")
    params: Mapping[str, Any] | None = getattr(source, "params", None)
    if params is not None:
        rows = list(params.values())
        if not rows:
            return pandas.DataFrame(columns=["value", "default", "low", "high", "whole"])
        return pandas.DataFrame(_columns(rows)).set_index("name")
    return pandas.DataFrame(_columns(source.rows))


def frame(columns: Mapping[str, Any]) -> Any:
    """Columns as a ``pandas.DataFrame``.

    Parameters
    ----------
    columns
        Arrays of one length by name.
    """
    return _module("pandas", "pandas").DataFrame(dict(columns))


def to_xarray(source: Any, *, along: str | None = None) -> Any:
    """An ``xarray.Dataset`` of the rows of a table, by its draft or heel.

    Parameters
    ----------
    source
        A hydrostatic table or a righting curve: anything with ``rows`` of records.
    along
        The column that is the coordinate; by default ``heel`` where it changes, else ``draft``.

    Returns
    -------
    xarray.Dataset
        A variable for each figure, its unit as the attribute ``units``.
    """
    xarray = _module("xarray", "xarray")
    columns = {
        name: np.array([np.nan if v is None else v for v in values])
        for name, values in _columns(source.rows).items()
    }
    if along is None:
        heel = columns.get("heel")
        along = "heel" if heel is not None and np.ptp(heel) > 0 else "draft"
    if along not in columns:
        raise Error(f"there is no column `{along}`; expected one of: {', '.join(columns)}")
    data = {name: (along, values) for name, values in columns.items() if name != along}
    return xarray.Dataset(data, coords={along: columns[along]})

"""Files, pictures and other forms of a model."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from moldloft.arguments import explain
from moldloft.errors import FileError, FormatError, ModelError, UnknownNameError

if TYPE_CHECKING:
    from moldloft import _core
    from moldloft.models import Model

__all__ = ["Writable"]

_OF_FORMATS = {"cannot-write", "unused-option"}
"""Ids of diagnostics about content that a format cannot represent."""


class Writable:
    """The methods of a model that write files, pictures and other forms."""

    if TYPE_CHECKING:
        # The class of models has it.
        @property
        def _document(self) -> _core.Document: ...

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        format: str | None = None,
        lids: bool = False,
        immersed: bool = False,
        tags: str | Sequence[str] = (),
        tolerance: float | None = None,
        angle: float | None = None,
        whole: bool = False,
        triangles: bool = False,
    ) -> list[Path]:
        """Write the panels to a file atomically.

        Parameters
        ----------
        path
            The file, in a folder that exists.
        format
            One of :data:`moldloft.exchange.files.FORMATS`, such as ``gdf``, ``nemoh``, ``stl``,
            ``glb``, ``vts``, ``svg`` or ``sdl``; by default what the file's name ends in.
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
            B-splines are exact. For files of panels: the largest distance of panels from their
            surfaces, by as many divisions as it takes; by default those of the model.
        angle
            For files of panels: the largest turn of a surface along a panel, in radians; 0.5 where
            only ``tolerance`` is given.
        whole
            Both sides of a symmetric model, joined in its planes, in files of plain panels; by
            default these contain one side. Files of panel codes state the planes of symmetry
            instead.
        triangles
            Triangles only, in files of plain panels.

        Returns
        -------
        list of pathlib.Path
            The files written; some formats take several.

        Raises
        ------
        FileError
            If there is no such folder, or it cannot be written to.
        FormatError
            If the format is unknown, cannot represent the model, or the model has nothing to write.
        ModelError
            If the model has errors, or no patch has such a tag.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> import tempfile, pathlib
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     [path.name for path in m.write(pathlib.Path(folder) / "plate.stl")]
        ['plate.stl']
        """
        from moldloft.exchange.files import commit, ending, produce

        path = Path(path)
        if not path.parent.is_dir():
            raise FileError(f"cannot write `{path}`: there is no folder `{path.parent}`")
        wanted = format or ending(path)
        names = [tags] if isinstance(tags, str) else list(tags)
        files = produce(
            cast("Model", self),
            wanted,
            path,
            lids=lids,
            immersed=immersed,
            tolerance=tolerance,
            angle=angle,
            tags=names,
            whole=whole,
            triangles=triangles,
        )
        return commit(path.parent, files, make=False)

    def encoded(
        self,
        format: str,
        name: str,
        *,
        lids: bool = False,
        immersed: bool = False,
        tags: Sequence[str] = (),
        tolerance: float | None = None,
        angle: float | None = None,
        whole: bool = False,
        triangles: bool = False,
    ) -> dict[str, bytes]:
        """The files of a format by name, without writing them; the first is called ``name``.

        For the formats of the Rust table; :func:`moldloft.exchange.files.produce` takes all.
        Arguments as for :meth:`write`.

        Parameters
        ----------
        format
            The name of a format, see :data:`moldloft.exchange.files.FORMATS`.
        name
            The name of the main file.
        lids
            Include lids.
        immersed
            Cut at z = 0 and keep what is below, for panel codes.
        tags
            Only patches with one of these tags; by default all.
        tolerance
            The largest error of fitted surfaces, or distance of panels from their surfaces.
        angle
            The largest turn along a panel, in radians.
        whole
            Both sides of a symmetric model, in files of plain panels.
        triangles
            Triangles only, in files of plain panels.

        Returns
        -------
        dict
            The bytes of each file by its name.

        Raises
        ------
        FormatError
            If the format is unknown, cannot represent the model, or the model has nothing to write.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> sorted(m.encoded("off", "plate.off"))
        ['plate.off']
        """
        try:
            files = self._document.write(
                format, name, lids, immersed, list(tags), tolerance, angle, whole, triangles
            )
        except ModelError as error:
            # The fault is in the format or its options, not in the model.
            if not {d.id for d in error.diagnostics} <= _OF_FORMATS:
                raise
            raise FormatError(str(error), format, diagnostics=error.diagnostics) from None
        self._warn_of_export()
        return dict(files)

    @property
    def export_remarks(self) -> list[_core.Diagnostic]:
        """Content of the model that the last text or file omits or approximates.

        Notes, such as the error of fitted surfaces, are not Python warnings.
        """
        return self._document.export_remarks()

    def _warn_of_export(self) -> None:
        for remark in self.export_remarks:
            if remark.severity == "note":
                continue
            warnings.warn(str(remark), stacklevel=4)

    def picture(
        self, width: int = 1280, height: int = 720, *, only: str | Sequence[str] = ()
    ) -> bytes:
        """A picture of the panels, contours and wires, as PNG.

        Without any of these, the arrays of points among the variables of a program are drawn.

        Parameters
        ----------
        width, height
            Size in pixels.
        only
            Names of the objects, patches, contours and arrays that are drawn, with their parts; by
            default all.

        Returns
        -------
        bytes
            The PNG file.

        Raises
        ------
        ModelError
            If a side is not 1 to 8192, a name is unknown, or there is nothing to draw.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.picture(64, 48)[1:4]
        b'PNG'
        >>> m.picture(64, 48, only="plate") == m.picture(64, 48)
        True
        """
        wanted = [only] if isinstance(only, str) else list(only)
        return bytes(self._document.picture(width, height, wanted))

    def kind_picture(self, kind: str, width: int = 360, height: int = 240) -> bytes:
        """A picture, as PNG, that emphasises the objects of one kind.

        Parameters
        ----------
        kind
            The name of a kind.
        width
            Width of the picture, pixels.
        height
            Height of the picture, pixels.

        Returns
        -------
        bytes
            The PNG file.

        Raises
        ------
        UnknownNameError
            If there is no such kind.
        ModelError
            If a side is not 1 to 8192.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m.kind_picture("RuledSurf", 64, 48)[1:4]
        b'PNG'
        """
        from moldloft.language import reference
        from moldloft.spelling import nearest

        known = [row["name"] for row in reference() if row["is_kind"]]
        if kind not in known:
            near = nearest(kind, known)
            hint = f"; did you mean `{near}`?" if near else ""
            raise UnknownNameError(f"unknown kind `{kind}`{hint}")
        return bytes(self._document.portrait(kind, width, height))

    def convert(self, to: str) -> str:
        """The model's text in another form: ``"sdl"`` or ``"ms2"``.

        A program is converted to a model file of its objects. Parameters become ``Variable``,
        variables with a single assignment ``Formula``, expressions of the main program in arguments
        ``[...]``; results of routines and loops become numbers. Arguments without a column are
        attributes ``A:Moldloft(name value)``. The text is read back; an error reports any object
        that differs.

        Parameters
        ----------
        to
            ``"sdl"`` or ``"ms2"``.

        Returns
        -------
        str
            The text.

        Raises
        ------
        Error
            If ``to`` is another word, or an object would come back as another.

        Warns
        -----
        UserWarning
            Objects whose numbers become independent of the parameters.
        """
        text = self._document.convert(to)
        self._warn_of_export()
        return text


# Messages and help name the class that users know.
for _name, _method in list(vars(Writable).items()):
    if callable(_method):
        _method.__qualname__ = f"Model.{_name}"

explain(globals())

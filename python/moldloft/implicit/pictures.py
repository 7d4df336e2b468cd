"""Ray-traced pictures of sets."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from moldloft._core import Set as Core
from moldloft.arguments import explain
from moldloft.implicit.answers import Lamp, Sun
from moldloft.implicit.moving import corners_of, triple

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Pictured"]

BACKGROUND = ((0xFC, 0xFD, 0xFE), (0xE2, 0xE8, 0xEE))


def _colour(of: Sequence[int]) -> list[int]:
    colour = [int(c) for c in of]
    if len(colour) != 3 or not all(0 <= c <= 255 for c in colour):
        raise ValueError(f"a colour is red, green and blue from 0 to 255, found {list(of)}")
    return colour


class Pictured:
    """Pictures of sets."""

    _core: Core

    def picture(
        self,
        path: str | os.PathLike[str] | None = None,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        size: tuple[int, int] = (800, 600),
        eye: Triple | None = None,
        centre: Triple | None = None,
        up: Triple = (0, 0, 1),
        angle: float = 0.6,
        lights: Sequence[Sun | Lamp] | None = None,
        ambient: float = 0.22,
        shadows: bool = True,
        shine: float = 0.15,
        background: tuple[Sequence[int], Sequence[int]] = BACKGROUND,
        mirrors: float | Mapping[str, float] = 0.0,
        samples: int = 1,
    ) -> bytes:
        """A ray-traced picture, a PNG file: exact surfaces with lights, shadows and colours.

        Parameters
        ----------
        path
            File to write in addition.
        low, high
            The box that is shown.
        size
            Picture points across and down.
        eye, centre, up
            Eye and target of the view; default: from the front, right and above.
        angle
            Angle of view from top to bottom, in radians.
        lights
            :class:`Sun` and :class:`Lamp`; by default a sun over the left shoulder and a weak one
            from the right.
        ambient
            Light from everywhere.
        shadows
            True to cast shadows.
        shine
            Strength of highlights, 0 to 1.
        background
            Red, green and blue, 0 to 255 each, at the top and at the bottom of the picture. Mirrors
            that look past everything show it by height.
        mirrors
            Reflectivity of faces, 0 to 1: one number for all, or numbers by the names of
            primitives.
        samples
            Rays along each side of a picture point.

        Returns
        -------
        bytes
            The PNG file.

        Raises
        ------
        Error
            If the set has no end and no box is given.
        ValueError
            If a number is beyond its range, or a name in ``mirrors`` is not one of a primitive.
        FileError
            If ``path`` cannot be written.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.picture(size=(32, 24))[1:4]
        b'PNG'
        """
        if not 0 < angle < math.pi:
            raise ValueError(f"the angle of view must be between 0 and pi radians, found {angle}")
        if min(size) < 1:
            raise ValueError(f"a picture is 1 to 8192 points wide and high, found {size}")
        if samples < 1:
            raise ValueError(f"a picture point takes at least one sample, found {samples}")
        shares = self._mirrors(mirrors)
        sky = [_colour(c) for c in background]
        if len(sky) != 2:
            raise ValueError(f"a background has two colours, top and bottom; found {len(sky)}")
        corners = corners_of(low, high) or self._core.around()
        box = np.array(corners)
        target = np.array(triple(centre, "centre")) if centre is not None else box.mean(axis=0)
        if eye is not None:
            place = np.array(triple(eye, "eye"))
        else:
            away = np.array([-0.62, -0.68, 0.42])
            away /= np.linalg.norm(away)
            place = target + away * _reach(box, target, away, triple(up, "up"), angle, size)
        if lights is None:
            ahead = (target - place) / np.linalg.norm(target - place)
            right = np.cross(ahead, np.array(triple(up, "up")))
            lights = [
                Sun(tuple(ahead + 0.5 * right - 0.9 * np.array(up)), (0.75, 0.74, 0.7)),
                Sun(tuple(ahead - 1.2 * right - 0.2 * np.array(up)), (0.16, 0.18, 0.22)),
            ]
        rows: list[tuple[list[float] | None, list[float], list[float]]] = []
        for light in lights:
            colour = triple(light.colour, "colour")
            if isinstance(light, Sun):
                rows.append((triple(light.direction, "direction"), [0.0, 0.0, 0.0], colour))
            else:
                rows.append((None, triple(light.place, "place"), colour))
        png = self._core.picture(
            corners,
            [int(size[0]), int(size[1])],
            (list(place), list(target), triple(up, "up"), float(angle)),
            rows,
            [float(ambient)] * 3,
            sky,
            (shadows, [float(shine), 40.0], int(samples)),
            shares,
        )
        if path is not None:
            from moldloft.exchange.files import Output, commit

            target_path = Path(path)
            commit(target_path.parent, [Output(target_path.name, png)], make=False)
        return png

    def _mirrors(self, mirrors: float | Mapping[str, float]) -> list[float]:
        names = [str(facts["name"] or facts["kind"]) for _, facts in self._core.leaves()]
        if isinstance(mirrors, Mapping):
            unknown = [name for name in mirrors if name not in names]
            if unknown:
                raise ValueError(f"unknown primitive {unknown[0]!r}; expected one of: {names}")
            shares = [float(mirrors.get(name, 0.0)) for name in names]
        else:
            shares = [float(mirrors)] * len(names)
        wrong = [share for share in shares if not 0 <= share <= 1]
        if wrong:
            raise ValueError(f"reflectance: expected 0 to 1, found {wrong[0]}")
        return shares


def _reach(
    box: Floats,
    target: Floats,
    away: Floats,
    up: Sequence[float],
    angle: float,
    size: tuple[int, int],
) -> float:
    """Distance from which all of a box is visible, with a small margin."""
    right = np.cross(np.array(up), away)
    if not np.linalg.norm(right) > 0:
        right = np.array([1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    corners = np.array(list(itertools.product(*box.T))) - target
    across, along = np.abs(corners @ right), corners @ away
    upward = np.abs(corners @ np.cross(away, right))
    slope = 0.92 * math.tan(angle / 2)
    wide = slope * size[0] / size[1]
    return float(max((upward / slope + along).max(), (across / wide + along).max()))


explain(globals())

"""Numbers that a program must print."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass
class Near:
    """Numbers that are met to a share of their size, at least of 1."""

    values: list[float]
    share: float


Wanted = Iterable[Any] | Near


def approx(values: Any, share: float) -> Near:
    """Numbers of any nesting, met to that share."""
    return Near([float(x) for x in np.ravel(values)], share)

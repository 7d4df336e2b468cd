"""Edges of the faces of a mesh, and how many faces use each."""

from __future__ import annotations

import numpy as np


def edge_uses(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The edges as pairs of vertices, of shape (n, 2), and the number of faces at each."""
    corners = np.asarray(faces, dtype=np.int64)
    edges = np.stack((corners, np.roll(corners, -1, axis=1)), axis=-1).reshape(-1, 2)
    edges = np.sort(edges[edges[:, 0] != edges[:, 1]], axis=1)
    found, uses = np.unique(edges, axis=0, return_counts=True)
    return found, uses

"""Meshes out of Draco's streams, by DracoPy: the only module that knows it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import MissingExtraError

EXTENSION = "KHR_draco_mesh_compression"


def decode(stream: bytes, path: Path) -> tuple[NDArray[Any], Mapping[int, NDArray[Any]]]:
    """Corners (3 T,) and attributes (N, columns) by their numbers. Raises ValueError for a damaged
    stream, MissingExtraError (which names ``path``) without DracoPy."""
    try:
        import DracoPy
    except ImportError as error:
        raise MissingExtraError(f"{path}: compressed with Draco, it", "draco") from error
    try:
        mesh = DracoPy.decode(stream)
    except Exception as error:  # its own kinds, which no list names
        raise ValueError(f"Draco cannot read it: {error}") from error
    if not hasattr(mesh, "faces"):
        raise ValueError("it holds points, no triangles")
    attributes = {found["unique_id"]: np.asarray(found["data"]) for found in mesh.attributes}
    return np.asarray(mesh.faces).reshape(-1), attributes

"""What commands that take scans share: how a file is meant, and whose eyes find its points."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mien.errors import MienError, MissingExtraError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from mien.face.mesh import Mesh
    from mien.scan.parameterise import ScanPoints
    from mien.scan.points import Detect, Reference

AXES = ("+x", "-x", "+y", "-y", "+z", "-z")
POINTS_ENDING = ".points.toml"


def add_scan_options(parser: argparse.ArgumentParser) -> None:
    """How a scan's file is meant."""
    parser.add_argument(
        "--units",
        metavar="NAME|MM",
        help="of the scan's numbers: mm, cm, m, in, or how many millimetres (default: as the file "
        "says; where it says nothing, this must)",
    )
    parser.add_argument(
        "--up", choices=AXES, default="+y", help="where the head's top is (default: %(default)s)"
    )
    parser.add_argument(
        "--front", choices=AXES, default="+z", help="where the face looks (default: %(default)s)"
    )


def read_upright(path: Path, options: argparse.Namespace) -> tuple[Mesh, float]:
    """The scan in millimetres, upright and to the front, and the millimetres in its unit."""
    from mien.formats.meshes.scans import read_scan, stand

    mesh, unit = read_scan(path, options.units)
    turn = stand(options.up, options.front)
    return replace(mesh, vertices=mesh.vertices @ turn.T), unit


def read_scan_points(path: Path, options: argparse.Namespace, unit: float) -> ScanPoints:
    """The points in a file, where ``read_upright`` has the scan."""
    from mien.formats.meshes.scans import stand
    from mien.formats.notes.scan_points import read_points
    from mien.scan.parameterise import ScanPoints

    told = read_points(path)
    places = unit * told.places @ stand(options.up, options.front).T
    return ScanPoints(told.ids, places, told.found)


def points_like(path: Path, options: argparse.Namespace) -> Reference:
    """The scan a file of points belongs to, and the points."""
    from mien.formats.notes.scan_points import read_points
    from mien.scan.points import Reference

    mesh, unit = read_upright(path.with_name(Path(read_points(path).scan).name), options)
    return Reference(mesh, read_scan_points(path, options, unit))


def detect_once() -> Detect:
    """The landmark networks as a function of one picture."""
    from mien.capture.detector import Detector

    def landmarks(picture: NDArray[np.uint8]) -> NDArray[np.float32] | None:
        # The networks were made for film: they look twice before they trust their eyes.
        with Detector() as detector:
            for _ in range(_LOOKS):
                found = detector.landmarks(picture)
        return found

    return landmarks


_LOOKS = 3


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the scan's name before what is wrong with it."""
    try:
        yield
    except MissingExtraError:  # no scan's fault
        raise
    except MienError as error:
        if str(path) in str(error):
            raise
        raise type(error)(f"{path}: {error}") from error

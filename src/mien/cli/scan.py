"""Find the feature points of a raw scan, for a databank."""

from __future__ import annotations

import argparse
from pathlib import Path

from mien.cli.command import tell
from mien.cli.progress import progress
from mien.cli.scanning import (
    POINTS_ENDING,
    add_scan_options,
    detect_once,
    naming,
    points_like,
    read_upright,
)
from mien.errors import InputError


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "action", choices=("points",), help="points: find MPEG-4 feature points, to be corrected"
    )
    parser.add_argument("scan", type=Path, metavar="SCAN", help="a .ply or .obj")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE.toml",
        help="where the points go (default: SCAN.points.toml beside the scan); a picture to check "
        "them by goes beside it",
    )
    parser.add_argument(
        "--like",
        type=Path,
        metavar="FILE.toml",
        help="corrected points of another scan, of the same person at best: these become like them",
    )
    add_scan_options(parser)


def run(options: argparse.Namespace) -> None:
    from mien.formats.meshes.scans import stand
    from mien.formats.notes.scan_points import PointsFile, write_points
    from mien.formats.pictures.images import write_image
    from mien.scan.picture import points_picture
    from mien.scan.points import PointFinder

    output = options.output or options.scan.with_name(options.scan.stem + POINTS_ENDING)
    if output.suffix.lower() != ".toml":
        raise InputError(f"-o {output}: points go into a .toml")
    mesh, unit = read_upright(options.scan, options)
    with progress(f"{options.scan.name}: points") as show, naming(options.scan):
        finder = PointFinder(detect_once(), options.like and points_like(options.like, options))
        show(1, 2)
        points = finder.find(mesh, unit)
        show(2, 2)
    places = points.places @ stand(options.up, options.front) / unit
    picture = output.with_suffix(".png")
    write_points(output, PointsFile(options.scan.name, True, points.ids, places))
    write_image(picture, points_picture(mesh, points.ids, points.places))
    missing = [name for name in finder.ids if name not in points.ids]
    unseen = f"; not seen: {', '.join(missing)}" if missing else ""
    tell(
        options,
        {"points": len(points.ids), "missing": missing, "files": [str(output), str(picture)]},
        f"{len(points.ids)} points{unseen}",
        str(output),
        str(picture),
    )

"""Build a databank of expressions from scans of one person."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mien.cli.command import remark, tell
from mien.cli.progress import progress
from mien.cli.scanning import (
    POINTS_ENDING,
    add_scan_options,
    detect_once,
    naming,
    points_like,
    read_scan_points,
    read_upright,
)
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.face.databank import Databank
    from mien.face.mesh import Mesh
    from mien.scan.parameterise import ScanPoints


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=("build",), help="build: scans become a databank")
    parser.add_argument(
        "scans",
        type=Path,
        nargs="*",
        metavar="SCAN",
        help="one person's scans, .ply or .obj, each named by its expression; points are read from "
        f"SCAN{POINTS_ENDING} beside it, and found where there are none",
    )
    parser.add_argument(
        "--neutral",
        type=Path,
        metavar="SCAN",
        help="the face at rest (default: the one called neutral)",
    )
    parser.add_argument(
        "--from-folder",
        type=Path,
        metavar="FOLDER",
        help="OBJ files that already share their vertices, among them neutral.obj, not scans",
    )
    parser.add_argument(
        "--like",
        type=Path,
        metavar="FILE.toml",
        help="corrected points that found ones become like",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("bank.npz"),
        metavar="FILE.npz",
        help="where the databank goes (default: %(default)s)",
    )
    add_scan_options(parser)


def run(options: argparse.Namespace) -> None:
    from mien.formats.databank_file import write_databank

    output = options.output
    if output.suffix != ".npz":
        output = output.with_name(output.name + ".npz")
    if bool(options.scans) == bool(options.from_folder):
        raise InputError("name either scans or --from-folder")
    bank = _from_folder(options) if options.from_folder else _from_scans(options, output.stem)
    write_databank(output, bank)
    tell(
        options,
        {"file": str(output), "faces": bank.names, "vertices": len(bank.face.vertices)},
        f"{len(bank.names)} faces of {len(bank.face.vertices)} vertices: {', '.join(bank.names)}",
        str(output),
    )


def _from_scans(options: argparse.Namespace, name: str) -> Databank:
    from mien.face.library import generic_face
    from mien.scan.bank import build_bank

    neutral, faces = _neutral_first(options.scans, options.neutral)
    load = _loader(options)
    with progress("scans") as show:
        return build_bank(
            generic_face(),
            name,
            partial(load, neutral),
            {path.stem: partial(load, path) for path in faces},
            show,
        )


def _neutral_first(scans: list[Path], named: Path | None) -> tuple[Path, list[Path]]:
    if named is None:
        likely = [path for path in scans if "neutral" in path.stem.lower()]
        if len(likely) != 1:
            raise InputError(
                f"{len(likely)} of the scans are called neutral; say which one is with --neutral"
            )
        named = likely[0]
    faces = [path for path in scans if path != named]
    twice = {path.stem for path in faces if [other.stem for other in faces].count(path.stem) > 1}
    if twice:
        raise InputError(f"two scans are called {sorted(twice)[0]}; a face needs a name of its own")
    return named, faces


def _loader(options: argparse.Namespace) -> Callable[[Path], tuple[Mesh, ScanPoints]]:
    """Reads a scan and its points, and finds those nobody has written down."""
    from mien.scan.points import PointFinder

    finders: list[PointFinder] = []

    def load(path: Path) -> tuple[Mesh, ScanPoints]:
        mesh, unit = read_upright(path, options)
        beside = path.with_name(path.stem + POINTS_ENDING)
        with naming(path):
            if beside.exists():
                return mesh, read_scan_points(beside, options, unit)
            if not finders:
                like = options.like and points_like(options.like, options)
                finders.append(PointFinder(detect_once(), like))
            remark(options, f"{path}: no {beside.name}; the points are found")
            return mesh, finders[0].find(mesh, unit)

    return load


def _from_folder(options: argparse.Namespace) -> Databank:
    from mien.recipe import load_databank

    return load_databank(options.from_folder)

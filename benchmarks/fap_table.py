"""What is lost when FAPs go through a file, and through ARKit's 52 shapes and back.

    python benchmarks/fap_table.py [--fap take.fap ...] [--json]

The visemes and expressions at half and full strength, and any takes given. FAPs that the way
through ARKit cannot know (tongue, ears, pupils) are left out. Units are the FAPs' own (1/1024 of a
length); mm are of feature points on the generic face, root mean square; "nothing" is the error of
answering with a face at rest.

    file    values to .fap and back, whole numbers as they come from files
    rounded the same with fractions, which files do not carry
    ARKit   values, motion of feature points, weights of the 52 shapes, motion, values
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import mien
from mien.capture.fap import motion_from_faps
from mien.capture.shapes import motion_from_shapes
from mien.face.fap_targets import basis_of
from mien.face.library import generic_face
from mien.formats.takes.fap import read_take, simple_take, write_take
from mien.mapping.arkit import arkit_weights
from mien.mapping.fap import fap_values
from mien.performance.acted import acted
from mien.performance.performance import Performance
from mien.vocabulary.fap import expressions, simple, visemes
from report import show

Array = NDArray[np.float64]

GROUPS = {2: "jaw, inner lips", 3: "lids", 4: "brows", 5: "cheeks", 8: "outer lips", 9: "nose"}
EYES = range(23, 31)


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fap", type=Path, nargs="*", default=[])
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    posed = np.stack([*visemes().values(), *expressions().values()])
    values = np.concatenate(
        [0.5 * posed, posed, *(mien.load_performance(path).shapes for path in options.fap)]
    )
    back = through_arkit(values)
    figures: dict[str, float] = {
        "file_units": float(np.abs(through_file(np.rint(values)) - np.rint(values)).max()),
        "rounded_units": float(np.abs(through_file(values) - values).max()),
    }
    table = Table(title="FAP to ARKit-52 and back")
    for heading in ("group", "nothing: units", "ARKit: units", "nothing: mm", "ARKit: mm"):
        table.add_column(heading)
    for group, name in GROUPS.items():
        columns = columns_of(group)
        row = errors(values, back, columns)
        table.add_row(name, *(f"{error:.3g}" for error in row))
    Console().print(table)
    known = np.concatenate([columns_of(group) for group in GROUPS])
    row = errors(values, back, known)
    names = ("nothing_units", "arkit_units", "nothing_mm", "arkit_mm")
    figures |= dict(zip(names, row, strict=True))
    figures["arkit_ratio"] = row[3] / row[2]
    show("fap_table", "Round trips of FAPs", figures, options.json)


def columns_of(group: int) -> NDArray[np.intp]:
    """Columns of the FAPs of a group that skin shows."""
    return np.array(
        [i for i, fap in enumerate(simple()) if fap.group == group and fap.number not in EYES]
    )


def errors(values: Array, back: Array, columns: NDArray[np.intp]) -> list[float]:
    """Mean absolute units and root mean square mm, of nothing and of the round trip."""
    generic = generic_face()
    fields = generic.face.points.at(basis_of(generic).fields)[columns]
    moved = np.flatnonzero(np.linalg.norm(fields, axis=-1).max(axis=0) > 1e-6)
    found: dict[str, list[float]] = {"units": [], "mm": []}
    for error in (values[:, columns], (back - values)[:, columns]):
        found["units"].append(float(np.abs(error).mean()))
        motion = np.tensordot(error, fields[:, moved], axes=1)
        found["mm"].append(float(np.sqrt((motion**2).sum(axis=-1).mean())))
    return [*found["units"], *found["mm"]]


def through_arkit(values: Array) -> Array:
    """Values (F, 66) after the way to ARKit's weights and back."""
    generic = generic_face()
    take = spoken("fap", values)
    weights = arkit_weights(motion_from_faps(take, generic), generic)
    return fap_values(motion_from_shapes(spoken("arkit", weights), generic))


def through_file(values: Array) -> Array:
    """Values (F, 66) after the way into a .fap file and back."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "take.fap"
        write_take(path, simple_take(np.arange(len(values)) / 25.0, values))
        return read_take(path).values[:, 2:]


def spoken(vocabulary: str, weights: Array) -> Performance:
    """A performance that came as weights."""
    still = acted((), np.zeros((0, 3)), np.zeros((len(weights), 0, 3)), sigma=np.zeros(0))
    return replace(still, vocabulary=vocabulary, shapes=weights)


if __name__ == "__main__":
    main()

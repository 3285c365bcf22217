"""How near the surface reconstructed from optical markers comes to the true one.

    python benchmarks/marker_accuracy.py --take C3D --truth NPZ [--faces FOLDER] [--json]

The take is read, its head motion removed, labels mended and neutral found as ``mien animate`` does.
The databank is the generic person's 25 faces (or all 55 shapes), the surface lands on the
performer's own true neutral. Errors are in mm, the mean over the vertices of the narrow face and
the frames whose surface is known, of the motion from neutral. "Smoothed" is in time.

Beside a take called NAME_clean.c3d the dirty NAME.c3d is looked for: head motion left in its
markers, its error over the clean one's, and which swaps, jumps, ghosts and gaps were found.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from ict_bank import read_bank
from mien.capture.markers.head import find_head_motion
from mien.capture.markers.labels import name_roles
from mien.capture.markers.mend import Event
from mien.face.databank import Databank
from mien.face.face import Face
from mien.formats.markers.c3d import read_c3d
from mien.mapping.genetic import published
from mien.mapping.reconstruct import Reconstruction, reconstruct
from mien.mapping.residual import believe, spread
from mien.numeric.procrustes import align
from mien.numeric.steady import steady
from mien.performance.performance import Performance
from mien.recipe import capture_markers
from mien.sculpt.cloning import clone
from report import show

Array = NDArray[np.float64]

SEEDS = 10
"""Runs of the genetic algorithm whose mean is told."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--take", type=Path, required=True)
    parser.add_argument("--truth", type=Path, required=True)
    parser.add_argument("--faces", type=Path, help="folder of the ICT faces (default: ../ict)")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    truth = Truth.read(options.truth)
    faces = options.faces or options.take.resolve().parent.parent / "ict"
    bank, shapes = read_bank(faces), read_bank(faces, shapes=True)
    performance, mended = capture_markers(options.take)
    table = Table(title="Error of the surface, mm", caption=f"neutral {mended.rest} s")
    for column in ("method", "raw", "smoothed"):
        table.add_column(column)
    rows = dict(errors(performance, bank, shapes, truth))
    for name, (raw, smoothed) in rows.items():
        table.add_row(name, f"{raw:.3f}", f"{smoothed:.3f}")
    Console().print(table)
    figures = {
        "nothing_mm": rows["nothing"][0],
        "rbf_mm": rows["RBF of the markers"][0],
        "ga_mm": rows["published"][0],
        "ga_repaired_residual_mm": rows["genetic, repaired + residual"][1],
        "bounded_residual_mm": rows["bounded + residual"][1],
        "cloned_local_mm": rows["bounded + residual, cloned with local size"][1],
        "shapes55_mm": rows["55 shapes, bounded + residual"][1],
        "heldout_mm": held_out(performance, bank, truth),
    }
    dirty = options.take.with_name(options.take.name.replace("_clean", ""))
    if dirty != options.take and dirty.exists():
        figures |= judge_dirty(dirty, bank, truth, figures["bounded_residual_mm"])
    show("marker_accuracy", options.take.name, figures, options.json)


@dataclass(frozen=True)
class Truth:
    """What really happened."""

    neutral: Array
    """(V, 3) mm, the performer's."""
    motion: Array
    """(N, V, 3)"""
    frames: NDArray[np.int32]
    """(N,) frames in which the surface is known."""
    markers: Array
    """(F, M, 3) without noise or head motion."""
    labels: tuple[str, ...]
    missing: NDArray[np.bool_]
    events: list[dict[str, object]]
    fdp: tuple[str, ...]

    @classmethod
    def read(cls, path: Path) -> Truth:
        """From the file beside the takes."""
        with np.load(path) as data:
            return cls(
                neutral=data["surface_neutral_mm"].astype(float),
                motion=data["surface_delta_mm"].astype(float),
                frames=data["surface_frames"],
                markers=data["marker_head_mm"].astype(float),
                labels=tuple(str(label).rpartition(":")[2] for label in data["labels"]),
                missing=data["missing"],
                events=json.loads(str(data["events"])),
                fdp=tuple(str(fdp) for fdp in data["fdp"]),
            )

    def error(self, surface: Reconstruction) -> float:
        """mm."""
        shown = np.stack([surface.motion(int(frame)) for frame in self.frames])
        return float(np.linalg.norm(shown - self.motion, axis=-1).mean())


def errors(
    performance: Performance, bank: Databank, shapes: Databank, truth: Truth
) -> Iterator[tuple[str, tuple[float, float]]]:
    """Methods and their errors, raw and smoothed."""
    face = replace(bank.face, vertices=truth.neutral)

    def both(bank: Databank, solver: str, residual: bool) -> tuple[float, float]:
        raw, smoothed = (
            truth.error(
                reconstruct(
                    performance, bank, face=face, solver=solver, smooth=smooth, residual=residual
                )
            )
            for smooth in (False, True)
        )
        return raw, smoothed

    nothing = float(np.linalg.norm(truth.motion, axis=-1).mean())
    yield "nothing", (nothing, nothing)
    yield "RBF of the markers", tuple(rbf(performance, face, truth, s) for s in (False, True))
    yield "published", genetic_errors(performance, bank, face, truth)
    yield "published + residual", both(bank, "published", True)
    yield "genetic, repaired", both(bank, "genetic", False)
    yield "genetic, repaired + residual", both(bank, "genetic", True)
    yield "bounded", both(bank, "bounded", False)
    yield "bounded + residual", both(bank, "bounded", True)
    # The same by expression cloning: with scale 1, which is true of these people, it changes
    # nothing; with local turn and size the databank's faces themselves are cloned.
    local = replace(bank, face=face, displacements=clone(bank.face, bank.displacements, face))
    yield "bounded, cloned with local size", both(local, "bounded", False)
    yield "bounded + residual, cloned with local size", both(local, "bounded", True)
    yield "55 shapes, bounded", both(shapes, "bounded", False)
    yield "55 shapes, bounded + residual", both(shapes, "bounded", True)


def rbf(performance: Performance, face: Face, truth: Truth, smooth: bool) -> float:
    """Error of the markers' motion alone, met in full."""
    worn = face.points.at(face.vertices)[face.points.index(performance.points)]
    motion = performance.motion @ align(performance.neutral, worn).rotation.T
    if smooth:
        motion, _ = steady(motion, 1.0 / float(np.diff(performance.time).mean()))
    moved = believe(motion[truth.frames], worn, np.zeros(len(worn)))
    shown = np.einsum("vp,fpx->fvx", spread(face.vertices, worn), moved)
    return float(np.linalg.norm(shown - truth.motion, axis=-1).mean())


def genetic_errors(
    performance: Performance, bank: Databank, face: Face, truth: Truth
) -> tuple[float, float]:
    """Mean error over seeds of the genetic algorithm, raw and smoothed."""
    raw, smoothed = (
        float(
            np.mean(
                [
                    truth.error(
                        reconstruct(
                            performance,
                            bank,
                            face=face,
                            solver=partial(published, seed=seed),
                            smooth=smooth,
                            residual=False,
                        )
                    )
                    for seed in range(SEEDS)
                ]
            )
        )
        for smooth in (False, True)
    )
    return raw, smoothed


def held_out(performance: Performance, bank: Databank, truth: Truth) -> float:
    """mm, mean over markers and frames: each is left out in turn, and told from the others."""
    face = replace(bank.face, vertices=truth.neutral)
    still = truth.markers - truth.markers[:30].mean(axis=0)
    found = []
    for point in performance.points:
        surface = reconstruct(_without(performance, point), bank, face=face)
        row = face.points.index([point])
        told = [face.points.at(surface.motion(frame))[row[0]] for frame in truth.frames]
        true = still[truth.frames, truth.fdp.index(point)]
        found.append(np.linalg.norm(np.array(told) - true, axis=-1).mean())
    return float(np.mean(found))


def _without(performance: Performance, point: str) -> Performance:
    kept = [i for i, other in enumerate(performance.points) if other != point]
    return replace(
        performance,
        points=tuple(performance.points[i] for i in kept),
        neutral=performance.neutral[kept],
        motion=performance.motion[:, kept],
        sigma=performance.sigma[kept],
    )


def judge_dirty(path: Path, bank: Databank, truth: Truth, clean: float) -> dict[str, float]:
    """Figures of the take with gaps, swaps, ghosts and a moving head."""
    performance, mended = capture_markers(path)
    face = replace(bank.face, vertices=truth.neutral)
    error = truth.error(reconstruct(performance, bank, face=face))
    counts = compare_events(mended.events, truth.events)
    return {
        "head_frame_mm": head_frame(path, truth),
        "dirty_mm": error,
        "dirty_ratio": error / clean,
        **counts,
    }


def head_frame(path: Path, truth: Truth) -> float:
    """mm, mean distance of the markers as seen from where they truly are in the head, once the
    head's motion is taken out; markers that were elsewhere than their label says do not count."""
    take = read_c3d(path)
    roles = name_roles(take.labels)
    worn = ~roles.nameless
    motion, _ = find_head_motion(take.places[:, worn], roles.jig[worn], take.rate)
    columns = [take.labels.index(label) for label in truth.labels if not label.startswith("Jig")]
    seen = motion.undo(take.places)[:, columns]
    there = [truth.labels.index(take.labels[column]) for column in columns]
    seen[truth.missing[:, there]] = np.nan
    for event in truth.events:
        if event["kind"] in ("swap", "jump"):
            for label in event.get("markers", [event.get("marker")]):
                column = there.index(truth.labels.index(str(label).rpartition(":")[2]))
                seen[int(event["first"]) : int(event["last"]) + 1, column] = np.nan
    true = truth.markers[:, there]
    known = np.isfinite(seen).all(axis=-1)
    onto = align(seen[known], true[known])
    still = seen @ onto.rotation.T
    still += (true - still)[known].mean(axis=0)
    return float(np.linalg.norm(still - true, axis=-1)[known].mean())


def compare_events(found: tuple[Event, ...], true: list[dict[str, object]]) -> dict[str, float]:
    """How many swaps, jumps and ghosts there were, how many were found (the same markers, frames
    that overlap), and how many were made up."""
    figures = {}
    for kind in ("swap", "jump", "ghost"):
        real = [event for event in true if event["kind"] == kind]
        told = [event for event in found if event.kind == kind]
        matched = [[_same(event, other) for other in told] for event in real]
        figures[f"{kind}s"] = float(len(real))
        figures[f"{kind}s_found"] = float(sum(any(row) for row in matched))
        figures[f"{kind}s_false"] = float(
            sum(not any(row[i] for row in matched) for i in range(len(told)))
        )
    return figures


def _same(true: dict[str, object], found: Event) -> bool:
    named = true.get("markers") or [true.get("marker") or true.get("label")]
    labels = {str(label).rpartition(":")[2] for label in named}
    return (
        labels == set(found.labels)
        and int(true["first"]) <= found.last
        and found.first <= int(true["last"])
    )


if __name__ == "__main__":
    main()

"""[B]: colour, curves, cardinal mapping, four characters."""

from __future__ import annotations

from time import process_time

import cv2
import numpy as np

import mien
from mien.capture.snakes.colour.transform import window
from mien.capture.snakes.curves.features import FEATURES
from mien.face.character import Character
from mien.face.library import generic_face
from mien.face.pieces import split
from mien.mapping.cardinal import fit
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.trace import Trace
from mien.rehearsal import Tempo, held
from mien.view.overlay import overlay
from reproduction.sheet import Picture, Results, Table, chart, grid
from reproduction.stage import Array, Shot, portraits, sculpted, shoot

FRAMES, RATE = 800, 30.0
MOMENTS = ("smile", "sad", "anger", "surprise", "disgust", "blink_left", "jaw_open", "pucker")
POINTS = (
    *("4.1", "4.2", "4.3", "4.4", "3.1", "3.2", "3.3", "3.4", "5.3", "5.4", "9.1", "9.2"),
    *("8.1", "8.2", "8.3", "8.4", "2.2", "2.3", "2.1", "9.3"),
)
"""Twenty: 60 numbers."""
THRESHOLD = 1e-5
LIGHTS = {"daylight": (1.0, 1.0, 1.0), "lamp": (1.0, 0.82, 0.6), "dusk": (0.42, 0.45, 0.55)}
PUPPETEERS = ("woman", "man", "monkey")
_FACE = np.s_[90:390, 100:380]
"""Rows and columns of a picture."""
_RESTING = 5
"""A frame in which the lips are shut."""
_OFFSET, _REACH = 5.0, 32
"""Patch units between a curve and its offset curves, and how far it is moved to either side."""


def results() -> Results:
    """Everything [B] shows, from nothing."""
    shot = shoot("woman", tempo=_tempo(), frames=FRAMES)
    _, traces = shot.captured("snakes")
    smile = shot.middle("smile")
    return {
        "figure_2": grid([[shot.frames[smile].image, _transformed(traces[smile])]], [], 360),
        **_energies(traces[_RESTING]),
        "figure_4": _examples(),
        "dimensions": _dimensions(),
        **_puppeteers(),
        **_animation(shot),
        **{way: f"{shot.speed(way):.0f}" for way in ("snakes", "landmarks")},
    }


def _tempo() -> Tempo:
    """Thirteen key models in just over ``FRAMES`` frames."""
    tempo, count = Tempo(rise=0.25, hold=0.0, gap=0.6), len(mien.load_character("woman").examples)
    free = FRAMES / RATE - 2 * tempo.rest - count * (2 * tempo.rise + tempo.gap)
    return Tempo(rise=tempo.rise, hold=free / count + 0.005, gap=tempo.gap, rate=RATE, sway=0.15)


def _transformed(trace: Trace) -> Picture:
    assert trace.beside is not None
    return trace.beside


def _energies(trace: Trace) -> dict[str, Picture | str]:
    """Image and constraint energy of the upper lip's curve, moved up and down."""
    to_patch = _to_patch(trace)
    curve = trace.curves["lips_upper"] @ to_patch[:, :2].T + to_patch[:, 2]
    field = cv2.GaussianBlur(_transformed(trace)[..., 0] / np.float32(255.0), (0, 0), 1.5)
    slope = np.hypot(*(cv2.Sobel(field, cv2.CV_32F, x, 1 - x, scale=0.25) for x in (1, 0)))
    steps = np.arange(-_REACH, _REACH + 1.0)
    image = np.array([-20.0 * float((_along(slope, curve, step) ** 2).mean()) for step in steps])
    outer, inner = (
        np.array([float(_along(field, curve, step + way * _OFFSET).mean()) for step in steps])
        for way in (-1.0, 1.0)
    )
    constraint = 0.5 * outer - inner
    valleys = np.flatnonzero((image[1:-1] < image[:-2]) & (image[1:-1] <= image[2:])) + 1
    first, second = sorted(sorted(valleys.tolist(), key=lambda i: float(image[i]))[:2])
    return {
        "figure_3": chart(
            steps.tolist(),
            {"image energy": image.tolist(), "constraint energy": constraint.tolist()},
            across="the curve moved down by ... patch units (100 between the eyes)",
            up="energy",
        ),
        "valleys": f"{steps[first]:+.0f} and {steps[second]:+.0f} units",
        "above": f"{constraint[first]:+.2f}",
        "below": f"{constraint[second]:+.2f}",
    }


def _to_patch(trace: Trace) -> Array:
    """(2, 3) from pixels of the frame to pixels of the transformed picture."""
    seen = np.concatenate([trace.boxes[feature.name] for feature in FEATURES])
    there = []
    for feature in FEATURES:
        left, top, right, bottom = window(feature.box)
        there += [[left, top], [right, top], [right, bottom], [left, bottom]]
    found, _ = cv2.estimateAffinePartial2D(seen, np.array(there, dtype=float))
    return np.asarray(found)


def _along(field: Picture, curve: Array, down: float) -> Array:
    x, y = curve.astype(np.float32).T
    return cv2.remap(field, x[None], y[None] + np.float32(down), cv2.INTER_LINEAR)[0]


def _examples() -> Picture:
    cast = [mien.load_character(name) for name in ("generic", *mien.CHARACTERS)]
    keys = cast[1].examples
    rows = [[sculpted(character, key, 120) for key in keys] for character in cast]
    return grid(rows, ["source", *mien.CHARACTERS], 120)


def _dimensions() -> Table:
    """How many eigenvectors the paper's threshold keeps."""
    generic = generic_face()
    rows = generic.face.points.index(POINTS)
    fields = generic.face.points.at(generic.keys.displacements.astype(float))[:, rows]
    examples = [generic.keys.names.index(name) for name in generic.examples]
    sets = {"13": examples[:13], "27": examples, "79": range(len(generic.keys.names))}
    mouth = float(np.linalg.norm(generic.face.point("8.3") - generic.face.point("8.4")))
    units = {"millimetres": 1.0, "mouth widths": 1.0 / mouth, "metres": 1e-3}

    def kept(motion: Array) -> int:
        return len(fit(motion, np.eye(len(motion)), 0.0, THRESHOLD).feature)

    return Table(
        ["source examples", *units],
        [
            [name, *(kept(fields[list(rows)].reshape(len(rows), -1) * u) for u in units.values())]
            for name, rows in sets.items()
        ],
    )


def _puppeteers() -> dict[str, Picture | str | int]:
    columns, lost = [], 0
    for name in PUPPETEERS:
        shot = shoot(name, ("smile",), Tempo(rest=0.3, hold=0.1))
        frame = shot.middle("smile")
        for light in LIGHTS.values():
            frames = [_lit(frame, light) for frame in shot.frames]
            _, traces = Shot(shot.character, shot.acted, frames).captured("snakes")
            image, trace = frames[frame].image, traces[frame]
            lost += sum(note.endswith("lost") for note in trace.notes)
            drawn = overlay(image, Trace(curves=trace.curves))
            columns.append([image[_FACE], _transformed(trace), drawn[_FACE]])
    rows = [list(row) for row in zip(*columns, strict=True)]
    return {
        "figure_6": grid(rows, ["original", "transformed", "curves"], 150),
        "lights": ", ".join(LIGHTS),
        "lost": lost,
    }


def _lit(frame: Frame, light: tuple[float, float, float]) -> Frame:
    linear = (frame.image / 255.0) ** 2.2 * np.array(light)
    return Frame((255.0 * linear ** (1 / 2.2) + 0.5).astype(np.uint8), frame.time)


def _animation(shot: Shot) -> Results:
    performance, _ = shot.captured("landmarks")
    moments = [shot.middle(key) for key in MOMENTS]
    rows, table = [[shot.frames[moment].image for moment in moments]], []
    for name in mien.CHARACTERS:
        character = mien.load_character(name)
        strongest = _recognised(shot, character, performance)
        begin = process_time()
        curves = mien.animate(performance, character)
        speed = FRAMES / (process_time() - begin)
        rows.append(list(portraits(character, curves, moments)))
        table.append([name, len(character.examples), strongest, f"{speed:.0f}"])
    return {
        "figure_7": grid(rows, ["performer", *mien.CHARACTERS], 190),
        "frames": len(performance),
        "nowhere": int(performance.lost.sum()),
        "characters": Table(
            ["character", "key models", "strongest is the one acted", "frames a second, mapping"],
            table,
        ),
    }


def _recognised(shot: Shot, character: Character, performance: Performance) -> str:
    """Share of the held frames in which the acted key model has the largest mean weight."""
    weights = mien.animate(performance, character, smooth=False).weights
    pieces = split(character)
    rows = [character.keys.names.index(key) for key in character.examples]
    strength = np.stack([weights[:, pieces.key == row].mean(axis=1) for row in rows], axis=1)
    right = [
        character.examples[int(strength[frame].argmax())] == key
        for key in shot.character.examples
        for frame in held(shot.acted, key)
    ]
    return f"{100 * np.mean(right):.0f} %"

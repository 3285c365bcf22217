"""A performer in a marker suit: where the markers are in the room, and where the skin truly is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mien.capture.markers.perform import MarkerSettings, perform
from mien.face.character import Character
from mien.face.library import generic_face
from mien.numeric.procrustes import rigid
from mien.numeric.rotation import from_vector
from mien.performance.marker_take import MarkerTake
from mien.performance.performance import Performance
from mien.rehearsal import Tempo, held, rehearse
from mien.scan.template import Template
from mien.view.camera import Camera
from mien.view.renderer import Renderer
from reproduction.sheet import Picture
from reproduction.stage import Array

SHOWN = ("smile", "sad", "surprise", "disgust", "brows_up", "pucker", "jaw_open")
WORN = (
    *("2.1", "2.10", "2.11", "2.12", "4.1", "4.2", "4.3", "4.4", "4.5", "4.6", "5.1", "5.2"),
    *("5.3", "5.4", "8.1", "8.2", "8.3", "8.4", "8.5", "8.6", "8.7", "8.8", "9.1", "9.2"),
    *("9.3", "9.4", "9.5", "9.12", "9.6", "9.7", "9.13", "9.14"),
)
"""Thirty-two, none on lids or inner lips."""
JIG = np.array([[0.0, 130.0, 20.0], [75.0, 105.0, 5.0], [-70.0, 100.0, 10.0]])
NOISE, RATE = 0.3, 60.0
VIEW = Camera(height=290.0, size=(300, 300))
_STEP = 20
"""Frames between two of which the skin is compared."""
_LEAN, _ROOM = from_vector(np.array([0.0, 0.0, 0.1])), np.array([80.0, -40.0, 1100.0])


@dataclass(frozen=True)
class Take:
    """A performance in markers, and what is known of it besides."""

    performance: Performance
    head: dict[str, float]
    """mm, mean error of a marker after the head's motion was undone, by how."""
    sampled: range
    """Frames of ``skin``."""
    skin: Array
    """(S, W, 3) mm, motion of the refined skin."""
    frames: list[int]
    """One for each key model of SHOWN."""
    snapshots: list[Picture]
    """What a camera saw in them."""


def worn_places(performer: Character) -> Array:
    """(35, 3) mm of the markers at rest, the jig's last."""
    points = performer.face.points
    return np.concatenate([points.at(performer.face.vertices)[points.index(WORN)], JIG])


def act(performer: Character, template: Template) -> Take:
    """``performer`` acts SHOWN, and the head moves."""
    acted = rehearse(performer, SHOWN, Tempo(rest=1.0, rise=0.25, hold=0.3, rate=RATE))
    weights, fields = acted.weights, performer.keys.displacements
    points = performer.face.points
    motion = np.tensordot(weights, points.at(fields.astype(float))[:, points.index(WORN)], axes=1)
    still = np.zeros((len(weights), len(JIG), 3))
    places = worn_places(performer) + np.concatenate([motion, still], axis=1)
    places = places @ np.swapaxes(_LEAN @ acted.rotation, 1, 2) + _ROOM
    places += NOISE * np.random.default_rng(2).standard_normal(places.shape)
    take = MarkerTake((*WORN, "JigTop", "JigL", "JigR"), acted.time, places, source=performer.name)
    rest, generic = (0.0, 0.8), generic_face().face
    ours, _ = perform(take, generic, MarkerSettings(rest))
    theirs, _ = perform(take, generic, MarkerSettings(rest, nose_tip=True))
    skin = fields[:, : len(template.vertices)]
    sampled = range(0, len(weights), _STEP)
    frames = [int(np.median(held(acted, key))) for key in SHOWN]
    renderer = Renderer(performer.face)
    return Take(
        performance=ours,
        head={
            "jig and nose tip, frame by frame, as published": _missed(theirs, motion),
            "all markers that keep their place, smoothed (default)": _missed(ours, motion),
        },
        sampled=sampled,
        skin=np.stack(
            [template.refinement @ np.tensordot(weights[f], skin, axes=1) for f in sampled]
        ),
        frames=frames,
        snapshots=[
            renderer.render(performer.surface(weights[f]) @ acted.rotation[f].T, VIEW)
            for f in frames
        ],
    )


def _missed(performance: Performance, motion: Array) -> float:
    """mm, mean error of a marker's ``motion`` (F, M, 3). Head frames may differ by a turn."""
    found = performance.motion[:, [performance.points.index(fdp) for fdp in WORN]]
    turn = rigid(found.reshape(-1, 3), motion.reshape(-1, 3)).rotation
    return float(np.linalg.norm(found @ turn.T - motion, axis=-1).mean())

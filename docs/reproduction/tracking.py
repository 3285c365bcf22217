"""[C]: non-rigid tracking, and MPEG-4 parameters by bounded least squares."""

from __future__ import annotations

from time import process_time

import numpy as np

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.face.fap_targets import basis_of
from mien.face.library import generic_face
from mien.mapping.fap import FapProgramme
from mien.performance.performance import Performance
from mien.performance.trace import Trace
from mien.rehearsal import Tempo
from mien.view.camera import Camera
from mien.view.overlay import overlay
from reproduction.sheet import Picture, Results, Table, chart, grid
from reproduction.stage import Array, Shot, portraits, shoot

CAMERA = Camera(size=(480, 480), height=330.0)
FOCAL = CAMERA.distance * CAMERA.size[1] / CAMERA.height
"""Pixels."""
KEYS = ("smile", "surprise", "blink_left", "anger", "pucker", "jaw_open")
TARGETS = ("toy", "monkey", "woman")
REST = 0.5
"""Seconds before the first key model, the neutral that the paper asks for."""
SHOWN = 6


def results() -> Results:
    """Everything [C] shows that is a result, from nothing."""
    shot = shoot("woman", KEYS, _tempo(sway=0.45), camera=CAMERA)
    other = shoot("man", KEYS, _tempo(sway=0.3), camera=CAMERA)
    (tracked, traces), (landmarks, _) = _follow(shot, "tracker"), _follow(shot, "landmarks")
    turned = _angles(shot.acted.rotation)
    errors = {"tracker": _error(tracked, shot), "landmarks": _error(landmarks, shot)}
    acts = [(shot, tracked), (other, _follow(other, "tracker")[0])]
    return {
        "figure_2": _tracked(shot, traces),
        "most": f"{turned.max():.0f}",
        "errors": Table(
            ["capture", "mean, degrees", "95 %", "frames a second of one core"],
            [
                [name, *_mean_and_worst(error), f"{shot.speed(name):.0f}"]
                for name, error in errors.items()
            ],
        ),
        "head_over_time": chart(
            shot.acted.time.tolist(),
            {"true turn of the head": turned.tolist()}
            | {f"error, {name}": error.tolist() for name, error in errors.items()},
            across="seconds",
            up="degrees",
        ),
        "figure_3": _animated(acts),
        **_programme(tracked),
    }


def _tempo(sway: float) -> Tempo:
    return Tempo(rest=REST, rise=0.15, hold=0.25, gap=0.1, sway=sway)


def _follow(shot: Shot, method: str) -> tuple[Performance, list[Trace]]:
    """What a capture makes of a film whose camera is known, and what it saw."""
    traces: list[Trace] = []
    settings = CaptureSettings((0.0, 0.8 * REST), FOCAL, watch=traces.append)
    return CAPTURES[method](shot.frames, settings, shot.character.name), traces


def _tracked(shot: Shot, traces: list[Trace]) -> Picture:
    frames = (np.linspace(0.08, 0.92, SHOWN) * (len(shot.frames) - 1)).astype(int)
    films = [shot.frames[f].image for f in frames]
    seen = [Trace(wire=traces[f].wire, axes=traces[f].axes) for f in frames]
    drawn = [overlay(image, trace) for image, trace in zip(films, seen, strict=True)]
    return grid([films, drawn], ["performer", "tracked"], 230)


def _error(performance: Performance, shot: Shot) -> Array:
    """(F,) degrees between the turn that was found and the one that was acted, from the first
    frame on."""
    found = performance.rotation @ performance.rotation[0].T
    return _angles(np.swapaxes(found, 1, 2) @ shot.acted.rotation)


def _mean_and_worst(error: Array) -> tuple[float, float]:
    return float(error.mean()), float(np.quantile(error, 0.95))


def _angles(rotations: Array) -> Array:
    cosine = (np.trace(rotations, axis1=1, axis2=2) - 1.0) / 2.0
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _animated(acts: list[tuple[Shot, Performance]]) -> Picture:
    rows, labels = [], []
    for shot, performance in acts:
        moments = [shot.middle(key) for key in KEYS]
        rows.append([shot.frames[f].image for f in moments])
        labels += ["performer", *TARGETS]
        for name in TARGETS:
            character = mien.load_character(name)
            curves = mien.animate(performance, character, mapping="fap")
            rows.append(list(portraits(character, curves, moments)))
    return grid(rows, labels, 170)


def _programme(performance: Performance) -> dict[str, Table | str | int]:
    """Equation 3 with its bounds and without, on the tracked motion."""
    generic = generic_face()
    programme = FapProgramme(performance, basis_of(generic), generic.face)
    begin = process_time()
    fit = programme(performance)
    seconds = (process_time() - begin) / len(performance)
    hessians, linear = programme.problem(performance, slice(0, len(performance)))
    hessians = np.broadcast_to(hessians, (len(linear), *hessians.shape[1:]))
    free = -np.linalg.solve(hessians, linear[..., None])[..., 0]
    fields = programme.fields.reshape(len(programme.fields), -1)
    motion = programme.rows(performance.motion[:, programme.rows.points])
    bare = np.linalg.lstsq(fields.T, motion.reshape(len(motion), -1).T, rcond=1e-9)[0].T
    lower, upper = programme.bounds
    ways = {"no bounds, no prior (equation 2)": bare, "no bounds, our prior": free}
    rows: list[list[str | float]] = [
        [name, f"{100.0 * np.mean((x < lower) | (x > upper)):.1f} %", float(np.abs(x).max())]
        for name, x in ways.items()
    ]
    return {
        "solved": len(lower),
        "bounds": Table(
            ["", "values beyond their bounds", "largest"],
            [*rows, ["bounds and prior (equation 3, ours)", "0 %", 1.0]],
        ),
        "microseconds": f"{1e6 * seconds:.0f}",
        "kkt": f"{fit.kkt.max():.0e}",
    }

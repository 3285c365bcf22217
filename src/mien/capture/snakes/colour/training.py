"""Teaching the network a performer: lessons from frames in which the features are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.network import Lesson, Network, train, untrained
from mien.capture.snakes.colour.regions import means
from mien.capture.snakes.colour.transform import USUAL_WEIGHTS, Weights, channels, contrast, window
from mien.capture.snakes.curves.features import FEATURES, ROW, Feature
from mien.capture.snakes.curves.fields import Look, corner_of, look_at
from mien.capture.snakes.curves.lens import outline
from mien.capture.snakes.head.patch import Picture

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

GROUPS = {"brow": ("brow_right", "brow_left"), "eye": ("eye_right", "eye_left"), "lip": ("lips",)}
_LIGHTS = ((1.0, 1.0, 1.0), (0.6, 0.6, 0.6), (1.3, 1.3, 1.3), (1.2, 1.0, 0.8), (0.85, 1.0, 1.2))
"""Gains of the channels under which every frame is shown: the network must know other lights."""
_BLURRED_EDGE = 4
"""Patch units of a feature's rim that are neither feature nor skin."""
_EVERY = 3
"""Of so many pixels one is learnt from: neighbours say the same."""
_TOO_WHITE = 0.5
_RIDGE = 0.05
"""How firmly a performer's own weights are held to the usual ones."""


def lessons(patch: Picture, lenses: Array, group: str) -> list[Lesson]:
    """What ``patch`` teaches of a group; ``lenses`` (L + 1, 6, 2) are its features, patch units,
    the mouth's opening last."""
    found = []
    for light in _LIGHTS:
        shown = np.clip(patch * np.array(light), 0, 255).astype(np.uint8)
        look = look_at(shown)
        whole, mask = _examples(look, lenses, group)
        pixels, wanted = whole[::_EVERY], mask[::_EVERY]
        share = np.where(wanted, 0.5 / max(wanted.sum(), 1), 0.5 / max((~wanted).sum(), 1))
        found.append(Lesson(means(look.value), pixels, wanted.astype(float), share))
    return found


def teach(shown: Sequence[tuple[Picture, Array]]) -> dict[str, Network]:
    """Networks from patches and their lenses (see ``lessons``), for the groups that they tell from
    their surroundings better than the usual weights do."""
    networks = {}
    for group in GROUPS:
        taught = [lesson for patch, lenses in shown for lesson in lessons(patch, lenses, group)]
        weights, constant = _fitted(taught, USUAL_WEIGHTS[group])
        network = train(untrained(weights, constant), taught)
        usual = untrained(*_flat(USUAL_WEIGHTS[group]))
        network = _midway(network, usual)
        if _misfit(network, taught) < _misfit(usual, taught):
            networks[group] = network
    return networks


def _flat(weights: Weights) -> tuple[Array, float]:
    """(4,) and the constant."""
    four = np.array([weights.magenta, weights.black, weights.brightness, weights.hue])
    return four, weights.constant


def _midway(network: Network, usual: Network) -> Network:
    """The network whose weights lie between what ``network`` and ``usual`` give: a few frames tell
    colours well and edges badly. Eyes and brows of four films are found better so than by either.
    """
    return replace(
        network,
        output=0.5 * network.output,
        output_bias=0.5 * (network.output_bias + usual.output_bias),
        constant=0.5 * (network.constant + usual.constant),
    )


def _misfit(network: Network, taught: Sequence[Lesson]) -> float:
    """Mean absolute error of I after contrast, as the curves see it."""
    missed = []
    for lesson in taught:
        intensity = lesson.channels @ network(lesson.means) + network.constant
        missed.append(lesson.share @ np.abs(contrast(intensity) - lesson.wanted))
    return float(np.mean(missed))


def least_squares(look: Look, lenses: Array) -> Mapping[str, Weights]:
    """Weights by least squares on the features as they were last seen: what the network is
    weighed against."""
    found = dict(USUAL_WEIGHTS)
    for group in GROUPS:
        pixels, wanted = _examples(look, lenses, group)
        if wanted.any() and not wanted.all():
            share = np.where(wanted, 0.5 / wanted.sum(), 0.5 / (~wanted).sum())
            lesson = Lesson(np.zeros(11), pixels, wanted.astype(float), share)
            weights, constant = _fitted([lesson], USUAL_WEIGHTS[group])
            magenta, black, brightness, hue = weights.tolist()
            found[group] = Weights(magenta, black, min(brightness, 0.0), hue, constant)
    return found


def _fitted(taught: Sequence[Lesson], usual: Weights) -> tuple[Array, float]:
    """Least squares over all lessons, held to the usual weights."""
    start = np.append(*_flat(usual))
    normal, right = _RIDGE * np.eye(5), _RIDGE * start
    for lesson in taught:
        rows = np.column_stack([lesson.channels, np.ones(len(lesson.channels))])
        normal += (rows * lesson.share[:, None]).T @ rows / len(taught)
        right = right + rows.T @ (lesson.share * lesson.wanted) / len(taught)
    solved = np.asarray(np.linalg.solve(normal, right), dtype=np.float64)
    return solved[:4], float(solved[4])


def _examples(look: Look, lenses: Array, group: str) -> tuple[Array, Mask]:
    """(N, 4) channels and (N,) what they should be, of a group's rectangles."""
    parts = [_example(look, lenses, name) for name in GROUPS[group]]
    return np.concatenate([p for p, _ in parts]), np.concatenate([w for _, w in parts])


def _example(look: Look, lenses: Array, name: str) -> tuple[Array, Mask]:
    feature = FEATURES[ROW[name]]
    size = _size(feature)
    corner = corner_of(feature)
    masks = [_mask((lens - corner) / feature.pitch, size) for lens in lenses]
    wanted = masks[ROW[name]].astype(bool)
    grown = np.ones((_BLURRED_EDGE // feature.pitch + 1,) * 2, np.uint8)
    edge = cv2.dilate(masks[ROW[name]], grown).astype(bool) & ~wanted
    others = np.any([m for row, m in enumerate(masks) if row != ROW[name]], axis=0)
    pixels = channels(look.at(feature.pitch), look.gains, look.mean, feature.box, feature.pitch)
    counts = ~edge & ~others
    if feature.group == "eye":
        # The white of the eye has a transformation of its own.
        counts &= ~(wanted & (pixels[..., 0] < -_TOO_WHITE))
    return pixels[counts], wanted[counts]


def _size(feature: Feature) -> tuple[int, int]:
    left, top, right, bottom = window(feature.box, feature.pitch)
    return bottom - top, right - left


def _mask(lens: Array, size: tuple[int, int]) -> NDArray[np.uint8]:
    """A lens in pixels as a mask."""
    mask = np.zeros(size, np.uint8)
    cv2.fillPoly(mask, [np.round(outline(lens)).astype(np.int32)], 1)
    return mask

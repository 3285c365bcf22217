"""Feature points of a face that is human enough, found by drawing it and looking at the picture.

The head is drawn from several sides with dark irises, the landmark network finds its points, and
each is cast back onto the skin; the median over the views counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.capture.detector import Detector
from mien.errors import NoFaceError
from mien.face.face import Array, Face, FeaturePoints, Ints, Material, Part
from mien.face.model import Model
from mien.numeric.raster import rasterize
from mien.rig.components import components, round_pair
from mien.rig.dress import dressed
from mien.rig.picks import NEEDED, Picks
from mien.view.camera import Camera
from mien.view.renderer import Renderer
from mien.vocabulary.landmarks import FACE_LANDMARKS, feature_points

_SIDE = 640
_VIEWS = ((0.0, 0.0), (0.14, 0.0), (-0.14, 0.0), (0.0, 0.12), (0.0, -0.12))
"""Yaw and pitch of the cameras."""
_ZOOMS = (1.7, 1.25, 2.4)
"""Heights of the picture in heights of what the shapes move."""
_LOOKS = 3
"""Times a view is shown: the network settles on it."""
_STRAY = 14.0
"""Pixels from a landmark within which skin is still meant."""


def find_points(model: Model, path: Path) -> Picks:
    """Feature points in the model's coordinates. Raises NoFaceError where nobody's face is seen,
    MissingExtraError without the landmark network."""
    vertices, triangles = model.vertices, model.triangles
    part = components(vertices, triangles)
    low, high = framed(model, vertices)
    with Detector() as detector:
        for facing in (1, -1) if model.forward is None else (model.forward,):
            turned = np.array([facing, 1.0, facing])
            centre = (low + high) / 2.0 * turned
            stage = _Stage(model, vertices * turned, triangles, part, centre, detector)
            for zoom in _ZOOMS:
                places = stage.look(zoom * float((high - low)[1]))
                if places is not None:
                    return {name: place * turned for name, place in places.items()}
    raise NoFaceError(
        f"{path}: no face was seen on it; take it in by 'mien character import' with --points FILE "
        "of feature points, at least " + ", ".join(pair[0] for pair in NEEDED)
    )


def framed(model: Model, vertices: Array) -> tuple[Array, Array]:
    """The box of what the shapes move most, or of everything."""
    moved = np.zeros(len(vertices))
    for shape in model.shapes:
        length = np.linalg.norm(model.dense(shape), axis=1)
        if length.any():
            moved = np.maximum(moved, length / length.max())
    chosen = vertices[moved > 0.3] if (moved > 0.3).sum() > 20 else vertices
    return np.percentile(chosen, 2, axis=0), np.percentile(chosen, 98, axis=0)


@dataclass
class _Stage:
    """A model that is looked at from around ``centre``, facing +z."""

    model: Model
    vertices: Array
    triangles: Ints
    part: NDArray[np.intp]
    centre: Array
    detector: Detector

    def __post_init__(self) -> None:
        unit = 250.0 / max(float(np.ptp(self.vertices[:, 1])), 1e-12)
        self._scale = unit
        self._placed = (self.vertices - self.centre) * unit
        colours = np.concatenate([part.colours for part in self.model.parts])
        everything = Part("all", "skin", 0, len(self.vertices), self.triangles)
        nothing = FeaturePoints((), np.zeros((0, 3), np.int32), np.zeros((0, 3)))
        self._face = Face(
            self._placed,
            (everything,),
            {"skin": Material(roughness=0.9, specular=0.1)},
            dressed(colours, self._placed, round_pair(self._placed, self.part)),
            np.ones(len(self.vertices)),
            nothing,
            {},
        )

    def look(self, height: float) -> dict[str, Array] | None:
        """Places (3,) of the feature points, upright in the file's unit; None: no face."""
        camera = Camera(
            height=height * self._scale,
            centre=(0.0, 0.0, 0.0),
            size=(_SIDE, _SIDE),
            distance=4.0 * height * self._scale,
        )
        renderer = Renderer(self._face)
        seen: list[tuple[Camera, Array]] = []
        for yaw, pitch in _VIEWS:
            view = replace(camera, yaw=yaw, pitch=pitch)
            picture = renderer.render(self._placed, view)
            for _ in range(_LOOKS):
                landmarks = self.detector.landmarks(picture, range(FACE_LANDMARKS))
            if landmarks is None and not seen:
                return None
            if landmarks is not None:
                seen.append((view, landmarks[:, :2].astype(float)))
        if len(seen) < 3:
            return None
        rows = list(feature_points().items())
        hits = [self._cast(view, pixels[[row for _, row in rows]]) for view, pixels in seen]
        found = {}
        for (name, _), places in zip(rows, np.stack(hits, axis=1), strict=True):
            met = places[np.isfinite(places[:, 0])]
            if len(met):
                found[name] = np.median(met, axis=0) / self._scale + self.centre
        return found if all(any(name in found for name in pair) for pair in NEEDED) else None

    def _cast(self, view: Camera, pixels: Array) -> Array:
        """(N, 3) places on the skin seen at ``pixels`` (N, 2); not a number where there is none."""
        screen = view.project(self._placed)
        two_sided = np.ones(len(self.triangles), dtype=bool)
        ids, _ = rasterize(screen, self.triangles, two_sided, _SIDE, _SIDE)
        column, row = np.clip(pixels, 0, _SIDE - 1).astype(int).T
        hit = ids[row, column]
        owner = np.where(hit >= 0, self.part[self.triangles[hit, 0]], -1)
        most = np.bincount(owner[owner >= 0]).argmax() if (owner >= 0).any() else -1
        own = np.where(ids >= 0, self.part[self.triangles[ids, 0]] == most, False)
        places = np.full((len(pixels), 3), np.nan)
        rows, columns = np.nonzero(own)
        for i, (x, y) in enumerate(pixels):
            away = (columns + 0.5 - x) ** 2 + (rows + 0.5 - y) ** 2
            best = int(away.argmin())
            if away[best] < _STRAY**2:
                triangle = self.triangles[ids[rows[best], columns[best]]]
                places[i] = _on_triangle(
                    screen[triangle, :2].astype(float),
                    self._placed[triangle],
                    (columns[best], rows[best]),
                )
        return places


def _on_triangle(corners: Array, places: Array, pixel: tuple[int, int]) -> Array:
    """The place (3,) that is seen at a pixel of a triangle (3, 3) whose corners are at (3, 2)."""
    system = np.vstack([corners.T, np.ones(3)]).astype(float)
    seen = np.array([pixel[0] + 0.5, pixel[1] + 0.5, 1.0])
    weights = np.clip(np.linalg.lstsq(system, seen, rcond=None)[0], 0.0, 1.0)
    return np.asarray(weights @ places / weights.sum())

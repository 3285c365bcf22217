"""The coach: asks a performer to hold still, looks, and keeps what the face stands for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mien.live.studio.messages import Face, Hold, Learnt
from mien.mapping.lids import SCALARS
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace, Performer

HELD = 0.6
"""Seconds for which a face is held."""
_FEWEST = 4
_PATIENCE = 6.0
"""Seconds after which nobody waits for a face any more."""
_FAR = 3.0
"""Standard errors by which some point must be away from rest, for a face to be another."""
_AT_REST = 1.5
"""Standard errors, root mean square over the points, within which a rest is believed."""
_TREMBLE = 0.35
"""Part of what moved that may tremble while it is held."""
_SAME = 1.0
"""Standard errors, root mean square, within which a held face takes the place of another."""
MOST = 64
_FACE_ON = np.array([0.0, 0.0, 1.0])
"""What a camera before a face does not see."""

Array = NDArray[np.float64]


@dataclass(slots=True)
class Coach:
    """What a performer holds, has held, and for whom."""

    faces: list[HeldFace] = field(default_factory=list)
    _task: Hold | None = None
    _pose: Mapping[str, float] = field(default_factory=dict)
    _seen: list[Performance] = field(default_factory=list)
    _begin: float = -1.0

    def ask(self, task: Hold, pose: Mapping[str, float]) -> None:
        """From now on the performer holds still; ``pose`` is what their face stands for."""
        self._task, self._pose = task, pose
        self._seen, self._begin = [], -1.0

    @property
    def task(self) -> Hold | None:
        """What is held now."""
        return self._task

    @property
    def share(self) -> float:
        """How much of it has been seen, 0..1."""
        if not self._seen:
            return 0.0
        span = float(self._seen[-1].time[0] - self._seen[0].time[0])
        return min(span / HELD, len(self._seen) / _FEWEST, 1.0)

    def see(self, time: float, performance: Performance | None) -> bool:
        """One more frame at ``time`` seconds; True when enough was seen, or when nobody came."""
        if self._task is None:
            return False
        self._begin = time if self._begin < 0.0 else self._begin
        if performance is not None and not performance.lost[0]:
            self._seen.append(performance)
        return self.share >= 1.0 or not 0.0 <= time - self._begin < _PATIENCE

    def judge(self, capture: str) -> Learnt:
        """End the task, and say what came of it; a face that is one is kept."""
        task, seen, self._task = self._task, self._seen, None
        assert task is not None
        pose = task.pose or ("pinned" if task.task == "face" else task.task)
        if len(seen) < _FEWEST:
            return Learnt(task.task, pose, "refused", "no face was seen")
        motion = np.stack([_seen(each.motion[0], each.unseen[0]) for each in seen])
        sigma = seen[0].sigma
        held = np.median(motion, axis=0)
        tremble = _rms(motion.std(axis=0) / sigma)
        if task.task == "neutral":
            return _rest(_rms(held / sigma))
        if task.task == "lids":
            return Learnt("lids", pose, "good", "your shut lids shut theirs")
        if _furthest(held / sigma) < _FAR:
            words = "hardly different from your face at rest: pull it further"
            return Learnt("face", pose, "refused", words)
        self._keep(HeldFace(capture, task.character, dict(self._pose), *_median(seen)), sigma)
        shaky = tremble > _TREMBLE * _rms(held / sigma)
        words = f"learnt, {_furthest(held):.0f} mm from rest"
        if shaky:
            words += ", but it trembled: better hold it again"
        return Learnt("face", pose, "shaky" if shaky else "good", words)

    def refuse(self, reason: str) -> Learnt:
        """End the task without having learnt anything."""
        task, self._task = self._task, None
        assert task is not None
        return Learnt(task.task, task.pose or task.task, "refused", reason)

    def shown(self) -> list[Face]:
        """The faces for the page."""
        return [
            Face(face.character, in_words(face.pose), _furthest(_seen(face.motion, face.unseen)))
            for face in self.faces
        ]

    def _keep(self, face: HeldFace, sigma: Array) -> None:
        """The newest of those that look alike, or that stand for the same, counts."""

        def replaced(other: HeldFace) -> bool:
            if (other.capture, other.character) != (face.capture, face.character):
                return False
            alike = _rms((other.motion - face.motion) / sigma) < _SAME
            return alike or other.pose == face.pose

        kept = [other for other in self.faces if not replaced(other)]
        self.faces = [*kept, face][-MOST:]


def known_faces(performer: Performer) -> list[HeldFace]:
    """The faces a performer has held, those of 'mien calibrate' too: its key poses stand for the
    key models of their names, for everybody."""
    held = list(performer.held)
    there = {(face.capture, *face.pose) for face in held if not face.character}
    for name, motion in performer.poses.items():
        capture, _, pose = name.partition("/")
        if (capture, pose) not in there:
            held.append(HeldFace(capture, "", {pose: 1.0}, motion, _FACE_ON, np.zeros(2)))
    return held


def key_poses(faces: Sequence[HeldFace]) -> dict[str, Array]:
    """Those that stand for one key model, for everybody, as 'mien calibrate' keeps them."""
    return {
        f"{face.capture}/{next(iter(face.pose))}": face.motion
        for face in faces
        if not face.character and list(face.pose.values()) == [1.0]
    }


def in_words(pose: Mapping[str, float]) -> str:
    """ "smile", or "smile_mouth_L 0.7, jaw_open 0.3"."""
    if list(pose.values()) == [1.0]:
        return next(iter(pose))
    named = sorted(pose.items(), key=lambda item: -item[1])
    words = [f"{name} {level:.1f}" for name, level in named[:3]]
    return ", ".join(words) + (f" and {len(named) - 3} more" if len(named) > 3 else "")


def _rest(away: float) -> Learnt:
    if away > _AT_REST:
        return Learnt("neutral", "neutral", "shaky", "you moved: hold your face still once more")
    return Learnt("neutral", "neutral", "good", "this is your face at rest from now on")


def _median(seen: list[Performance]) -> tuple[Array, Array, Array]:
    """Motion (P, 3), unseen direction (3,) and lids (2,) of what was held."""
    away = np.mean([each.unseen[0] for each in seen], axis=0)
    lids = np.array(
        [np.median([each.scalars[name][0] for each in seen]) for name in SCALARS]
        if all(name in seen[0].scalars for name in SCALARS)
        else [0.0, 0.0]
    )
    length = np.linalg.norm(away)
    motion = np.median([each.motion[0] for each in seen], axis=0)
    return motion, away / length if length > 0.0 else away, lids


def _seen(motion: Array, unseen: Array) -> Array:
    """(P, 3) motion without what nobody measured."""
    return np.asarray(motion - (motion @ unseen)[:, None] * unseen)


def _rms(errors: Array) -> float:
    return float(np.sqrt((errors**2).sum(axis=-1).mean()))


def _furthest(motion: Array) -> float:
    return float(np.sqrt((motion**2).sum(axis=-1).max()))

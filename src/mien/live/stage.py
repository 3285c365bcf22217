"""The stage: one performer, the characters that follow, one frame at a time.

The same capture, mappers and causal filter as offline, stepped: with the same calibration the same
frames give the same weights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from mien.capture.shapes import motion_from_shapes
from mien.capture.stepping import Stepper
from mien.face.character import Character
from mien.face.library import generic_face
from mien.face.overrides import overridden
from mien.mapping import MAPPERS, Mapper, Settings
from mien.mapping.arkit import ArkitMapper
from mien.mapping.beside import beside
from mien.mapping.fap import parted
from mien.mapping.held import with_held
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.performance.curves import Curves
from mien.performance.filters import Smoother
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace
from mien.vocabulary.arkit import names

State = Literal["waiting", "following", "lost"]


@dataclass(frozen=True, slots=True)
class Moment:
    """What is known of one instant."""

    time: float
    """Seconds, of the source."""
    state: State
    """"waiting": nobody seen yet, or not long enough to know their rest."""
    performance: Performance | None = None
    """One frame, or None while waiting."""
    curves: Mapping[str, Curves] | None = None
    """One frame for each character, by its name."""
    arkit: ArkitFrame | None = None
    """The same in ARKit's words, where somebody listens."""


class Stage:
    """Steps performers through capture, mapping and the causal filter."""

    def __init__(
        self,
        characters: Sequence[Character] = (),
        stepper: Stepper | None = None,
        *,
        mapping: str = "cardinal",
        settings: Settings | None = None,
        held: Sequence[HeldFace] = (),
        speak: bool = False,
    ) -> None:
        """``stepper`` sees pictures, and is not needed by those who only ``hear``; ``held``
        are faces of the performer that stand for what characters do; ``speak`` also tells every
        moment in ARKit's words. Raises KeyError for an unknown ``mapping``."""
        self._characters = tuple(characters)
        self._stepper = stepper
        self._build = MAPPERS[mapping]
        self._settings = settings or Settings()
        self._held = held
        self._speak = speak
        self._header: Performance | None = None
        self._mappers: dict[str, Mapper] = {}
        self._smoother = Smoother()
        self._voice: _Voice | None = None
        self._begin: ArkitFrame | None = None

    def see(self, frame: Frame) -> Moment:
        """The moment in a picture. Raises ValueError without a stepper."""
        if self._stepper is None:
            raise ValueError("this stage has no capture and cannot see")
        performance = self._stepper.step(frame)
        if performance is None:
            return Moment(frame.time, "waiting")
        return self._moment(frame.time, performance)

    def look_around(self) -> None:
        """Once everybody was told of a picture: see to what could wait until then."""
        if self._stepper is not None:
            self._stepper.look_around()

    def hear(self, frame: ArkitFrame) -> Moment:
        """The moment in a frame that somebody streams."""
        if self._begin is None:
            if not frame.seen:
                return Moment(frame.time, "waiting")
            self._begin = frame
        spoken = performance_of([frame], "stream")
        return self._moment(
            frame.time,
            replace(
                spoken,
                time=np.array([frame.time]),
                rest_translation=self._begin.translation,
            ),
        )

    def show(self, performance: Performance) -> Moment:
        """The moment in one frame of a performance that is known already."""
        return self._moment(float(performance.time[0]), performance)

    def learn(self) -> None:
        """Take the performer's next second as their rest."""
        self._begin = None
        if self._stepper is not None:
            self._stepper.learn()

    def _moment(self, time: float, performance: Performance) -> Moment:
        heard = bool(performance.vocabulary and not performance.points)
        moved = motion_from_shapes(performance, generic_face()) if heard else performance
        self._meet(moved)
        mapped = [
            beside(self._mappers[character.name](moved), moved, character)
            for character in self._characters
        ]
        smoothed = self._smoother.together(mapped)
        shown = [
            overridden(parted(curves, character), character)
            for curves, character in zip(smoothed, self._characters, strict=True)
        ]
        curves = dict(zip(self._mappers, shown, strict=True))
        return Moment(
            time,
            "lost" if performance.lost[0] else "following",
            performance,
            curves,
            self._voice(performance) if self._voice else None,
        )

    def _meet(self, performance: Performance) -> None:
        """Build the mappers for a performer who is new, or whose rest was learned anew."""
        header = self._header
        if header is not None and np.array_equal(header.neutral, performance.neutral):
            return
        self._header = performance
        self._mappers = {
            character.name: self._build(
                character,
                performance,
                with_held(self._settings, self._held, character, performance),
            )
            for character in self._characters
        }
        self._smoother = Smoother()
        if self._speak:
            self._voice = _Voice(performance)


class _Voice:
    """Says what a performer does in ARKit's words; words that came so pass as they are."""

    def __init__(self, header: Performance) -> None:
        self._mapper = None if header.vocabulary else ArkitMapper(generic_face(), header)
        self._smoother = Smoother()

    def __call__(self, performance: Performance) -> ArkitFrame:
        """The words of a performance of one frame, filtered."""
        rotation, translation = performance.head()
        said = Curves(
            character="arkit",
            names=names(),
            time=performance.time,
            weights=self._mapper(performance) if self._mapper else performance.shapes,
            rotation=rotation,
            translation=translation,
            gaze=performance.gaze,
            lost=performance.lost,
            residual=np.zeros(1),
        )
        if self._mapper:
            said = self._smoother(said)
        return ArkitFrame(
            float(said.time[0]),
            said.weights[0],
            said.rotation[0],
            said.translation[0],
            said.gaze[0],
            not said.lost[0],
        )

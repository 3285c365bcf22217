"""A take while it is recorded: every frame at once, and what was heard of a film with it."""

from __future__ import annotations

from pathlib import Path

from mien.formats.pictures.sound import write_sound
from mien.formats.takes.recording import Recorder
from mien.performance.performance import Performance

_TOGETHER = 0.1
"""Seconds by which two frames may lie apart otherwise in the take than in the film."""


class Keeping:
    """Writes a take as it comes."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._recorder: Recorder | None = None
        self._stretches: list[tuple[float, float]] = []
        self._last = 0.0

    def write(self, performance: Performance, place: float | None) -> None:
        """One more frame; ``place`` is where in a film it was seen. Raises OutputError."""
        if self._recorder is None:
            self._recorder = Recorder(self.path, performance)
        self._recorder.write(performance)
        time = float(performance.time[0])
        if place is not None:
            self._hear(time, place)
        self._last = time

    def close(self, film: Path | None) -> None:
        """The take ends; ``film`` is what it was recorded from. Raises OutputError."""
        if self._recorder is not None:
            self._recorder.close()
        if film is not None and self._stretches:
            write_sound(film, self._stretches, self.path.with_suffix(".wav"))

    def _hear(self, time: float, place: float) -> None:
        """Go on in the stretch that is heard, or begin another where the film was wound."""
        if self._stretches:
            first, last = self._stretches[-1]
            if abs((place - last) - (time - self._last)) < _TOGETHER:
                self._stretches[-1] = (first, place)
                return
            # What was shown last stays until the next is shown.
            self._stretches[-1] = (first, last + time - self._last)
        self._stretches.append((place, place))

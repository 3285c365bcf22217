"""Mending labels: swaps, jumps and ghosts.

A column of a take is cut into runs wherever the marker vanishes or leaps. A run that is not where
the rest of the face tells its marker to be is taken out; then every such run, and every run
without a name, is given to the marker that is missing there, if it fits. Two runs that fit each
other's places were swapped; one that fits none is a jump, or a ghost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mien.capture.markers.correlation import Correlation, learn

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAP = 3.0
"""mm in one frame at which a column is cut. Cutting too often costs nothing."""
_ASTRAY = 3.0
"""mm from where it should be, and ..."""
_ODD = 5.0
"""... times its usual distance from there, beyond which a run is not its marker's."""
_FITS = 3.0
"""mm: a run nearer than this to where a missing marker should be, and nearer than ..."""
_BETTER = 0.5
"""... this part of its distance from its own marker's place, is that marker's."""
_ROUNDS = 4
_FAR = 15.0
"""mm: a long run that fits nobody keeps its name up to here; faces do things once."""
_BRIEF = 10
"""Frames: a run astray that is shorter is a jump of its marker; a longer one is a stray."""


@dataclass(frozen=True, slots=True)
class Event:
    """What was mended: frames ``first`` to ``last``, inclusive."""

    kind: str
    """"swap" (of two markers), "jump" or "stray" (a marker was somewhere else), "ghost" (nobody's
    point), "found" (a nameless point was a missing marker), "gap" (filled) or "absent" (never
    seen)."""
    labels: tuple[str, ...]
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class _Run:
    """A stretch of one column in which the marker neither vanished nor leapt."""

    column: int
    first: int
    last: int
    named: bool

    @property
    def frames(self) -> slice:
        return slice(self.first, self.last + 1)

    def meets(self, other: _Run) -> bool:
        return self.first <= other.last and other.first <= self.last


def mend(
    places: Array, labels: Sequence[str], nameless: Mask, noise: float
) -> tuple[Array, list[Event]]:
    """Places (F, M, 3) of the M markers that have a name, NaN where unseen, with every point where
    it belongs; and what was done.

    ``places`` (F, N, 3) are those of all N columns, the head's motion undone; ``nameless`` (N,)
    tells which columns are no markers of the set; ``noise`` mm, of a coordinate.
    """
    markers = np.flatnonzero(~nameless)
    own = places[:, markers]
    seen: Mask = np.asarray(np.isfinite(own).all(axis=-1))
    runs = _runs(own, True)
    good, correlation = _trusted(own, seen, runs, noise)
    astray = [run for run in runs if not good[run.frames, run.column].any()]
    strangers = _runs(places[:, nameless], False)
    mended = np.where(good[..., None], own, np.nan)
    away = {run: own[run.frames, run.column] for run in astray}
    away |= {run: places[:, nameless][run.frames, run.column] for run in strangers}
    guess, _ = correlation.predict(own, good)
    homes = _homes(away, guess, good)
    for run, marker in homes.items():
        mended[run.frames, marker] = away[run]
    named = [labels[i] for i in markers.tolist()]
    others = [labels[i] for i in np.flatnonzero(nameless).tolist()]
    events = _events(astray, strangers, homes, named, others)
    return mended, events


def _runs(places: Array, named: bool) -> list[_Run]:
    """Unbroken runs of every column of ``places`` (F, M, 3)."""
    found = []
    seen: Mask = np.asarray(np.isfinite(places).all(axis=-1))
    with np.errstate(invalid="ignore"):
        leaps = np.linalg.norm(np.diff(places, axis=0), axis=-1) > _LEAP
    for column in range(places.shape[1]):
        here = seen[:, column]
        cut = np.ones(len(here) + 1, dtype=bool)
        cut[1:-1] = leaps[:, column] | (here[1:] != here[:-1])
        edges = np.flatnonzero(cut)
        found += [_Run(column, int(a), int(b) - 1, named) for a, b in pairwise(edges) if here[a]]
    return found


def _trusted(places: Array, seen: Mask, runs: list[_Run], noise: float) -> tuple[Mask, Correlation]:
    """(F, M) what is where its marker should be, and the correlation learnt from that alone."""
    good = _undoubted(places, runs, seen)
    correlation = learn(places, good, noise)
    for _ in range(_ROUNDS):
        apart = correlation.surprise(places, good)
        usual = np.nan_to_num(np.nanmedian(np.where(good, apart, np.nan), axis=0))
        unsure = correlation.predict(places, good)[1]
        before, good = good, seen.copy()
        for run in runs:
            there = run.frames, run.column
            limit = max(_ASTRAY, _ODD * usual[run.column], _ODD * np.median(unsure[there]))
            good[there] = np.median(apart[there]) <= limit
        if (good == before).all():
            break
        correlation = learn(places, good, noise)
    return good, correlation


def _undoubted(places: Array, runs: list[_Run], seen: Mask) -> Mask:
    """(F, M) the longest stretches without a leap that cover half of every column: two markers
    that are swapped together would explain each other if both were believed."""
    good = np.zeros_like(seen)
    for column in range(seen.shape[1]):
        chains: list[list[_Run]] = []
        for run in (run for run in runs if run.column == column):
            before = chains[-1][-1].last if chains else 0
            step = np.linalg.norm(places[run.first, column] - places[before, column])
            if chains and step < _LEAP:
                chains[-1].append(run)
            else:
                chains.append([run])
        lengths = [sum(run.last - run.first + 1 for run in chain) for chain in chains]
        for i in np.argsort(lengths)[::-1]:
            for run in chains[i]:
                good[run.frames, column] = True
            if 2 * good[:, column].sum() >= seen[:, column].sum():
                break
    return good


def _homes(away: dict[_Run, Array], guess: Array, good: Mask) -> dict[_Run, int]:
    """The marker each run belongs to, where one misses it: the nearest pairs first."""
    pairs = []
    for run, places in away.items():
        apart = np.median(np.linalg.norm(guess[run.frames] - places[:, None], axis=-1), axis=0)
        stay = apart[run.column] if run.named else np.inf
        for marker in np.flatnonzero(apart < min(_FITS, _BETTER * stay)).tolist():
            if not good[run.frames, marker].any():
                pairs.append((float(apart[marker]), run, marker))
    homes: dict[_Run, int] = {}
    for _, run, marker in sorted(pairs, key=lambda pair: pair[0]):
        if run not in homes and _free(marker, run, homes):
            homes[run] = marker
    for run, places in away.items():
        if run in homes or not run.named or run.last - run.first < _BRIEF:
            continue
        off = np.median(np.linalg.norm(guess[run.frames, run.column] - places, axis=-1))
        if off < _FAR and _free(run.column, run, homes):
            homes[run] = run.column
    return homes


def _free(marker: int, run: _Run, homes: dict[_Run, int]) -> bool:
    return not any(home == marker and run.meets(other) for other, home in homes.items())


def _events(
    astray: list[_Run],
    strangers: list[_Run],
    homes: dict[_Run, int],
    named: list[str],
    others: list[str],
) -> list[Event]:
    events = []
    for run in astray:
        label = named[run.column]
        if homes.get(run) == run.column:
            continue
        if run in homes:
            pair = tuple(sorted((label, named[homes[run]])))
            events.append(Event("swap", pair, run.first, run.last))
        else:
            kind = "jump" if run.last - run.first < _BRIEF else "stray"
            events.append(Event(kind, (label,), run.first, run.last))
    for run in strangers:
        found = run in homes
        whose = (named[homes[run]], others[run.column]) if found else (others[run.column],)
        events.append(Event("found" if found else "ghost", whose, run.first, run.last))
    return _joined(events)


def _joined(events: list[Event]) -> list[Event]:
    """Events of the same kind and markers that touch or overlap as one."""
    joined: list[Event] = []
    for event in sorted(events, key=lambda e: (e.kind, e.labels, e.first)):
        last = joined[-1] if joined else None
        same = last and (last.kind, last.labels) == (event.kind, event.labels)
        if last and same and event.first <= last.last + _BRIEF:
            joined[-1] = Event(event.kind, event.labels, last.first, max(last.last, event.last))
        else:
            joined.append(event)
    return sorted(joined, key=lambda e: e.first)

"""Which marker is which feature point: by its name, by the user's word, or by its place.

Names of markers follow habits, not a standard: "LBrowIn", "Leyebrow_Inside", "brow_inner_l",
"8.3". What a name leaves open is told from where the marker sits on the generic face.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from mien.numeric.procrustes import Similarity, align
from mien.vocabulary.fdp import feature_points

Array = NDArray[np.float64]

JIG, IGNORE = "jig", "-"
"""What a user's file may say of a marker in place of an FDP id."""

_RULES: tuple[tuple[str, str], ...] = (
    ("nostril|nosewing|alar", "9.1 9.2"),
    ("nose(root|top|bridge)|bridge", "9.7 9.6 9.12"),
    ("nose.*", "9.1 9.2 9.3"),
    ("brow.*(in|inner|inside|1)", "4.1 4.2"),
    ("brow.*(out|outer|outside|3)", "4.5 4.6"),
    ("brow(m|mid|middle|2)?", "4.3 4.4"),
    ("(eye|lid|canthus).*out(er|side)?", "3.7 3.12"),
    ("(eye|lid|canthus).*in(ner|side)?", "3.11 3.8"),
    ("(eye|lid).*(down|low|lower|bot|bottom)", "3.9 3.10"),
    ("(upper)?(eyelid|eye|lid)(up|upper|top)?", "3.13 3.14"),
    ("cheek(bone|up|upper|high)|malar|zygoma", "5.3 5.4"),
    ("cheek(down|low|lower|mid|m)?", "5.1 5.2"),
    ("(mouth|lips?).*(up|upper|top).*|upper(mouth|lips?)", "8.5 8.6 8.1"),
    ("(mouth|lips?).*(low|lower|down|bot|bottom).*|lower(mouth|lips?)", "8.7 8.8 8.2"),
    ("(mouth|lips?)(corner|end|side)?", "8.3 8.4"),
    ("chin(bot|bottom|low)?", "2.11 2.12 2.1"),
    ("chin(1|mid|m|boss)", "2.11 2.12 2.10"),
    ("jaw|chin2", "2.13 2.14"),
    ("(forehead|fh|front)(m|mid|middle)?", "11.3 11.2 11.1"),
)
"""What is left of a name without its side, and the points on the left, the right, the middle."""
_JIG_NAME = re.compile(r"jig|helmet|headband|rigid|^hd\d*$|^head(top|front|back|\d+)?$")
_PARTS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")
_GLUED = re.compile(r"([lr])((?:eye)?brow|eye|lid|cheek|mouth|lip|nose|nostril|jaw|chin|hd|fh|end)")
_SIDES = {"l": 0, "left": 0, "r": 1, "right": 1}
_NEAR = 12.0
"""mm on the generic face within which a marker is the feature point it sits at."""
_NOT_WORN = frozenset(
    ("2.2", "2.3", "2.4", "2.5", "2.6", "2.7", "2.8", "2.9", "3.1", "3.2", "3.3", "3.4", "3.5")
) | frozenset(("3.6", "7.1", "11.4", "11.5", "11.6", "9.8", "9.9", "9.10", "9.11"))
"""Inner lips, lid margins, pupils, teeth, and what is no skin of the face carry no markers."""


@dataclass(frozen=True, slots=True)
class Roles:
    """What the M columns of a take are."""

    labels: tuple[str, ...]
    """(M)"""
    fdp: tuple[str, ...]
    """(M) the feature point of each, or "": skin between feature points, jig, or nobody's."""
    jig: NDArray[np.bool_]
    """(M,) fixed to the skull."""
    nameless: NDArray[np.bool_]
    """(M,) no marker of the set: what it shows may be a ghost, or a marker that lost its name."""

    @property
    def face(self) -> NDArray[np.bool_]:
        """(M,) markers on the skin."""
        return ~self.jig & ~self.nameless

    def only(self, chosen: NDArray[np.bool_]) -> Roles:
        """The roles of the ``chosen`` (M,) columns."""
        rows = np.flatnonzero(chosen)
        return Roles(
            tuple(self.labels[i] for i in rows),
            tuple(self.fdp[i] for i in rows),
            self.jig[rows],
            self.nameless[rows],
        )


def name_roles(labels: Sequence[str], said: Mapping[str, str] | None = None) -> Roles:
    """Roles by name; ``said`` (label -> FDP id, "jig" or "-") comes first.

    Where two markers would be the same feature point, the first is; a label that comes again is
    nameless.
    """
    said = said or {}
    fdp: list[str] = []
    jig, nameless = np.zeros((2, len(labels)), dtype=bool)
    for i, label in enumerate(labels):
        role = said.get(label) or _named(label)
        nameless[i] = label.startswith("*") or label in labels[:i] or role == IGNORE
        jig[i] = role == JIG and not nameless[i]
        known = role in feature_points() and not nameless[i] and role not in fdp
        fdp.append(role if known else "")
    return Roles(tuple(labels), tuple(fdp), jig, nameless)


def place_roles(roles: Roles, places: Array, generic: Mapping[str, Array]) -> Roles:
    """``roles`` with feature points for markers whose name told none, by their neutral ``places``
    (M, 3) against those of the ``generic`` face, once enough are known to lay one on the other."""
    known = [i for i, f in enumerate(roles.fdp) if f in generic and np.isfinite(places[i]).all()]
    open_ = [i for i in np.flatnonzero(roles.face) if not roles.fdp[i]]
    open_ = [i for i in open_ if np.isfinite(places[i]).all()]
    free = [f for f in generic if f not in roles.fdp and f not in _NOT_WORN]
    if len(known) < 4 or not open_ or not free:
        return roles
    onto = fit_generic(roles.fdp, places, generic)
    apart = np.linalg.norm(
        onto(places[open_])[:, None] - np.stack([generic[f] for f in free])[None], axis=-1
    )
    fdp = list(roles.fdp)
    for row, column in zip(*linear_sum_assignment(np.minimum(apart, _NEAR)), strict=True):
        if apart[row, column] < _NEAR:
            fdp[open_[row]] = free[column]
    return replace(roles, fdp=tuple(fdp))


def fit_generic(fdp: Sequence[str], places: Array, generic: Mapping[str, Array]) -> Similarity:
    """The similarity that lays markers at neutral ``places`` (M, 3) on the ``generic`` face.
    Raises ValueError where fewer than three are known on both."""
    known = [i for i, f in enumerate(fdp) if f in generic and np.isfinite(places[i]).all()]
    return align(places[known], np.array([generic[fdp[i]] for i in known]).reshape(-1, 3))


def _named(label: str) -> str:
    """The FDP id a label speaks of, "jig", or ""."""
    dotted = re.search(r"(?<!\d)(\d{1,2})[._](\d{1,2})(?!\d)", label)
    if dotted and ".".join(dotted.groups()) in feature_points():
        return ".".join(dotted.groups())
    words = [word.lower() for word in _PARTS.findall(label)]
    words = [part for word in words for part in _unglued(word)]
    side = next((_SIDES[word] for word in words if word in _SIDES), 2)
    rest = "".join(word for word in words if word not in _SIDES)
    if _JIG_NAME.search(rest):
        return JIG
    if rest.startswith("eyebrow"):
        rest = rest[3:]
    for pattern, ids in _RULES:
        if re.fullmatch(pattern, rest):
            choices = ids.split()
            return choices[side] if side < len(choices) else ""
    return ""


def _unglued(word: str) -> tuple[str, ...]:
    """("l", "cheek") of "lcheek"."""
    glued = _GLUED.fullmatch(word)
    return glued.groups() if glued else (word,)

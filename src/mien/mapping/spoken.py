"""Weights that came under a vocabulary go unchanged to a character that speaks it."""

from __future__ import annotations

import numpy as np

from mien.face.character import Character
from mien.face.pieces import split
from mien.mapping.joint import head_on_neck
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.vocabulary.arkit import names

_WORDS = {"arkit": names}
"""What the columns of ``Performance.shapes`` are called, by vocabulary."""


def understood(performance: Performance, character: Character) -> bool:
    """Whether ``character`` speaks the vocabulary of ``performance``."""
    return performance.vocabulary in _WORDS and performance.vocabulary in character.speaks


def pass_through(performance: Performance, character: Character) -> Curves:
    """Curves with the performance's own weights; a word that several key models answer to drives
    them all, and one that none answers to is lost. Raises KeyError for an unknown vocabulary."""
    targets = split(character).names
    weights = np.zeros((len(performance), len(targets)))
    keys = character.speaks[performance.vocabulary]
    for column, word in enumerate(_WORDS[performance.vocabulary]()):
        for key in keys.get(word, ()):
            if key in targets:
                weights[:, targets.index(key)] = performance.shapes[:, column]
    rotation, translation = head_on_neck(performance, character.face)
    return Curves(
        character=character.name,
        names=targets,
        time=performance.time,
        weights=weights,
        rotation=rotation,
        translation=translation,
        gaze=performance.gaze,
        lost=performance.lost,
        residual=np.zeros(len(performance)),
    )

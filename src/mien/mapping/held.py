"""Faces that a performer held become own examples of the characters they are meant for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mien.errors import InputError
from mien.face.character import Character
from mien.face.pieces import split
from mien.mapping.lids import SCALARS
from mien.mapping.own import OwnExamples, frames_of
from mien.mapping.settings import Settings
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace


def with_held(
    settings: Settings, faces: Sequence[HeldFace], character: Character, header: Performance
) -> Settings:
    """``settings`` with those of ``faces`` as own examples that ``character`` can show; ``header``
    is any performance of the performer. Raises InputError where another capture saw them."""
    known = {*character.examples, *split(character).names}
    meant = [
        face for face in faces if face.character in ("", character.name) and set(face.pose) <= known
    ]
    return replace(settings, own=held_examples(header, meant)) if meant else settings


def held_examples(header: Performance, faces: Sequence[HeldFace]) -> OwnExamples:
    """Own examples from faces that were held. Raises InputError as ``with_held``."""
    if any(len(face.motion) != len(header.points) for face in faces):
        raise InputError("a held face was seen by another capture; hold it again with this one")
    first = frames_of(header, [0] * len(faces))
    closures = dict(zip(SCALARS, np.stack([face.lids for face in faces], axis=1), strict=True))
    moments = replace(
        first,
        motion=np.stack([face.motion for face in faces]),
        unseen=np.stack([face.unseen for face in faces]),
        lost=np.zeros(len(faces), dtype=bool),
        scalars={name: closures.get(name, values) for name, values in first.scalars.items()},
    )
    return OwnExamples(moments, tuple(face.pose for face in faces))

"""Which morph targets curves drive: a character's pieces by region or by wire, the FAPs, or its key
models as such."""

from __future__ import annotations

import numpy as np

from mien.face.character import Character, KeyModels
from mien.face.fap_targets import fap_models, is_fap
from mien.face.pieces import split
from mien.face.wires import is_wire_piece, wire_pieces


def targets(character: Character, names: tuple[str, ...]) -> KeyModels:
    """The targets called ``names`` (W), in that order. Raises ValueError for one that the
    character has not."""
    pieces, keys = split(character), character.keys
    if names == pieces.names:
        return KeyModels(names, pieces.displacements)
    if any(map(is_wire_piece, names)):
        hung = wire_pieces(character)
        if names == hung.names:
            return KeyModels(names, hung.displacements)
    known = dict(zip(keys.names, keys.displacements, strict=True))
    known |= dict(zip(pieces.names, pieces.displacements, strict=True))
    if not known.keys() >= set(names) and any(map(is_fap, names)):
        models = fap_models(character)
        if names == models.names:
            return models
        known |= dict(zip(models.names, models.displacements, strict=True))
    if not known.keys() >= set(names):
        raise ValueError(f"{character.name} lacks {', '.join(sorted(set(names) - known.keys()))}")
    return KeyModels(names, np.stack([known[name] for name in names]))

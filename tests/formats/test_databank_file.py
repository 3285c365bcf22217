"""Databanks survive their file, and are characters to everybody else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mien.errors import FormatError
from mien.face.character import Character
from mien.face.databank import databank
from mien.face.library import load_character
from mien.face.store import write_character
from mien.formats.databank_file import read_databank, write_databank


def test_a_databank_reads_back(toy_face: Character, tmp_path: Path) -> None:
    bank = databank(toy_face)
    write_databank(tmp_path / "bank.npz", bank)
    again = read_databank(tmp_path / "bank.npz")
    assert (again.name, again.names) == (bank.name, bank.names)
    assert np.abs(again.displacements - bank.displacements).max() < 0.001
    assert np.abs(again.face.vertices - bank.face.vertices).max() < 1e-4


def test_a_databank_is_a_character(toy_face: Character, tmp_path: Path) -> None:
    write_databank(tmp_path / "bank.npz", databank(toy_face))
    character = load_character(tmp_path / "bank.npz")
    assert character.examples == character.keys.names == toy_face.examples


def test_a_neutral_alone_is_no_databank(toy_face: Character, tmp_path: Path) -> None:
    write_character(tmp_path / "bare.npz", replace(toy_face, examples=()))
    with pytest.raises(FormatError, match="no faces"):
        read_databank(tmp_path / "bare.npz")

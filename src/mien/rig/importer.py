"""A character from somebody's file, ready to act."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from mien.errors import InputError
from mien.face.character import Character
from mien.face.model import Model
from mien.formats.gltf.read import read_gltf
from mien.formats.gltf.vrm import LOOKS, read_vrm
from mien.formats.meshes.character_folder import read_folder, read_obj_model
from mien.formats.meshes.lengths import UNITS
from mien.rig.acts import Act, blinks, measure
from mien.rig.build import build, facing, pupils_apart
from mien.rig.mixtures import silent
from mien.rig.picks import Picks, read_picks
from mien.rig.said import NOTHING, Said, meant, read_said, with_nodes
from mien.rig.spoken import arkit_keys, disagreements

FORMATS: Mapping[str, Callable[[Path], Model]] = {
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".vrm": read_vrm,
    ".obj": read_obj_model,
}
"""How a file is read, by its ending; a folder holds OBJ files."""
ANY_SIZE = "face"
"""The unit of a face whose size does not count."""
_ASK_UNIT = (
    f"take it in by 'mien character import' with --units {', '.join(UNITS)}, or {ANY_SIZE} where "
    "the size does not count"
)
_HUMAN = (35.0, 110.0)
"""mm between the pupils of what may be a face, where a file says metres."""


@dataclass(frozen=True, slots=True)
class Import:
    """A character, and what was found out about it."""

    character: Character
    acts: tuple[Act, ...]
    """Of its key models, in their order."""
    facing: int
    """1 where it looks to +z in its own file, -1 to -z."""
    notes: tuple[str, ...]
    """What was mended, odd or doubtful, for a person to read."""
    model: Model
    """What the file holds."""


def readable(path: Path) -> bool:
    """Whether ``path`` is of a kind that is imported."""
    return path.is_dir() or path.suffix.lower() in FORMATS


def read_model(path: Path) -> Model:
    """What a file or folder holds. Raises InputError, FormatError."""
    if path.is_dir():
        return read_folder(path)
    if not path.exists():
        raise InputError(f"{path}: no such file")
    read = FORMATS.get(path.suffix.lower())
    if read is None:
        raise InputError(
            f"{path}: characters come as {', '.join(FORMATS)} or a folder of OBJ files"
        )
    return read(path)


def import_character(
    path: Path,
    *,
    points: Path | None = None,
    units: str | None = None,
    meanings: Path | None = None,
    name: str | None = None,
) -> Import:
    """Read a character and find out what it can do.

    ``points`` is a file of feature points (found by looking otherwise), ``units`` "m", "cm",
    "mm" ... or "face" where the size does not count, ``meanings`` a file that says what shapes
    mean and which nodes turn head and eyes (``rig.said``). Raises InputError, FormatError,
    NoFaceError, MissingExtraError.
    """
    model = read_model(path)
    said = read_said(meanings) if meanings is not None else Said({}, {})
    model = with_nodes(model, said, path)
    picks = read_picks(points) if points is not None else _seen(model, path)
    unit = _unit(model, picks, units, path)
    character = build(model, picks, unit, seen=points is None)
    character = replace(character, name=name or model.name)
    return _finish(character, model, meant(said, model), facing(picks))


def _finish(
    character: Character, model: Model, meanings: Mapping[str, str], towards: int
) -> Import:
    """Measure what each key model does, and choose by which ones it acts."""
    acts = measure(character)
    unheard = silent(character, model.shapes, acts)
    looks = {way: key for way, key in LOOKS.items() if key in character.keys.names}
    by_gaze = set(looks.values()) if model.hooks.vrm is not None else set()
    acting = [
        act.name
        for act in acts
        if meanings.get(act.name, "" if act.still else act.name)
        and act.name not in unheard | by_gaze
        and meanings.get(act.name) != NOTHING
    ]
    rest = [act.name for act in acts if act.still and act.name not in {*meanings, *unheard}]
    notes = [*model.notes, *disagreements(acts)]
    if unheard:
        notes.append(f"{', '.join(sorted(unheard))}: shown by what they mix or are mixed into")
    if rest:
        notes.append(f"no performance reaches {', '.join(sorted(rest))}: no feature point moves")
    spoken = arkit_keys(acts)
    character = replace(
        character,
        examples=tuple(acting),
        blinks=blinks(tuple(act for act in acts if act.name in acting)),
        meanings={key: word for key, word in meanings.items() if word != NOTHING},
        speaks={"arkit": spoken} if spoken else {},
        looks=looks if by_gaze else {},
    )
    return Import(character, acts, towards, tuple(notes), model)


def _seen(model: Model, path: Path) -> Picks:
    from mien.rig.sight import find_points  # the renderer and the network behind it are heavy

    return find_points(model, path)


def _unit(model: Model, picks: Picks, units: str | None, path: Path) -> float | None:
    """Millimetres in a unit of the file, None where the size does not count."""
    if units == ANY_SIZE:
        return None
    if units is not None:
        if units not in UNITS:
            raise InputError(f"--units {units}: there are {', '.join(UNITS)} and {ANY_SIZE}")
        return UNITS[units]
    if model.unit is not None:
        apart = pupils_apart(picks) * model.unit
        if model.hooks.vrm is not None or _HUMAN[0] < apart < _HUMAN[1]:
            return model.unit
        raise InputError(
            f"{path}: its unit cannot be told (in metres its eyes are {apart:.4g} mm apart); "
            + _ASK_UNIT
        )
    raise InputError(f"{path}: its unit cannot be told; {_ASK_UNIT}")

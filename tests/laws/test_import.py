"""Laws of imported characters: sides by measurement, names for nothing, weights unchanged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mien
from actors import shown
from guests import SHAPES, edited, guest, write_guest
from mien.errors import FormatError, InputError
from mien.face.character import Character
from mien.face.pieces import split
from mien.face.store import read_character, write_character
from mien.performance.acted import acted
from mien.performance.performance import Performance
from mien.rig.importer import Import, import_character
from mien.vocabulary.arkit import face_shapes, names


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Import:
    path, points = write_guest(tmp_path_factory.mktemp("guest"))
    return import_character(path, points=points)


@pytest.fixture(scope="module")
def performance() -> Performance:
    """A left wink, a smile of the left, an open mouth, brows, all in turn."""
    who = guest()
    weights = np.eye(len(SHAPES))
    return shown(who, weights)


def test_the_head_comes_back(imported: Import) -> None:
    face, known = imported.character.face, guest().face
    for eye in ("eye_left", "eye_right"):
        assert np.allclose(face.pivots[eye], known.pivots[eye], atol=0.5)
    for fdp in face.points.ids:
        if fdp in known.points.ids and fdp not in ("3.5", "3.6"):
            away = np.linalg.norm(face.point(fdp) - known.point(fdp))
            assert away < 8.0, fdp
    assert imported.facing == 1


def test_what_a_shape_does_is_measured(imported: Import) -> None:
    acts = {act.name: act for act in imported.acts}
    assert imported.character.blinks == {"eyeBlinkLeft", "eyeBlinkRight"}
    for name in SHAPES:
        side = next((s for s in ("Left", "Right") if name.endswith(s)), "both").lower()
        assert acts[name].side == side, name
        assert acts[name].like == name
        assert acts[name].confidence > 0.6
    assert acts["eyeBlinkLeft"].shuts[0] == pytest.approx(1.0, abs=0.25)
    assert acts["eyeBlinkLeft"].shuts[1] < 0.05


def test_a_left_wink_stays_left(imported: Import, performance: Performance) -> None:
    curves = mien.animate(performance, imported.character, smooth=False)
    wink = dict(zip(curves.names, curves.weights[SHAPES.index("eyeBlinkLeft")], strict=True))
    assert wink["eyeBlinkLeft"] > 0.6
    assert wink["eyeBlinkRight"] < 0.1


def test_names_and_order_mean_nothing(
    imported: Import, performance: Performance, tmp_path: Path
) -> None:
    order = np.random.default_rng(3).permutation(len(SHAPES))
    called = [f"x{k}" for k in range(len(SHAPES))]
    path, points = write_guest(tmp_path, [SHAPES[k] for k in order], called)
    other = import_character(path, points=points).character
    first = mien.animate(performance, imported.character)
    second = mien.animate(performance, other)
    own = dict(zip(called, (SHAPES[k] for k in order), strict=True))
    assert tuple(own[name] for name in second.names) == first.names
    assert second.weights.tobytes() == first.weights.tobytes()


def test_swapped_names_are_reported_and_not_obeyed(
    imported: Import, performance: Performance, tmp_path: Path
) -> None:
    known = face_shapes()
    path, points = write_guest(tmp_path, SHAPES, [_mirror(name) for name in SHAPES])
    found = import_character(path, points=points)
    told = " ".join(found.notes)
    assert "eyeBlinkRight moves the other side" in told
    assert "jawOpen" not in told
    curves = mien.animate(performance, found.character, smooth=False)
    wink = dict(zip(curves.names, curves.weights[SHAPES.index("eyeBlinkLeft")], strict=True))
    assert wink["eyeBlinkRight"] > 0.6 > 0.1 > wink["eyeBlinkLeft"]
    assert known["eyeBlinkLeft"].mirror == "eyeBlinkRight"


def _mirror(name: str) -> str:
    return face_shapes()[name].mirror


def test_a_vocabulary_passes_through_unchanged(tmp_path: Path) -> None:
    many = tuple(name for name in names() if name != "tongueOut")[:30]
    spelled = [_blender(name) for name in many]
    path, points = write_guest(tmp_path, many, spelled)
    character = import_character(path, points=points).character
    shapes = np.random.default_rng(1).uniform(0, 1, (5, len(names())))
    still = acted((), np.zeros((0, 3)), np.zeros((5, 0, 3)), sigma=np.zeros(0))
    curves = mien.animate(replace(still, vocabulary="arkit", shapes=shapes), character)
    for name, called in zip(many, spelled, strict=True):
        if called in curves.names:
            column = curves.weights[:, curves.names.index(called)]
            assert np.array_equal(column, shapes[:, names().index(name)]), name
    assert len(curves.names) >= 28


def _blender(name: str) -> str:
    return name.removesuffix("Left").removesuffix("Right") + {
        "Left": "_L",
        "ight": "_R",
    }.get(name[-4:], "")


def test_a_character_file_keeps_everything(imported: Import, tmp_path: Path) -> None:
    write_character(tmp_path / "g.character", imported.character)
    again = mien.load_character(tmp_path / "g.character")
    _alike(again, imported.character)
    assert again.origin is not None
    assert imported.character.origin is not None
    assert again.origin.glb == imported.character.origin.glb
    assert again.origin.binds == imported.character.origin.binds
    assert read_character(tmp_path / "g.character").blinks == imported.character.blinks


def _alike(found: Character, wanted: Character) -> None:
    assert found.keys.names == wanted.keys.names
    assert found.examples == wanted.examples
    assert found.whole
    assert found.speaks == wanted.speaks
    assert np.allclose(found.keys.displacements, wanted.keys.displacements, atol=2e-3)
    assert split(found).side.tolist() == split(wanted).side.tolist()


def test_a_map_says_what_measuring_cannot(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    said = tmp_path / "map.toml"
    said.write_text('[shapes]\n"noseSneerLeft" = "nothing"\n"mouthPucker" = "jawOpen"\n')
    found = import_character(path, points=points, meanings=said).character
    assert "noseSneerLeft" not in found.examples
    assert found.meanings == {"mouthPucker": "jawOpen"}
    opened = shown(guest(), np.eye(len(SHAPES))[[SHAPES.index("jawOpen")]])
    without = replace(found, examples=tuple(n for n in found.examples if n != "jawOpen"))
    curves = mien.animate(opened, without, smooth=False)
    assert curves.weights[0, curves.names.index("mouthPucker")] > 0.5
    for wrong in ('[shapes]\nx = "jawOpen"\n', '[shapes]\njawOpen = "yodel"\n', "[shapes", "a = 1"):
        said.write_text(wrong)
        with pytest.raises(InputError):
            import_character(path, points=points, meanings=said)


def test_units_are_found_or_asked(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path, size=10.0)
    with pytest.raises(InputError, match="--units"):
        import_character(path, points=points)
    with pytest.raises(InputError, match="--units furlong"):
        import_character(path, points=points, units="furlong")
    big = import_character(path, points=points, units="m").character.face
    small = import_character(path, points=points, units="dm").character.face
    assert np.ptp(big.vertices[:, 1]) == pytest.approx(10 * np.ptp(small.vertices[:, 1]))
    any_size = import_character(path, points=points, units="face").character.face
    apart = any_size.pivots["eye_left"][0] - any_size.pivots["eye_right"][0]
    assert apart == pytest.approx(63.0, rel=0.1)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[points]\n", "no .points."),
        ('[points]\n"9.99" = [0, 0, 0]\n', "no feature point"),
        ('[points]\n"9.3" = [0, 0]\n', "not at"),
        ('[points]\n"9.3" = [0, 0, nan]\n', "not at"),
        ('[points]\n"9.3" = [0, 0, 1]\n', "is missing"),
        ("[points", "not TOML"),
    ],
)
def test_bad_points_are_refused(text: str, told: str, tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    points.write_text(text)
    with pytest.raises((InputError, FormatError), match=told):
        import_character(path, points=points)


def test_points_on_the_wrong_side_are_refused(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path, flip=-1.0)
    with pytest.raises(InputError, match="subject's right"):
        import_character(path, points=points)


def test_nodes_are_named_where_they_cannot_be_found(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    edited(path, lambda told: [n.update(name=f"n{i}") for i, n in enumerate(told["nodes"])])
    plain = import_character(path, points=points).character.origin
    assert plain is not None
    # Eyeballs nobody named are known by their being round, and get nodes.
    assert None not in plain.hooks.eyes
    said = tmp_path / "map.toml"
    said.write_text('[nodes]\nhead = "n0"\neye_left = "n2"\n')
    named = import_character(path, points=points, meanings=said).character.origin
    assert named is not None
    assert (named.hooks.head, named.hooks.eyes) == (0, (2, None))
    for wrong in ('[nodes]\nhead = "n99"\n', '[nodes]\ntail = "n0"\n', "[nodes]\nhead = 3\n"):
        said.write_text(wrong)
        with pytest.raises(InputError):
            import_character(path, points=points, meanings=said)


def test_a_shut_eye_is_the_whole_blink(imported: Import, performance: Performance) -> None:
    lids = {"lid_left": np.ones(len(SHAPES)), "lid_right": np.zeros(len(SHAPES))}
    curves = mien.animate(replace(performance, scalars=lids), imported.character, smooth=False)
    still = SHAPES.index("jawOpen")
    weights = dict(zip(curves.names, curves.weights[still], strict=True))
    assert weights["eyeBlinkLeft"] == pytest.approx(1.0, abs=0.05)
    assert weights["eyeBlinkRight"] < 0.05

"""What FAPs do to a face: points go where values say, lids and lips stay lids and lips."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from actors import built_in
from mien.errors import InputError
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.fap_basis import CORNERS, LIDS, fap_basis
from mien.face.fap_targets import SLIDES, basis_of, fap_models, fap_weights
from mien.face.targets import targets
from mien.sculpt import soundness
from mien.sculpt.anatomy.skin import labels
from mien.vocabulary.fap import column, expressions, faps, simple, visemes
from mien.vocabulary.fdp import feature_points

FACES = ("generic", "man", "woman", "monkey", "toy")
CARRIED = {"2.10"}
"""The chin's boss goes with the jaw, though another FAP moves it too."""
everyone = pytest.mark.parametrize("name", FACES)


def values(**faps_by_number: float) -> np.ndarray:
    """(1, 66) from f3=100, ..."""
    found = np.zeros((1, 66))
    for name, value in faps_by_number.items():
        found[0, column(int(name[1:]))] = value
    return found


def posed(character: Character, wanted: np.ndarray) -> np.ndarray:
    """(V, 3) mm at one frame of FAP values (1, 66)."""
    poser = Poser(character.face, fap_models(character))
    return poser.pose(fap_weights(character, wanted)[0])


@everyone
def test_each_fap_moves_its_own_point_by_its_value(name: str) -> None:
    face, basis = built_in(name).face, basis_of(built_in(name))
    at = face.points.at(basis.fields)
    for fap in simple():
        i = column(fap.number)
        if fap.axis is None:
            continue
        wanted = np.zeros(3)
        wanted[fap.axis] = fap.sign * basis.size[i]
        off = at[i, face.points.index([fap.point])[0]] - wanted
        assert np.abs(off).max() < 0.01 * basis.size[i], (fap.number, off)


@everyone
def test_no_fap_moves_a_point_along_an_axis_that_is_anothers(name: str) -> None:
    face, basis = built_in(name).face, basis_of(built_in(name))
    at = face.points.at(basis.fields)
    for fap in simple():
        if fap.axis is None or fap.number in LIDS or fap.point in ("3.5", "3.6"):
            continue
        others = {
            o.point
            for o in simple()
            if o.axis == fap.axis and o.point != fap.point and o.group not in (3, 6, 10)
        } - (CARRIED if fap.point == "2.1" else set())
        moved = at[column(fap.number), face.points.index(sorted(others)), fap.axis]
        assert np.abs(moved).max() < 0.01 * basis.size[column(fap.number)], fap.number


@everyone
def test_the_mirrored_fap_is_the_mirror(name: str) -> None:
    face, basis = built_in(name).face, basis_of(built_in(name))
    at = face.points.at(basis.fields)
    moved = sorted({fap.point for fap in simple()} | {"6.4", "2.11", "2.12", "8.9", "8.10"})
    rows = face.points.index(moved)
    partner = face.points.index([feature_points()[fdp].mirror for fdp in moved])
    for fap in simple():
        i, j = column(fap.number), column(fap.mirror)
        off = fap.mirror_sign * at[i][partner] * [-1, 1, 1] - at[j][rows]
        # The tongue's triangles are not quite mirrored.
        most = 0.05 if fap.group == 6 else 0.01
        assert np.abs(off).max() <= most * np.abs(at[j]).max(), fap.number


@everyone
def test_what_turns_has_no_field_and_pupils_and_tongues_have(name: str) -> None:
    character, basis = built_in(name), basis_of(built_in(name))
    for fap in simple():
        assert basis.fields[column(fap.number)].any() != fap.motion.startswith("turn")
    eye = character.face.part("eye_left")
    assert basis.fields[column(29), eye.first : eye.last].any()
    assert not basis.fields[column(30), eye.first : eye.last].any()


def test_faps_do_not_know_how_large_a_face_is() -> None:
    face = built_in("man").face
    large = replace(
        face,
        vertices=1.3 * face.vertices,
        pivots={name: 1.3 * place for name, place in face.pivots.items()},
    )
    small_at, large_at = (
        f.points.at(fap_basis(f).fields[[column(n) for n in (3, 5, 6, 31, 39, 53, 61)]])
        for f in (face, large)
    )
    np.testing.assert_allclose(large_at, 1.3 * small_at, atol=0.02 * np.abs(small_at).max())


def test_a_face_that_is_cut_where_its_texture_is_moves_as_one() -> None:
    face = built_in("man").face
    skin = face.part("skin")
    left = (face.vertices[skin.triangles][..., 0] > -1e-6).all(axis=1)
    seam = np.intersect1d(skin.triangles[left], skin.triangles[~left])
    twin = np.arange(len(face.vertices))
    twin[seam] = len(face.vertices) + np.arange(len(seam))
    # The twins go behind the last part: the skin is made that, so that its vertices are a run.
    order = np.r_[skin.last : len(face.vertices), skin.first : skin.last, twin[seam]]
    place = np.argsort(order)
    cut = skin.triangles.copy()
    cut[~left] = twin[cut[~left]]
    shift = skin.last - skin.first
    others = [
        replace(p, first=p.first - shift, last=p.last - shift, triangles=place[p.triangles])
        for p in face.parts
        if p.name != "skin"
    ]
    last = replace(
        skin, first=len(place) - shift - len(seam), last=len(place), triangles=place[cut]
    )
    source = np.r_[np.arange(len(face.vertices)), seam][order]
    in_two = replace(
        face,
        vertices=face.vertices[source],
        parts=(*others, last),
        colours=face.colours[source],
        occlusion=face.occlusion[source],
        uv=None,
        points=replace(face.points, vertices=place[face.points.vertices]),
    )
    whole, found = basis_of(built_in("man")), fap_basis(in_two)
    off = np.abs(found.fields - whole.fields[:, source]).max(axis=(1, 2))
    assert (off <= 1e-3 * np.abs(whole.fields).max(axis=(1, 2)) + 1e-9).all()


@everyone
def test_lids_slide_on_the_eyeball_and_shut(name: str) -> None:
    character = built_in(name)
    face, skin = character.face, character.face.part("skin")
    outer = (labels().lid_inside < 0.02) & (labels().mask > 0.9)

    def nearest(vertices: np.ndarray) -> float:
        places = vertices[skin.first : skin.last][outer]
        balls = (face.pivots["eye_left"], face.pivots["eye_right"])
        return min(float(np.linalg.norm(places - ball, axis=1).min()) for ball in balls)

    rest = nearest(face.vertices)
    for part in (-0.2, 0.25, 0.5, 0.75, 1.0):
        shown = posed(character, values(f19=1024 * part, f20=1024 * part))
        assert nearest(shown) > rest - 0.4, part
    for lower in (0, 300):
        shut = posed(character, values(f19=1024 - lower, f20=1024 - lower, f21=lower, f22=lower))
        for side in (0, 1):
            assert soundness.lid_gap(shut[skin.first : skin.last], side) < 0.3
    # More than shut is shut.
    more = posed(character, values(f19=1400.0, f20=1400.0, f21=200.0, f22=200.0))
    exactly = posed(character, values(f19=824.0, f20=824.0, f21=200.0, f22=200.0))
    np.testing.assert_allclose(more, exactly, atol=1e-4)


@everyone
def test_lips_meet_and_teeth_stay_inside(name: str) -> None:
    character = built_in(name)
    face, skin = character.face, character.face.part("skin")
    teeth = [part for part in face.parts if part.name.startswith("teeth")]
    rest = soundness.lip_overlap(face.vertices[skin.first : skin.last])
    for what, shown in {**visemes(), **expressions()}.items():
        places = posed(character, shown[None])
        lips = places[skin.first : skin.last]
        assert soundness.lip_overlap(lips) < max(0.5, rest + 0.2), what
        for part in teeth:
            through = soundness.teeth_through(lips, places[part.first : part.last])
            assert through < 0.3, (what, part.name)
    pressed = values(f4=300.0, f5=300.0, f8=300.0, f10=300.0, f9=300.0, f11=300.0)
    lips = posed(character, pressed)[skin.first : skin.last]
    assert soundness.lip_overlap(lips) < max(0.5, rest + 0.2)


def test_the_jaw_takes_teeth_and_tongue_along_and_leaves_the_lips() -> None:
    man = built_in("man")
    moved = posed(man, values(f3=600.0)) - man.face.vertices
    drop = 600 / 1024 * basis_of(man).fapu.philtrum
    for name, part in ((p.name, p) for p in man.face.parts):
        down = -moved[part.first : part.last, 1]
        if name in ("teeth_lower", "tongue"):
            assert down.min() > 0.3 * drop
        if name in ("teeth_upper", "hair", "bust"):
            assert np.abs(down).max() == 0.0
    lips = man.face.points.at(moved)[man.face.points.index(["2.2", "2.3", "8.1", "8.2"])]
    assert np.abs(lips[:, 1]).max() < 0.01 * drop


def test_targets_are_named_as_the_standard_names_them() -> None:
    woman = built_in("woman")
    models = fap_models(woman)
    assert set(SLIDES) < set(models.names)
    assert {faps()[n].name for n in (3, 31, 53)} < set(models.names)
    assert targets(woman, models.names) is models
    weights = fap_weights(woman, values(f31=200.0, f6=-125.0, f53=-125.0))[0]
    found = dict(zip(models.names, weights, strict=True))
    assert found["raise_l_i_eyebrow"] == pytest.approx(200 / faps()[31].reach)
    assert found["slide_l_cornerlip"] == pytest.approx(-125 / faps()[CORNERS[0][0]].reach)
    assert not fap_weights(woman, values())[0].any()


def test_a_face_without_the_points_is_told(toy_face: Character) -> None:
    with pytest.raises(InputError, match=r"toy_face: 13 feature points .* are missing: 2\.4, "):
        fap_models(toy_face)

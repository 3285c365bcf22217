"""FAPs as the standard has them: the table, compounds, head and gaze, and what a take becomes."""

from __future__ import annotations

import numpy as np
import pytest

from mien.capture.fap import motion_from_faps, perform
from mien.errors import InputError
from mien.face.library import generic_face
from mien.formats.takes.fap import FapTake
from mien.numeric.rotation import from_vector
from mien.performance.acted import acted
from mien.vocabulary.fap import (
    column,
    expression_values,
    expressions,
    faps,
    head_and_gaze,
    mirrored,
    names,
    simple,
    viseme_values,
    visemes,
    with_head_and_gaze,
)
from mien.vocabulary.fdp import feature_points


def take(values: np.ndarray, given: list[int] | None = None, **compounds: np.ndarray) -> FapTake:
    """``values`` (F, 68) at 25 frames a second; all FAPs but 1 and 2 are ``given``, or those."""
    frames = len(values)
    mask = np.zeros((frames, 68), dtype=bool)
    mask[:, slice(2, 68) if given is None else [number - 1 for number in given]] = True
    return FapTake(
        rate=25.0,
        number=np.arange(frames),
        mask=mask,
        values=values,
        viseme=compounds.get("viseme", np.zeros((frames, 4))),
        expression=compounds.get("expression", np.zeros((frames, 6))),
    )


def test_there_are_68_and_each_moves_its_point() -> None:
    table, points = faps(), feature_points()
    assert list(table) == list(range(1, 69))
    assert len(set(names())) == 66
    for fap in simple():
        assert fap.number in points[fap.point].faps or fap.point == "6.3"
        assert fap.group == points[fap.point].group
        assert fap.lower <= 0.0 < fap.upper
    assert table[37].axis == 0
    assert table[37].sign == -1.0  # the left brow goes to the right, to the nose
    assert table[18].sign == 1.0  # "depress_chin" raises the chin's boss


def test_mirrors_are_partners_and_mirror_twice_is_nothing() -> None:
    for fap in simple():
        partner = faps()[fap.mirror]
        assert (partner.mirror, partner.mirror_sign) == (fap.number, fap.mirror_sign)
        assert feature_points()[fap.point].mirror == partner.point or fap.point == "6.3"
        flip = -1.0 if fap.axis == 0 or fap.motion in ("turn +y", "turn +z") else 1.0
        assert fap.mirror_sign * partner.sign == flip * fap.sign
        bounds = sorted((fap.mirror_sign * fap.lower, fap.mirror_sign * fap.upper))
        assert bounds == [partner.lower, partner.upper]
    values = np.random.default_rng(1).normal(size=(4, 66))
    np.testing.assert_array_equal(mirrored(mirrored(values)), values)


def test_visemes_and_expressions_are_within_what_faces_can_do() -> None:
    assert len(visemes()) == 14
    assert list(expressions()) == ["joy", "sadness", "anger", "fear", "disgust", "surprise"]
    for values in (*visemes().values(), *expressions().values()):
        np.testing.assert_array_equal(mirrored(values), values)
        for value, fap in zip(values, simple(), strict=True):
            assert fap.lower <= value <= fap.upper


def test_compounds_blend_by_63rds() -> None:
    a, u = visemes()["a"], visemes()["u"]
    np.testing.assert_allclose(viseme_values([10], [14], [63.0]), [a])
    np.testing.assert_allclose(viseme_values([10], [14], [21.0]), [a / 3 + 2 * u / 3])
    np.testing.assert_allclose(viseme_values([0], [14], [63.0]), [0 * u])
    joy, fear = expressions()["joy"], expressions()["fear"]
    np.testing.assert_allclose(expression_values([1], [63], [4], [21]), [joy + fear / 3])


def test_head_and_gaze_have_the_standards_signs() -> None:
    values = np.zeros((3, 66))
    values[0, column(48)] = values[1, column(49)] = values[2, column(50)] = 30000.0
    rotation, _ = head_and_gaze(values)
    for found, axis in zip(rotation, np.eye(3), strict=True):
        np.testing.assert_allclose(found, from_vector(0.3 * axis), atol=1e-12)
    assert (rotation[0] @ [0, 0, 1])[1] < 0  # plus nods down
    assert (rotation[1] @ [0, 0, 1])[0] > 0  # plus turns to its own left
    assert (rotation[2] @ [0, 1, 0])[0] < 0  # plus leans to its own right
    values[:] = 0.0
    values[0, column(23)], values[1, column(26)] = 20000.0, 20000.0
    _, gaze = head_and_gaze(values)
    assert gaze[0, 0, 0] == pytest.approx(0.2)  # to the left
    assert gaze[1, 1, 1] == pytest.approx(-0.2)  # down
    random = np.random.default_rng(2).uniform(-60000, 60000, (5, 66))
    again = with_head_and_gaze(np.zeros((5, 66)), *head_and_gaze(random))
    turned = [column(number) for number in (*range(23, 27), *range(48, 51))]
    np.testing.assert_allclose(again[:, turned], random[:, turned], atol=1e-6)


def test_visemes_and_expressions_add_to_what_is_said_simply() -> None:
    values = np.zeros((2, 68))
    values[:, 30] = 40.0
    viseme = np.array([[10.0, 0, 63, 0], [10, 0, 63, 1]])
    found = perform(take(values, viseme=viseme), "x").shapes
    assert found[0, column(31)] == 40.0
    assert found[0, column(3)] == visemes()["a"][column(3)]
    assert found[1, column(3)] == 0.0  # a definition: the simple values are the viseme


def test_an_edge_of_the_lips_that_is_never_given_follows_the_other() -> None:
    values = np.zeros((2, 68))
    values[1, 4 - 1], values[1, 6 - 1] = 30.0, -20.0
    found = perform(take(values, given=[4, 6]), "x").shapes
    assert (found[1, column(51)], found[1, column(53)]) == (30.0, -20.0)
    both = perform(take(values, given=[4, 6, 51]), "x").shapes
    assert (both[1, column(51)], both[1, column(53)]) == (0.0, 0.0)


def test_frames_that_are_missing_leave_a_gap_in_time() -> None:
    spread = take(np.zeros((3, 68)))
    object.__setattr__(spread, "number", np.array([4, 5, 30]))
    np.testing.assert_allclose(perform(spread, "x").time, [0.0, 0.04, 1.04])


def test_values_move_the_points_of_the_generic_face() -> None:
    values = np.zeros((2, 68))
    values[1, 19 - 1], values[1, 21 - 1], values[1, 31 - 1] = 700.0, 100.0, 200.0
    generic = generic_face()
    found = motion_from_faps(perform(take(values), "x"), generic)
    assert not found.motion[0].any()
    inner = found.motion[1, found.points.index("4.1")]
    length = generic.face.point("3.5")[1] - generic.face.point("9.15")[1]
    np.testing.assert_allclose(inner, [0, 200 / 1024 * length, 0], atol=0.01 * length)
    assert found.scalars["lid_left"][1] == pytest.approx(800 / 1024)
    assert found.scalars["lid_right"][1] == 0.0


def test_another_number_of_values_is_no_take_of_faps() -> None:
    still = acted((), np.zeros((0, 3)), np.zeros((2, 0, 3)), sigma=np.zeros(0))
    object.__setattr__(still, "shapes", np.zeros((2, 52)))
    with pytest.raises(InputError, match="expected 66"):
        motion_from_faps(still, generic_face())

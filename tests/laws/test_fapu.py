"""Laws of the units faces are compared by, and of the points they are measured at."""

from __future__ import annotations

import math
from dataclasses import astuple

import numpy as np
import pytest

from actors import built_in
from mien.mapping.size import scales
from mien.vocabulary.fapu import measure
from mien.vocabulary.fdp import feature_points


def test_the_standard_has_84_points_that_mirror_onto_each_other() -> None:
    points = feature_points()
    assert len(points) == 84
    for fdp, point in points.items():
        partner = points[point.mirror]
        assert points[partner.mirror].id == fdp
        assert {point.side, partner.side} in ({"left", "right"}, {"centre"})
    assert points["8.9"].side == "right"  # even or odd tells nothing
    assert points["8.3"].faps == (53, 59)


def test_units_are_lengths_of_the_neutral() -> None:
    ids = ("3.1", "3.3", "3.2", "3.4", "3.5", "3.6", "9.15", "2.2", "8.3", "8.4")
    places = np.array(
        [
            (32, 5, 0), (32, -6, 0), (-32, 4, 0), (-32, -5, 0), (31.5, 0, 0), (-31.5, 0, 0),
            (0, -40, 9), (0, -60, 9), (26, -62, 0), (-25, -62, 0),
        ],
        dtype=float,
    )  # fmt: skip
    assert astuple(measure(ids, places)) == pytest.approx((10.0, 63.0, 40.0, 20.0, 51.0))


def test_a_length_whose_points_are_missing_is_not_a_number() -> None:
    units = measure(("8.3", "8.4"), np.array([[25.0, 0, 0], [-25.0, 0, 0]]))
    assert units.mouth == 50.0
    assert math.isnan(units.eyes)
    assert math.isnan(units.iris)


@pytest.mark.parametrize("missing", [(), ("3.5", "3.6"), ("8.3",)])
def test_a_face_twice_the_size_moves_twice_as_far(missing: tuple[str, ...]) -> None:
    points = built_in("man").face.points
    ids = tuple(fdp for fdp in points.ids if fdp not in missing)
    places = points.at(built_in("man").face.vertices)[points.index(ids)]
    assert scales(ids, 2.0 * places, places) == pytest.approx(2.0)


def test_lips_go_by_mouth_width_and_brows_by_the_nose() -> None:
    points = built_in("man").face.points
    places = points.at(built_in("man").face.vertices)
    wide = places.copy()
    lips = [i for i, fdp in enumerate(points.ids) if fdp.startswith("8.")]
    wide[lips, 0] *= 1.5
    factors = scales(points.ids, wide, places)
    assert factors[points.index(["8.1"])[0]] == pytest.approx(1.5)
    assert factors[points.index(["4.3"])[0]] == pytest.approx(1.0)

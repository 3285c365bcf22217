"""``.fdp`` files: the points of others' faces, by either kind; damage told in one line."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError
from mien.formats.fdp import read_fdp

XFACE = """<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<xfdp>
  <head><file version="0.2"/><fapu ENS0="51" ES0="69" IRISD0="16" MNS0="30" MW0="50"/></head>
  <source>
    <entity alias="Rest" category="Expression"><mesh file="a.wrl" format="wrl"/>
      <bind item="Hair" submesh="a.wrl_0"/>
      <bind item="LeftEye" pivotX="-33.8" pivotY="-33.2" pivotZ="-28.8" submesh="a.wrl_1"/>
    </entity>
  </source>
  <fdp affects="a.wrl_3" index="2395" name="2.1"><indices>0 1 2 </indices>
    <influence fap="2" type="RaisedCosInfluenceSph" weight="0.3"/></fdp>
  <fdp affects="a.wrl_3" index="35" name="8.3"><indices>3 4 </indices></fdp>
  <fdp affects="a.wrl_5" index="0" name="2.1"/>
</xfdp>
"""
VISAGE = """# FDP file
1.0 somebody
2.1 0.0 -84.5 30.25 0.1203
8.3 26.0 -60 20 head.7   # a corner
"""


def test_points_of_xface_are_vertices_of_meshes(tmp_path: Path) -> None:
    path = tmp_path / "a.fdp"
    path.write_text(XFACE)
    found = read_fdp(path)
    assert [(p.fdp, p.mesh, p.vertex) for p in found.points] == [
        ("2.1", "a.wrl_3", 2395),
        ("8.3", "a.wrl_3", 35),
        ("2.1", "a.wrl_5", 0),
    ]
    assert found.fapu is not None
    assert (found.fapu.nose, found.fapu.mouth, found.fapu.iris) == (51.0, 50.0, 16.0)
    assert found.pivots["LeftEye"].tolist() == [-33.8, -33.2, -28.8]
    points = found.on("a.wrl_3", first=100)
    vertices = np.arange(3 * 3000, dtype=float).reshape(-1, 3)
    np.testing.assert_array_equal(points.at(vertices), vertices[[2495, 135]])


def test_points_of_visage_have_places(tmp_path: Path) -> None:
    path = tmp_path / "a.fdp"
    path.write_text(VISAGE)
    found = read_fdp(path)
    assert [(p.fdp, p.mesh, p.vertex, p.place) for p in found.points] == [
        ("2.1", "0", 1203, (0.0, -84.5, 30.25)),
        ("8.3", "head", 7, (26.0, -60.0, 20.0)),
    ]


BOMB = '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "no feature points"),
        ("hello", "no feature points"),
        ("<xfdp></xfdp>", "no feature points"),
        ("<xfdp>", "not a .fdp file"),
        ("<svg/>", "expected <xfdp>"),
        (BOMB + XFACE.partition("?>")[2], "entities"),
        (XFACE.replace('"2395"', '"-1"'), "no index"),
        (XFACE.replace('"2395"', '"99999999999999"'), "no index"),
        (XFACE.replace('name="8.3"', 'name="8.99"'), "no feature point"),
        (XFACE.replace('MW0="50"', 'MW0="nan"'), "out of bounds"),
        (XFACE.replace('pivotZ="-28.8" ', ""), "could not convert"),
        (VISAGE.replace("-84.5", "inf"), "out of bounds"),
        (VISAGE + "nonsense\n", "no feature point"),
    ],
)
def test_damage_is_told_in_one_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "a.fdp"
    path.write_text(text)
    with pytest.raises(FormatError) as error:
        read_fdp(path)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_fdp(tmp_path / "absent.fdp")


def test_an_encoding_nobody_knows_is_a_plain_error(tmp_path: Path) -> None:
    (tmp_path / "a.fdp").write_text(XFACE.replace("UTF-8", "aTF-8"))
    with pytest.raises(FormatError, match=r"a\.fdp"):
        read_fdp(tmp_path / "a.fdp")


@settings(
    deadline=None, max_examples=120, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_nothing_but_a_plain_error_comes_of_damage(tmp_path: Path, data: st.DataObject) -> None:
    whole = bytearray(data.draw(st.sampled_from([XFACE, VISAGE])).encode())
    for _ in range(data.draw(st.integers(1, 6))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "a.fdp"
    path.write_bytes(whole[: data.draw(st.integers(0, len(whole)))])
    with suppress(FormatError):
        assert read_fdp(path).points


@pytest.mark.skipif("MIEN_TEST_DATA" not in os.environ, reason="MIEN_TEST_DATA names no faces")
def test_xfaces_own_face_is_read() -> None:
    found = read_fdp(Path(os.environ["MIEN_TEST_DATA"], "fap", "xface_alice.fdp"))
    assert len(found.points) == 35
    assert len({point.fdp for point in found.points}) == 33
    assert len(found.on("alice.wrl_3").ids) == 32

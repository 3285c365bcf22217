"""Tables of markers: TRC and CSV read back, tell their units, and are told when they are broken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError
from mien.formats.markers.csv import read_marker_csv
from mien.formats.markers.file import holds_markers, read_markers, read_roles
from mien.formats.markers.trc import read_trc
from mien.performance.marker_take import MarkerTake


def small() -> MarkerTake:
    places = np.random.default_rng(1).uniform(-100.0, 100.0, (5, 3, 3))
    places[2, 1] = np.nan
    return MarkerTake(("LBrowIn", "RBrowIn", "NoseTip"), np.arange(5) / 100, places)


def trc(take: MarkerTake, path: Path, units: str = "mm") -> Path:
    rows = [
        "\t".join(
            [str(i + 1), f"{take.time[i]:.6f}"]
            + ["" if np.isnan(x) else f"{x:.5f}" for x in take.places[i].ravel()]
        )
        for i in range(len(take))
    ]
    count = len(take.labels)
    head = [
        "PathFileType\t4\t(X/Y/Z)\ta.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate",
        f"100\t100\t{len(take)}\t{count}\t{units}\t100",
        "Frame#\tTime\t" + "\t\t\t".join(f"Vera:{label}" for label in take.labels),
        "\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(count) for axis in "XYZ"),
    ]
    path.write_text("\n".join([*head, *rows]) + "\n")
    return path


def table(take: MarkerTake, path: Path, unit: str = " (mm)", mark: str = ".") -> Path:
    names = [f"{label}{mark}{axis}{unit}" for label in take.labels for axis in "xyz"]
    rows = [
        ",".join([f"{time:.6f}"] + ["" if np.isnan(x) else f"{x:.5f}" for x in place.ravel()])
        for time, place in zip(take.time, take.places, strict=True)
    ]
    path.write_text("\n".join([",".join(["time", *names]), *rows]) + "\n")
    return path


def same(first: MarkerTake, second: MarkerTake) -> None:
    assert first.labels == second.labels
    assert np.allclose(first.time, second.time)
    assert np.allclose(first.places, second.places, atol=1e-4, equal_nan=True)


def test_tables_read_back(tmp_path: Path) -> None:
    same(read_trc(trc(small(), tmp_path / "a.trc")), small())
    for mark in (".", ":", "_", " "):
        same(read_marker_csv(table(small(), tmp_path / "a.csv", mark=mark)), small())


def test_units_are_read_or_asked_for(tmp_path: Path) -> None:
    assert read_trc(trc(small(), tmp_path / "a.trc", "cm")).unit == 10.0
    with pytest.raises(FormatError, match="--units"):
        read_trc(trc(small(), tmp_path / "a.trc", ""))
    bare = table(small(), tmp_path / "a.csv", unit="")
    with pytest.raises(FormatError, match="it names no unit; say --units, here likely --units mm"):
        read_marker_csv(bare)
    assert read_marker_csv(bare, "m").unit == 1000.0


def test_a_csv_is_a_marker_take_by_its_first_line(tmp_path: Path) -> None:
    assert holds_markers(table(small(), tmp_path / "a.csv"))
    (tmp_path / "b.csv").write_text("Timecode,BlendShapeCount,EyeBlinkLeft\n")
    assert not holds_markers(tmp_path / "b.csv")
    assert not holds_markers(tmp_path / "none.csv")
    assert holds_markers("anything.c3d")


def test_roles_are_lines_of_label_and_point(tmp_path: Path) -> None:
    path = tmp_path / "roles.csv"
    path.write_text("# mine\nM1,8.3\n\nTop , jig\nM9,-\n")
    assert read_roles(path) == {"M1": "8.3", "Top": "jig", "M9": "-"}
    path.write_text("M1 8.3\n")
    with pytest.raises(InputError, match="line 1 is not LABEL,FDP"):
        read_roles(path)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "PathFileType\n",
        "PathFileType\n\n\n\n\n\n",
        "PathFileType\nDataRate\tUnits\n100\tmm\nFrame#\tTime\tA\n\t\tX1\n1\t0\t1\tx\t3\n",
        "PathFileType\nDataRate\tUnits\n0\tmm\nFrame#\tTime\tA\n\t\tX1\n1\t0\t1\t2\t3\n1\t0\t1\t2\t3\n",
    ],
)
def test_broken_tables_are_told(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.trc").write_text(text)
    with pytest.raises(FormatError, match=r"a\.trc"):
        read_markers(tmp_path / "a.trc")


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(hits=st.lists(st.tuples(st.integers(0, 700), st.sampled_from("\t\n,x-9.e\0é")), max_size=8))
def test_damaged_tables_do_no_harm(tmp_path: Path, hits: list[tuple[int, str]]) -> None:
    for path, write in ((tmp_path / "a.trc", trc), (tmp_path / "a.csv", table)):
        text = list(write(small(), path).read_text())
        for place, letter in hits:
            text[place % len(text)] = letter
        path.write_text("".join(text))
        said = ""
        try:
            take = read_markers(path, "mm")
            assert take.places.shape == (len(take.time), len(take.labels), 3)
        except InputError as error:
            said = str(error)
        assert "\n" not in said

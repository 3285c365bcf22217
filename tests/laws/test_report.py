"""What a report says is true: of takes of which all is known."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from actors import FACE_ON, built_in, shown
from mien import recipe
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.report.chart import Chart, ridges, thinned
from mien.report.eyes import closures
from mien.report.findings import find, worst
from mien.report.levels import levels
from mien.report.page import page
from mien.report.reach import reach, spans, telling
from mien.report.rest import rest
from mien.report.tell import Story, tell

FRAMES = 40


def smiling() -> Performance:
    """The man smiles in the second half of the take."""
    man = built_in("man")
    weights = np.zeros((FRAMES, len(man.examples)))
    weights[FRAMES // 2 :, man.examples.index("smile")] = 1.0
    return shown(man, weights, unseen=FACE_ON)


def still(performance: Performance, residual: float) -> Curves:
    """The man does nothing, and ``residual`` mm are missing in every frame."""
    curves = recipe.animate(performance, built_in("man"))
    return replace(
        curves, weights=0.0 * curves.weights, residual=np.full(len(performance), residual)
    )


def test_nothing_expressed_is_all_missing() -> None:
    performance = smiling()
    nothing = still(performance, 0.0)
    moved = reach(performance, nothing).motion
    found = reach(performance, replace(nothing, residual=moved))
    assert found.missing == pytest.approx(1.0)
    assert reach(performance, nothing).missing == 0.0
    assert not reach(performance, nothing).unreached.any()


def test_what_is_below_the_noise_is_not_called_unreached() -> None:
    performance = smiling()
    assert not reach(performance, still(performance, 1.0)).unreached.any()
    assert reach(performance, still(performance, 50.0)).unreached.all()


def test_lost_frames_count_for_nothing() -> None:
    performance = replace(smiling(), lost=np.ones(FRAMES, dtype=bool))
    found = reach(performance, still(performance, 50.0))
    assert not found.unreached.any()
    assert found.missing == 0.0
    assert telling(performance, 3) == []


def test_telling_frames_are_where_most_happens() -> None:
    first, second = telling(smiling(), 2)
    assert first < FRAMES // 2 <= second


def test_spans_are_runs_of_frames() -> None:
    frames = np.array([1, 1, 0, 0, 1, 0, 1, 1], dtype=bool)
    time = np.arange(8) / 10
    assert spans(frames, time) == [(0.0, 0.1), (0.4, 0.4), (0.6, 0.7)]
    assert spans(~frames & frames, time) == []


@pytest.mark.parametrize("name", ["man", "monkey"])
def test_each_eye_is_measured_by_itself(name: str) -> None:
    character = built_in(name)
    performance = smiling()
    curves = recipe.animate(performance, character)
    weights = np.zeros_like(curves.weights)
    weights[FRAMES // 2 :, curves.names.index("blink_L")] = 1.0
    found = closures(character, replace(curves, weights=weights))
    assert found["left"][0] == 0.0
    assert 0.85 < found["left"][-1] < 1.15
    assert abs(found["right"][-1]) < 0.05


def test_a_slow_drift_is_no_tremble_and_noise_is() -> None:
    performance, man = smiling(), built_in("man")
    curves = still(performance, 0.0)
    quiet = reach(performance, curves).motion
    drift = np.linspace(0.0, 1.0, FRAMES)[:, None, None]
    drifting = replace(performance, motion=np.ones_like(performance.motion) * drift)
    assert rest(drifting, man, curves, quiet).tremble == pytest.approx((0.0, 0.0), abs=1e-9)
    noise = np.random.default_rng(0).normal(0.0, 0.5, performance.motion.shape)
    performed, acted = rest(replace(performance, motion=noise), man, curves, quiet).tremble
    assert 0.6 < performed < 1.0  # 0.5 mm along each of three axes
    assert acted == 0.0


def test_levels_are_those_of_whole_key_models() -> None:
    man, performance = built_in("man"), smiling()
    curves = recipe.animate(performance, man)
    found = levels(man, curves)
    assert next(iter(found)) == "smile"
    assert set(found) <= set(man.keys.names)
    beside = replace(
        curves,
        names=(*curves.names, "tongue"),
        weights=np.column_stack([curves.weights, np.full(FRAMES, -0.1)]),
    )
    assert set(levels(man, beside)) == {*found, "tongue"}
    assert levels(man, beside)["tongue"][0] == -0.1
    strongest = curves.weights[:, [n.startswith("smile_") for n in curves.names]].max(axis=1)
    assert np.allclose(found["smile"], strongest)


def test_worst_frames_are_apart_and_in_order() -> None:
    performance = smiling()
    curves = replace(still(performance, 0.0), residual=np.linspace(0.0, 3.0, FRAMES))
    frames = worst(find(performance, built_in("man"), curves), 4)
    assert frames == sorted(frames)
    assert frames[-1] == FRAMES - 1
    assert (np.diff(frames) >= 0.05 * (FRAMES - 1)).all()


def test_a_thinned_line_keeps_its_peak() -> None:
    values = np.zeros(100_000)
    values[77_777] = -3.0
    time, shown_values = thinned(np.arange(100_000.0), values)
    assert len(time) < 1000
    assert shown_values.min() == -3.0


@pytest.mark.parametrize("frames", [2, 40, 5000])
def test_charts_are_whole_whatever_is_drawn(frames: int) -> None:
    time = np.arange(frames) / 30.0
    values = np.sin(time)
    chart = Chart(time, -1.0, 1.0, unit="mm").bands([(0.0, 0.1)], "lost", "<&>")
    drawn = [
        chart.area(values, "a").line(0.0 * values, "b").dots([0.0], [1.0], "c").svg('"<&>"'),
        ridges(time, {"a<b": values, "none": 0.0 * values}, "character"),
        Chart(time, 0.0, 0.0).line(0.0 * values, "b").svg("flat"),
    ]
    for svg in drawn:
        ElementTree.fromstring(svg)
        assert not re.search(r"nan|inf|--|-0[^.]", svg)


def test_a_report_is_one_page_that_loads_nothing(tmp_path: Path) -> None:
    performance, toy = smiling(), built_in("toy")
    findings = find(performance, toy, recipe.animate(performance, toy))
    told = tell(Story(findings, "<i>take</i>", lambda frames, side: []))
    assert "<i>take" not in told
    assert not re.findall(r"(?:src|href)=\"(?!data:)", told)
    assert not re.findall(r"https?://|url\(|@import|<script|<link", told)
    for title in ("What was expressed", "Weights over time", "sculpt next", "eye", "Noise at rest"):
        assert title in told
    assert page("t", [""]).count("<title>t</title>") == 1

"""Markers become motion: names, heads, mends, gaps, rest, and the face's own frame."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from mien.capture.markers.correlation import learn
from mien.capture.markers.gaps import fill, find_gaps
from mien.capture.markers.head import by_nose_tip, find_head_motion
from mien.capture.markers.labels import name_roles, place_roles
from mien.capture.markers.neutral import find_rest
from mien.capture.markers.perform import MarkerSettings, perform
from mien.errors import FormatError, InputError
from mien.face.library import generic_face
from mien.numeric.noise import noise_of
from mien.numeric.procrustes import rigid
from mien.numeric.rotation import from_vector
from mien.performance.marker_take import MarkerTake
from mien.performance.performance import Performance
from takes import JIG, RATE, WORN, act

FACE = generic_face().face
NAMES = {
    "LBrowIn": "4.1", "Leyebrow_Inside": "4.1", "brow_inner_l": "4.1", "R_EyeBrow_Outer": "4.6",
    "8.3": "8.3", "fdp_8_3": "8.3", "Mouth_Lend": "8.3", "mouthCornerR": "8.4", "Mouth_UpL1": "8.5",
    "LipLow": "8.2", "upperLip": "8.1", "Rcheek_up": "5.4", "NoseTip": "9.3", "nostril_l": "9.1",
    "Chin": "2.1", "ForeHead_R": "11.2", "RJaw": "2.14", "Leye_Outside": "3.7", "elbow": "",
}  # fmt: skip


def motion_error(performance: Performance, take: MarkerTake, true: np.ndarray) -> float:
    """mm, mean error of the motion of all points, in whatever axes."""
    order = [take.labels.index(label) for p in performance.points for label in [_label(p)]]
    wanted = (true - true[:40].mean(axis=0))[:, order]
    turn = rigid(performance.neutral, true[:40].mean(axis=0)[order]).rotation
    return float(np.linalg.norm(performance.motion @ turn.T - wanted, axis=-1).mean())


def _label(point: str) -> str:
    return next(label for label, fdp in WORN.items() if fdp == point)


@pytest.mark.parametrize(("label", "fdp"), NAMES.items())
def test_names_tell_feature_points(label: str, fdp: str) -> None:
    assert name_roles([label]).fdp == (fdp,)


def test_jigs_nameless_columns_and_users_are_heard() -> None:
    labels = ("JigTop", "*31", "LBrowIn", "LBrowIn", "M7", "M8")
    roles = name_roles(labels, {"M7": "8.3", "M8": "-"})
    assert roles.fdp == ("", "", "4.1", "", "8.3", "")
    assert roles.jig.tolist() == [True, False, False, False, False, False]
    assert roles.nameless.tolist() == [False, True, False, True, False, True]


def test_places_tell_what_names_do_not() -> None:
    labels = [f"x{i}" if i % 4 == 0 else label for i, label in enumerate(WORN)]
    _, _, neutral = act(60)
    generic = dict(zip(FACE.points.ids, FACE.points.at(FACE.vertices), strict=True))
    found = place_roles(name_roles(labels), 1.1 * neutral + [5.0, 3.0, -900.0], generic)
    assert found.fdp == tuple(WORN.values())


@pytest.mark.parametrize("jig", [True, False])
def test_heads_are_held_still(jig: bool) -> None:
    take, true, _ = act()
    worn = len(take.labels) if jig else len(WORN)
    fixed = np.array([label in JIG for label in take.labels[:worn]])
    motion, _ = find_head_motion(take.places[:, :worn], fixed, RATE)
    still = motion.undo(take.places)[:, : len(WORN)]
    moved = still @ rigid(still.mean(0), true.mean(0)).rotation.T
    left = moved - moved.mean(0) - (true - true.mean(0))
    assert np.linalg.norm(left, axis=-1).mean() < (0.3 if jig else 1.2)


def test_the_published_way_shakes_more() -> None:
    take, true, _ = act(noise=0.3)
    fixed = np.array([label in JIG for label in take.labels])
    nose = take.labels.index("NoseTip")

    def error(still: np.ndarray) -> float:
        still = still[:, : len(WORN)] @ rigid(still[0, : len(WORN)], true[0]).rotation.T
        left = still - still.mean(0) - (true - true.mean(0))
        return float(np.linalg.norm(left, axis=-1).mean())

    better = find_head_motion(take.places, fixed, RATE)[0].undo(take.places)
    assert error(better) < 0.8 * error(by_nose_tip(take.places, fixed, nose).undo(take.places))


def test_performances_ignore_where_the_room_is() -> None:
    take, *_ = act(240)
    turn = from_vector(np.array([0.4, -2.0, 1.0]))
    elsewhere = replace(take, places=take.places @ turn.T + [500.0, 0.0, 30.0])
    first, second = (perform(each, FACE)[0] for each in (take, elsewhere))
    # Medians go by axes, and so the noise that is told depends a little on them.
    assert np.abs(first.motion - second.motion).max() < 0.2
    assert np.abs(first.neutral - second.neutral).max() < 0.2
    assert np.abs(first.head()[0] - second.head()[0]).max() < 2e-3


def test_a_clean_take_becomes_its_motion() -> None:
    take, true, _ = act()
    performance, mended = perform(take, FACE)
    assert set(performance.points) == set(WORN.values())
    assert mended.events == ()
    assert mended.noise == pytest.approx(0.1, rel=0.15)
    assert mended.rest[0] < 0.5
    assert motion_error(performance, take, true) < 0.3
    assert not performance.unseen.any()
    assert not performance.lost.any()


def spoilt() -> tuple[MarkerTake, np.ndarray, MarkerTake]:
    """A take with two markers swapped, a leap, a ghost, a gap and a missing start; and the take."""
    take, true, _ = act()
    places = np.concatenate([take.places, np.full((len(take), 1, 3), np.nan)], axis=1)
    column = {label: i for i, label in enumerate(take.labels)}
    swapped = [column["LipLow"], column["LLipLow"]]
    places[300:350, swapped] = places[300:350, swapped[::-1]]
    places[420:422, column["LMouth"]] += [9.0, -6.0, 3.0]
    places[200:260, -1] = take.places[200:260, column["NoseTip"]] + [25.0, 8.0, 30.0]
    places[120:200, column["LBrowMid"]] = np.nan
    places[:100, column["RCheek"]] = np.nan
    return replace(take, labels=(*take.labels, "*35"), places=places), true, take


def test_what_was_spoilt_is_found_and_mended() -> None:
    take, true, clean = spoilt()
    performance, mended = perform(take, FACE)
    told = {(event.kind, event.labels, event.first, event.last) for event in mended.events}
    assert told == {
        ("swap", ("LLipLow", "LipLow"), 300, 349),
        ("jump", ("LMouth",), 420, 421),
        ("ghost", ("*35",), 200, 259),
        ("gap", ("LMouth",), 420, 421),
        ("gap", ("LBrowMid",), 120, 199),
        ("gap", ("RCheek",), 0, 99),
    }
    whole, _ = perform(clean, FACE)
    assert motion_error(performance, take, true) < 1.3 * motion_error(whole, clean, true)


def test_a_marker_that_lost_its_name_is_found() -> None:
    take, *_ = act()
    column = take.labels.index("RMouth")
    places = np.concatenate([take.places, np.full((len(take), 1, 3), np.nan)], axis=1)
    places[250:300, -1], places[250:300, column] = places[250:300, column], np.nan
    _, mended = perform(replace(take, labels=(*take.labels, "*9"), places=places), FACE)
    assert [(e.kind, e.labels) for e in mended.events] == [("found", ("RMouth", "*9"))]


def test_gaps_are_filled_by_what_faces_do() -> None:
    _, true, _ = act(noise=0.0)
    noisy = true + 0.05 * np.random.default_rng(2).standard_normal(true.shape)
    known = np.ones(true.shape[:2], dtype=bool)
    known[100:110, 3] = known[200:320, 15] = known[:90, 20] = False
    noisy[~known] = np.nan
    filled, error = fill(noisy, known, learn(noisy, known, 0.05), RATE)
    assert np.linalg.norm(filled - true, axis=-1)[~known].mean() < 0.5
    assert (filled[known] == noisy[known]).all()
    assert (error[known] == 0.0).all()
    assert (error[~known] > 0.0).all()
    assert [(gap.marker, gap.first, gap.last) for gap in find_gaps(known)] == [
        (3, 100, 109), (15, 200, 319), (20, 0, 89),
    ]  # fmt: skip


def test_frames_without_any_marker_are_lost() -> None:
    take, *_ = act()
    places = take.places.copy()
    places[200:320] = np.nan
    performance, _ = perform(replace(take, places=places), FACE)
    assert np.flatnonzero(performance.lost).tolist() == list(range(200, 320))
    assert np.isfinite(performance.motion).all()
    assert np.isfinite(performance.translation).all()


def test_rest_is_found_and_may_be_named() -> None:
    _, true, _ = act(noise=0.0)
    rest = find_rest(true, RATE)
    assert rest.stop <= 62
    take, *_ = act()
    _, mended = perform(take, FACE, MarkerSettings(neutral=(2.0, 2.5)))
    assert mended.rest == pytest.approx((2.0, 2.5), abs=0.01)
    with pytest.raises(InputError, match="--neutral"):
        perform(take, FACE, MarkerSettings(neutral=(50.0, 51.0)))


def test_a_wrong_unit_is_told() -> None:
    take, *_ = act(60)
    with pytest.raises(FormatError, match=r"likely --units m$"):
        perform(replace(take, places=take.places / 1000.0), FACE)


def test_a_take_without_known_markers_is_told() -> None:
    take, *_ = act(60)
    strange = replace(take, labels=tuple(f"M{i}" for i in range(len(take.labels))))
    with pytest.raises(InputError, match="--labels"):
        perform(strange, FACE)
    with pytest.raises(InputError, match="no column of it names a marker"):
        perform(replace(take, labels=tuple(f"*{i}" for i in range(len(take.labels)))), FACE)


def test_a_single_frame_is_a_take() -> None:
    take, *_ = act(60)
    alone = replace(take, time=take.time[:1], places=take.places[:1])
    assert len(perform(alone, FACE)[0]) == 1


def test_noise_is_told_from_motion() -> None:
    time = np.linspace(0.0, 10.0, 1200)
    smooth = 20.0 * np.sin(2.0 * time)
    noise = 0.3 * np.random.default_rng(0).standard_normal(1200)
    assert noise_of(smooth) < 0.01
    assert noise_of(smooth + noise) == pytest.approx(0.3, rel=0.1)
    assert noise_of(smooth[:2]) == 0.0


def _emptied(places: np.ndarray, random: np.random.Generator) -> None:
    places[random.random(places.shape[:2]) < 0.5] = np.nan


def _unworn(places: np.ndarray, random: np.random.Generator) -> None:
    places[:, random.random(places.shape[1]) < 0.6] = np.nan


def _dark(places: np.ndarray, random: np.random.Generator) -> None:
    places[random.random(len(places)) < 0.7] = np.nan


def _without_a_jig(places: np.ndarray, random: np.random.Generator) -> None:
    places[:, -3:] = np.nan
    places[random.random(places.shape[:2]) < 0.05] += 50.0


def _anything(places: np.ndarray, random: np.random.Generator) -> None:
    places[:] = random.choice([1.0, 100.0, 1e4]) * random.normal(size=places.shape)


def _one_place(places: np.ndarray, random: np.random.Generator) -> None:
    places[:] = places[:, :1]


def _flat(places: np.ndarray, random: np.random.Generator) -> None:
    places[..., 2] = 0.0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("frames", [1, 2, 5, 40])
@pytest.mark.parametrize(
    "spoil", [_emptied, _unworn, _dark, _without_a_jig, _anything, _one_place, _flat]
)
def test_hostile_takes_are_told_or_become_numbers(
    spoil: Callable[[np.ndarray, np.random.Generator], None], frames: int
) -> None:
    take, *_ = act(60)
    for seed in range(3):
        places = take.places[:frames].copy()
        spoil(places, np.random.default_rng(seed))
        spoilt = replace(take, time=take.time[:frames], places=places)
        with suppress(InputError):
            performance, _ = perform(spoilt, FACE, MarkerSettings(nose_tip=seed == 1))
            for values in (performance.motion, performance.rotation, performance.translation):
                assert np.isfinite(values).all()

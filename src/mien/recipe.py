"""The recipe: from a recording to curves. Knows every verb, owns no mathematics."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import TypeVar

from mien.capture import CAPTURES, CaptureSettings
from mien.capture.fap import motion_from_faps, perform
from mien.capture.learn import Lessons, learn
from mien.capture.markers.perform import MarkerSettings, Mended
from mien.capture.markers.perform import perform as perform_markers
from mien.capture.shapes import motion_from_shapes
from mien.capture.snakes.curves.features import NAMES
from mien.errors import InputError, NoFaceError
from mien.face.character import Character
from mien.face.databank import Databank, databank, performer_face, shape_space
from mien.face.face import Face
from mien.face.library import generic_face
from mien.face.overrides import overridden
from mien.face.shape_space import ShapeSpace
from mien.formats.markers.file import holds_markers, read_markers, read_roles
from mien.formats.meshes.obj_read import read_obj
from mien.formats.notes.own import read_pairs
from mien.formats.notes.rectangles import read_rectangles
from mien.formats.performer_file import read_performer, write_performer
from mien.formats.pictures.lens import read_focal
from mien.formats.pictures.mp4 import Sound, write_mp4
from mien.formats.pictures.sources import open_source
from mien.formats.pictures.video import Video
from mien.formats.takes.fap import read_take, simple_take, write_take
from mien.formats.takes.livelink import read_livelink, write_livelink
from mien.formats.takes.mien_file import read_performance, write_performance
from mien.formats.takes.recording import read_recording
from mien.mapping import MAPPERS, Settings
from mien.mapping.arkit import arkit_weights
from mien.mapping.beside import beside
from mien.mapping.fap import fap_values, parted
from mien.mapping.held import with_held
from mien.mapping.own import own_examples
from mien.mapping.ranges import measure_ranges
from mien.mapping.reconstruct import reconstruct
from mien.mapping.spoken import pass_through, understood
from mien.mapping.surface import act_surface, told_points
from mien.overlay_film import overlay_film
from mien.performance.curves import Curves
from mien.performance.filters import Smoother
from mien.performance.filters import smooth as smooth_curves
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace, Performer
from mien.rig.load import load_character

Progress = Callable[[int, int | None], None]
Way = TypeVar("Way")


MOTIONS: Mapping[str, Callable[[Performance, Character], Performance]] = {
    "arkit": motion_from_shapes,
    "fap": motion_from_faps,
}
"""How the weights of a vocabulary become motion of the generic face's points."""


def _read_fap(path: Path) -> Performance:
    return perform(read_take(path), f"FAP file {path.name}")


def _write_fap(performance: Performance, path: Path) -> None:
    write_take(path, simple_take(performance.time, fap_values(moving(performance))))


def _write_arkit(performance: Performance, path: Path) -> None:
    weights = arkit_weights(moving(performance), generic_face())
    write_livelink(path, performance.time, weights, performance.head()[0], performance.gaze)


READERS: Mapping[str, Callable[[Path], Performance]] = {
    ".mien": read_performance,
    ".take": read_recording,
    ".csv": read_livelink,
    ".fap": _read_fap,
}
"""How a file that holds a performance is read, by its ending."""
WRITERS: Mapping[str, Callable[[Performance, Path], None]] = {
    ".mien": write_performance,
    ".csv": _write_arkit,
    ".fap": _write_fap,
}
"""How a performance is kept in a file, by its ending."""


def capture(
    path: str | Path,
    *,
    method: str = "tracker",
    start: float | None = None,
    end: float | None = None,
    mirror: bool = False,
    rate: float | None = None,
    neutral: tuple[float, float] | None = None,
    focal: float | str | Path | None = None,
    performer: str | Path | None = None,
    faces: str | Path | None = None,
    overlay: str | Path | None = None,
    progress: Progress | None = None,
    notice: Callable[[str], None] | None = None,
) -> Performance:
    """What the performer in a recording did.

    ``path`` names a video, a folder of images, "camera:0", or a marker take (see
    ``capture_markers``); ``start`` and ``end`` cut it, in seconds; ``mirror`` undoes a selfie's
    flip; ``rate`` is frames a second of a folder of images (30); ``neutral`` (first, last) names
    the seconds in which the face rests (found otherwise); ``focal`` is the camera's focal length
    in pixels, or a camera file that says it; ``performer`` is a .performer file of what earlier
    takes told of the same person; ``faces`` is a databank of their scanned faces, by which the
    tracker knows how they look and move; ``overlay`` names an MP4 to write, in which what was seen
    is drawn over the recording. ``progress`` is called with frames done and frames expected (None:
    unknown), ``notice`` with a line where the tracker left a take to the landmarks.
    Raises InputError, FormatError, NoFaceError, MissingExtraError.
    """
    if holds_markers(path):
        return capture_markers(path, start=start, end=end, neutral=neutral)[0]
    way = _choose(CAPTURES, method, "capture")
    source = open_source(path, start, end, mirror, rate)
    count = source.count
    told = None if progress is None else (lambda done: progress(done, count))
    if faces is not None and method != "tracker":
        raise InputError(f"--faces {faces}: only --capture tracker knows faces by their scans")
    known = None if performer is None else read_performer(Path(performer))
    settings = CaptureSettings(
        neutral, _focal(focal, source.size[0]), known, _space(faces), notice=notice
    )
    try:
        if overlay is None:
            return way(source, settings, source.name, told)
        if str(path).startswith("camera:"):
            raise InputError(f"{path}: a camera cannot be read twice, so there is no overlay of it")
        again = open_source(path, start, end, mirror, rate)
        with overlay_film(Path(overlay), again) as watch:
            return way(source, replace(settings, watch=watch), source.name, told)
    except NoFaceError as error:
        raise NoFaceError(f"{source.name}: {error}") from error


def calibrate(
    takes: Sequence[str | Path],
    path: str | Path,
    *,
    neutral: tuple[float, float] | None = None,
    shut: tuple[float, float] | None = None,
    poses: Mapping[str, tuple[float, float]] | None = None,
    features: str | Path | None = None,
    focal: float | str | Path | None = None,
    progress: Progress | None = None,
) -> Performer:
    """Learn a performer from ``takes`` and keep what was learnt in the .performer file ``path``.

    ``neutral`` names the seconds (first, last) in which the face rests (found otherwise), ``shut``
    those in which both eyes are shut (otherwise they are when they are narrowest) and ``poses``
    those in which key poses are held; seconds count through all takes. ``features`` is a file of
    rectangles that say where the features are (see ``formats.notes.rectangles``), otherwise the
    landmark networks do. Raises InputError, FormatError, NoFaceError, OutputError.
    """
    sources = [open_source(take) for take in takes]
    for source in sources:
        if source.size != sources[0].size:
            sizes = " and ".join(f"{s.name} {s.size[0]}x{s.size[1]}" for s in (sources[0], source))
            raise InputError(f"{sizes}: the takes of a performer need pictures of one size")
    drawn = read_rectangles(Path(features), (*NAMES, "mouth")) if features is not None else {}
    focal = _focal(focal, sources[0].size[0])
    lessons = Lessons(neutral, shut, focal, poses or {}, drawn)
    done = itertools.count(1)

    def play() -> Iterator[Frame]:
        begin = 0.0
        for source in sources:
            last = begin
            for frame in source:
                last = begin + frame.time
                yield Frame(frame.image, last)
                if progress is not None:
                    progress(next(done), None)
            begin = last + 1.0 / source.rate

    performer = learn(play, lessons, ", ".join(source.name for source in sources))
    write_performer(performer, Path(path))
    return performer


def capture_markers(
    path: str | Path,
    *,
    units: str | None = None,
    labels: str | Path | None = None,
    nose_tip: bool = False,
    start: float | None = None,
    end: float | None = None,
    neutral: tuple[float, float] | None = None,
) -> tuple[Performance, Mended]:
    """What a performer wearing optical markers did, and what was mended in the take.

    ``path`` names a .c3d; ``units`` of its numbers ("mm", "m" ...) where it does not name them;
    ``labels`` is a file with lines "LABEL,8.3", "LABEL,jig" or "LABEL,-" for markers that names do
    not tell; ``nose_tip`` undoes the head's motion as [Z] §3 has it; ``start``, ``end`` and
    ``neutral`` in seconds as for ``capture``. Raises InputError, FormatError.
    """
    take = read_markers(path, units)
    if start is not None or end is not None:
        take = take.cut(start or 0.0, inf if end is None else end)
    if not len(take):
        raise InputError(f"{path}: has no frames from --start to --end")
    roles = read_roles(labels) if labels else None
    return perform_markers(take, generic_face().face, MarkerSettings(neutral, roles, nose_tip))


def load_performance(path: str | Path) -> Performance:
    """A performance from a .mien file, a Live Link Face .csv or an MPEG-4 .fap. Raises InputError,
    FormatError."""
    return _of_ending(READERS, Path(path))(Path(path))


def save_performance(performance: Performance, path: str | Path) -> None:
    """Keep a performance as .mien, as a Live Link Face .csv (ARKit's 52 weights, head, eyes) or as
    an MPEG-4 .fap (animation parameters 3 to 68).

    Raises InputError for another ending, OutputError where it cannot be written.
    """
    _of_ending(WRITERS, Path(path))(performance, Path(path))


def animate(
    performance: Performance,
    character: str | Path | Character,
    *,
    mapping: str = "cardinal",
    gain: float = 1.0,
    brows: float = 1.0,
    eyes: float = 1.0,
    mouth: float = 1.0,
    head: float = 1.0,
    own: str | Path | Sequence[HeldFace] | None = None,
    own_range: bool = False,
    smooth: bool = True,
    causal: bool = False,
) -> Curves:
    """The curves with which ``character`` acts ``performance``.

    ``gain`` exaggerates (1 leaves as it is), ``brows``, ``eyes``, ``mouth`` and ``head`` each a
    part; ``own`` is a file of moments of this performance that stand for poses of the character
    (``formats.notes.own``), or a .performer with faces that were held, or such faces;
    ``own_range`` makes the range shown in it the character's; ``smooth`` False leaves the
    detector's tremble in; ``causal`` smooths as live work has to, from what came before alone.
    Weights that came under a vocabulary the character speaks pass as they are.
    Raises InputError.
    """
    if not isinstance(character, Character):
        character = load_character(character)
    if understood(performance, character):
        return pass_through(performance, character)
    performance = moving(performance)
    settings = Settings(
        gain=gain,
        brows=brows,
        eyes=eyes,
        mouth=mouth,
        head=head,
        ranges=measure_ranges(performance) if own_range else None,
    )
    if own is not None:
        settings = _with_own(settings, own, character, performance)
    mapper = _choose(MAPPERS, mapping, "mapping")(character, performance, settings)
    curves = beside(mapper(performance), performance, character)
    if smooth:
        curves = Smoother()(curves) if causal else smooth_curves(curves)
    return overridden(parted(curves, character), character)


def _with_own(
    settings: Settings,
    own: str | Path | Sequence[HeldFace],
    character: Character,
    performance: Performance,
) -> Settings:
    if isinstance(own, str | Path):
        path = Path(own)
        if path.suffix.lower() != ".performer":
            return replace(settings, own=own_examples(performance, read_pairs(path)))
        own = read_performer(path).held
    return with_held(settings, own, character, performance)


def animate_surface(
    performance: Performance,
    bank: Databank,
    face: Face | None = None,
    *,
    mapping: str = "bounded",
    smooth: bool = True,
) -> tuple[Character, Curves]:
    """The dense surface that a performance shows through the faces of a databank [Z], as a
    character that acts it and its curves.

    It lands on the databank's person, or on ``face``, the performer's own neutral of the same
    topology (``load_performer``). ``mapping`` is "bounded", "genetic" or "published"; ``smooth``
    False leaves the markers' noise in. Raises InputError.
    """
    performance = moving(performance)
    surface = reconstruct(performance, bank, face=face, solver=mapping, smooth=smooth)
    return act_surface(surface, performance, bank.name)


def enrich(
    performance: Performance, bank: Databank, *, mapping: str = "bounded", smooth: bool = True
) -> Performance:
    """``performance`` with the motion of every feature point of a databank's face, also of those
    that wore no marker; for characters of any other mesh. As ``animate_surface``."""
    performance = moving(performance)
    surface = reconstruct(performance, bank, solver=mapping, smooth=smooth)
    return told_points(surface, performance)


def load_databank(path: str | Path) -> Databank:
    """A databank from its file, from a folder of OBJ files that share their topology
    (neutral.obj and a face each), or from any character's examples. Raises InputError,
    FormatError."""
    character = load_character(path)
    if not character.examples:
        raise InputError(f"{path}: holds a neutral but no faces to blend")
    return databank(character)


def load_performer(path: str | Path, bank: Databank) -> Face:
    """A performer's own neutral from an OBJ file in millimetres, in the databank's topology.

    Raises InputError where it has another topology, FormatError where it is broken or in another
    unit.
    """
    vertices = read_obj(Path(path)).vertices
    try:
        return performer_face(bank, vertices)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error


def moving(performance: Performance) -> Performance:
    """``performance`` with motion of feature points, also where it came as weights."""
    if performance.points or not performance.vocabulary:
        return performance
    if performance.vocabulary not in MOTIONS:
        raise InputError(
            f"{performance.source}: weights of '{performance.vocabulary}' are not understood; "
            f"there are {', '.join(MOTIONS)}"
        )
    return MOTIONS[performance.vocabulary](performance, generic_face())


def film(
    acts: Sequence[tuple[Character, Curves]],
    path: str | Path,
    *,
    take: str | Path | None = None,
    start: float | None = None,
    end: float | None = None,
    mirror: bool = False,
    rate: float | None = None,
    progress: Progress | None = None,
) -> None:
    """Write an MP4 of up to four characters and what they do, beside the performer.

    ``take``, ``start``, ``end``, ``mirror`` and ``rate`` as given to ``capture``; without ``take``,
    or from a camera, the characters are alone. Raises InputError, FormatError, OutputError.
    """
    from mien.view.preview import preview  # only films need the renderer and its compiler

    performer = sound = None
    if take is not None and not str(take).startswith("camera:"):
        performer = open_source(take, start, end, mirror, rate)
        if isinstance(performer, Video):
            sound = Sound(performer.path, performer.begin)
    frames: Iterable[Frame] = preview(acts, performer)
    if progress is not None:
        frames = _told(frames, len(acts[0][1]), progress)
    write_mp4(Path(path), frames, sound)


def _told(frames: Iterable[Frame], count: int, progress: Progress) -> Iterator[Frame]:
    for done, frame in enumerate(frames, start=1):
        yield frame
        progress(done, count)


def _space(faces: str | Path | None) -> ShapeSpace | None:
    if faces is None:
        return None
    try:
        return shape_space(load_databank(faces))
    except ValueError as error:
        raise InputError(
            f"{faces}: {error}; 'mien databank build SCANS' makes one that is"
        ) from error


def _focal(focal: float | str | Path | None, width: int) -> float | None:
    """Pixels on pictures ``width`` pixels wide."""
    if focal is None or isinstance(focal, int | float):
        return focal
    pixels, measured = read_focal(Path(focal))
    return pixels * width / (measured or width)


def _choose(ways: Mapping[str, Way], name: str, what: str) -> Way:
    if name not in ways:
        raise InputError(f"--{what} {name}: no such {what}; there are {', '.join(ways)}")
    return ways[name]


def _of_ending(ways: Mapping[str, Way], path: Path) -> Way:
    way = ways.get(path.suffix.lower())
    if way is None:
        raise InputError(f"{path}: a performance is kept as {' or '.join(ways)}")
    return way

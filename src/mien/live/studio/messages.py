"""What page and server say to each other, besides the frames.

The one source of these messages: ``python -m mien.live.studio.messages`` prints them as TypeScript
for the page.
"""

from __future__ import annotations

import json
import types
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

MAX_TEXT = 200
MAX_ITEMS = 64
MAX_MESSAGE = MAX_ITEMS * (MAX_TEXT + 8)

SourceKind = Literal["none", "camera", "sample", "video", "take"]
Task = Literal["neutral", "lids", "face"]


@dataclass(frozen=True, slots=True)
class Look:
    """Look at another performer: this camera's pictures (which the page sends), the sample that
    comes with mien, an uploaded video, or a recorded take."""

    source: SourceKind
    name: str = ""


@dataclass(frozen=True, slots=True)
class Cast:
    """Who is on stage."""

    characters: list[str]


@dataclass(frozen=True, slots=True)
class Way:
    """How the performer is followed and mapped."""

    capture: str
    mapping: str
    gain: float
    mirror: bool


@dataclass(frozen=True, slots=True)
class Hold:
    """The performer holds still now: their face at rest, both eyes shut, or a face that stands for
    a key model or, where none is named, for what is pinned of that character. No character: all
    that have the key model."""

    task: Task
    character: str
    pose: str


@dataclass(frozen=True, slots=True)
class Forget:
    """A held face means nothing any more."""

    number: int


@dataclass(frozen=True, slots=True)
class Keep:
    """Keep in a file what is known of the performer."""

    name: str


@dataclass(frozen=True, slots=True)
class Meet:
    """Go on with what a file tells of the performer; no name: with somebody new."""

    name: str


@dataclass(frozen=True, slots=True)
class Adjust:
    """What one morph target of one character does to what it is told."""

    character: str
    target: str
    gain: float
    muted: bool
    pinned: float | None


@dataclass(frozen=True, slots=True)
class Recording:
    """Begin or end a recording."""

    on: bool


@dataclass(frozen=True, slots=True)
class Seek:
    """Move in the take that is played."""

    time: float
    playing: bool


@dataclass(frozen=True, slots=True)
class Actor:
    """A character on stage: its file, its morph targets in the order of their weights, the key
    models it acts by, and whether it came as a VRM."""

    name: str
    url: str
    targets: list[str]
    keys: list[str]
    vrm: bool


@dataclass(frozen=True, slots=True)
class Face:
    """A face that was held: for whom, what it stands for, and how many millimetres its furthest
    point is from rest."""

    character: str
    pose: str
    far: float


@dataclass(frozen=True, slots=True)
class StageSet:
    """Everything the page has to show."""

    session: str
    actors: list[Actor]
    characters: list[str]
    models: list[str]
    captures: list[str]
    mappings: list[str]
    videos: list[str]
    takes: list[str]
    performers: list[str]
    faces: list[Face]
    way: Way
    source: SourceKind
    name: str
    sound: str
    recording: bool


@dataclass(frozen=True, slots=True)
class Learnt:
    """What came of holding still."""

    task: Task
    pose: str
    quality: Literal["good", "shaky", "refused"]
    text: str


@dataclass(frozen=True, slots=True)
class Note:
    """A line for the person in front of the page."""

    text: str
    level: Literal["info", "error"]


FROM_PAGE = (Look, Cast, Way, Hold, Forget, Keep, Meet, Adjust, Recording, Seek)
TO_PAGE = (StageSet, Learnt, Note)
PARTS = (Actor, Face)
Message = Look | Cast | Way | Hold | Forget | Keep | Meet | Adjust | Recording | Seek
Told = StageSet | Learnt | Note

_NAMES = {kind.__name__: kind for kind in FROM_PAGE}


def encode(message: Told) -> str:
    """As JSON, with its name as "kind"."""
    return json.dumps({"kind": type(message).__name__, **asdict(message)})


def decode(text: str) -> Message:
    """A message of the page. Raises ValueError for anything else."""
    if len(text) > MAX_MESSAGE:
        raise ValueError("a message longer than any this server knows")
    try:
        told = json.loads(text)
        kind = _NAMES[told.pop("kind")]
        hints = get_type_hints(kind)
        if told.keys() != hints.keys():
            raise ValueError(f"{kind.__name__} has {', '.join(hints) or 'no fields'}")
        return kind(**{name: _checked(told[name], hint, name) for name, hint in hints.items()})
    except (KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError("not a message this server knows") from error


def _checked(value: Any, hint: Any, name: str) -> Any:
    origin, choices = get_origin(hint), get_args(hint)
    if origin is Literal:
        valid = value in choices
    elif origin in (Union, types.UnionType):
        return None if value is None else _checked(value, choices[0], name)
    elif origin is list:
        if not isinstance(value, list) or len(value) > MAX_ITEMS:
            raise ValueError(f"{name} is no list, or too long a one")
        return [_checked(item, choices[0], name) for item in value]
    elif hint is float:
        valid = isinstance(value, int | float) and not isinstance(value, bool)
        valid = valid and abs(value) < 1e9
    elif hint is int:
        valid = isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1e9
    elif hint is str:
        valid = isinstance(value, str) and len(value) <= MAX_TEXT
    else:
        valid = isinstance(value, hint)
    if not valid:
        raise ValueError(f"{name} is not what it should be")
    return value


def typescript() -> str:
    """The messages as TypeScript."""
    shown = (*FROM_PAGE, *PARTS, *TO_PAGE)
    lines = ["// Made by python -m mien.live.studio.messages: do not edit.", ""]
    for kind in shown:
        doc = " ".join((kind.__doc__ or "").split())
        lines += [f"/** {doc} */", f"export interface {kind.__name__} {{"]
        if kind not in PARTS:
            lines.append(f'  kind: "{kind.__name__}";')
        hints = get_type_hints(kind)
        lines += [f"  {field.name}: {_script(hints[field.name])};" for field in fields(kind)]
        lines += ["}", ""]
    for name, kinds in (("FromPage", FROM_PAGE), ("ToPage", TO_PAGE)):
        lines.append(f"export type {name} = {' | '.join(kind.__name__ for kind in kinds)};")
    return "\n".join(lines) + "\n"


def _script(hint: Any) -> str:
    origin, choices = get_origin(hint), get_args(hint)
    if origin is Literal:
        return " | ".join(f'"{choice}"' for choice in choices)
    if origin in (Union, types.UnionType):
        return f"{_script(choices[0])} | null"
    if origin is list:
        return f"{_script(choices[0])}[]"
    plain = {float: "number", int: "number", bool: "boolean", str: "string"}
    return plain.get(hint) or (
        f'Omit<{hint.__name__}, "kind">' if hint in FROM_PAGE else hint.__name__
    )


if __name__ == "__main__":
    print(typescript(), end="")

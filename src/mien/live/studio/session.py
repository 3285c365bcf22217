"""One open page: its stage, its performer, its recording; worked on by a thread of its own."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace
from functools import singledispatchmethod
from importlib import resources
from pathlib import Path
from queue import Empty, Full, Queue
from threading import Event, Thread
from time import perf_counter

from mien.capture.stepping import STEPPERS, Stepper
from mien.errors import InputError, MienError
from mien.face.library import CHARACTERS, load_character
from mien.face.pieces import split
from mien.formats.takes.recording import Recorder
from mien.live.stage import Moment, Stage
from mien.live.studio import packet
from mien.live.studio.adjust import Desk
from mien.live.studio.messages import (
    Actor,
    Adjust,
    Cast,
    Learn,
    Look,
    Message,
    Note,
    Recording,
    Seek,
    SourceKind,
    StageSet,
    Way,
)
from mien.live.studio.shelf import Shelf
from mien.live.studio.sources import Arrived, Film, PageCamera, Source, Tape
from mien.mapping import MAPPERS, Settings
from mien.performance.frame import Frame

MOST_ON_STAGE = 4
LARGEST_PICTURE = 4 * 2**20
_WAITING = 64
"""Messages of the page that may wait."""
_PATIENCE = 0.05

Tell = Callable[[str | bytes], None]
"""Sends to the page; must not wait. Of frames the newest counts."""


class Session:
    """What one page does. Safe to talk to from the server's thread."""

    def __init__(self, shelf: Shelf, tell: Callable[[StageSet | Note | bytes], None]) -> None:
        self._shelf, self._tell = shelf, tell
        self._way = Way(next(iter(STEPPERS)), next(iter(MAPPERS)), 1.0, False)
        self._characters = list(CHARACTERS[:2])
        self._source: Source | None = None
        self._kind: SourceKind = "none"
        self._camera = PageCamera()
        self._stepper: Stepper | None = None
        self._stage = Stage()
        self._desk = Desk()
        self._recorder: Recorder | None = None
        self._recording: Path | None = None
        self._messages: Queue[Message] = Queue(_WAITING)
        self._stop = Event()
        self._thread = Thread(target=self._work, name="mien-session", daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def stop(self) -> None:
        """End the work, and wait until nothing is held any more."""
        self._stop.set()
        self._thread.join()

    def hear(self, message: Message) -> None:
        """What the page asks for. Raises InputError where it asks faster than can be done."""
        try:
            self._messages.put_nowait(message)
        except Full as error:
            raise InputError("the page asks for more than can be done") from error

    def see(self, data: bytes) -> None:
        """A picture of the page's camera: float64 seconds, then a JPEG. Raises InputError."""
        if not 8 < len(data) <= LARGEST_PICTURE:
            raise InputError("the page sent a picture that cannot be used")
        (time,) = struct.unpack("<d", data[:8])
        if not 0.0 <= time < 1e7:
            raise InputError("the page's clock cannot be right")
        self._camera.put(time, data[8:])

    def _work(self) -> None:
        try:
            self._set_stage()
            while not self._stop.is_set():
                try:
                    self._obey()
                    self._play()
                except MienError as error:
                    self._tell(Note(str(error), "error"))
                    self._look_away()
        finally:
            self._finish_recording()
            self._look_away()
            if self._stepper is not None:
                self._stepper.close()

    def _obey(self) -> None:
        while True:
            try:
                message = self._messages.get_nowait()
            except Empty:
                return
            self._do(message)

    @singledispatchmethod
    def _do(self, message: Message) -> None:
        raise InputError("the page asks for something unknown")

    @_do.register
    def _(self, message: Cast) -> None:
        wanted = list(dict.fromkeys(message.characters))
        if not 0 < len(wanted) <= MOST_ON_STAGE or not set(wanted) <= set(CHARACTERS):
            raise InputError(f"on stage there is room for 1 to {MOST_ON_STAGE} of the cast")
        self._characters = wanted
        self._set_stage()

    @_do.register
    def _(self, message: Way) -> None:
        if message.capture not in STEPPERS or message.mapping not in MAPPERS:
            raise InputError("there is no such capture or mapping")
        again = message.capture != self._way.capture or message.mirror != self._way.mirror
        self._way = message
        if again and self._stepper is not None:
            self._stepper.close()
            self._stepper = None
        self._set_stage()

    @_do.register
    def _(self, message: Learn) -> None:
        self._stage.learn()

    @_do.register
    def _(self, message: Adjust) -> None:
        self._desk.set(message)

    @_do.register
    def _(self, message: Look) -> None:
        self._look_away()
        self._source = self._opened(message)
        self._kind = message.source
        self._set_stage()

    @_do.register
    def _(self, message: Recording) -> None:
        self._finish_recording()
        if message.on:
            self._recording = self._shelf.new_take()
        self._announce()

    @_do.register
    def _(self, message: Seek) -> None:
        if isinstance(self._source, Tape):
            self._source.seek(message.time, message.playing)

    def _opened(self, look: Look) -> Source | None:
        if look.source == "camera":
            self._camera = PageCamera()
            return self._camera
        if look.source == "sample":
            with resources.as_file(resources.files("mien").joinpath("data", "sample.mp4")) as path:
                return Film(path, self._way.mirror)
        if look.source == "video":
            return Film(self._shelf.video(look.name), self._way.mirror)
        if look.source == "take":
            return Tape(self._shelf.take(look.name))
        return None

    def _look_away(self) -> None:
        if self._source is not None:
            self._source.close()
        self._source, self._kind = None, "none"

    def _set_stage(self) -> None:
        """A new stage for these characters and this way; and tell the page what is on it."""
        if self._kind in ("camera", "sample", "video") and self._stepper is None:
            self._stepper = STEPPERS[self._way.capture]()
        self._stage = Stage(
            [load_character(name) for name in self._characters],
            self._stepper,
            mapping=self._way.mapping,
            settings=Settings(gain=self._way.gain),
        )
        self._announce()

    def _announce(self) -> None:
        actors = [
            Actor(name, f"characters/{name}.glb", list(split(load_character(name)).names))
            for name in self._characters
        ]
        self._tell(
            StageSet(
                actors=actors,
                characters=list(CHARACTERS),
                captures=list(STEPPERS),
                mappings=list(MAPPERS),
                videos=self._shelf.videos(),
                takes=self._shelf.takes(),
                way=self._way,
                source=self._kind,
                recording=self._recording is not None,
            )
        )

    def _play(self) -> None:
        if self._source is None:
            self._stop.wait(_PATIENCE)
            return
        arrived = self._source.next(_PATIENCE)
        if arrived is None:
            return
        item = arrived.item
        if isinstance(item, Frame):
            if self._way.mirror and self._kind == "camera":
                item = replace(item, image=item.image[:, ::-1].copy())
            moment = self._stage.see(item)
            self._record(moment)
        else:
            moment = self._stage.show(item)
        self._tell(self._packet(arrived, moment))

    def _record(self, moment: Moment) -> None:
        if self._recording is None or moment.performance is None:
            return
        self._recorder = self._recorder or Recorder(self._recording, moment.performance)
        self._recorder.write(moment.performance)

    def _finish_recording(self) -> None:
        if self._recorder is not None:
            self._recorder.close()
        self._recorder = self._recording = None

    def _packet(self, arrived: Arrived, moment: Moment) -> bytes:
        late = 1e3 * (perf_counter() - arrived.at)
        sections = [packet.moment(moment.time, late, moment.state)]
        if arrived.place is not None:
            sections.append(packet.playing(*arrived.place))
        if isinstance(arrived.item, Frame) and self._stepper is not None:
            height, width = arrived.item.image.shape[:2]
            sections.append(packet.points(self._stepper.trace.points, (width, height)))
        if arrived.shown:
            sections.append(("JPEG", arrived.shown))
        adjusted = self._desk(moment.curves or {})
        for number, name in enumerate(self._characters):
            if name in adjusted:
                sections.append(packet.character(number, adjusted[name]))
        return packet.packet(sections)

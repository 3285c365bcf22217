"""One open page: its stage, its performer, its recording; worked on by a thread of its own."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace
from functools import singledispatchmethod
from importlib import resources
from queue import Empty, Full, Queue
from secrets import token_urlsafe
from threading import Event, Thread
from urllib.parse import quote

from mien.capture.detector import WITHOUT, installed
from mien.capture.known import landmark_section
from mien.capture.stepping import LandmarkStepper, Stepper, available, meet
from mien.errors import InputError, MienError
from mien.face.character import Character
from mien.formats.performer_file import read_performer, write_performer
from mien.live.stage import Moment, Stage
from mien.live.studio import packet
from mien.live.studio.adjust import Desk
from mien.live.studio.coach import HELD, Coach, key_poses, known_faces
from mien.live.studio.keeping import Keeping
from mien.live.studio.memory import give_back
from mien.live.studio.messages import (
    Actor,
    Adjust,
    Cast,
    Forget,
    Hold,
    Keep,
    Learnt,
    Look,
    Meet,
    Message,
    Note,
    Recording,
    Seek,
    StageSet,
    Told,
    Way,
)
from mien.live.studio.shelf import MODELS, PERFORMERS, TAKES, VIDEOS, Shelf
from mien.live.studio.sources import Arrived, Film, PageCamera, Recorded, Source, Tape
from mien.live.studio.troupe import Troupe, targets
from mien.mapping import MAPPERS, Settings
from mien.performance.curves import Curves
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace, Performer
from mien.recipe import animate, moving

MOST_ON_STAGE = 4
LARGEST_PICTURE = 4 * 2**20
_WAITING = 64
"""Messages of the page that may wait."""
_PATIENCE = 0.05

Tell = Callable[[Told | packet.Answer], None]
"""Sends to the page; must not wait. Of answers the newest counts."""


class Session:
    """What one page does. Safe to talk to from the server's thread."""

    def __init__(
        self, shelf: Shelf, troupe: Troupe, tell: Tell, performer: Performer | None = None
    ) -> None:
        """``performer`` is what is known of whoever will be seen."""
        self.name = token_urlsafe(9)
        """Nobody else's page knows it."""
        self._shelf, self._troupe, self._tell = shelf, troupe, tell
        self._way = Way(available()[0], next(iter(MAPPERS)), 1.0, False)
        self._characters = troupe.names()[:2]
        self._source: Source | None = None
        self._look = Look("none")
        self._camera = PageCamera()
        self._stepper: Stepper | None = None
        self._stage = Stage()
        self._desk = Desk()
        self._performer = performer or Performer()
        self._coach = Coach(known_faces(self._performer))
        self._keeping: Keeping | None = None
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

    def act(self, take: Performance, character: Character) -> Curves:
        """What a character makes of a take, the way this page has it; from any thread. Raises
        InputError."""
        way, faces = self._way, tuple(self._coach.faces)
        curves = animate(
            take,
            character,
            mapping=way.mapping,
            gain=way.gain,
            own=[face for face in faces if len(face.motion) == len(take.points)] or None,
        )
        return self._desk({character.name: curves})[character.name]

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
            if not installed():
                self._tell(Note(WITHOUT, "info"))
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
            self._stage = Stage()
            self._forget_stepper()

    def _obey(self) -> None:
        while True:
            try:
                self._do(self._messages.get_nowait())
            except Empty:
                return
            except MienError as error:
                self._tell(Note(str(error), "error"))

    @singledispatchmethod
    def _do(self, message: Message) -> None:
        raise InputError("the page asks for something unknown")

    @_do.register
    def _(self, message: Cast) -> None:
        wanted = list(dict.fromkeys(message.characters))
        if not 0 < len(wanted) <= MOST_ON_STAGE or not set(wanted) <= set(self._troupe.names()):
            raise InputError(f"on stage there is room for 1 to {MOST_ON_STAGE} of the cast")
        self._characters = wanted
        self._set_stage()

    @_do.register
    def _(self, message: Way) -> None:
        if message.capture not in available() or message.mapping not in MAPPERS:
            raise InputError("there is no such capture or mapping")
        again = message.capture != self._way.capture or message.mirror != self._way.mirror
        turned = message.mirror != self._way.mirror
        self._way = message
        if again:
            self._forget_stepper()
        if turned and isinstance(self._source, Film):
            self._source.close()
            self._source = self._opened(self._look)
        self._set_stage()

    @_do.register
    def _(self, message: Hold) -> None:
        try:
            self._coach.ask(message, self._pose(message))
        except InputError as error:
            self._tell(Learnt(message.task, message.pose, "refused", str(error)))
            return
        if message.task == "neutral":
            self._stage.learn()

    @_do.register
    def _(self, message: Forget) -> None:
        if 0 <= message.number < len(self._coach.faces):
            self._coach.faces.pop(message.number)
            self._set_stage()

    @_do.register
    def _(self, message: Keep) -> None:
        path = self._shelf.place(f"{message.name}.performer", PERFORMERS)
        known = self._stepper.known if isinstance(self._stepper, LandmarkStepper) else None
        write_performer(
            replace(
                self._performer,
                landmarks=landmark_section(known) if known else self._performer.landmarks,
                poses=key_poses(self._coach.faces),
                held=tuple(self._coach.faces),
                source=self._performer.source or "mien studio",
            ),
            path,
        )
        self._announce()

    @_do.register
    def _(self, message: Meet) -> None:
        self._performer = (
            read_performer(self._shelf.there(message.name, PERFORMERS))
            if message.name
            else Performer()
        )
        self._coach = Coach(known_faces(self._performer))
        self._forget_stepper()
        self._set_stage()

    @_do.register
    def _(self, message: Adjust) -> None:
        self._desk.set(message)

    @_do.register
    def _(self, message: Look) -> None:
        self._finish_recording()
        self._look_away()
        self._source = self._opened(message)
        self._look = message
        self._set_stage()

    @_do.register
    def _(self, message: Recording) -> None:
        self._finish_recording()
        if message.on:
            self._keeping = Keeping(self._shelf.new_take())
        self._announce()

    @_do.register
    def _(self, message: Seek) -> None:
        if isinstance(self._source, Recorded):
            self._source.seek(message.time, message.playing)

    def _opened(self, look: Look) -> Source | None:
        if look.source == "camera":
            self._camera = PageCamera()
            return self._camera
        if look.source == "sample":
            with resources.as_file(resources.files("mien").joinpath("data", "sample.mp4")) as path:
                return Film(path, self._way.mirror)
        if look.source == "video":
            return Film(self._shelf.there(look.name, VIDEOS), self._way.mirror)
        if look.source == "take":
            return Tape(moving(self._shelf.take(look.name)))
        return None

    def _look_away(self) -> None:
        if self._source is not None:
            self._source.close()
        self._source, self._look = None, Look("none")

    def _forget_stepper(self) -> None:
        if self._stepper is not None:
            self._stepper.close()
            self._stepper = None
            give_back()

    def _pose(self, hold: Hold) -> dict[str, float]:
        """What a face that is held stands for; nothing for a rest and for shut lids. Raises
        InputError where nobody could show it, or learn it."""
        if hold.task == "lids" and not isinstance(self._stepper, LandmarkStepper):
            raise InputError("this capture learns its lids by itself")
        if hold.task != "face":
            return {}
        if not hold.pose:
            pinned = self._desk.pinned(hold.character)
            if not pinned:
                raise InputError("nothing is pinned: drag weights first")
            return pinned
        meant = [hold.character] if hold.character else self._characters
        if not any(hold.pose in self._troupe.character(name).examples for name in meant):
            raise InputError(f"nobody on stage acts by '{hold.pose}'")
        return {hold.pose: 1.0}

    def _set_stage(self) -> None:
        """A new stage for these characters and this way; and tell the page what is on it."""
        if self._look.source in ("camera", "sample", "video") and self._stepper is None:
            self._stepper = meet(self._way.capture, self._performer)
        self._stage = Stage(
            [self._troupe.character(name) for name in self._characters],
            self._stepper,
            mapping=self._way.mapping,
            settings=Settings(gain=self._way.gain),
            held=self._heeded(),
        )
        self._announce()

    def _heeded(self) -> list[HeldFace]:
        """The held faces that count: of this capture, and of a take the same points."""
        faces = [face for face in self._coach.faces if face.capture == self._way.capture]
        if isinstance(self._source, Tape):
            count = len(self._source.points)
            faces = [face for face in faces if len(face.motion) == count]
        return faces

    def _announce(self) -> None:
        self._tell(
            StageSet(
                session=self.name,
                actors=[self._actor(name) for name in self._characters],
                characters=self._troupe.names(),
                models=self._shelf.names(MODELS),
                captures=list(available()),
                mappings=list(MAPPERS),
                videos=self._shelf.names(VIDEOS),
                takes=self._shelf.names(TAKES),
                performers=self._shelf.names(PERFORMERS),
                faces=self._coach.shown(),
                way=self._way,
                source=self._look.source,
                name=self._look.name,
                sound=self._sound(),
                recording=self._keeping is not None,
            )
        )

    def _actor(self, name: str) -> Actor:
        character = self._troupe.character(name)
        url = self._troupe.address(name)
        vrm = character.origin is not None and character.origin.hooks.vrm is not None
        return Actor(name, url, list(targets(character)), list(character.examples), vrm)

    def _sound(self) -> str:
        """Where the sound of what is played is, or nothing."""
        if self._look.source == "video":
            return f"videos/{quote(self._look.name)}"
        if self._look.source == "take" and self._shelf.sound(self._look.name).is_file():
            return f"takes/{quote(self._look.name)}/sound"
        return ""

    def _play(self) -> None:
        if self._source is None:
            self._stop.wait(_PATIENCE)
            return
        arrived = self._source.next(_PATIENCE)
        if arrived is None:
            return
        item = arrived.item
        if isinstance(item, Frame):
            if self._way.mirror and self._look.source == "camera":
                item = replace(item, image=item.image[:, ::-1].copy())
            moment = self._stage.see(item)
            if self._keeping is not None and moment.performance is not None:
                place = arrived.place[0] if arrived.place else None
                self._keeping.write(moment.performance, place)
            self._teach(moment)
        else:
            moment = self._stage.show(item)
        self._tell(self._answer(arrived, moment))
        self._stage.look_around()

    def _teach(self, moment: Moment) -> None:
        """Let the coach look; when it has seen enough, everybody knows."""
        if not self._coach.see(moment.time, moment.performance):
            return
        task = self._coach.task
        if task is not None and task.task == "lids" and isinstance(self._stepper, LandmarkStepper):
            try:
                self._stepper.learn_shut(HELD)
            except InputError as error:
                self._tell(self._coach.refuse(str(error)))
                return
        learnt = self._coach.judge(self._way.capture)
        self._tell(learnt)
        if learnt.task == "face" and learnt.quality != "refused":
            self._set_stage()

    def _finish_recording(self) -> None:
        keeping, self._keeping = self._keeping, None
        if keeping is not None:
            film = self._look.source == "video"
            keeping.close(self._shelf.there(self._look.name, VIDEOS) if film else None)

    def _answer(self, arrived: Arrived, moment: Moment) -> packet.Answer:
        sections = []
        if arrived.place is not None:
            sections.append(packet.playing(*arrived.place))
        if isinstance(arrived.item, Frame) and self._stepper is not None:
            height, width = arrived.item.image.shape[:2]
            sections += packet.traced(self._stepper.trace, (width, height))
        elif isinstance(arrived.item, Performance):
            sections.append(packet.posed(arrived.item))
        if self._coach.task is not None:
            sections.append(packet.holding(self._coach.share))
        if arrived.shown:
            sections.append(("JPEG", arrived.shown))
        adjusted = self._desk(moment.curves or {})
        for number, name in enumerate(self._characters):
            if name in adjusted:
                names = targets(self._troupe.character(name))
                sections.append(packet.character(number, adjusted[name], names))
        return packet.Answer(arrived.at, moment.time, moment.state, sections)

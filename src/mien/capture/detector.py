"""The landmark networks, behind one class. Nothing else imports them."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from importlib.util import find_spec
from math import inf
from pathlib import Path
from threading import Lock
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.capture.track import KEPT, LandmarkTrack
from mien.errors import MissingExtraError, NoFaceError
from mien.performance.frame import Frame
from mien.vocabulary.landmarks import ALL_LANDMARKS

_GRAPH = "modules/face_landmark/face_landmark_front_cpu.binarypb"
_LANDMARK = np.dtype([("", "V3"), ("x", "<f4"), ("", "V1"), ("y", "<f4"), ("", "V1"), ("z", "<f4")])
"""One landmark in the bytes of a NormalizedLandmarkList, between protobuf's tags."""
_TERMINAL = Lock()
"""Of two that silence it at once, one would give it back for good as the other left it."""

COUNTED = 1.0
"""Seconds between two moments at which the faces in view are counted."""

Progress = Callable[[int], None]
Beside = Callable[[Frame, NDArray[np.float32] | None], None]


WITHOUT = (
    "the landmark networks are not installed (pip install 'mien[landmarks]'); "
    "faces are followed by their curves (snakes)"
)


def installed() -> bool:
    """Whether the networks are there."""
    return find_spec("mediapipe") is not None


class Detector:
    """Follows one face from picture to picture (MediaPipe FaceMesh with irises, video mode)."""

    def __init__(self) -> None:
        self._mesh: Any = _face_mesh()
        self._counter: Any = None
        self._silent = False

    def __enter__(self) -> Detector:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._mesh.close()
        if self._counter is not None:
            self._counter.close()

    def faces(self, image: NDArray[np.uint8]) -> int:
        """How many faces ``image`` (H, W, 3) RGB shows; ``landmarks`` follows one of them."""
        with _quiet_stderr():
            if self._counter is None:
                from mediapipe.python.solutions.face_detection import FaceDetection

                self._counter = FaceDetection(min_detection_confidence=0.6)
            return len(self._counter.process(image).detections or ())

    def landmarks(
        self, image: NDArray[np.uint8], which: Sequence[int] = range(ALL_LANDMARKS)
    ) -> NDArray[np.float32] | None:
        """(N, 3) landmarks ``which`` of ``image`` (H, W, 3) RGB, or None where no face is seen.

        x right and y down in pixels from the picture's outer corner, z in the same scale.
        """
        # The networks talk to the terminal until each has seen its first face.
        with nullcontext() if self._silent else _quiet_stderr():
            found = self._mesh.process(image).multi_face_landmarks
        if not found:
            return None
        self._silent = True
        height, width = image.shape[:2]
        scale = np.array([width, height, width], dtype=np.float32)
        return np.asarray(_places(found[0])[np.asarray(which)] * scale)


def follow(
    frames: Iterable[Frame], progress: Progress | None = None, beside: Beside | None = None
) -> LandmarkTrack:
    """Landmarks of every frame; ``beside`` is shown each frame with its landmarks (N, 3), or None.

    Raises NoFaceError where not one frame shows a face.
    """
    time: list[float] = []
    points: list[NDArray[np.float32]] = []
    lost: list[bool] = []
    size = (0, 0)
    faces, counted = 1, -inf
    nothing = np.zeros((len(KEPT), 3), dtype=np.float32)
    with Detector() as detector:
        for frame in frames:
            seen = detector.landmarks(frame.image, KEPT)
            time.append(frame.time)
            points.append(nothing if seen is None else seen)
            lost.append(seen is None)
            size = (frame.image.shape[1], frame.image.shape[0])
            if frame.time - counted >= COUNTED:
                faces, counted = max(faces, detector.faces(frame.image)), frame.time
            if beside is not None:
                beside(frame, seen)
            if progress is not None:
                progress(len(time))
    if all(lost):
        raise NoFaceError(
            f"no face was found in {len(time)} frames; a face must be in view, upright and lit"
        )
    return LandmarkTrack(np.array(time), np.stack(points), np.array(lost), size, faces)


def _places(found: Any) -> NDArray[np.float32]:
    """(N, 3) of a NormalizedLandmarkList, out of its bytes: to ask for 1434 numbers one by one
    takes as long as a quarter of the networks."""
    told = np.frombuffer(found.SerializeToString(), _LANDMARK)
    return np.stack([told[axis] for axis in "xyz"], axis=1)


def _face_mesh() -> Any:
    """FaceMesh with irises, in video mode, for one face; but in the thread that asks.

    FaceMesh itself hands each picture to threads of its own: to wake them twice a picture costs
    half a millisecond at the pace of a camera, and each keeps memory that it does not give back.
    """
    try:
        with _quiet_stderr():
            import mediapipe
            from mediapipe.framework.calculator_pb2 import CalculatorGraphConfig
            from mediapipe.python.solution_base import SolutionBase

            # What the graph names is known once FaceMesh's module is there.
            from mediapipe.python.solutions import face_mesh as _  # noqa: F401

            graph = CalculatorGraphConfig.FromString(
                (Path(mediapipe.__file__).parent / _GRAPH).read_bytes()
            )
            graph.executor.add(type="ApplicationThreadExecutor")
            mesh = SolutionBase(
                graph_config=graph,
                side_inputs={"num_faces": 1, "with_attention": True, "use_prev_landmarks": True},
                outputs=["multi_face_landmarks"],
            )
            mesh.process(np.zeros((64, 64, 3), dtype=np.uint8))
    except ImportError as error:
        raise MissingExtraError("finding a face in a picture", "landmarks") from error
    return mesh


@contextmanager
def _quiet_stderr() -> Iterator[None]:
    """Keep what native code prints away from the terminal: no Python setting reaches it."""
    with _TERMINAL:
        sys.stderr.flush()
        kept = os.dup(2)
        with Path(os.devnull).open("wb") as sink:
            os.dup2(sink.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)

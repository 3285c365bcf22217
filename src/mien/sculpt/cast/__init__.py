"""The generic face and the four characters."""

from mien.sculpt.cast.generic import GENERIC_FACE
from mien.sculpt.cast.man import MAN
from mien.sculpt.cast.monkey import MONKEY
from mien.sculpt.cast.toy import TOY
from mien.sculpt.cast.woman import WOMAN
from mien.sculpt.sculpture import Sculpture

CAST: dict[str, Sculpture] = {
    sculpture.name: sculpture for sculpture in (GENERIC_FACE, MAN, WOMAN, MONKEY, TOY)
}

__all__ = ["CAST"]

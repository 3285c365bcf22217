"""Memory that is given back to the system when a page goes."""

from __future__ import annotations

import ctypes
import sys


def give_back() -> None:
    """Return what was freed. glibc keeps it instead, for every thread that ever ran: networks that
    come and go with their pages would hold a hundred megabytes more than they use."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:
        trim(0)

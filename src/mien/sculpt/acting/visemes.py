"""The fourteen visemes of MPEG-4, named by their first sound."""

from __future__ import annotations

from collections.abc import Mapping

from mien.sculpt.acting.expression import Expression

E = Expression

VISEMES: Mapping[str, Expression] = {
    "viseme_p": E(
        upper_thick=0.7, lower_thick=0.7, upper_lip=(0, -0.3, -0.8), lower_lip=(0, 0.2, -0.8)
    ),
    "viseme_f": E(
        jaw=1.0,
        lower_thick=0.6,
        lower_lip=(0, 1.6, -1.8),
        upper_lip=(0, 1.2, 0.6),
        upper_quarter=(0, 0.6, 0),
    ),
    "viseme_th": E(jaw=4.0, tongue=7.0, upper_lip=(0, 0.6, 0), lower_quarter=(0, -0.8, 0)),
    "viseme_t": E(
        jaw=3.0, corner=(2.0, 0.3, -1.5), upper_lip=(0, 0.8, 0), lower_quarter=(0, -0.8, 0)
    ),
    "viseme_k": E(
        jaw=5.0, corner=(1.5, 0, -1.0), upper_lip=(0, 0.8, 0), lower_quarter=(0, -1.0, 0)
    ),
    "viseme_ch": E(
        jaw=2.0,
        narrow=0.24,
        pucker=5.0,
        upper_lip=(0, 2.0, 0),
        lower_lip=(0, -2.0, 0),
        upper_quarter=(0, 1.4, 0),
        lower_quarter=(0, -1.4, 0),
        upper_thick=1.2,
        lower_thick=1.2,
    ),
    "viseme_s": E(
        jaw=1.5,
        corner=(4.0, 0.6, -2.5),
        upper_lip=(0, 1.0, 0),
        lower_lip=(0, -0.8, 0),
        upper_quarter=(0, 0.8, 0),
        lower_quarter=(0, -1.0, 0),
    ),
    "viseme_n": E(
        jaw=4.0, corner=(1.0, 0, -0.5), upper_lip=(0, 0.8, 0), lower_quarter=(0, -0.8, 0)
    ),
    "viseme_r": E(
        jaw=3.0, narrow=0.16, pucker=3.0, upper_lip=(0, 1.0, 0), upper_thick=1.15, lower_thick=1.15
    ),
    "viseme_a": E(
        jaw=14.0, corner=(1.0, 0, -1.0), lower_quarter=(0, -2.0, 0), upper_lip=(0, 0.8, 0)
    ),
    "viseme_e": E(
        jaw=7.0, corner=(5.0, 0.8, -3.0), upper_lip=(0, 1.2, -0.4), lower_quarter=(0, -2.0, 0)
    ),
    "viseme_i": E(
        jaw=3.0,
        corner=(7.0, 1.0, -4.0),
        upper_lip=(0, 1.2, -0.8),
        lower_lip=(0, -0.6, -0.6),
        lower_quarter=(0, -1.8, 0),
        cheek=(1.0, 1.5, 1.5),
    ),
    "viseme_o": E(
        jaw=9.0,
        narrow=0.24,
        pucker=4.0,
        upper_quarter=(0, 0.8, 0),
        upper_thick=1.25,
        lower_thick=1.25,
    ),
    "viseme_u": E(
        jaw=2.0,
        narrow=0.38,
        pucker=7.0,
        upper_lip=(0, 1.0, 0),
        lower_lip=(0, -1.2, 0),
        upper_thick=1.4,
        lower_thick=1.4,
    ),
}

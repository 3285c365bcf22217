"""What it costs to find the FAPs of a frame, [C] eq. 3, beside the solvers one would call oneself.

    python benchmarks/fap_qp.py [--frames 600] [--rounds 5] [--json]

The generic face speaks and nods by known FAPs, seen by one camera with 1 mm of noise, so that the
programme's matrix changes from frame to frame as the unseen direction turns. All solvers get the
same problems, one after the other, on one core:

    ours        from a Performance to values and certificates: matrices, solves, KKT residuals
    daqp        its own warm solve (Model.update, Model.solve) with the matrices at hand
    osqp        warm, 1e-6
    bvls        scipy.optimize.lsq_linear on the factored problem (fewer frames: it is slow)

Figures with "fixed" are of a head that does not turn: one matrix for all frames.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import daqp
import numpy as np
import osqp
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import lsq_linear

from mien.capture.landmarks import POINTS, SIGMA, SPANS
from mien.face.fap_targets import basis_of
from mien.face.library import generic_face
from mien.mapping.fap import FapProgramme
from mien.performance.acted import acted
from mien.performance.performance import Performance
from mien.vocabulary.fap import simple
from report import show

Array = NDArray[np.float64]

_SLOW = 25


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=600)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found = figures(options.frames, options.rounds)
    show("fap_qp", "FAPs of a frame, microseconds", found, options.json)


def figures(frames: int = 600, rounds: int = 5) -> dict[str, float]:
    """Medians over ``rounds``: qp_us and daqp_us a frame, their ratio qp_daqp_ratio, the same for
    a head that does not turn; osqp_us, bvls_us, and kkt, the largest KKT residual."""
    programme, turning = speaking(frames, turn=0.6)
    _, straight = speaking(frames, turn=0.0)
    result = beside_daqp(programme, turning, rounds, "")
    result |= beside_daqp(programme, straight, rounds, "fixed_")
    hessians, linear = programme.problem(turning, slice(0, frames))
    result["kkt"] = float(programme(turning).kkt.max())
    result["osqp_us"] = timed(lambda: by_osqp(hessians, linear, *programme.bounds)) / frames
    few = hessians[:_SLOW], linear[:_SLOW]
    result["bvls_us"] = timed(lambda: by_bvls(*few, *programme.bounds)) / len(few[1])
    return result


def beside_daqp(
    programme: FapProgramme, take: Performance, rounds: int, kind: str
) -> dict[str, float]:
    """Microseconds a frame of ours and daqp's, in turns, and the median of their ratios."""
    frames = len(take)
    hessians, linear = programme.problem(take, slice(0, frames))
    ours, theirs = [], []
    for _ in range(rounds):
        ours.append(timed(lambda: programme(take)) / frames)
        theirs.append(timed(lambda: bare(hessians, linear, *programme.bounds)) / frames)
    return {
        f"qp_{kind}us": statistics.median(ours),
        f"daqp_{kind}us": statistics.median(theirs),
        f"qp_{kind}daqp_ratio": statistics.median(a / b for a, b in zip(ours, theirs, strict=True)),
    }


def speaking(frames: int, turn: float) -> tuple[FapProgramme, Performance]:
    """The generic face saying something, its head turning by ``turn`` radians either way."""
    generic = generic_face()
    face, basis = generic.face, basis_of(generic)
    rows = face.points.index(POINTS)
    random = np.random.default_rng(5)
    time = np.arange(frames) / 30.0
    waves = np.sin(time[:, None] * random.uniform(1.0, 9.0, 66) + random.uniform(0.0, 6.0, 66))
    lower, upper = (np.array([getattr(fap, end) for fap in simple()]) for end in ("lower", "upper"))
    values = 0.6 * np.where(waves > 0, waves * upper, -waves * lower)
    motion = np.tensordot(values, face.points.at(basis.fields)[:, rows], axes=1)
    angle = turn * np.sin(time)
    take = acted(
        POINTS,
        face.points.at(face.vertices)[rows],
        motion + random.normal(0.0, 1.0, motion.shape),
        sigma=SIGMA,
        unseen=np.stack([np.sin(angle), np.zeros(frames), np.cos(angle)], axis=1),
        spans=SPANS,
    )
    return FapProgramme(take, basis, face), take


def timed(work: Callable[[], object]) -> float:
    """Microseconds."""
    begin = time.perf_counter()
    work()
    return 1e6 * (time.perf_counter() - begin)


def bare(hessians: Array, linear: Array, lower: Array, upper: Array) -> None:
    """daqp alone, warm from frame to frame."""
    model = daqp.Model()
    model.setup(hessians[0], linear[0], np.zeros((0, len(lower))), upper, lower)
    for i in range(len(linear)):
        if len(hessians) > 1:
            model.update(H=hessians[i], f=linear[i])
        else:
            model.update(f=linear[i])
        model.solve()


def by_osqp(hessians: Array, linear: Array, lower: Array, upper: Array) -> None:
    """osqp, warm from frame to frame."""
    triangle = np.triu_indices(len(lower))
    order = np.lexsort(triangle)
    rows, columns = triangle[0][order], triangle[1][order]
    first = sparse.csc_matrix((hessians[0][rows, columns], (rows, columns)))
    solver = osqp.OSQP()
    identity = sparse.eye(len(lower), format="csc")
    solver.setup(
        first, linear[0], identity, lower, upper, verbose=False, eps_abs=1e-6, eps_rel=1e-6
    )
    for hessian, f in zip(hessians, linear, strict=True):
        solver.update(Px=hessian[rows, columns], q=f)
        solver.solve()


def by_bvls(hessians: Array, linear: Array, lower: Array, upper: Array) -> None:
    """scipy's bounded least squares, which knows no warm start."""
    for hessian, f in zip(hessians, linear, strict=True):
        factor = np.linalg.cholesky(hessian)
        lsq_linear(factor.T, np.linalg.solve(factor, -f), (lower, upper), method="bvls")


if __name__ == "__main__":
    main()

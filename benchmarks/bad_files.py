"""What broken, hostile and hopeless files cost: each through `mien character check`, by itself.

    python benchmarks/bad_files.py FOLDER [--json]

Every file and folder in FOLDER, and four that are made here: a million morph targets, a cube, a
head whose shapes open no mouth, a head whose triangles meet in no surface. For each one line: what
came of it, wall time, processor time and memory. A machine that does other work makes wall times
long: processor time tells what the file itself took. Beside them an empty start of mien.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np

import mien
from mien.face.character import KeyModels
from mien.formats.gltf.buffer import GltfBuffer
from mien.formats.gltf.glb import write_glb
from report import show

WALL, MEMORY = 8.0, 3072.0
"""Seconds and megabytes that no file may take."""
POINTS = ("3.1", "3.3", "3.7", "3.11", "4.3", "8.3", "9.3", "8.1", "2.2", "2.3", "8.2", "2.1")


@dataclass(frozen=True)
class Run:
    """What a file came to."""

    name: str
    verdict: str
    wall: float
    cpu: float
    memory: float
    told: str


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    start = check("(an empty start)", ["--version"])
    with tempfile.TemporaryDirectory() as folder:
        files = [(file, []) for file in sorted(options.folder.iterdir()) if file.suffix != ".md"]
        runs = [
            check(file.name, ["character", "check", str(file), "--json", *more])
            for file, more in [*files, *made(Path(folder))]
        ]
    for run in runs:
        print(
            f"{run.name[:36]:36s} {run.verdict:8s} {run.wall:6.2f} s {run.cpu:6.2f} s "
            f"{run.memory:6.0f} MB  {run.told[:90]}"
        )
    count = {
        word: sum(run.verdict == word for run in runs) for word in ("refused", "noted", "read")
    }
    show(
        "bad_files",
        f"{len(runs)} broken, hostile and hopeless files",
        {
            **count,
            "traceback": sum(run.verdict == "FAILED" for run in runs),
            "wall_max_s": max(run.wall for run in runs),
            "cpu_max_s": max(run.cpu for run in runs),
            "start_s": start.wall,
            "start_cpu_s": start.cpu,
            "peak_mb": max(run.memory for run in runs),
            "over_limits": sum(run.wall > WALL or run.memory > MEMORY for run in runs),
        },
        options.json,
        f"{os.getloadavg()[0]:.1f} processes waited for {os.cpu_count()} processors",
    )


def check(name: str, arguments: list[str]) -> Run:
    """One run of the command, with its own time and memory."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begin = perf_counter()
        command = [shutil.which("mien", path=Path(sys.executable).parent) or "mien", *arguments]
        process = subprocess.Popen(command, stdout=out, stderr=err)
        _, status, usage = os.wait4(process.pid, 0)
        wall = perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode(errors="replace").strip())
    return Run(
        name,
        **_verdict(process.returncode, *texts),
        wall=wall,
        cpu=usage.ru_utime + usage.ru_stime,
        memory=usage.ru_maxrss / 1024,
    )


def _verdict(code: int, out: str, err: str) -> dict[str, str]:
    if code == 1 and len(err.splitlines()) == 1:
        return {"verdict": "refused", "told": err}
    if code != 0:
        return {"verdict": "FAILED", "told": err.splitlines()[-1] if err else ""}
    told = json.loads(out.splitlines()[-1]) if out.startswith("{") else {}
    notes = [*told.get("notes", ()), *told.get("doubts", ())]
    return {"verdict": "noted" if notes else "read", "told": "; ".join(notes)}


def made(folder: Path) -> Iterator[tuple[Path, list[str]]]:
    """Files that nobody keeps because they are large or easily made, with what their command
    needs."""
    yield _million(folder / "million targets.glb"), []
    yield _cube(folder / "cube.obj"), []
    head = mien.load_character("generic")
    points = folder / "points.toml"
    lines = [f'"{p}" = {(head.face.point(p) / 1e3).tolist()}' for p in POINTS]
    points.write_text("[points]\n" + "\n".join(lines) + "\n")
    for name, keep, torn in (
        ("no mouth", ("eyeBlinkLeft", "eyeBlinkRight", "browInnerUp"), 0),
        ("fins on every edge", ("eyeBlinkLeft", "jawOpen"), 3000),
    ):
        keys = KeyModels(keep, np.stack([head.keys[key] for key in keep]))
        face = head.face
        if torn:
            chance = np.random.default_rng(7)
            parts = list(face.parts)
            fins = parts[0].triangles[:torn].copy()
            fins[:, 2] = chance.integers(parts[0].first, parts[0].last, len(fins))
            parts[0] = replace(parts[0], triangles=np.concatenate([parts[0].triangles, fins]))
            face = replace(face, parts=tuple(parts))
        path = folder / f"{name}.glb"
        write_glb(path, replace(head, face=face, keys=keys, examples=keys.names))
        yield path, ["--points", str(points)]


def _million(path: Path) -> Path:
    buffer = GltfBuffer()
    places = buffer.add(np.eye(3, dtype=np.float32), "vertex", bounds=True)
    described = {"attributes": {"POSITION": places}, "targets": [{"POSITION": places}] * 10**6}
    path.write_bytes(
        buffer.glb(
            {
                "asset": {"version": "2.0"},
                "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [described]}],
            }
        )
    )
    return path


def _cube(path: Path) -> Path:
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    path.write_text("\n".join(lines + ["f " + " ".join(map(str, side)) for side in sides]) + "\n")
    return path


if __name__ == "__main__":
    main()

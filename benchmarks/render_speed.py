"""How fast a posed character becomes a picture.

    python benchmarks/render_speed.py [--size 512] [--json]

Ours: pose, shadow, four lights, smooth edges, one thread. Beside it, in turns and on the same
poses, moderngl over EGL where it is installed (``pip install moderngl``): the same mesh under one
Lambert light with four samples a pixel and no shadow, uploaded, drawn and read back. The figure
is the median over all characters and rounds.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.library import CHARACTERS, load_character
from mien.face.pieces import split
from mien.numeric.normals import vertex_normals
from mien.view.camera import Camera
from mien.view.renderer import Renderer
from report import show

Array = NDArray[np.float64]
Draw = Callable[[Array], object]

VERTEX_SHADER = """#version 330
uniform mat3 axes; uniform vec3 centre; uniform float height;
in vec3 place; in vec3 normal; in vec3 colour;
out vec3 shown;
void main() {
    vec3 seen = axes * (place - centre);
    gl_Position = vec4(seen.xy * 2.0 / height, -seen.z / 1000.0, 1.0);
    shown = colour * (0.3 + 0.7 * max(0.0, dot(normal, normalize(vec3(-0.55, 0.65, 0.75)))));
}"""
FRAGMENT_SHADER = """#version 330
in vec3 shown; out vec4 pixel;
void main() { pixel = vec4(pow(shown, vec3(1.0 / 2.2)), 1.0); }"""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=512, help="pixels a side (default 512)")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    camera = Camera(yaw=0.3, size=(options.size, options.size))

    ours: list[float] = []
    theirs: list[float] = []
    figures: dict[str, float] = {}
    notes = ""
    for name in CHARACTERS:
        character = load_character(name)
        poser, weights = _poser(character)
        renderer = Renderer(character.face)
        draws: list[tuple[list[float], Draw]] = [
            (ours, lambda places, renderer=renderer: renderer.render(places, camera))
        ]
        try:
            draws.append((theirs, moderngl_draw(character, camera)))
        except Exception as error:
            # No library, no EGL, no driver: each has an error of its own.
            notes = f"moderngl skipped: {error}"
        mine: list[float] = []
        for row in [weights[0], *weights[: options.rounds]]:
            for times, draw in draws:
                start = time.perf_counter()
                draw(poser.morph(row))
                times.append(1e3 * (time.perf_counter() - start))
            mine.append(ours[-1])
        # The first of each is the warm-up.
        for times, _ in draws:
            del times[-len(mine)]
        figures[f"{name}_ms"] = statistics.median(mine[1:])
    figures = {"ms": statistics.median(ours)} | figures
    if theirs:
        figures["moderngl_ms"] = statistics.median(theirs)
        figures["moderngl_ratio"] = figures["ms"] / figures["moderngl_ms"]
    title = f"ms a picture of {options.size} x {options.size} pixels"
    show("render_speed", title, figures, options.json, notes)


def _poser(character: Character) -> tuple[Poser, Array]:
    pieces = split(character)
    weights = np.random.default_rng(3).uniform(0.0, 0.3, (64, len(pieces.names)))
    return Poser(character.face, pieces), weights


def moderngl_draw(character: Character, camera: Camera) -> Draw:
    """A function that uploads places, draws and reads the picture back."""
    import moderngl

    context = moderngl.create_standalone_context(backend="egl")
    context.enable(moderngl.DEPTH_TEST)
    program = context.program(vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER)
    program["axes"].write(np.ascontiguousarray(camera.axes().T, dtype=np.float32))
    program["centre"].value = camera.centre
    program["height"].value = camera.height
    face = character.face
    triangles = np.ascontiguousarray(face.triangles, dtype=np.int32)
    vertex = np.zeros((len(face.vertices), 9), dtype=np.float32)
    vertex[:, 6:] = face.colours
    buffer = context.buffer(vertex.tobytes(), dynamic=True)
    layout = [(buffer, "3f 3f 3f", "place", "normal", "colour")]
    mesh = context.vertex_array(program, layout, context.buffer(triangles.tobytes()))
    smooth = context.framebuffer(
        [context.renderbuffer(camera.size, samples=4)],
        context.depth_renderbuffer(camera.size, samples=4),
    )
    plain = context.simple_framebuffer(camera.size)

    def draw(places: Array) -> bytes:
        vertex[:, :3], vertex[:, 3:6] = places, vertex_normals(places, triangles)
        buffer.write(vertex.tobytes())
        smooth.use()
        smooth.clear(0.6, 0.65, 0.7)
        mesh.render()
        context.copy_framebuffer(plain, smooth)
        return bytes(plain.read(components=3))

    return draw


if __name__ == "__main__":
    main()

"""Light on a face: from visible triangles to a picture, in two compiled passes.

Four lights stand round the camera: a warm key with a soft shadow, a cool fill, two rims; sky and
ground light everything by its openness. Diffuse light wraps round the terminator as it does on
skin (red furthest), highlights are GGX with Schlick's Fresnel, and a filmic curve (Narkowicz's
fit of ACES) brings all to the screen.

Walter et al. 2007, "Microfacet models for refraction": D = a^2 / (pi ((n.h)^2 (a^2 - 1) + 1)^2).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

# Python's checks of divisors would be branches, and keep the compiler from vector instructions.
_kernel = njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
_inlined = njit(cache=True, nogil=True, fastmath=True, error_model="numpy", forceinline=True)

DIRECTIONS = np.array(
    [[-0.55, 0.65, 0.75], [0.80, 0.15, 0.60], [0.75, 0.35, -0.75], [-0.80, 0.45, -0.65]]
)
"""(4, 3) towards key, fill and the rims: right, up and towards the camera."""
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)

_KEY = np.array([1.80, 1.67, 1.51], dtype=np.float32)
_FILL = np.array([0.45, 0.52, 0.62], dtype=np.float32)
_RIM = np.array([1.09, 1.12, 1.16], dtype=np.float32)
_SKY = np.array([0.37, 0.42, 0.48], dtype=np.float32)
_GROUND = np.array([0.29, 0.24, 0.21], dtype=np.float32)
_WRAP = np.array([0.42, 0.20, 0.13], dtype=np.float32)
_BLEED = np.array([0.35, 0.0, 0.0], dtype=np.float32)
"""How much of the penumbra on skin is filled: red light travels furthest inside."""
_GLOW = np.float32(1.6)
_EXPOSURE = 0.62

_SHADOW_BIAS = 1.6
"""mm a surface may lie behind its own shadow map."""
_TONE_MAX, _TONE_SIZE = 6.0, 16384
_GAP = 2.5
"""mm of depth inside one pixel that make an edge of it."""
_CONTRAST = 0.06
"""Difference of albedo inside one pixel that makes an edge of it."""

# Columns of a vertex, of which sixteen floats fill one line of the cache.
SCREEN, SHADOW, NORMAL, ALBEDO, OPENNESS = 0, 3, 6, 9, 12
VERTEX_COLUMNS = 16
ROUGHNESS, REFLECTANCE, SUBSURFACE, EMISSION = range(4)
"""Columns of the table of materials."""

# Samples are gathered until a block is full and then lit together. The rows of the block lie at
# constant distances in one array, from which the compiler sees that they do not overlap, and
# lights sixteen samples at once.
_BLOCK = 512
(_NX, _NY, _NZ, _SX, _SY, _SZ, _R, _G, _B, _OR, _OG, _OB) = (r * _BLOCK for r in range(12))
(_PX, _PY, _LIT, _ALPHA, _F0, _SKIN, _GLOWS, _SHARE, _ROWS) = (r * _BLOCK for r in range(12, 21))


def encode_srgb(linear: Array) -> Array:
    """Screen values 0..1 of linear light 0..1 (IEC 61966-2-1)."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def tone_table() -> Floats:
    """Screen value 0..255 of linear light, in steps of _TONE_MAX / _TONE_SIZE."""
    x = (np.arange(_TONE_SIZE) + 0.5) * (_TONE_MAX / _TONE_SIZE) * _EXPOSURE
    filmic = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
    return np.asarray(255.0 * encode_srgb(filmic), dtype=np.float32)


@_kernel
def shade(
    ids: Ints,
    nearness: Floats,
    triangles: Ints,
    material_of: Ints,
    materials: Floats,
    vertex: Floats,
    rays: Floats,
    lights: Floats,
    shadow: Floats,
    distance: float,
    tone: Floats,
    picture: Floats,
) -> None:
    """Paint ``picture`` (H * W, 3), which comes with the background in screen values 0..255.

    ``ids`` and ``nearness`` (2H, 2W) are four samples a pixel. A pixel inside one surface is
    shaded once, a pixel on an edge once a sample: edges are smooth at little more than the price
    of one sample. ``vertex`` (V, 16) has the columns named above, its screen in samples, its
    shadow in cells of the map ``shadow``. ``rays`` (3, 3): a sample at (x, y) is seen from along
    x rays[0] + y rays[1] + rays[2].
    """
    rows, columns = ids.shape[0] // 2, ids.shape[1] // 2
    block = np.empty(_ROWS, dtype=np.float32)
    sent = np.empty(3 * _BLOCK, dtype=np.float32)
    pixel_of = np.empty(_BLOCK, dtype=np.int32)
    filled = np.int64(0)
    for y in range(rows):
        for x in range(columns):
            pixel, left, top = y * columns + x, 2 * x, 2 * y
            a, b = ids[top, left], ids[top, left + 1]
            c, d = ids[top + 1, left], ids[top + 1, left + 1]
            covered = (a >= 0) + (b >= 0) + (c >= 0) + (d >= 0)
            samples = 0
            if covered > 0:
                background = np.float32(1.0 - 0.25 * covered)
                for channel in range(3):
                    picture[pixel, channel] *= background
                samples = 4
                if (a == b and a == c and a == d) or (
                    covered == 4
                    and _depth(nearness, left, top) * distance < _GAP
                    and _alike(triangles, material_of, vertex, a, b)
                    and _alike(triangles, material_of, vertex, a, c)
                    and _alike(triangles, material_of, vertex, a, d)
                ):
                    samples = 1
            for sample in range(samples):
                sx, sy = sample & 1, sample >> 1
                t = ids[top + sy, left + sx]
                if t < 0:
                    continue
                px = left + (1.0 if samples == 1 else sx + 0.5)
                py = top + (1.0 if samples == 1 else sy + 0.5)
                _gather(block, filled, px, py, t, triangles, vertex)
                _dress(block, filled, material_of[t], materials, 1.0 / samples)
                pixel_of[filled] = pixel
                filled += 1
            if filled > _BLOCK - 4 or pixel == rows * columns - 1:
                _expose(block, filled, lights, shadow)
                _light(block, filled, rays, lights, sent)
                _develop(block, sent, pixel_of, filled, tone, picture)
                filled = np.int64(0)


@_inlined
def _depth(nearness: Floats, left: int, top: int) -> np.float32:
    """Difference of nearness in the four samples of a pixel."""
    a, b = nearness[top, left], nearness[top, left + 1]
    c, d = nearness[top + 1, left], nearness[top + 1, left + 1]
    return np.float32(max(a, b, c, d) - min(a, b, c, d))


@_inlined
def _alike(triangles: Ints, material_of: Ints, vertex: Floats, t: int, other: int) -> bool:
    """Whether two triangles may be taken for one surface of one colour."""
    i, j = triangles[t, 0], triangles[other, 0]
    if material_of[t] != material_of[other]:
        return False
    difference = np.float32(0.0)
    for c in range(ALBEDO, ALBEDO + 3):
        difference = max(difference, abs(vertex[i, c] - vertex[j, c]))
    return bool(difference < _CONTRAST)


@_inlined
def _gather(
    block: Floats,
    slot: np.int64,
    px: float,
    py: float,
    t: int,
    triangles: Ints,
    vertex: Floats,
) -> None:
    """Interpolate the three corners at a place on the screen, made right for perspective by their
    nearness."""
    i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    one = np.float32(1.0)
    ax, ay = vertex[i, 0], vertex[i, 1]
    bx, by = vertex[j, 0] - ax, vertex[j, 1] - ay
    cx, cy = vertex[k, 0] - ax, vertex[k, 1] - ay
    dx, dy = np.float32(px) - ax, np.float32(py) - ay
    area = bx * cy - by * cx
    # Open sheets are seen from behind too, and then face the other way (y runs down).
    side = np.float32(-1.0) if area > 0.0 else one
    scale = one / area
    v = min(one, max(np.float32(0.0), (dx * cy - dy * cx) * scale))
    w = min(one - v, max(np.float32(0.0), (bx * dy - by * dx) * scale))
    u = (one - v - w) * vertex[i, 2]
    v *= vertex[j, 2]
    w *= vertex[k, 2]
    scale = one / (u + v + w)
    u *= scale
    v *= scale
    w *= scale
    block[_PX + slot] = px
    block[_PY + slot] = py
    for c in range(3):
        block[_SX + c * _BLOCK + slot] = (
            u * vertex[i, SHADOW + c] + v * vertex[j, SHADOW + c] + w * vertex[k, SHADOW + c]
        )
        block[_NX + c * _BLOCK + slot] = side * (
            u * vertex[i, NORMAL + c] + v * vertex[j, NORMAL + c] + w * vertex[k, NORMAL + c]
        )
        block[_R + c * _BLOCK + slot] = (
            u * vertex[i, ALBEDO + c] + v * vertex[j, ALBEDO + c] + w * vertex[k, ALBEDO + c]
        )
        block[_OR + c * _BLOCK + slot] = (
            u * vertex[i, OPENNESS + c] + v * vertex[j, OPENNESS + c] + w * vertex[k, OPENNESS + c]
        )


@_inlined
def _dress(block: Floats, slot: np.int64, kind: int, materials: Floats, share: float) -> None:
    block[_ALPHA + slot] = materials[kind, ROUGHNESS] * materials[kind, ROUGHNESS]
    block[_F0 + slot] = materials[kind, REFLECTANCE]
    block[_SKIN + slot] = materials[kind, SUBSURFACE]
    block[_GLOWS + slot] = materials[kind, EMISSION]
    block[_SHARE + slot] = share


@_kernel
def _expose(block: Floats, count: np.int64, lights: Floats, shadow: Floats) -> None:
    """Find how much of the key light reaches gathered samples."""
    zero, one = np.float32(0.0), np.float32(1.0)
    kx, ky, kz = lights[0, 0], lights[0, 1], lights[0, 2]
    for s in range(count):
        nx, ny, nz = block[_NX + s], block[_NY + s], block[_NZ + s]
        length = np.sqrt(nx * nx + ny * ny + nz * nz + np.float32(1e-12))
        steep = (nx * kx + ny * ky + nz * kz) / length
        if steep < np.float32(-0.45):
            block[_LIT + s] = zero
            continue
        steep = min(one, max(steep, np.float32(0.15)))
        bias = np.float32(1.7) * np.sqrt(one - steep * steep) / steep + np.float32(_SHADOW_BIAS)
        block[_LIT + s] = _lit(shadow, block[_SX + s], block[_SY + s], block[_SZ + s] + bias)


@_inlined
def _lit(shadow: Floats, x: np.float32, y: np.float32, depth: np.float32) -> np.float32:
    """Share of the key light that reaches a place: 5 x 5 comparisons, bilinear at the border."""
    one = np.float32(1.0)
    column, row = int(x) - 3, int(y) - 3
    if column < 0 or row < 0 or column + 5 >= shadow.shape[1] or row + 5 >= shadow.shape[0]:
        return one
    reached = (
        (depth >= shadow[row, column])
        + (depth >= shadow[row, column + 5])
        + (depth >= shadow[row + 5, column])
        + (depth >= shadow[row + 5, column + 5])
        + (depth >= shadow[row + 2, column + 3])
        + (depth >= shadow[row + 3, column + 2])
    )
    if reached == 6:
        return one
    if reached == 0:
        return np.float32(0.0)
    fx, fy = x - np.float32(column + 3), y - np.float32(row + 3)
    total = np.float32(0.0)
    for dy in range(6):
        r = row + dy
        line = (
            (one - fx) * np.float32(depth >= shadow[r, column])
            + np.float32(depth >= shadow[r, column + 1])
            + np.float32(depth >= shadow[r, column + 2])
            + np.float32(depth >= shadow[r, column + 3])
            + np.float32(depth >= shadow[r, column + 4])
            + fx * np.float32(depth >= shadow[r, column + 5])
        )
        total += line * ((one - fy) if dy == 0 else (fy if dy == 5 else one))
    return total * np.float32(0.04)


@_inlined
def _highlight(
    n_l: np.float32,
    n_v: np.float32,
    n_h: np.float32,
    v_h: np.float32,
    alpha: np.float32,
    f0: np.float32,
) -> np.float32:
    """GGX times Schlick's visibility and Fresnel terms, times the cosine."""
    one = np.float32(1.0)
    square = alpha * alpha
    d = n_h * n_h * (square - one) + one
    k = np.float32(0.5) * alpha
    n_l = max(n_l, np.float32(0.0))
    seen = (n_l * (one - k) + k) * (n_v * (one - k) + k)
    away = one - v_h
    fresnel = f0 + (one - f0) * away * away * away * away * away
    return min(np.float32(6.0), square * fresnel * n_l / (np.float32(4.0) * d * d * seen))


@_kernel
def _light(block: Floats, count: np.int64, rays: Floats, lights: Floats, sent: Floats) -> None:
    """What light gathered samples send to the camera, into ``sent``, three rows like a block's."""
    zero, one = np.float32(0.0), np.float32(1.0)
    tiny, half = np.float32(1e-12), np.float32(0.5)
    kx, ky, kz = lights[0, 0], lights[0, 1], lights[0, 2]
    fx, fy, fz = lights[1, 0], lights[1, 1], lights[1, 2]
    lx, ly, lz = lights[2, 0], lights[2, 1], lights[2, 2]
    rx, ry, rz = lights[3, 0], lights[3, 1], lights[3, 2]
    rx_x, rx_y, rx_z = rays[0, 0], rays[0, 1], rays[0, 2]
    ry_x, ry_y, ry_z = rays[1, 0], rays[1, 1], rays[1, 2]
    r_x, r_y, r_z = rays[2, 0], rays[2, 1], rays[2, 2]
    for s in range(count):
        nx, ny, nz = block[_NX + s], block[_NY + s], block[_NZ + s]
        px, py = block[_PX + s], block[_PY + s]
        vx = px * rx_x + py * ry_x + r_x
        vy = px * rx_y + py * ry_y + r_y
        vz = px * rx_z + py * ry_z + r_z
        scale = one / np.sqrt(nx * nx + ny * ny + nz * nz + tiny)
        nx, ny, nz = nx * scale, ny * scale, nz * scale
        scale = one / np.sqrt(vx * vx + vy * vy + vz * vz + tiny)
        vx, vy, vz = vx * scale, vy * scale, vz * scale
        n_v = max(nx * vx + ny * vy + nz * vz, np.float32(0.02))
        alpha, f0, skin = block[_ALPHA + s], block[_F0 + s], block[_SKIN + s]
        lit, glow, open_ = block[_LIT + s], block[_GLOWS + s], block[_OG + s]

        n_k = nx * kx + ny * ky + nz * kz
        hx, hy, hz = kx + vx, ky + vy, kz + vz
        scale = one / np.sqrt(hx * hx + hy * hy + hz * hz + tiny)
        n_h = max(zero, (nx * hx + ny * hy + nz * hz) * scale)
        v_h = max(zero, (vx * hx + vy * hy + vz * hz) * scale)
        key_shine = lit * _highlight(n_k, n_v, n_h, v_h, alpha, f0)

        n_f = nx * fx + ny * fy + nz * fz
        hx, hy, hz = fx + vx, fy + vy, fz + vz
        scale = one / np.sqrt(hx * hx + hy * hy + hz * hz + tiny)
        n_h = max(zero, (nx * hx + ny * hy + nz * hz) * scale)
        v_h = max(zero, (vx * hx + vy * hy + vz * hz) * scale)
        fill_shine = half * open_ * _highlight(n_f, n_v, n_h, v_h, alpha, f0)

        # Rims show where the surface turns away.
        rim = max(zero, nx * lx + ny * ly + nz * lz) + max(zero, nx * rx + ny * ry + nz * rz)
        rim *= (one - n_v) * (one - n_v) * open_
        gloss = min(np.float32(0.22), np.float32(4.0) * f0)
        up = half + half * ny
        penumbra = skin * lit * (one - lit)
        for c in range(3):
            colour, openness = block[_R + c * _BLOCK + s], block[_OR + c * _BLOCK + s]
            wrap = _WRAP[c] * skin
            spread = one / (one + wrap)
            key = max(zero, (n_k + wrap) * spread) * (lit + _BLEED[c] * penumbra)
            key *= np.float32(0.45) + np.float32(0.55) * openness
            sky = max(zero, (n_f + wrap) * spread) * _FILL[c]
            sky += _SKY[c] * up + _GROUND[c] * (one - up)
            light = key * _KEY[c] + sky * openness + rim * _RIM[c]
            light = light * (one - glow) + _GLOW * glow
            shine = key_shine * _KEY[c] + fill_shine * _FILL[c] + rim * gloss * _RIM[c]
            sent[c * _BLOCK + s] = colour * light + shine


@_kernel
def _develop(
    block: Floats, sent: Floats, pixel_of: Ints, count: np.int64, tone: Floats, picture: Floats
) -> None:
    """Add the lit samples to the picture through the filmic curve."""
    scale = np.float32(_TONE_SIZE / _TONE_MAX)
    for s in range(count):
        for c in range(3):
            step = max(0, min(_TONE_SIZE - 1, int(sent[c * _BLOCK + s] * scale)))
            picture[pixel_of[s], c] += block[_SHARE + s] * tone[step]

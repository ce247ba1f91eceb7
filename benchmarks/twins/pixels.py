"""Pixels: blending, variance of blocks, colour conversion, distance transform."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16


@kernel
def alpha_blend(fore: u8[:], alpha: u8[:], image: u8[:], n: i32) -> None:
    for i in range(n):
        a = alpha[i]
        if a == 0:
            continue
        if a == 255:
            image[i] = fore[i]
            continue
        t = fore[i] * a + image[i] * (255 - a) + 128
        image[i] = (t + (t >> 8)) >> 8


@kernel
def variance_blocks(src: u8[:], w: i32, h: i32, out: u16[:]) -> None:
    k = 0
    for y0 in range(0, h, 8):
        for x0 in range(0, w, 8):
            total = 0
            squares = 0
            for y in range(y0, y0 + 8):
                for x in range(x0, x0 + 8):
                    v = src[y * w + x]
                    total += v
                    squares += v * v
            out[k] = (squares - ((total * total) >> 6)) >> 6
            k += 1


@kernel
def clamp8(v: i32) -> i32:
    if v < 0:
        return 0
    if v > 255:
        return 255
    return v


@kernel
def yuv_to_rgb(y: u8[:], u: u8[:], v: u8[:], rgb: u8[:], n: i32) -> None:
    for i in range(n):
        c = 298 * (y[i] - 16) + 128
        d = u[i] - 128
        e = v[i] - 128
        rgb[3 * i] = clamp8((c + 409 * e) >> 8)
        rgb[3 * i + 1] = clamp8((c - 100 * d - 208 * e) >> 8)
        rgb[3 * i + 2] = clamp8((c + 516 * d) >> 8)


@kernel
def chamfer(dist: u8[:], w: i32, h: i32) -> None:
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            p = y * w + x
            d = dist[p]
            if d != 0:
                side = min(dist[p - 1], dist[p - w])
                corner = min(dist[p - w - 1], dist[p - w + 1])
                side += 3
                corner += 4
                d = min(d, side)
                d = min(d, corner)
                dist[p] = d
    for y in range(h - 2, 0, -1):
        for x in range(w - 2, 0, -1):
            p = y * w + x
            d = dist[p]
            if d != 0:
                side = min(dist[p + 1], dist[p + w])
                corner = min(dist[p + w + 1], dist[p + w - 1])
                side += 3
                corner += 4
                d = min(d, side)
                d = min(d, corner)
                dist[p] = d


def play_blend(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    fore, image, alpha = (lcg.bytes(800) for _ in range(3))
    alpha[alpha < 80] = 0
    alpha[alpha > 200] = 255
    run(fore, alpha, image, 800)
    return (image,)


def play_variance(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(32, np.uint16)
    run(lcg.bytes(64 * 32), 64, 32, out)
    return (out,)


def play_yuv(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rgb = np.zeros(600, np.uint8)
    run(lcg.bytes(200), lcg.bytes(200), lcg.bytes(200), rgb, 200)
    return (rgb,)


def play_chamfer(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dist = np.where(lcg.bytes(32 * 24) < 12, 0, 255).astype(np.uint8)
    run(dist, 32, 24)
    return (dist,)


CASES = (
    Case(alpha_blend, 1128, play_blend),
    Case(variance_blocks, 1130, play_variance),
    Case(yuv_to_rgb, 1132, play_yuv),
    Case(chamfer, 1134, play_chamfer),
)

"""Python twins of C kernels that GCC compiled for the Blackfin and the GNU simulator ran."""

from __future__ import annotations

from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def gray_from_uyvy_row(uyvy: u8[:], y: u8[:], n: i32):
    for i in range(n):
        y[i] = uyvy[2 * i + 1]


@kernel
def gauss3_row(r0: u8[:], r1: u8[:], r2: u8[:], out: u8[:], w: i32):
    out[0] = r1[0]
    for x in range(1, w - 1):
        a = r0[x - 1] + 2 * r0[x] + r0[x + 1]
        b = r1[x - 1] + 2 * r1[x] + r1[x + 1]
        c = r2[x - 1] + 2 * r2[x] + r2[x + 1]
        out[x] = (a + 2 * b + c) >> 4
    out[w - 1] = r1[w - 1]


@kernel
def sobel_row(r0: u8[:], r1: u8[:], r2: u8[:], gx: i16[:], gy: i16[:], w: i32):
    gx[0] = 0
    gy[0] = 0
    for x in range(1, w - 1):
        left = r0[x - 1] + 2 * r1[x - 1] + r2[x - 1]
        right = r0[x + 1] + 2 * r1[x + 1] + r2[x + 1]
        top = r0[x - 1] + 2 * r0[x] + r0[x + 1]
        bottom = r2[x - 1] + 2 * r2[x] + r2[x + 1]
        gx[x] = right - left
        gy[x] = bottom - top
    gx[w - 1] = 0
    gy[w - 1] = 0


@kernel
def isqrt32(v: u32) -> u32:
    root: u32 = 0
    bit: u32 = 1 << 30
    for _ in range(16):
        trial = root + bit
        root = root >> 1
        if v >= trial:
            v = v - trial
            root = root + bit
        bit = bit >> 2
    return root


@kernel
def isqrt_row(gx: i16[:], gy: i16[:], mag: u16[:], n: i32):
    for i in range(n):
        x = gx[i]
        y = gy[i]
        mag[i] = i32(isqrt32(u32(x * x + y * y)))


@kernel
def nms_row(m0: u8[:], m1: u8[:], m2: u8[:], direction: u8[:], out: u8[:], w: i32):
    out[0] = 0
    for x in range(1, w - 1):
        m = m1[x]
        sector = ((direction[x] + 16) >> 5) & 3
        if sector == 0:
            a = m1[x - 1]
            b = m1[x + 1]
        elif sector == 1:
            a = m0[x - 1]
            b = m2[x + 1]
        elif sector == 2:
            a = m0[x]
            b = m2[x]
        else:
            a = m0[x + 1]
            b = m2[x - 1]
        if m >= a and m > b:
            out[x] = m
        else:
            out[x] = 0
    out[w - 1] = 0


@kernel
def erode32_row(r0: u32[:], r1: u32[:], r2: u32[:], out: u32[:], w: i32):
    out[0] = 0
    for x in range(1, w - 1):
        a = r0[x - 1] & r0[x] & r0[x + 1]
        b = r1[x - 1] & r1[x] & r1[x + 1]
        c = r2[x - 1] & r2[x] & r2[x + 1]
        out[x] = a & b & c
    out[w - 1] = 0


@kernel
def remap_row(src: u8[:], lut: u32[:], dst: u8[:], n: i32):
    for x in range(n):
        dst[x] = src[lut[x]]


@kernel
def copy_words(src: u32[:], dst: u32[:], n: i32):
    for i in range(n):
        dst[i] = src[i]


@kernel
def insertion_sort_u16(a: u16[:], n: i32):
    for i in range(1, n):
        v = a[i]
        j = i - 1
        while j >= 0 and a[j] > v:
            a[j + 1] = a[j]
            j = j - 1
        a[j + 1] = v


@kernel
def match_lines(
    ax: i16[:], ay: i16[:], aa: u8[:], n: i32,
    bx: i16[:], by: i16[:], ba: u8[:], m: i32,
    thr: i32, max_d2: i32, match: i16[:],
) -> i32:  # fmt: skip
    count = 0
    for i in range(n):
        x = ax[i]
        y = ay[i]
        a = aa[i]
        best = -1
        best_d2 = max_d2
        for j in range(m):
            diff = (a - ba[j]) & 127
            if diff > 64:
                diff = 128 - diff
            if diff < thr:
                dx = x - bx[j]
                dy = y - by[j]
                d2 = dx * dx + dy * dy
                if d2 < best_d2:
                    best_d2 = d2
                    best = j
        match[i] = best
        if best >= 0:
            count = count + 1
    return count

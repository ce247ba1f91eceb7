"""Kernels of which an estimate once ended in a traceback: drawn by chance, or written by people who had not seen it."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2, CompilerProfile
from tests.kernel.beside_gcc import check_estimate, check_meaning

PLACE = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    found = 0
    c = 0
    while c < n and found == 0:
        if a[c] == 7:
            found = c + 1
        c += 1
    return found
"""
NUMBERS = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    y = 0
    k = 0
    for i in range(n):
        c = 0
        while c < t:
            if 5 >= 8 and 1 < 8:
                d = 0
                while d < t and k == 0:
                    y = a[y & 127]
                e = 0
                while e < n and a[e & 127] != 8:
                    y = k
            c += 1
    return y + k
"""
SURE = """
def f(n: i32, t: i32) -> i32:
    x = 3
    for i in range(n):
        if n - i < n:
            x += 255
            for j in range(60):
                if x != 255:
                    break
            x = 0
        elif t < i ^ n:
            x = 0
        else:
            c = 0
            while c < n:
                x = (t << 1) // 2
    return x
"""
OTHER_ENDS = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    x = 0
    y = 0
    k = 0
    for i in range(n):
        c = 0
        while c < 9:
            if a[k & 127] > 5:
                d = 0
                while d < n and k == 0:
                    if t == 255:
                        break
                    if a[y & 127] == x:
                        y += 2
                    d += 1
                y = (y - (15 & (i >> 1))) & 0xffff
                if k < 0 and (a[y & 127] <= t or a[y & 127] != k >> 12):
                    x = a[k & 127]
            for e in range(7):
                k = (k + (a[i & 127] >> 5)) & 0xffff
            c += 1
    return x + y + k
"""
CHOICES = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    x = 0
    y = 0
    z = 0
    k = 0
    for i in range(n):
        for e in range(3):
            x -= 1
        c = 0
        while c < n and k == 0:
            c += 1
            if (8 if y < t else 9) < a[i & 127]:
                if (i ^ (4 if x >= a[i & 127] else 5)) <= 4:
                    k = (k - 63 * x) & 0xffff
                d = 0
                while d < 9 and k == 0:
                    x = a[i & 127]
                    d += 1
                if k <= 1:
                    y = 15 & 0xffff
            z = t & 0xffff
        g = 0
        while g < n and x == 0:
            g += 1
            if i > t:
                x += 2
    return x + y + z + k
"""
KERNELS = {"place": PLACE, "numbers": NUMBERS, "sure": SURE, "other ends": OTHER_ENDS, "choices": CHOICES}


def test_a_search_that_notes_the_place_is_near_what_gcc_makes(tmp_path: Path) -> None:
    """The way on from where something is found is known, of blocks without code one behind the other."""
    check_estimate(PLACE, 366, 0.07, tmp_path)


@pytest.mark.parametrize("profile", [GCC_O2, VDSP_O2], ids=str)
@pytest.mark.parametrize("name", KERNELS)
def test_what_is_costed_is_what_runs(name: str, profile: CompilerProfile, tmp_path: Path) -> None:
    check_meaning(KERNELS[name], profile, tmp_path)

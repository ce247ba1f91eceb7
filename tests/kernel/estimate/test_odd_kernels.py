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
OTHER_ENDS = """
def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    y = 0
    s = 0
    for i in range(n):
        c = 0
        while c < 9 and y < 50:
            y += a[(c + i) & 127] & 7
            if y == 13:
                s -= y
                break
            if b[c] > t:
                y -= 1
            c += 1
        if s < 1000:
            s += y
            y = 0
    return s - y
"""
CHOICES = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    x = 0
    y = 0
    z = 0
    k = 0
    for i in range(n):
        if 0 >= t and (k & a[k & 127]) > 5:
            y += abs(1 | a[k & 127])
        for c in range(7):
            d = 0
            while d < 3 and a[(d + c) & 127] != 6:
                k = i & 127
                d += 1
            if a[i & 127] >= t:
                for e in range(3, 9):
                    x += 2
                g = 0
                while g < 9 and y == 0:
                    g += 1
                if abs(y) != (0 if a[z & 127] <= 7 else 0):
                    y = abs(y)
                elif k == 2:
                    k += 3
                    z = a[z & 127]
                else:
                    k = a[z & 127]
    return x + y + z + k
"""
KERNELS = {"place": PLACE, "numbers": NUMBERS, "other ends": OTHER_ENDS, "choices": CHOICES}


def test_a_search_that_notes_the_place_is_near_what_gcc_makes(tmp_path: Path) -> None:
    """The way on from where something is found is known, of blocks without code one behind the other."""
    check_estimate(PLACE, 366, 0.07, tmp_path)


@pytest.mark.parametrize("profile", [GCC_O2, VDSP_O2], ids=str)
@pytest.mark.parametrize("name", KERNELS)
def test_what_is_costed_is_what_runs(name: str, profile: CompilerProfile, tmp_path: Path) -> None:
    check_meaning(KERNELS[name], profile, tmp_path)

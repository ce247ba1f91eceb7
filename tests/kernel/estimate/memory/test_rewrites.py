"""Loads and stores stand where GCC has them, whatever LLVM has made of the source."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bfsim.kernel import GCC_O2
from bfsim.kernel.operations import Op
from tests.kernel.modules import import_text
from tests.kernel.running import run

STRONGEST = """
@kernel
def keep(a: u8[:], b: u8[:], kind: u8[:], out: u8[:], limit: i32):
    for x in range(1, len(a) - 1):
        if kind[x] == 0:
            before = a[x - 1]
        elif kind[x] == 1:
            before = b[x - 1]
        else:
            before = b[x]
        if a[x] >= limit and a[x] >= before:
            out[x] = a[x]
        else:
            out[x] = 0
"""
COUNTED = """
@kernel
def count(a: u8[:], counts: i32[:], b: u8[:]):
    for x in range(len(a)):
        if a[x] > 7:
            counts[a[x] & 3] = counts[a[x] & 3] + 1
        else:
            counts[a[x] & 3] = b[x]
"""


def rows(seed: int, count: int, length: int = 40) -> list[np.ndarray]:
    """Random rows of bytes."""
    random = np.random.default_rng(seed)
    return [random.integers(0, 12, length, np.uint8) for _ in range(count)]


def test_a_load_on_each_way_is_made_on_each_way(tmp_path: Path) -> None:
    """`before` is loaded whether it is needed behind or not: one access an element, as in the source."""
    kernel = import_text(STRONGEST, tmp_path).keep
    a, b, kind, out = rows(1, 4)
    kind %= 3
    expected = out.copy()
    for x in range(1, len(a) - 1):
        before = a[x - 1] if kind[x] == 0 else b[x - 1] if kind[x] == 1 else b[x]
        expected[x] = a[x] if a[x] >= 6 and a[x] >= before else 0
    code = kernel.compile(GCC_O2)
    totals = code.new_totals()
    kernel.prepare(code, [a, b, kind, out], totals).run(a, b, kind, out, 6)
    np.testing.assert_array_equal(out, expected)
    reads = dict.fromkeys(("a", "b", "kind"), 0)
    writes = 0
    for counter, events in zip(code.counters, totals.tolist(), strict=True):
        for name, read, written in counter.array_accesses:
            reads[name] = reads.get(name, 0) + events * read
            writes += events * written
    inner = len(a) - 2
    of_a = int((kind[1:-1] == 0).sum())
    assert reads["a"] == inner + of_a
    assert reads["b"] == inner - of_a
    assert writes == inner


def test_stores_at_the_ends_of_both_sides_are_one(tmp_path: Path) -> None:
    """`out[x] = a[x]` or 0: one store, and a move on the condition, as `if cc R0 = R4`."""
    kernel = import_text(STRONGEST, tmp_path).keep
    charges = [
        each for counter in kernel.counters(GCC_O2) if counter.value is None for each in counter.charges
    ]
    assert sum(each.times for each in charges if each.op is Op.STORE8) == 1
    assert Op.COND_MOVE in {each.op for each in charges}


def test_what_the_stores_address_is_still_there(tmp_path: Path) -> None:
    """One side reads the element that it stores, the other one does not."""
    kernel = import_text(COUNTED, tmp_path).count
    a, b = rows(2, 2)
    counts, expected = np.zeros(4, np.int32), np.zeros(4, np.int32)
    for value, other in zip(a.tolist(), b.tolist(), strict=True):
        expected[value & 3] = expected[value & 3] + 1 if value > 7 else other
    run(kernel, a, counts, b, profile=GCC_O2)
    np.testing.assert_array_equal(counts, expected)


CHAINS = """
@kernel
def root(parents: u8[:], label: i32) -> i32:
    while parents[label] != label:
        label = parents[label]
    return label

@kernel
def halved(parents: u8[:], label: i32) -> i32:
    while parents[label] != label:
        parents[label] = parents[parents[label]]
        label = parents[label]
    return label

@kernel
def overwritten(parents: u8[:], seen: u8[:], label: i32) -> i32:
    while parents[label] != label:
        seen[0] = 1
        label = parents[label]
    return label
"""


@pytest.mark.parametrize(
    ("name", "others", "reads"), [("root", 0, 4), ("halved", 0, 5), ("overwritten", 1, 7)]
)
def test_what_was_loaded_to_be_tested_is_not_loaded_again(
    name: str, others: int, reads: int, tmp_path: Path
) -> None:
    """Of a chain of three steps each label is read once, and by `halved` its grandparent; twice if a store is between."""
    kernel = getattr(import_text(CHAINS, tmp_path), name)
    parents = np.array([0, 0, 1, 2, 3], np.uint8)
    arrays = [parents, *(np.ones(5, np.uint8) for _ in range(others))]
    code = kernel.compile(GCC_O2)
    totals = code.new_totals()
    assert kernel.prepare(code, arrays, totals).run(*arrays, 3).value == 0
    found = sum(
        events * read
        for counter, events in zip(code.counters, totals.tolist(), strict=True)
        for array, read, _ in counter.array_accesses
        if array == "parents"
    )
    assert found == reads
    if name == "halved":
        assert parents.tolist() == [0, 0, 1, 1, 3]


def test_a_moved_operand_does_not_share_the_register_of_the_sum(tmp_path: Path) -> None:
    """`halved` has three pointers; a moved index beside them is the fourth, which the caller's code needs: it is saved."""
    counters = import_text(CHAINS, tmp_path).halved.counters(GCC_O2)
    entry = [each.op for counter in counters for each in counter.charges if counter.value is None]
    assert Op.PUSH_MULTIPLE in entry
    root = [each.op for each in import_text(CHAINS, tmp_path).root.counters(GCC_O2)[0].charges]
    assert Op.PUSH_MULTIPLE not in root


TWO_LOOPS = """
@kernel
def f(x: i32, y: u32) -> u32:
    p = i32(1)
    q = x
    r = x >> 3
    for k0 in range(-1, (x * (i32(5) if y != 200 else 0)) & 15):
        if k0 >= r and (x == k0 or y < y):
            break
        k1 = i32(0)
        while k1 < 6 and q > 0:
            k1 += 1
        k2 = i32(0)
        while k2 < 3 and p != x:
            k2 += 1
    return y
"""


def test_a_rotation_that_would_cut_values_off_is_left(tmp_path: Path) -> None:
    """Two loops of two tests in a third one: the kernel is compiled, and computes what it did."""
    kernel = import_text(TWO_LOOPS, tmp_path).f
    kernel.compile(GCC_O2)
    assert kernel(7, 5) == 5


HASHED = """
@kernel
def slots(pixels: u16[:], keys: i32[:], counts: u16[:]):
    for p in pixels:
        slot = i32((u32(p) * u32(0x9E3779B1)) >> 16) & 63
        if keys[slot] == -1:
            keys[slot] = p
        counts[slot] += 1
"""


def test_a_factor_that_is_stored_elsewhere_is_no_other_product(tmp_path: Path) -> None:
    """What is multiplied is stored in another block, too: a use of it without a result."""
    kernel = import_text(HASHED, tmp_path).slots
    assert kernel.counters(GCC_O2)

"""The order of blocks is that of GCC's software trace cache: traces along likely edges, loops that end with a test, copies of returns."""

from __future__ import annotations

from pathlib import Path

from bfsim.kernel import GCC_O2
from bfsim.kernel.estimate.layout.traces import Edge, Graph, Layout, laid_out
from bfsim.kernel.operations import Op
from tests.kernel.modules import import_text

WAYS = tuple[tuple[str, float], ...]


def order(
    blocks: dict[str, tuple[float, WAYS]], *, size: int = 10, jumps: frozenset[tuple[str, str]] = frozenset()
) -> Layout:
    """Lay out blocks: of each its count and its ways with their probabilities; a way to a block before it is one back."""
    names = [*blocks]
    edges = {
        name: tuple(Edge(name, way, chance, count * chance, (name, way) not in jumps) for way, chance in ways)
        for name, (count, ways) in blocks.items()
    }
    back = frozenset(
        (name, way)
        for name, (_, ways) in blocks.items()
        for way, _ in ways
        if names.index(way) <= names.index(name)
    )
    return laid_out(
        Graph(
            names,
            edges,
            {name: count for name, (count, _) in blocks.items()},
            dict.fromkeys(names, size),
            {name: ways[0][0] for name, (_, ways) in blocks.items() if ways},
            back,
            frozenset(name for name, (_, ways) in blocks.items() if not ways),
        )
    )


def test_the_body_of_an_if_is_in_line_unless_it_is_rare() -> None:
    """Half as likely as what skips it is enough."""
    for chance, expected in ((0.4, ["test", "body", "end"]), (0.2, ["test", "end", "body"])):
        found = order(
            {
                "test": (1, (("body", chance), ("end", 1 - chance))),
                "body": (chance, (("end", 1.0),)),
                "end": (1, ()),
            },
            size=100,
        )
        assert found.order == expected


def test_a_loop_ends_with_its_test() -> None:
    """The header tests, the body jumps back: the test moves to the bottom. Where a counter does the jump, nothing moves."""
    blocks: dict[str, tuple[float, WAYS]] = {
        "entry": (1, (("header", 1.0),)),
        "header": (10, (("body", 0.9), ("end", 0.1))),
        "body": (9, (("header", 1.0),)),
        "end": (1, ()),
    }
    assert order(blocks).order == ["entry", "body", "header", "end"]
    counted = order(blocks, jumps=frozenset({("body", "header")}))
    assert counted.order == ["entry", "header", "body", "end"]


def test_a_small_return_is_copied() -> None:
    """Both sides of a test return by the same few instructions: the second side has them once more, behind it."""
    blocks: dict[str, tuple[float, WAYS]] = {
        "test": (1, (("one", 0.6), ("other", 0.4))),
        "one": (0.6, (("end", 1.0),)),
        "other": (0.4, (("end", 1.0),)),
        "end": (1, ()),
    }
    small, large = order(blocks, size=4), order(blocks, size=40)
    assert small.order == large.order == ["test", "one", "end", "other"]
    assert small.copied == {("other", "end")}
    assert large.copied == set()


def test_a_loop_that_nothing_ends_is_not_copied_behind_itself(tmp_path: Path) -> None:
    """Somebody has forgotten `i += 1`: the loop is one small block, whose copy would jump to a copy, and so on."""
    text = """
@kernel
def fill(a: u8[:]) -> None:
    i = 0
    while i < len(a):
        a[i] = 1
"""
    fill = import_text(text, tmp_path, "endless").fill
    assert 0 < fill.code_bytes(GCC_O2)["endless_fill"] < 30


def test_of_two_sides_as_likely_the_one_that_is_next_in_the_source_is_in_line(tmp_path: Path) -> None:
    """LLVM turns `if` and `else` round; GCC leaves the `if` first: odd numbers take no jump to get to their step."""
    text = """
@kernel
def steps(v: u32) -> i32:
    k = 0
    while v != 1:
        if (v & 1) != 0:
            v = 3 * v + 1
        else:
            v = v >> 1
        k += 1
    return k
"""
    kernel = import_text(text, tmp_path).steps
    odd = [each for each in kernel.counters(GCC_O2) if each.label.startswith("then") and each.value is None]
    assert Op.JUMP not in {charge.op for each in odd for charge in each.charges}

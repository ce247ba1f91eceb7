"""What is computed on each side of a test, in code in which LLVM has made copies of it."""

from __future__ import annotations

from bfsim.kernel import i32, kernel, u32


@kernel
def _by_turns(added: u32, start: i32) -> i32:
    s = start
    for k in range(3):
        if s & 1 != 0:
            s += i32(added) * 2
        else:
            s += k
    return s


def test_operations_of_copied_turns_keep_their_names_apart() -> None:
    """`s.1` of the second turn was what the other side of the first turn made, too: this returned 3."""
    assert _by_turns(1, 1) == 7
    assert _by_turns(7, 3) == 45

"""Calls that others are told of: a kernel that is checked before each call is prepared for that once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import pytest

from bfsim.api import Core, Frame, Kernel
from bfsim.machine.calls.watched_call import Sanitizer
from tests.machine.kernels import first, negate, spin
from tests.machine.rig import Play, every_frame, load, noise


def test_a_kernel_is_prepared_once_for_its_rows_and_checked_before_each_call(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With the numbers of that call; the records are the same as without."""
    prepared, checked = Counter[str](), Counter[str]()
    sanitizer = Kernel.sanitizer

    def seen(kernel: Kernel, arrays: Sequence[Any]) -> Callable[[Sequence[Any]], None]:
        prepared[kernel.name] += 1
        check = sanitizer(kernel, arrays)

        def counted(arguments: Sequence[Any]) -> None:
            checked[kernel.name] += 1
            check(arguments)

        return counted

    monkeypatch.setattr(Kernel, "sanitizer", seen)

    def work(core: Core, frame: Frame) -> Play:
        source, target = core.rows("in_ring")[0], core.rows("out_ring")[0]
        for cycles in range(1, 6):
            yield core.run(spin, cycles)
            yield core.run(negate, source, target)
        core.publish(found=(yield core.run(first, target)))

    plain = load(every_frame(work)).run(noise(3))
    board = load(every_frame(work))
    board.before_call = (Sanitizer(),)
    assert board.run(noise(3)) == plain
    assert prepared == {"spin": 1, "negate": 1, "first": 1}
    assert checked == {"spin": 15, "negate": 15, "first": 3}

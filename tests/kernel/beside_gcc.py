"""Small kernels beside what GCC makes of them: their arguments, how near an estimate is, and that what is estimated computes what Python does."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.kernel import GCC_O2, VDSP_O2, CompilerProfile, Kernel
from bfsim.kernel.types import ArrayType
from tests.kernel.modules import kernel_of
from tests.kernel.running import check_against_python

COUNT, LIMIT = 200, 100

Case = tuple[str, int, float]
"""The kernel `f`, cycles of GCC 12.2's code of its exported C in the GNU simulator, and how near the estimate is, a part of them."""


def arguments(kernel: Kernel) -> list[Any]:
    """Return numbers by chance, the same each time, and how many of them count."""
    random = np.random.default_rng(3)
    found: list[Any] = []
    for each in kernel.function.parameters:
        if each.name in ("n", "t"):
            found.append(COUNT if each.name == "n" else LIMIT)
            continue
        assert isinstance(each.type, ArrayType)
        kind = np.dtype(each.type.element.dtype)
        low, high = (0, 256) if kind.itemsize == 1 else (0 if kind.kind == "u" else -500, 500)
        found.append(random.integers(low, high, 256).astype(kind))
    return found


def check_estimate(text: str, cycles: int, near: float, folder: Path, helpers: str = "") -> None:
    """Assert that the estimate of the kernel `f` is as near, a part of it, as said to the cycles of GCC's code."""
    kernel = kernel_of(text, folder, helpers)
    assert kernel.cost(*arguments(kernel), profile="gcc-O2") == pytest.approx(cycles, rel=near)


def check_meaning(
    text: str, profile: CompilerProfile, folder: Path, counts: Sequence[int] = (), helpers: str = ""
) -> None:
    """Assert that the kernel `f` leaves what Python does; `counts` in turn are its numbers, or else those of `arguments`."""
    kernel = kernel_of(text, folder, helpers)
    for count in counts or (None,):
        given = arguments(kernel)
        if count is not None:
            given = [count if isinstance(each, int) else each for each in given]
        check_against_python(kernel, given, profile)


def beside_gcc(
    cases: Mapping[str, Case],
    *,
    others: Mapping[str, str] | None = None,
    counts: Sequence[int] = (),
    helpers: str = "",
) -> tuple[Callable[..., None], Callable[..., None]]:
    """Return two tests of each case: the estimate is near what GCC makes, and what is costed is what runs. Of `others` the second alone."""
    texts = {name: text for name, (text, _, _) in cases.items()} | dict(others or {})

    @pytest.mark.parametrize("name", cases)
    def near(name: str, tmp_path: Path) -> None:
        check_estimate(*cases[name], tmp_path, helpers)

    @pytest.mark.parametrize("profile", [GCC_O2, VDSP_O2], ids=str)
    @pytest.mark.parametrize("name", texts)
    def same(name: str, profile: CompilerProfile, tmp_path: Path) -> None:
        check_meaning(texts[name], profile, tmp_path, counts, helpers)

    return near, same

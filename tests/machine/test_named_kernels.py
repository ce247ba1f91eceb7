"""Kernels are found wherever firmware keeps what it calls: only what is found is placed by the linker, and played again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial, wraps
from typing import Any

import pytest

from bfsim.kernel import Kernel
from bfsim.machine import named_kernels
from bfsim.machine.named_kernels import kernels_named
from tests.machine import kernels
from tests.machine.kernels import copy, first, negate, spin


class Stage:
    """Runs a kernel in a method, one that its base class names, and one that it holds."""

    kept = spin

    def __init__(self, core: Any) -> None:
        self._core = core

    def method(self) -> Any:
        """Run a kernel that only a method names."""
        return self._core.run(copy)


class Derived(Stage):
    """Names no kernel itself."""


class Odd:
    """Has its kernels in methods of other kinds."""

    @staticmethod
    def static(core: Any) -> Any:
        """Run one."""
        return core.run(copy)

    @classmethod
    def of_class(cls, core: Any) -> Any:
        """Run another one."""
        return core.run(negate)

    @property
    def value(self) -> Kernel:
        """Return a third one."""
        return first

    @cached_property
    def later(self) -> Kernel:
        """Return a fourth one."""
        return spin


@dataclass(frozen=True, slots=True)
class Step:
    """Holds its kernel."""

    kernel: Kernel


def of_a_class(core: Any) -> Any:
    """Make a stage in the main loop."""
    yield Derived(core).method()


def of_methods(core: Any) -> Any:
    """Use methods of every kind."""
    yield Odd.static(core)
    yield Odd.of_class(core)


TABLE = {"copy": copy, "others": [(negate,), {first}]}
STEP = Step(spin)
BOUND = Stage(None).method
PARTIAL = partial(of_a_class, None)


def of_a_table(core: Any) -> Any:
    """Take kernels from a table."""
    yield core.run(TABLE["copy"])


def of_a_module(core: Any) -> Any:
    """Name a kernel by its module."""
    yield core.run(kernels.negate)


def of_an_object(core: Any) -> Any:
    """Take a kernel that an object holds."""
    yield core.run(STEP.kernel)


def of_a_bound_method(_: Any) -> Any:
    """Call the method of an object."""
    yield BOUND()


def of_a_partial(_: Any) -> Any:
    """Call what is bound to some arguments."""
    yield PARTIAL()


def of_a_default(core: Any, kernel: Kernel = negate) -> Any:
    """Take a kernel as a default."""
    yield core.run(kernel)


def decorated(main: Callable[..., Any]) -> Callable[..., Any]:
    """Return a main loop around another one."""

    @wraps(main)
    def inner(core: Any) -> Any:
        return main(core)

    return inner


@decorated
def of_the_decorated(core: Any) -> Any:
    """Stand in a closure."""
    yield core.run(first)


@pytest.mark.parametrize(
    ("main", "named"),
    [
        (of_a_class, {copy, spin}),
        (of_methods, {copy, negate, first, spin}),
        (of_a_table, {copy, negate, first}),
        (of_a_module, {negate}),
        (of_an_object, {spin}),
        (of_a_bound_method, {copy, spin}),
        (of_a_partial, {copy, spin}),
        (of_a_default, {negate}),
        (of_the_decorated, {first}),
    ],
)
def test_kernels_are_found_where_firmware_keeps_them(main: Callable[..., Any], named: set[Kernel]) -> None:
    """Each once, in the order of their symbols, and no others."""
    found = kernels_named(main)
    assert set(found) == named
    assert list(found) == sorted(named, key=lambda each: each.function.symbol)


def test_what_is_not_bound_yet_is_no_kernel() -> None:
    """A closure may have names that nothing was given to; a table may hold itself."""

    def main(core: Any) -> Any:
        yield core.run(copy, later, table)

    table: list[Any] = [negate]
    table.append(table)
    assert kernels_named(main) == (copy, negate)
    later = first
    assert set(kernels_named(main)) == {copy, negate, later}


def test_an_assertion_does_not_lead_into_pytest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which writes itself into each: 9,607 things were looked at in 46 ms, and 2 are."""
    looked = []
    monkeypatch.setattr(
        named_kernels, "_named", lambda each, real=named_kernels._named: looked.append(each) or real(each)
    )

    def main(core: Any) -> Iterator[object]:
        assert core
        yield core.run(negate)

    assert kernels_named(main) == (negate,)
    assert len(looked) < 100

"""Which kernel each instruction of an image is of."""

from __future__ import annotations

from bfsim.api import i32, kernel
from bfsim.blackfin.elf.image import Image, Routine
from bfsim.blackfin.elf.lines import Line, LineTable, Row
from bfsim.kernel.objects.places import Places


@kernel
def half(a: i32) -> i32:
    return a >> 1


@kernel
def quarter(a: i32) -> i32:
    return half(half(a))


def test_code_is_of_the_kernel_whose_symbol_is_there_whatever_line_it_begins_with() -> None:
    """The compiler has put `half` in the place of its calls, and `quarter`, and a clone of it, begin with a line of that."""
    routines = (
        Routine("_half", 0, 8),
        Routine("_quarter", 8, 16),
        Routine("_quarter.constprop.0", 16, 24),
    )
    image = Image("kernels.o", (), {each.name: each.address for each in routines}, routines, frozenset(), b"")
    functions = {f"_{each.name}": each.function for each in (half, quarter)}
    places = Places(image, functions, {each.symbol: each for each in functions.values()})
    inlined = Line(half.function.symbol, 3)
    places.lines = LineTable((Row(0, inlined),))
    assert [places.function_at(each.address).name for each in routines] == ["half", "quarter", "quarter"]
    assert places.line_of(8).routine == half.function.symbol
    assert places.functions.keys() == {each.symbol for each in functions.values()}

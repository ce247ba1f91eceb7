"""What Python says of a function in C is held against what its debugging information says. `blackfin/data/make` makes the file."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.api import f32, i8, i16, i32, kernel_from, u8, u16
from bfsim.errors import KernelError
from tests.sums import DATA

FILE = DATA / "prototypes.o"
SUM = "int sum(const unsigned char *row, int n)"
STEP = "void step(const short int *gains, struct state *state, void *scratch, float by, enum pace pace)"
WIDE = "double wide(double x, int n)"
TICKS = "long long int ticks(int n)"
AT = "int at(struct state state)"
DARKER = "unsigned char darker(const unsigned char *row, unsigned char limit, short int by)"
DARKENED = {"row": u8[:], "limit": u8, "by": i16, "result": u8}
STEPPED = {"gains": i16[:], "state": i32[:], "scratch": u8[:], "by": f32, "pace": i32}


@pytest.mark.parametrize(
    ("name", "declared", "why"),
    [
        ("sum", {"row": u8[:]}, "sum must be declared with 2 parameters, not 1 (row)"),
        ("sum", {"row": u8[:], "n": i32, "returns": i32}, "must be declared with 2 parameters, not 3 (row, n, returns)"),
        ("sum", {"n": i32, "row": u8[:]}, "row (n in C) of sum must be a number, not u8[:]"),
        ("sum", {"line": i16[:], "n": i32}, "line (row in C) of sum must be an array of 8-bit integers, not i16[:]"),
        ("sum", {"row": u8[:], "n": f32}, "n of sum must be an integer, not f32"),
        ("sum", {"row": u8[:], "n": i32, "result": f32}, "the result of sum must be an integer, not f32"),
        ("step", STEPPED | {"by": i32}, "by of step must be f32, not i32"),
        ("step", STEPPED | {"gains": f32[:]}, "gains of step must be an array of 16-bit integers, not f32[:]"),
        ("step", STEPPED | {"result": i32}, "step must have no `result`, for it returns nothing"),
    ],
)  # fmt: skip
def test_what_c_has_otherwise_is_refused(name: str, declared: dict[str, object], why: str) -> None:
    """It would read another register, or elements of another size, and return whatever that gives."""
    with pytest.raises(KernelError) as refused:
        kernel_from(FILE, name, **declared)
    assert why in str(refused.value)
    assert str(refused.value).endswith(f"; in prototypes.o it is `{SUM if name == 'sum' else STEP}`")


@pytest.mark.parametrize(
    ("name", "declared", "what", "prototype"),
    [
        ("wide", {"x": f32, "n": i32, "result": f32}, "x of wide", WIDE),
        ("ticks", {"n": i32, "result": i32}, "the result of ticks", TICKS),
        ("at", {"state": i32, "result": i32}, "state of at", AT),
    ],
)
def test_what_takes_more_than_a_register_is_refused(
    name: str, declared: dict[str, object], what: str, prototype: str
) -> None:
    """A double is in two registers, which no declaration says: half of it would be taken for a float, and 3.0 / 2 be 1e-19."""
    with pytest.raises(KernelError) as refused:
        kernel_from(FILE, name, **declared)
    must_be = f"{what} must be a number of at most 32 bits or a pointer in C, not "
    assert str(refused.value).startswith(must_be)
    assert str(refused.value).endswith(f"; in prototypes.o it is `{prototype}`")


@pytest.mark.parametrize(
    ("declared", "why"),
    [
        ({"result": i32}, "the result of darker must be u8, not i32"),
        ({"result": i8}, "the result of darker must be u8, not i8"),
        ({"limit": i32}, "limit of darker must be u8, not i32"),
        ({"by": u16}, "by of darker must be i16, not u16"),
    ],
)
def test_short_numbers_are_declared_as_such(declared: dict[str, object], why: str) -> None:
    """C's caller cuts what it hands over and extends what it gets: a byte of 200 came as -56, for GCC loads it with a sign."""
    with pytest.raises(KernelError) as refused:
        kernel_from(FILE, "darker", **(DARKENED | declared))
    assert str(refused.value) == f"{why}; in prototypes.o it is `{DARKER}`"


def test_short_numbers_are_extended_and_held_to_their_range() -> None:
    darker = kernel_from(FILE, "darker", **DARKENED)
    row = np.array([255, 203], np.uint8)
    assert [darker(row, 202, -1), darker(row, 220, 20), darker(row, 255, 0)] == [204, 183, 255]
    with pytest.raises(KernelError, match=r"by must be an int in -32768\.\.32767, not 40000"):
        darker(row, 0, 40000)


def test_an_array_of_doubles_is_told_from_one_of_floats() -> None:
    """It said that the array must be f32[:], not f32[:]."""
    with pytest.raises(KernelError, match=r"values of halve must be an array of 64-bit floats, not f32\[:\]"):
        kernel_from(FILE, "halve", values=f32[:], n=i32)


@pytest.mark.parametrize(
    ("name", "declared"),
    [
        ("sum", {"pixels": u8[:], "n": i32, "result": i32}),
        ("sum", {"row": i8[:], "n": i16}),
        ("darker", {"row": u8[:], "limit": u8, "by": u8}),
        ("sum", {"row": i32, "n": i32}),
        ("step", STEPPED),
        ("step", STEPPED | {"state": i16[:], "scratch": i32[:]}),
        ("any", {"first": i32, "second": i32, "result": i32}),
        ("untold", {"first": i32, "result": i32}),
    ],
)
def test_what_c_leaves_open_is_taken(name: str, declared: dict[str, object]) -> None:
    """Names, signs, a pointer to a struct or to nothing told, the null pointer, a result that nobody wants, and older C."""
    assert kernel_from(FILE, name, **declared).name == name

"""What Python says of a function in C is held against what its debugging information says. `blackfin/data/make` makes the file."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.api import f32, i8, i16, i32, kernel_from, u8
from bfsim.errors import KernelError

FILE = Path(__file__).parent / "blackfin" / "data" / "prototypes.o"
SUM = "int sum(const unsigned char *row, int n)"
STEP = "void step(const short int *gains, struct state *state, void *scratch, float by, enum pace pace)"
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
    ("name", "declared"),
    [
        ("sum", {"pixels": u8[:], "n": i32, "result": i32}),
        ("sum", {"row": i8[:], "n": i16}),
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

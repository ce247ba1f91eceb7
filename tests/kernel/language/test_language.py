"""What is not the kernel language is refused: with file, line, column, a caret, and what to write instead."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from bfsim.errors import KernelError
from bfsim.kernel import Kernel
from tests.kernel.modules import HEADER_LINES, import_text

BEFORE = """
from enum import Enum, IntEnum
import numpy as np

SIZE = 4
RATIO = 0.5
NAMES = ["a"]
LEVELS = np.int32(3)

class Mode(IntEnum):
    OFF, RUN = 0, 3

class Colour(Enum):
    RED = 1

def plain(x):
    return x

def max(x, y, z):
    return x

@kernel
def other(x: i32, row: u8[:]) -> i32:
    return x + row[0]

@kernel
def silent(row: u8[:]):
    row[0] = 1
"""
DEF = "def f(x: i32, w: u32, row: u8[:], col: i16[:]) -> i32:"


def refusal_of(text: str, folder: Path) -> tuple[str, str, str]:
    """Return the message, the shown line and what stands above the caret, of a module that must be refused."""
    with pytest.raises(KernelError) as caught:
        import_text(text, folder)
    message, shown, caret = str(caught.value).splitlines()
    return message, shown, shown[caret.index("^") :]


@pytest.mark.parametrize(
    ("line", "at", "what"),
    [
        ("y = x * 0.5", "x * 0.5", "the two sides are i32 and f32; write f32(...) around the integer"),
        ("y = x / 2", "x / 2", "cannot use the float division / on integers; write // (rounds down) or quotient(x, y)"),
        ("y = x ** 2", "x ** 2", "cannot use **; write it with"),
        ("y = x @ x", "x @ x", "cannot use @; write it with"),
        ("y = 'text'", "'text'", "cannot use the constant 'text'; use numbers"),
        ("y = f'{x}'", "f'{x}'", "cannot use strings"),
        ("y = [x, x]", "[x, x]", "cannot use lists"),
        ("y = {x: 1}", "{x: 1}", "cannot use dictionaries"),
        ("y = [i for i in range(3)]", "[i for", "cannot use comprehensions"),
        ("y = {i for i in row}", "{i for", "cannot use comprehensions"),
        ("y = {i: 1 for i in row}", "{i: 1", "cannot use comprehensions"),
        ("y = (i for i in row)", "(i for", "cannot use comprehensions"),
        ("y = {x, 1}", "{x, 1}", "cannot use sets"),
        ("y = x + 0x" + 5000 * "f", "0xf", "a number of thousands of digits does not fit in 32 bits"),
        ("y = 1e39", "1e39", "1e+39 does not fit in an f32; use a value in -3.4028e38..3.4028e38"),
        ("y = -3.4028235677973366e38", "3.4", "3.4028235677973366e+38 does not fit in an f32"),
        ("y = lambda: 1", "lambda: 1", "cannot use lambda"),
        ("y = row.shape[0]", "row.shape", "an array has one dimension and no shape; write len(row)"),
        ("y = row.size", "row.size", "cannot use attributes; write len(row) for how many elements it has"),
        ("y = (z := x)", "z := x", "cannot use `:=`; give the name its value on a line before"),
        ("y = x is x", "x is x", "cannot use `is`; write < <= > >= == !="),
        ("y = x in row", "x in row", "cannot use `in`; write < <= > >= == !="),
        ("y = x is not x", "x is not x", "cannot use `is not`; write < <= > >= == !="),
        ("y = x not in row", "x not in row", "cannot use `not in`; write < <= > >= == !="),
        ("try:\n        y = x\n    except ValueError:\n        y = 1", "try:", "cannot use `try` statements; test with if"),
        ("with x:\n        pass", "with x:", "cannot use `with` statements"),
        ("del x", "del x", "cannot use `del` statements"),
        ("assert x", "assert x", "cannot use `assert` statements; test the kernel in a unit test"),
        ("global SIZE", "global SIZE", "cannot use `global` statements"),
        ("import math", "import math", "cannot use `import` statements; import at the top of the module"),
        ("from math import pi", "from math", "cannot use `from` statements; import at the top of the module"),
        ("raise ValueError", "raise ValueError", "cannot use `raise` statements; return a number that the main loop"),
        ("def g():\n        pass", "def g():", "cannot use `def` statements; write another @kernel beside this one, and call it"),
        ("match x:\n        case 1:\n            pass", "match x:", "cannot use `match` statements; write if and elif"),
        ("return x, w", "x, w", "a kernel returns one number; store several into an array that is a parameter"),
        ("yield x", "yield x", "cannot use `yield`"),
        ("yield from row", "yield from", "cannot use `yield from`"),
        ("y, z = x", "y, z", "only as many values, or an intrinsic with two results, are assigned to several names; write `a, b = x"),
        ("y, z = row", "row", "the array row is used like a number; write row[i] or len(row)"),
        ("y, z = row.shape", "row.shape", "cannot use attributes; write len(row) for how many elements it has"),
        ("y, z = x, x, x", "y, z", "only as many values, or an intrinsic with two results"),
        ("y = z, v = x, x", "x, x", "cannot use tuples"),
        ("y, *z = x, x", "*z", "only a local name or an array element can be assigned"),
        ("y = x, x", "x, x", "cannot use tuples"),
        ("w = y = x", "x", "u32 is needed here, not i32"),
        ("row = col", "row = col", "only a local name or an array element can be assigned"),
        ("for v in (1, 2):\n        pass", "(1, 2)", "loops over range(...), an array or enumerate(array) only; write for i in range("),
        ("for w in row:\n        pass", "row:", "u32 is needed here, not i32"),
        ("for i, v in row:\n        pass", "i, v", "an array gives one value at a time; write for i, v in enumerate(a)"),
        ("for i, v in enumerate(row, start=1):\n        pass", "enumerate(row", "loops over range(...), an array or"),
        ("for v in enumerate(row):\n        pass", "v in", "enumerate gives two values; write for i, v in enumerate(a)"),
        ("for i, v in enumerate(row, 1):\n        pass", "enumerate(row, 1)", "loops over range(...), an array or"),
        ("for v in enumerate:\n        pass", "enumerate", "loops over range(...), an array or"),
        ("for i, j in range(3):\n        pass", "i, j", "a loop counts one plain name"),
        ("for i in range(stop=3):\n        pass", "range(stop", "range takes one to three numbers"),
        ("for i in range():\n        pass", "range()", "range takes one to three numbers"),
        ("for i in range(0, 9, 0):\n        pass", "0):", "step of a range cannot be 0; write 1 or more, or a negative constant"),
        ("for i in range(9, 0, -x):\n        pass", "-x):", "a negative step of a range must be a constant; count upwards, or"),
        ("for i in range(0, 9, w):\n        pass", "w):", "i32 is needed here, not u32; write i32(...) around it"),
        ("for i in range(0, 9, x < 1):\n        pass", "x < 1):", "a number is needed here, not a truth value"),
        ("for w in range(3):\n        pass", "w in", "w is u32, not i32; use another name for the counter"),
        ("while x:\n        x -= 1\n    else:\n        x = 1", "x = 1", "a loop cannot have an else; use a flag"),
        ("for i in range(3):\n        break\n        x = 1", "x = 1", "this line is never reached; remove it"),
        ("return x\n    x = 1", "x = 1", "this line is never reached"),
        ("return", "return", "this kernel must return a value"),
        ("return x < 1", "x < 1", "a number is needed here, not a truth value; write `1 if test else 0`"),
        ("return w", "w", "i32 is needed here, not u32; write i32(...) around it"),
        ("if x:\n        y = 1\n    x = y", "y", "y may be used before it has a value; give y a value on every way"),
        ("for i in range(3):\n        pass\n    x = i", "i", "i may be used before it has a value"),
        ("while x < 9:\n        y = 1\n        if y:\n            break\n    x = y", "y", "y may be used before it has a value"),
        ("while True:\n        if x:\n            break\n        y = 1\n    x = y", "y", "y may be used before it has a value"),
        ("x = SIZE\n    SIZE = 3", "SIZE", "SIZE may be used before it has a value; give SIZE a value on every way to this line; a kernel cannot change the SIZE of the module"),
        ("x = rows[0]", "rows[0]", "the name rows is not defined; assign it first, or make it a parameter; near it are row"),
        ("x = RATIO", "RATIO", "an integer is needed here, not an f32"),
        ("x = NAMES[0]", "NAMES[0]", "only array parameters can be indexed; pass the array as a parameter"),
        ("x = nothing", "nothing", "the name nothing is not defined"),
        ("x = x + w", "w", "the two sides are i32 and u32; write i32(...) or u32(...) around one of them"),
        ("x = x + 3000000000", "3000000000", "3000000000 does not fit in i32"),
        ("w = w & -2", "-2", "-2 does not fit in u32; use a value in 0..4294967295"),
        ("x = 5000000000", "5000000000", "5000000000 does not fit in 32 bits"),
        ("x = 2147483647 * 4", "2147483647 * 4", "8589934588 does not fit in 32 bits"),
        ("x = row[-1]", "-1", "an index cannot be negative; write row[len(row) - 1] for the end"),
        ("x = row[0:2]", "0:2", "an array has one integer index; loop over the elements"),
        ("x = row[0, 1]", "0, 1", "an array has one integer index; write a[y * width + x]"),
        ("x = row[0][1]", "row[0][1]", "an array has one dimension; write a[y * width + x]"),
        ("x = row + 1", "row", "the array row is used like a number; write row[i] or len(row)"),
        ("x = len(x)", "len(x)", "len is for array parameters"),
        ("x = x // 0", "0", "the division is by zero"),
        ("x = quotient(x, 0)", "0", "the division is by zero"),
        ("x = remainder(x)", "remainder(x)", "cannot call remainder like this; give remainder two arguments"),
        ("x = i32(quotient(1.5, 2.0))", "quotient(1.5", "quotient is not for f32"),
        ("x %= 0", "0", "the division is by zero"),
        ("x = x << 40", "40", "a shift must be by 0..31, not by 40"),
        ("x >>= -1", "-1", "a shift must be by 0..31, not by -1"),
        ("x **= 2", "x **= 2", "cannot use **; write it with + - *"),
        ("y = x and x", "x and x", "`and` and `or` give truth values, not numbers, outside of a condition; write a comparison, `x != 0`"),
        ("y = x < 1 or x", "x", "`and` and `or` give truth values, not numbers"),
        ("y = (1 if x else 2) + (x and 3)", "x and 3", "give truth values, not numbers, outside of a condition"),
        ("return x or 3", "x or 3", "give truth values, not numbers, outside of a condition"),
        ("y = (x < 0) < (w < 1)", "x < 0", "a number is needed here, not a truth value; write `1 if test else 0`"),
        ("y = x == (w < 1)", "w < 1", "a number is needed here, not a truth value"),
        ("if x and silent(row):\n        pass", "silent(row)", "this kernel returns nothing"),
        ("if x or 0.5:\n        pass", "0.5", "an f32 is no truth value; write `x != 0.0`"),
        ("x = LEVELS", "LEVELS", "cannot read LEVELS, which is an int32; pass it as an array or integer parameter; of the module only"),
        ("x = NAMES", "NAMES", "cannot read NAMES, which is a list"),
        ("x = Mode", "Mode", "cannot read Mode, which is an EnumType"),
        ("x = Mode.IDLE", "Mode.IDLE", "Mode has no member IDLE; it has OFF, RUN"),
        ("x = Colour.RED", "Colour.RED", "cannot use attributes; write RED = Colour.RED in the module, if it is a number, and use that"),
        ("x = np.pi", "np.pi", "cannot use attributes; write PI = np.pi in the module"),
        ("Mode = 3\n    x = Mode.RUN", "Mode.RUN", "cannot use attributes"),
        ("x = row[0] == '$'", "'$'", "cannot use the constant '$'; write its number, ord('$')"),
        ("x = ord(x)", "ord(x)", "ord is for one constant character; write ord('x')"),
        ("x = ord('ab')", "ord('ab')", "ord is for one constant character"),
        ("x = ord()", "ord()", "ord is for one constant character"),
        ("x = other(x, row[2:])", "row[2:]", "row must be an array u8[:]; pass the whole array on, and where its part begins as an i32"),
        ("y = row if x else col", "row if", "a choice is between numbers, and row is an array; let the caller pass the one that is meant"),
        ("y = 1 if x else col", "col", "a choice is between numbers, and col is an array"),
        ("y = x < 2 if x > 3 else False", "x < 2 if", "a choice is between numbers, and these are truth values; write it with `and`, `or`"),
        ("y = x < 1\n    y = 2", "2", "y holds bool, not i32; use another name"),
        ("y: u8 = 1", "y: u8", "a local is an i32, a u32 or an f32 with a value; write x: u32 = 0"),
        ("x: u32 = 1", "x: u32", "x is i32 already, not u32; use another name"),
        ("x = plain(x)", "plain(x)", "cannot call plain like this; make plain a @kernel, or inline it"),
        ("print(row[0])", "print(row", "cannot call print, which is Python's; return a number, or store it in an array that the"),
        ("print(x, end='')", "print(x", "search a mistake, call the kernel's `.python(...)` in a test, which runs it as plain"),
        ("print('x is', x)", "print('x", "cannot call print, which is Python's"),
        ("x = sum(row)", "sum(row)", "cannot call sum, which is Python's; write a loop, for i in range(...)"),
        ("x = int(w)", "int(w)", "cannot call int, which is Python's; write i32(x), or a comparison"),
        ("x = range(4)", "range(4)", "cannot call range, which is Python's; it counts a loop only"),
        ("y = list(row)", "list(row)", "cannot call list, which is Python's; a kernel has numbers and the arrays"),
        ("x = exit(1)", "exit(1)", "cannot call exit, which is Python's; use numbers, arrays, loops, len"),
        ("x = max(x, x, x)", "max(x", "cannot call max like this; make max a @kernel"),
        ("x = min(x)", "min(x", "cannot call min like this; give min two arguments"),
        ("x = abs(x, 2)", "abs(x", "cannot call abs like this; give abs one argument"),
        ("x = min(x, 1, w)", "w", "the two sides are i32 and u32"),
        ("x = min(row)", "min(row", "cannot call min like this; give min two arguments, in a loop over the array"),
        ("x = row.sum()", "row.sum()", "cannot call row.sum: it has no modules and no methods; write a loop, for i in range(...)"),
        ("x = np.abs(x)", "np.abs(x)", "cannot call np.abs: it has no modules and no methods; write abs(...) of numbers"),
        ("y = np.zeros(4)", "np.zeros", "no methods; a kernel has numbers and the arrays that it is given; pass an array as a parameter"),
        ("x = np.clip(x, 0, 9)", "np.clip", "no methods; write min(max(x, low), high)"),
        ("x = other(x, row)(1)", "other(x", "a kernel calls by name; write the name of a kernel or a function"),
        ("x = other(x, row=row)", "row=row", "a kernel calls without keywords; give other its arguments in order"),
        ("x = other(*row)", "*row", "a kernel calls without `*`; give other its arguments one by one"),
        ("x = other(**row)", "**row", "a kernel calls without keywords"),
        ("x = below(x)", "below(x)", "the name below is not defined above this kernel; put it above, or import it"),
        ("x = other(x)", "other(x)", "other takes 2 arguments, not 1; match its def"),
        ("x = other(w, row)", "w, row", "i32 is needed here, not u32"),
        ("x = other(x, col)", "col", "row must be an array u8[:]; pass such a parameter on"),
        ("x = u8(x, x)", "u8(x, x)", "u8(...) takes one number; write u8(x)"),
        ("x = silent(row)", "silent(row)", "this kernel returns nothing; call it on a line of its own"),
        ("y = silent(row)", "silent(row)", "this kernel returns nothing; call it on a line of its own"),
        ("y: f32 = 2", "2", "f32 is needed here, not i32; write 2.0"),
        ("if silent(row):\n        pass", "silent(row)", "this kernel returns nothing"),
        ("y = x < 1 and silent(row)", "silent(row)", "this kernel returns nothing"),
        ("x = f(x, w, row, col)", "f(x", "a kernel cannot call itself; write a loop"),
        ("abs = 1\n    x = abs(x)", "abs(x)", "abs is a variable here, not a function"),
        ("row[other(x, row)] += 1", "row[other", "this call would run twice; put its result in a local name first"),
        ("x = 1 if 0 < other(x, row) < 9 else 0", "other(x", "this call would run twice"),
        ("x", "x", "this line does nothing; assign the result, or remove the line"),
        ("x + 1", "x + 1", "this line does nothing"),
    ],
)  # fmt: skip
def test_what_is_outside_the_language_is_refused_where_it_stands(
    line: str, at: str, what: str, tmp_path: Path
) -> None:
    """A line outside the subset is refused with its place, a caret below the culprit, and what to write."""
    message, _, above_caret = refusal_of(f"{BEFORE}\n@kernel\n{DEF}\n    {line}\n    return x\n", tmp_path)
    assert what in message
    assert above_caret.startswith(at)


@pytest.mark.parametrize(
    ("head", "at", "what"),
    [
        ("def f(x):", "x)", "the parameter x needs a type; write i32, u32, f32, or an array such as u8[:]"),
        ("def f(x: u8):", "x: u8", "the parameter x cannot be u8; write i32, u32"),
        ("def f(x: float):", "x: float", "the parameter x cannot be float; write i32, u32"),
        ("def f(x: 'i32 +'):", "x: 'i32 +'", "the parameter x cannot be 'i32 +'"),
        ("def f(x: u8[4]):", "x: u8[4]", "the parameter x cannot be u8[4]"),
        ("def f(x: i32 = 1):", "1", "takes plain parameters only; remove *, ** and default values"),
        ("def f(*x: i32):", "x: i32", "takes plain parameters only"),
        ("def f(**x: i32):", "x: i32", "takes plain parameters only"),
        ("def f(*, x: i32):", "x: i32", "takes plain parameters only"),
        ("def f(x: i32) -> u8:", "u8", "returns i32, u32, f32 or nothing; write -> i32"),
        ("def f(x: i32) -> bool:", "bool", "returns i32, u32, f32 or nothing"),
        ("def f(x: i32) -> i32:", "def f", "f can end without a value; return an i32 on every way"),
        ("async def f(x: i32):", "async def", "must be a plain `def`; write def, not lambda or async def"),
        ("def f(größe: i32):", "größe: i32", "the name größe is not ASCII"),
    ],
)
def test_a_head_outside_the_language_is_refused(head: str, at: str, what: str, tmp_path: Path) -> None:
    """A kernel's own line is refused when its parameters or its result are not of the language."""
    message, _, above_caret = refusal_of(f"@kernel\n{head}\n    pass\n", tmp_path)
    assert what in message
    assert above_caret.startswith(at)


def test_a_refusal_names_file_line_and_column(tmp_path: Path) -> None:
    """The place of a refusal is one that an editor can jump to, however the kernel is indented."""
    text = "if True:\n    @kernel\n    def f(x: i32):\n        '''Text\nat the margin.'''\n        y = None\n"
    message, shown, _ = refusal_of(text, tmp_path)
    place = re.match(r"(.*\.py):(\d+):(\d+): ", message)
    assert place
    line = Path(place[1]).read_text().splitlines()[int(place[2]) - 1]
    assert int(place[2]) == HEADER_LINES + 6
    assert line[int(place[3]) - 1 :] == "None"
    assert shown.strip() == line.strip()


def test_the_caret_stands_right_behind_wide_letters_and_tabs(tmp_path: Path) -> None:
    """Letters of several bytes and tabs before the culprit do not move the caret away from it."""
    text = "@kernel\ndef f(x: i32):\n\tx = 1; y = 'äöü' + 'é'\n"
    with pytest.raises(KernelError) as caught:
        import_text(text, tmp_path)
    _, shown, caret = str(caught.value).splitlines()
    assert shown[caret.index("^") :] == "'äöü' + 'é'"
    assert caret.startswith("    \t")


@pytest.mark.parametrize("sign", ["\f", "\v", "\x1c", "\x85", "\N{LINE SEPARATOR}"])
def test_the_caret_stands_in_its_line_behind_what_is_no_end_of_a_line(sign: str, tmp_path: Path) -> None:
    """A form feed in a comment above ends no line, neither in a refusal nor in the lines of a kernel."""
    _, shown, above_caret = refusal_of(
        f"@kernel\ndef f(x: i32):\n    x = 1  #{sign}\n    y = [x]\n", tmp_path
    )
    assert shown.strip() == "y = [x]"
    assert above_caret == "[x]"
    f: Kernel = import_text(f"@kernel\ndef f(x: i32):\n    x = 1  #{sign}\n", tmp_path).f
    assert len(f.function.lines) == 3


def test_of_a_long_line_what_is_about_the_caret_is_shown(tmp_path: Path) -> None:
    """A line of thousands of letters leaves room for what is wrong in it."""
    _, shown, above_caret = refusal_of(
        f"@kernel\ndef f(x: i32):\n    x = 0x{5000 * '0'}1; y = [x]{500 * ' '}# end\n", tmp_path
    )
    assert len(shown) < 300
    assert above_caret.startswith("[x]")


def test_a_variable_of_the_function_around_a_kernel_is_refused_where_it_is_used(tmp_path: Path) -> None:
    """A kernel cannot close over a name, and the caret stands below its first use."""
    text = (
        "def outer(size: int):\n    @kernel\n    def f(x: i32) -> i32:\n        return x + size\nouter(3)\n"
    )
    message, _, above_caret = refusal_of(text, tmp_path)
    assert "a kernel cannot close over size; pass it as a parameter" in message
    assert above_caret == "size"

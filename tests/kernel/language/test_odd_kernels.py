"""Functions at the edge of the kernel language: each compiles or is refused, and nothing else happens."""

from __future__ import annotations

import functools
import types
from pathlib import Path

import pytest

from bfsim.errors import KernelError
from bfsim.kernel import VDSP_O2, Kernel, kernel
from tests.kernel.conftest import ImportText
from tests.kernel.modules import import_text
from tests.tiers import exhaustive

ODD = {
    "lambda": kernel.__class__,
    "class": type("Thing", (), {}),
    "builtin": len,
    "partial": functools.partial(len),
    "number": 3,
    "method": Path("x").exists,
    "exec": types.FunctionType(compile("def g(): pass", "<made>", "exec").co_consts[0], {}),
    "wrapper": functools.wraps(len)(lambda: None),
}


@pytest.mark.parametrize("name", ODD)
def test_what_has_no_source_of_its_own_is_refused(name: str) -> None:
    """Anything that is not a plain function with a source is refused, never another exception."""
    with pytest.raises(
        KernelError, match="must (stand directly above a plain `def`|be a function in a file)"
    ):
        kernel(ODD[name])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "text",
    [
        "f = kernel(lambda x: x)",
        "f = [\n    kernel(\n        lambda x: x\n    ),\n]",
        "class C:\n    @kernel\n    def f(self, x: i32):\n        pass",
        "class C:\n    @kernel\n    @staticmethod\n    def f(x: i32):\n        pass",
        "def outer():\n    size = 3\n    @kernel\n    def f(x: i32) -> i32:\n        return x + size\nouter()",
        "import functools\n@kernel\n@functools.cache\ndef f(x: i32):\n    pass",
        "@kernel\n@kernel\ndef f(x: i32):\n    pass",
        "@kernel\nasync def f(x: i32):\n    await x",
        "@kernel\ndef f(x: i32) -> i32:\n    return " + " + ".join(["x"] * 900),
        "@kernel\ndef f(x: i32) -> i32:\n    return " + "-" * 90 + "(x, x)",
        "@kernel\ndef f(x: i32):\n    print(x, *x, **x)",
        "@kernel\ndef f(x: i32):\n    for i in range(*x):\n        pass",
        "@kernel\ndef f(x: i32):\n    x = max(*x)",
        "@kernel\ndef f(x: i32):\n    x = i32[:]",
        "@kernel\ndef f(x: i32):\n    x[0] = 1",
        "@kernel\ndef f(x: i32):\n    x.y = 1",
        "@kernel\ndef f(x: i32):\n    f: i32\n",
        "@kernel\ndef f(x: i32):\n    return None",
    ],
)
def test_odd_functions_are_refused_and_nothing_else(text: str, tmp_path: Path) -> None:
    """A function far from the language raises a KernelError, never another exception."""
    with pytest.raises(KernelError):
        import_text(text, tmp_path)


@pytest.mark.parametrize(
    "text",
    [
        "@kernel\ndef f(x: i32):\n    '''Docstring only.'''",
        "@kernel\ndef f():\n    pass",
        "@kernel\ndef f(x: i32, /) -> i32:\n    return x",
        "@kernel\ndef f(x: 'i32', row: 'u8[:]') -> 'i32':\n    return x",
        "@kernel\ndef f(x: i32) -> None:\n    return",
        "@kernel\ndef f(x: f32) -> f32:\n    return min(x, 3.4028235e38)",
        "@kernel\ndef f(x: i32) -> i32:\n    while True:\n        x += 1\n        if x > 9:\n            return x",
        "@kernel\ndef f(entry: i32, label: i32, bf: i32, then: u8[:]) -> i32:\n    return entry // label + bf + then[0]",
        *exhaustive("@kernel\ndef f(x: i32) -> i32:\n" + "".join(f"    if x == {i}:\n        x += {i}\n" for i in range(300)) + "    return x"),
        "@kernel\ndef f(x: i32) -> i32:\n    if x < 0:\n        return 0\n"
        + "".join(f"    elif x == {i}:\n        return {i * i % 7}\n" for i in range(60)) + "    return x",
    ],
)  # fmt: skip
def test_odd_kernels_of_the_language_compile(text: str, tmp_path: Path) -> None:
    """A function inside the language compiles, whatever its names, its size and the way its types are written."""
    f: Kernel = import_text(text, tmp_path).f
    assert f.compile(VDSP_O2).counters


def test_two_kernels_of_one_name_cannot_be_linked(import_kernels: ImportText) -> None:
    """A kernel that reaches two different kernels of the same name is refused instead of running the wrong one."""
    text = """
        @kernel
        def step(x: i32) -> i32:
            return x + 1
        @kernel
        def twice(x: i32) -> i32:
            return step(step(x))
        @kernel
        def step(x: i32) -> i32:
            return x + 100
        @kernel
        def both(x: i32) -> i32:
            return step(x) + twice(x)
    """
    with pytest.raises(
        KernelError, match=r"it needs two different kernels named step, .*:\d+ and .*:\d+; rename one"
    ):
        import_kernels(text)


def test_a_file_may_begin_with_a_digit(tmp_path: Path) -> None:
    """As `2024_line.py`: code has no names that do, and the run ended in an error of LLVM."""
    helper = "@kernel\ndef half(x: i32) -> i32:\n    return x >> 1\n\n\n"
    f = import_text(
        f"{helper}@kernel\ndef f(x: i32) -> i32:\n    return half(x) + 1\n", tmp_path, "2024_line"
    ).f
    assert f(6) == 4
    assert f.cost(6, profile="gcc-O2") > 0

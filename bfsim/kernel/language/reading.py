"""From a Python function to a kernel: its text and the meanings of its names → what the language makes of it.

A kernel that was read and not refused is kept in the cache, under a digest of all that decided how it was understood.
Most starts find every kernel there, and read the bodies only of those that must be compiled.
"""

from __future__ import annotations

import builtins
import hashlib
import inspect
import re
import unicodedata
from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from bfsim.errors import KernelError
from bfsim.files import store
from bfsim.kernel import keys
from bfsim.kernel.intrinsics import INTRINSICS, TO_THE_RIGHT
from bfsim.kernel.intrinsics.fract import high_of_fr2x16, low_of_fr2x16
from bfsim.kernel.language.constants import constant_of, members_of
from bfsim.kernel.language.function import Function, Parameter
from bfsim.kernel.language.operators import OF_TWO
from bfsim.kernel.language.refusal import KernelSource
from bfsim.kernel.language.source_files import file_of
from bfsim.kernel.types import NUMBERS, FloatType, IntType, sqrt, type_named

if TYPE_CHECKING:
    from bfsim.kernel.language.language import Read

WORD = re.compile(r"[\w\x80-\U0010ffff]+")
"""Matches all names in a text, and more, such as the words of comments."""
HALVES = (high_of_fr2x16, low_of_fr2x16)
FUNCTIONS: tuple[Any, ...] = (
    *INTRINSICS,
    *TO_THE_RIGHT,
    *OF_TWO,
    *HALVES,
    abs,
    enumerate,
    len,
    ord,
    range,
    sqrt,
)
MEANINGS = {id(each): f"{each.__module__}.{each.__qualname__}" for each in FUNCTIONS}
"""Full names of the functions that the language knows, by `id`."""


class _Known(NamedTuple):
    """What the cache keeps of a kernel, as text: parameters with their types, names of kernels that it calls, ... See `Function`."""

    parameters: list[tuple[str, str]]
    result: str | None
    calls: list[str]
    written: list[str]
    measured: list[str]
    digest: str


def read_kernel(python: Callable[..., Any]) -> Function:
    """Read the source of `python` as a kernel. Raises KernelError where it leaves the language."""
    if not inspect.isfunction(python) or hasattr(python, "__wrapped__"):
        raise KernelError(f"@kernel must stand directly above a plain `def`, not on {python!r}")
    code, file = python.__code__, file_of(python)
    source = KernelSource(code.co_filename, code.co_firstlineno, file.text_from(code.co_firstlineno))
    if not source.text:
        raise KernelError(f"{python!r} must be a function in a file, so that its source can be read")
    symbol = re.sub(r"\W|^(?=\d)", "_", f"{python.__module__}.{python.__qualname__}", flags=re.ASCII)
    is_static = file.is_static(python.__name__, code.co_firstlineno)
    outer = _meant(source.text, python.__globals__)

    @cache
    def read() -> Read:
        from bfsim.kernel.language.language import read_definition  # most starts read no body

        return read_definition(source, outer, python)

    def known() -> _Known:
        return _known(read(), outer, (python.__name__, symbol, is_static))

    meanings = (f"{name} {_meaning(value)}" for name, value in outer.items())
    own = repr((source.text, symbol, python.__name__, code.co_freevars, is_static))
    found = _Known(*store.kept(keys.reading_key(own, *meanings), known))
    function = Function(
        name=python.__name__,
        symbol=symbol,
        file=source.file,
        first_line=source.first_line,
        source=source.text,
        names=python.__globals__,
        is_static=is_static,
        parameters=tuple(Parameter(name, type_named(kind)) for name, kind in found.parameters),
        result=NUMBERS[found.result] if found.result else None,
        calls=tuple(outer[name].function for name in found.calls),
        written=frozenset(found.written),
        measured=frozenset(found.measured),
        digest=found.digest,
        read=lambda: read().body,
    )
    _check_callees(source, function)
    return function


def _meant(text: str, names: Mapping[str, Any]) -> dict[str, Any]:
    """Return those of a file's `names` and of Python's own that a text may use, in the order of the text."""
    words, own = dict.fromkeys(WORD.findall(unicodedata.normalize("NFKC", text))), vars(builtins)
    return {
        each: names[each] if each in names else own[each] for each in words if each in names or each in own
    }


def _meaning(value: object) -> str:
    """Return as text what `value` means to a kernel that names it; '' if no kernel can use it."""
    if (constant := constant_of(value)) is not None:
        return constant.hex() if isinstance(constant, float) else repr(constant)
    if members := members_of(value):
        return repr(members)
    if isinstance(value, (IntType, FloatType)):
        return str(value)
    if isinstance(function := getattr(value, "function", None), Function):
        kinds = [(each.name, str(each.type)) for each in function.parameters]
        return repr((function.symbol, kinds, str(function.result), sorted(function.written)))
    return MEANINGS.get(id(value), "")


def _known(read: Read, outer: Mapping[str, Any], head: tuple[str, str, bool]) -> _Known:
    from bfsim.kernel.language import tree

    body = read.body
    names = {id(getattr(value, "function", None)): name for name, value in outer.items()}
    calls = dict.fromkeys(names[id(each.callee)] for each in tree.calls_in(body.block))
    text = repr((*head, read.parameters, read.result, body.locals, body.block))
    return _Known(
        parameters=[(each.name, str(each.type)) for each in read.parameters],
        result=str(read.result) if read.result else None,
        calls=list(calls),
        written=sorted(tree.written_arrays(body)),
        measured=sorted(tree.measured_arrays(body)),
        digest=hashlib.sha256(text.encode()).hexdigest(),
    )


def _check_callees(source: KernelSource, function: Function) -> None:
    """Refuse two kernels of one name in one program: their machine code could not be told apart."""
    known = {function.symbol: function}
    for each in function.callees():
        if known.setdefault(each.symbol, each) is not each:
            from bfsim.kernel.language.language import parsed

            source.refuse(
                parsed(source.text),
                f"it needs two different kernels named {each.name}, {each.place} and "
                f"{known[each.symbol].place}",
                "rename one",
            )

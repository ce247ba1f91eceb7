"""Names in C: the kernel's own wherever C and its headers leave them free."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from bfsim.kernel.c.headers import MACROS
from bfsim.kernel.language.function import Function
from bfsim.kernel.language.tree import body_of
from bfsim.kernel.types import PAIR, ArrayType, FloatType, IntType, Number, Value

OPERATORS = (
    "min",
    "max",
    "abs",
    "floor_div",
    "floor_mod",
    "min_u32",
    "max_u32",
    "min_f32",
    "max_f32",
    "to_i32",
    "to_u32",
)
"""What `operators.h` and the headers that it includes declare for kernels."""
KEYWORDS = [
    "auto",
    "break",
    "case",
    "char",
    "const",
    "continue",
    "default",
    "do",
    "double",
    "else",
    "enum",
    "extern",
    "float",
    "for",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "typedef",
    "union",
    "unsigned",
    "void",
    "volatile",
    "while",
    "asm",  # of GNU C, as the next one
    "typeof",
    "alignas",  # of C23, to which compilers are moving
    "alignof",
    "bool",
    "constexpr",
    "false",
    "nullptr",
    "static_assert",
    "thread_local",
    "true",
    "typeof_unqual",
    "main",
    "labs",
    "fabs",
    "fabsf",
    "sqrt",
    "sqrtf",
    "NULL",
    "errno",
]
RESERVED = frozenset((*KEYWORDS, *OPERATORS))
TYPE_NAME = re.compile(r"u?int(_\w+)?\d+_t|U?INT\w*_(MIN|MAX|C)")
WORD = re.compile(r"[A-Za-z_]\w*")


def c_type(kind: Value) -> str:
    """Return the name of a type in C."""
    if isinstance(kind, IntType):
        return f"{'' if kind.signed else 'u'}int{kind.bits}_t"
    if kind is PAIR:
        return "uint64_t"
    return "float" if isinstance(kind, FloatType) else "bool"


def is_free(name: str) -> bool:
    """Whether C and its headers leave a name to the program; names with a leading underscore are the compiler's."""
    taken = name in RESERVED or name in MACROS or name.startswith("_") or TYPE_NAME.fullmatch(name)
    return not taken


def free_name(wanted: str, taken: Iterable[str] = ()) -> str:
    """Return `wanted`, or a similar name that is free."""
    name = wanted.lstrip("_") or "x"
    while not is_free(name) or name in taken:
        name += "_"
    return name


class LocalNames:
    """The names in C of the parameters and locals of one kernel, and of the lengths that come with its arrays."""

    def __init__(self, function: Function, functions: Iterable[str]) -> None:
        taken = set(functions)
        self.of: dict[str, str] = {}
        for name in _declared(function):
            self.of[name] = free_name(name, taken)
            taken.add(self.of[name])
        self.lengths: dict[str, str] = {}
        measured = function.measured
        for name in (each for each in function.array_names if each in measured):
            self.lengths[name] = free_name(f"{name}_length", taken)
            taken.add(self.lengths[name])
        self._taken = taken

    def another(self, wanted: str) -> str:
        """Return a new name for something that only C needs."""
        name = free_name(wanted, self._taken)
        self._taken.add(name)
        return name


def _declared(function: Function) -> Iterator[str]:
    yield from (each.name for each in function.parameters)
    parameters = {each.name for each in function.parameters}
    yield from (name for name, _ in body_of(function).locals if name not in parameters)


def parameter_list(function: Function, names: LocalNames) -> list[str]:
    """Return the parameters in C: those of the kernel, then the length of every array whose length it asks for."""
    parts = []
    for each in function.parameters:
        if isinstance(each.type, ArrayType):
            const = "" if each.name in function.written else "const "
            parts.append(f"{const}{c_type(each.type.element)} {names.of[each.name]}[]")
        else:
            parts.append(f"{c_type(each.type)} {names.of[each.name]}")
    parts += [f"int32_t {each}" for each in names.lengths.values()]
    return parts or ["void"]


def result_type(result: Number | None) -> str:
    """Return the type in C of what a kernel returns."""
    return c_type(result) if result else "void"

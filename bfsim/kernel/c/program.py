"""A program of kernels as files of C: one for each Python file, a header for all, and the operators that C lacks."""

from __future__ import annotations

import re
from collections import Counter as Tally
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import PurePath

from bfsim.kernel.c.comments import c_comment
from bfsim.kernel.c.expressions import number
from bfsim.kernel.c.headers import DECLARED
from bfsim.kernel.c.intrinsics import INTRINSICS, intrinsics_header, intrinsics_in, names_in_header
from bfsim.kernel.c.library import LIBRARY
from bfsim.kernel.c.names import WORD, free_name, is_free
from bfsim.kernel.c.statements import Definition, Place, signature
from bfsim.kernel.language import tree
from bfsim.kernel.language.constants import constant_of
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import Number, f32, i32, u32

OPERATORS = "operators.h"
HEADER = "kernels.h"
HEADERS = {name.removesuffix(".h") for name in (HEADER, OPERATORS, INTRINSICS)}


@dataclass(frozen=True, slots=True)
class CProgram:
    """Kernels in C. `files`: texts by name. `names`: the name of each kernel. `static`: those that only their file calls."""

    files: Mapping[str, str]
    names: Mapping[Function, str]
    static: frozenset[Function]

    @property
    def sources(self) -> list[str]:
        """Names of the files that are compiled."""
        return [each for each in self.files if each.endswith(".c")]


def c_program(
    kernels: Iterable[Function],
    *,
    entries: Iterable[Function] = (),
    place: Callable[[Function], Place] | None = None,
) -> CProgram:
    """Return `kernels` and what they call as C99.

    A kernel is static if its Python file suggests so and no other file's kernel needs it; `entries` never are. With
    `place`, debuggers and the compiler's messages point to the place that it returns for a kernel.
    """
    functions = sorted(_with_callees(kernels), key=lambda each: (each.file, each.first_line))
    static = _static(functions) - frozenset(entries)
    names = _names(functions, static)
    of_file: dict[str, list[Function]] = {}
    for each in functions:
        of_file.setdefault(each.file, []).append(each)
    stems = _stems(of_file)
    texts = {OPERATORS: (files(__package__) / OPERATORS).read_text(encoding="utf-8")}
    used = intrinsics_in(functions)
    if used:
        texts[INTRINSICS] = intrinsics_header(used)
    texts[HEADER] = _header(of_file, stems, names, static)
    for file, members in of_file.items():
        texts[f"{stems[file]}.c"] = _source(file, members, names, static, place)
    return CProgram(texts, names, static)


def _with_callees(kernels: Iterable[Function]) -> list[Function]:
    found: dict[Function, None] = {}
    for each in kernels:
        found.update(dict.fromkeys((*each.callees(), each)))
    return list(found)


def _static(functions: Iterable[Function]) -> frozenset[Function]:
    elsewhere = {
        call.callee
        for each in functions
        for call in tree.calls_in(tree.body_of(each).block)
        if call.callee.file != each.file
    }
    return frozenset(each for each in functions if each.is_static and each not in elsewhere)


def _names(functions: Iterable[Function], static: frozenset[Function]) -> dict[Function, str]:
    """Return kernels' names in C: their own; with their file's before it if several share one that other files see."""
    functions = list(functions)
    many = Tally(each.name for each in functions)
    reserved = names_in_header(intrinsics_in(functions))
    found: dict[Function, str] = {}
    for each in functions:
        shared = many[each.name] > 1 and each not in static
        wanted = f"{_stem(each.file)}_{each.name}" if shared else each.name
        clashing = {name for other, name in found.items() if other.file == each.file or other not in static}
        found[each] = free_name(wanted, clashing | LIBRARY | DECLARED | reserved)
    return found


def _stem(file: str) -> str:
    return re.sub(r"\W", "_", PurePath(file).stem, flags=re.ASCII) or "kernels"


def _stems(sources: Iterable[str]) -> dict[str, str]:
    """Return the names of the C files, without ending: those of the Python files, numbered if two are alike."""
    found: dict[str, str] = {}
    for file in sources:
        stem, number = _stem(file), 2
        while stem.lower() in {each.lower() for each in found.values()} or stem in HEADERS:
            stem, number = f"{_stem(file)}_{number}", number + 1
        found[file] = stem
    return found


def _header(
    of_file: Mapping[str, list[Function]],
    stems: Mapping[str, str],
    names: Mapping[Function, str],
    static: frozenset[Function],
) -> str:
    lines = [
        *c_comment(
            f"{HEADER} - kernels for the Blackfin, exported by bfsim.\n\n"
            "A length that a kernel asks for is one more parameter, after the others: elements, not bytes. Arrays that are "
            "written must not overlap others."
        ),
        "#ifndef KERNELS_H",
        "#define KERNELS_H",
        "",
        "#include <stdint.h>",
    ]
    for file, members in of_file.items():
        public = [each for each in members if each not in static]
        if public:
            lines += ["", f"/* {stems[file]}.c */"]
            for each in public:
                lines += signature(each, names, is_static=False, end=";")
    return "\n".join([*lines, "", "#endif", ""])


def _source(
    file: str,
    members: list[Function],
    names: Mapping[Function, str],
    static: frozenset[Function],
    place: Callable[[Function], Place] | None,
) -> str:
    constants = _constants(members, names)
    definitions = [
        Definition(each, names, constants, is_static=each in static, place=place(each) if place else None)
        for each in members
    ]
    lines = [
        *c_comment(f"Exported by bfsim from {PurePath(file).name}."),
        f'#include "{HEADER}"',
        f'#include "{OPERATORS}"',
        *([f'#include "{INTRINSICS}"'] if intrinsics_in(members) else []),
    ]
    if constants:
        lines += [
            "",
            *(
                f"#define {name} {_bracketed(number(value, _type(value)))}"
                for name, value in constants.items()
            ),
        ]
    for each in definitions:
        lines += ["", *each.lines]
    return "\n".join([*lines, ""])


def _constants(members: Iterable[Function], names: Mapping[Function, str]) -> dict[str, int | float]:
    """Return the constants of the file that its kernels name, unless the name also means something else in one of them."""
    taken = {*names.values(), *names_in_header(intrinsics_in(members))}
    wanted: dict[str, int | float] = {}
    for function in members:
        body = tree.body_of(function)
        taken.update(name for name, _ in body.locals)
        taken.update(each.name for each in function.parameters)
        for node in tree.parts(body.block):
            if isinstance(node, tree.Const):
                for name in WORD.findall(node.written):
                    value = constant_of(function.names.get(name))
                    if value is not None:
                        wanted[name] = value
    return {name: value for name, value in sorted(wanted.items()) if name not in taken and is_free(name)}


def _type(value: float) -> Number:
    if isinstance(value, float):
        return f32
    return i32 if value <= i32.bounds[1] else u32


def _bracketed(text: str) -> str:
    return f"({text})" if text.startswith("-") else text

"""The header of the intrinsics that a program uses: their instructions for the Blackfin, an expression for other processors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.resources import files

from bfsim.blackfin.instructions.decode import Instruction, Operation
from bfsim.blackfin.instructions.form import Form
from bfsim.blackfin.instructions.forms import TABLE
from bfsim.blackfin.instructions.operands import Operand
from bfsim.blackfin.instructions.text import text
from bfsim.kernel.intrinsics import Intrinsic
from bfsim.kernel.intrinsics.intrinsic import RESULT, Step
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import PAIR, IntType

INTRINSICS = "intrinsics.h"
HALVES = "halves.h"
DATA_REGISTER = re.compile(r"\bR[0-7]\b(?!:)")
FUNCTION = re.compile(r"^OPERATOR \w+ (\w+)\(", re.MULTILINE)
FIXED = ("R1:0", "R3:2")
"""Pairs of registers: an instruction that uses them needs its operands in these."""
PAIRED = {"R0", "R2"}
BLACKFIN = "__bfin__"


def intrinsics_in(functions: Iterable[Function]) -> list[Intrinsic]:
    """Return the intrinsics that kernels use, by name."""
    nodes = (node for each in functions for node in tree.parts(tree.body_of(each).block))
    found = {each.intrinsic for each in nodes if isinstance(each, tree.IntrinsicCall)}
    return sorted(found, key=lambda each: each.name)


def names_in_header(used: Iterable[Intrinsic]) -> frozenset[str]:
    """Return the names that the header takes from a program: none if no intrinsic is used."""
    names = [each.name for each in used]
    return frozenset([*names, *FUNCTION.findall(_helpers())] if names else ())


def intrinsics_header(used: Iterable[Intrinsic]) -> str:
    """Return the header."""
    guard = "INTRINSICS_H"
    lines = [
        f"/* {INTRINSICS} - instructions of the Blackfin as functions. */",
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        '#include "operators.h"',
        "",
        f"#ifndef {BLACKFIN}",
        _helpers(),
        "#endif",
    ]
    for each in used:
        lines += ["", *_function(each)]
    return "\n".join([*lines, "", "#endif", ""])


@cache
def _helpers() -> str:
    return (files(__package__) / HALVES).read_text(encoding="utf-8")


def _function(intrinsic: Intrinsic) -> Iterator[str]:
    names = zip(intrinsic.takes, intrinsic.parameters, strict=True)
    parameters = ", ".join(f"int{kind.bits}_t {name}" for kind, name in names)
    yield f"OPERATOR {_result(intrinsic)} {intrinsic.name}({parameters})"
    yield "{"
    yield f"#ifdef {BLACKFIN}"
    yield from _instructions(intrinsic)
    yield "#else"
    yield f"    return {intrinsic.c};"
    yield "#endif"
    yield "}"


def _result(intrinsic: Intrinsic) -> str:
    return f"int{intrinsic.gives.bits}_t" if isinstance(intrinsic.gives, IntType) else "uint64_t"


def _instructions(intrinsic: Intrinsic) -> Iterator[str]:
    """Yield assembler for GCC: the results first, with registers for intermediate values, then the parameters."""
    texts = [_assembler(each) for each in intrinsic.steps]
    mentioned = dict.fromkeys(name for each in texts for name in DATA_REGISTER.findall(each))
    inner = [each for each in mentioned if each not in {*intrinsic.inputs, *intrinsic.outputs}]
    written = [*intrinsic.outputs, *inner]
    numbers = {name: f"%{number}" for number, name in enumerate([*written, *intrinsic.inputs])}
    results = ["upper_result", "lower_result"] if intrinsic.gives is PAIR else ["result"]
    variables = [*results, *(f"inner_{number}" for number, _ in enumerate(inner, start=1))]
    narrow = isinstance(intrinsic.gives, IntType) and intrinsic.gives.bits < 32
    yield f"    int{16 if narrow else 32}_t {', '.join(variables)};"
    rows = [DATA_REGISTER.sub(lambda found: numbers[found[0]], each) for each in texts]
    for first, row in enumerate(rows):
        head = "    __asm__(" if not first else "            "
        yield f'{head}"{row};{"" if row is rows[-1] else chr(92) + "n"}"'
    fixed = any(pair in each for each in texts for pair in FIXED)
    last = max(at for at, each in enumerate(texts) if _reads(each, intrinsic.inputs))
    early = {name: next(at for at, each in enumerate(texts) if name in each) < last for name in written}
    out = [
        f'"={"&" * early[name]}{_class(name, texts)}"({variable})'
        for name, variable in zip(written, variables, strict=True)
    ]
    into = [
        f'"q{name[1]}"({parameter})' if fixed and name in PAIRED else f'"d"({parameter})'
        for name, parameter in zip(intrinsic.inputs, intrinsic.parameters, strict=True)
    ]
    clobbered = dict.fromkeys(name for each in texts for name in re.findall(r"\b[AI][01]\b", each))
    clobbers = "".join(f'{", " if number else " : "}"{each}"' for number, each in enumerate(clobbered))
    yield f"            : {', '.join(out)} : {', '.join(into)}{clobbers});"
    if intrinsic.gives is PAIR:
        yield "    return (uint64_t)(uint32_t)upper_result << 32 | (uint32_t)lower_result;"
    else:
        yield "    return result;"


def _reads(text: str, inputs: Iterable[str]) -> bool:
    return any(name in text for name in (*inputs, *FIXED))


def _class(register: str, texts: list[str]) -> str:
    """Return GCC's letter for the registers that may be taken: a product of a whole word goes to an even one."""
    is_product = any(re.fullmatch(rf"{register} = R\d\.[LH] \* R\d\.[LH].*", each) for each in texts)
    return "D" if is_product and register == RESULT else "d"


def _assembler(step: Step) -> str:
    form, operands = _form(step)
    return text(Instruction(0, form.length, (Operation(form, operands),)))


def _form(step: Step) -> tuple[Form, Mapping[str, Operand]]:
    """Return the row of the instruction table that a step names, and the operands that its encoding has."""
    for form in TABLE:
        operands = {letter: value for letter, value in step.operands.items() if letter in form.fields}
        given = {name: value for name, value in step.operands.items() if name not in form.fields}
        is_named = form.does == step.does and operands.keys() == form.fields.keys() and given == form.given
        if is_named and all(_is_encoded(form, *each) for each in operands.items()):
            return form, operands
    raise AssertionError(step)


def _is_encoded(form: Form, letter: str, value: Operand) -> bool:
    kind = form.kinds[letter].value
    return any(kind(raw, 0) == value for raw in range(1 << min(len(form.fields[letter]), 7)))

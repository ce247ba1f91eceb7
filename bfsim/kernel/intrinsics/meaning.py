"""Intrinsics as LLVM's functions, made of the semantics of their instructions (`bfsim.blackfin.instructions.semantics`)."""

from __future__ import annotations

import re
from collections.abc import Iterable

from llvmlite import ir

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.registers import width
from bfsim.blackfin.instructions.semantics import SEMANTICS
from bfsim.blackfin.instructions.value import Value
from bfsim.kernel.intrinsics import BY_NAME, PREFIX
from bfsim.kernel.intrinsics.intrinsic import Intrinsic
from bfsim.kernel.types import PAIR, IntType

DECLARED = re.compile(rf"^declare .*@{re.escape(PREFIX)}(\w+)\(.*$", re.MULTILINE)
I32, I64 = ir.IntType(32), ir.IntType(64)


def result_type(intrinsic: Intrinsic) -> ir.Type:
    """Return the type of its result; the upper word of a pair is the upper half."""
    return ir.IntType(intrinsic.gives.bits) if isinstance(intrinsic.gives, IntType) else I64


def function_type(intrinsic: Intrinsic) -> ir.FunctionType:
    """Return its type in LLVM's IR."""
    return ir.FunctionType(result_type(intrinsic), [ir.IntType(each.bits) for each in intrinsic.takes])


def defined(text: str) -> str:
    """Return a module in which every intrinsic that is declared is defined."""
    names = DECLARED.findall(text)
    return DECLARED.sub("", text) + "\n" + _definitions(names) if names else text


def _definitions(names: Iterable[str]) -> str:
    module = ir.Module()
    for each in names:
        _define(module, BY_NAME[each])
    body = str(module).split("\n\n", 1)[1]  # without the module's own lines
    return "\n".join(
        row for row in body.splitlines() if not row.startswith(("target", "source_filename", ";"))
    )


def _define(module: ir.Module, intrinsic: Intrinsic) -> None:
    function = ir.Function(module, function_type(intrinsic), intrinsic.symbol)
    function.linkage = "internal"
    function.attributes.add("alwaysinline")
    builder = ir.IRBuilder(function.append_basic_block("entry"))
    values = {
        register: Value(builder, argument).zero_extended().ir
        for register, argument in zip(intrinsic.inputs, function.args, strict=True)
    }

    def fetch(register: str) -> ir.Value:
        return values.get(register, ir.IntType(width(register))(0))

    memory = ir.PointerType()(None)
    for step in intrinsic.steps:
        effects = Effects(builder, fetch, memory, _no_clock, 0, _no_clock)
        SEMANTICS[step.does](effects, **step.operands)
        values |= {register: value.ir for register, value in effects.pending.items()}
    results = [Value(builder, fetch(each)) for each in intrinsic.outputs]
    if intrinsic.gives is PAIR:
        upper, lower = (each.zero_extended(64) for each in results)
        builder.ret((upper.shift_left(32) | lower).ir)
    else:
        builder.ret(results[0].low(result_type(intrinsic).width).ir)


def _no_clock() -> Value:
    raise AssertionError("no intrinsic reads the clock")

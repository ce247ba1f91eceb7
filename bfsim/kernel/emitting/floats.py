"""Single-precision floats in LLVM IR, with the results that numpy's float32 gives: nothing contracted or reordered."""

from __future__ import annotations

from collections.abc import Callable

from llvmlite import ir

from bfsim.kernel.types import FloatType, IntType, Number, PairType, Value, u32

I1, I32, I64, FLOAT = ir.IntType(1), ir.IntType(32), ir.IntType(64), ir.FloatType()
ARITHMETIC = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
Intrinsic = Callable[[str, ir.Type, list[ir.Value]], ir.Value]
"""Calls an LLVM intrinsic by name, result type and arguments."""


def register_type(kind: Value) -> ir.Type:
    """Return the type of a value in a register."""
    if isinstance(kind, FloatType):
        return FLOAT
    if isinstance(kind, PairType):
        return I64
    return I32 if isinstance(kind, IntType) else I1


def binary(builder: ir.IRBuilder, op: str, left: ir.Value, right: ir.Value) -> ir.Value:
    """Return `left op right`; min and max choose as Python does, the left one when neither is smaller."""
    if op in ARITHMETIC:
        return getattr(builder, ARITHMETIC[op])(left, right)
    better = builder.fcmp_ordered("<" if op == "min" else ">", right, left)
    return builder.select(better, right, left)


def unary(builder: ir.IRBuilder, op: str, value: ir.Value, intrinsic: Intrinsic) -> ir.Value:
    """Return -x, abs(x) or sqrt(x)."""
    if op == "-":
        return builder.fneg(value)
    return intrinsic("llvm.fabs.f32" if op == "abs" else "llvm.sqrt.f32", FLOAT, [value])


def compare(builder: ir.IRBuilder, op: str, left: ir.Value, right: ir.Value) -> ir.Value:
    """Return a truth value; a NaN differs from everything, as in Python."""
    return (builder.fcmp_unordered if op == "!=" else builder.fcmp_ordered)(op, left, right)


def convert(
    builder: ir.IRBuilder, value: ir.Value, source: Value, to: Number, intrinsic: Intrinsic
) -> ir.Value:
    """Convert to or from f32. An integer is rounded towards zero; one that does not fit becomes the nearest, NaN 0."""
    if isinstance(to, FloatType):
        if isinstance(source, FloatType):
            return value
        return (builder.uitofp if source is u32 else builder.sitofp)(value, FLOAT)
    return intrinsic(f"llvm.fpto{'si' if to.signed else 'ui'}.sat.i32.f32", I32, [value])

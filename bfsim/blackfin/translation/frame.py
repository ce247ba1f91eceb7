"""The stack frame of code whose accesses to it are known: a variable of native code, which LLVM turns into registers of the host."""

from __future__ import annotations

from collections.abc import Callable

from llvmlite import ir

from bfsim.blackfin.control_flow.frames import Places
from bfsim.blackfin.instructions.effects import I8, I32, I64, POINTER
from bfsim.blackfin.instructions.registers import WORD_BYTES
from bfsim.blackfin.translation.native_function import NativeFunction


class Frame:
    """The words around the entry's stack pointer that are accessed, at known `places`; the `span` of bytes that they are in."""

    def __init__(self, function: NativeFunction, places: Places) -> None:
        self._function, self._places = function, places
        words = {each & -WORD_BYTES for one in places.values() for each in one if each is not None}
        self.span = range(min(words), max(words) + WORD_BYTES) if words else range(0)
        self._kept: ir.Value | None = None
        if words:
            # of words: LLVM makes registers of elements, and would put words together from bytes
            kind = ir.ArrayType(I32, len(self.span) // WORD_BYTES)
            self._kept = ir.IRBuilder(function.entry).alloca(kind, name="frame")
            self._kept.align, self._kept.type = WORD_BYTES, POINTER

    def places_of(self, builder: ir.IRBuilder, instruction: int) -> Callable[[], ir.Value | None] | None:
        """Return a function that gives the place of each access of an instruction in turn, if it is to the frame."""
        places = iter(self._places.get(instruction, ()))
        return (lambda: self._at(builder, next(places))) if self._kept else None

    def begin(self, builder: ir.IRBuilder) -> None:
        """Fetch what the caller left on the stack; the rest is 0."""
        if not self._kept:
            return
        builder.store(ir.Constant(self._kept.allocated_type, None), self._kept)
        stack = self._function.read(builder, "SP")
        for place in range(max(self.span.start, 0), self.span.stop, WORD_BYTES):
            address = builder.zext(builder.add(stack, stack.type(place)), I64)
            word = builder.load(
                builder.gep(self._function.memory, [address], source_etype=I8), typ=stack.type, align=1
            )
            builder.store(word, self._at(builder, place), align=WORD_BYTES)

    def _at(self, builder: ir.IRBuilder, place: int | None) -> ir.Value | None:
        if place is None:
            return None
        return builder.gep(self._kept, [I64(place - self.span.start)], source_etype=I8)

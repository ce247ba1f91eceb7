"""The report on a call that did not return: what ended it, at which instruction and source line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from bfsim.blackfin.control_flow.convention import KEPT, STACK, STACK_BYTES
from bfsim.blackfin.control_flow.ways import Ways
from bfsim.blackfin.elf.image import LINKED_WITH, REGISTERS, Image
from bfsim.blackfin.elf.lines import lines_of
from bfsim.blackfin.execution.guard import runner
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.instructions.event import ENDS, Event
from bfsim.errors import cut

STACK_OVERRUN_BYTES = 1 << 18
"""[ours] An access up to this far below the stack is to local variables: nothing else is there."""
MOST_PLACES = 3
"""[ours] At most this many are listed if one of them is meant."""
SYSTEM = {
    "_exit", "_close", "_environ", "_execve", "_fork", "_fstat", "_getpid", "_gettimeofday", "_isatty", "_kill", "_link", "_lseek", "_open",
    "_read", "_sbrk", "_stat", "_times", "_unlink", "_wait", "_write",
}  # fmt: skip
"""[newlib, "System Calls"] What C's library asks an operating system for."""


class FailedCall:
    """A call of the function `symbol` of an image that an event ended; the processor's registers are as they were then."""

    def __init__(self, image: Image, processor: Processor, symbol: str, event: Event) -> None:
        self._image, self._processor, self._symbol, self._event = image, processor, symbol, event
        self._address = processor.state["PC"]

    @cached_property
    def _ways(self) -> Ways:
        counted = self._processor.prepared().counted
        return Ways(self._image, counted.code, lines_of(self._image), self._symbol)

    def told(self) -> str:
        """Return what happened, in words."""
        if self._event is Event.FAULT:
            return self._accesses(runner().fault.value)
        if missing := self._image.missing_at(self._address):
            source = self._processor.state["FROM"]
            places = self._ways.going_to(self._address) or ([source] if source else [])
            return self._lacks(missing, self._ways.callers(places))
        if self._event is Event.UNKNOWN_TARGET:
            return self._goes(self._processor.state["FROM"])
        if self._event is Event.MISALIGNED:
            return (
                f"{self._ways.place(self._address)} it accesses an address that is no multiple of the 2 or 4 bytes accessed, for which "
                "the Blackfin raises an exception"
            )
        if self._event is Event.NOT_KEPT:
            changed = [each for each in KEPT[:-1] if self._processor.state[each]] or ["SP"]
            return (
                f"it changes {', '.join(changed)}; R4 to R7, P3 to P5, FP and SP must be as they were when it returns, for its caller has "
                "something in them: push them first, and pop them before the return"
            )
        nbytes, told = ENDS[self._event]
        return f"{self._ways.place(self._address - nbytes)} there is {told}"

    def _accesses(self, accessed: int) -> str:
        """Describe an access where there is no memory."""
        places = self._processor.faulted_at()
        if missing := self._image.missing_at(accessed):
            return self._lacks(missing, self._ways.callers(places, "uses"))
        what = "where there is no memory"
        if STACK - STACK_OVERRUN_BYTES <= accessed < STACK:
            what += f": its stack must fit into the {STACK_BYTES:,} bytes of the scratchpad, so large arrays must be static, or arguments"
        elif accessed >= REGISTERS:
            what = "a register of the Blackfin in memory, of which a kernel has none: devices are for the main loop, which is in Python"
        return f"{self._one_of(places)}it accesses 0x{accessed:08X}, {what}"

    def _one_of(self, places: Sequence[int]) -> str:
        """Return the place in words, or the few lines that it may be; '' if there are many."""
        lines = dict.fromkeys(self._ways.line_at(each) or f"0x{each:08X}" for each in places)
        if len(places) == 1:
            return f"{self._ways.place(places[0])} "
        return f"at {' or '.join(lines)} " if 0 < len(lines) <= MOST_PLACES else ""

    def _lacks(self, symbol: str, users: str) -> str:
        """Describe a symbol that is not defined, and who uses it."""
        name, file = cut(symbol.removeprefix("_")), self._image.name
        advice = f"define it there, or give one object file of all that it needs ({LINKED_WITH})"
        if name in SYSTEM:
            advice = (
                "C's library asks an operating system for it, and a kernel has none: do without what leads there, or "
                f"define {name} in {file}"
            )
        elif file.endswith(".doj"):
            advice = "give the program that it was linked to (.dxe), which has all that it needs"
        return f"it comes to {name}, which {file} does not define{users and f' and {users}'}; {advice}"

    def _goes(self, source: int) -> str:
        """Describe a jump or a call to where there is no code."""
        where = f"{self._ways.place(source)} " if source else ""
        return (
            f"{where}it goes to 0x{self._address:08X}, an address that neither its code nor its data names; a pointer to a function must be "
            "that of one, and a label stand in a table"
        )

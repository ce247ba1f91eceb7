"""The counters of object code: its blocks and taken branches, by source line and class of operation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from bfsim.blackfin.control_flow.blocks import BRANCHES, CALLS, DIRECT, Code, accesses_memory, does
from bfsim.blackfin.control_flow.pointers import Accesses
from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.timing.interlocks import Wait
from bfsim.blackfin.timing.stalls import Waits
from bfsim.blackfin.timing.tables import Timing
from bfsim.blackfin.translation.counters import Counter as BlockCounter
from bfsim.kernel.costs.charges import Access, Charge, instead, merged
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.costs.routine_calls import RoutineCall
from bfsim.kernel.ir.text import Entrance, SourceLine
from bfsim.kernel.objects.operations import TAKEN, operation_of
from bfsim.kernel.objects.places import Places


def counters(
    counted: Iterable[BlockCounter],
    places: Places,
    timing: Timing,
    accessed: Mapping[int, Accesses],
    traced: Sequence[str],
) -> list[Counter]:
    """Return a kernel's counter for each counter of the translated code, in the same order.

    `accessed`: the accesses of instructions, by their addresses. `traced`: what an access may be to, if its address
    decides.
    """
    return [_counter(each, places, timing, accessed, traced) for each in counted]


def _counter(
    each: BlockCounter,
    places: Places,
    timing: Timing,
    accessed: Mapping[int, Accesses],
    traced: Sequence[str],
) -> Counter:
    block = each.block
    routine, label = places.function_at(block.start).symbol, f"{block.start:08x}"
    if each.taken:
        (last,) = _charges(block.instructions[-1:], (Wait(),), places, timing)
        taken = Charge(TAKEN[last.op], last.line, timing.taken(block.instructions[-1]))
        return Counter(routine, label, "taken", None, instead((taken,), (last,)), ())
    charges = _charges(block.instructions, each.waits, places, timing)
    if each.along:
        replaced = _charges(block.instructions, each.instead, places, timing)
        way = f"from {each.along.source:08x}"
        return Counter(routine, label, way, None, merged(instead(charges, replaced)), ())
    lines = dict.fromkeys(places.line_of(one.address) for one in block.instructions if accesses_memory(one))
    accesses = (
        *(Access(array, False, "", 0, line, may_be=True) for line in lines for array in traced),  # noqa: FBT003
        *(
            Access(array, writes, label, number, places.line_of(one.address), turn=turn, among=len(arrays))
            for number, one in enumerate(block.instructions)
            for writes, arrays in accessed.get(one.address, ())
            for turn, array in enumerate(sorted(arrays))
        ),
    )
    begins = places.entered_at(block.start)
    enters = (Entrance(begins, SourceLine(begins, 0)),) if begins else ()
    return Counter(
        routine, label, None, None, merged(charges), accesses, block.end - block.start, enters=enters
    )


def _charges(
    instructions: Sequence[Instruction], waits: Waits, places: Places, timing: Timing
) -> tuple[Charge, ...]:
    """Return the costs of instructions with their waits; one that goes to a routine of the library has its name."""
    return tuple(
        Charge(
            operation_of(each),
            places.line_of(each.address),
            timing.of(each),
            wait.cclk,
            routine=_library_routine(each, places),
        )
        for each, wait in zip(instructions, waits, strict=True)
    )


def _library_routine(instruction: Instruction, places: Places) -> str:
    """Return the library routine that an instruction always goes to from another routine; '' if it does not."""
    if does(instruction) not in DIRECT - BRANCHES:
        return ""
    routine = places.library_routine_at(int(instruction.operations[0].operands["t"]))
    return routine if routine != places.library_routine_at(instruction.address) else ""


def calls(
    code: Code, places: Places, entry: int, arrays: Sequence[str]
) -> Mapping[str, tuple[RoutineCall, ...]]:
    """Return the functions that each function calls or jumps to; the first one calls those that only computed jumps reach.

    Arrays have the same names in all of them as in the first: they are told apart by addresses.
    """
    first = places.function_at(entry).symbol
    found: dict[str, dict[str, None]] = {first: {}}
    for block in code.blocks.values():
        caller = places.function_at(block.start).symbol
        found.setdefault(caller, {})
        last = block.instructions[-1] if block.instructions else None
        if last and does(last) in DIRECT | CALLS and "t" in last.operations[0].operands:
            callee = places.function_at(int(last.operations[0].operands["t"])).symbol
            if callee != caller:
                found[caller][callee] = None
    called = {callee for callees in found.values() for callee in callees}
    found[first] |= {each: None for each in found if each not in called and each != first}
    same = tuple((each, each) for each in arrays)
    return {caller: tuple(RoutineCall(each, same) for each in callees) for caller, callees in found.items()}

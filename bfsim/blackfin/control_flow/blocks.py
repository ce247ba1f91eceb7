"""Code as blocks: all that can be reached from its entries, cut where control can come in or go out."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from bfsim.blackfin.control_flow.halves import PutTogether
from bfsim.blackfin.instructions.decode import Instruction, InstructionError, Operation, decode

Fetch = Callable[[int], bytes]
"""Returns the 8 bytes of code at an address, or as many as there are."""

DIRECT = {"jump", "call", "branch", "branch_predicted"}
"""These go to their operand t."""
COMPUTED = {"jump_to", "jump_relative", "call_to", "call_relative", "return_"}
CALLS = {"call", "call_to", "call_relative"}
BRANCHES = {"branch", "branch_predicted"}
ASSERTIONS = {"assert_low", "assert_high"}
"""These end a program, if they do anything."""
EVENTS = {
    *("return_from_interrupt", "return_from_exception", "return_from_nmi", "return_from_emulation"),
    *("raise_interrupt", "exception", "emulation_exception", "idle"),
    *("output", "output_register", "halt", "abort", "debug"),
    *ASSERTIONS,
}
"""These may leave native code, which goes on with what follows."""
STOPS = {"halt", "abort"}
NEVER_ON = (DIRECT | COMPUTED | STOPS) - CALLS - BRANCHES
"""Control never goes from these to what follows."""
NEVER_RESUMED = NEVER_ON | (EVENTS - ASSERTIONS)
"""Nor from these, if nothing goes on after an event."""
MOST_INSTRUCTIONS = 1 << 18
"""[ours] Two and a half times all of GCC's and newlib's libraries. A wild jump into memory that is zero meets millions of NOPs."""
SAVED_RETS = 4
"""[PRM] Where LINK saves RETS, relative to FP."""
LOOP_ENDS = {"LB0": 0, "LB1": 1}
"""The registers that say where a hardware loop ends, with the numbers of their counters."""
LOOP_BOUNDS = frozenset({*LOOP_ENDS, "LT0", "LT1"})
MEMORY = {
    *("load", "store", "load_half", "store_half", "load_indexed", "store_indexed"),
    *("push", "pop", "push_multiple", "pop_multiple", "link", "unlink", "test_and_set"),
}
"""These access memory."""
CLOCKED = {"CYCLES", "CYCLES2", "SYSCFG"}
"""An instruction with one of these begins a block: it needs the cycles of everything executed before it."""


@dataclass(frozen=True, slots=True)
class Block:
    """Instructions that are executed one after the other. `refused`: why there is no instruction after the last one."""

    start: int
    instructions: tuple[Instruction, ...]
    refused: str = ""

    @property
    def end(self) -> int:
        """The address after the last instruction."""
        return self.instructions[-1].end if self.instructions else self.start

    @property
    def returns(self) -> bool:
        """Whether it ends with a return: RTS, or a jump to the RETS that LINK has saved, as by VisualDSP++ before UNLINK."""
        last = self.instructions[-1] if self.instructions else None
        if last is None or does(last) != "jump_to":
            return last is not None and does(last) == "return_"
        pointer = last.operations[0].operands["p"]
        writes = [
            (each.form.does, each.operands.get("p"), each.operands.get("n"))
            for one in self.instructions
            for each in one.operations
            if each.operands.get("d") == pointer
        ]
        return writes[-1:] == [("load", "FP", SAVED_RETS)]

    @property
    def calls(self) -> tuple[int, ...]:
        """The address of the function that it calls at its end, if the call names it."""
        last = self.instructions[-1] if self.instructions else None
        if last is None or does(last) not in CALLS & DIRECT:
            return ()
        return (int(last.operations[0].operands["t"]),)

    @property
    def branches(self) -> bool:
        """Whether it ends with a conditional branch."""
        return bool(self.instructions) and does(self.instructions[-1]) in BRANCHES

    @property
    def is_computed(self) -> bool:
        """Whether it ends by going to a computed address."""
        return bool(self.instructions) and does(self.instructions[-1]) in COMPUTED


@dataclass(slots=True)
class Code:
    """The code that can be reached from `entries`, which are also addresses that a computed jump may lead to.

    `resumes`: whether it may go on after an event that leaves native code. `callees`: entries that are functions called
    by address. `blocks`: by their addresses. `resumed`: where calls, and such events, come back to. `loop_starts`:
    where the hardware loops begin, by the last instruction and the number of the counter. Raises InstructionError if
    more than `MOST_INSTRUCTIONS` can be reached.
    """

    fetch: Fetch
    entries: frozenset[int]
    resumes: bool = True
    callees: frozenset[int] = frozenset()
    blocks: dict[int, Block] = field(default_factory=dict)
    resumed: set[int] = field(default_factory=set)
    loop_starts: dict[tuple[int, int], set[int]] = field(default_factory=dict)
    _decoded: dict[int, Instruction | InstructionError] = field(default_factory=dict)

    def __post_init__(self) -> None:
        leaders = self._explore()
        self.blocks = {start: self._block(start, leaders) for start in sorted(leaders)}

    @property
    def targets(self) -> list[int]:
        """Addresses that computed jumps may lead to."""
        starts = {start for starts in self.loop_starts.values() for start in starts}
        return sorted(self.entries | self.resumed | starts)

    def is_loop_end(self, address: int) -> bool:
        """Whether a hardware loop ends with the instruction at an address."""
        return (address, 0) in self.loop_starts or (address, 1) in self.loop_starts

    def _explore(self) -> set[int]:
        """Decode all that can be reached; return where blocks begin."""
        leaders, waiting = set(self.entries), sorted(self.entries)
        while waiting:
            address = waiting.pop()
            if address in self._decoded:
                continue
            if len(self._decoded) == MOST_INSTRUCTIONS:
                raise InstructionError(
                    f"code must have at most {MOST_INSTRUCTIONS:,} instructions, but from {min(self.entries):#010x} more can be "
                    f"reached, of which one is at {address:#010x}; jumps must lead to code, not to memory that is all zero"
                )
            instruction = self._decoded[address] = self._decode(address)
            if isinstance(instruction, InstructionError):
                continue
            found = self._targets(instruction)
            leaders |= found
            waiting += found
            if does(instruction) not in self._never_on:
                waiting.append(instruction.end)
            if is_clocked(instruction):
                leaders.add(address)
        for end, counter, start in self._written_loops():
            self.loop_starts.setdefault((end, counter), set()).add(start)
            leaders.add(start)
        for end, _ in self.loop_starts:
            if isinstance(last := self._decoded.get(end), Instruction) and last.end in self._decoded:
                leaders.add(last.end)
        return leaders

    def _written_loops(self) -> Iterator[tuple[int, int, int]]:
        """Yield end, counter and start of each loop that code may set up without LSETUP, by writing LB and LT itself."""
        known = {at: each for at, each in self._decoded.items() if isinstance(each, Instruction)}
        moves = (each.operations[0] for each in known.values() if does(each) == "move")
        counters = {LOOP_ENDS[each] for move in moves if (each := str(move.operands["d"])) in LOOP_ENDS}
        if counters:
            put_together = PutTogether(known.values())
            places = [at for at in known if at in put_together]
            yield from ((end, each, start) for each in counters for end in places for start in places)

    def _decode(self, address: int) -> Instruction | InstructionError:
        try:
            return decode(self.fetch(address), address)
        except InstructionError as refused:
            return refused

    def _targets(self, instruction: Instruction) -> set[int]:
        """Return where blocks begin because of an instruction; note loops and where control comes back to."""
        what, operands = does(instruction), instruction.operations[0].operands
        if what == "loop_setup":
            start, end, counter = int(operands["s"]), int(operands["e"]), int(operands["c"])
            self.loop_starts.setdefault((end, counter), set()).add(start)
            return {start}
        found = {int(operands["t"])} if what in DIRECT else set()
        if what in (CALLS | EVENTS) - ASSERTIONS - self._never_on:
            self.resumed.add(instruction.end)
        return found | ({instruction.end} if what in (CALLS | EVENTS | BRANCHES) - self._never_on else set())

    @property
    def _never_on(self) -> set[str]:
        """Instructions after which control never goes on."""
        return NEVER_ON if self.resumes else NEVER_RESUMED

    def _block(self, start: int, leaders: set[int]) -> Block:
        instructions: list[Instruction] = []
        address = start
        while isinstance(instruction := self._decoded[address], Instruction):
            instructions.append(instruction)
            address = instruction.end
            ends = does(instruction) in DIRECT | COMPUTED | EVENTS
            if ends or address in leaders or self.is_loop_end(instruction.address):
                return Block(start, tuple(instructions))
        return Block(start, tuple(instructions), str(instruction))


def does(instruction: Instruction) -> str:
    """Return what an instruction does; for a bundle, what its DSP instruction does."""
    return instruction.operations[0].form.does


def sets_up_loops(code: Code) -> bool:
    """Whether LSETUP alone says where hardware loops begin and end: nothing else names their registers."""
    return all(LOOP_BOUNDS.isdisjoint(map(str, each.operands.values())) for each in operations_of(code))


def operations_of(code: Code) -> Iterator[Operation]:
    """Yield the operations of all instructions."""
    return (each for block in code.blocks.values() for one in block.instructions for each in one.operations)


def is_clocked(instruction: Instruction) -> bool:
    """Whether an instruction needs the cycles of everything executed before it."""
    return not CLOCKED.isdisjoint(map(str, instruction.operations[0].operands.values()))


def accesses_memory(instruction: Instruction) -> bool:
    """Whether an instruction, or one of a bundle, loads or stores."""
    return not MEMORY.isdisjoint(each.form.does for each in instruction.operations)

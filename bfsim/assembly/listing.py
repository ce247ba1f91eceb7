"""A kernel's code as records: each instruction with its source line, cycles and waits, and each loop with what bounds it."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from bfsim.assembly.finding import KernelCode
from bfsim.blackfin.control_flow.blocks import CALLS, Block, Code, does
from bfsim.blackfin.control_flow.edge_counts import CountedEvent, times_gone
from bfsim.blackfin.control_flow.flow import Edge, Loop, edges, loops
from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.text import text
from bfsim.blackfin.timing.interlocks import Wait
from bfsim.blackfin.timing.stalls import Stalls, stalls
from bfsim.blackfin.timing.tables import Timing
from bfsim.blackfin.timing.turns import Chain, Turn, longest_chain, turns
from bfsim.trace.assembly import Assembly, AssemblyInstruction, AssemblyLoop, SourceText

CHAIN, ISSUE, JUMPS, WAITS = (
    "a dependence chain",
    "issue slots",
    "branches",
    "waits that other code could fill",
)


def listed(code: KernelCode, events: Mapping[CountedEvent, int] | None = None) -> Assembly:
    """Return the code of a kernel as records; with the `events` of a run, how often each instruction ran and what it cost."""
    kernel = code.kernel
    made = _Listing(code, events)
    return Assembly(
        kernel=kernel.name,
        file=kernel.function.file,
        first_line=kernel.function.first_line,
        compiler=code.compiler,
        timing=code.timing.name,
        timing_about=code.timing.about,
        code_bytes=sum(each.end - each.start for each in made.blocks),
        calls=None if events is None else made.calls,
        instructions=tuple(made.instructions()),
        loops=tuple(made.loop(each) for each in made.loops),
        callees=tuple(made.callees(made.blocks)),
    )


@dataclass(frozen=True)
class _Listing:
    """One kernel's blocks while they are listed."""

    kernel_code: KernelCode
    events: Mapping[CountedEvent, int] | None

    @property
    def code(self) -> Code:
        return self.kernel_code.compiled.subroutine.translated.code

    @property
    def timing(self) -> Timing:
        return self.kernel_code.compiled.subroutine.translated.counted.timing

    @cached_property
    def blocks(self) -> list[Block]:
        routine = self.kernel_code.routine
        return [
            each
            for start, each in sorted(self.code.blocks.items())
            if routine.address <= start < routine.end and each.instructions
        ]

    @cached_property
    def edges(self) -> list[Edge]:
        """Edges within it. Computed jumps of others may lead to its start, but no case of its own switches does."""
        first, within = self.kernel_code.routine.address, [each.start for each in self.blocks]
        return [
            each
            for each in edges(self.code, within)
            if each.target != first or not self.code.blocks[each.source].is_computed
        ]

    @cached_property
    def loops(self) -> list[Loop]:
        return loops(self.edges, self.kernel_code.routine.address)

    @cached_property
    def stalls(self) -> Stalls:
        return stalls(self.code, self.timing)

    @property
    def calls(self) -> int:
        """How often control entered the kernel from elsewhere."""
        first = self.kernel_code.routine.address
        return self._times({CountedEvent(first): 1}) - sum(
            self._times(times_gone(self.code, self.edges, each))
            for each in self.edges
            if each.target == first
        )

    def instructions(self) -> Iterator[AssemblyInstruction]:
        entered = {each.target for each in self.edges if each.source != each.target} | {
            self.kernel_code.routine.address
        }
        for block in self.blocks:
            depth = max((each.depth for each in self.loops if block.start in each.blocks), default=0)
            costs = self._waited(block)
            for number, each in enumerate(block.instructions):
                branches = block.branches and each is block.instructions[-1]
                wait, waited = costs[number]
                yield AssemblyInstruction(
                    address=each.address,
                    nbytes=each.length,
                    text=tuple(text(each).split(" || ")),
                    source=self._source(each.address),
                    cclk=self.timing.of(each),
                    taken_cclk=self.timing.taken(each) if branches else None,
                    stall_cclk=wait.cclk,
                    waits_for=wait.register,
                    depth=depth,
                    starts_block=number == 0 and block.start in entered,
                    executions=self._count(CountedEvent(block.start)),
                    taken=self._count(CountedEvent(block.start, taken=True)) if branches else None,
                    total_cclk=self._total(block, each, waited),
                )

    def loop(self, loop: Loop) -> AssemblyLoop:
        inside = [each for each in self.blocks if each.start in loop.blocks]
        least, most = turns(self.code, loop, self.edges, self.timing)
        chain = longest_chain(most, self.timing)
        last = max(each.instructions[-1].address for each in inside)
        return AssemblyLoop(
            first=loop.head,
            last=last,
            depth=loop.depth,
            is_hardware=loop.is_hardware,
            instructions=len(most.instructions),
            least_cclk=least.cclk,
            most_cclk=most.cclk,
            issue_cclk=most.issue_cclk,
            jump_cclk=most.jump_cclk,
            stall_cclk=most.stall_cclk,
            chain_cclk=float(chain.cclk),
            chain=chain.registers,
            bound=bound_of(most, chain),
            calls=tuple(self.callees(inside)),
            turns=self._count(CountedEvent(loop.head)),
            total_cclk=None if self.events is None else sum(self._block_total(each) for each in inside),
        )

    def callees(self, blocks: Sequence[Block]) -> list[str]:
        """Return the functions that blocks call or jump to, each once."""
        routine, places = self.kernel_code.routine, self.kernel_code.places
        found = dict[str, None]()
        for block in blocks:
            last = block.instructions[-1]
            target = last.operations[0].operands.get("t")
            if isinstance(target, int) and not routine.address <= target < routine.end:
                found[places.function_at(target).name] = None
            elif does(last) in CALLS and target is None:
                found["(computed)"] = None
        return list(found)

    def _source(self, address: int) -> SourceText | None:
        places = self.kernel_code.places
        if places.lines.at(address) is None:
            return None
        at = places.line_of(address)
        function = places.functions[at.routine]
        rows = function.lines
        shown = rows[at.line - 1] if 0 < at.line <= len(rows) else ""
        return SourceText(file=function.file, line=function.first_line + at.line - 1, text=shown)

    def _waited(self, block: Block) -> list[tuple[Wait, int]]:
        """Return for each instruction of a block its longest wait, and the cycles that it waited in a run."""
        jumped = self.stalls.jumped[block.start]
        carried = {edge: waits for edge, waits in self.stalls.carried.items() if edge.target == block.start}
        times = {edge: self._times({CountedEvent(edge.target, along=edge): 1}) for edge in carried}
        executed = self._times({CountedEvent(block.start): 1})
        found = []
        for number, first in enumerate(jumped):
            waits = [first, *(each[number] for each in carried.values())]
            more = sum((each[number].cclk - first.cclk) * times[edge] for edge, each in carried.items())
            found.append((max(waits, key=lambda each: each.cclk), first.cclk * executed + more))
        return found

    def _total(self, block: Block, instruction: Instruction, waited: int) -> int | None:
        if self.events is None:
            return None
        total = self.timing.of(instruction) * self._times({CountedEvent(block.start): 1}) + waited
        if block.branches and instruction is block.instructions[-1]:
            more = self.timing.taken(instruction) - self.timing.of(instruction)
            total += more * self._times({CountedEvent(block.start, taken=True): 1})
        return total

    def _block_total(self, block: Block) -> int:
        return sum(
            self._total(block, each, waited) or 0
            for each, (_, waited) in zip(block.instructions, self._waited(block), strict=True)
        )

    def _count(self, event: CountedEvent) -> int | None:
        return None if self.events is None else self._times({event: 1})

    def _times(self, factors: Mapping[CountedEvent, int]) -> int:
        events: Mapping[CountedEvent, int] = self.events or Tally()
        return sum(events.get(event, 0) * factor for event, factor in factors.items())


def bound_of(turn: Turn, chain: Chain) -> str:
    """Return what bounds a loop: a chain of dependences that fills its iterations, or what takes most of their cycles."""
    if chain.cclk >= turn.issue_cclk + turn.jump_cclk and turn.stall_cclk:
        return CHAIN
    parts = {ISSUE: turn.issue_cclk, JUMPS: turn.jump_cclk, WAITS: turn.stall_cclk}
    return max(parts, key=lambda each: parts[each])

"""Gives every symbol its address, in the way the default LDFs of VisualDSP++ rely on.

Blocks, output sections and their statements are taken in the order of the file, the symbols of a statement in
the order of the call. Each segment has one location pointer, whichever core fills it. A symbol that does not
fit waits for the next output section that names its input section; one that waits at the end is an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bfsim.chip.memory_map import CM_BF561_REGIONS, Region
from bfsim.errors import LinkError
from bfsim.linker.checks import check_memories, check_resolves, check_symbols
from bfsim.linker.filling import Filling
from bfsim.linker.link_map import LinkMap, Placement, SegmentUsage, Symbol
from bfsim.linker.script import InputSections, LinkerScript, OutputSection, Reserve


@dataclass(frozen=True, slots=True)
class Refusal:
    """An output section without room for a symbol: the statement's line, and how full the segment was."""

    output_section: str
    line: int
    align: int
    usage: SegmentUsage


def link(
    script: LinkerScript, symbols: Sequence[Symbol], regions: Sequence[Region] = CM_BF561_REGIONS
) -> LinkMap:
    """Place `symbols` by `script` into the memories `regions` of a board; LinkError if one has no place."""
    check_symbols(script, symbols)
    check_memories(script, regions)
    linker = _Linker(script)
    waiting = list(symbols)
    for block in script.blocks:
        for output in block.output_sections:
            linker.fill(output, [symbol for symbol in waiting if block.serves(symbol)])
            waiting = [symbol for symbol in waiting if symbol not in linker.placed]
    if waiting:
        raise linker.error_about(waiting)
    link_map = LinkMap(list(linker.placed.values()), [filling.usage for filling in linker.fillings.values()])
    check_resolves(script, link_map)
    return link_map


class _Linker:
    """One link: the segments as they fill, what has its place, and what found no room where."""

    def __init__(self, script: LinkerScript) -> None:
        self._script = script
        self.fillings = {segment.name: Filling(segment, script.reserves) for segment in script.segments}
        self.placed: dict[Symbol, Placement] = {}
        self._refusals: dict[Symbol, list[Refusal]] = {}

    def fill(self, output: OutputSection, symbols: Sequence[Symbol]) -> None:
        """Place those of `symbols` that `output` takes and has room for."""
        for statement in output.statements:
            if isinstance(statement, Reserve):
                self._reserve(output, statement)
                continue
            for symbol in symbols:
                if symbol not in self.placed and statement.takes(symbol):
                    self._place(symbol, output, statement)

    def _place(self, symbol: Symbol, output: OutputSection, statement: InputSections) -> None:
        filling = self.fillings[output.segment]
        align = max(symbol.align, statement.align)
        if filling.has_room(symbol.nbytes, align):
            address = filling.take(symbol.nbytes, align)
            self.placed[symbol] = Placement(symbol, output.segment, output.name, address, statement.line)
        else:
            refusal = Refusal(output.name, statement.line, align, filling.usage)
            self._refusals.setdefault(symbol, []).append(refusal)

    def _reserve(self, output: OutputSection, reserve: Reserve) -> None:
        filling = self.fillings[output.segment]
        if not filling.has_room(reserve.nbytes, reserve.align):
            what = f"RESERVE({reserve.name}, {reserve.nbytes} bytes, align {reserve.align})"
            raise LinkError(self._out_of_memory(reserve.line, output.name, what, filling.usage))
        filling.take(reserve.nbytes, reserve.align)

    def error_about(self, waiting: Sequence[Symbol]) -> LinkError:
        """Return the LinkError for the first of the symbols that found no place."""
        symbol = waiting[0]
        if symbol not in self._refusals:
            return self._not_taken(symbol)
        *before, last = self._refusals[symbol]
        what = f"{symbol} (section {symbol.section}, {symbol.nbytes} bytes, align {last.align})"
        message = self._out_of_memory(last.line, last.output_section, what, last.usage)
        for refusal in before:
            message += (
                f"; nor in {_fullness(refusal.usage)} ('{refusal.output_section}', line {refusal.line})"
            )
        if len(waiting) > 1:
            nbytes = sum(other.nbytes for other in waiting)
            message += f"; in all {len(waiting)} symbols, {nbytes} bytes, are left without a place"
        return LinkError(message)

    def _out_of_memory(self, line: int, output_section: str, what: str, usage: SegmentUsage) -> str:
        return (
            f"{self._script.path}:{line}: Out of memory in output section '{output_section}' [li1040]: "
            f"{what} does not fit in {_fullness(usage)}"
        )

    def _not_taken(self, symbol: Symbol) -> LinkError:
        """Return the LinkError for a symbol whose input section no output section names."""
        inputs = [
            source
            for block in self._script.blocks
            if block.serves(symbol)
            for output in block.output_sections
            for statement in output.statements
            if isinstance(statement, InputSections)
            for source in statement.inputs
        ]
        owner = symbol.processor or "both cores"
        taken = sorted({name for source in inputs if source.takes_file(symbol) for name in source.sections})
        return LinkError(
            f"{self._script.path}: section of {symbol} ({symbol.object_file}, {symbol.nbytes} bytes) must "
            f"be one that the LDF takes for {owner} ({', '.join(taken) or 'none'}), "
            f"not {symbol.section}"
        )


def _fullness(usage: SegmentUsage) -> str:
    return f"{usage.name}: {usage.free_bytes} of {usage.nbytes} bytes free"

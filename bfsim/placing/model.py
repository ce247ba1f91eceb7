"""The parts to place, their possible places, and their cost in each: the items of the integer programme."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bfsim.chip.spec import BoardSpec
from bfsim.errors import LinkError
from bfsim.linker import CORE_OF_PROCESSOR, LinkerScript, LinkMap, Placement, Symbol, link
from bfsim.linker.filling import align_up
from bfsim.linker.script import InputSections
from bfsim.machine.calls.caches import caches_of
from bfsim.machine.code import SECTION
from bfsim.placing.latencies import Latencies
from bfsim.placing.measured import Accesses, Measured, Use
from bfsim.placing.programme import Choice, Item, solve
from bfsim.placing.stretches import Level, stretches_of

SHARED = "shared"
CORES = {core: processor for processor, core in CORE_OF_PROCESSOR.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A buffer, or the code of a kernel. `name` is as in the records; `owner` is a core or "shared".

    It lies in `segment`, in stretch number `home` of the memories. If the LDF has no room for the firmware, it is in no
    segment, and `home` is in the first one that takes its section.
    """

    symbol: Symbol
    name: str
    owner: str
    is_code: bool
    segment: str
    home: int | None

    @property
    def label(self) -> str:
        """Its name and its owner."""
        return f"{self.symbol.name} ({self.owner if self.owner == SHARED else f'core {self.owner}'})"


class Model:
    """A firmware with the memories of an LDF."""

    def __init__(self, board: BoardSpec, script: LinkerScript, symbols: Sequence[Symbol]) -> None:
        self.board, self.script, self.symbols = board, script, symbols
        chip = board.chip
        self.stretches = stretches_of(script, chip.regions, chip.cache.line_bytes)
        self._latencies = Latencies(board)
        frame = link(script, (), chip.regions, chip=chip.name)
        self._caches = {core: caches_of(frame, CORES[core]) for core in chip.cores}
        try:
            link_map: LinkMap | None = link(script, symbols, chip.regions, chip=chip.name)
        except LinkError:
            link_map = None
        self.is_linked = link_map is not None
        self._segments_of = {
            processor: frozenset(self._starts(processor)) for processor in (None, *CORE_OF_PROCESSOR)
        }
        placements = link_map.placements if link_map else ()
        self.parts = tuple(self._parts(placements))

    def best(self, measured: Measured) -> tuple[int, ...]:
        """Return the stretch of each part in the best placement, by what was measured. Raises NoRoomError."""
        items = [self._item(each, measured) for each in self.parts]
        busy = measured.busy_cclk or dict.fromkeys(self.board.chip.cores, 0.0)
        return tuple(each.stretch for each in solve(items, [each.nbytes for each in self.stretches], busy))

    def cclk(self, part: Part, stretch: int, measured: Measured) -> dict[str, float]:
        """Return how long a part in a stretch stalls each core in a frame."""
        return {
            core: self._stall_cclk((core, part.name), part, stretch, measured) for core in self._users(part)
        }

    def busy_cclk(self, places: Sequence[int], measured: Measured) -> dict[str, float]:
        """Return each core's cycles a frame in a placement, without its waits for pictures and for the other core."""
        busy = Counter(measured.busy_cclk)
        for part, stretch in zip(self.parts, places, strict=True):
            busy.update(self.cclk(part, stretch, measured))
        return dict(busy)

    def code_levels(self, places: Sequence[int | None]) -> Mapping[Use, Level]:
        """Return where the code of each movable kernel lies in a placement."""
        return {
            (part.owner, part.name): self.stretches[stretch].level
            for part, stretch in zip(self.parts, places, strict=True)
            if part.is_code and stretch is not None
        }

    def _parts(self, placements: Sequence[Placement]) -> Iterator[Part]:
        declared = Counter(each.name for each in self.symbols if each.section != SECTION)
        with_code_outside = self._with_code_outside(placements)
        placed = {(each.symbol.processor, each.symbol.name): each for each in placements}
        for symbol in self.symbols:
            owner = SHARED if symbol.processor is None else CORE_OF_PROCESSOR[symbol.processor]
            is_code = symbol.section == SECTION
            twice = not is_code and declared[symbol.name] > 1
            place = placed.get((symbol.processor, symbol.name))
            part = Part(
                symbol=symbol,
                name=f"{symbol.name} ({owner})" if twice else symbol.name,
                owner=owner,
                is_code=is_code,
                segment=place.segment if place else "",
                home=self._stretch_in(place.segment, place.address) if place else self._asked_for(symbol),
            )
            if symbol.nbytes and not (is_code and owner not in with_code_outside):
                yield part

    def _starts(self, processor: str | None) -> Iterator[int]:
        """Yield the starts of the segments that the LDF fills in the blocks of a processor; None: of both."""
        for block in self.script.blocks:
            for output in block.output_sections if block.processor == processor else ():
                if output.segment:
                    yield self.script.segment_by_name[output.segment].start

    def _with_code_outside(self, placements: Sequence[Placement]) -> set[str]:
        """Return the cores with code outside L1: the code of other cores stays where it is."""
        if not self.is_linked:
            return {*self.board.chip.cores}
        return {
            CORE_OF_PROCESSOR[each.symbol.processor]
            for each in placements
            if each.symbol.section == SECTION and each.symbol.processor
            for stretch in [self._stretch_in(each.segment, each.address)]
            if stretch is None or self.stretches[stretch].level is not Level.L1_CODE
        }

    def _stretch_in(self, segment: str, address: int) -> int | None:
        """Return the stretch of a segment at an address or before it: in the new LDF, reserves lie elsewhere."""
        start = self.script.segment_by_name[segment].start
        found = [number for number, each in enumerate(self.stretches) if each.segment.start == start]
        return max(
            (number for number in found if self.stretches[number].start <= address),
            default=min(found, default=None),
        )

    def _asked_for(self, symbol: Symbol) -> int | None:
        """Return the first stretch that the LDF has for the section of a symbol."""
        for block in self.script.blocks:
            for output in block.output_sections if block.serves(symbol) else ():
                inputs = (each for each in output.statements if isinstance(each, InputSections))
                if output.segment and any(each.takes(symbol) for each in inputs):
                    return self._stretch_in(output.segment, 0)
        return None

    def _item(self, part: Part, measured: Measured) -> Item:
        choices = tuple(
            Choice(
                stretch=number,
                nbytes=align_up(part.symbol.nbytes, self.stretches[number].align),
                cclk=self.cclk(part, number, measured),
            )
            for number in self.possible(part, measured)
        )
        return Item(name=part.label, nbytes=part.symbol.nbytes, choices=choices)

    def possible(self, part: Part, measured: Measured) -> list[int]:
        """Return the possible stretches of a part: its present one, then others, those in slow memories first.

        This leaves fast memories free. Among equally slow ones, those that the LDF uses for the part's core come first.
        Code goes to L1 first: nothing else can, and code that did not run on these pictures may run on others.
        """
        own = self._segments_of[part.symbol.processor]

        def order(number: int) -> tuple[bool, bool, int, bool, int]:
            stretch = self.stretches[number]
            is_l1_code, is_foreign = stretch.level is Level.L1_CODE, stretch.segment.start not in own
            return not is_l1_code, number != part.home, stretch.level.rank, is_foreign, number

        return sorted(
            (each for each in range(len(self.stretches)) if self._can_lie(part, each, measured)), key=order
        )

    def _can_lie(self, part: Part, number: int, measured: Measured) -> bool:
        """Whether everything that uses a part reaches a stretch, and sees the same bytes there."""
        stretch, users = self.stretches[number], self._users(part)
        if number == part.home:
            return True
        if not stretch.takes(owner=part.owner, is_code=part.is_code):
            return False
        if stretch.level is Level.SCRATCH:  # DMA does not reach it
            is_used = any((core, part.name) in measured.accesses for core in users)
            return is_used and part.name not in measured.streamed
        if stretch.level is Level.SDRAM and any(
            self._caches[core].data for core in users
        ):  # caches are not coherent
            was_cached = part.home is not None and self.stretches[part.home].level is Level.SDRAM
            return was_cached or not (part.owner == SHARED or part.name in measured.streamed)
        return True

    def _users(self, part: Part) -> tuple[str, ...]:
        return self.board.chip.cores if part.owner == SHARED else (part.owner,)

    def _stall_cclk(self, use: Use, part: Part, number: int, measured: Measured) -> float:
        stretch, caches = self.stretches[number], self._caches[use[0]]
        known = measured.fetches if part.is_code else measured.stalls
        if (use, stretch.level) in known:
            return known[use, stretch.level]
        if part.is_code:
            issue_cclk = measured.issue_cclk.get(use, 0.0)
            return self._latencies.code_cclk(stretch.level, issue_cclk, is_cached=caches.code)
        made = measured.accesses.get(use, Accesses())
        return self._latencies.data_cclk(stretch.level, made.reads, made.writes, is_cached=bool(caches.data))

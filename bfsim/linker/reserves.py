"""The reserves of a link: where each RESERVE lies, and what those that expand finally get."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bfsim.errors import LinkError
from bfsim.linker.filling import Filling
from bfsim.linker.link_map import PlacedReserve, Placement
from bfsim.linker.script import LinkerScript, OutputSection, Reserve


@dataclass(frozen=True, slots=True)
class Reserved:
    """A RESERVE of an output section as it was placed at first: `nbytes` from `start`."""

    reserve: Reserve
    processor: str | None
    output: OutputSection
    start: int
    nbytes: int

    @property
    def owner(self) -> tuple[str | None, str]:
        """What a RESERVE and its RESERVE_EXPAND have in common."""
        return self.processor, self.reserve.name


def expanded(
    script: LinkerScript,
    reserves: Sequence[Reserved],
    placements: Sequence[Placement],
    fillings: Mapping[str, Filling],
) -> list[PlacedReserve]:
    """Return all reserves, after those that expand have taken the largest free stretch of their segment.

    What a RESERVE and the RESERVE_EXPAND of its name hold counts as free for them: together they become one stretch.
    The default LDFs use them so [assumed]: heap and stack get all that the data leave.
    """
    held = list(reserves)
    for expanding in (each for each in reserves if each.reserve.expands):
        filling = fillings[expanding.output.segment]
        pair = [each for each in held if each.owner == expanding.owner]
        others = [each for each in held if each.owner != expanding.owner]
        taken = [
            *((p.address, p.address + p.symbol.nbytes) for p in placements if fillings[p.segment] is filling),
            *((r.start, r.start + r.nbytes) for r in others if fillings[r.output.segment] is filling),
        ]
        start, nbytes = filling.largest_stretch(
            [each for each in taken if each[0] < each[1]], expanding.reserve.align
        )
        minimum = max(each.nbytes for each in pair)
        if nbytes < minimum:
            raise LinkError(
                f"{expanding.reserve.place}: RESERVE_EXPAND({expanding.reserve.name}) must have {minimum} bytes "
                f"from a multiple of {expanding.reserve.align}, not the {nbytes} that are left"
            )
        grown = Reserved(expanding.reserve, expanding.processor, expanding.output, start, nbytes)
        held = [grown if each is pair[0] else each for each in held if each is pair[0] or each not in pair]
    return [*_fixed(script), *map(_placed, held)]


def _placed(held: Reserved) -> PlacedReserve:
    return PlacedReserve(
        processor=held.processor,
        name=held.reserve.name,
        length_name=held.reserve.length_name,
        segment=held.output.segment,
        output_section=held.output.name,
        start=held.start,
        nbytes=held.nbytes,
        line=held.reserve.line,
    )


def _fixed(script: LinkerScript) -> list[PlacedReserve]:
    return [
        PlacedReserve(
            processor=each.processor,
            name=each.name,
            length_name=each.length_name,
            segment=segment.name,
            output_section="",
            start=each.start,
            nbytes=each.nbytes,
            line=each.line,
        )
        for each in script.reserves
        if (segment := script.segment_of(each))
    ]

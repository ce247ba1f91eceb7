"""The pieces of a segment: symbols, reserves, gaps, and free space."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from bfsim.linker.script import Segment
from bfsim.report.ldf.map import SHARED, ContentKind, MapPiece, MapSymbol


def pieces_of(
    segment: Segment, used_bytes: int, symbols: Sequence[MapSymbol], reserves: Sequence[MapPiece]
) -> Iterator[MapPiece]:
    """Yield the pieces of a segment. Used bytes without a name are a gap before a symbol, or after the last one."""
    placed = [_piece(each) for each in symbols if each.nbytes]
    named = _merged([*placed, *(each for each in reserves if each.nbytes)])
    last = max((each.start + each.nbytes for each in placed), default=segment.start)
    gaps = max(0, used_bytes - sum(each.nbytes for each in named))
    here = segment.start
    for piece in [*named, _unnamed(ContentKind.FREE, segment.end + 1, 0)]:
        space = piece.start - here
        gap = space if here < last else min(space, gaps)
        gaps -= gap
        if gap:
            yield _unnamed(ContentKind.RESERVED, here, gap)
        if space > gap:
            yield _unnamed(ContentKind.FREE, here + gap, space - gap)
        if piece.nbytes:
            yield piece
        here = max(here, piece.start + piece.nbytes)


def _unnamed(kind: ContentKind, start: int, nbytes: int) -> MapPiece:
    return MapPiece(
        name="free" if kind is ContentKind.FREE else "gap",
        kind=kind,
        owner=SHARED,
        start=start,
        nbytes=nbytes,
    )


def _piece(symbol: MapSymbol) -> MapPiece:
    return MapPiece(
        name=symbol.name, kind=symbol.kind, owner=symbol.owner, start=symbol.address, nbytes=symbol.nbytes
    )


def _merged(pieces: Iterable[MapPiece]) -> list[MapPiece]:
    """Return the pieces by address, with adjacent code of one core merged."""
    merged: list[MapPiece] = []
    ordered = sorted(pieces, key=lambda piece: piece.start)
    for (kind, _), group in groupby(ordered, key=lambda piece: (piece.kind, piece.owner)):
        run = list(group)
        if kind is ContentKind.CODE and len(run) > 1:
            nbytes = run[-1].start + run[-1].nbytes - run[0].start
            run = [replace(run[0], name=f"{len(run)} kernels", nbytes=nbytes)]
        merged.extend(run)
    return merged

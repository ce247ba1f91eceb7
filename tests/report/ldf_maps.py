"""Memory maps by hand, for the tests of lint, tables and pictures."""

from __future__ import annotations

from bfsim.report.ldf.map import (
    SHARED,
    CacheRange,
    ContentKind,
    MapPiece,
    MapSection,
    MapSegment,
    MapSymbol,
    MemoryMap,
)

BANK_BYTES = 8 * 1024**2
DATA_A = 0xFF800000


def a_symbol(name: str, kind: ContentKind, owner: str, address: int, nbytes: int = 1000) -> MapSymbol:
    """A symbol at an address; below the four banks' end it is in SDRAM."""
    last = address + nbytes - 1
    banks = tuple(range(address // BANK_BYTES, last // BANK_BYTES + 1)) if address < 4 * BANK_BYTES else ()
    return MapSymbol(
        name=name, kind=kind, owner=owner, section=f"of_{name}", nbytes=nbytes, address=address,
        output_section="out", line=1, banks=banks,
    )  # fmt: skip


def a_segment(
    memory: str,
    *symbols: MapSymbol,
    start: int = 0,
    nbytes: int = BANK_BYTES,
    used_bytes: int = 0,
    takes: tuple[str, ...] = (),
) -> MapSegment:
    """A segment with symbols in it, by address; what lies between them is free."""
    section = MapSection(
        name="out", block="PROCESSOR p0", line=1, takes=takes, symbols=len(symbols), nbytes=0
    )
    pieces, here = [], start
    for each in symbols:
        pieces.append(_free(here, each.address))
        pieces.append(
            MapPiece(name=each.name, kind=each.kind, owner=each.owner, start=each.address, nbytes=each.nbytes)
        )
        here = each.address + each.nbytes
    pieces.append(_free(here, start + nbytes))
    return MapSegment(
        name=f"MEM_{memory}", memory=memory, owner=SHARED, start=start, nbytes=nbytes, used_bytes=used_bytes,
        sections=(section,), symbols=symbols, pieces=tuple(piece for piece in pieces if piece.nbytes),
    )  # fmt: skip


def _free(start: int, end: int) -> MapPiece:
    return MapPiece(name="free", kind=ContentKind.FREE, owner=SHARED, start=start, nbytes=max(0, end - start))


def a_map(*segments: MapSegment, caches: tuple[CacheRange, ...] = ()) -> MemoryMap:
    """A map of segments."""
    return MemoryMap(
        ldf="test.ldf", firmware="test:firmware", board="test-board", width_px=320, height_px=240,
        segments=segments, caches=caches,
    )  # fmt: skip

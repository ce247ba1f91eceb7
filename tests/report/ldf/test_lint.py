"""Each lint of a memory map: a map that it finds something in, and one beside it that is fine."""

from __future__ import annotations

import pytest

from bfsim.report.ldf.bank_rules import Stream, streams_by_bank
from bfsim.report.ldf.finding import Finding
from bfsim.report.ldf.lint import lint
from bfsim.report.ldf.map import SHARED, CacheRange, ContentKind, MemoryMap
from tests.report.ldf_maps import BANK_BYTES, DATA_A, a_map, a_segment, a_symbol

SCRATCH = 0xFFB00000
L2 = 0xFEB00000
CODE_CACHE = CacheRange(memory="COREA_L1_CODE_CACHE", owner="A", start=0xFFA10000, nbytes=0x4000)
DATA_CACHE = CacheRange(memory="COREA_L1_DATA_A", owner="A", start=DATA_A + 0x4000, nbytes=0x4000)


def found(memory_map: MemoryMap, rule: str) -> list[Finding]:
    """What a rule finds."""
    return [each for each in lint(memory_map) if each.rule == rule]


def bank(number: int) -> int:
    """First address of an internal bank of the SDRAM."""
    return number * BANK_BYTES


def sdram(*where: tuple[str, ContentKind, str, int]) -> MemoryMap:
    """Buffers in SDRAM: name, kind, owner, bank; buffers of one bank lie behind each other."""
    symbols = [
        a_symbol(name, kind, owner, bank(number) + 0x1000 * index)
        for index, (name, kind, owner, number) in enumerate(where)
    ]
    return a_map(a_segment("SDRAM", *symbols, nbytes=4 * BANK_BYTES))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (("camera", ContentKind.CAMERA, "A"), ("camera", ContentKind.CAMERA, "B")),
        (("camera", ContentKind.CAMERA, "A"), ("image", ContentKind.LINES, "A")),
        (("image", ContentKind.LINES, "A"), ("image", ContentKind.LINES, "B")),
        (("image", ContentKind.LINES, "A"), ("map", ContentKind.LINES, SHARED)),
    ],
    ids=["two cameras", "camera and image", "images of two cores", "one core's and both cores'"],
)
def test_streams_of_two_masters_in_one_bank(
    one: tuple[str, ContentKind, str], other: tuple[str, ContentKind, str]
) -> None:
    """They are told by name, bank and master; in two banks they are fine."""
    (finding,) = found(sdram((*one, 2), (*other, 2)), "streams share a bank")
    assert finding.where == "SDRAM bank 2"
    assert one[0] in finding.reason
    assert other[0] in finding.reason
    assert not found(sdram((*one, 2), (*other, 3)), "streams share a bank")


def test_what_is_not_streamed_may_share_a_bank() -> None:
    """Rows, tables and code are no streams, whoever owns them."""
    memory_map = sdram(
        ("image", ContentKind.LINES, "A", 1),
        ("row", ContentKind.ROW, "B", 1),
        ("table", ContentKind.TABLE, "B", 1),
        ("kernel", ContentKind.CODE, "B", 1),
    )
    assert not found(memory_map, "streams share a bank")


def test_a_buffer_over_two_banks_streams_through_both() -> None:
    """An image that crosses the border of two banks meets a camera in either."""
    image = a_symbol("image", ContentKind.LINES, "A", bank(1) - 500, 1000)
    for number, where in ((0, 0), (1, bank(1) + 0x1000)):
        camera = a_symbol("camera", ContentKind.CAMERA, "B", where)
        (finding,) = found(a_map(a_segment("SDRAM", image, camera)), "streams share a bank")
        assert finding.where == f"SDRAM bank {number}"


def test_streams_by_bank_is_about_data_alone() -> None:
    """The judgement needs no map: streams in, banks out."""
    streams = [
        Stream(buffer="left", master="camera A", banks=(0,)),
        Stream(buffer="wide", master="core A", banks=(0, 1)),
    ]
    assert streams_by_bank(streams) == {0: streams, 1: streams[1:]}


def test_advice_names_a_bank_without_streams_and_its_sections() -> None:
    """The input sections that go to a free bank are what the user has to write."""
    memory_map = a_map(
        a_segment(
            "SDRAM",
            a_symbol("camera", ContentKind.CAMERA, "A", 0),
            a_symbol("camera", ContentKind.CAMERA, "B", 0x1000),
            takes=("sdram_bank0",),
        ),
        a_segment("SDRAM", start=bank(1), takes=("sdram_bank1", "sdram_data_bank1")),
    )
    (finding,) = found(memory_map, "streams share a bank")
    assert "sdram_bank1, sdram_data_bank1" in finding.advice
    assert "sdram_bank0" not in finding.advice


def test_images_of_one_core_in_one_bank() -> None:
    """They are pointed at as a matter of the main loop; one image alone is fine."""
    (finding,) = found(
        sdram(("in", ContentKind.LINES, "A", 2), ("out", ContentKind.LINES, "A", 2)), "images share a bank"
    )
    assert finding.reason.startswith("in and out of core A")
    assert not found(
        sdram(("in", ContentKind.LINES, "A", 2), ("out", ContentKind.LINES, "A", 3)), "images share a bank"
    )


def test_code_outside_l1() -> None:
    """Code in L2 is hot code in the wrong place; in L1, or behind a code cache, it is fine."""
    in_l2 = a_segment("L2", a_symbol("sobel_row", ContentKind.CODE, "A", L2, 144))
    (finding,) = found(a_map(in_l2), "hot code outside L1")
    assert "sobel_row, 144 bytes" in finding.reason
    in_l1 = a_segment("COREA_L1_CODE_CACHE", a_symbol("sobel_row", ContentKind.CODE, "A", 0xFFA10000, 144))
    assert not found(a_map(in_l1), "hot code outside L1")
    assert not found(a_map(in_l2, caches=(CODE_CACHE,)), "hot code outside L1")


def test_the_cache_of_one_core_does_not_serve_the_other() -> None:
    """Core B's code in L2 is not behind core A's cache."""
    in_l2 = a_segment("L2", a_symbol("sobel_row", ContentKind.CODE, "B", L2))
    assert found(a_map(in_l2, caches=(CODE_CACHE,)), "hot code outside L1")


@pytest.mark.parametrize(
    ("address", "inside"),
    [(0x2000, False), (0x4000 - 1000, False), (0x4000 - 999, True), (0x4000, True), (0x7FFF - 1000, True)],
)
def test_a_dma_target_in_a_cached_half(address: int, *, inside: bool) -> None:
    """The upper 16 KB of a bank with cache hold no lines; tight at the border."""
    lines = a_symbol("ring", ContentKind.LINES, "A", DATA_A + address, 1000)
    memory_map = a_map(a_segment("COREA_L1_DATA_A", lines, start=DATA_A), caches=(DATA_CACHE,))
    assert bool(found(memory_map, "DMA target in a cached half")) == inside
    assert not found(a_map(*memory_map.segments), "DMA target in a cached half")


def test_a_row_in_a_cached_half_is_no_dma_target() -> None:
    """It cannot be there either, but by another name."""
    row = a_symbol("gx", ContentKind.ROW, "A", DATA_A + 0x5000)
    memory_map = a_map(a_segment("COREA_L1_DATA_A", row, start=DATA_A), caches=(DATA_CACHE,))
    assert found(memory_map, "symbols in a cached half")
    assert not found(memory_map, "DMA target in a cached half")


def test_lines_in_scratchpad() -> None:
    """DMA does not reach the scratchpad; a row of a kernel is welcome there."""
    for kind, count in (
        (ContentKind.LINES, 1),
        (ContentKind.CAMERA, 1),
        (ContentKind.ROW, 0),
        (ContentKind.TABLE, 0),
    ):
        memory_map = a_map(a_segment("COREA_SCRATCH", a_symbol("x", kind, "A", SCRATCH)))
        assert len(found(memory_map, "DMA buffer in scratchpad")) == count
    assert not found(
        a_map(a_segment("COREA_L1_DATA_A", a_symbol("x", ContentKind.LINES, "A", DATA_A))),
        "DMA buffer in scratchpad",
    )


@pytest.mark.parametrize(("used_bytes", "count"), [(950, 0), (951, 1), (1000, 1)])
def test_nearly_full(used_bytes: int, count: int) -> None:
    """More than 95 % used."""
    memory_map = a_map(a_segment("L2", start=L2, nbytes=1000, used_bytes=used_bytes))
    assert len(found(memory_map, "nearly full")) == count


@pytest.mark.parametrize(
    ("memory", "takes", "used_bytes", "count"),
    [
        ("COREA_L1_CODE_CACHE", ("program", "cplb_code"), 950, 0),
        ("COREA_L1_CODE_CACHE", ("program", "cplb_code"), 951, 2),
        ("COREA_L1_CODE_CACHE", ("cplb_code",), 0, 1),
        ("L2", ("program", "cplb_code"), 0, 1),
    ],
    ids=["room beside it", "that is full, too", "room for something else", "a slower memory"],
)
def test_nearly_full_where_the_next_one_finds_room(
    memory: str, takes: tuple[str, ...], used_bytes: int, count: int
) -> None:
    """What spills to a memory as fast costs nothing."""
    full = a_segment("COREA_L1_CODE", start=0, nbytes=1000, used_bytes=1000, takes=("program",))
    other = a_segment(memory, start=0x2000, nbytes=1000, used_bytes=used_bytes, takes=takes)
    assert len(found(a_map(full, other), "nearly full")) == count


def test_tables_in_sdram() -> None:
    """Look-up tables wait for the SDRAM at every element, but not behind a data cache or in L2."""
    table = a_symbol("atan", ContentKind.TABLE, "A", bank(2), 257)
    (finding,) = found(a_map(a_segment("SDRAM", table)), "table in SDRAM")
    assert "atan, 257 bytes" in finding.reason
    assert not found(a_map(a_segment("SDRAM", table), caches=(DATA_CACHE,)), "table in SDRAM")
    assert not found(a_map(a_segment("L2", a_symbol("atan", ContentKind.TABLE, "A", L2))), "table in SDRAM")


def test_long_lists_are_cut() -> None:
    """A finding stays a sentence, however many buffers are in it."""
    memory_map = sdram(*((f"image_{number}", ContentKind.LINES, "A", 2) for number in range(9)))
    (finding,) = found(memory_map, "images share a bank")
    assert finding.reason.startswith("image_0, image_1, image_2, image_3 and 5 more of core A")

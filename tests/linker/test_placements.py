"""The shipped placements with the built-in firmware: everything fits, and lies where the file says that it does."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import pytest

from bfsim.kernel.profile import DEFAULT
from bfsim.mapping import map_memory
from bfsim.report.ldf.lint import lint
from bfsim.report.ldf.map import ContentKind, MemoryMap
from bfsim.shipped import LDF_FOLDER

SIZES = [(160, 120), (320, 240), (640, 480)]
KIB = 1024
CACHE_BYTES = 16 * KIB
IMAGES = {"colour_image", "edge_image", "opened_image"}
CLOSE = (
    "camera_ring", "colour_ring", "opened_ring", "edge_ring", "grey_ring", "smooth_ring", "eroded_ring",
    "magnitude_ring", "direction_ring", "gx", "gy", "atan", "candidate_ring", "edge_index", "edge_counts",
)  # fmt: skip
"""What every stage reads or writes all the time."""


@cache
def placed(name: str, width_px: int = 320, height_px: int = 240, profile: str = DEFAULT.name) -> MemoryMap:
    """The built-in firmware in one of the shipped placements."""
    return map_memory(
        LDF_FOLDER / f"{name}.ldf", firmware="tinyphoon", board="cm-bf561", profile=profile,
        width_px=width_px, height_px=height_px,
    )  # fmt: skip


def memories(memory_map: MemoryMap, *kinds: ContentKind) -> dict[str, set[str]]:
    """The memories of what is of these kinds, by name."""
    found: dict[str, set[str]] = {}
    for segment in memory_map.segments:
        for each in segment.symbols:
            if each.kind in kinds:
                found.setdefault(each.name, set()).add(segment.memory)
    return found


def sizes_where(memory_map: MemoryMap, memory: str) -> int:
    """Bytes of symbols in a memory."""
    return sum(s.nbytes for each in memory_map.segments if each.memory == memory for s in each.symbols)


@pytest.mark.parametrize(("width_px", "height_px"), SIZES)
@pytest.mark.parametrize("name", ["thesis", "sdram", "l2", "cache"])
def test_every_placement_holds_the_firmware(name: str, width_px: int, height_px: int) -> None:
    """At each size of the camera, with the same symbols, none over another."""
    memory_map = placed(name, width_px, height_px)
    symbols = sorted(memory_map.symbols, key=lambda each: each.address)
    assert all(one.address + one.nbytes <= two.address for one, two in pairwise(symbols))
    here = {(each.owner, each.name, each.nbytes) for each in symbols}
    assert here == {
        (each.owner, each.name, each.nbytes) for each in placed("thesis", width_px, height_px).symbols
    }


@pytest.mark.parametrize("name", ["thesis", "sdram", "l2", "cache"])
def test_images_of_each_stream_have_a_bank(name: str) -> None:
    """Cameras in banks 0 and 1, working images in 2 and 3; nothing of another owner beside them."""
    banks = {(each.kind, each.owner): each.banks for each in placed(name).symbols if each.name in ("camera", "colour_image")}  # fmt: skip
    assert banks == {
        (ContentKind.CAMERA, "A"): (0,),
        (ContentKind.CAMERA, "B"): (1,),
        (ContentKind.LINES, "A"): (2,),
        (ContentKind.LINES, "B"): (3,),
    }
    assert "streams share a bank" not in {each.rule for each in lint(placed(name))}


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", ["thesis", "sdram", "l2"])
def test_all_code_of_visualdsp_is_in_l1(name: str) -> None:
    """What the code memory has no room for is in the code cache, which is off."""
    found = memories(placed(name, profile="vdsp-O2"), ContentKind.CODE)
    assert all("_L1_CODE" in each for where in found.values() for each in where)


@pytest.mark.parametrize("name", ["sdram", "l2"])
def test_placements_differ_in_data_only(name: str) -> None:
    """Code of GCC, which is larger, fills L1 in each of them, and what is left is in L2."""
    found = memories(placed(name), ContentKind.CODE)
    assert found == memories(placed("thesis"), ContentKind.CODE)
    assert {each for where in found.values() for each in where if "_L1_CODE" not in each} == {"L2"}


def test_code_that_the_cache_leaves_no_room_for_is_in_sdram() -> None:
    """It is fetched through the cache; the rest is in L1."""
    found = memories(placed("cache"), ContentKind.CODE)
    outside = {memory for where in found.values() for memory in where if "_L1_CODE" not in memory}
    assert outside == {"SDRAM"}


def test_thesis_keeps_lines_and_tables_in_l1() -> None:
    """Rings, tables and edge store are in L1, images in SDRAM, and what the cores share in L2."""
    found = memories(placed("thesis"), ContentKind.LINES, ContentKind.ROW, ContentKind.TABLE)
    assert all("L1_DATA" in each for name in CLOSE for each in found[name])
    assert {name for name, where in found.items() if where == {"SDRAM"}} >= IMAGES
    assert found["right_edges"] == {"L2"}


def test_sdram_has_all_data() -> None:
    """Rings, tables and edge store, too: L1 data banks keep heap and stack alone."""
    found = memories(placed("sdram"), *ContentKind)
    data = {name: where for name, where in found.items() if where & {"SDRAM"}}
    assert {"camera_ring", "atan", "edge_data", "gx"} <= set(data)
    assert all(where == {"SDRAM"} for where in data.values())
    assert (
        sizes_where(placed("sdram"), "COREA_L1_DATA_A")
        == sizes_where(placed("sdram"), "COREB_L1_DATA_B")
        == 0
    )
    assert "table in SDRAM" in {each.rule for each in lint(placed("sdram"))}


@pytest.mark.parametrize(("width_px", "height_px"), SIZES)
def test_l2_takes_what_thesis_has_in_l1(width_px: int, height_px: int) -> None:
    """Rings, tables and edge store of both cores, as long as there is room; core A's come first."""
    memory_map = placed("l2", width_px, height_px)
    (l2,) = (each for each in memory_map.segments if each.memory == "L2")
    close = [
        (each.memory, symbol)
        for each in memory_map.segments
        for symbol in each.symbols
        if symbol.name in CLOSE
    ]
    assert {memory for memory, symbol in close if symbol.owner == "A"} == {"L2"}
    assert all(symbol.nbytes > l2.free_bytes for memory, symbol in close if memory != "L2")


def test_cache_gives_half_of_each_bank_away() -> None:
    """Three caches of 16 KB in each core, and nothing is placed in them."""
    memory_map = placed("cache")
    assert [(each.memory, hex(each.start), each.nbytes) for each in memory_map.caches] == [
        ("COREA_L1_DATA_A", "0xff804000", CACHE_BYTES),
        ("COREA_L1_DATA_B", "0xff904000", CACHE_BYTES),
        ("COREA_L1_CODE_CACHE", "0xffa10000", CACHE_BYTES),
        ("COREB_L1_DATA_A", "0xff404000", CACHE_BYTES),
        ("COREB_L1_DATA_B", "0xff504000", CACHE_BYTES),
        ("COREB_L1_CODE_CACHE", "0xff610000", CACHE_BYTES),
    ]
    assert not any("cached half" in each.rule for each in lint(memory_map))
    assert memories(memory_map, ContentKind.ROW)["edge_data"] == {"SDRAM"}


@pytest.mark.parametrize("name", ["thesis", "sdram", "l2"])
def test_the_others_have_no_cache(name: str) -> None:
    """Their switches are 0."""
    assert placed(name).caches == ()

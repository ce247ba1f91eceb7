"""Placements as LDFs: what is written is what was meant, for every shipped LDF and for odd ones."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from bfsim.chip.boards import BOARDS
from bfsim.linker import LinkerScript, LinkMap, Symbol, link
from bfsim.machine.code import SECTION, object_file
from bfsim.placing.ldf import LdfWriter
from bfsim.placing.measured import Accesses, Measured
from bfsim.placing.model import Model
from bfsim.placing.stretches import Level
from bfsim.running.inputs import read_placement

SIZES = (4, 13, 77, 300, 1024, 2049)


def symbol(name: str, section: str, nbytes: int, processor: str | None) -> Symbol:
    """A symbol with the object file that firmware gives it."""
    return Symbol(name, section, nbytes, processor=processor, object_file=object_file(name))


def symbols(processors: tuple[str, ...], code: str = SECTION) -> list[Symbol]:
    """Buffers and kernels of each core, and what both share; some have names that an LDF cannot have without quotes."""
    sections = ("L1_data_a", "L1_data_b", "data1", "bsz", "L1_scratch", "sdram_bank0")
    own = [
        symbol(
            f"{section} {number}" if number == 2 else f"{section}.{number}", section, SIZES[number], processor
        )
        for processor in processors
        for section in sections
        for number in range(3)
    ]
    kernels = [
        symbol(f"kernel_{number}", code, 60 * (number + 1), p) for p in processors for number in range(5)
    ]
    shared = [
        symbol(f"exchange{number}", "l2_shared", 500, None) for number in range(3 * (len(processors) > 1))
    ]
    return [*own, *kernels, *shared]


def used(model: Model) -> Measured:
    """Every part was accessed by its core."""
    return Measured(accesses={(core, part.name): Accesses(9, 9) for part in model.parts for core in "AB"})


def written(model: Model, places: list[int], folder: Path) -> tuple[LinkerScript, LinkMap]:
    """Write a placement and link by it."""
    path = folder / "placed.ldf"
    writer = LdfWriter(model.script, model.stretches)
    why = {each.label: "a remark /* that would end a comment */ \\" for each in model.parts}
    path.write_text(writer.text(model.parts, places, why, ["About it. */", "More."]))
    script = read_placement(path, model.board, {}, ())
    return script, link(script, model.symbols, model.board.chip.regions, chip=model.board.chip.name)


def check(model: Model, folder: Path, seed: int) -> None:
    """Every part lies in the segment that it was given at random, and memories, reserves and switches are as before."""
    possible, random = used(model), Random(seed)
    room = [each.nbytes for each in model.stretches]
    places = []
    for part in model.parts:
        free = [each for each in model.possible(part, possible) if room[each] >= part.symbol.nbytes + 32]
        places.append(random.choice(free))
        room[places[-1]] -= -(-part.symbol.nbytes // 32) * 32
    script, link_map = written(model, places, folder)
    for part, number in zip(model.parts, places, strict=True):
        stretch = model.stretches[number]
        address = link_map.find(part.symbol.processor, part.symbol.name).address
        assert stretch.segment.start <= address <= stretch.segment.end
    before = link(model.script, (), model.board.chip.regions, chip=model.board.chip.name)
    after = link(script, (), model.board.chip.regions, chip=model.board.chip.name)
    assert [(each.name, each.start, each.nbytes) for each in script.segments] == [
        (each.name, each.start, each.nbytes) for each in model.script.segments
    ]
    assert {(each.name, each.segment, each.nbytes) for each in after.reserves} == {
        (each.name, each.segment, each.nbytes) for each in before.reserves
    }
    assert after.values.keys() == before.values.keys()
    assert {key: value for key, value in after.values.items() if key[1].startswith("___")} == {
        key: value for key, value in before.values.items() if key[1].startswith("___")
    }


@pytest.mark.parametrize("name", ["thesis", "sdram", "l2", "cache"])
def test_shipped_memories_come_back(name: str, tmp_path: Path) -> None:
    board = BOARDS["cm-bf561"]
    model = Model(board, read_placement(Path(name), board, {}, ()), symbols(("p0", "p1")))
    assert model.is_linked
    for seed in range(2):
        check(model, tmp_path, seed)


def test_one_core_comes_back(tmp_path: Path) -> None:
    board = BOARDS["cm-bf533"]
    model = Model(board, read_placement(Path("cm-bf533"), board, {}, ()), symbols(("p0",)))
    check(model, tmp_path, 1)


ODD = """
ARCHITECTURE(ADSP-BF561)
$OBJECTS = start.doj, $COMMAND_LINE_OBJECTS;
SHARED_MEMORY { MASTERS(p0 p1)
   MEMORY { L2 { START(0xFEB00000) LENGTH(128K) } BANK { START(32) LENGTH(8M) } NOT_HERE { START(0x7000000) LENGTH(16M) } }
   SECTIONS { RESERVE(boot = 0xFEB08000, boot_length = 0x400)
      both { INPUT_SECTIONS($OBJECTS(l2_shared)) } > L2 } }
PROCESSOR p0 {
   MEMORY { DATA { START(0xFF800000) LENGTH(16K) } CODE { START(0xFFA00000) LENGTH(16K) } PAD { START(0xFFB00000) LENGTH(4K) } }
   SECTIONS {
      data { INPUT_SECTIONS($OBJECTS{prefersMem("internal")}(data1)) INPUT_SECTION_ALIGN(8) INPUT_SECTIONS_PIN($OBJECTS(L1_data_a))
             INPUT_SECTIONS($OBJECTS{prefersMem("internal")}(bsz) spare.doj(bsz)) RESERVE(heap, heap_length, 1K, 8) } > DATA
      code { INPUT_SECTIONS($OBJECTS(program)) } > CODE
      pad { INPUT_SECTIONS($OBJECTS(L1_scratch)) } > PAD
      rest { INPUT_SECTIONS($OBJECTS(L1_* data1 bsz)) RESERVE_EXPAND(pool, pool_length = 0, 64, 32) } > L2
      far { INPUT_SECTIONS($OBJECTS(sdram_bank0)) } > BANK } }
PROCESSOR p1 {
   MEMORY { DATA { START(0xFF400000) LENGTH(16K) } CODE { START(0xFF600000) LENGTH(16K) } PAD { START(0xFF700000) LENGTH(4K) } }
   SECTIONS {
      data { ___l1_data_cache_a = 1; INPUT_SECTIONS($OBJECTS(L1_data_a L1_data_b)) RESERVE(stack, stack_length = 2K, 16) } > DATA
      code { INPUT_SECTIONS($OBJECTS(program)) } > CODE
      pad { INPUT_SECTIONS($OBJECTS(L1_scratch)) } > PAD
      far { INPUT_SECTIONS($OBJECTS(data1 bsz sdram_bank0)) } > BANK } }
"""


def test_an_odd_ldf_comes_back(tmp_path: Path) -> None:
    """Segments of one name on each core or of no memory, reserves that cut memory, take the rest or expand, pins, quotes, filters."""
    board = BOARDS["cm-bf561"]
    (tmp_path / "odd.ldf").write_text(ODD)
    script = read_placement(tmp_path / "odd.ldf", board, {}, ())
    model = Model(board, script, symbols(("p0", "p1")))
    assert [each.nbytes for each in model.stretches if each.level is Level.L2] == [
        0x8000 - 64,
        128 * 1024 - 0x8400,
    ]
    for seed in range(3):
        check(model, tmp_path, seed)


def test_what_is_new_goes_where_its_section_says(tmp_path: Path) -> None:
    """A buffer that the placement does not know is taken by the sections of the LDF that it began with."""
    board = BOARDS["cm-bf561"]
    model = Model(board, read_placement(Path("thesis"), board, {}, ()), symbols(("p0", "p1")))
    script, _ = written(model, [each.home or 0 for each in model.parts], tmp_path)
    new = symbol("newcomer", "L1_data_b", 16, "p0")
    link_map = link(script, [*model.symbols, new], board.chip.regions, chip=board.chip.name)
    assert link_map.find("p0", "newcomer").segment == "MEM_A_L1_DATA_B"


def test_code_moves_where_some_of_it_is_outside_l1(tmp_path: Path) -> None:
    """Core A's kernels ask for SDRAM and move to L1; those of core B stay and are no parts."""
    board = BOARDS["cm-bf561"]
    text = ODD.replace("INPUT_SECTIONS($OBJECTS(program)) } > CODE\n      pad", "} > CODE\n      pad", 1)
    (tmp_path / "odd.ldf").write_text(
        text.replace(
            "(sdram_bank0)) } > BANK } }\nPROCESSOR p1", "(sdram_bank0 program)) } > BANK } }\nPROCESSOR p1"
        )
    )
    model = Model(board, read_placement(tmp_path / "odd.ldf", board, {}, ()), symbols(("p0", "p1")))
    code = {part.owner for part in model.parts if part.is_code}
    assert code == {"A"}
    places = model.best(Measured())
    script, link_map = written(model, list(places), tmp_path)
    assert {link_map.find("p0", f"kernel_{number}").segment for number in range(5)} == {"CODE"}
    assert script.path.read_text().count("$CODE_OF_A_IN_CODE") == 2

"""Both timings of the same code: closed forms on short sequences, each interlock from both sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bfsim.blackfin.elf.image import Image, Routine
from bfsim.blackfin.instructions.decode import Instruction, decode
from bfsim.blackfin.timing.interlocks import NOTHING, issued_in_turn
from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from bfsim.kernel import GCC_O0, GCC_O2, VDSP_O2
from bfsim.kernel.objects.timing import timing_of
from bfsim.kernel.profile import GCC, GCC_ADI
from tests.blackfin.code import CODE, DATA, processor

ENCODED = {
    "P1 = [P0]": "4191",
    "R0 = [P1]": "0891",
    "R0 = B[P1] (Z)": "0899",
    "NOP": "0000",
    "P1 = R0": "0832",
    "P1 = P0": "4832",
    "P1 = 5": "2968",
    "P1.L = 5": "09e10500",
    "P1.H = 5": "49e10500",
    "R2 = P1": "5130",
    "P2 = P1 + P0": "815a",
    "CC = P1 == 0": "410c",
    "[P0] = P1": "4193",
    "JUMP (P1)": "5100",
    "I0 = R0": "0034",
    "R1 = [I0]": "019d",
    "M0 = R0": "2034",
    "I0 += M0": "609e",
    "UNLINK": "01e80000",
    "RETS = [SP++]": "2701",
    "RTS": "1000",
    "R0 = [P0]": "0091",
    "R1 = R0 + R0": "4050",
    "R0.L = R1.L * R2.L": "00c20a20",
    "R0 = R7 << 2 || P1 = [P0]": "82ce178041910000",
    "R0 *= R1": "c840",
    "IF CC P1 = R0": "8807",
    "[--SP] = (R7:4, P5:3)": "e305",
    "(R7:4, P5:3) = [SP++]": "a305",
    "[--SP] = (R7:7)": "7805",
    "[--SP] = (P5:5)": "c504",
    "LINK 0": "00e80000",
    "LSETUP LC0 = P1": "a2e00310",
    "LSETUP LC0 = P2": "a2e00320",
}
"""By bfin-elf-as; loops go over the next two instructions of two bytes each."""


def of(*texts: str) -> list[Instruction]:
    """Instructions one behind the other."""
    found, address = [], CODE
    for each in texts:
        found.append(decode(bytes.fromhex(ENCODED[each]).ljust(8, b"\0"), address))
        address = found[-1].end
    return found


def waits(*texts: str) -> list[int]:
    """How long each of a sequence waits."""
    found, _ = issued_in_turn(of(*texts), NOTHING, ADI.interlocks)
    return [each.cclk for each in found]


def called(*texts: str, timing: Timing, **registers: int) -> tuple[int, int]:
    """Cycles of a subroutine, RTS included, and those of them that its instructions waited."""
    code = "".join(ENCODED[each] for each in (*texts, "RTS"))
    core = processor(code, timing, P0=DATA, P1=DATA, **registers)
    core.space.at(DATA, 4)[:] = np.frombuffer(DATA.to_bytes(4, "little"), np.uint8)
    core.call(CODE)
    return core.state["CLOCK"], core.state["WAITED"]


@pytest.mark.parametrize("between", range(6))
@pytest.mark.parametrize(
    ("makes", "uses", "cclk"),
    [
        *(
            ("P1 = [P0]", uses, 3)
            for uses in ("R0 = [P1]", "R2 = P1", "P2 = P1 + P0", "CC = P1 == 0", "[P0] = P1", "JUMP (P1)")
        ),
        ("R0 = R7 << 2 || P1 = [P0]", "R0 = [P1]", 3),
        ("P1 = R0", "R0 = B[P1] (Z)", 4),
        ("P1 = R0", "LSETUP LC0 = P1", 4),
        ("IF CC P1 = R0", "R0 = [P1]", 4),
        ("I0 = R0", "R1 = [I0]", 4),
        ("M0 = R0", "I0 += M0", 4),
        ("UNLINK", "RTS", 4),
        ("RETS = [SP++]", "RTS", 4),
    ],
)
def test_a_wait_is_hidden_instruction_by_instruction(makes: str, uses: str, cclk: int, between: int) -> None:
    """Whatever is issued in between hides a cycle."""
    assert waits(makes, *between * ("NOP",), uses) == [0] * (between + 1) + [max(0, cclk - between)]


@pytest.mark.parametrize(
    "texts",
    [
        ("R0 = [P0]", "R1 = R0 + R0"),
        ("R0.L = R1.L * R2.L", "R1 = R0 + R0"),
        ("R0 *= R1", "R1 = R0 + R0"),
        ("P1 = P0", "R0 = [P1]"),
        ("P1 = 5", "R0 = [P1]"),
        ("P1.L = 5", "P1.H = 5", "R0 = [P1]"),
        ("P1 = [P0]", "P1 = 5", "R0 = [P1]"),
        ("P1 = [P0]", "R0 = [P0]"),
    ],
)
def test_what_waits_for_nothing(texts: tuple[str, ...]) -> None:
    """Data registers are there at once, and so is what pointers are set to."""
    assert sum(waits(*texts)) == 0


def test_a_wait_hides_another_one() -> None:
    """P1 is there two cycles before I0: who waits for it has waited for a part of the other."""
    assert waits("I0 = R0", "P1 = [P0]", "R0 = [P1]", "R1 = [I0]") == [0, 0, 3, 0]
    assert waits("P1 = [P0]", "I0 = R0", "R0 = [P1]", "R1 = [I0]") == [0, 0, 2, 1]


def test_several_registers() -> None:
    """The GNU simulator has 14 and 11 cycles for any number of them; ADI's document one for each [EE-171]."""
    texts = ("[--SP] = (R7:4, P5:3)", "(R7:4, P5:3) = [SP++]", "[--SP] = (R7:7)", "[--SP] = (P5:5)")
    assert list(map(GNU.of, of(*texts))) == [14, 11, 14, 14]
    assert list(map(ADI.of, of(*texts))) == [7, 7, 1, 1]


def test_all_other_cycles_are_the_same() -> None:
    """[EE-197] and the GNU simulator agree on them, those of predicted branches among them."""
    several = {"push_multiple", "pop_multiple"}
    assert {name: cclk for name, cclk in GNU.cclk.items() if name not in several} == ADI.cclk
    assert ADI.taken_cclk == GNU.taken_cclk == {"branch": 9, "branch_predicted": 5}


def test_a_call_takes_the_cycles_of_its_instructions_and_waits() -> None:
    """Native code counts both; the GNU simulator's timing has no waits."""
    texts = ("P1 = R0", "NOP", "R0 = [P1]")
    assert called(*texts, timing=ADI, R0=DATA) == (3 + 5 + 3, 3)
    assert called(*texts, timing=GNU, R0=DATA) == (3 + 5, 0)


@pytest.mark.parametrize("turns", [1, 2, 7])
def test_a_loop_waits_for_its_last_turn(turns: int) -> None:
    """The first turn finds P1 there; each other one waits for what the one before it has loaded at its end."""
    found = called("LSETUP LC0 = P2", "R0 = [P1]", "P1 = [P0]", timing=ADI, P2=turns)
    waited = 3 * (turns - 1)
    assert found == (1 + 2 * turns + 5 + waited, waited)


def test_a_library_counts_as_a_whole() -> None:
    """Each time that it is entered, whatever its instructions are, and nothing in it waits."""
    image = Image("code", (), {}, (Routine("_slow", CODE, CODE + 6),), frozenset(), b"")
    timing = replace(ADI, routines={"_slow": 47}).placed(image)
    assert called("P1 = R0", "R0 = [P1]", timing=timing, R0=DATA) == (47, 0)
    beside = replace(ADI, routines={"_other": 47}).placed(image)
    assert called("P1 = R0", "R0 = [P1]", timing=beside, R0=DATA) == (2 + 5 + 4, 4)


def test_profiles_say_which_timing() -> None:
    """Those with interlocks stand for ADI's documents, their library included."""
    assert timing_of(GCC) is timing_of(GCC_O2) is timing_of(GCC_O0) is GNU
    routines = timing_of(GCC_ADI).routines
    assert timing_of(VDSP_O2).routines == routines
    assert routines["___udivsi3"] + routines["___divsi3"] == VDSP_O2.library.divide_signed.cclk == 47
    assert timing_of(GCC_ADI).digest != ADI.digest != GNU.digest

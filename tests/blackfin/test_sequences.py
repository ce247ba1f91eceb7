"""Random sequences end as the GNU simulator has them end; `benchmarks/instruction_set.py --record` wrote down how."""

from __future__ import annotations

from pathlib import Path

from benchmarks.instructions.recorded import replayed
from benchmarks.instructions.sequences import DSP_GROUPS, translated
from bfsim.blackfin.instructions.decode import disassemble
from bfsim.blackfin.instructions.text import text

RECORDED = replayed(Path(__file__).parent / "data/sequences.json")


def test_registers_behind_240_sequences_are_those_of_the_gnu_simulator() -> None:
    sequences = [each for each, _ in RECORDED]
    wrong = {
        "; ".join(map(text, disassemble(each.code, 0))): {
            name: (ours[name], gnu[name]) for name in ours if ours[name] != gnu[name]
        }
        for (each, gnu), ours in zip(RECORDED, translated(sequences), strict=True)
        if ours != gnu
    }
    assert len(RECORDED) == 240
    assert not wrong


def test_nearly_every_dsp_instruction_is_in_them_and_bundles_too() -> None:
    """All but a few rows of the table, by chance."""
    instructions = [each for sequence, _ in RECORDED for each in disassemble(sequence.code, 0)]
    seen = {id(operation.form) for each in instructions for operation in each.operations}
    rows = [form for group in DSP_GROUPS for form in group]
    assert sum(id(form) in seen for form in rows) > 0.9 * len(rows)
    assert sum(len(each.operations) == 3 for each in instructions) > 100

"""Which kernels and stages of two runs are the same: also in another file, or under another name."""

from __future__ import annotations

from dataclasses import replace

from bfsim.report.diff.compare import difference_of
from bfsim.report.results.result import Result
from bfsim.trace import (
    KernelRecord,
    StallReason,
)
from tests.report.diff.diff_rig import TEXT, check_sums, kernel, line, run, wait


def test_kernels_that_came_and_went() -> None:
    """Both are in full, where their texts have nothing in common."""
    before = run(kernel(line(12, 1, 10), name="slow"))
    after = run(kernel(line(12, 1, 4), name="fast", text=[each.replace("row", "out") for each in TEXT]))
    found = difference_of(before, after)
    names = {part.name: (part.before_cclk, part.after_cclk) for part in found.stages[0].parts}
    assert names == {"slow": (10, 0), "fast": (0, 4)}
    check_sums(found.stages, -6)


def test_kernels_of_one_name_are_the_same_in_another_file() -> None:
    """Firmware that was copied to be edited: the symbol has the name of its file."""
    before = run(kernel(line(12, 1, 10)))
    copy = replace(kernel(line(12, 1, 14)), symbol="copy_blur", file="/home/me/copy.py")
    found = difference_of(before, run(copy))
    assert [(each.name, each.place, each.cclk) for each in found.stages[0].parts] == [
        ("blur", "copy.py:10", 4)
    ]


def test_a_kernel_that_was_renamed_is_the_one_with_its_lines() -> None:
    """What grew is told, not both of them in full; another kernel that came is not taken for it."""
    before = run(kernel(line(12, 1, 10), line(13, 1, 5)))
    other = kernel(line(12, 1, 99), text=["@kernel\n", "def other(row):\n", "    row[3] = 4\n"], name="other")
    found = difference_of(before, run(other, kernel(line(12, 1, 14), line(13, 1, 5), name="smooth")))
    parts = {each.name: each for each in found.stages[0].parts}
    assert {name: each.cclk for name, each in parts.items()} == {"other": 99, "blur → smooth": 4}
    assert [(each.name, each.cclk) for each in parts["blur → smooth"].parts] == [("left = row[0]", 4)]
    check_sums(found.stages, 103)


def test_a_stage_that_was_renamed_is_the_one_with_its_kernels() -> None:
    """What grew is told, not both of them in full; another stage that came with one kernel of it is not taken for it."""

    def blurs(stage: str, *more: KernelRecord, cclk: int) -> Result:
        blur, sharpen = (
            kernel(line(12, 1, cclk), stage=stage),
            kernel(line(12, 1, 7), name="sharpen", stage=stage),
        )
        return run(blur, sharpen, *more, waits=[wait(stage, "core B", StallReason.SEMAPHORE, 5)])

    new = kernel(line(12, 1, 99), stage="Look")
    found = difference_of(blurs("Blur", cclk=10), blurs("Smooth", new, cclk=14))
    stages = {each.name: (each.before_cclk, each.after_cclk) for each in found.stages}
    assert stages["Blur → Smooth"] == (17, 21)
    assert stages["Look"] == (0, 99)
    assert stages.keys() <= {"Blur → Smooth", "Look", "waits for other cores and the cameras"}
    check_sums(found.stages, 103)
    assert difference_of(blurs("Blur", cclk=10), blurs("Smooth", cclk=10)).cclk == 0


def test_stages_of_other_kernels_are_no_renamed_ones() -> None:
    """Half of the kernels, such as a routine of the library, do not make one of them."""
    before = run(kernel(line(12, 1, 10)), kernel(line(12, 1, 3), name="divide"))
    after = run(*(kernel(line(12, 1, 9), name=name, stage="Find") for name in ("divide", "peak")))
    assert {each.name for each in difference_of(before, after).stages} == {"Blur", "Find"}

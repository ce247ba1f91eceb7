"""What two runs were made with: frames, files, clocks and code, which are told apart from edits."""

from __future__ import annotations

from dataclasses import replace

import pytest

from bfsim.errors import ConfigError
from bfsim.report.diff.as_json import diff_json
from bfsim.report.diff.compare import difference_of
from bfsim.report.diff.difference import Change
from bfsim.report.diff.markdown import diff_markdown
from bfsim.report.diff.sentences import clock, code
from bfsim.report.diff.tables import diff_report
from bfsim.report.results.result import result_of
from tests.report.diff.diff_rig import kernel, line, run
from tests.report.printed import printed
from tests.report.records import IDENTITY


def test_other_frames_are_compared_without_lines() -> None:
    """Lines are counted over a whole run: where frames are missing they say nothing."""
    first, second = run(kernel(line(12, 1, 10))), run(kernel(line(12, 1, 30)))
    both = replace(second.run, frames=(*first.run.frames, *run(kernel(line(12, 1, 30)), index=1).run.frames))
    found = difference_of(first, result_of(both, {}))
    assert (found.frames, found.has_lines, found.cclk) == ((0,), False, 0)
    with pytest.raises(ConfigError, match="frames in common"):
        difference_of(first, run(kernel(line(12, 1, 30)), index=7))


def test_fewer_frames_are_told_as_such() -> None:
    """The digest of a recording is of the frames that ran: with fewer it looked like another recording."""
    first, second = run(kernel(line(12, 1, 10))), run(kernel(line(12, 1, 30)), index=1)
    longer = replace(first.run, frames=(*first.run.frames, *second.run.frames))
    longer = replace(longer, identity=replace(IDENTITY, recording_digest="0" * 64))
    found = difference_of(first, result_of(longer, {}))
    assert [(each.what, each.before, each.after) for each in found.configuration] == [("frames", "1", "2")]


def test_the_configuration_comes_first() -> None:
    """Names in full, digests cut."""
    one = run(kernel(line(12, 1, 10)))
    other = result_of(replace(one.run, identity=replace(IDENTITY, ldf="l2", ldf_digest="9" * 64)), one.seen)
    found = difference_of(one, other)
    assert [(each.what, each.before, each.after) for each in found.configuration] == [
        ("ldf", "thesis", "l2"),
        ("ldf: content", "4" * 12, "9" * 12),
    ]


def test_many_buffers_that_went_one_way_are_one_row() -> None:
    """Of another placement there were fifty rows before the cycles; JSON and the page have them all."""
    one = run(kernel(line(12, 1, 10)))
    ways = [(f"buffer ring{n}", "L1", "L2") for n in range(9)] + [("buffer table", "L2", "SDRAM")]
    changes = tuple(Change(what=what, before=before, after=after) for what, before, after in ways)
    found = replace(difference_of(one, run(kernel(line(12, 1, 30)))), configuration=changes)
    rows = ["| buffer ring0 and 8 others | L1 | L2 |", "| buffer table | L2 | SDRAM |"]
    assert [each for each in diff_markdown(found, 5).splitlines() if "buffer" in each] == rows
    assert any("buffer ring0 and 8 others" in each for each in printed(diff_report(found, 5)))
    assert "buffer ring8" in diff_json(found)


def test_code_of_another_gcc_is_named() -> None:
    """By whose it is; the profile and its digest are the same."""
    one, other = (
        replace(IDENTITY, code=f"GCC {version} -O2", code_digest=digit * 64)
        for version, digit in (("12.2.0", "7"), ("14.1.0", "8"))
    )
    measured = run(kernel(line(12, 1, 10)))
    results = [result_of(replace(measured.run, identity=each), measured.seen) for each in (one, other)]
    assert [(each.what, each.before, each.after) for each in difference_of(*results).configuration] == [
        ("code", "GCC 12.2.0 -O2", "GCC 14.1.0 -O2"),
        ("code: content", "7" * 12, "8" * 12),
    ]


def test_another_clock_is_told_apart_from_cycles() -> None:
    """The same cycles at half the clock take twice as long, and no line is the reason."""
    one = run(kernel(line(12, 1, 1000)))
    slower = result_of(replace(one.run, identity=replace(IDENTITY, cclk_hz=IDENTITY.cclk_hz / 2)), one.seen)
    found = difference_of(one, slower)
    assert found.cclk == 0
    assert clock(found) == "The core clock went from 1 MHz to 0.5 MHz: the same cycles take 100.0 % longer."
    assert clock(difference_of(slower, one)).endswith(
        "0.5 MHz to 1 MHz: the same cycles take 50.0 % less time."
    )
    assert clock(difference_of(one, one)) == ""


def test_clocks_are_whole_numbers_in_words() -> None:
    """They were listed as 600000000.0 and 500000000.0, which nobody counts the digits of."""
    one = run(kernel(line(12, 1, 10)))
    rates = {"cclk_hz": 500e6, "sclk_hz": 400e6 / 3}
    other = result_of(replace(one.run, identity=replace(IDENTITY, **rates)), one.seen)
    found = {each.what: (each.before, each.after) for each in difference_of(one, other).configuration}
    assert found == {"cclk hz": ("1,000,000", "500,000,000"), "sclk hz": ("200,000", "133,333,333.333333")}


def test_no_board_is_taken_for_one_with_two_cores() -> None:
    """A board with an ADSP-BF533 has one core, and its differences were those of `both cores`."""
    found = difference_of(run(kernel(line(12, 1, 10))), run(kernel(line(12, 1, 30))))
    told = "\n".join(printed(diff_report(found, 5))) + diff_markdown(found, 5)
    assert "of all cores" in told
    assert "both" not in told


def test_many_files_are_told_as_the_first_few_and_a_number() -> None:
    """On the screen and in a comment; the JSON has all."""
    files = tuple(f"far/{each}.py" for each in range(40))
    one = run(kernel(line(12, 1, 10)))
    other = result_of(replace(one.run, identity=replace(IDENTITY, firmware_files=files)), one.seen)
    found = difference_of(one, other)
    screen = " ".join(" ".join(printed(diff_report(found, top=5))).split())
    for text in (screen, diff_markdown(found, top=5)):
        assert "far/5.py and 34 others" in text
        assert "far/6.py" not in text
    assert "far/39.py" in diff_json(found)


def test_other_code_of_the_same_compiler_is_told_apart_from_edits() -> None:
    """Where one side was estimated; not where another compiler was asked for."""
    estimated = "estimated, for bfin-elf-gcc is not on the PATH"
    one = run(kernel(line(12, 1, 10)))
    compiled, guessed, asked = (
        result_of(replace(one.run, identity=replace(IDENTITY, code=words, compiler=compiler)), one.seen)
        for words, compiler in (("GCC 12.2.0", "gcc-adi"), (estimated, "gcc-adi"), ("", "gcc-O2"))
    )
    assert code(difference_of(compiled, guessed)).startswith(
        f"The code of the kernels went from 'GCC 12.2.0' to {estimated!r}, which makes a part of the difference"
    )
    assert code(difference_of(compiled, asked)) == ""
    assert code(difference_of(compiled, compiled)) == ""

"""Flame graphs: files of speedscope's own schema, whose stages are as wide as the rows of the budget."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest

from bfsim.report.viewers.speedscope import speedscope_json, stacks_of
from bfsim.run import simulate
from bfsim.trace import RunRecord, StallReason
from tests.report.records import edge_run

SCHEMA = json.loads((Path(__file__).parent / "speedscope" / "file-format-schema.json").read_text())
"""Of speedscope 1.25.0, under the licence beside it."""


@pytest.fixture(scope="module")
def run() -> RunRecord:
    """The built-in firmware on two frames."""
    return simulate(frames=2)


def test_a_file_is_of_the_schema(run: RunRecord) -> None:
    """Of speedscope's; and every frame that a sample names is there."""
    for each in (run, edge_run(3_000_000, 3_100_000)):
        content = json.loads(speedscope_json(each))
        jsonschema.validate(content, SCHEMA)
        count = len(content["shared"]["frames"])
        stacks = [stack for profile in content["profiles"] for stack in profile["samples"]]
        assert all(0 <= frame < count for stack in stacks for frame in stack)


def test_the_schema_refuses_what_is_wrong(run: RunRecord) -> None:
    """A sample of names instead of numbers."""
    content = json.loads(speedscope_json(run))
    content["profiles"][0]["samples"][0] = ["Edge detection"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(content, SCHEMA)


def test_each_stage_is_as_wide_as_its_row_of_the_budget(run: RunRecord) -> None:
    """To the cycle, stages within others at their place; every weight is above zero, and all of them are the frames."""
    content = json.loads(speedscope_json(run))
    within = {row.stage: row.within for row in run.rows if row.within}
    for number, core in enumerate(("A", "B")):
        stages: Counter[str] = Counter()
        for stack, cclk in stacks_of(run, core).items():
            assert cclk > 0
            stages[stack[1] if stack[1] in within else stack[0]] += cclk
        frames = [frame.cores[number] for frame in run.frames]
        budget = sum(
            (Counter({each.stage: each.elapsed_cclk for each in frame.stages}) for frame in frames), Counter()
        )
        assert stages == +budget
        profile = content["profiles"][number]
        total_cclk = sum(each.end_cclk - each.begin_cclk for each in frames)
        assert sum(profile["weights"]) == profile["endValue"] == total_cclk


def test_a_kernel_stands_in_the_one_that_called_it(run: RunRecord) -> None:
    """A callee is as wide as its calls by each caller cost, waits of a kernel are in it, by reason, and names are short."""
    content = json.loads(speedscope_json(run))
    names = [each["name"] for each in content["shared"]["frames"]]
    profile = content["profiles"][0]
    named = Counter()
    for stack, cclk in zip(profile["samples"], profile["weights"], strict=True):
        named[tuple(names[each] for each in stack)] += cclk
    callers = {stack[-2] for stack in named if stack[-1] == "isqrt32"}
    assert callers >= {"magnitude_row", "colour_row"}
    by_path = [each for each in run.paths if each.core == "A" and each.path[-1].endswith("isqrt32")]
    assert sum(cclk for stack, cclk in named.items() if stack[-1] == "isqrt32") == sum(
        each.issue_cclk for each in by_path
    )
    for reason in (StallReason.INTERLOCK, StallReason.L1_CONFLICT):
        assert named["Edge detection", "sobel_row", reason.value] > 0
    (square_root,) = [each for each in content["shared"]["frames"] if each["name"] == "isqrt32"]
    assert square_root["file"].endswith("arithmetic.py")


def test_names_of_any_kind_are_written() -> None:
    """Quotes, other scripts."""
    run = edge_run(3_000_000)
    named = replace(run, identity=replace(run.identity, recording='"größe".mcap'))
    assert json.loads(speedscope_json(named))["name"].endswith('"größe".mcap')

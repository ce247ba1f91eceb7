"""Flame graphs: files of speedscope's own schema, whose stages are as wide as the rows of the budget."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest

from bfsim.report.speedscope import speedscope_json, stacks_of
from bfsim.run import simulate
from bfsim.trace import RunRecord
from tests.report.records import edge_run

SCHEMA = json.loads((Path(__file__).parent / "speedscope" / "file-format-schema.json").read_text())
"""Of speedscope 1.25.0, under the licence beside it."""


@pytest.fixture(scope="module")
def run() -> RunRecord:
    """The built-in firmware on two frames, the slow placement for its stalls."""
    return simulate(frames=2, ldf=Path("sdram"))


def test_a_file_is_of_the_schema(run: RunRecord) -> None:
    """Of speedscope's; and every frame that a sample names is there."""
    for each in (run, edge_run(3_000_000, 3_100_000)):
        content = json.loads(speedscope_json(each))
        jsonschema.validate(content, SCHEMA)
        count = len(content["shared"]["frames"])
        assert all(
            0 <= frame < count
            for profile in content["profiles"]
            for stack in profile["samples"]
            for frame in stack
        )


def test_the_schema_refuses_what_is_wrong() -> None:
    """A sample of names instead of numbers."""
    content = json.loads(speedscope_json(edge_run(3_000_000, 3_100_000)))
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
            stage = stack[-2]
            assert stack[:-2] == ((within[stage],) if stage in within else ())
            assert cclk > 0
            stages[stage] += cclk
        frames = [frame.cores[number] for frame in run.frames]
        budget = sum(
            (Counter({each.stage: each.elapsed_cclk for each in frame.stages}) for frame in frames), Counter()
        )
        assert stages == +budget
        profile = content["profiles"][number]
        assert (
            sum(profile["weights"])
            == profile["endValue"]
            == sum(each.end_cclk - each.begin_cclk for each in frames)
        )


def test_names_of_any_kind_are_written() -> None:
    """Quotes, other scripts."""
    run = edge_run(3_000_000, 3_100_000)
    named = replace(run, identity=replace(run.identity, recording='"größe".mcap'))
    assert json.loads(speedscope_json(named))["name"].endswith('"größe".mcap')

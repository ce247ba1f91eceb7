"""The pytest plugin: a fixture `bfsim` that runs firmware, `@pytest.mark.frame_budget` that limits what a frame costs, and `bfsim_check`.

Nothing is imported until a test asks for the fixture.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from bfsim.report.check.judge import Outcome
    from bfsim.report.result_file import Result
    from bfsim.result import Run
    from bfsim.seen import SeenFrame

MARK = "frame_budget"

_RUNS = pytest.StashKey[dict[str, "Result"]]()


def pytest_configure(config: pytest.Config) -> None:
    """Tell of the marker."""
    config.addinivalue_line(
        "markers",
        f"{MARK}(*require, min_hz=None, stages={{}}): limits for the runs of the fixture `bfsim`: sentences of `bfsim check` "
        'such as "latency <= 200 ms", the least frame rate in Hz, and the most ms of stages in any frame',
    )
    config.stash[_RUNS] = {}


@pytest.fixture
def bfsim(request: pytest.FixtureRequest) -> Callable[..., Run]:
    """Return `bfsim.run.simulate`, which runs the same configuration once a session, and fails the test if a run breaks its `frame_budget`."""
    from bfsim.result import Run

    marks = list(request.node.iter_markers(MARK))
    required = [sentence for mark in marks for sentence in _sentences(*mark.args, **mark.kwargs)]

    def run(*recording: Any, **what: Any) -> Run:
        result = _once(request.config, *recording, **what)
        if broken := _broken(result, required):
            pytest.fail(broken, pytrace=False)
        assert isinstance(result.run, Run)
        return result.run

    return run


@pytest.fixture
def bfsim_check(request: pytest.FixtureRequest) -> Callable[..., dict[str, Run]]:
    """Return a function that does what `bfsim check` does: `bfsim_check("budget.toml", case=None)` fails the test if a run breaks its limits.

    The file lies beside the test. Returns the runs by their names: all of the file, or the one of that name.
    """
    from bfsim.checking import arguments_of, require_comparable
    from bfsim.report.check.baseline import read_baseline
    from bfsim.report.check.choice import chosen
    from bfsim.report.check.judge import judge
    from bfsim.report.check.tables import verdict_line
    from bfsim.result import Run

    def check(baseline: str = "budget.toml", case: str | None = None) -> dict[str, Run]:
        path = request.path.parent / baseline
        cases = chosen(read_baseline(path), path, None, case, "", update=False)
        for each in cases:
            require_comparable(each, path)
        results = {
            each.name: _once(request.config, **arguments_of(each.configuration, path.parent))
            for each in cases
        }
        outcomes = [judge(each, results[each.name], path) for each in cases]
        told = [f"{verdict_line(each)}\n{_told(each)}" for each in outcomes if not each.passed]
        if told:
            pytest.fail("\n\n".join(told), pytrace=False)
        return {name: each.run for name, each in results.items() if isinstance(each.run, Run)}

    return check


def _once(config: pytest.Config, *recording: Any, **what: Any) -> Result:
    """Run firmware, or return the run of the same configuration that this session has done."""
    from bfsim.errors import ConfigError

    runs = config.stash[_RUNS]
    key = f"{recording} {sorted(what.items(), key=lambda each: each[0])}"
    if key not in runs:
        runs[key] = _result(*recording, **what)
    if not runs[key].run.frames:
        raise ConfigError("a run must have at least one frame to hold against a budget")
    return runs[key]


def _result(*recording: Any, on_seen: Callable[[SeenFrame], None] | None = None, **what: Any) -> Result:
    """Run firmware, and note the names of what it sees."""
    from bfsim.report.result_file import result_of
    from bfsim.run import simulate

    seen: dict[int, dict[str, Any]] = {}

    def note(frame: SeenFrame) -> None:
        seen[frame.index] = {"objects": [asdict(each) for each in frame.objects]}
        if on_seen:
            on_seen(frame)

    return result_of(simulate(*recording, on_seen=note, **what), seen)


def _sentences(
    *require: str, min_hz: float | None = None, stages: Mapping[str, float] | None = None
) -> list[str]:
    """Return what a marker says as sentences of `bfsim check`."""
    rate = [f"frame_rate >= {min_hz:f} Hz"] if min_hz is not None else []
    return [*require, *rate, *(f'"{stage}".max <= {ms:f} ms' for stage, ms in (stages or {}).items())]


def _broken(result: Result, required: list[str]) -> str:
    """Return what a run breaks, and the kernels and lines that take most; nothing if it breaks nothing."""
    from bfsim.report.check.baseline import Case
    from bfsim.report.check.judge import judge

    case = Case(name=result.run.identity.firmware, require=required)
    return _told(judge(case, result, Path(f"@pytest.mark.{MARK}")))


def _told(outcome: Outcome) -> str:
    """Return what is broken, and why; nothing if nothing is."""
    from bfsim.report.check.cause import explanation
    from bfsim.report.check.outputs import broken_lines
    from bfsim.result import Run

    if outcome.passed:
        return ""
    assert isinstance(outcome.run, Run)
    return "\n".join([*broken_lines(outcome), "", *explanation(outcome), "", outcome.run.report()])

"""The pytest plugin: a fixture `bfsim` that runs firmware, and `@pytest.mark.frame_budget` that limits what a frame costs.

Nothing is imported until a test asks for the fixture.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
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
    from bfsim.errors import ConfigError
    from bfsim.result import Run

    marks = list(request.node.iter_markers(MARK))
    required = [sentence for mark in marks for sentence in _sentences(*mark.args, **mark.kwargs)]
    runs = request.config.stash[_RUNS]

    def run(*recording: Any, **what: Any) -> Run:
        key = f"{recording} {sorted(what.items(), key=lambda each: each[0])}"
        if key not in runs:
            runs[key] = _result(*recording, **what)
        done = runs[key].run
        assert isinstance(done, Run)
        if not done.frames:
            raise ConfigError("a run must have at least one frame to hold against a budget")
        if broken := _broken(runs[key], required):
            pytest.fail(broken, pytrace=False)
        return done

    return run


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
    from bfsim.report.check.cause import explanation
    from bfsim.report.check.judge import judge
    from bfsim.report.check.outputs import broken_lines
    from bfsim.result import Run

    name, run = result.run.identity.firmware, result.run
    outcome = judge(Case(name=name, require=required), result, Path(f"@pytest.mark.{MARK}"))
    if outcome.passed:
        return ""
    assert isinstance(run, Run)
    return "\n".join([*broken_lines(outcome), "", *explanation(outcome), "", run.report()])

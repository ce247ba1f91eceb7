"""`--update`: measured values become the limits of a run; a limit that was missed within its tolerance stays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import tomlkit
from tomlkit.items import AoT, Table

from bfsim.files.save import alone_in, write_text
from bfsim.report.check.baseline import COMPARABLE, Case, MeasuredOn, measured_on
from bfsim.report.check.baseline_file import parsed, requirements_of, validated
from bfsim.report.check.figures import COUNTS, MISSED, SEEN, STATISTICS, Name, Unit, figures_of, statistic
from bfsim.report.check.judge import judge
from bfsim.report.check.kept import kept_costs, whole_side
from bfsim.report.check.requirement import Requirement, counts_text, limit_text
from bfsim.report.check.toml_items import toml_item
from bfsim.report.check.verdicts import Outcome, Verdict, worst_of_each
from bfsim.report.results.result import Result
from bfsim.trace import RunRecord

NEW_FILE = """\
# What `bfsim check` holds every run against; `bfsim check --help` says how to use it.
# Yours: name, what to run, tolerances, comments, and `require`, such as
#     require = ["frame_rate >= 15 Hz", '"Look for lines".max <= 80 ms', "memory.L2 <= 90 %", "results.balls >= 1"]
#     require = ["objects.ball == 1", "distance_mm.ball <= 900", "results.lines_A.min >= 20"]
# Written by `--update`: limits; measured_on; and costs, which explain what grew, and limit nothing.

"""
DEFAULT_TOLERANCE_PERCENT = 1
"""For new runs: each change of one stage moves others a little, because they wait for memory differently."""
MOST_COUNTS = 22
"""Results are kept frame by frame if their sentence has at most so many words, 20 of them counts such as 1*200.

Otherwise their total, least and most are kept.
"""


def loosened(case: Case, result: Result, path: Path, *, in_short: bool = False) -> list[str]:
    """Return in words which limits of a run `--update` would loosen or remove.

    With `in_short`, only one of the limits on each figure, results first.
    """
    _, gone = _limits_of(case, result, path)
    broken = [each for each in _held(case, result, path).verdicts if each.broken and not each.is_persons]
    if in_short:
        broken = sorted(worst_of_each(broken), key=lambda each: each.requirement.name[0] not in COUNTS)
    return [
        *(f"{each.requirement.text}, measured {_number(each, result.run)}" for each in broken),
        *(f"{each.text}, which the run has no more" for each in gone),
    ]


def updated(case: Case, result: Result, reason: str, path: Path) -> Case:
    """Return a run of the file with the measured limits. A `reason` is kept with the limits that were loosened."""
    outcome = _held(case, result, path)
    kept = {
        (each.requirement.name, each.requirement.statistic): each.requirement.text
        for each in outcome.verdicts
        if not each.is_persons and not each.broken and not each.better
    }
    loose = loosened(case, result, path)
    values = {
        "limits": [kept.get(key, text) for key, text in _limits(outcome)],
        "loosened": [*case.loosened, *([f"{reason}: {'; '.join(loose)}"] if loose else [])],
        "measured_on": _on(result.run),
        "costs": kept_costs(whole_side(result)),
    }
    return case.model_copy(update=values)


def write_cases(path: Path, cases: Mapping[str, Case]) -> None:
    """Write runs, by their names, into the file at `path`.

    Everything else in it stays as it is, including what others write meanwhile.

    Raises ConfigError, and leaves the file alone, if it is no baseline.
    """
    with alone_in(path.parent):
        _write_cases(path, cases)


def _write_cases(path: Path, cases: Mapping[str, Case]) -> None:
    document = parsed(path) if path.exists() else tomlkit.parse(NEW_FILE)
    before = {each.name: each for each in validated(document, path).run}
    is_of_windows = tomlkit.dumps(document).partition("\n")[0].endswith("\r")
    tables = document.setdefault("run", tomlkit.aot())
    assert isinstance(tables, AoT)
    for name, case in cases.items():
        table = next((each for each in tables if each["name"] == name), None)
        if table is None:
            table = tomlkit.table()
            tables.append(table)
            table = tables[-1]
        _fill(table, case, before.get(name))
    text = tomlkit.dumps(document).replace("\r\n", "\n")
    validated(tomlkit.parse(text), path)
    write_text(path, text.replace("\n", "\r\n") if is_of_windows else text)


def _held(case: Case, result: Result, path: Path) -> Outcome:
    """Compare a run with those of its limits that apply to it."""
    there, _ = _limits_of(case, result, path)
    return judge(case.model_copy(update={"limits": [each.text for each in there]}), result, path)


def _limits_of(case: Case, result: Result, path: Path) -> tuple[list[Requirement], list[Requirement]]:
    """Return the limits for the same pictures and hardware: those on figures that the run has, and those on others."""
    then, now, figures = case.measured_on, _on(result.run), figures_of(result)
    if then is None or any(then.differs_in(key, now) for key in COMPARABLE):
        return [], []
    there: list[Requirement] = []
    gone: list[Requirement] = []
    for each in requirements_of(case, path)[1]:
        has_it = each.name in figures or (result.seen and each.name[0] in SEEN)
        (there if has_it else gone).append(each)
    return there, gone


def _on(run: RunRecord) -> MeasuredOn:
    return measured_on(run.identity, len(run.frames) + len(run.missed))


def _limits(outcome: Outcome) -> Iterator[tuple[tuple[Name, str], str]]:
    """Yield a sentence for each limit: stages by core, and for times the median and the maximum."""
    cclk_hz = outcome.run.identity.cclk_hz
    for name, figure in outcome.figures.items():
        is_of_all_cores = any(
            len(each) > 1 and each[0] == name[0] for each in outcome.figures if each != name
        )
        is_nothing = not any(figure.values) and name != MISSED and name[0] not in COUNTS
        if is_nothing or (len(name) == 1 and is_of_all_cores):
            continue
        if name[0] in COUNTS and len(counts_text(name, figure.values).split()) <= MOST_COUNTS:
            yield (name, ""), counts_text(name, figure.values)
        elif name[0] in COUNTS:
            for each in STATISTICS:
                if each != "median":
                    yield (name, each), limit_text(name, statistic(figure, each), cclk_hz, each)
        elif len(figure.values) == 1 and figure.unit is not Unit.CCLK:
            yield (name, ""), limit_text(name, figure.values[0], cclk_hz)
        else:
            for each in ("median", "max"):
                yield (name, each), limit_text(name, statistic(figure, each), cclk_hz, each)


def _number(verdict: Verdict, run: RunRecord) -> str:
    """Return what was measured as a sentence would have it."""
    return limit_text(verdict.requirement.name, verdict.measured, run.identity.cclk_hz).rpartition("= ")[2]


def _fill(table: Table, case: Case, before: Case | None) -> None:
    """Write a run into a TOML table, without defaults; values that are as `before` stay as they are written."""
    plain, old = case.model_dump(exclude_defaults=True), before.model_dump() if before else {}
    for key in ("name", *Case.model_fields):
        if key not in plain:
            if key in table:
                del table[key]
        elif key not in table or old.get(key) != plain[key]:
            table[key] = toml_item(plain[key])

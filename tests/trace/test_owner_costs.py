"""Costs of owners as tables: what they come to together, and frame by frame."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from bfsim.report.budget.owners import owner_frames
from bfsim.report.budget.waits import waiting_cclk
from bfsim.trace import OwnerCost, StallReason
from bfsim.trace.owner_costs import OwnerCosts, sum_of_owners
from tests.report.records import core_frame, frame, run_of

NUMBERS = st.integers(0, 5)
COSTS = st.lists(
    st.builds(
        lambda stage, owner, calls, issue, idle, stalls: OwnerCost(
            stage=stage, owner=owner, symbol=owner.upper(), calls=calls, issue_cclk=issue, idle_cclk=idle,
            stall_cclk=dict(sorted(stalls.items())),
        ),
        st.sampled_from(["Edges", "Lines"]), st.sampled_from("ab"), st.integers(1, 5), NUMBERS, NUMBERS,
        st.dictionaries(st.sampled_from([StallReason.SEMAPHORE, StallReason.INTERLOCK]), st.integers(1, 5)),
    ),
    unique_by=lambda each: (each.stage, each.owner),
)  # fmt: skip


@given(COSTS)
def test_costs_are_kept_as_a_table(costs: list[OwnerCost]) -> None:
    """Each comes back, in order; what is a table already is left as it is."""
    table = OwnerCosts.of(costs)
    assert list(table) == costs
    assert OwnerCosts.of(table) is table


@given(st.lists(COSTS, max_size=4))
def test_costs_of_frames_add_up(frames: list[list[OwnerCost]]) -> None:
    """By owner and stage, in the order in which they come."""
    sums: dict[tuple[str, str], Counter[object]] = {}
    for each in (cost for costs in frames for cost in costs):
        numbers = {"calls": each.calls, "issue": each.issue_cclk, "idle": each.idle_cclk, **each.stall_cclk}
        sums.setdefault((each.stage, each.owner), Counter()).update(numbers)
    found = {
        (each.stage, each.owner): +Counter[object](
            {"calls": each.calls, "issue": each.issue_cclk, "idle": each.idle_cclk, **each.stall_cclk}
        )
        for each in sum_of_owners(frames)
    }
    assert list(found.items()) == [(key, +numbers) for key, numbers in sums.items()]


@given(st.lists(st.tuples(COSTS, COSTS), min_size=1, max_size=4))
def test_each_owner_has_a_number_for_each_frame(
    frames: list[tuple[list[OwnerCost], list[OwnerCost]]],
) -> None:
    """Of calls, cycles and waits; owners come as in the first frame that has them, core by core."""
    run = run_of(
        [
            frame(
                index,
                *(
                    replace(core_frame(name, 0), owners=costs)
                    for name, costs in zip("AB", cores, strict=True)
                ),
            )
            for index, cores in enumerate(frames)
        ]
    )
    expected: dict[tuple[str, str, str], list[tuple[int, int, int]]] = {}
    for index, cores in enumerate(frames):
        for name, costs in zip("AB", cores, strict=True):
            for each in costs:
                row = expected.setdefault((name, each.stage, each.owner), [(0, 0, 0)] * len(frames))
                row[index] = each.calls, each.elapsed_cclk, waiting_cclk(each)
    found = [
        (
            (each.core, each.stage, each.owner),
            list(zip(each.calls, each.elapsed_cclk, each.waiting_cclk, strict=True)),
        )
        for each in owner_frames(run)
    ]
    assert found == list(expected.items())

"""The digests: blind to what does not matter, awake to every cycle."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.trace import REST, StallReason
from tests.report.records import IDENTITY, core_frame, cost, edge_run, frame


def test_cycle_digest_is_fixed() -> None:
    """The digest of a known run is a known number: in another process, on another day."""
    known = "cf5235448b04176985579b1ee16f26ffb6fd68c00fd615f779545883fb8b5a85"
    assert cycle_digest(edge_run(100, 120).frames) == known


def test_cycle_digest_ignores_the_order_in_which_stalls_were_met() -> None:
    """Stalls are a mapping: their order, and its kind, are no cycles."""
    stalls = {StallReason.RING_EMPTY: 3, StallReason.SEMAPHORE: 4}
    turned = MappingProxyType(dict(reversed(stalls.items())))
    one, other = (frame(0, core_frame("A", 0, cost(REST, 9, each))) for each in (stalls, turned))
    assert cycle_digest([one]) == cycle_digest([other])


def test_cycle_digest_sees_a_stall_change_its_reason() -> None:
    """The same total for another reason is another cycle vector."""
    reasons = (StallReason.RING_EMPTY, StallReason.RING_FULL)
    one, other = (frame(0, core_frame("A", 0, cost(REST, 9, {each: 1}))) for each in reasons)
    assert cycle_digest([one]) != cycle_digest([other])


def test_cycle_digest_leaves_published_results_out() -> None:
    """What the robot saw is not what it cost."""
    (before,) = edge_run(100).frames
    assert cycle_digest([before]) == cycle_digest([replace(before, results={"edges": 7})])


def test_identity_digest_sees_every_field() -> None:
    """Another value in any field is another identity."""
    tuples = ("board_files", "compiler_files", "board_numbers", "compiler_numbers")
    others = {
        **dict.fromkeys(tuples, ("mine",)),
        "compiler_digest": "6" * 64,
        "code": "GCC",
        "code_digest": "7" * 64,
        "file_compiler": "GCC 12.2.0",
    }
    changed = [
        replace(IDENTITY, **{name: others.get(name) or getattr(IDENTITY, name) * 2})
        for name in IDENTITY.__dataclass_fields__
    ]
    digests = {identity_digest(each) for each in (IDENTITY, *changed)}
    assert len(digests) == len(changed) + 1

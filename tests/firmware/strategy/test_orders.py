"""What both cores do with orders over SPI."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bfsim.api import FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link
from bfsim.machine.board import Board
from bfsim.machine.symbols import symbols_of
from bfsim.trace import BoardRecord
from tests.firmware.whole_pictures import buffer, random_frames
from tests.machine.rig import thesis_ldf
from tinyphoon import tinyphoon
from tinyphoon.fields import to_words
from tinyphoon.strategy import order_checks as checks
from tinyphoon.strategy.models import MODEL_CAPACITY, MODEL_WORDS, MODELS
from tinyphoon.strategy_unit.decoding import decode_results
from tinyphoon.strategy_unit.unit import StrategyUnit

Entry = dict[str, Any]


def run(script: Sequence[Entry], frames: int) -> tuple[StrategyUnit, Board, BoardRecord]:
    """Play noise of 64x48 to the firmware while the strategy unit sends the entries of a script."""
    size = FrameSize(64, 48)
    link_map = link(thesis_ldf(), symbols_of(tinyphoon, size), CM_BF561.chip.regions)
    unit = StrategyUnit({"send": list(script)})
    board = Board(CM_BF561, tinyphoon, size, link_map, devices={"SPI": unit})
    return unit, board, board.run(iter(random_frames(64, 48, frames)))


def mode(after_frames: int, names: object) -> Entry:
    """A mode of a script."""
    return {"after_frames": after_frames, "mode": names}


def test_a_bad_order_is_counted_and_told_and_the_last_good_mode_stays() -> None:
    """The frames go on as if it had not come."""
    good, bad = (
        mode(0, {"edges": {"strong_threshold": 60}}),
        mode(1, {"edges": {"edge_threshold": 61, "strong_threshold": 60}}),
    )
    _, _, alone = run([good], 4)
    unit, _, outcome = run([good, bad, {"after_frames": 1, "bytes": [0x78, 0x78]}], 4)
    counted = [(each.results["orders_taken_A"], each.results["orders_refused_A"]) for each in outcome.frames]
    assert counted == [(1, 0), (0, 2), (0, 0), (0, 0)]
    assert [each.remarks for each in outcome.frames] == [
        (),
        (
            "core A refused MODE 1: edges.edge_threshold must be at most edges.strong_threshold, which is 60, not 61",
            "core A refused a message: it must have 10 bytes at least, but is cut short after 2",
        ),
        (),
        (),
    ]
    for one, other in zip(outcome.frames, alone.frames, strict=True):
        for name in ("edges_A", "edges_B", "lines_A", "blobs_B"):
            assert one.results[name] == other.results[name]
    told = [decode_results(each.message.payload).refusal for each in unit.received]
    assert told == [0, checks.CUT_SHORT, 0, 0], "the reason of the last one"


def test_what_waits_at_the_start_holds_from_the_first_frame_on() -> None:
    """For both cores; a bad order too is counted and told with the first frame, once."""
    strong = {"edges": {"edge_threshold": 100, "strong_threshold": 200}}
    _, _, plain = run([], 2)
    unit, _, outcome = run([{"mode": strong}, mode(0, {"edges": {"gauss_px": 4}})], 2)
    for core in "AB":
        for whole, thresholded in zip(plain.frames, outcome.frames, strict=True):
            assert thresholded.results[f"edges_{core}"] < whole.results[f"edges_{core}"] / 2
    counted = [(each.results["orders_taken_A"], each.results["orders_refused_A"]) for each in outcome.frames]
    assert counted == [(1, 1), (0, 0)]
    assert [len(each.remarks) for each in outcome.frames] == [1, 0]
    assert [decode_results(each.message.payload).refusal & 0xFF for each in unit.received] == [
        checks.RANGE,
        0,
    ]


def test_both_cores_obey_from_the_next_frame_on() -> None:
    """Not in the frame in which the mode comes; and until another one comes."""
    strong = {"edges": {"edge_threshold": 100, "strong_threshold": 200}}
    _, _, plain = run([], 4)
    _, _, outcome = run([mode(1, strong), mode(2, {})], 4)
    for core in "AB":
        before, after = (
            [each.results[f"edges_{core}"] for each in frames.frames] for frames in (plain, outcome)
        )
        assert after[:2] == before[:2]
        assert after[2] < before[2]
        assert after[3] == before[3]


def test_models_reach_both_cores() -> None:
    """Their colours are those that blobs are made of; a table that contradicts itself changes nothing."""
    script = [
        {"after_frames": 0, "models": ["robot marker"]},
        {"after_frames": 1, "models": ["ball", "ball"]},
    ]
    _, board, outcome = run(script, 3)
    expected = np.zeros(MODEL_CAPACITY * MODEL_WORDS, np.int32)
    words = to_words(MODELS[3])
    expected[: len(words)] = words
    for core in "AB":
        np.testing.assert_array_equal(buffer(board, core, "models")[0], expected)
        assert buffer(board, core, "colour_groups")[0, 0] == MODELS[3].colours
    assert outcome.frames[1].remarks == (
        "core A refused MODELS 1: model 1 must have a number of its own, not that of one before it",
    )


def test_orders_cost_cycles() -> None:
    """Copying them every frame little, checking one that comes more; all outside of the stages."""
    _, _, outcome = run([mode(1, {})], 4)
    checked = [each for each in outcome.kernels if each.kernel in ("words_refusal", "checksum", "copy_order")]
    assert {(each.core, each.kernel) for each in checked} == {
        ("A", "copy_order"), ("B", "copy_order"), ("A", "words_refusal"), ("A", "checksum"),
    }  # fmt: skip
    copies = [each for each in checked if each.kernel == "copy_order" and each.stage == "(the rest)"]
    assert {each.core for each in copies} == {"A", "B"}
    assert all(0 < each.issue_cclk < 4 * 3000 for each in copies)

"""What was seen in the JSON of a run."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from bfsim.report.results.as_json import json_chunks
from bfsim.report.results.seen_json import SeenStore, seen_json
from tests import seen_frames as made
from tests.report.records import edge_run


def test_objects_and_what_is_in_space_are_always_there() -> None:
    """With the time stamps of the pictures; nothing of the pictures themselves."""
    plain = seen_json(made.frame(), with_features=False)
    assert plain == json.loads(json.dumps(plain))
    assert plain["times_ns"] == {"left": 500_000_000, "right": 502_000_000}
    assert [each["name"] for each in plain["objects"]] == ["ball", "blue goal", "robot marker"]
    assert plain["objects"][0]["place_mm"] == [30.0, 40.0, 1200.0]
    assert plain["objects"][0]["solid"] == "sphere"
    assert plain["lines_3d"] == [
        {"start_mm": [0, 0, 300], "end_mm": [100, 50, 500], "left_line": 1, "right_line": 0}
    ]
    assert plain["edges_3d_mm"] == [[10, 20, 300], [-10, 5, 1500]]
    assert "cameras" not in plain


def test_features_of_the_pictures_come_when_asked_for() -> None:
    """By camera: edges as arrays, the others as records."""
    cameras = seen_json(made.frame(), with_features=True)["cameras"]
    left, right = cameras["left"], cameras["right"]
    assert left["edges"] == {
        "x_px": [5, 6, 7],
        "y_px": [50, 50, 51],
        "gradients": [255, 40, 96],
        "directions": [0, 64, 128],
        "lost": 0,
    }
    assert left["blobs"][0]["centre_px"] == [39.5, 29.5]
    assert left["lines"][1]["end_px"] == [40.0, 5.0]
    assert left["circles"][0]["tests"] == ["centre", "radius"]
    assert (right["width_px"], right["height_px"], right["lines"]) == (80, 60, [])


def test_places_in_an_area_count_in_the_whole_picture() -> None:
    """Points, columns and rows; sizes and what is in space stay as they are."""
    whole = made.frame()
    left, right = (replace(each, corner_px=(20, 10)) for each in whole.cameras)
    plain, shifted = (
        seen_json(each, with_features=True) for each in (whole, replace(whole, cameras=(left, right)))
    )
    for one, other in zip(plain["objects"], shifted["objects"], strict=True):
        assert np.subtract(other["image_px"], one["image_px"]).tolist() == [20, 10]
        assert (other["image_size_px"], other["place_mm"]) == (one["image_size_px"], one["place_mm"])
    before, after = plain["cameras"]["left"], shifted["cameras"]["left"]
    assert after["corner_px"] == [20, 10]
    assert np.subtract(after["edges"]["x_px"], before["edges"]["x_px"]).tolist() == [20, 20, 20]
    assert np.subtract(after["edges"]["y_px"], before["edges"]["y_px"]).tolist() == [10, 10, 10]
    sides = "left_px", "right_px", "top_px", "bottom_px"
    moved = [after["blobs"][0][side] - before["blobs"][0][side] for side in sides]
    assert moved == [20, 20, 10, 10]
    assert np.subtract(after["lines"][0]["start_px"], before["lines"][0]["start_px"]).tolist() == [20, 10]
    assert after["circles"][0]["radius_px"] == before["circles"][0]["radius_px"]


def test_each_frame_has_its_own() -> None:
    """By its number in the recording; without anything seen nothing is added."""
    run = edge_run(100, 200)
    text = "".join(json_chunks(run, {1: seen_json(made.frame(1), with_features=False)}))
    frames = json.loads(text)["frames"]
    assert "seen" not in frames[0]
    assert frames[1]["seen"]["edges_3d_mm"][1] == [-10, 5, 1500]
    assert "[-10, 5, 1500]" in text  # a line each, not a line a number
    assert list(json_chunks(run)) == list(json_chunks(run, {}))


def test_a_store_keeps_each_frame_outside_of_memory() -> None:
    """What comes out is what `seen_json` made."""
    with SeenStore(with_features=True) as store:
        store.add(made.frame(1))
        assert dict(store) == {1: seen_json(made.frame(1), with_features=True)}

"""The store: results are kept whole or not at all, and belong to what they are of."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.errors import ConfigError
from bfsim.sweeping.running import Outcome
from bfsim.sweeping.store import Store, key_of
from tests.report.records import IDENTITY

OUTCOME = Outcome(
    identity=IDENTITY,
    frames=3,
    seconds=0.5,
    figures={"frame_rate Hz": 15.25, "missed": 0},
    warnings=("clocks: none",),
)
KEY = key_of(IDENTITY, "code")
CLAIM = """
import sys; from pathlib import Path; from bfsim.sweeping.store import Store
store = Store(Path(sys.argv[1])); store.open(); print(store.claim(sys.argv[2]), flush=True); sys.stdin.read()
"""


@pytest.fixture
def store(tmp_path: Path) -> Store:
    """An empty one."""
    store = Store(tmp_path / "a" / "store")
    store.open()
    return store


def test_what_is_kept_is_found_again(store: Store) -> None:
    """With all that was known of it; a failure too."""
    failure = Outcome(error="nothing fits", seconds=1)
    store.keep(KEY, OUTCOME)
    store.keep("ab" * 32, failure)
    assert Store(store.folder).outcome(KEY) == OUTCOME
    assert store.outcome("ab" * 32) == failure
    assert store.outcome("cd" * 32) is None
    assert type(store.outcome(KEY).figures["missed"]) is int  # type: ignore[union-attr]


@pytest.mark.parametrize("damaged", ["", "{", "[" * 100_000, "[]", "null", '{"schema": 1}', "\udcff"])
def test_a_damaged_file_is_as_if_it_were_not_there(store: Store, damaged: str) -> None:
    """Nothing in it is believed, and it is written anew."""
    store.keep(KEY, OUTCOME)
    (file,) = (store.folder / "points").rglob("*.json")
    file.write_bytes(damaged.encode(errors="surrogateescape"))
    assert store.outcome(KEY) is None
    store.keep(KEY, OUTCOME)
    assert store.outcome(KEY) == OUTCOME


def test_a_file_under_another_name_is_not_believed(store: Store) -> None:
    """Nor one whose figures are none, or others."""
    store.keep(KEY, OUTCOME)
    (file,) = (store.folder / "points").rglob("*.json")
    other = file.with_name("ab" * 32 + ".json")
    other.parent.with_name("ab").mkdir()
    other = file.rename(other.parent.with_name("ab") / other.name)
    assert store.outcome("ab" * 32) is None
    for changed in ('"fast"', "15.75"):
        store.keep(KEY, OUTCOME)
        file.write_text(file.read_text().replace("15.25", changed))
        assert store.outcome(KEY) is None


def test_keys_differ_where_anything_does() -> None:
    """Of the identity, or of bfsim's code."""
    others = [replace(IDENTITY, recording_digest="9" * 64), replace(IDENTITY, feed="cameras")]
    keys = {KEY, key_of(IDENTITY, "other code"), *(key_of(each, "code") for each in others)}
    assert len(keys) == 4


def test_another_process_that_has_a_point_keeps_it_until_it_dies(store: Store) -> None:
    """However it dies; other points are free."""
    command = [sys.executable, "-c", CLAIM, str(store.folder), KEY]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout and other.stdout.readline() == "True\n"
        assert not store.claim(KEY)
        assert store.claim("ab" * 32)
        other.kill()
        other.wait()
        assert store.claim(KEY)
    store.release(KEY)


def test_the_digest_of_a_recording_holds_while_the_file_is_the_same(store: Store, tmp_path: Path) -> None:
    """For as many frames; not after it was written again, to the same size."""
    file = tmp_path / "drive.mcap"
    file.write_bytes(b"abc")
    store.keep_recording_digest(file, 2, "d")
    assert store.recording_digest(file, 2) == "d"
    assert not store.recording_digest(file, 3)
    file.write_bytes(b"abd")
    os.utime(file, ns=(0, 0))
    assert not store.recording_digest(file, 2)
    assert not store.recording_digest(tmp_path / "no.mcap", 2)


def test_a_folder_that_cannot_be(tmp_path: Path) -> None:
    """Because a file is in its place."""
    (tmp_path / "store").touch()
    with pytest.raises(
        ConfigError, match="must be writable: File exists; --store DIR keeps results elsewhere"
    ):
        Store(tmp_path / "store").open()

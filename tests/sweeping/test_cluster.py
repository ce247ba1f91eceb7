"""A sweep on a Dask cluster of this machine, one process of which is killed; skipped where Dask is not installed."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

from bfsim.errors import ConfigError
from bfsim.sweeping import running
from bfsim.sweeping.cluster import Cluster
from tests.eyes import FIRMWARE
from tests.sweeping.rig import BASE, Forgetful, home_in, planned, swept

pytestmark = pytest.mark.exhaustive

distributed = pytest.importorskip("distributed")

DIES_ONCE = FIRMWARE.replace(
    "def main(core):\n",
    """\
def main(core):
    import os, signal
    from pathlib import Path
    if not Path(__file__).with_name("killed").exists():
        Path(__file__).with_name("killed").touch()
        os.kill(os.getpid(), signal.SIGKILL)
""",
)

NOTES_RUNS = FIRMWARE.replace(
    "def main(core):\n",
    """\
def main(core):
    from pathlib import Path
    if core.name == "A":
        with Path(__file__).with_name("runs").open("a") as runs:
            runs.write("A")
""",
)


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """A scheduler with two worker processes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the cluster's own
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
        ) as cluster:
            yield cluster.scheduler_address


def test_a_worker_that_is_killed_takes_nothing_along(address: str, tmp_path: Path) -> None:
    """Its point goes to another one; all figures are those of a sweep without a cluster."""
    file = home_in(tmp_path / "cluster", f"{BASE}[axes]\nframes = [1, 2]\nset.sdram.nRP = [2, 3, 4]\n")
    file.with_name("fw_eyes.py").write_text(DIES_ONCE)
    sweep = planned(file)
    with Cluster(address, running.code_digest()) as cluster:
        assert cluster.room() == 4
        sweep.run(cluster, lambda _point, _outcome: None)
    assert file.with_name("killed").exists()
    assert not any(map(sweep.error_of, sweep.planned))
    again, ran = swept(file)
    assert ran == []
    alone, _ = swept(home_in(tmp_path / "alone", file.read_text()))
    assert [each.figures for each in again.values()] == [each.figures for each in alone.values()]


def test_one_worker_records_and_the_others_play(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was recorded there is sent to all, its figures are those of runs, and nothing of it stays behind."""
    axes = "[axes]\nset.sdram.nRP = [2, 3, 4, 5, 6, 7]\n"
    file = home_in(tmp_path / "cluster", BASE + axes)
    file.with_name("fw_eyes.py").write_text(NOTES_RUNS)
    with Cluster(address, running.code_digest()) as cluster:
        monkeypatch.setattr(cluster, "room", lambda: 1)  # else all run at once
        played, _ = swept(file, cluster)
    assert file.with_name("runs").read_text() == "A" * 2  # the first one, and the one that was recorded
    assert not list((file.with_suffix(".sweep") / "works").iterdir())
    alone, _ = swept(home_in(tmp_path / "alone", BASE + axes), Forgetful())
    assert {name: each.figures for name, each in played.items()} == {
        name: each.figures for name, each in alone.items()
    }


def test_a_worker_with_another_bfsim_is_refused(address: str) -> None:
    """At once, and by its own check if it comes later."""
    with pytest.raises(ConfigError, match="must have the same bfsim as this machine, but tcp:"):
        Cluster(address, "another")
    outcome = running.run_point(None, Path(), "another")  # type: ignore[arg-type]
    assert "must have the same bfsim" in outcome.error
    assert not outcome.is_final


def test_a_worker_that_dies_while_it_is_asked_for_its_bfsim(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It may go, as later; what it does not have is another bfsim."""
    killed = tmp_path / "killed"

    def dies_once() -> str:
        import os
        import signal

        try:
            killed.touch(exist_ok=False)
        except FileExistsError:
            return "mine"
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError

    monkeypatch.setattr("bfsim.sweeping.cluster.code_digest", dies_once)
    with Cluster(address, "mine"):
        assert killed.exists()


def test_a_worker_without_bfsim_is_refused(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With what it says."""

    def missing() -> str:
        raise ModuleNotFoundError("No module named 'bfsim'")

    monkeypatch.setattr("bfsim.sweeping.cluster.code_digest", missing)
    with pytest.raises(
        ConfigError, match="this bfsim installed: ModuleNotFoundError: No module named 'bfsim'"
    ):
        Cluster(address, "mine")


@pytest.mark.parametrize("address", ["nowhere", "tcp://127.0.0.1:1", "tcp://", ""])
def test_an_address_without_a_scheduler(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a sentence."""
    monkeypatch.setattr("bfsim.sweeping.cluster.CONNECT_S", 0.2)
    with pytest.raises(ConfigError, match="--scheduler must be the address of a Dask scheduler that answers"):
        Cluster(address, "")

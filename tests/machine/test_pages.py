"""What memory straight from the system takes, by the state of the buses, most of which nobody touches."""

from pathlib import Path

from bfsim.machine.bus import state as w
from bfsim.machine.pages import zeros


def resident_pages() -> int:
    """Return how many pages this process has from the system."""
    return int(Path("/proc/self/statm").read_text().split()[1])


def test_only_what_is_touched_of_a_state_takes_memory() -> None:
    before = resident_pages()
    states = [zeros(w.STATE_WORDS) for _ in range(4)]
    for each in states:
        each[:: w.STATE_WORDS // 10] = 1
    assert resident_pages() - before < 256  # of 4 kB, of 1.5 GB

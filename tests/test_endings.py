"""How commands end: exit codes by cause, and nothing left behind."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bfsim.process import signals
from bfsim.process.endings import FAULT
from tests.tiers import exhaustive

# a run that is in the midst of a drawing when the signal comes, however late that is
SLOW = """
import os, signal, time
import bfsim.report.overlay.files as files

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nohup ignores it

drawn = files.overlay_of

def slowly(*frame, **how):
    open("drawing", "w").close()
    while not os.path.exists("signalled"):
        time.sleep(0.01)
    return drawn(*frame, **how)

files.overlay_of = slowly
from bfsim.__main__ import main
main()
"""

TALKING = """
from dataclasses import replace
from tinyphoon import tinyphoon

def main(core):
    while (frame := (yield from core.next_frame())) is not None:
        for number in range(10_000):
            print(core.name, "has", number, flush=True)

firmware = replace(tinyphoon, mains={"A": main, "B": main})
"""

TIDY = """
import contextlib, io, sys
from dataclasses import replace
from tinyphoon import tinyphoon

def closes(core):
    while (frame := (yield from core.next_frame())) is not None:
        sys.stdout.close(), sys.stderr.close()

def clears(core):
    while (frame := (yield from core.next_frame())) is not None:
        sys.stdout = None

def redirects(core):
    with contextlib.redirect_stdout(io.StringIO()):
        while (frame := (yield from core.next_frame())) is not None:
            print(core.name)

closing, clearing, redirecting = (replace(tinyphoon, mains={"A": each, "B": each}) for each in (closes, clears, redirects))
"""


def bfsim(command: str, *, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a line of shell in which "$BFSIM" is the command."""
    surroundings = {**os.environ, "BFSIM": f"{sys.executable} -m bfsim"}
    return subprocess.run(
        ["bash", "-c", command], env=surroundings, capture_output=True, check=False, text=True, cwd=cwd
    )


@pytest.mark.parametrize("command", ["boards", "--help", "run --help", "--version"])
def test_a_closed_pipe_is_no_broken_limit(command: str) -> None:
    """Who stops to read ends the command as a signal would, in silence."""
    done = bfsim(f"$BFSIM {command} | true; exit ${{PIPESTATUS[0]}}")
    assert (done.returncode, done.stderr) == (141, "")


def test_a_closed_pipe_is_no_mistake_of_firmware_that_prints(tmp_path: Path) -> None:
    """It was told that the firmware failed with an error of bfsim's own."""
    (tmp_path / "talking.py").write_text(TALKING)
    command = "run --firmware talking.py:firmware --frames 1"
    done = bfsim(f"$BFSIM {command} | true; exit ${{PIPESTATUS[0]}}", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize("firmware", ["closing", "clearing", "redirecting"])
def test_firmware_takes_no_output_from_the_report(firmware: str, tmp_path: Path) -> None:
    """A closed one was a fault of bfsim, and where both cores redirected it the report was lost without a word."""
    (tmp_path / "tidy.py").write_text(TIDY)
    done = bfsim(f"$BFSIM run --firmware tidy.py:{firmware} --frames 1", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "frames/s" in done.stdout


@pytest.mark.parametrize("command", ["--help", "boards --help", "--version", "boards"])
def test_a_full_device(command: str) -> None:
    """Help is output as any other."""
    done = bfsim(f"$BFSIM {command} > /dev/full")
    assert done.returncode == 2
    assert done.stderr == "bfsim: error: standard output must be accessible: No space left on device\n"


def test_q_in_the_debugger_ends_quietly(tmp_path: Path) -> None:
    """It was told as a failure of the firmware, `BdbQuit: `."""
    (tmp_path / "stopping.py").write_text("breakpoint()\nfirmware = None\n")
    done = bfsim("echo q | $BFSIM run --firmware stopping.py", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (130, "bfsim: ended by the debugger\n")


def test_a_full_device_for_the_message() -> None:
    """Nobody can be told, but the exit code says it."""
    assert bfsim("$BFSIM fly 2> /dev/full").returncode == 2


def test_trouble_elsewhere_is_not_blamed_on_standard_output(tmp_path: Path) -> None:
    """What the system refuses without a file's name is not standard output."""
    program = "import bfsim.cli.main, errno; from unittest.mock import patch\n"
    program += "with patch('bfsim.cli.boards._summary', side_effect=OSError(errno.EMFILE, 'Too many open files')): bfsim.cli.main.main()"
    done = subprocess.run(
        [sys.executable, "-c", program, "boards"], capture_output=True, check=False, text=True, cwd=tmp_path
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "bfsim: error: the system must allow what bfsim asks of it: Too many open files\n"


@pytest.mark.parametrize("option", ["--json run.json", "--firmware red.py:firmware"])
def test_a_folder_that_was_removed_meanwhile(tmp_path: Path, option: str) -> None:
    """Another terminal has removed the folder that a command is started in: it was told as a circle of links, or without a place."""
    (tmp_path / "gone").mkdir()
    ended = bfsim(f"cd gone && rmdir ../gone && $BFSIM run {option}", cwd=tmp_path)
    assert ended.returncode == 2
    assert ended.stderr == (
        "bfsim: error: the current folder must be there, but was removed; `cd` to another one: No such file or directory\n"
    )


def test_a_limit_of_addresses_is_told_with_a_way_around_it() -> None:
    """As of the jobs of a cluster: code that a compiler made has the Blackfin's 4 GB of addresses; that memory was lacking said nothing."""
    limited = bfsim("ulimit -v 3000000; $BFSIM run --frames 1")
    assert limited.returncode == 2
    assert limited.stderr.startswith(
        "bfsim: error: this system must allow a process 4 GB of addresses, without memory"
    )
    assert "`ulimit -v unlimited` does, and `--profile gcc-O2`" in limited.stderr
    around = bfsim("ulimit -v 3000000; $BFSIM run --frames 1 --profile gcc-O2")
    assert around.returncode == 0, around.stderr


def test_a_fault_of_bfsim_is_no_broken_limit() -> None:
    """A traceback ends with a code of its own."""
    program = "import bfsim.cli.boards as boards; from unittest.mock import patch; from bfsim.__main__ import main\n"
    program += "with patch('bfsim.cli.boards._summary', side_effect=KeyError('x')): main()"
    done = subprocess.run(
        [sys.executable, "-c", program, "boards"], capture_output=True, check=False, text=True
    )
    assert done.returncode == FAULT
    assert "KeyError" in done.stderr
    assert "fault of bfsim" in done.stderr


def test_a_name_that_the_system_cannot_write_is_no_fault(tmp_path: Path) -> None:
    """As one from a file, in UTF-8, where names of files are ASCII; one of the command line comes as the shell has it."""
    (tmp_path / "budget.toml").write_text(
        '[[run]]\nname = "a"\nrecording = "é.mcap"\nrequire = ["missed == 0"]\n'
    )
    ascii_alone = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    done = subprocess.run(
        [sys.executable, "-m", "bfsim", "check", "--baseline", "budget.toml"],
        cwd=tmp_path,
        env=ascii_alone,
        capture_output=True,
        check=False,
        text=True,
    )
    assert done.returncode == 2
    assert ".mcap must be a name in this system's encoding, ascii; LC_ALL=C.UTF-8" in done.stderr


@pytest.mark.parametrize("moment", ["bfsim.process.signals.hear_signals", "bfsim.cli.main.main"])
def test_ctrl_c_beside_the_command_is_no_traceback(moment: str) -> None:
    """A moment before the command hears it, or behind its end."""
    program = "from unittest.mock import patch; from bfsim.__main__ import main\n"
    program += f"with patch({moment!r}, side_effect=KeyboardInterrupt): main()"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False, text=True)
    assert (done.returncode, done.stderr) == (130, "bfsim: interrupted\n")


def test_ctrl_c_is_heard_before_anything_of_bfsim_is_imported() -> None:
    """What comes before the handler is Python's own start, which tells of Ctrl-C by a traceback."""
    program = "import signal, sys\nfrom bfsim.__main__ import main\n"
    program += "assert {each for each in sys.modules if 'bfsim' in each} == {'bfsim', 'bfsim.__main__'}\n"
    program += "class Early:\n def find_spec(self, name, *_):\n  signal.raise_signal(signal.SIGINT)\n"
    program += "sys.meta_path.insert(0, Early())\nmain()"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False, text=True)
    assert (done.returncode, done.stderr) == (130, "bfsim: interrupted\n")


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGTERM, 143),
        (signal.SIGHUP, 129),
        (signal.SIGINT, 130),
    ],
)
def test_a_signal_leaves_nothing_behind(tmp_path: Path, number: signal.Signals, code: int) -> None:
    """What is drawn when the signal comes is drawn to its end, and no file or folder stays but what was asked for."""
    arguments = "run", "--overlay", "seen", "--mcap", "seen.mcap", "--json", "seen.json"
    with subprocess.Popen(
        [sys.executable, "-c", SLOW, *arguments],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        cwd=tmp_path,
    ) as process:
        while process.poll() is None and not (tmp_path / "drawing").exists():
            time.sleep(0.05)
        process.send_signal(number)
        (tmp_path / "signalled").touch()
        _, err = process.communicate()
    assert (process.returncode, err) == (code, "bfsim: interrupted after 1 frames\n")
    left = {each.name for each in tmp_path.iterdir()} - {"drawing", "signalled"}
    assert left == {"seen", "seen.json", "seen.mcap"}
    assert [each.name for each in (tmp_path / "seen").iterdir()] == ["frame-0000.png"]
    assert ["seen" in each for each in json.loads((tmp_path / "seen.json").read_text())["frames"]] == [True]


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="a system without /dev/zero")
@pytest.mark.parametrize(
    "arguments",
    [
        ("ldf", "/dev/zero"),
        *exhaustive(
            (("run", "--ldf", "/dev/zero"),),
            (("check", "--baseline", "/dev/zero"),),
            (("sweep", "/dev/zero"),),
            (("diff", "/dev/zero", "/dev/zero"),),
        ),
    ],
)
def test_a_device_without_an_end_is_no_file_to_read(arguments: tuple[str, ...]) -> None:
    """What is read whole has a largest size: an endless device is refused, where it filled the memory."""
    command = [sys.executable, "-m", "bfsim", *arguments]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert done.returncode == 2, done.stderr
    assert "/dev/zero" in done.stderr


DROPPED = """
import os, signal, sys, time, weakref
from bfsim.process import signals
from bfsim.process.signals import hear_signals, interrupted_code

class Thing: ...

signals.AGAIN_S = float(sys.argv[1])
hear_signals()
thing = Thing()
watch = weakref.ref(thing, lambda _: [os.kill(os.getpid(), signal.SIGTERM) for _ in range(1)])
try:
    del thing
    time.sleep(20)
except KeyboardInterrupt:
    raise SystemExit(interrupted_code())
"""


@pytest.mark.parametrize("again_s", [signals.AGAIN_S, 0])
def test_a_signal_in_a_callback_is_heard_all_the_same(again_s: float) -> None:
    """Python prints an exception in a callback of a weak reference, and goes on: a sweep ran to its end after Ctrl-C.

    It is sent again until it comes behind the callback: a busy machine may take longer to get there.
    """
    done = subprocess.run(
        [sys.executable, "-c", DROPPED, str(again_s)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.returncode, done.stderr) == (128 + signal.SIGTERM, "")

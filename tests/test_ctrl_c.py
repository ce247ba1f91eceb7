"""A run, or a script, that is interrupted: it ends with what it has, and says which line was at work, also of a kernel that does not end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bfsim.process.signals import cancellable
from tests.eyes import FIRMWARE, record
from tests.tiers import exhaustive

ENDLESS_LINE = '            while True: pathlib.Path("begun").touch(); time.sleep(0.01)'
STOPS_IN_A_FRAME = FIRMWARE.replace(
    "        bright = 0\n",
    f"""        bright = 0
        if core.name == "A" and frame.index == {{frame}}:
            import time, pathlib
{ENDLESS_LINE}
""",
)


def interrupted_in(frame: int, folder: Path) -> tuple[int, str, str]:
    """Interrupt a run in a frame that does not end; return its exit code and what it has printed."""
    (folder / "eyes.py").write_text(STOPS_IN_A_FRAME.replace("{frame}", str(frame)))
    recording = record(folder / "drive.mcap", 5)
    command = [sys.executable, "-m", "bfsim", "run", recording, "--firmware", "eyes.py"]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        while process.poll() is None and not (folder / "begun").exists():
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    return process.returncode, out, err


@pytest.mark.parametrize(
    ("frame", "told", "shown"),
    [(3, "interrupted after 3 frames", "frames/s"), (0, "interrupted before the first frame was done", "")],
)
def test_ctrl_c_ends_with_the_report_of_the_frames_done(
    tmp_path: Path, frame: int, told: str, shown: str
) -> None:
    """An interrupted run prints what it has, says which line of the firmware was at work, and exits with 130."""
    code, out, err = interrupted_in(frame, tmp_path)
    line = STOPS_IN_A_FRAME.splitlines().index(ENDLESS_LINE) + 1
    assert code == 130
    assert shown in out
    assert f"bfsim: {told} ({tmp_path}/eyes.py:{line})\n" in err
    assert "Traceback" not in err


ENDLESS = """
from pathlib import Path
from bfsim.api import Buffer, BudgetRow, Firmware, i32, kernel, kernel_from, u8

@kernel
def spin(x: i32) -> i32:
    while x > 0:
        x = 1
    return x

def main(core):
    while (yield from core.next_frame()) is not None:
        yield core.run(spin, 0)  # compiled from now on
        Path("begun").touch()
        yield core.run(spin, 1)

def buffers(size):
    rows = {"A": "sdram_bank0", "B": "sdram_bank1"}
    return {core: [Buffer("camera", u8, 2 * size.width_px, bank, rows=2 * size.height_px)] for core, bank in rows.items()}

fw = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="S"),))
"""


OBJECT_CODE = (
    f"kernel_from({str(Path(__file__).parent / 'blackfin/data/endless.o')!r}, 'spin', x=i32, result=i32)"
)
SURELY_IN_THE_KERNEL_TICKS = 50
"""Of 10 ms each: what Python has to do between the file and the kernel takes less than one, however busy the machine is."""


def cpu_ticks(pid: int) -> int:
    """Return for how long a process was running on a processor, in user mode (proc(5), field 14)."""
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11])


def wait_for_the_kernel(process: subprocess.Popen[str], folder: Path) -> None:
    """Return when the kernel that does not end has surely begun."""
    while process.poll() is None and not (folder / "begun").exists():
        time.sleep(0.05)
    begun = cpu_ticks(process.pid)
    while process.poll() is None and cpu_ticks(process.pid) < begun + SURELY_IN_THE_KERNEL_TICKS:
        time.sleep(0.05)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="a system without /proc")
@pytest.mark.parametrize("number", [signal.SIGINT, *exhaustive(signal.SIGTERM)])
@pytest.mark.parametrize("code", ["spin", OBJECT_CODE])
def test_a_signal_ends_a_kernel_that_does_not_end(tmp_path: Path, number: signal.Signals, code: str) -> None:
    """Python hears nothing while the machine code of a kernel runs, estimated or not; the user needs no `kill`."""
    (tmp_path / "endless.py").write_text(f"{ENDLESS}\nspin = {code}\n")
    command = [sys.executable, "-m", "bfsim", "run", "--firmware", "endless:fw"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for_the_kernel(process, tmp_path)
        process.send_signal(number)
        _, err = process.communicate()
    line = ENDLESS.splitlines().index("        yield core.run(spin, 1)") + 1
    told = f"bfsim: interrupted before the first frame was done, in a kernel that does not end ({tmp_path}/endless.py:{line})\n"
    assert (process.returncode, err) == (128 + number, told)


MEETS_THE_OTHER_CORE = (
    ENDLESS.replace("x: i32)", "x: i32, both: u8[:])")
    .replace("spin, 0)", 'spin, 0, core.array("both"))')
    .replace("spin, 1)", 'spin, 1, core.array("both"))')
    .replace("rows.items()}", 'rows.items()} | {"shared": [Buffer("both", u8, 4, "l2_shared")]}')
)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="a system without /proc")
def test_a_kernel_that_does_not_end_is_told_with_its_line_where_it_waited_for_its_turn(
    tmp_path: Path,
) -> None:
    """One that meets the other core is run when the simulated time is there, from no line of the firmware."""
    (tmp_path / "endless.py").write_text(MEETS_THE_OTHER_CORE)
    command = [sys.executable, "-m", "bfsim", "run", "--firmware", "endless:fw"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for_the_kernel(process, tmp_path)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate()
    line = next(
        number for number, each in enumerate(MEETS_THE_OTHER_CORE.splitlines(), 1) if "spin, 1" in each
    )
    assert err.endswith(f", in a kernel that does not end ({tmp_path}/endless.py:{line})\n")


SCRIPT = """
import sys
from pathlib import Path
from endless import fw, spin
from bfsim.run import simulate

try:
    if sys.argv[1] == "call":
        spin(0)
        Path("begun").touch()
        spin(1)
    else:
        run = simulate(firmware=fw)
        print(run.interrupted, run.interrupted_at)
except KeyboardInterrupt as error:
    print(error)
print(spin(0))
"""
"""A call, or a run, that Ctrl-C ends; then the kernel is called once more."""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="a system without /proc")
@pytest.mark.parametrize("code", ["spin", OBJECT_CODE])
@pytest.mark.parametrize("what", ["call", "run"])
def test_ctrl_c_ends_a_kernel_that_does_not_end_in_a_script(tmp_path: Path, code: str, what: str) -> None:
    """Python's own handler had its turn when the kernel was over: never."""
    (tmp_path / "endless.py").write_text(f"{ENDLESS}\nspin = {code}\n")
    (tmp_path / "script.py").write_text(SCRIPT)
    command = [sys.executable, "script.py", what]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        wait_for_the_kernel(process, tmp_path)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    line = ENDLESS.splitlines().index("        yield core.run(spin, 1)") + 1
    told = {"call": "", "run": "True , "}[what]
    place = {"call": "", "run": f" ({tmp_path}/endless.py:{line})"}[what]
    assert out == f"{told}in a kernel that does not end{place}\n0\n"


IN_A_THREAD = """
from multiprocessing import get_context
from threading import Thread
from endless import fw
from bfsim.run import simulate

def run():
    print(simulate(firmware=fw).interrupted_at, flush=True)

def run_in_a_fork():
    child = get_context("fork").Process(target=run)
    child.start()
    child.join()

if __name__ == "__main__":
    thread = Thread(target={target}, daemon={target} is run)
    thread.start()
    try:
        thread.join()
    except KeyboardInterrupt:
        print("heard", flush=True)
"""
"""A run in a thread, which no signal ends, or in the main thread of a process that was forked there, which one does."""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="a system without /proc")
@pytest.mark.parametrize("target", ["run", "run_in_a_fork"])
def test_ctrl_c_is_heard_while_another_thread_is_in_a_kernel_that_does_not_end(
    tmp_path: Path, target: str
) -> None:
    """The kernel was short before: it kept Python, and nobody heard."""
    (tmp_path / "endless.py").write_text(ENDLESS)
    (tmp_path / "script.py").write_text(IN_A_THREAD.replace("{target}", target))
    command = [sys.executable, "script.py"]
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        while process.poll() is None and not (tmp_path / "begun").exists():
            time.sleep(0.05)
        time.sleep(1)
        os.killpg(process.pid, signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    line = ENDLESS.splitlines().index("        yield core.run(spin, 1)") + 1
    told = f", in a kernel that does not end ({tmp_path}/endless.py:{line})"
    assert sorted(out.splitlines()) == (["heard"] if target == "run" else [told, "heard"])


NATIVE = """
import os, signal, sys, time
from threading import Event
from bfsim.process.signals import cancellable, hear_signals

def render():
    open("begun", "w").close()
    assert cancelled.wait(30)
    return "half a picture"

cancelled = Event()
hear_signals()
try:
    print(cancellable(render, cancelled.set))
except KeyboardInterrupt:
    print("cancelled", cancelled.is_set())
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_native_code_that_takes_long_is_cancelled(tmp_path: Path, number: signal.Signals) -> None:
    """The renderer of scenes took the signal for itself, and half a picture went to the recording."""
    command = [sys.executable, "-c", NATIVE]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        while process.poll() is None and not (tmp_path / "begun").exists():
            time.sleep(0.05)
        process.send_signal(number)
        out, _ = process.communicate()
    assert out == "cancelled True\n"


def test_native_code_that_nobody_cancels_returns() -> None:
    """And what it raises is raised."""
    assert cancellable(lambda: 5, lambda: None) == 5
    with pytest.raises(ZeroDivisionError):
        cancellable(lambda: 1 // 0, lambda: None)


IMPORTED = """
import importlib, os, signal
from threading import Event, Thread
from bfsim.process.signals import hear_signals
from bfsim.recording.scenes import renderer

importing = Event()

def press():
    importing.wait()
    os.kill(os.getpid(), signal.SIGINT)  # heard by this thread, as by that which draws a bar

class Renderer:
    def set_variant(self, name):
        print(name)

def imported(name):
    importing.set()
    thread.join()
    try:
        sum(range(100_000))
    except BaseException:  # as drjit's import does
        raise NameError(name) from None
    return Renderer()

thread = Thread(target=press)
thread.start()
hear_signals()
importlib.import_module = imported
try:
    renderer._load_mitsuba()
except KeyboardInterrupt:
    print("interrupted")
"""


def test_ctrl_c_waits_for_the_import_of_the_renderer() -> None:
    """A thread of ours may hear it where the main one does not: drjit takes the exception for a part that is not there."""
    done = subprocess.run([sys.executable, "-c", IMPORTED], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("scalar_rgb\ninterrupted\n", "")

"""Programs that are run: what they write, their time limit, and that nothing of them stays."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from programs.toolchains import running
from programs.toolchains.process import ToolchainError, execute
from programs.toolchains.running import run

# Starts another program, as a compiler does, and writes its number into a file.
_WITH_ANOTHER = "sleep 60 & echo $! > other; wait"


def is_alive(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def ends(process: int) -> bool:
    """Return whether a process ends within some seconds."""
    for _ in range(100):
        if not is_alive(process):
            return True
        time.sleep(0.05)
    return False


@pytest.fixture(autouse=True)
def nothing_else_stays():
    """Each test ends what it started; workers of other tests may go on."""
    before = set(running._RUNNING)
    yield
    assert before == running._RUNNING


def test_status_and_output_are_returned_and_input_is_read(tmp_path):
    command = ["sh", "-c", "cat; pwd; echo bad >&2; exit 3"]
    status, out, complaint = run(command, 10.0, tmp_path, b"given\n")
    assert (status, complaint) == (3, b"bad\n")
    assert out == f"given\n{tmp_path}\n".encode()


def test_a_program_that_does_not_start_leaves_nothing():
    with pytest.raises(FileNotFoundError):
        run(["/no/such/program"], 1.0)


def test_what_a_hung_program_started_is_killed_too(tmp_path):
    with pytest.raises(ToolchainError, match=r"no end after 0\.5 s"):
        execute(["sh", "-c", _WITH_ANOTHER], failure="it hangs", folder=tmp_path, seconds=0.5)
    assert ends(int((tmp_path / "other").read_text()))


_ENDING = """
import os, threading, time
from programs.toolchains import running

def end_process():
    while not running._RUNNING:
        time.sleep(0.01)
    running.end_all()
    time.sleep(1)
    os._exit(7)

threading.Thread(target=end_process).start()
running.run(["sleep", "60"], 60.0)
os._exit(1)
"""


def test_nobody_hears_of_a_program_that_was_killed_because_the_process_ends():
    done = subprocess.run([sys.executable, "-c", _ENDING], check=False, timeout=60)
    assert done.returncode == 7


_COMPILING = f"""
import sys, types
from programs.toolchains.process import execute, workspace

def compiling():
    with workspace() as folder:
        print(folder, flush=True)
        execute(["sh", "-c", {_WITH_ANOTHER!r}], failure="it hangs", folder=folder)

# In place of a command that takes long
cli = sys.modules["shadefit.cli"] = types.ModuleType("shadefit.cli")
cli.main = compiling
from shadefit.__main__ import main
main()
"""


@pytest.mark.parametrize(
    ("number", "said"),
    [
        (signal.SIGINT, "interrupted; no file is half written"),
        (signal.SIGTERM, "ended by SIGTERM; no file is half written"),
        (signal.SIGHUP, "ended, as its terminal was closed (SIGHUP); no file is half written"),
    ],
)
def test_a_signal_ends_compilers_and_removes_their_folder(number, said):
    code = f"import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n{_COMPILING}"
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    folder = Path(process.stdout.readline().strip())
    while not (folder / "other").exists() or not (folder / "other").read_text().strip():
        time.sleep(0.05)
    other = int((folder / "other").read_text())
    assert is_alive(other)
    process.send_signal(number)
    out, error = process.communicate(timeout=60)
    assert (process.returncode, out, error) == (128 + number, "", f"shadefit: {said}\n")
    assert not folder.exists()
    assert ends(other)


def test_a_signal_that_is_ignored_stays_ignored():
    """As under nohup."""
    code = f"import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)\n{_COMPILING}"
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process.stdout.readline()
    process.send_signal(signal.SIGHUP)
    time.sleep(0.3)
    assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=60)[1].startswith("shadefit: ended by SIGTERM")


@pytest.mark.parametrize("broken", ["closed", "full", "pipe"])
def test_a_signal_ends_a_process_whose_standard_error_cannot_be_written(broken, tmp_path):
    code = f"import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n{_COMPILING}"
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    while broken == "pipe":
        try:
            os.write(writer, b"x" * 4096)
        except BlockingIOError:
            break
    os.set_blocking(writer, True)
    redirection = {"closed": "2>&-", "full": "2>/dev/full", "pipe": ""}[broken]
    process = subprocess.Popen(
        ["sh", "-c", f'exec "$0" -c "$1" {redirection}', sys.executable, code],
        stdout=subprocess.PIPE,
        stderr=writer,
        text=True,
    )
    os.close(writer)
    folder = Path(process.stdout.readline().strip())
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    assert not folder.exists()
    process.stdout.close()
    os.close(reader)

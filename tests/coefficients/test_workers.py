"""Processes that work side by side: none of their results is lost."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from coefficients.workers import Cluster, LocalProcesses

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def functions_of_this_file_can_be_imported(monkeypatch):
    """Other processes import them from the folder of the project."""
    monkeypatch.syspath_prepend(ROOT)


def squared(task: int) -> tuple[int, int]:
    return task**2, os.getpid()


def killed_once(task: tuple[str, int]) -> int:
    """Kill the own process if no process has been killed for this task."""
    folder, number = task
    mark = Path(folder) / str(number)
    if number % 2 == 0 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def killed_always(_: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def refused(task: int) -> None:
    raise ValueError(f"task {task}")


def test_all_tasks_have_their_results_and_other_processes_compute_them():
    found = dict(LocalProcesses(2).results(squared, range(5)))
    assert {task: value for task, (value, _) in found.items()} == {k: k * k for k in range(5)}
    assert os.getpid() not in {process for _, process in found.values()}


def test_no_task_needs_no_process():
    assert list(LocalProcesses(2).results(squared, [])) == []


@pytest.mark.slow
def test_a_killed_process_loses_nothing(tmp_path):
    tasks = [(str(tmp_path), number) for number in range(5)]
    found = list(LocalProcesses(2).results(killed_once, tasks))
    assert sorted(result for _, result in found) == list(range(5))
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.slow
def test_processes_that_always_end_are_given_up():
    with pytest.raises(ValueError, match="processes ended 6 times"):
        list(LocalProcesses(1).results(killed_always, [1]))


def test_an_error_of_a_task_is_raised_here():
    with pytest.raises(ValueError, match="task 3"):
        list(LocalProcesses(1).results(refused, [3]))


_PARENT = """
import sys, time
from coefficients.workers import LocalProcesses
from tests.coefficients.test_workers import squared
if __name__ == "__main__":
    for task, (value, process) in LocalProcesses(1).results(squared, range(2)):
        print(process, flush=True)
        time.sleep(60)
"""


@pytest.mark.slow
def test_processes_end_with_the_one_that_started_them(tmp_path):
    program = tmp_path / "parent.py"
    program.write_text(_PARENT)
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    parent = subprocess.Popen(
        [sys.executable, str(program)], stdout=subprocess.PIPE, text=True, env=variables
    )
    assert parent.stdout is not None
    worker = int(parent.stdout.readline())
    os.kill(worker, 0)
    parent.kill()
    parent.wait()
    parent.stdout.close()
    ends = time.monotonic() + 20
    while time.monotonic() < ends and Path(f"/proc/{worker}").exists():
        time.sleep(0.05)
    assert not Path(f"/proc/{worker}").exists()


def test_a_cluster_that_does_not_answer_is_one_line(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("coefficients.workers._PATIENCE", 0.3)
    with pytest.raises(ValueError, match="no dask scheduler at 'tcp://127") as error:
        list(Cluster("tcp://127.0.0.1:9").results(squared, [1]))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("address", ["nowhere", "tcp://127.0.0.1", "foo://host:1", ""])
def test_an_address_of_no_cluster_is_refused_before_a_client_exists(address, monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed, "Client", None)
    with pytest.raises(ValueError, match="no dask scheduler at") as error:
        list(Cluster(address).results(squared, [1]))
    assert "\n" not in str(error.value)


def test_a_cluster_without_dask_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ValueError, match=r"shadefit\[cluster\]"):
        list(Cluster("tcp://127.0.0.1:9").results(squared, [1]))

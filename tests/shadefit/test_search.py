import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from coefficients import candidates as module
from coefficients.catalogue import resolve
from coefficients.search import Search
from fitting import Goal
from quantities import problem
from quantities.fuzz.supplement import RATIONAL_PS
from shadefit.commands.search import search
from shadefit.outputs import SearchOutput

GOAL = Goal("l2", rounding="float32")
ROOT = Path(__file__).parents[2]


def run(capsys, folder, *, rounding="float32"):
    search("q", budget=5, norm="l2", rounding=rounding, out=folder, json=True)
    found = json.loads(capsys.readouterr().out)
    SearchOutput.model_validate(found)
    return found


@pytest.mark.slow
def test_a_search_finds_a_frontier_and_goes_on_where_it_stopped(tmp_path, capsys, monkeypatch):
    found = run(capsys, tmp_path)
    best = found["frontier"]
    assert 2 <= len(best) < len(found["all"])
    assert all(each["operations"] <= 5 for each in found["all"])
    costs, errors = zip(
        *((each["operations"], each["errors"]["max"]) for each in best), strict=True
    )
    assert list(costs) == sorted(set(costs))
    assert list(errors) == sorted(errors, reverse=True)
    assert errors[-1] < found["published"]["errors"]["max"]
    # Every table is an ordinary one, and so is the plot.
    for each in found["all"]:
        assert (tmp_path / each["file"]).is_file()
    assert (tmp_path / "q-frontier.png").read_bytes()[:4] == b"\x89PNG"
    # A second run fits nothing, and says the same.
    monkeypatch.setattr(module, "fit", None)
    assert run(capsys, tmp_path) == found
    # With another goal it is another search.
    with pytest.raises(TypeError):
        run(capsys, tmp_path, rounding="none")


def test_the_published_table_is_judged_where_the_candidates_are(tmp_path):
    wanted = Search(problem("ps"), GOAL, tmp_path, lower={"alpha": 0.3})
    (form, *_) = wanted.candidates()
    part = wanted._published(form)
    whole = wanted._published(RATIONAL_PS)
    assert part is not None
    assert whole is not None
    # The largest errors are those of the least α.
    assert part.largest < 0.9 * whole.largest
    assert part.rms < whole.rms
    assert whole.operations == part.operations


@pytest.mark.slow
def test_a_search_for_r_begins_with_the_forms_of_the_best_tables(tmp_path):
    wanted = Search(problem("r"), GOAL, tmp_path, lower={"alpha": 0.05})
    (form, *_) = wanted.candidates()
    assert form.axes[0].lower == 0.05
    assert form is resolve("best/r-40-wide").require_fitted().form


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("s", None, None, None), "no forms are known of 's'"),
        (("velvet", None, None, None), "velvet has a single form: a search needs several"),
        (("q", 0, None, None), "budget = 0"),
        (("q", None, -1.0, None), "max-error = -1.0"),
        (("r", None, None, ["alpha=1.5"]), "--lower alpha=1.5: allowed are 0.01 to below 1"),
        (("r", None, None, ["alpha=x"]), "--lower alpha=x: 'x' is no number"),
        (("r", None, None, ["beta=1"]), "'beta' cannot be restricted: allowed are alpha"),
        (("q", None, None, ["density=0.1"]), "'density' cannot be restricted: it takes none"),
        (("q", 1, None, None), "no form of q"),
    ],
)
def test_what_cannot_be_searched_is_refused_in_one_line(tmp_path, arguments, message):
    quantity, budget, max_error, lower = arguments
    with pytest.raises(ValueError, match=message) as caught:
        search(quantity, budget, max_error, lower, norm="l2", out=tmp_path, json=True)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_form_that_was_refused_is_not_tried_again(tmp_path, capsys, monkeypatch):
    def refuse(*_, **__):
        raise ValueError("it has a pole")

    monkeypatch.setattr(module, "fit", refuse)
    for _ in range(2):
        with pytest.raises(ValueError, match="no form of q was found"):
            run(capsys, tmp_path)
        # From now on an attempt would be a TypeError.
        monkeypatch.setattr(module, "fit", None)
    reasons = list(tmp_path.glob("*.refused.txt"))
    assert reasons
    assert {path.read_text() for path in reasons} == {"it has a pole\n"}


@pytest.mark.slow
def test_the_plot_has_a_line_of_its_own_and_a_pipe_hears_of_the_work(tmp_path, capsys):
    search("q", budget=4, norm="l2", out=tmp_path)
    said = capsys.readouterr()
    assert said.out.splitlines()[-1] == f"plot {tmp_path / 'q-frontier'}.png"
    assert "Operations a call, of P_s a direction." in " ".join(said.out.split())
    assert said.err.splitlines()[0] == "q: which forms to try"


@pytest.mark.parametrize(
    ("jobs", "cluster", "message"),
    [
        (0, None, "jobs = 0: allowed are 1 to 256"),
        (1000, None, "jobs = 1000"),
        (2, "tcp://127.0.0.1:9", "jobs = 2 with --cluster"),
    ],
)
def test_jobs_that_cannot_be_are_refused(tmp_path, jobs, cluster, message):
    with pytest.raises(ValueError, match=message):
        search("q", norm="l2", out=tmp_path, jobs=jobs, cluster=cluster)
    assert list(tmp_path.iterdir()) == []


def start_of_search(folder: Path, *options: str) -> subprocess.Popen:
    """Start the command in a process of its own, without the cache of compiled programs."""
    command = ["-m", "shadefit", "search", "q", "--budget", "7", "--norm", "l2", *options]
    variables = {**os.environ, "PYTHONPATH": str(ROOT), "SHADEFIT_CACHE": "off"}
    return subprocess.Popen(
        [sys.executable, *command, "--out", str(folder)],
        env=variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def end_of(started: subprocess.Popen, folder: Path) -> tuple[str, dict[str, bytes]]:
    """Wait for a search. Returns its output without the folder's name, and the files."""
    output, errors = started.communicate(timeout=600)
    assert started.returncode == 0, errors
    files = {each.name: each.read_bytes() for each in folder.iterdir()}
    return output.replace(str(folder), ""), files


def kill_while_busy(client, processes: dict[str, int], started: subprocess.Popen) -> int:
    """Kill one of some workers, given by address and process, when it makes a fit."""
    while started.poll() is None:
        busy = [address for address, tasks in client.processing().items() if tasks]
        for address in set(busy) & set(processes):
            os.kill(processes[address], signal.SIGKILL)
            return processes.pop(address)
        time.sleep(0.02)
    raise AssertionError("the search ended before a worker was killed")


@pytest.mark.slow
def test_killed_workers_of_a_cluster_lose_nothing(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    # Workers import the project from its folder.
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    alone, together = tmp_path / "alone", tmp_path / "together"
    expected = end_of(start_of_search(alone), alone)
    tables = [name for name in expected[1] if name.endswith(".json")]
    assert len(tables) > 4
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs="CRITICAL"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        processes = client.run(os.getpid)
        started = start_of_search(together, "--cluster", cluster.scheduler_address)
        try:
            # One is killed in its first fit, another one when some fits are done and others not.
            killed = {kill_while_busy(client, processes, started)}
            while started.poll() is None and not list(together.glob("*.json")):
                time.sleep(0.02)
            assert len(list(together.glob("*.json"))) < len(tables)
            killed.add(kill_while_busy(client, processes, started))
            assert len(killed) == 2
            assert end_of(started, together) == expected
        finally:
            started.kill()
            started.communicate()
        # Other processes have taken the places of those that were killed.
        client.wait_for_workers(2, timeout=120)
        assert killed.isdisjoint(client.run(os.getpid).values())

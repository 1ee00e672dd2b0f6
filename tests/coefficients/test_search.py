"""A search among forms: what is tried, kept, refused and named."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from coefficients import candidates, search
from coefficients.catalogue import entries, resolve
from coefficients.search import Search
from coefficients.table import read
from coefficients.workers import Cluster, LocalProcesses
from fitting import Goal
from quantities import problem
from quantities.loader import load_problems
from quantities.registry import unregister

GOAL = Goal("l2", rounding="float32")
EXAMPLE = Path(__file__).parents[2] / "examples" / "soft_step.py"


def of(folder, quantity: str = "q", budget: int | None = 5, **options) -> Search:
    return Search(problem(quantity), options.pop("goal", GOAL), folder, budget, **options)


def test_the_errors_of_a_table_that_was_made_before_are_not_believed(tmp_path):
    entry = resolve("best/q-9")
    form, table = entry.require_fitted().form, entry.require_table()
    searched = of(tmp_path, goal=Goal(**table.goal.model_dump()), budget=None)
    path = tmp_path / f"{searched.name_of(form)}.json"
    path.write_text(search.serialise(table))
    assert searched._made_before([form, problem("q").default]) == [table, None]
    off_grid = table.errors.off_grid
    flattered = off_grid.model_copy(update={"max": off_grid.max / 2, "rms": off_grid.rms / 2})
    errors = table.errors.model_copy(update={"off_grid": flattered})
    path.write_text(search.serialise(table.model_copy(update={"errors": errors})))
    assert searched._made_before([form]) == [None]


def test_a_table_of_the_older_schema_that_was_made_before_is_not_fitted_again(tmp_path):
    entry = resolve("best/q-9")
    form, table = entry.require_fitted().form, entry.require_table()
    searched = of(tmp_path, goal=Goal(**table.goal.model_dump()), budget=None)
    data = json.loads(search.serialise(table)) | {"schema": "shadefit.table/1"}
    del data["expression"]
    (tmp_path / f"{searched.name_of(form)}.json").write_text(json.dumps(data))
    (made,) = searched._made_before([form])
    assert made is not None
    assert made.coefficients == table.coefficients


@pytest.mark.slow
def test_a_search_finds_a_frontier_and_goes_on_where_it_stopped(tmp_path, monkeypatch):
    told = []
    found = of(tmp_path).run(lambda *step: told.append(step))
    assert 2 <= len(found.best) <= len(found.found)
    assert all(each.operations <= 5 for each in found.found)
    costs, errors = zip(*((each.operations, each.largest) for each in found.best), strict=True)
    assert list(costs) == sorted(set(costs))
    assert list(errors) == sorted(errors, reverse=True)
    assert errors[-1] < found.published.largest
    assert [each.name for each in found.exact] == ["closed form"]
    # Every candidate is counted: those that were done, and the number of all.
    total = len(found.found) + found.refused
    assert {step[2] for step in told} == {total}
    assert list(dict.fromkeys(step[1] for step in told)) == list(range(total))
    # Every table is an ordinary one.
    for each in found.found:
        entry = resolve(each.file)
        assert entry.require_table().name == each.name
        assert entry.require_table().errors.off_grid.max == each.largest
    # Again: nothing is fitted, and the same is found.
    monkeypatch.setattr(candidates, "fit", None)
    assert of(tmp_path).run() == found
    # A goal of another kind is another search.
    with pytest.raises(TypeError):
        of(tmp_path, goal=Goal("l2")).run()


def test_a_table_of_another_form_under_the_same_name_is_not_taken(tmp_path, monkeypatch):
    form = next(problem("q").candidates({}))
    name = of(tmp_path).name_of(form)
    table = resolve("best/q-9").require_table()
    (tmp_path / f"{name}.json").write_text(search.serialise(table))
    monkeypatch.setattr(candidates, "fit", None)
    with pytest.raises(TypeError):
        of(tmp_path).run()


def test_a_refused_form_is_not_tried_again(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise ValueError("it has a pole")

    monkeypatch.setattr(candidates, "fit", refuse)
    for _ in range(2):
        with pytest.raises(ValueError, match="no form of q was found within 5 operations"):
            of(tmp_path).run()
        # From now on an attempt would be a TypeError.
        monkeypatch.setattr(candidates, "fit", None)
    reasons = list(tmp_path.glob("*.refused.txt"))
    assert reasons
    assert {path.read_text() for path in reasons} == {"it has a pole\n"}


@pytest.mark.slow
def test_refused_forms_are_counted(tmp_path, monkeypatch):
    fit, forms = candidates.fit, []

    def refuse_the_first(form, *arguments, **options):
        forms.append(form)
        if len(forms) == 1:
            raise ValueError("it has a pole")
        return fit(form, *arguments, **options)

    monkeypatch.setattr(candidates, "fit", refuse_the_first)
    found = of(tmp_path, budget=4).run()
    assert found.refused == 1
    assert len(found.found) == len(forms) - 1
    assert read(tmp_path / f"{found.found[0].name}.json").form == found.found[0].form


def test_no_form_within_the_budget_is_an_error(tmp_path):
    with pytest.raises(ValueError, match="no form of q was found within 1 operations"):
        of(tmp_path, budget=1).run()
    assert not list(tmp_path.iterdir())


def test_names_are_those_of_shape_and_goal(tmp_path):
    forms = list(problem("q").candidates({}))
    names = [of(tmp_path).name_of(form) for form in forms]
    assert len(set(names)) == len(names)
    assert all(name.startswith("pole-q-") for name in names)
    assert names == [of(tmp_path / "other").name_of(form) for form in forms]
    other = of(tmp_path, goal=replace(GOAL, rounding="none"))
    assert not set(names) & {other.name_of(form) for form in forms}


def test_a_search_of_r_begins_with_the_best_forms_of_the_same_domain(tmp_path):
    best = [e.require_fitted().form for e in entries(problem("r")) if e.kind == "best"]
    for least in (0.15, 0.05):
        wanted = [form for form in best if form.axes[0].lower == least]
        tried = of(tmp_path, "r", lower={"alpha": least}).candidates()
        assert [next(tried) for _ in wanted] == wanted


def test_the_published_table_is_judged_where_the_candidates_are(tmp_path):
    """The largest errors of P_s are those of the least α."""
    lower = {"alpha": 0.3}
    form = next(of(tmp_path, "ps", lower=lower).candidates())
    part = of(tmp_path, "ps", lower=lower)._published(form)
    whole = of(tmp_path, "ps")._published(problem("ps").default)
    assert part.largest < 0.9 * whole.largest
    assert part.rms < whole.rms
    assert whole.operations == part.operations


class Here:
    """Workers that fit in this process, the last task first."""

    def results(self, function, tasks):
        return ((task, function(task)) for task in reversed(tasks))


def files_of(folder):
    return {each.name: each.read_bytes() for each in folder.iterdir()}


@pytest.mark.slow
def test_fits_side_by_side_give_the_same_files_and_the_same_result(tmp_path):
    one, other = tmp_path / "one", tmp_path / "other"
    alone = of(one, budget=4).run()
    told = []
    found = of(other, budget=4).run(lambda *step: told.append(step), Here())
    assert files_of(one) == files_of(other)
    assert [replace(each, file=None) for each in found.found] == [
        replace(each, file=None) for each in alone.found
    ]
    assert found.refused == alone.refused
    assert [step[1] for step in told] == list(range(len(told)))
    assert told[-1][1] == told[-1][2] == len(files_of(one))
    # Nothing is left to do.
    again = of(other, budget=4)
    assert again.run(workers=Here()) == found


def test_refusals_of_other_processes_are_kept(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise ValueError("a pole")

    monkeypatch.setattr(candidates, "fit", refuse)
    with pytest.raises(ValueError, match="no form of q"):
        of(tmp_path).run(workers=Here())
    assert set(files_of(tmp_path).values()) == {b"a pole\n"}


@pytest.mark.slow
def test_processes_and_a_cluster_give_the_files_of_one_process(tmp_path):
    distributed = pytest.importorskip("distributed")
    (owner,) = load_problems(str(EXAMPLE))

    def run(folder, workers=None):
        Search(owner, GOAL, tmp_path / folder).run(workers=workers)
        return files_of(tmp_path / folder)

    try:
        alone = run("alone")
        assert len(alone) >= 2
        assert run("processes", LocalProcesses(2)) == alone
        with distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, dashboard_address=None
        ) as cluster:
            assert run("cluster", Cluster(cluster.scheduler_address)) == alone
    finally:
        unregister(owner.name)

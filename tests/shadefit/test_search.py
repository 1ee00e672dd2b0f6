import json

import pytest

from fitting import Goal, RationalPs
from shadefit import search

GOAL = Goal("l2", rounding="float32")


def run(capsys, folder, *, budget=5, max_error=None):
    search.run("q", budget, max_error, 0.15, GOAL, folder, True)
    return json.loads(capsys.readouterr().out)


def test_a_search_finds_a_frontier_and_goes_on_where_it_stopped(tmp_path, capsys, monkeypatch):
    found = run(capsys, tmp_path)
    best = found["frontier"]
    assert 2 <= len(best) < len(found["all"])
    assert all(each["operations"] <= 5 for each in found["all"])
    costs, errors = zip(*((each["operations"], each["largest"]) for each in best), strict=True)
    assert list(costs) == sorted(set(costs))
    assert list(errors) == sorted(errors, reverse=True)
    assert errors[-1] < found["published"]["largest"]
    # Every table is an ordinary one, and so is the plot.
    for each in found["all"]:
        assert (tmp_path / each["file"]).is_file()
    assert (tmp_path / "q-frontier.png").read_bytes()[:4] == b"\x89PNG"
    # Again: nothing is fitted, and the same is said.
    monkeypatch.setattr(search, "improve", None)
    assert run(capsys, tmp_path) == found
    # A goal of another kind is another search.
    with pytest.raises(TypeError):
        search.run("q", 5, None, 0.15, Goal("l2"), tmp_path, True)


def test_the_published_table_is_judged_where_the_candidates_are():
    (form, *_) = search._candidates("ps", 0.3)
    part = search._published("ps", form)
    whole = search._published("ps", RationalPs)
    # The largest errors are those of the least α.
    assert part.largest < 0.9 * whole.largest
    assert part.rms < whole.rms
    assert whole.operations == part.operations


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("s", None, None, 0.15), "no forms of 's' are known"),
        (("q", 0, None, 0.15), "budget = 0"),
        (("q", None, -1.0, 0.15), "max-error = -1.0"),
        (("r", None, None, 1.5), "least-alpha = 1.5"),
        (("q", 1, None, 0.15), "no form of q"),
    ],
)
def test_what_cannot_be_searched_is_refused_in_one_line(tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message) as caught:
        search.run(*arguments, GOAL, tmp_path, True)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_form_that_was_refused_is_not_tried_again(tmp_path, capsys, monkeypatch):
    def refuse(*_):
        raise ValueError("it has a pole")

    monkeypatch.setattr(search, "improve", refuse)
    for _ in range(2):
        with pytest.raises(ValueError, match="no form of q was found"):
            run(capsys, tmp_path)
        # From now on an attempt would be a TypeError.
        monkeypatch.setattr(search, "improve", None)
    reasons = list(tmp_path.glob("*.refused.txt"))
    assert reasons
    assert {path.read_text() for path in reasons} == {"it has a pole\n"}

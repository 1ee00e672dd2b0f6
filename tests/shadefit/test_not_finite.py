"""Values that are not finite, and numbers that are too small: said in words, in text and JSON."""

import json
import math

import numpy as np
import pytest

from coefficients.compare import _ratio
from integrals import PS
from quantities import problem
from shadefit.cli import main
from shadefit.commands.evaluate import _by_form, _cells
from shadefit.commands.options import checked
from shadefit.commands.point_files import read_points
from tests.coefficients.changed import changed_table

ALPHA = PS.axes[0]


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    out, err = capsys.readouterr()
    return ended.value.code, out, err


@pytest.mark.parametrize(("value", "word"), [(math.inf, "infinite"), (math.nan, "no number")])
def test_a_value_that_is_not_finite_is_null_with_a_reason(monkeypatch, value, word):
    monkeypatch.setattr("shadefit.commands.evaluate._value_at", lambda *_: value)
    fitted = problem("q").default.fitted(np.zeros(2))
    found = _by_form(fitted, {"density": 0.1}, 0.5)
    assert found == {"value": None, "difference": None, "reason": f"its value is {word} there"}
    assert _cells(found)[:2] == ["—", "—"]


def test_a_number_that_counts_as_zero_is_refused_where_zero_is():
    with pytest.raises(ValueError, match=r"^--alpha = 1e-310 is so small that it counts as 0: "):
        checked(ALPHA, 1e-310)
    assert checked(ALPHA, 2.3e-308) == 2.3e-308
    assert checked(PS.axes[1], 1e-310) == 1e-310


def test_points_that_count_as_outside_are_refused(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("alpha\n1e-310\n")
    with pytest.raises(ValueError, match=r"line 2: alpha = 1e-310 is outside its domain"):
        read_points(path, [ALPHA])
    np.save(tmp_path / "points.npy", np.array([1e-300]))
    assert read_points(tmp_path / "points.npy", [ALPHA]).tolist() == [[1e-300]]


def test_errors_of_zero_have_ratios():
    assert [_ratio(0.0, 0.0), _ratio(2.0, 0.0), _ratio(5e-324, 2.0)] == [1.0, math.inf, 0.0]
    assert _ratio(3.0, 2.0) == 1.5


@pytest.mark.slow
def test_commands_say_infinity_of_a_table_of_infinite_values(capsys, tmp_path):
    path = changed_table(tmp_path, coefficients=[1.7e308, 1.7e308], errors=None)
    status, out, err = run(capsys, "compare", path, "--json")
    found = json.loads(out)
    assert (status, err) == (0, "")
    assert found["comparisons"][0]["tables"][-1]["errors"]["max"] is None
    assert "infinity" in found["not_finite"].values()
    status, out, err = run(capsys, "evaluate", "q", "--d", "0.4", "--table", path, "--json")
    assert (status, err) == (0, "")
    assert json.loads(out)["tables"][-1]["reason"] == "its value is infinite there"
    status, out, err = run(capsys, "evaluate", "q", "--d", "0.4", "--table", path)
    assert (status, err) == (0, "") and "its value is infinite there" in out

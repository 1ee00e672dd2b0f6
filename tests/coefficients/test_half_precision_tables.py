"""What README says of the tables to take in half precision: their own error, and rounding."""

import re
from pathlib import Path

import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import trial_of
from coefficients.packaged import names_of_best
from programs.toolchains.half_precision import half_rounding
from programs.toolchains.verification import Trial

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
ADVICE = README.partition("precision, take ")[2].partition(", for arguments")[0]
CHOSEN = re.findall(r"`(best/\S+)` \((?:[^)\d]*)([\d.e-]+)\)", ADVICE)
# No table of R stays below 1e-3.
MOST = {"ps": 0.02, "g": 0.006, "q": 1e-3, "r": 2.5e-3}


def total(name: str) -> float:
    """Return a table's largest error, and how far half precision moves its values, added."""
    table = resolve(name).require_table()
    proven = table.certificates.largest_error
    own = table.errors.off_grid.max if proven is None else proven.upper
    trial = trial_of(resolve(name), "half")
    assert isinstance(trial, Trial)
    rounding = half_rounding(trial)
    assert rounding.not_finite == 0
    return own + rounding.largest


def test_readme_names_a_table_for_each_quantity():
    assert sorted(resolve(name).problem.name for name, _ in CHOSEN) == sorted(MOST)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "stated"), CHOSEN)
def test_the_total_error_is_as_stated_and_small_enough(name, stated):
    found = total(name)
    assert float(f"{found:.1e}") == float(stated)
    assert found <= MOST[resolve(name).problem.name]


@pytest.mark.slow
def test_no_cheaper_table_of_g_or_r_is_better():
    for quantity in ("g", "r"):
        names = [
            n for n in names_of_best() if n.startswith(f"best/{quantity}-") and "wide" not in n
        ]
        totals = {name: total(name) for name in names}
        assert min(totals, key=totals.__getitem__) in dict(CHOSEN)

"""The readers that docs/table-format.md prints give the values of the packaged tables."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from coefficients.catalogue import AS_PRINTED, entries, path_of
from fitting.linearity import program_of
from programs import evaluate

PAGE = (Path(__file__).parents[2] / "docs" / "table-format.md").read_text(encoding="utf-8")
# Rounding of the same operations by another library.
RELATIVE = 1e-12

# The file of a published table has the coefficients as they are printed.
PRINTED = {each.name.removesuffix(AS_PRINTED): each for each in entries() if each.kind == "printed"}
TABLES = [PRINTED.get(each.name, each) for each in entries() if each.kind != "printed"]
FILES = [path_of(each.name.removesuffix(AS_PRINTED)) for each in TABLES]


def code(language: str) -> str:
    (found,) = re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)
    return found


def points(entry) -> list[list[float]]:
    box = np.array([(axis.lower, axis.upper) for axis in entry.axes])
    return [(low + (high - low) * f).tolist() for f in (0.11, 0.83) for low, high in [box.T]]


def expected(entry) -> list[float]:
    fitted = entry.require_fitted()
    rows = [[*fitted.constants.ravel(), *point] for point in points(entry)]
    return evaluate(program_of(fitted.form), np.array(rows))[:, 0].tolist()


def test_the_python_reader():
    space: dict = {}
    exec(code("python"), space)
    for entry, file in zip(TABLES, FILES, strict=True):
        read = space["load"](file)
        found = [read(*point) for point in points(entry)]
        assert found == pytest.approx(expected(entry), rel=RELATIVE)


@pytest.mark.slow
def test_the_javascript_reader(tmp_path):
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    cases = [[str(file), points(each)] for each, file in zip(TABLES, FILES, strict=True)]
    script = tmp_path / "read.js"
    script.write_text(
        f"""{code("javascript")}
const fs = require("fs");
const cases = {json.dumps(cases)};
const rows = cases.map(([path, points]) => {{
  const evaluate = load(JSON.parse(fs.readFileSync(path)));
  return points.map((point) => evaluate(...point));
}});
console.log(JSON.stringify(rows));
"""
    )
    ran = subprocess.run([node, script], capture_output=True, text=True, check=True)
    for entry, found in zip(TABLES, json.loads(ran.stdout), strict=True):
        assert found == pytest.approx(expected(entry), rel=RELATIVE)

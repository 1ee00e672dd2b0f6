"""Memory that hostile tables take: the largest file that is read stays below a budget."""

import json
import subprocess
import sys

import pytest

from coefficients import json_text
from coefficients.json_text import MAX_VALUES, read_object
from coefficients.packaged import FOLDER
from coefficients.table import MAX_BYTES, parse

TEXT = (FOLDER / "fuzz" / "published" / "ps.json").read_text(encoding="utf-8")
# MiB for a process without JAX. Python and the validator take 40; the rest is the values of a file,
# or the errors of as many values as are allowed.
BUDGET = 400
_READ = r"""
import re, sys
from pathlib import Path
from coefficients.table import read
for path in sys.argv[1:]:
    try:
        read(Path(path))
    except ValueError as error:
        print(str(error)[:200])
# The peak of getrusage would count the process that started this one, too.
print(int(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1]) >> 10)
"""


def hostile(key: str, item: str, size: int) -> str:
    """Return a published table in which one part of its publication is a long list."""
    table = json.loads(TEXT)
    table["publication"][key] = "HERE"
    count = (size - len(TEXT)) // (len(item) + 1)
    found = ",".join([item] * count)
    return json.dumps(table).replace('"HERE"', f"[{found}]")


@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is read from /proc")
def test_the_largest_hostile_tables_stay_below_the_budget(tmp_path):
    # The first is refused before it is validated; of the second, each value is an error.
    cases = [("errata", "{}", MAX_BYTES - 100), ("errata", "{}", 3 * MAX_VALUES)]
    for number, case in enumerate(cases):
        (tmp_path / f"{number}.json").write_text(hostile(*case))
    files = [str(tmp_path / f"{number}.json") for number in range(len(cases))]
    done = subprocess.run(
        [sys.executable, "-c", _READ, *files], capture_output=True, text=True, check=True
    )
    first, second, peak = done.stdout.splitlines()
    assert first.endswith(f"is no JSON table: it has more than {MAX_VALUES} values")
    assert second.endswith("publication.errata.0.id: Field required")
    assert int(peak) < BUDGET


def test_all_values_of_a_table_count(monkeypatch):
    monkeypatch.setattr(json_text, "MAX_VALUES", 1000)
    few = 1000 - 3
    read_object(json.dumps({"a": [0] * few, "b": {}}))
    for text in (
        json.dumps({"a": [0] * (few + 1), "b": {}}),
        json.dumps({"a": [[{}] * (few // 2)] * 2, "b": 1}),
        json.dumps({str(k): None for k in range(1000)}),
        '{"a":' + "[" * 900 + "0" + "]" * 900 + ',"b":[' + "0," * 100 + "0]}",
    ):
        with pytest.raises(ValueError, match="more than 1000 values"):
            read_object(text)


def test_tables_have_far_fewer_values():
    def count(value) -> int:
        inner = value.values() if isinstance(value, dict) else value
        return 1 + sum(map(count, inner)) if isinstance(value, dict | list) else 1

    for path in FOLDER.glob("*/*/*.json"):
        text = path.read_text(encoding="utf-8")
        assert parse(text, path.name)
        assert count(json.loads(text)) < MAX_VALUES // 20

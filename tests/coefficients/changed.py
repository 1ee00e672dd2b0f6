"""Tables with other content."""

import json
from pathlib import Path

from coefficients.packaged import packaged_table
from coefficients.table import serialise


def changed_table(folder: Path, name: str = "q", **changes) -> str:
    """Write the table `name` with other values of some keys; None removes a key."""
    data = json.loads(serialise(packaged_table(name)))
    data |= changes
    path = folder / "changed.json"
    path.write_text(json.dumps({key: each for key, each in data.items() if each is not None}))
    return str(path)


def put(*path_and_value):
    """Return a function that puts a value at a path in the content of a table."""
    *path, last, value = path_and_value

    def change(data):
        for key in path:
            data = data[key]
        data[last] = value

    return change

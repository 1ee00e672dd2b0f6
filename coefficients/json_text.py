"""JSON as text: strict reading, because a file may be hostile, and a layout for people to read."""

import json
import math
from typing import Any

# Integers with more digits are refused before they are converted, because the conversion is slow.
MAX_DIGITS = 100
# More values than these (objects, lists, texts, numbers) are refused before they are validated: an
# error takes kilobytes, and each value may be one. The largest packaged table has 1855.
MAX_VALUES = 100_000
# Lines are at most this many characters long.
WIDTH = 100


def read_object(text: str) -> dict[str, Any]:
    """Read a JSON object.

    Raises ValueError for text that is not a JSON object, for a key that occurs twice, for NaN and
    infinities, for an integer with too many digits, and for too many values. Raises RecursionError
    for text that is nested too deeply.
    """
    data = json.loads(
        text,
        parse_constant=_refuse_constant,
        parse_int=_integer,
        object_pairs_hook=_without_repetition,
    )
    if not isinstance(data, dict):
        raise ValueError("allowed is an object, {…}")
    _require_few(data)
    return data


def laid_out(value: Any, indent: str = "") -> str:
    """Return JSON text. A list of scalars is on one line, or wrapped if it exceeds WIDTH."""
    inner = indent + "  "
    if isinstance(value, dict) and value:
        items = [
            f"{inner}{json.dumps(key)}: {laid_out(each, inner)}" for key, each in value.items()
        ]
        return "{\n" + ",\n".join(items) + f"\n{indent}}}"
    if isinstance(value, list) and value:
        if any(isinstance(each, dict | list) for each in value):
            items = [f"{inner}{laid_out(each, inner)}" for each in value]
            return "[\n" + ",\n".join(items) + f"\n{indent}]"
        return _wrapped([_scalar(each) for each in value], indent)
    return _scalar(value)


def _without_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"{max(keys, key=keys.count)!r} is there twice")
    return found


def _require_few(data: dict[str, Any]) -> None:
    """Raise ValueError if data has too many values. They are counted without recursion."""
    waiting: list[Any] = [data]
    count = 1
    while waiting:
        each = waiting.pop()
        inner = each.values() if isinstance(each, dict) else each
        count += len(inner)
        if count > MAX_VALUES:
            raise ValueError(f"it has more than {MAX_VALUES} values")
        waiting.extend(value for value in inner if isinstance(value, dict | list))


def _integer(digits: str) -> int:
    if len(digits) > MAX_DIGITS:
        raise ValueError(f"an integer has {len(digits)} digits: allowed are {MAX_DIGITS}")
    return int(digits)


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON number")


def _wrapped(items: list[str], indent: str) -> str:
    one_line = f"[{', '.join(items)}]"
    if len(one_line) + len(indent) <= WIDTH:
        return one_line
    lines, line = [], ""
    for item in items:
        if line and len(indent) + 2 + len(line) + len(item) + 2 > WIDTH:
            lines.append(line)
            line = ""
        line += (" " if line else "") + item + ","
    lines.append(line.removesuffix(","))
    body = "\n".join(f"{indent}  {each}" for each in lines)
    return f"[\n{body}\n{indent}]"


def _scalar(value: Any) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{value} cannot be written as JSON")
    return json.dumps(value, ensure_ascii=False)

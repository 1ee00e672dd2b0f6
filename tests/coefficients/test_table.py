"""Tables as files: what is written comes back, and nothing but a table is read."""

import copy
import errno
import json
import os
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import coefficients
from coefficients.json_text import MAX_DIGITS, read_object
from coefficients.packaged import FOLDER, names_of_best
from coefficients.table import (
    MAX_BYTES,
    SCHEMA,
    Table,
    json_schema,
    parse,
    read,
    serialise,
)
from coefficients.table_parts import BLANK
from tests.coefficients.changed import put

FUZZ = FOLDER / "fuzz"
SHIPPED = sorted(FUZZ.parent.glob("*/*/*.json"))
TEXT = (FUZZ / "refit" / "r.json").read_text(encoding="utf-8")
# One that is there once: the first coefficient.
NUMBER = repr(json.loads(TEXT)["coefficients"][0])
PUBLISHED = (FUZZ / "published" / "ps.json").read_text(encoding="utf-8")


def refused(text: str) -> str:
    """Check that a text is refused in one line that names its source; give the line."""
    with pytest.raises(ValueError) as caught:
        parse(text, "some/file.json")
    message = str(caught.value)
    assert type(caught.value) is ValueError
    assert message.isprintable()  # which a line break is not
    assert message.startswith("some/file.json")
    assert len(message) < 500
    return message


def changed(change, text: str = TEXT) -> str:
    data = json.loads(text)
    change(data)
    return json.dumps(data)


# What comes back


def test_published_refitted_and_best_tables_are_shipped():
    names = [f"{path.parent.name}/{path.stem}" for path in SHIPPED]
    others = [f"{folder}/{q}" for folder in ("published", "refit") for q in ("g", "ps", "q", "r")]
    ggx = [
        f"{folder}/ggx-{q}"
        for folder in ("published", "refit")
        for q in ("bias", "directional-albedo", "scale")
    ]
    more = ["refit/velvet", "refit/ggx-average-albedo"]
    ends = ("published", "refit")
    maps = [f"{folder}/sggx-filter{axes}" for folder in ends for axes in ("", "-axes")]
    maps += [f"published/sggx-filter{axes}-lean" for axes in ("", "-axes")]
    channels = ("red", "green", "blue")
    surfaces = [(folder, s) for folder in ends for s in ("cylinder", "sphere")]
    skin = [f"{folder}/skin-{s}-{c}" for folder, s in surfaces for c in channels]
    skin += [f"published/skin-cylinder-{c}-yeung" for c in channels]
    skin += ["published/skin-lobe-sphere"]
    skin += [f"refit/skin-{s}-{c}" for s in ("band-1", "band-2") for c in channels]
    skin += [f"refit/skin-lobe-{surface}" for surface in ("cylinder", "sphere")]
    assert sorted(names) == sorted([*names_of_best(), *others, *ggx, *more, *maps, *skin])


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_shipped_tables_are_written_back_byte_for_byte(path):
    text = path.read_text(encoding="utf-8")
    assert serialise(read(path)) == text


NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
SELECTORS = "".join(map(chr, [*range(0xFE00, 0xFE10), *range(0xE0100, 0xE01F0)]))
SEEN = st.characters(
    exclude_categories=("Cc", "Cf", "Cs", "Zl", "Zp"), exclude_characters=BLANK + SELECTORS
)


@settings(max_examples=60, deadline=None)
@given(
    numbers=st.lists(NUMBERS, min_size=17, max_size=17),
    rms=st.floats(0, 1e300),
    place=st.fixed_dictionaries({"alpha": NUMBERS, "theta_f": NUMBERS}),
    equation=st.text(SEEN, max_size=40),
)
def test_any_table_survives_writing_and_reading_bit_for_bit(numbers, rms, place, equation):
    data = json.loads(TEXT)
    data["coefficients"], data["equation"] = numbers, equation
    data["errors"]["on_grid"].update(rms=rms, max=rms, where=place)
    table = Table.model_validate(data)
    text = serialise(table)
    again = parse(text, "itself")
    assert repr(again.coefficients) == repr(numbers)  # −0.0 is not 0.0
    assert again == table
    assert serialise(again) == text


def test_keys_are_written_in_a_fixed_order_whatever_order_they_are_read_in():
    def backwards(value):
        if isinstance(value, dict):
            return {key: backwards(value[key]) for key in reversed(value)}
        return [backwards(each) for each in value] if isinstance(value, list) else value

    data = json.loads(TEXT)
    assert list(data) == [
        "schema", "name", "quantity", "form", "equation", "arguments", "coefficients",
        "coefficient_names", "expression", "grid", "weight", "reference", "errors", "certificates",
        "provenance",
    ]  # fmt: skip
    turned = json.dumps(backwards(data))
    assert turned != json.dumps(data)
    where = data["errors"]["on_grid"]["where"]
    written = json.loads(serialise(parse(turned, "itself")))
    assert written == data
    assert list(written) == list(data)
    assert list(written["errors"]["on_grid"]) == ["rms", "max", "where", "points"]
    # Names of axes are data: their order is the reader's to keep.
    assert set(written["errors"]["on_grid"]["where"]) == set(where)


SCHEMA_FILE = Path(coefficients.__file__).parent / "table.schema.json"
SHIPPED_SCHEMA = json.loads(SCHEMA_FILE.read_text(encoding="utf-8"))


def test_the_shipped_schema_is_the_one_that_tables_are_held_to():
    assert json_schema() == SHIPPED_SCHEMA
    assert SHIPPED_SCHEMA["properties"]["schema"]["enum"] == ["shadefit.table/1", SCHEMA]
    assert SHIPPED_SCHEMA["additionalProperties"] is False


TYPES = {
    "object": dict,
    "array": list,
    "string": str,
    "integer": int,
    "number": (int, float),
    "null": type(None),
    "boolean": bool,
}
# What each keyword of a schema asks of a value that it is about.
KEYWORDS = {
    "const": lambda value, wanted: value == wanted,
    "enum": lambda value, wanted: value in wanted,
    "minimum": lambda value, least: value >= least,
    "maximum": lambda value, most: value <= most,
    "exclusiveMinimum": lambda value, least: value > least,
    "minItems": lambda value, least: len(value) >= least,
    "maxItems": lambda value, most: len(value) <= most,
    "maxLength": lambda value, most: len(value) <= most,
    "pattern": lambda value, pattern: re.search(pattern, value) is not None,
    "required": lambda value, keys: set(keys) <= set(value),
    "propertyNames": lambda value, schema: all(conforms(key, schema) for key in value),
    "items": lambda value, schema: all(conforms(each, schema) for each in value),
    "anyOf": lambda value, schemas: any(conforms(value, each) for each in schemas),
    "$ref": lambda value, ref: conforms(value, SHIPPED_SCHEMA["$defs"][ref.split("/")[-1]]),
}
ANNOTATIONS = {"title", "description", "default", "$defs"}


def conforms(value, schema: dict) -> bool:
    """Tell whether a value conforms to a JSON Schema; an unknown keyword is a KeyError."""
    kind = schema.get("type")
    if kind and not (
        isinstance(value, TYPES[kind]) and isinstance(value, bool) == (kind == "boolean")
    ):
        return False
    known = schema.get("properties", {})
    alike = schema.get("patternProperties", {})
    others = schema.get("additionalProperties", True)
    if kind == "object":
        for key, each in value.items():
            fitting = [rule for pattern, rule in alike.items() if re.search(pattern, key)]
            rule = known.get(key, fitting[0] if fitting else others)
            if rule is False or (isinstance(rule, dict) and not conforms(each, rule)):
                return False
    handled = ANNOTATIONS | {"type", "properties", "patternProperties", "additionalProperties"}
    return all(KEYWORDS[key](value, schema[key]) for key in schema if key not in handled)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_shipped_tables_conform_to_the_shipped_schema(path):
    assert conforms(json.loads(path.read_text(encoding="utf-8")), SHIPPED_SCHEMA)


# What is refused


def drop(key):
    return lambda data: data.pop(key)


WRONG = {
    "another schema": put("schema", "shadefit.table/3"),
    "no schema": drop("schema"),
    "no coefficients": drop("coefficients"),
    "no names": drop("coefficient_names"),
    "an unknown key": put("comment", "hello"),
    "a key of two lines": put("com\nment", "hello"),
    "a key that colours the terminal": put("\x1b[31mcomment\u2028", "hello"),
    "a key without end": put("comment" * 10_000, "hello"),
    "an equation that colours the terminal": put("equation", "Eq. \x1b[31m(5)"),
    "an equation that goes back": put("equation", "Eq. (5)\b\b\b(6)"),
    "an equation of two lines": put("equation", "Eq.\n(5)"),
    "an equation in eight-bit control codes": put("equation", "Eq. \x9b31m(5)"),
    "an equation written backwards": put("equation", "Eq. \u202e(5)"),
    "a name of a coefficient that rings": put("coefficient_names", 3, "p\a β"),
    "an argument that is cleared": put("arguments", 0, "name", "al\x7fpha"),
    "a solver that is cleared": put("provenance", "solver", "\x1b[2JNewton"),
    "a version that is cleared": put("provenance", "versions", "jax", "\x1b[2J1"),
    "a library that is cleared": put("provenance", "versions", "\x1b[2Jjax", "1"),
    "a place that is cleared": put("errors", "on_grid", "where", "\x1b[2Jalpha", 0.5),
    "a shape that is cleared": put("shape", {"\x1b[2J": 1}),
    "an unknown key below": put("errors", "on_grid", "median", 0.1),
    "a name with a path": put("name", "../../etc/passwd"),
    "a name in capitals": put("name", "PS"),
    "a quantity that is no name": put("quantity", "P_s"),
    "too few coefficients": lambda data: data["coefficients"].pop(),
    "a coefficient in words": put("coefficients", 3, "0.5"),
    "a coefficient that is true": put("coefficients", 3, True),
    "a coefficient that is null": put("coefficients", 3, None),
    "coefficients one level too deep": put("coefficients", [[[1.0]]]),
    "coefficients as an object": put("coefficients", {"0": 1.0}),
    "no coefficient of a row": lambda data: data.update(coefficients=[[]], coefficient_names=["c"]),
    "rows of different length": lambda data: data.update(
        coefficients=[[1.0, 2.0], [3.0]], coefficient_names=[["a", "b"], ["c"]]
    ),
    "an empty domain": put("arguments", 0, "domain", [1.0, 1.0]),
    "a domain the wrong way round": put("arguments", 0, "domain", [1.0, 0.5]),
    "a domain of three ends": put("arguments", 0, "domain", [0.1, 0.5, 1.0]),
    "degrees": put("arguments", 0, "unit", "deg"),
    "no arguments": put("arguments", []),
    "nine arguments": lambda data: data.update(arguments=data["arguments"] * 5),
    "a grid of one node": put("grid", "nodes", 0, "count", 1),
    "a grid of half a node": put("grid", "nodes", 0, "count", 2.5),
    "a negative error": put("errors", "on_grid", "rms", -1e-3),
    "an error at no point": put("errors", "off_grid", "points", 0),
    "a weight that is no name": put("weight", "Sine!"),
    "an rms above the largest error": put("errors", "off_grid", "rms", 0.5),
    "a place of another argument": put("errors", "off_grid", "where", {"alpha": 0.5, "x": 1.0}),
    "a place without an argument": put("errors", "on_grid", "where", {"alpha": 0.5}),
    "a proof at a place of another argument": put(
        "certificates", "largest_error", {"lower": 0.0, "at": {"x": 1.0}, "upper": 1.0, "boxes": 1}
    ),
    "a range the wrong way round": put("certificates", "range", [0.5, 0.1]),
    "a proof of errors the wrong way round": put(
        "certificates",
        "largest_error",
        {"lower": 2.0, "at": {"alpha": 0.5, "theta_f": 0.1}, "upper": 1.0, "boxes": 1},
    ),
    "nodes that are there twice": lambda d: d["grid"].update(nodes=[d["grid"]["nodes"][0]] * 2),
    "nodes of another argument": put("grid", "nodes", 0, "argument", "x"),
    "two arguments of one name": put("arguments", 1, "name", "alpha"),
    "a clamp of another argument": lambda d: d.update(
        publication={**json.loads(PUBLISHED)["publication"], "clamps": {"x": [0.0, 1.0]}}
    ),
    "an equation with a soft hyphen": put("equation", "Eq.\u00ad(5)"),
    "an equation with a tag": put("equation", "Eq. (5)\U000e0041"),
    "an equation with a variation selector": put("equation", "Eq. (5)\ufe0f"),
    "an argument with a filler": put("arguments", 0, "symbol", "α\u3164"),
    "an unknown leg": put("reference", "leg", "guess"),
    "a list for a table": lambda data: None,
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_table_is_refused_in_one_line(name):
    text = changed(WRONG[name])
    refused(f"[{text}]" if name == "a list for a table" else text)


# What a schema cannot say: the order of two numbers, that two shapes or names are the same, and
# what cannot be seen.
BEYOND_A_SCHEMA = {
    "an rms above the largest error",
    "a place of another argument",
    "a place without an argument",
    "a proof at a place of another argument",
    "a range the wrong way round",
    "a proof of errors the wrong way round",
    "nodes that are there twice",
    "nodes of another argument",
    "two arguments of one name",
    "a clamp of another argument",
    "an equation with a soft hyphen",
    "an equation with a tag",
    "an equation with a variation selector",
    "an argument with a filler",
    "too few coefficients",
    "rows of different length",
    "an empty domain",
    "a domain the wrong way round",
}


@pytest.mark.parametrize("name", sorted(WRONG.keys() - BEYOND_A_SCHEMA))
def test_the_schema_refuses_what_reading_refuses(name):
    text = changed(WRONG[name])
    value = json.loads(f"[{text}]" if name == "a list for a table" else text)
    assert not conforms(value, SHIPPED_SCHEMA)


def test_the_untouched_text_of_those_is_a_table():
    assert parse(changed(lambda data: None), "itself") == parse(TEXT, "itself")


def test_a_message_says_where_and_what():
    assert "coefficients" in refused(changed(put("coefficients", 3, "0.5")))
    message = refused(changed(lambda data: data["coefficients"].pop()))
    assert "(16,)" in message
    assert "(17,)" in message
    assert "quantity" in refused(changed(put("quantity", "P_s")))
    assert "comment" in refused(changed(put("comment", "hello")))
    assert "coefficients.3: " in refused(changed(put("coefficients", 3, "0.5")))
    assert "5000 digits" in refused(TEXT.replace(NUMBER, "9" * 5000))
    assert refused(NO_JSON["nested too deeply"]).endswith("nested too deeply")


NO_JSON = {
    "nothing": "",
    "a blank": " \n",
    "cut off": TEXT[:700],
    "something behind it": TEXT + "x",
    "a number": "1e5",
    "a string": '"ps"',
    "null": "null",
    "nested too deeply": "[" * 100_000,
    "nested too deeply, but closed": '{"a":' * 20_000 + "1" + "}" * 20_000,
    "single quotes": TEXT.replace('"', "'"),
    "no text": "\x00\x01\x02",
    "half a character": '"\ud800"',
    "NaN": TEXT.replace(NUMBER, "NaN"),
    "infinity": TEXT.replace(NUMBER, "Infinity"),
    "minus infinity": TEXT.replace(NUMBER, "-Infinity"),
    "a number beyond float64": TEXT.replace(NUMBER, "1e999"),
    "digits without end": TEXT.replace(NUMBER, "9" * 5000),
    "an integer beyond float64": TEXT.replace(NUMBER, "1" + "0" * 400),
    "a name without end": TEXT.replace('"rational-r"', '"' + "r" * 10_000 + '"'),
    "a key that is there twice": TEXT.replace('"quantity"', '"name": "r", "quantity"', 1),
    "too many coefficients": changed(
        lambda d: d.update(coefficients=[0.5] * 5000, coefficient_names=["c"] * 5000)
    ),
}


@pytest.mark.parametrize("name", NO_JSON)
def test_hostile_text_is_refused_in_one_line(name):
    assert NO_JSON[name] != TEXT
    refused(NO_JSON[name])


JUNK = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**400), 10**400)
    | st.floats()
    | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=8,
)


def places(value, path=()):
    """Give the paths of everything in a JSON value."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in items:
        yield (*path, key)
        if isinstance(each, dict | list) and each:
            yield from places(each, (*path, key))


DATA = {"refit": json.loads(TEXT), "published": json.loads(PUBLISHED)}
PLACES = {name: sorted(places(data), key=str) for name, data in DATA.items()}


def read_or_refuse(text: str) -> Table | None:
    """Parse; anything but a table or a ValueError of one line fails the test."""
    try:
        return parse(text, "some/file.json")
    except ValueError as error:
        assert type(error) is ValueError
        assert str(error).isprintable()
        assert str(error).startswith("some/file.json")
        return None


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    which=st.sampled_from(sorted(DATA)),
    edits=st.lists(
        st.tuples(st.integers(0, 10**6), st.sampled_from(["put", "drop", "add", "double"]), JUNK),
        min_size=1,
        max_size=3,
    ),
)
def test_mutated_tables_are_refused_or_are_tables(which, edits):
    data = copy.deepcopy(DATA[which])
    for number, kind, junk in edits:
        *path, last = PLACES[which][number % len(PLACES[which])]
        holder = data
        try:
            for key in path:
                holder = holder[key]
            holder[last]
        except (KeyError, IndexError, TypeError):
            continue  # an earlier edit took it away
        if kind == "drop":
            del holder[last]
        elif kind == "put":
            holder[last] = junk
        elif isinstance(holder, list):
            holder.append(holder[last] if kind == "double" else junk)
        else:
            holder[f"{last}2" if kind == "double" else str(junk)[:20]] = junk
    table = read_or_refuse(json.dumps(data))
    # What passes is a table in every respect: it is written and read back unchanged.
    if table is not None:
        assert parse(serialise(table), "itself") == table


@settings(max_examples=300, deadline=None)
@given(at=st.integers(0, len(TEXT) - 1), length=st.integers(0, 40), put_in=st.text(max_size=6))
def test_text_that_is_cut_and_patched_is_refused_or_is_a_table(at, length, put_in):
    table = read_or_refuse(TEXT[:at] + put_in + TEXT[at + length :])
    if table is not None:
        assert parse(serialise(table), "itself") == table


# Files


def one_line(error) -> str:
    message = str(error.value)
    assert "\n" not in message
    return message


def test_a_file_that_cannot_be_read_is_refused_with_its_name(tmp_path, monkeypatch):
    binary, large, missing = (
        tmp_path / name for name in ("binary.json", "large.json", "none.json")
    )
    binary.write_bytes(bytes(range(256)) * 4)
    large.write_bytes(b" " * (MAX_BYTES + 1))
    for path, why in ((binary, "UTF-8"), (large, "bytes"), (missing, "No such"), (tmp_path, "no")):
        with pytest.raises(ValueError, match=why) as error:
            read(path)
        assert str(path) in one_line(error)
    for bad in ("a\0b.json", "x" * 5000 + ".json"):
        with pytest.raises(ValueError) as error:
            read(Path(bad))
        one_line(error)
    locked = tmp_path / "locked.json"
    locked.write_text(TEXT)

    def denied(*_, **__):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(os, "open", denied)
    with pytest.raises(ValueError, match="Permission denied") as error:
        read(locked)
    one_line(error)


def test_a_fifo_is_no_table(tmp_path):
    """Nor does opening one wait for a writer."""
    os.mkfifo(tmp_path / "fifo.json")
    with pytest.raises(ValueError, match="no regular file"):
        read(tmp_path / "fifo.json")


def test_what_is_no_json_number_is_not_written():
    table = parse(TEXT, "itself")
    for bad in (float("nan"), float("inf")):
        with pytest.raises(ValueError, match="cannot be written as JSON"):
            serialise(table.model_copy(update={"coefficients": [bad]}))


def test_an_integer_may_have_a_hundred_digits():
    assert read_object('{"a": ' + "9" * MAX_DIGITS + "}") == {"a": 10**MAX_DIGITS - 1}
    with pytest.raises(ValueError, match="an integer has 101 digits: allowed are 100"):
        read_object('{"a": ' + "9" * 101 + "}")

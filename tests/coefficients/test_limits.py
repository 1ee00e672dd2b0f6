"""Limits of tables: what is exactly at a limit is accepted, and one beyond it is refused."""

import copy
import json
import math

import pytest

from coefficients.json_text import read_object
from coefficients.ndf_table import read_ndf, serialise_ndf
from coefficients.packaged import FOLDER
from coefficients.table import parse, read, serialise
from coefficients.table_text import read_text, validated
from tests.coefficients.changed import put

BASE = json.loads((FOLDER / "fuzz" / "refit" / "r.json").read_text(encoding="utf-8"))
PUBLISHED = json.loads((FOLDER / "fuzz" / "published" / "ps.json").read_text(encoding="utf-8"))
PLACE = {"alpha": 0.5, "theta_f": 0.1}
# Every part that a fitted table may have
BASE |= {
    "shape": {"degree": 3, "scale": 0.5, "kind": "x", "pairs": [[1, 2]]},
    "about": {
        "symbol": "S",
        "definition": "a",
        "meaning": "b",
        "function": "F",
        "arguments": {"alpha": "a", "theta_f": "t"},
        "codomain": [0.0, 1.0],
    },
    "uncertainty": {"standard_errors": [0.1], "condition": 3.0, "unique": True, "undetermined": []},
    "goal": {"norm": "l2", "relative": False, "side": "both", "rounding": "none"},
    "publication": PUBLISHED["publication"] | {"clamps": {}},
}
BASE["grid"]["points"] = 3
BASE["reference"]["data"] = {"name": "d", "sha256": "0" * 64, "rows": 3, "held_out": 1}
BASE["certificates"] |= {
    "least_error": 1e-4,
    "conservative_bound": 0.0,
    "local_optimality": {"decrease": 0.1, "extrema": 3},
    "largest_error": {"lower": 0.1, "at": PLACE, "upper": 0.2, "boxes": 3},
    "float32_rounding": {"ieee": {"upper": 1e-7, "boxes": 3}},
}
TINY, MOST = 5e-324, 0.0013390408430285494
ROWS = [[0.5] for _ in range(64)]
NAMES = [["c"] for _ in range(64)]
LONGEST = "e" + "x" * 1999
STEPS = [["neg", "c0"]]


def several(**parts):
    """Make a change of several parts at once."""
    return lambda data: data.update(copy.deepcopy(parts))


def rows(count: int, length: int):
    return several(
        coefficients=[[0.5] * length] * count, coefficient_names=[["c"] * length] * count
    )


def row(length: int):
    return several(coefficients=[0.5] * length, coefficient_names=["c"] * length)


def arguments(count: int, different: int | None = None):
    names = [f"x{k % (different or count)}" for k in range(count)]
    place = dict.fromkeys(names, 0.5)
    one = {"rms": 0.1, "max": 0.2, "where": place, "points": 1}
    return several(
        arguments=[{"name": name, "unit": "1", "domain": [0.0, 1.0]} for name in names],
        about=BASE["about"] | {"arguments": dict(zip(names, names, strict=True))},
        errors={"on_grid": one, "off_grid": one},
        certificates={"boxes": 0},
        grid={"nodes": []},
    )


def number(path: str, accepted, refused):
    keys = [int(key) if key.isdecimal() else key for key in path.split(".")]
    return put(*keys, accepted), put(*keys, refused)


# What is just accepted, and what is not
LIMITS = {
    "coefficients": (row(4096), row(4097)),
    "coefficients in a row": (rows(1, 4096), rows(1, 4097)),
    "rows of coefficients": (rows(64, 1), rows(65, 1)),
    "no coefficients": (row(0), rows(1, 0)),
    "fewest arguments": (arguments(1), arguments(0)),
    "arguments": (arguments(8), arguments(9)),
    "arguments of different names": (arguments(2), arguments(2, different=1)),
    "steps": number("expression.steps", STEPS * 4096, STEPS * 4097),
    "operands": number(
        "expression.steps.0", ["select", "a", "b", 1.0], ["select", 1.0, 2.0, 3.0, 4.0]
    ),
    "fewest operands": number("expression.steps.0", ["neg", 1.0], ["neg"]),
    "an operand": number("expression.value", "t" * 64, "t" * 65),
    "a text": number("equation", LONGEST, LONGEST + "x"),
    "a name": number("name", "0" + "a.-_" * 15 + "abc", "0" + "a.-_" * 15 + "abcd"),
    "a name of nothing": number("form", "9", ""),
    "a name that begins with a sign": number("weight", "a-", "-a"),
    "an identifier": number("about.function", "_" + "aZ9" * 21, "_" + "aZ9" * 21 + "a"),
    "an identifier of nothing": number("about.function", "A", ""),
    "an identifier with a digit": number("about.function", "f9", "9f"),
    "pairs": number("shape.pairs", [[1, 2]] * 64, [[1, 2]] * 65),
    "a pair": number("shape.pairs.0", [1, -2], [1, 2, 3]),
    "half a pair": number("shape.pairs.0", [0, 0], [1]),
    "a shape": number("shape.degree", -3, None),
    "standard errors": number("uncertainty.standard_errors", [0.1] * 4096, [0.1] * 4097),
    "undetermined": number("uncertainty.undetermined", ["c"] * 4096, ["c"] * 4097),
    "a domain": number("arguments.0.domain", [1.0, 1.0000000000000002], [1.0, 1.0]),
    "a side": number("arguments.0.domain", [-1.0, 0.0], [-1.0]),
    "a codomain": number("about.codomain", [2.0, 2.0], [2.0, 0.0]),
    "a codomain of one end": number("about.codomain", [0.0, 1.0], [0.0]),
    "a codomain of three ends": number("about.codomain", None, [0.0, 1.0, 2.0]),
    "nodes": number("grid.nodes.0.count", 2, 1),
    "lights": number("grid.directions", 0, -1),
    "points of a fit": number("grid.points", 1, 0),
    "rows of data": number("reference.data.rows", 1, 0),
    "rows held out": number("reference.data.held_out", 0, -1),
    "a digest": number("reference.data.sha256", "0a9f" * 16, "0a9f" * 16 + "0"),
    "part of a digest": number("reference.data.sha256", "f" * 64, "0" * 63),
    "a digest in capitals": number("reference.data.sha256", "e" * 64, "A" * 64),
    "error of the reference": number("reference.error", 0.0, -TINY),
    "condition": number("uncertainty.condition", TINY, 0.0),
    "rms": number("errors.on_grid.rms", 0.0, -TINY),
    "rms and largest": number("errors.on_grid.rms", MOST * (1 + 1e-12), MOST * (1 + 1.01e-12)),
    "rms without errors": (
        lambda d: d["errors"]["on_grid"].update(rms=0.0, max=0.0),
        lambda d: d["errors"]["on_grid"].update(rms=TINY, max=0.0),
    ),
    "points": number("errors.off_grid.points", 1, 0),
    "a place": number("errors.off_grid.where", PLACE, {"alpha": 0.5}),
    "a place on the grid": number("errors.on_grid.where", PLACE, PLACE | {"x": 1.0}),
    "a place of a proof": number(
        "certificates.largest_error.at", PLACE, {"x": 0.5, "theta_f": 0.1}
    ),
    "largest error": number("certificates.largest_error.lower", 0.0, -TINY),
    "largest error at most": number("certificates.largest_error.upper", 0.1, 0.09999999999999999),
    "boxes of the largest error": number("certificates.largest_error.boxes", 1, 0),
    "decrease": number("certificates.local_optimality.decrease", 0.0, -TINY),
    "extrema": number("certificates.local_optimality.extrema", 1, 0),
    "rounding": number("certificates.float32_rounding.ieee.upper", TINY, 0.0),
    "boxes of rounding": number("certificates.float32_rounding.ieee.boxes", 1, 0),
    "denominators": number("certificates.denominator_bound", TINY, 0.0),
    "least error": number("certificates.least_error", TINY, 0.0),
    "boxes": number("certificates.boxes", 0, -1),
    "a range": number("certificates.range", [0.5, 0.5], [0.5, 0.49]),
    "a range of one end": number("certificates.range", [-1.0, 1.0], [0.5]),
    "a range of three ends": number("certificates.range", [0.0, 1.0], [0.5, 0.6, 0.7]),
    "rows to exchange": number("publication.errata.0.exchange_rows", [2, 3], [2, 3, 4]),
    "one row to exchange": number("publication.errata.0.exchange_rows", None, [2]),
    "the older schema": (
        lambda d: (d.update(schema="shadefit.table/1"), d.pop("expression")),
        lambda d: d.pop("expression"),
    ),
    "arguments of the function": number(
        "about.arguments", {"theta_f": "a", "alpha": "t"}, {"alpha": "a", "x": "t"}
    ),
    "a clamp": number("publication.clamps", {"alpha": [0.0, None]}, {"x": [0.0, None]}),
    "nodes of an argument": number("grid.nodes.1.argument", "theta_f", "alpha"),
    "some nodes": number("grid.nodes", BASE["grid"]["nodes"][1:], BASE["grid"]["nodes"] * 2),
    "names of another shape": (rows(2, 3), several(coefficients=[[0.5] * 3] * 2)),
}


def changed(change) -> str:
    data = copy.deepcopy(BASE)
    change(data)
    return json.dumps(data)


@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_is_accepted_and_no_more(name):
    accepted, refused = map(changed, LIMITS[name])
    table = parse(accepted, "a file")
    assert parse(serialise(table), "itself") == table
    with pytest.raises(ValueError, match=r"^a file: ") as caught:
        parse(refused, "a file")
    assert str(caught.value).isprintable()


# Ranges of characters that show nothing, or change what is shown: the first and the last of each
UNSEEN = [(0, 0x1F), (0x7F, 0x9F), (0x200B, 0x200F), (0x2028, 0x202E), (0x2060, 0x206F)]
UNSEEN += [(0xFE00, 0xFE0F), (0xE0100, 0xE01EF), (0x61C, 0x61C), (0xFEFF, 0xFEFF), (0xAD, 0xAD)]
UNSEEN += [(x, x) for x in map(ord, "\u034f\u115f\u1160\u180b\u2800\u3164\uffa0")]
SEEN = (0x20, 0x7E, 0xA0, 0x200A, 0x2010, 0x2027, 0x202F, 0x2070, 0xFDF0, 0xFE10, 0xE00FF, 0xE01F0)


@pytest.mark.parametrize("text", [chr(x) for pair in UNSEEN for x in sorted(set(pair))])
def test_a_character_that_cannot_be_seen_is_refused(text):
    for key in ("equation", "form"):
        with pytest.raises(ValueError, match=f"^a file: {key}: "):
            parse(changed(put(key, f"a{text}b")), "a file")


def test_characters_beside_those_that_cannot_be_seen_are_accepted():
    text = "".join(map(chr, SEEN))
    assert parse(changed(put("equation", text)), "a file").equation == text


def test_a_file_may_have_four_mebibytes(tmp_path):
    text, path = json.dumps(BASE), tmp_path / "table.json"
    path.write_text(text.ljust(4 << 20), encoding="ascii")
    assert read(path) == parse(text, "a file")
    path.write_text(text.ljust((4 << 20) + 1), encoding="ascii")
    with pytest.raises(ValueError, match="has 4194305 bytes: allowed are 4194304"):
        read(path)
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert read(path) == parse(text, "a file")
    assert read_text(path, len(text) + 3) == text


def test_an_object_may_have_a_hundred_thousand_values():
    few = [None] * (100_000 - 2)
    read_object(json.dumps({"a": few}))
    nested = [[None] * 50_000, dict.fromkeys(map(str, range(49_999)))]
    for more in ([*few, None], nested):
        with pytest.raises(ValueError, match="more than 100000 values"):
            read_object(json.dumps({"a": more}))


def test_a_key_that_is_there_twice_is_named():
    with pytest.raises(ValueError, match="'b' is there twice"):
        read_object('{"a": 1, "b": 2, "c": 3, "b": 4}')
    for text in ("NaN", "Infinity", "-Infinity"):
        with pytest.raises(ValueError, match=f"^{text} is no JSON number"):
            read_object(f'{{"a": {text}}}')
    assert math.isinf(read_object('{"a": 1e999}')["a"])


@pytest.mark.parametrize("length", [200, 201, 5000])
def test_a_long_message_is_cut_after_two_hundred_characters(length):
    def fail(_):
        raise ValueError(("y" + "x\n" * length)[:length])

    with pytest.raises(ValueError) as caught:
        validated(fail, "{}", "a file")
    shown = "yx" + " x" * 99 + ("…" if length > 200 else "")
    assert str(caught.value) == f"a file is no JSON table: {shown}"


def test_a_message_names_the_place_without_the_types_that_were_tried():
    with pytest.raises(
        ValueError, match=r"^a file: coefficients\.1: Input should be a valid number"
    ):
        parse(changed(put("coefficients", [0.5, "x"])), "a file")
    with pytest.raises(ValueError, match=r"^a file: the table: grid.nodes: expected are nodes"):
        parse(changed(put("grid", "nodes", 0, "argument", "x")), "a file")


def ndf(count: int = 2, **parts) -> dict:
    quarter = math.pi / 2
    knots = [*(quarter * k / (count - 1) for k in range(count - 1)), quarter]
    errors = {"total_variation": 0.0, "masking": 0.0, "directions": 1}
    table = {"schema": "shadefit.ndf/1", "target": "a", "linear_in": "angle", "monotone": True}
    table |= {"knots": knots, "values": [0.0] * (count - 1) + [1.0], "mass": TINY}
    return table | {"errors": errors, "command": "c"} | parts


NDF = {
    # What is accepted, and what is not
    "knots": (ndf(1024), ndf(1025)),
    "fewest knots": (ndf(2), ndf(1)),
    "a last knot": (
        ndf(knots=[0.0, math.pi / 2 + 0.9e-12]),
        ndf(knots=[0.0, math.pi / 2 - 1.1e-12]),
    ),
    "a first knot": (ndf(knots=[-0.0, math.pi / 2]), ndf(knots=[TINY, math.pi / 2])),
    "increasing knots": (
        ndf(3, knots=[0.0, TINY, math.pi / 2]),
        ndf(3, knots=[0.0, 0.0, math.pi / 2]),
    ),
    "values": (ndf(values=[TINY, 0.0]), ndf(values=[-TINY, 1.0])),
    "values above zero": (ndf(values=[TINY, TINY]), ndf(values=[0.0, 0.0])),
    "as many values": (ndf(3), ndf(3, values=[1.0, 1.0])),
    "mass": (ndf(), ndf(mass=0.0)),
    "masking": (ndf(), ndf(errors={"total_variation": 0.0, "masking": -TINY, "directions": 1})),
    "variation": (ndf(), ndf(errors={"total_variation": -TINY, "masking": 0.0, "directions": 1})),
    "directions": (ndf(), ndf(errors={"total_variation": 0.0, "masking": 0.0, "directions": 0})),
}


@pytest.mark.parametrize("name", NDF)
def test_a_limit_of_a_distribution_of_normals_is_accepted_and_no_more(name, tmp_path):
    accepted, refused = NDF[name]
    path = tmp_path / "ndf.json"
    path.write_text(json.dumps(accepted))
    table = read_ndf(path)
    path.write_text(serialise_ndf(table))
    assert read_ndf(path) == table
    path.write_text(json.dumps(refused))
    with pytest.raises(ValueError, match=r"ndf\.json: "):
        read_ndf(path)


def test_a_file_of_a_distribution_may_have_a_mebibyte(tmp_path):
    path = tmp_path / "ndf.json"
    path.write_text(json.dumps(ndf()).ljust(1 << 20))
    read_ndf(path)
    path.write_text(json.dumps(ndf()).ljust((1 << 20) + 1))
    with pytest.raises(ValueError, match="has 1048577 bytes: allowed are 1048576"):
        read_ndf(path)

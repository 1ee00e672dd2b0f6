"""What `--json` prints: the schema, and one shape in every command."""

import json
from pathlib import Path

import pytest
from pydantic import TypeAdapter, ValidationError

import shadefit.outputs
from coefficients.catalogue import resolve
from coefficients.compare import compare
from shadefit.cli import main
from shadefit.commands.compare import contestants, record
from shadefit.commands.table_records import entry_fields
from shadefit.outputs import CompareOutput, Output, output_schema
from shadefit.records import TableRecord

SCHEMA = Path(shadefit.outputs.__file__).parent / "output.schema.json"
DOCUMENTATION = Path(__file__).parents[2] / "docs" / "json.md"
CHECKED = TypeAdapter(Output)
TABLE = ("name", "kind", "quantity", "form", "equation", "file", "errors")


def printed(capsys, *arguments: str) -> dict:
    """Run a command with --json. The object is one of the schema's, and has no other keys."""
    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--json"])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    CHECKED.validate_json(text, strict=True)
    found = json.loads(text)
    assert found["schema"] == "shadefit.output/1"
    assert found["command"] == arguments[0]
    return found


def test_the_schema_file_is_that_of_the_models():
    expected = json.dumps(output_schema(), indent=2, ensure_ascii=False) + "\n"
    assert SCHEMA.read_text(encoding="utf-8") == expected


def test_the_documentation_names_every_command_and_field():
    text = DOCUMENTATION.read_text(encoding="utf-8")
    definitions = output_schema()["$defs"]
    for name, definition in definitions.items():
        for field in definition["properties"]:
            assert f"`{field}`" in text, (name, field)
    commands = [
        definition["properties"]["command"]["const"]
        for name, definition in definitions.items()
        if name.endswith("Output")
    ]
    assert len(commands) == 19
    for command in commands:
        assert f"`{command}`" in text


@pytest.mark.parametrize(
    "arguments",
    [
        ["list"],
        ["evaluate", "q", "--density", "0.3"],
        ["verify", "q", "--to", "python"],
        ["cost", "exact/ps"],
    ],
    ids=lambda arguments: " ".join(arguments[:2]),
)
def test_tables_have_one_shape_in_every_command(capsys, arguments):
    found = printed(capsys, *arguments)
    assert found["tables"]
    for table in found["tables"]:
        assert set(TABLE) <= set(table)
        assert set(table["errors"] or ()) <= {"rms", "max", "where", "points"}


def test_a_refit_holds_the_whole_table(capsys, tmp_path):
    (table,) = printed(capsys, "refit", "q", "--grid", "9", "--out", str(tmp_path))["tables"]
    file = tmp_path / "q.json"
    assert set(table) == {*TABLE, "content", "second_opinion"}
    assert table["file"] == str(file)
    assert table["content"] == json.loads(file.read_text())
    assert table["errors"] == table["content"]["errors"]["off_grid"]


@pytest.mark.parametrize("quantity", ["ps", "q"])
def test_a_comparison_is_written_with_its_coefficients(quantity):
    labelled = contestants(resolve(quantity))
    found = compare(labelled)
    data = record(found, labelled).model_dump(mode="json")
    CompareOutput.model_validate_json(json.dumps({"comparisons": [data]}), strict=True)
    assert data["quantity"] == quantity
    refitted, errors = data["tables"][-1], found.contestants[-1].errors
    assert refitted["coefficients"] == resolve(quantity).require_table().coefficients
    assert refitted["errors"] == {
        "rms": errors.rms,
        "max": errors.largest,
        "where": errors.where,
        "points": errors.points,
    }
    assert data["tables"][0]["ratios"] == {"rms": 1, "max": 1}
    assert data["largest_difference"] == {"value": found.difference, "where": found.where}


def test_a_closed_form_has_neither_form_nor_errors():
    found = TableRecord(**entry_fields(resolve("exact/q")))
    assert (found.form, found.errors, found.file, found.kind) == (None, None, None, "exact")


def test_what_is_not_of_the_schema_is_refused():
    def output(command: str = "list", **change) -> dict:
        errors = {"rms": 1.0, "max": 2.0, "where": {"x": 0.5}, "points": 4, **change}
        table = {**dict.fromkeys(TABLE, "q"), "kind": "file", "errors": errors}
        return {"schema": "shadefit.output/1", "command": command, "tables": [table]}

    CHECKED.validate_python(output(), strict=True)
    for wrong in (
        output(rms=-1.0),
        output(rms="1"),
        output(extra=1),
        output(where=[0.5]),
        output("nothing"),
    ):
        with pytest.raises(ValidationError):
            CHECKED.validate_python(wrong, strict=True)

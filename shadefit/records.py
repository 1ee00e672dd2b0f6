"""The parts of what `--json` prints: one shape for a table, its errors and its place.

`code_records` has the parts of exported code, `fuzz_records` those of the fuzz BRDF, and `outputs`
the whole objects, one for each command. docs/json.md describes them. These modules need no JAX.
"""

import math
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    WithJsonSchema,
)

from coefficients.packaged import Kind
from coefficients.table import Table

SCHEMA = "shadefit.output/1"


def _number(value: Any) -> Any:
    return math.nan if value is None else value


def _not_negative(value: float) -> float:
    if value < 0:
        raise ValueError("is negative")
    return value


# JSON has no infinity and no NaN: `shadefit.terminal.print_json` writes null for them.
Number = Annotated[float, BeforeValidator(_number), WithJsonSchema({"type": ["number", "null"]})]
Size = Annotated[
    float,
    BeforeValidator(_number),
    AfterValidator(_not_negative),
    WithJsonSchema({"minimum": 0, "type": ["number", "null"]}),
]
Count = Annotated[int, Field(ge=0)]
# The value of each axis by its name, in the unit of the axis.
Place = dict[str, Number]


class Part(BaseModel):
    """A part of a JSON object: it has no other keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Whole(Part):
    """A whole JSON object; its class has the name of the command.

    `not_finite` says of each number that is null because it is not finite what it is, by its place,
    such as `tables[0].errors.max`. It is left out if there is none.
    """

    schema_: Literal["shadefit.output/1"] = Field(alias="schema", default=SCHEMA)
    not_finite: dict[str, Literal["infinity", "-infinity", "no number"]] | None = None


class ErrorsRecord(Part):
    """The rms and the largest absolute error at a number of points.

    `where` has the largest error. It is null, and so is `points`, if they are not known.
    """

    rms: Size
    max: Size
    where: Place | None = None
    points: Count | None = None


class TableRecord(Part):
    """A table or a closed form.

    `form` is null for a closed form, `file` for a table that comes with shadefit. `errors` are
    those that the command measured, or else those that the table states; null if there are none.
    """

    name: str
    kind: Kind
    quantity: str
    form: str | None
    equation: str
    file: str | None
    errors: ErrorsRecord | None


class SecondOpinionRecord(Part):
    """What jaxopt found from `tried` other starts at the points of a fit.

    `error` and `other_error` are what the fit minimised, of the table and of the best other end;
    `values` and `coefficients` are the largest differences of the two, the second relative.
    """

    agreed: bool
    better: bool
    error: Size
    other_error: Size
    values: Size
    coefficients: Size
    tried: Count


class RefittedTable(TableRecord):
    """A table that was made; `content` is what its file holds (coefficients/table.schema.json).

    `second_opinion` is null if none was asked for, or if there is none for this fit.
    """

    content: dict[str, Any]
    second_opinion: SecondOpinionRecord | None = None


class Ratios(Part):
    """The errors of a table, divided by those of the first table of the comparison."""

    rms: Size
    max: Size


class ComparedTable(TableRecord):
    """A table of a comparison."""

    label: str
    ratios: Ratios
    coefficients: list[Any]


class LargestDifference(Part):
    """The largest difference between the values of the first and the last table, and its place."""

    value: Size
    where: Place


class ComparisonRecord(Part):
    """Tables of one quantity, measured at the same points of their common domain."""

    quantity: str
    domain: dict[str, Annotated[list[Number], Field(min_length=2, max_length=2)]]
    tables: list[ComparedTable]
    coefficient_names: list[Any]
    largest_difference: LargestDifference


class Leg(Part):
    """An exact value, and the error that its method states."""

    value: Number
    error: Size


class EvaluatedTable(TableRecord):
    """A table's value and its difference from the exact value.

    Both are null outside the table's domain; `reason` then says which argument is outside.
    """

    label: str
    value: Number | None
    difference: Number | None
    reason: str | None


class FoundTable(TableRecord):
    """A table of a search; `size` is the number of coefficients, `operations` those of a call."""

    size: Count
    operations: Count


def table_fields(name: str, kind: Kind, table: Table, file: str | None = None) -> dict[str, Any]:
    """Return the fields of a `TableRecord`, with the errors that the table states."""
    stated = table.errors.off_grid.model_dump() if table.errors else None
    return {
        "name": name,
        "kind": kind,
        "quantity": table.quantity,
        "form": table.form,
        "equation": table.equation,
        "file": file,
        "errors": stated,
    }

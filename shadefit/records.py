"""The parts of what `--json` prints: one shape for a table, its errors and its place.

`shadefit.outputs` has the whole objects, one for each command. docs/json.md describes them. This
module needs no JAX.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from coefficients.packaged import Kind
from coefficients.table import Table

SCHEMA = "shadefit.output/1"
Number = Annotated[float, Field(allow_inf_nan=False)]
Size = Annotated[Number, Field(ge=0)]
Count = Annotated[int, Field(ge=0)]
# The value of each axis by its name, in the unit of the axis.
Place = dict[str, Number]


class Part(BaseModel):
    """A part of a JSON object: it has no other keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Whole(Part):
    """A whole JSON object; its class has the name of the command."""

    schema_: Literal["shadefit.output/1"] = Field(alias="schema", default=SCHEMA)


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


class CodeErrors(ErrorsRecord):
    """Errors of exported code; `not_finite` values are left out of them."""

    not_finite: Count


class CheckRecord(Part):
    """Exported code in one language and precision; `errors` are null if it was not run.

    `form`: the difference from the float64 form, `units` the same in units in the last place,
    `allowed` the largest `form` that passes, `integral` the difference from the exact values.
    """

    language: str
    precision: str
    status: Literal["passed", "failed", "not good enough", "not checked"]
    reason: str | None
    tool: str | None
    note: str | None
    form: CodeErrors | None
    units: CodeErrors | None
    allowed: CodeErrors | None
    integral: CodeErrors | None


class VerifiedTable(TableRecord):
    """A table with the checks of its exported code."""

    checks: list[CheckRecord]


class LargestErrorRecord(Part):
    """What is proven of a largest error.

    It is at least `lower`, at the point `at`, and at most
    `upper`, which is null if that is not proven. `boxes` were examined.
    """

    lower: Size
    at: Place
    upper: Size | None
    boxes: Count


class RoundingRecord(Part):
    """What float32 rounding adds to the error of exported code, at most.

    `upper` has the proven bounds by the name of the model of arithmetic; null if there is none.
    `measured` is the largest that was found at fixed points, in IEEE 754 arithmetic.
    """

    upper: dict[str, Size | None]
    measured: Size


class CertifiedTable(TableRecord):
    """A table with what is proven of its largest error; null if there is no closed form.

    It is `understated` if an error was found that is clearly above the one that the table states.
    With --rounding, `rounding` is proven instead.
    """

    state: Literal["proven", "refuted", "not proven", "sampled"]
    largest_error: LargestErrorRecord | None
    understated: bool
    rounding: RoundingRecord | None = None


class ThroughputRecord(Part):
    """Evaluations a second by compiled C and JAX, and the largest difference of their values."""

    compiled: Size
    jax: Size
    ratio: Size
    difference: Size
    points: Count
    compiler: str
    flags: list[str]


class FunctionRecord(Part):
    """The operations of an exported function, by kind."""

    function: str
    evaluated_for: str
    operations: Count
    weighted: Count
    kinds: dict[str, Count]
    throughput: ThroughputRecord | None


class CostedTable(TableRecord):
    """A table with its exported functions, and the closed form's if it is shown beside them."""

    functions: list[FunctionRecord]


class AmbientErrors(Part):
    """Errors of the ambient model relative to the mean radiance: rms and bias by functions."""

    part: str
    light: str
    mean: Number
    rms: dict[str, Size]
    bias: dict[str, Number]
    worst: Number
    where: Place


class AmbientModelErrors(Part):
    """A model of the layer with some P_s and G: errors by light relative to the mean radiance.

    `scattered` and `scattering` name P_s and G. `brightest` is the largest radiance in uniform
    light of radiance one, `least` the least one in any light. `operations` are those of the
    exported function by its parts.
    """

    model: str
    meaning: str
    scattered: str
    scattering: str
    rms: dict[str, Size]
    largest: dict[str, Size]
    brightest: Number
    least: Number
    operations: dict[str, Count]


class LargestRadiance(Part):
    """The largest radiance in uniform light of radiance one, and where it is."""

    what: str
    largest: Number
    where: Place


class ImageRecord(Part):
    """An image's mean luminance, and its rms and largest difference from the exact image."""

    scene: str
    tables: str
    mean: Number
    rms: Size
    max: Size


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

"""What `--json` prints: one shape for a table, its errors and its place, in every command.

docs/json.md describes the objects, and output.schema.json is their JSON Schema. This module needs
no JAX.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from coefficients.packaged import Kind
from coefficients.table import Table

SCHEMA = "shadefit.output/1"

Number = Annotated[float, Field(allow_inf_nan=False)]
Size = Annotated[Number, Field(ge=0)]
Count = Annotated[int, Field(ge=0)]
# The value of each axis by its name, in the unit of the axis.
Place = dict[str, Number]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ErrorsRecord(_Part):
    """The rms and the largest absolute error at a number of points.

    `where` has the largest error. It is null, and so is `points`, if they are not known.
    """

    rms: Size
    max: Size
    where: Place | None = None
    points: Count | None = None


class TableRecord(_Part):
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


class SecondOpinionRecord(_Part):
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


class Ratios(_Part):
    """The errors of a table, divided by those of the first table of the comparison."""

    rms: Size
    max: Size


class ComparedTable(TableRecord):
    """A table of a comparison."""

    label: str
    ratios: Ratios
    coefficients: list[Any]


class LargestDifference(_Part):
    """The largest difference between the values of the first and the last table, and its place."""

    value: Size
    where: Place


class ComparisonRecord(_Part):
    """Tables of one quantity, measured at the same points of their common domain."""

    quantity: str
    domain: dict[str, Annotated[list[Number], Field(min_length=2, max_length=2)]]
    tables: list[ComparedTable]
    coefficient_names: list[Any]
    largest_difference: LargestDifference


class Leg(_Part):
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


class CheckRecord(_Part):
    """Exported code in one language and precision; `errors` are null if it was not run.

    `form`: the difference from the float64 form, `units` the same in units in the last place,
    `allowed` the largest `form` that passes, `integral` the difference from the exact values.
    """

    language: str
    precision: str
    status: Literal["passed", "failed", "not checked"]
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


class LargestErrorRecord(_Part):
    """What is proven of a largest error.

    It is at least `lower`, at the point `at`, and at most
    `upper`, which is null if that is not proven. `boxes` were examined.
    """

    lower: Size
    at: Place
    upper: Size | None
    boxes: Count


class CertifiedTable(TableRecord):
    """A table with what is proven of its largest error; null if there is no closed form.

    It is `understated` if an error was found that is clearly above the one that the table states.
    """

    state: Literal["proven", "refuted", "not proven", "sampled"]
    largest_error: LargestErrorRecord | None
    understated: bool


class ThroughputRecord(_Part):
    """Evaluations a second by compiled C and JAX, and the largest difference of their values."""

    compiled: Size
    jax: Size
    ratio: Size
    difference: Size
    points: Count
    compiler: str
    flags: list[str]


class FunctionRecord(_Part):
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


class AmbientErrors(_Part):
    """Errors of the ambient model relative to the mean radiance: rms and bias by functions."""

    part: str
    light: str
    mean: Number
    rms: dict[str, Size]
    bias: dict[str, Number]
    worst: Number
    where: Place


class LargestRadiance(_Part):
    """The largest radiance in uniform light of radiance one, and where it is."""

    what: str
    largest: Number
    where: Place


class ImageRecord(_Part):
    """An image's mean luminance, and its rms and largest difference from the exact image."""

    scene: str
    tables: str
    mean: Number
    rms: Size
    max: Size


class _Output(_Part):
    schema_: Literal["shadefit.output/1"] = Field(alias="schema", default=SCHEMA)


class ListOutput(_Output):
    """`shadefit list`."""

    command: Literal["list"] = "list"
    tables: list[TableRecord]


class RefitOutput(_Output):
    """`shadefit refit`."""

    command: Literal["refit"] = "refit"
    tables: list[RefittedTable]


class FitOutput(_Output):
    """`shadefit fit`; `file` is null for a table that was not written."""

    command: Literal["fit"] = "fit"
    tables: list[RefittedTable]


class CompareOutput(_Output):
    """`shadefit compare`."""

    command: Literal["compare"] = "compare"
    comparisons: list[ComparisonRecord]


class EvaluateOutput(_Output):
    """`shadefit evaluate`."""

    command: Literal["evaluate"] = "evaluate"
    quantity: str
    where: Place
    legs: dict[str, Leg]
    tables: list[EvaluatedTable]


class PointsOutput(_Output):
    """`shadefit evaluate --points`; `values` are null if they were written to a file.

    A value outside a table's domain is null.
    """

    command: Literal["evaluate-points"] = "evaluate-points"
    quantity: str
    points: Count
    file: str | None
    columns: list[str]
    values: dict[str, list[Number | None]] | None


class BakedAxis(_Part):
    """An axis of a LUT; `coordinate` is the formula of its texture coordinate."""

    name: str
    domain: Annotated[list[Number], Field(min_length=2, max_length=2)]
    unit: str
    scale: str
    coordinate: str


class BakeSource(_Part):
    """The table that a LUT was made of, in the domain of the LUT."""

    rms: Size
    max: Size
    bytes: Count
    operations: Count
    largest_difference: Size


class BakeOutput(_Output):
    """`shadefit bake`; `errors` are those of the LUT, `tables` are the others of the quantity."""

    command: Literal["bake"] = "bake"
    file: str
    format: str
    source: str
    size: list[Count]
    axes: list[BakedAxis]
    texel: str
    span: list[Number]
    filter: str
    centres: str
    weight_bits: Count | None
    bytes: Count
    fetches: Count
    operations: Count
    moved_texels: Count
    rounding: Size
    errors: ErrorsRecord
    table: BakeSource | None
    tables: list[dict[str, Any]]


class SearchOutput(_Output):
    """`shadefit search`: `good` are the tables of the frontier within --max-error."""

    command: Literal["search"] = "search"
    quantity: str
    published: FoundTable | None
    exact: list[FoundTable]
    refused: Count
    frontier: list[FoundTable]
    good: list[FoundTable]
    all: list[FoundTable]


class VerifyOutput(_Output):
    """`shadefit verify`."""

    command: Literal["verify"] = "verify"
    tables: list[VerifiedTable]


class CertifyOutput(_Output):
    """`shadefit certify`."""

    command: Literal["certify"] = "certify"
    tables: list[CertifiedTable]


class CostOutput(_Output):
    """`shadefit cost`."""

    command: Literal["cost"] = "cost"
    tables: list[CostedTable]


class AmbientOutput(_Output):
    """`shadefit ambient`."""

    command: Literal["ambient"] = "ambient"
    points: Count
    errors: list[AmbientErrors]
    energy: list[LargestRadiance]
    rms_without_symmetry: dict[str, Size]
    files: list[str]


class RenderOutput(_Output):
    """`shadefit render`; with --sweep there are no `images`."""

    command: Literal["render"] = "render"
    files: list[str]
    images: list[ImageRecord]


Output = Annotated[
    ListOutput
    | RefitOutput
    | CompareOutput
    | FitOutput
    | EvaluateOutput
    | PointsOutput
    | BakeOutput
    | SearchOutput
    | VerifyOutput
    | CertifyOutput
    | CostOutput
    | AmbientOutput
    | RenderOutput,
    Field(discriminator="command"),
]


def output_schema() -> dict[str, Any]:
    """Return the JSON Schema of everything that `--json` prints."""
    return TypeAdapter(Output).json_schema(by_alias=True)


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

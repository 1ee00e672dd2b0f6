"""What each command prints with `--json`, and its JSON Schema. This module needs no JAX.

docs/json.md describes the objects; output.schema.json is the schema.
"""

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter

from coefficients.packaged import Kind
from shadefit.code_records import CertifiedTable, CostedTable, VerifiedTable
from shadefit.fuzz_records import (
    AmbientErrors,
    AmbientModelErrors,
    ImageRecord,
    LargestRadiance,
)
from shadefit.material_outputs import (
    CurvatureOutput,
    DetailOutput,
    MapsEncodeOutput,
    MapsErrorsOutput,
    MapsFilterOutput,
    NdfOutput,
)
from shadefit.records import (
    ComparisonRecord,
    Count,
    ErrorsRecord,
    EvaluatedTable,
    FoundTable,
    Leg,
    Number,
    Part,
    Place,
    RefittedTable,
    Size,
    TableRecord,
    Whole,
)


class ListOutput(Whole):
    """`shadefit list`."""

    command: Literal["list"] = "list"
    tables: list[TableRecord]


class RefitOutput(Whole):
    """`shadefit refit`."""

    command: Literal["refit"] = "refit"
    tables: list[RefittedTable]


class FitOutput(Whole):
    """`shadefit fit`; `file` is null for a table that was not written."""

    command: Literal["fit"] = "fit"
    tables: list[RefittedTable]


class CompareOutput(Whole):
    """`shadefit compare`."""

    command: Literal["compare"] = "compare"
    comparisons: list[ComparisonRecord]


class EvaluateOutput(Whole):
    """`shadefit evaluate`."""

    command: Literal["evaluate"] = "evaluate"
    quantity: str
    where: Place
    legs: dict[str, Leg]
    tables: list[EvaluatedTable]


class PointsOutput(Whole):
    """`shadefit evaluate --points`; `values` are null if they were written to a file.

    A value outside a table's domain is null.
    """

    command: Literal["evaluate-points"] = "evaluate-points"
    quantity: str
    points: Count
    file: str | None
    columns: list[str]
    values: dict[str, list[Number | None]] | None


class BakedAxis(Part):
    """An axis of a LUT; `coordinate` is the formula of its texture coordinate."""

    name: str
    domain: Annotated[list[Number], Field(min_length=2, max_length=2)]
    unit: str
    scale: str
    coordinate: str


class BakeSource(Part):
    """The table that a LUT was made of, in the domain of the LUT."""

    rms: Size
    max: Size
    bytes: Count
    operations: Count
    largest_difference: Size


class BesideTable(Part):
    """A table of the quantity, in the domain that it shares with the LUT.

    `domain` has the ends of the axes of which that is not the whole; it is empty if all is shared.
    """

    table: str
    kind: Kind
    bytes: Count
    operations: Count
    rms: Size
    max: Size
    domain: dict[str, Annotated[list[Number], Field(min_length=2, max_length=2)]]


class BakeOutput(Whole):
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
    tables: list[BesideTable]


class SearchOutput(Whole):
    """`shadefit search`: `good` are the tables of the frontier within --max-error."""

    command: Literal["search"] = "search"
    quantity: str
    published: FoundTable | None
    exact: list[FoundTable]
    refused: Count
    frontier: list[FoundTable]
    good: list[FoundTable]
    all: list[FoundTable]


class VerifyOutput(Whole):
    """`shadefit verify`."""

    command: Literal["verify"] = "verify"
    tables: list[VerifiedTable]


class CertifyOutput(Whole):
    """`shadefit certify`."""

    command: Literal["certify"] = "certify"
    tables: list[CertifiedTable]


class CostOutput(Whole):
    """`shadefit cost`."""

    command: Literal["cost"] = "cost"
    tables: list[CostedTable]


class AmbientOutput(Whole):
    """`shadefit ambient`."""

    command: Literal["ambient"] = "ambient"
    points: Count
    errors: list[AmbientErrors]
    models: list[AmbientModelErrors]
    energy: list[LargestRadiance]
    rms_without_symmetry: dict[str, Size]
    files: list[str]


class RenderOutput(Whole):
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
    | NdfOutput
    | MapsEncodeOutput
    | MapsFilterOutput
    | MapsErrorsOutput
    | DetailOutput
    | CurvatureOutput
    | RenderOutput,
    Field(discriminator="command"),
]


def output_schema() -> dict[str, Any]:
    """Return the JSON Schema of everything that `--json` prints."""
    return TypeAdapter(Output).json_schema(by_alias=True)

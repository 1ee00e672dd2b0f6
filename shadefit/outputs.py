"""What each command prints with `--json`, and its JSON Schema. This module needs no JAX.

docs/json.md describes the objects; output.schema.json is the schema.
"""

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter

from coefficients.packaged import Kind
from shadefit.records import (
    AmbientErrors,
    CertifiedTable,
    ComparisonRecord,
    CostedTable,
    Count,
    ErrorsRecord,
    EvaluatedTable,
    FoundTable,
    ImageRecord,
    LargestRadiance,
    Leg,
    Number,
    Part,
    Place,
    RefittedTable,
    Size,
    TableRecord,
    VerifiedTable,
)

SCHEMA = "shadefit.output/1"


class _Output(Part):
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
    tables: list[BesideTable]


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


class NdfCheck(Part):
    """The check of one function of an NDF's code."""

    function: str
    language: str
    status: str
    reason: str | None


class NdfLookup(Part):
    """A texture that stands for a function, and its largest error."""

    texels: Count
    error: Size


class NdfCost(Part):
    """The cost of one function of an NDF's code, and the `textures` over `axes` instead of it."""

    function: str
    operations: Count
    rounding: Size
    axes: str
    textures: list[NdfLookup]


class NdfProfile(Part):
    """One profile of a blend: `mass` is that of its source interpolated at the knots."""

    mass: Size
    knots: list[Number]
    values: list[Size]


class NdfOutput(_Output):
    """`shadefit ndf`: `mass` is that of the source interpolated at the knots.

    For a blend, `mass`, `knots` and `values` are those of the profile at azimuth 0, and `across`
    has those at π/2. The errors are None if the blend has no anisotropic source.
    """

    command: Literal["ndf"] = "ndf"
    target: str
    linear_in: str
    segments: Count
    mass: Size
    total_variation: Size | None
    masking: Size | None
    directions: Count | None
    knots: list[Number]
    values: list[Size]
    across: NdfProfile | None
    checks: list[NdfCheck]
    costs: list[NdfCost]
    files: list[str]


class EncodedLevel(Part):
    """A mip level of a map, and the total variation between its lobes and the decoded ones."""

    width: Count
    height: Count
    bytes: Count
    mean: Size
    percentile_99: Size
    largest: Size


class MapsEncodeOutput(_Output):
    """`shadefit maps encode`."""

    command: Literal["maps encode"] = "maps encode"
    encoding: str
    format: str
    levels: list[EncodedLevel]
    files: list[str]


class MapLevel(Part):
    """One level of a mip chain, and its files of normals and of anisotropic roughness."""

    width: Count
    height: Count
    normal: str
    aniso: str


class MapsFilterOutput(_Output):
    """`shadefit maps filter`: the levels from the largest to that of one texel."""

    command: Literal["maps filter"] = "maps filter"
    method: str
    convention: str
    levels: list[MapLevel]


class MapErrors(Part):
    """Errors of one filter on one map; the method 'best' is the best single lobe.

    `radiance` is the rms error of a lit plane's radiance by its mean.
    """

    map: str
    method: str
    total_variation: Size
    radiance: Size


class MapsErrorsOutput(_Output):
    """`shadefit maps errors`: means over the footprints of each map."""

    command: Literal["maps errors"] = "maps errors"
    footprints: Count
    seed: Count
    errors: list[MapErrors]


class DetailOutput(_Output):
    """`shadefit detail`: errors of the composed image; null without a target, or without error."""

    command: Literal["detail"] = "detail"
    operator: str
    colour_space: str
    encoder: str | None
    rmse: Size | None
    psnr: Number | None
    largest: Size | None
    files: list[str]


class CurvatureOutput(_Output):
    """`shadefit curvature`: lengths in mm, `area` in mm², curvature in 1/mm.

    `mean_curvature` has the least, the 5 %, 50 % and 95 % quantiles, and the largest of vertices.
    `widths` are those of the smoothing. `concave` is whether concave curvature was kept. `clamped`,
    `made_normals` and `isolated` count vertices, `degenerate` triangles, `non_manifold` edges.
    """

    command: Literal["curvature"] = "curvature"
    mesh: str
    unit: str
    vertices: Count
    triangles: Count
    area: Size
    mean_curvature: list[Number]
    widths: list[Size]
    concave: bool
    range: Size
    packing_error: Size
    clamped: Count
    made_normals: Count
    degenerate: Count
    isolated: Count
    non_manifold: Count
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

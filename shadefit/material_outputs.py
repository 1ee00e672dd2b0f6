"""What the commands of materials print with `--json`: NDFs, maps, details, and meshes.

`shadefit.outputs` has the other commands. docs/json.md describes the objects.
"""

from typing import Literal

from shadefit.records import Count, Number, Part, Size, Whole


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


class NdfOutput(Whole):
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


class MapsEncodeOutput(Whole):
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


class MapsFilterOutput(Whole):
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


class MapsErrorsOutput(Whole):
    """`shadefit maps errors`: means over the footprints of each map."""

    command: Literal["maps errors"] = "maps errors"
    footprints: Count
    seed: Count
    errors: list[MapErrors]


class DetailOutput(Whole):
    """`shadefit detail`: errors of the composed image; null without a target, or without error."""

    command: Literal["detail"] = "detail"
    operator: str
    colour_space: str
    encoder: str | None
    rmse: Size | None
    psnr: Number | None
    largest: Size | None
    files: list[str]


class CurvatureOutput(Whole):
    """`shadefit curvature`: lengths in mm, `area` in mm², curvature in 1/mm.

    `mean_curvature` has the least, the 5 %, 50 % and 95 % quantiles, and the largest of vertices.
    `widths` are those of the smoothing. `concave` is whether concave curvature was kept. `drift` is
    the width of the blurred normals, if their drift was written. `clamped`,
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
    drift: Size | None
    range: Size
    packing_error: Size
    clamped: Count
    made_normals: Count
    degenerate: Count
    isolated: Count
    non_manifold: Count
    files: list[str]

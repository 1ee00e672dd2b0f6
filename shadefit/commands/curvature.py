"""`shadefit curvature`: write the curvature tensor of each vertex of a mesh."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json

if TYPE_CHECKING:
    from shadefit.material_outputs import CurvatureOutput


def curvature(
    mesh: Annotated[
        Path, typer.Argument(help="File of the mesh: OBJ, PLY, glTF or GLB.", metavar="MESH")
    ],
    unit: Annotated[
        str | None,
        typer.Option(help="Unit of the file's lengths: mm, cm, m or in. It must be given."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="PLY file with the curvature of vertices.")
    ] = None,
    widths: Annotated[
        str,
        typer.Option(
            help="Widths σ in mm of the Gaussians that curvature is smoothed by, with equal "
            "weights; 'none' for no smoothing."
        ),
    ] = "8,2.3",
    keep_concave: Annotated[
        bool, typer.Option("--keep-concave", help="Do not clamp concave curvature to zero.")
    ] = False,
    largest: Annotated[
        float,
        typer.Option("--range", help="Largest curvature of the packed bytes, in 1/mm."),
    ] = 0.5,
    json: Json = False,
) -> None:
    """Compute the curvature tensor of each vertex of a mesh, for skin.

    The PLY file has the tensor in 1/mm, its tangent, and the tensor packed into four bytes. Without
    -o only the summary is printed.
    """
    from coefficients.files import OUTPUT, require_writable_file, write_whole_bytes
    from shadefit.curvature import curvature as curvature_of
    from shadefit.curvature.files import ply_bytes, read_mesh
    from shadefit.curvature.smoothing import convex, smoothed
    from shadefit.curvature.vertex_bytes import require_range
    from shadefit.terminal import apart_from, print_json

    if unit is None:
        raise ValueError("the unit of the mesh is not known: give --unit mm, cm, m or in")
    chosen = _widths(widths)
    require_range(largest)
    if out is not None:
        if out != OUTPUT and out.suffix.lower() != ".ply":
            raise ValueError(f"{out}: allowed is a file that ends with .ply")
        require_writable_file(out)
    shape = read_mesh(mesh, unit)
    found = curvature_of(shape)
    if not keep_concave:
        found = convex(found)
    if chosen:
        found = smoothed(shape, found, chosen)
    if out is not None:
        write_whole_bytes(out, ply_bytes(shape, found, largest))
    record = _record(mesh, unit, chosen, keep_concave, largest, shape, found, out)
    with apart_from(out):
        if json:
            print_json(record)
        else:
            _print(record)


def _widths(text: str) -> list[float]:
    if text == "none":
        return []
    try:
        found = [float(each) for each in text.split(",")]
    except ValueError:
        found = []
    if not found or len(found) > 8 or not all(1e-3 <= each <= 1e3 for each in found):
        raise ValueError(
            f"--widths {text}: allowed are 'none' or up to 8 numbers in mm, like 8,2.3"
        )
    return found


def _record(path, unit, widths, keep_concave, largest, shape, found, out) -> "CurvatureOutput":
    import numpy as np

    from shadefit.curvature.vertex_bytes import clamped_count
    from shadefit.material_outputs import CurvatureOutput
    from shading.curvature import packing_error

    half = (found.tensors[:, 0] + found.tensors[:, 2]) / 2
    quantiles = np.quantile(half, [0.0, 0.05, 0.5, 0.95, 1.0])
    return CurvatureOutput(
        mesh=str(path),
        unit=unit,
        vertices=len(shape.vertices),
        triangles=len(shape.triangles),
        area=_area(shape),
        mean_curvature=[float(each) for each in quantiles],
        widths=widths,
        concave=keep_concave,
        range=largest,
        packing_error=packing_error(largest),
        clamped=clamped_count(found.tensors, largest),
        made_normals=shape.made_normals,
        degenerate=found.degenerate,
        isolated=found.isolated,
        non_manifold=found.non_manifold,
        files=[] if out is None else [str(out)],
    )


def _area(shape) -> float:
    import numpy as np

    a, b, c = (shape.vertices[each] for each in shape.triangles.T)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _print(record: "CurvatureOutput") -> None:
    from shadefit.terminal import print_table

    names = ["least", "5 %", "median", "95 %", "largest"]
    print_table(
        f"Mean curvature in 1/mm of {record.vertices} vertices, {record.triangles} triangles",
        names,
        [[f"{each:.4f}" for each in record.mean_curvature]],
        f"Packed bytes hold ±{record.range:g}/mm with an error of {record.packing_error:.1e}/mm.",
    )
    counts = {
        "vertices have curvature beyond the range, which is clamped": record.clamped,
        "vertices had no normal; it was computed": record.made_normals,
        "triangles have no area; they were left out": record.degenerate,
        "vertices have no triangle with area; their curvature is zero": record.isolated,
        "edges have more than two triangles": record.non_manifold,
    }
    for text, count in counts.items():
        if count:
            print(f"{count} {text}")
    for each in record.files:
        print(each)

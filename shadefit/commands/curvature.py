"""`shadefit curvature`: write the curvature of the vertices of a mesh, and draw it as skin."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json

if TYPE_CHECKING:
    from shadefit.curvature.mesh_picture import View
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
    drift: Annotated[
        float | None,
        typer.Option(
            help="Also write the drift of normals that are blurred by this width σ in mm; "
            "1.4 suits the red light of skin."
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(help="PNG file with the mesh as skin: N·L, lookup table, fit, curvature."),
    ] = None,
    view: Annotated[
        str,
        typer.Option(
            help="Azimuth and height of the viewer in degrees. At 0,0 the viewer is at +z, and y "
            "is up.",
            metavar="AZIMUTH,HEIGHT",
        ),
    ] = "0,0",
    light: Annotated[
        str,
        typer.Option(
            help="Azimuth and height of the light in degrees, from the viewer.",
            metavar="AZIMUTH,HEIGHT",
        ),
    ] = "-60,30",
    size: Annotated[
        int, typer.Option(help="Width of the mesh in the picture in pixels, 32 to 1024.")
    ] = 320,
    json: Json = False,
) -> None:
    """Compute the curvature tensor of each vertex of a mesh, for skin.

    The PLY file has the tensor in 1/mm, its tangent, and the tensor packed into
    four bytes. Without -o and --picture only the summary is printed.
    """
    from coefficients.files import OUTPUT, require_writable_file, write_whole_bytes
    from shadefit.curvature import curvature as curvature_of
    from shadefit.curvature.files import ply_bytes, read_mesh
    from shadefit.curvature.smoothing import convex, normal_drift, smoothed
    from shadefit.curvature.vertex_bytes import require_range
    from shadefit.terminal import messages_beside, print_json

    if unit is None:
        raise ValueError("the unit of the mesh is not known: give --unit mm, cm, m or in")
    chosen = _widths(widths)
    require_range(largest)
    if drift is not None and not 1e-3 <= drift <= 1e3:
        raise ValueError(f"--drift {drift:g}: allowed are 0.001 to 1000, in mm")
    seen = _view(view, light, size)
    if out is not None:
        if out != OUTPUT and out.suffix.lower() != ".ply":
            raise ValueError(f"{out}: allowed is a file that ends with .ply")
        require_writable_file(out)
    if picture is not None:
        if picture.suffix.lower() != ".png":
            raise ValueError(f"{picture}: allowed is a file that ends with .png")
        require_writable_file(picture)
    shape = read_mesh(mesh, unit)
    raw = curvature_of(shape)
    found = raw if keep_concave else convex(raw)
    if chosen:
        found = smoothed(shape, found, chosen)
    leaning = None if drift is None else normal_drift(shape, raw, drift)
    files = {}
    if out is not None:
        files[out] = ply_bytes(shape, found, largest, leaning)
    if picture is not None:
        files[picture] = _drawn(shape, raw, found, seen)
    for path, content in files.items():
        write_whole_bytes(path, content)
    record = _record(mesh, unit, chosen, keep_concave, largest, shape, found, drift, list(files))
    with messages_beside(out):
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


def _view(view: str, light: str, size: int) -> "View":
    from shadefit.curvature.mesh_picture import View

    if not 32 <= size <= 1024:
        raise ValueError(f"--size {size}: allowed are 32 to 1024 pixels")
    return View(*_angles("--view", view), *_angles("--light", light), size)


def _angles(option: str, text: str) -> tuple[float, float]:
    """Return an azimuth and a height in radians."""
    from math import radians

    try:
        azimuth, height = (float(each) for each in text.split(","))
    except ValueError:
        azimuth = height = float("nan")
    if not (-360 <= azimuth <= 360 and -90 <= height <= 90):
        raise ValueError(
            f"{option} {text}: allowed are an azimuth from -360 to 360 and a height from -90 to "
            "90, in degrees, like 30,10"
        )
    return radians(azimuth), radians(height)


def _drawn(shape, raw, found, view: "View") -> bytes:
    from shadefit.curvature.mesh_picture import draw_mesh
    from shadefit.curvature.skin_light import skin_of
    from shadefit.curvature.smoothing import DRIFT_WIDTH

    return draw_mesh(shape, skin_of(shape, raw, found, DRIFT_WIDTH), view)


def _record(
    path, unit, widths, keep_concave, largest, shape, found, drift, files
) -> "CurvatureOutput":
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
        drift=drift,
        files=[str(each) for each in files],
    )


def _area(shape) -> float:
    import numpy as np

    a, b, c = (shape.vertices[each] for each in shape.triangles.T)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _print(record: "CurvatureOutput") -> None:
    from shadefit.terminal import print_lines, print_table

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
        print_lines(each)

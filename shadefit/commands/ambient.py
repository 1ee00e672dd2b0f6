"""`shadefit ambient`: measure the errors of the ambient model; print tables and draw a picture."""

from pathlib import Path
from typing import Annotated

import typer

from shadefit.commands.options import Json


def ambient(
    out: Annotated[Path, typer.Option(help="Folder for ambient.png.")] = Path("build/figures"),
    json: Json = False,
) -> None:
    """Measure the errors of the ambient models, and their largest radiance in uniform light.

    Exact radiances are integrals of the whole BRDF. The picture shows the layer
    over all views, exact and by two models.
    """
    run(out, json)


def run(out: Path, json: bool) -> None:
    """Measure the ambient models, write `ambient.png`, and print tables or one JSON object."""
    from coefficients.files import require_writable, write_whole_bytes
    from shadefit.ambient.energy import largest_radiances
    from shadefit.ambient.errors import errors_with_phase_integral, model_errors
    from shadefit.ambient.models import model_rows
    from shadefit.ambient.radiances import materials_and_views, radiances
    from shadefit.ambient.sheet import draw_ambient
    from shadefit.outputs import AmbientOutput
    from shadefit.progress import stages
    from shadefit.terminal import print_json

    require_writable(out)
    path = out / "ambient.png"
    with stages() as progress:
        stage = progress.begin("exact radiances by quadrature", total=3)
        found = radiances(materials_and_views())
        stage.advance()
        stage.show("models")
        models = model_rows(found)
        stage.advance()
        stage.show("picture")
        write_whole_bytes(path, draw_ambient())
    rows, with_integral = model_errors(found), errors_with_phase_integral(found)
    largest = largest_radiances(found)
    if json:
        record = {"points": len(found.points), "errors": rows, "models": models}
        others = {
            "energy": largest,
            "rms_without_symmetry": with_integral,
            "files": [str(path)],
        }
        print_json(AmbientOutput.model_validate({**record, **others}))
        return
    _print_errors(rows, with_integral, list(found.models), len(found.points))
    _print_models(models)
    _print_energy(largest, path)


def _print_errors(
    rows: list[dict], with_integral: dict[str, float], names: list[str], count: int
) -> None:
    from shadefit.terminal import place, print_table

    print_table(
        f"Error of the ambient model over {count:,} materials and views, relative to the mean",
        [
            *("part, light", "mean", *(f"rms, {name}" for name in names), "rms, lit p"),
            *("bias", "worst", "at"),
        ],
        [
            [
                f"{row['part']}, {row['light']}",
                f"{row['mean']:.4f}",
                *(f"{row['rms'][name]:.2%}" for name in names),
                f"{with_integral[row['light']]:.2%}" if row["part"] == "layer" else "—",
                f"{row['bias']['exact']:+.2%}",
                f"{row['worst']:+.1%}",
                place(row["where"]),
            ]
            for row in rows
        ],
        "White fibres, white base. rms by whose G, Q, R and P_s the model takes; lit p: exact "
        "ones, and the integral of p(u, v) over lights for 1 − P_s(v). Bias, worst: exact ones.",
        below=1,
    )


def _print_models(rows: list[dict]) -> None:
    from shadefit.terminal import print_table

    print_table(
        "rms error of models of the layer by light, relative to the mean, and operations of code",
        ["model", "P_s", "G", *rows[0]["rms"], "worst", "brightest", "operations"],
        [
            [
                *(row[key] for key in ("model", "scattered", "scattering")),
                *(f"{value:.2%}" for value in row["rms"].values()),
                f"{max(row['largest'].values()):.0%}",
                f"{row['brightest']:.4f}",
                str(sum(row["operations"].values())),
            ]
            for row in rows
        ],
        "White fibres. worst: the largest error in any light; brightest: the largest radiance in "
        "uniform light of radiance one; operations: those of the exported function with closed "
        "form and best/g-17, base included. Models from mean-cosine on have a P_s of their own.",
        below=1,
    )


def _print_energy(rows: list[dict], path: Path) -> None:
    from shadefit.terminal import place, print_table

    print_table(
        "Largest radiance in uniform light of radiance one",
        ["in", "largest", "at"],
        [[row["what"], f"{row['largest']:.4f}", place(row["where"])] for row in rows],
        f"Of the same points; {path}.",
        below=1,
    )

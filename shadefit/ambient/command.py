"""`shadefit ambient`: what the ambient model's approximations cost, as tables and a picture."""

from pathlib import Path

from coefficients.files import require_writable, write_whole_bytes
from shadefit.ambient.energy import energy
from shadefit.ambient.errors import errors, points, radiances, without_symmetry
from shadefit.ambient.sheet import draw_ambient
from shadefit.terminal import place, print_json, print_table, stages


def run(out: Path, as_json: bool) -> None:
    """Measure, print, and write `ambient.png`."""
    require_writable(out)
    with stages() as progress:
        task = progress.add_task("exact radiances by quadrature")
        found = radiances(points())
        progress.update(task, description="picture")
        path = out / "ambient.png"
        write_whole_bytes(path, draw_ambient())
    rows, sums, asymmetric = errors(found), energy(found), without_symmetry(found)
    if as_json:
        record = {"points": len(found.points), "errors": rows, "energy": sums}
        print_json({**record, "rms_without_symmetry": asymmetric, "file": str(path)})
        return
    names = list(found.models)
    print_table(
        f"Error of the ambient model over {len(found.points):,} materials and views, "
        "relative to the mean",
        [
            *("part, light", "mean", *(f"rms, {name}" for name in names), "rms, lit p"),
            *("bias", "worst", "at"),
        ],
        [
            [
                f"{row['part']}, {row['light']}",
                f"{row['mean']:.4f}",
                *(f"{row['rms'][name]:.2%}" for name in names),
                f"{asymmetric[row['light']]:.2%}" if row["part"] == "layer" else "—",
                f"{row['bias']['exact']:+.2%}",
                f"{row['worst']:+.1%}",
                place(row["where"]),
            ]
            for row in rows
        ],
        "White fibres, white base. rms by whose G, Q, R and P_s the model takes; lit p: exact "
        "ones, and the integral of p(u, v) over lights for 1 − P_s(v). Bias, worst: exact ones.",
    )
    print_table(
        "Largest radiance in uniform light of radiance one",
        ["", "largest", "at"],
        [[row["what"], f"{row['largest']:.4f}", place(row["where"])] for row in sums],
        f"Of the same points; {path}.",
    )

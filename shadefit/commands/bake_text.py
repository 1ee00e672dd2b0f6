"""What `shadefit bake` prints: the texture beside the fits, and what a shader must know of it."""

from shadefit.outputs import BakeOutput
from shadefit.terminal import place, print_table

_COLUMNS = ["by", "bytes", "fetches", "operations", "rms", "largest", "only for"]


def print_bake(report: BakeOutput) -> None:
    """Print the costs and the errors of a texture and of the tables of its quantity."""
    size = "×".join(map(str, report.size))
    errors = report.errors
    rows = [
        [
            f"LUT {size}, {report.texel}, {report.filter}",
            *(str(report.bytes), str(report.fetches), str(report.operations)),
            *(f"{errors.rms:.3e}", f"{errors.max:.3e}", ""),
        ]
    ]
    if report.table is not None:
        rows.append([report.source, *_cost(report.table), ""])
    for each in report.tables:
        name = f"{each.table}, refitted" if each.kind == "refitted" else each.table
        ends = each.domain.items()
        domain = ", ".join(f"{axis} in [{low:.4g}, {high:.4g}]" for axis, (low, high) in ends)
        if name != report.source:
            rows.append([name, *_cost(each), domain])
    print_table(f"{report.file}: {report.source}", _COLUMNS, rows, "\n".join(_lines(report)))


def _cost(each) -> list[str]:
    return [str(each.bytes), "0", str(each.operations), f"{each.rms:.3e}", f"{each.max:.3e}"]


def _lines(report: BakeOutput) -> list[str]:
    """Return the lines below the table: how texels are placed, and which fit is as good."""
    axes = ", ".join(
        f"{each.name} in [{each.domain[0]:.6g}, {each.domain[1]:.6g}] ({each.scale})"
        for each in report.axes
    )
    filtered = (
        "Catmull–Rom filter in the shader."
        if report.filter == "cubic"
        else f"Filter with {report.weight_bits} fractional bits, as in hardware."
    )
    lines = [
        f"Texels over {axes}; centres: {report.centres}. {filtered} "
        f"Rounding to {report.texel} changes texels by at most {report.rounding:.1e}. "
        f"Largest error at {place(report.errors.where or {})}."
    ]
    texts = zip("uvw", (axis.coordinate for axis in report.axes), strict=False)
    lines.append(f"Texture coordinates: {', '.join(f'{u} = {text}' for u, text in texts)}.")
    if report.span != [0.0, 1.0]:
        low, high = report.span
        lines.append(f"A value is {low!r} + {high - low!r} times the texel.")
    if report.moved_texels:
        lines.append(
            f"{report.moved_texels} texels have no value of their own: they have that of a point a "
            "tenth of a texel further in."
        )
    if report.table is not None:
        apart = report.table.largest_difference
        lines.append(f"The LUT differs from {report.source} by at most {apart:.3e}.")
    if report.tables:
        whole = [each for each in report.tables if not each.domain]
        cheapest = next((each for each in whole if each.max <= report.errors.max), None)
        lines.append(
            "No table of this domain is as accurate."
            if cheapest is None
            else f"{cheapest.table} is at least as accurate, in {cheapest.operations} operations."
        )
    return lines

"""`shadefit bake`: write a quantity or a table as a lookup texture, and compare it with fits."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from shadefit.commands.options import Json
from shadefit.completion import complete_shader

if TYPE_CHECKING:
    import numpy as np

    from coefficients.lut import Lut
    from fitting import Errors, FittedForm
    from integrals.reference import Axis
    from quantities import Problem

_SCALES = ("linear", "logarithmic", "square")


def bake(
    source: Annotated[
        str,
        typer.Argument(
            help="A quantity's name, or exact/NAME, for its exact values; or a table's name or "
            "path, for the table's values.",
            autocompletion=complete_shader,
        ),
    ],
    size: Annotated[str, typer.Option(help="Texels along each argument: 256, 64x64, 32x32x16.")],
    format: Annotated[
        Literal["exr", "png16", "npy", "csv", "dds", "ktx2"], typer.Option(help="File format.")
    ],
    texel: Annotated[
        Literal["float32", "float16", "unorm16", "unorm8"] | None,
        typer.Option(help="Type of the texels; by default the format's usual one."),
    ] = None,
    filter: Annotated[
        Literal["linear", "cubic"],
        typer.Option(help="linear: one fetch; cubic: Catmull–Rom, 4, 16 or 64 fetches."),
    ] = "linear",
    centres: Annotated[
        Literal["ends", "half"],
        typer.Option(
            help="Place of the first and last texel centres: at the ends of an argument's domain, "
            "or half a texel from them."
        ),
    ] = "ends",
    domain: Annotated[
        list[str] | None,
        typer.Option(
            "--range",
            help="Domain of an argument, and how texels are distributed over it: "
            "NAME=LOW:HIGH[:linear|logarithmic|square]. May be given again.",
            metavar="RANGE",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="File to write; by default SOURCE.EXTENSION.")
    ] = None,
    json: Json = False,
) -> None:
    """Write a lookup texture (LUT) of a quantity or of a table.

    Prints its bytes, its fetches, and its errors against exact values, beside those of the tables
    of the quantity. A refitted table is baked by the path of its file, as its name is also that of
    the quantity. By default the domain is that of the table, or of the quantity's default form.
    """
    from coefficients.files import require_writable_file, write_whole_bytes
    from coefficients.lut import bake as bake_lut
    from coefficients.lut import errors_of, require_format, write_lut
    from coefficients.lut.beside import coefficient_bytes, difference_from, tables_beside
    from coefficients.lut.files import EXTENSIONS
    from fitting import Domain, judge
    from shadefit.progress import stages

    counts = _size(size)
    made = _source(source)
    axes = _domain(made, domain or [])
    texel = require_format(format, texel, len(axes))
    default = Path(f"{Path(source).stem if made.is_file else source.replace('/', '-')}")
    path = out or default.with_suffix(f".{EXTENSIONS.get(format, format)}")
    require_writable_file(path)
    with stages() as progress:
        progress.begin(f"{source}: texels and errors")
        lut = bake_lut(made.values, axes, counts, filter, texel, centres)
        data = write_lut(lut, format)
        where = Domain(made.owner.reference, axes)
        errors = errors_of(lut, where.reference)
        own = None if made.fitted is None else judge(made.fitted, where)
        others = tables_beside(made.owner, where)
    write_whole_bytes(path, data)
    report = _report(source, path, format, lut, errors)
    if own is not None and made.fitted is not None:
        report["table"] = {
            "rms": own.rms,
            "max": own.largest,
            "bytes": coefficient_bytes(made.fitted),
            "operations": made.operations,
            "largest_difference": difference_from(lut, made.fitted, where),
        }
    report["tables"] = [
        {
            **{key: value for key, value in asdict(each).items() if key != "largest"},
            "max": each.largest,
        }
        for each in others
    ]
    _show(report, json)


@dataclass(frozen=True)
class _Source:
    """What is baked: the exact values of a quantity, or a table's values if it is fitted."""

    owner: "Problem"
    fitted: "FittedForm | None" = None
    operations: int = 0
    is_file: bool = False

    @property
    def axes(self) -> "tuple[Axis, ...]":
        return self.owner.default.axes if self.fitted is None else self.fitted.axes

    def values(self, points: "np.ndarray") -> "np.ndarray":
        import numpy as np

        from fitting import form_values
        from integrals.many_points import estimates_at_many

        if self.fitted is not None:
            return form_values(self.fitted, points)
        return np.asarray(estimates_at_many(self.owner.reference, points).value)


def _source(name: str) -> _Source:
    from coefficients.catalogue import EXACT, resolve
    from coefficients.exported_code import operations_of
    from quantities import problems

    quantity = name.removeprefix(f"{EXACT}/")
    if quantity in problems():
        return _Source(problems()[quantity])
    entry = resolve(name)
    return _Source(
        entry.problem, entry.require_fitted(), operations_of(entry), entry.kind == "file"
    )


def _size(text: str) -> list[int]:
    parts = text.lower().split("x")
    if not all(part.isdecimal() for part in parts):
        raise ValueError(f"size {text!r}: allowed are numbers of texels, such as 256 or 64x64")
    return [int(part) for part in parts]


def _domain(made: _Source, given: list[str]) -> "tuple[Axis, ...]":
    """Return the axes of the LUT: those of the source, with the domains and scales that are given.

    Exact values may be baked in the quantity's whole domain, a table in its own.
    """
    from dataclasses import replace

    from coefficients.lut import scaled_for_lut
    from integrals.reference import restricted

    full = {axis.name: axis for axis in made.owner.axes if made.fitted is None}
    chosen = {axis.name: axis for axis in made.axes}
    scales: dict[str, Any] = {}
    for text in given:
        name, ends, scale = _range(text)
        name = next((a.name for a in made.axes if name in (a.name, a.alias, a.symbol)), name)
        whole = tuple((chosen | full).values())
        found = {axis.name: axis for axis in restricted(whole, **{name: ends})}
        chosen[name] = found[name]
        scales |= {} if scale is None else {name: scale}
    return tuple(
        replace(axis, scale=scales.get(axis.name, axis.scale))
        for axis in scaled_for_lut(list(chosen.values()))
    )


def _range(text: str) -> tuple[str, tuple[float, float], str | None]:
    from shadefit.commands.options import angle

    name, _, rest = text.partition("=")
    parts = rest.split(":")
    if not (len(parts) == 2 or (len(parts) == 3 and parts[2] in _SCALES)):
        raise ValueError(f"range {text!r}: allowed is NAME=LOW:HIGH[:{'|'.join(_SCALES)}]")
    try:
        low, high = (angle(part) for part in parts[:2])
    except typer.BadParameter:
        raise ValueError(f"range {text!r}: allowed are two numbers or angles") from None
    return name.replace("-", "_"), (low, high), parts[2] if len(parts) == 3 else None


def _report(source: str, path: Path, kind: str, lut: "Lut", errors: "Errors") -> dict[str, Any]:
    return {
        "file": str(path),
        "format": kind,
        "source": source,
        "size": list(lut.size),
        "axes": [
            {
                "name": axis.name,
                "domain": [axis.lower, axis.upper],
                "unit": axis.unit,
                "scale": axis.scale,
                "coordinate": each.text(axis.name),
            }
            for axis, each in zip(lut.axes, lut.coordinates, strict=True)
        ],
        "texel": lut.texel,
        "span": list(lut.span),
        "filter": lut.filter,
        "centres": lut.centres,
        "weight_bits": lut.weight_bits if lut.filter == "linear" else None,
        "bytes": lut.bytes,
        "fetches": lut.fetches,
        "operations": lut.operations,
        "moved_texels": lut.moved,
        "rounding": lut.rounding,
        "rms": errors.rms,
        "max": errors.largest,
        "where": errors.where,
    }


def _show(report: dict[str, Any], json: bool) -> None:
    from shadefit.terminal import place, print_json, print_table

    if json:
        from shadefit.outputs import BakeOutput

        errors = {key: report[key] for key in ("rms", "max", "where")}
        rest = {key: value for key, value in report.items() if key not in errors}
        print_json(BakeOutput.model_validate({"table": None, **rest, "errors": errors}))
        return
    size = "×".join(map(str, report["size"]))
    label = f"LUT {size}, {report['texel']}, {report['filter']}"
    row = [label, str(report["bytes"]), str(report["fetches"]), str(report["operations"])]
    rows = [[*row, f"{report['rms']:.3e}", f"{report['max']:.3e}", ""]]
    if "table" in report:
        own = report["table"]
        cost = [str(own["bytes"]), "0", str(own["operations"])]
        rows.append([report["source"], *cost, f"{own['rms']:.3e}", f"{own['max']:.3e}", ""])
    for each in report["tables"]:
        domain = ", ".join(
            f"{name} in [{low:.4g}, {high:.4g}]" for name, (low, high) in each["domain"].items()
        )
        cost = [str(each["bytes"]), "0", str(each["operations"])]
        name = f"{each['table']}, refitted" if each["kind"] == "refitted" else each["table"]
        if name == report["source"]:
            continue
        rows.append([name, *cost, f"{each['rms']:.3e}", f"{each['max']:.3e}", domain])
    columns = ["by", "bytes", "fetches", "operations", "rms", "largest", "only for"]
    print_table(f"{report['file']}: {report['source']}", columns, rows, _note(report, place))


def _filtered(report: dict[str, Any]) -> str:
    if report["filter"] == "cubic":
        return "Catmull–Rom filter in the shader."
    return f"Filter with {report['weight_bits']} fractional bits, as in hardware."


def _note(report: dict[str, Any], place: Callable[[dict[str, float]], str]) -> str:
    """Return the lines below the table: how texels are placed, and which fit is as good."""
    axes = ", ".join(
        f"{axis['name']} in [{axis['domain'][0]:.6g}, {axis['domain'][1]:.6g}] ({axis['scale']})"
        for axis in report["axes"]
    )
    lines = [
        f"Texels over {axes}; centres: {report['centres']}. "
        f"{_filtered(report)} "
        f"Rounding to {report['texel']} changes texels by at most {report['rounding']:.1e}. "
        f"Largest error at {place(report['where'])}."
    ]
    coordinates = (axis["coordinate"] for axis in report["axes"])
    texts = zip("uvw", coordinates, strict=False)
    lines.append(f"Texture coordinates: {', '.join(f'{u} = {text}' for u, text in texts)}.")
    if report["span"] != [0.0, 1.0]:
        low, high = report["span"]
        lines.append(f"A value is {low!r} + {high - low!r} times the texel.")
    if report["moved_texels"]:
        count = report["moved_texels"]
        lines.append(f"{count} texels without a value have that a tenth of a texel further in.")
    if "table" in report:
        apart = report["table"]["largest_difference"]
        lines.append(f"The LUT differs from {report['source']} by at most {apart:.3e}.")
    if report["tables"]:
        whole = [each for each in report["tables"] if not each["domain"]]
        cheapest = next((each for each in whole if each["max"] <= report["max"]), None)
        lines.append(
            "No table of this domain has a largest error that is no larger."
            if cheapest is None
            else f"{cheapest['table']} needs {cheapest['operations']} operations for a largest "
            "error that is no larger."
        )
    return "\n".join(lines)

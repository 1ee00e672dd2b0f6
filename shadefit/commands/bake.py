"""`shadefit bake`: write a quantity or a table as a lookup texture, and compare it with fits."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from shadefit.commands.options import Json
from shadefit.completion import complete_shader

if TYPE_CHECKING:
    import numpy as np

    from fitting import FittedForm
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
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="File to write, or - for standard output; by default SOURCE.EXTENSION.",
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Write a lookup texture (LUT) of a quantity or of a table.

    Prints its bytes, its fetches, and its errors against exact values, beside
    those of the tables of the quantity. A refitted table is baked by the path of
    its file, as its name is also that of the quantity. By default the domain is
    that of the table, or of the quantity's default form.
    """
    from coefficients.files import require_writable_file, write_whole_bytes
    from coefficients.lut import bake as bake_lut
    from coefficients.lut import errors_of, require_format, write_lut
    from coefficients.lut.beside import coefficient_bytes, difference_from, tables_beside
    from coefficients.lut.files import EXTENSIONS
    from fitting import Domain, judge
    from shadefit.commands.bake_text import print_bake
    from shadefit.commands.table_records import errors_record
    from shadefit.outputs import BakedAxis, BakeOutput, BakeSource, BesideTable
    from shadefit.progress import stages
    from shadefit.terminal import messages_beside, print_json

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
    table = None
    if own is not None and made.fitted is not None:
        table = BakeSource(
            rms=own.rms,
            max=own.largest,
            bytes=coefficient_bytes(made.fitted),
            operations=made.operations,
            largest_difference=difference_from(lut, made.fitted, where),
        )
    report = BakeOutput(
        file=str(path),
        format=format,
        source=source,
        axes=[
            BakedAxis(
                name=axis.name,
                domain=[axis.lower, axis.upper],
                unit=axis.unit,
                scale=axis.scale,
                coordinate=each.text(axis.name),
            )
            for axis, each in zip(lut.axes, lut.coordinates, strict=True)
        ],
        size=list(lut.size),
        texel=lut.texel,
        span=list(lut.span),
        filter=lut.filter,
        centres=lut.centres,
        weight_bits=lut.weight_bits if lut.filter == "linear" else None,
        bytes=lut.bytes,
        fetches=lut.fetches,
        operations=lut.operations,
        moved_texels=lut.moved,
        rounding=lut.rounding,
        errors=errors_record(errors),
        table=table,
        tables=[
            BesideTable(
                table=each.table,
                kind=each.kind,
                bytes=each.bytes,
                operations=each.operations,
                rms=each.rms,
                max=each.largest,
                domain={name: list(ends) for name, ends in each.domain.items()},
            )
            for each in others
        ],
    )
    with messages_beside(path):
        if json:
            print_json(report)
        else:
            print_bake(report)


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
    from quantities import problem
    from quantities.registry import names

    quantity = name.removeprefix(f"{EXACT}/")
    if quantity in names():
        return _Source(problem(quantity))
    entry = resolve(name)
    return _Source(
        entry.problem, entry.require_fitted(), operations_of(entry), entry.kind == "file"
    )


def _size(text: str) -> list[int]:
    parts = text.lower().split("x")
    if not all(part.isascii() and part.isdecimal() for part in parts):
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

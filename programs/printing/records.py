"""Writing structures that hold the results of one function for another one."""

from collections.abc import Sequence

from programs.functions import Function, Parameter, Record
from programs.languages import Language
from programs.printing.line_breaking import INDENT, Break, Tokens

_VECTOR = 4


def record_of(language: Language, holder: Function | Parameter) -> Record | None:
    """Return the structure of a function's results or of a parameter, if the language has any."""
    return holder.record if language.record_opening is not None else None


def record_declarations(
    language: Language, precision: str, functions: Sequence[Function]
) -> list[list[str]]:
    """Write the types of all structures that functions return or take, each as lines of code.

    Raises ValueError for a layout that the language does not have, and for two structures of the
    same name that differ.
    """
    sizes: dict[str, tuple[Record, int]] = {}
    for function in functions:
        holders = [(function.record, function.result)]
        holders += [(parameter.record, parameter.size) for parameter in function.parameters]
        for record, size in holders:
            if record is None or size is None:
                continue
            _require_layout(language, precision, record)
            if sizes.setdefault(record.name, (record, size)) != (record, size):
                raise ValueError(f"structure {record.name!r} occurs twice; allowed: once")
    if language.record_opening is None:
        return []
    return [_declaration(language, precision, *each) for each in sizes.values()]


def empty_components(record: Record, size: int) -> list[str]:
    """Return the components of a structure that hold no result: the rest of the last vector."""
    if record.vectors or record.layout != "vec4":
        return []
    return [record.place(index) for index in range(size, -(-size // _VECTOR) * _VECTOR)]


def in_threes(values: list[Tokens], language: Language) -> list[Tokens]:
    """Put the components of each vector together."""
    opening, closing = language.return_three.split("{values}")
    return [
        [opening, *x, ",", Break(), *y, ",", Break(), *z, closing]
        for x, y, z in zip(values[::3], values[1::3], values[2::3], strict=True)
    ]


def _declaration(language: Language, precision: str, record: Record, size: int) -> list[str]:
    kind, member = language.types[precision], record.member
    if record.vectors:
        three, extent = language.triple(precision).type_and_extent(kind)
        template = language.record_number if extent is None else language.record_array
        members = [template.format(type=three, name=each, size=extent) for each in record.vectors]
    elif record.layout == "array":
        members = [language.record_array.format(type=kind, name=member, size=size)]
    else:
        vector = record.layout == "vec4"
        kind = language.vectors[precision] if vector else kind
        count = -(-size // _VECTOR) if vector else size
        members = [
            language.record_number.format(type=kind, name=f"{member}{index}")
            for index in range(count)
        ]
    assert language.record_opening is not None
    opening = language.record_opening.format(name=record.name)
    closing = language.record_closing.format(name=record.name)
    return [opening, *(INDENT + each for each in members), closing]


def _require_layout(language: Language, precision: str, record: Record) -> None:
    if record.vectors:
        return
    allowed = ["array"]
    if language.record_opening is not None:
        allowed.append("struct")
    if precision in language.vectors:
        allowed.append("vec4")
    if record.layout not in allowed:
        raise ValueError(
            f"layout {record.layout!r} is not in {language.name} at {precision} precision; "
            f"allowed: {', '.join(allowed)}"
        )

"""The report's tables in HTML: what each table costs and is worth, its errata, where it is from."""

import re
from collections.abc import Sequence
from html import escape

from coefficients.catalogue import AS_PRINTED, load, names
from coefficients.proven import proven
from coefficients.shaders import EXACT_PS, shader
from coefficients.table import Table
from integrals import INTEGRALS
from programs.cost import count
from programs.tracing.tracer import trace
from shadefit.figures.frontier import Mark, marks
from shadefit.figures.style import KINDS
from shadefit.figures.values import kind_of, quantities, tables_of

_COLUMNS = (
    "table",
    "form",
    "coefficients",
    "operations",
    "rms error",
    "ratio",
    "largest error",
    "ratio",
    "proven",
)
_NORMS = {"l2": "rms", "linf": "largest"}
_TEXT = ' class="text"'


def summary(chosen: Sequence[str]) -> str:
    """Give the table of all tables of some quantities: form, operations, errors, certificates."""
    head = "".join(
        f'<th scope="col"{_TEXT if column == "form" else ""}>{column}</th>' for column in _COLUMNS
    )
    rows = [row for quantity in chosen for row in _group(quantity)]
    return (
        '<div class="scroll" tabindex="0" role="group" aria-label="All tables">\n'
        f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n" + "\n".join(rows) + "\n</tbody>\n"
        "</table>\n</div>\n"
        '<p class="note">Operations: of the exported functions, once for a material and then for '
        "each direction where there are two. The closed form has the error of float32, in which it "
        "is evaluated. Errors are measured on the published table's domain (α ≥ 0.15): "
        "'shadefit list' gives those of a -wide table over its own. What is proven holds on a "
        "table's whole domain, between the nodes too; r, which has no published table, is "
        "measured on its own.</p>"
    )


def _group(quantity: str) -> list[str]:
    integral = INTEGRALS[quantity]
    span = len(_COLUMNS)
    title = f"{integral.symbol} = {integral.definition}, {integral.meaning}"
    order = list(KINDS)
    every = sorted(_marks(quantity), key=lambda mark: (order.index(mark.kind), mark.operations))
    base = next((mark for mark in every if mark.name == f"published/{quantity}"), None)
    head = f'<tr class="group"><th colspan="{span}" scope="colgroup">{markup(title)}</th></tr>'
    return [head, *(_row(mark, base, quantity) for mark in every)]


def _marks(quantity: str) -> tuple[Mark, ...]:
    """Give the marks of a quantity; where nothing is published, with the tables' own errors."""
    if quantity in quantities():
        return marks(quantity)
    found = []
    for name in tables_of(quantity):
        errors = load(name).errors
        if errors is not None:
            operations = count(trace(shader(name).functions[-1])).operations
            own = errors.off_grid
            found.append(Mark(name, kind_of(name), operations, own.max, own.rms))
    return tuple(found)


def _row(mark: Mark, base: Mark | None, quantity: str) -> str:
    table = None if mark.kind == "exact" else load(mark.name)
    cells = [
        table.equation if table else "closed form",
        str(table.size) if table else "0",
        _operations(mark, quantity),
        f"{mark.rms:.3e}",
        f"{mark.rms / base.rms:.3g}" if base else "—",
        f"{mark.largest:.3e}",
        f"{mark.largest / base.largest:.3g}" if base else "—",
        _certificate(table),
    ]
    first = f"<td{_TEXT}>{markup(cells[0])}</td>"
    rest = "".join(f"<td>{escape(cell)}</td>" for cell in cells[1:])
    return f'<tr><th scope="row">{escape(mark.name)}</th>{first}{rest}</tr>'


def _operations(mark: Mark, quantity: str) -> str:
    name = EXACT_PS if mark.kind == "exact" else mark.name
    if mark.kind == "exact" and quantity != "ps":
        return str(mark.operations)
    before = shader(name).functions[:-1]
    costs = [str(count(trace(each)).operations) for each in before]
    return " + ".join([*costs, str(mark.operations)])


def _certificate(table: Table | None) -> str:
    return "—" if table is None else "; ".join(proven(table.certificates)) or "—"


def errata() -> str:
    """Give the errata that the published tables record, as lists."""
    lines = []
    for name in names():
        publication = load(name).publication
        if publication is None or name.endswith(AS_PRINTED):
            continue
        lines.append(f"<h3>{escape(name)}</h3>")
        lines.append(f'<p class="faint">{escape(publication.listing)}</p>')
        for erratum in publication.errata:
            entries = {
                "where": erratum.where,
                "printed": erratum.printed,
                "corrected": erratum.corrected,
                "why": erratum.why,
            }
            lines.append(_list(entries))
        if not publication.errata:
            lines.append("<p>None known.</p>")
    return "\n".join(lines)


def provenance() -> str:
    """Give, for every table, what made it: source or command, grid, reference, versions."""
    return "\n".join(
        f"<h3>{escape(name)}</h3>\n{_list(_origin(load(name)))}"
        for name in names()
        if not name.endswith(AS_PRINTED)
    )


def _origin(table: Table) -> dict[str, str | None]:
    if table.publication is not None:
        appendix = f"appendix {table.publication.appendix}, {table.publication.listing}"
        return {"source": table.publication.source, "printed in": appendix}
    entries: dict[str, str | None] = {}
    recorded = table.model_dump(exclude_none=True)
    if table.grid is not None:
        nodes = [f"{n.count} {n.spacing} nodes of {n.argument}" for n in table.grid.nodes]
        if table.grid.directions:
            nodes.append(f"{table.grid.directions} lights each")
        if "points" in recorded["grid"]:
            nodes.append(f"{recorded['grid']['points']} scattered points")
        entries["fitted on"] = ", ".join(nodes)
    if "goal" in recorded:
        entries["made small"] = _goal(recorded["goal"])
    if table.weight is not None:
        entries["weight"] = table.weight
    if table.reference is not None:
        leg = table.reference.leg.replace("_", " ")
        entries["exact values"] = f"{leg}, error at most {table.reference.error:.1e}"
    if table.provenance is not None:
        entries["command"] = table.provenance.command
        entries["solver"] = table.provenance.solver
        versions = [f"{name} {version}" for name, version in table.provenance.versions.items()]
        entries["versions"] = ", ".join(versions)
    return entries


def _goal(goal: dict) -> str:
    words = [f"the {_NORMS[goal['norm']]} {'relative' if goal['relative'] else 'absolute'} error"]
    if goal["side"] != "both":
        words.append(f"staying {goal['side']} the exact values")
    if goal["bounded"]:
        words.append("values between 0 and 1")
    if goal["rounding"] != "none":
        words.append(f"coefficients rounded to {goal['rounding']}")
    return ", ".join(words)


def _list(entries: dict[str, str | None]) -> str:
    lines = [
        f"<dt>{escape(label)}</dt><dd>{escape(text)}</dd>"
        for label, text in entries.items()
        if text is not None
    ]
    return "<dl>\n" + "\n".join(lines) + "\n</dl>"


def markup(text: str) -> str:
    """Escape a text for HTML and set what stands behind '_' as a subscript: P_s, ∫_Ω."""
    return re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text))

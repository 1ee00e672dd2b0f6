"""The report's tables in HTML: the cost and errors of each table, its errata, and its origin."""

import re
from collections.abc import Mapping, Sequence
from html import escape

from coefficients.catalogue import EXACT, Entry, entries, published, resolve
from coefficients.exported_code import programs_of
from coefficients.frontier import Mark, mark_of, marks
from coefficients.proof_text import proofs
from coefficients.table import Table
from programs import count_operations
from quantities import Problem
from shadefit.figures.style import KINDS
from shadefit.memory import give_back

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


def summary(chosen: Sequence[Problem], more: Sequence[Entry] = ()) -> str:
    """Return the table of all tables of some quantities: form, operations, errors and proofs.

    `more` are tables that are not packaged.
    """
    head = "".join(
        f'<th scope="col"{_TEXT if column == "form" else ""}>{column}</th>' for column in _COLUMNS
    )
    rows = []
    for owner in chosen:
        rows += _group(owner, more)
        give_back()
    return (
        '<div class="scroll" tabindex="0" role="group" aria-label="All tables">\n'
        f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n" + "\n".join(rows) + "\n</tbody>\n"
        "</table>\n</div>\n"
        '<p class="note">Operations are those of the exported functions. Two numbers are the '
        "operations for a material, and then for each direction. The error of a closed form is "
        "that of its evaluation in float32. Errors are measured on the domain of the published "
        "table (α ≥ 0.15 for P<sub>s</sub> and R); 'shadefit list' gives the error of a -wide "
        "table on its own domain. If a quantity has no published table, each table is measured "
        "on its own domain. Proofs hold on the whole domain of a table, also between the "
        "nodes.</p>"
    )


def _group(owner: Problem, more: Sequence[Entry]) -> list[str]:
    """Return the rows of a quantity: its definition, its tables, and its closed form."""
    span = len(_COLUMNS)
    order = [*KINDS, "file"]
    own = {entry.name: entry for entry in more if entry.problem is owner}
    every = [*marks(owner), *(mark_of(entry) for entry in own.values())]
    every.sort(key=lambda mark: (order.index(mark.kind), mark.operations))
    base = published(owner)
    first = next((mark for mark in every if base and mark.name == base.name), None)
    head = (
        f'<tr class="group"><th colspan="{span}" scope="colgroup">{markup(_title(owner))}</th></tr>'
    )
    if not every:
        return [head, f'<tr><td colspan="{span}"{_TEXT}>There is no table.</td></tr>']
    return [head, *(_row(mark, first, _entry(mark, owner, own)) for mark in every)]


def _title(owner: Problem) -> str:
    """Return a text that says what a quantity is: 'Q = (1/π) ∫_Ω …, average chance …'."""
    reference = owner.reference
    defined = f"{owner.symbol} = {reference.definition}" if reference.definition else owner.symbol
    of_data = f"data of {reference.data.source}" if reference.data is not None else ""
    return ", ".join(part for part in (defined, reference.meaning, of_data) if part)


def _entry(mark: Mark, owner: Problem, own: Mapping[str, Entry]) -> Entry:
    if mark.kind == "exact":
        return resolve(f"{EXACT}/{owner.name}")
    return own.get(mark.name) or resolve(mark.name)


def _form(entry: Entry) -> str:
    """Return where a form is printed, or else its name."""
    return (
        "closed form"
        if entry.fitted is None
        else entry.fitted.form.printed or entry.fitted.form.name
    )


def _row(mark: Mark, base: Mark | None, entry: Entry) -> str:
    table = entry.table
    cells = [
        _form(entry),
        str(table.size) if table else "0",
        _operations(entry),
        f"{mark.rms:.3e}",
        f"{mark.rms / base.rms:.3g}" if base else "—",
        f"{mark.largest:.3e}",
        f"{mark.largest / base.largest:.3g}" if base else "—",
        _proofs(entry),
    ]
    first = f"<td{_TEXT}>{markup(cells[0])}</td>"
    rest = "".join(f"<td>{escape(cell)}</td>" for cell in cells[1:])
    return f'<tr><th scope="row">{escape(mark.name)}</th>{first}{rest}</tr>'


def _operations(entry: Entry) -> str:
    """Return the operations of each exported function, in the order of their calls: '520 + 13'."""
    return " + ".join(
        str(count_operations(each).operations) for each in programs_of(entry, "float")
    )


def _proofs(entry: Entry) -> str:
    return "—" if entry.table is None else "; ".join(proofs(entry)) or "—"


def errata() -> str:
    """Return the errata that the published tables record, as lists."""
    lines = []
    for entry in entries():
        publication = entry.require_table().publication
        if publication is None or entry.kind == "printed":
            continue
        lines.append(f"<h3>{escape(entry.name)}</h3>")
        if publication.listing:
            lines.append(f'<p class="faint">{escape(publication.listing)}</p>')
        for erratum in publication.errata:
            lines.append(
                _list(
                    {
                        "where": erratum.where,
                        "printed": erratum.printed,
                        "corrected": erratum.corrected,
                        "why": erratum.why,
                    }
                )
            )
        if not publication.errata:
            lines.append("<p>None known.</p>")
    return "\n".join(lines)


def provenance(more: Sequence[Entry] = ()) -> str:
    """Return the origin of every table: source or command, grid, exact values, versions.

    What several tables have in common is said once, with their names.
    """
    tables = {e.name: e.require_table() for e in (*entries(), *more) if e.kind != "printed"}
    facts: dict[str, dict[str, list[str]]] = {}
    for name, table in tables.items():
        for label, text in _origin(table).items():
            if text is not None:
                # The same command with the names of several tables is one fact.
                words = ["NAME" if word == name else word for word in text.split(" ")]
                said = " ".join(words) if label == "command" else text
                facts.setdefault(label, {}).setdefault(said, []).append(name)
    return "\n".join(_facts(label, texts) for label, texts in facts.items())


def _facts(label: str, texts: Mapping[str, list[str]]) -> str:
    lines = [
        f'<li>{escape(text)}: <span class="faint">{escape(", ".join(names))}</span></li>'
        for text, names in texts.items()
    ]
    return (
        f"<h3>{escape(label[:1].upper() + label[1:])}</h3>\n<ul>\n" + "\n".join(lines) + "\n</ul>"
    )


def _origin(table: Table) -> dict[str, str | None]:
    if table.publication is not None:
        appendix, listing = table.publication.appendix, table.publication.listing
        places = [f"appendix {appendix}" if appendix else "", listing]
        printed = ", ".join(place for place in places if place)
        return {"source": table.publication.source, "printed in": printed or None}
    found: dict[str, str | None] = {}
    recorded = table.model_dump(exclude_none=True)
    if table.grid is not None:
        nodes = [f"{n.count} {n.spacing} nodes of {n.argument}" for n in table.grid.nodes]
        if table.grid.directions:
            nodes.append(f"{table.grid.directions} lights each")
        if "points" in recorded["grid"]:
            nodes.append(f"{recorded['grid']['points']} scattered points")
        found["fitted on"] = ", ".join(nodes)
    if "goal" in recorded:
        found["made small"] = _goal(recorded["goal"])
    if table.weight is not None:
        found["weight"] = table.weight
    if table.reference is not None:
        leg = table.reference.leg.replace("_", " ")
        found["exact values"] = f"{leg}, error at most {table.reference.error:.1e}"
    if table.provenance is not None:
        found["command"] = table.provenance.command
        found["solver"] = table.provenance.solver
        versions = [f"{name} {version}" for name, version in table.provenance.versions.items()]
        found["versions"] = ", ".join(versions)
    return found


def _goal(goal: dict) -> str:
    words = [f"the {_NORMS[goal['norm']]} {'relative' if goal['relative'] else 'absolute'} error"]
    if goal["side"] != "both":
        words.append(f"staying {goal['side']} the exact values")
    if goal["bounded"]:
        words.append("only possible values")
    if goal["rounding"] != "none":
        words.append(f"coefficients rounded to {goal['rounding']}")
    return ", ".join(words)


def _list(terms: dict[str, str | None]) -> str:
    lines = [
        f"<dt>{escape(label)}</dt><dd>{escape(text)}</dd>"
        for label, text in terms.items()
        if text is not None
    ]
    return "<dl>\n" + "\n".join(lines) + "\n</dl>"


def markup(text: str) -> str:
    """Escape a text for HTML, and write the word after '_' as a subscript: P_s, ∫_Ω."""
    return re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text))

"""The report: one HTML page with the tables' errors and costs, all pictures, and the explorer."""

import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files

from coefficients.catalogue import Entry
from quantities import problems
from shadefit.figures import Picture, pictures
from shadefit.report import sections
from shadefit.report.explorer import explored, script
from shadefit.report.sections import markup


def page(drawn: Mapping[str, bytes], more: Sequence[Entry] = ()) -> str:
    """Return the report with the PNG files of pictures, by the names of the pictures.

    It is about the packaged tables, and those in `more`.
    """
    known = pictures()
    return assemble(
        sections.summary(list(problems().values()), more),
        "\n".join(figure(name, known[name], png) for name, png in drawn.items()),
        sections.errata(),
        sections.provenance(more),
        more,
    )


def assemble(
    summary: str, figures: str, errata: str, provenance: str, more: Sequence[Entry] = ()
) -> str:
    """Return the page with the explorer and these sections, each in HTML."""
    parts = {
        "style": _packaged("report.css"),
        "quantities": _choices(more),
        "summary": summary,
        "figures": figures,
        "errata": errata,
        "provenance": provenance,
        "script": script(more),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda slot: parts[slot[1]], _packaged("report.html"))


def figure(name: str, picture: Picture, png: bytes) -> str:
    """Return a picture with its title and caption, in HTML."""
    source = f"data:image/png;base64,{b64encode(png).decode()}"
    return (
        f'<figure id="figure-{name}">\n<h3>{markup(picture.title)}</h3>\n'
        f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(picture.title)}">'
        f'<img src="{source}" alt="{escape(picture.caption)}" width="{_width(png)}"></div>\n'
        f"<figcaption>{markup(picture.caption)}</figcaption>\n</figure>"
    )


def _packaged(name: str) -> str:
    return files("shadefit.report").joinpath(name).read_text(encoding="utf-8").rstrip()


def _choices(more: Sequence[Entry]) -> str:
    """Return a radio button for each quantity of the explorer."""
    lines = []
    for index, owner in enumerate(explored(more)):
        chosen = " checked" if index == 0 else ""
        lines.append(
            f'<label><input type="radio" name="quantity" value="{escape(owner.name)}"{chosen}> '
            f"{markup(owner.symbol)}</label>"
        )
    return "\n".join(lines)


def _width(png: bytes) -> int:
    # A PNG file begins with 8 bytes of signature, and the length and name of the first chunk, of 4
    # bytes each. That chunk begins with the width.
    return int.from_bytes(png[16:20], "big")

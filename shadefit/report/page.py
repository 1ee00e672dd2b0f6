"""`shadefit report`: one HTML file with the tables' worth, the figures and the explorer in it."""

import re
from base64 import b64encode
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from pathlib import Path

from coefficients.files import require_writable_file, write_whole
from integrals import INTEGRALS
from shadefit.figures import PICTURES, render
from shadefit.figures.values import quantities
from shadefit.report import sections as tables
from shadefit.report.explorer import script
from shadefit.report.sections import markup
from shadefit.terminal import stages


def run(out: Path) -> None:
    """Draw every picture and write the report; the same tables give the same bytes.

    Raises ValueError where the file cannot be written.
    """
    require_writable_file(out)
    drawn = {}
    with stages() as progress:
        task = progress.add_task("")
        for name, picture in PICTURES.items():
            progress.update(task, description=name)
            drawn[name] = render(picture.draw)["png"]
        progress.update(task, description="tables")
        write_whole(out, page(drawn))
    print(out)


def page(pictures: Mapping[str, bytes]) -> str:
    """Give the report with PNG files of pictures, by the name of the picture."""
    return assemble(
        tables.summary(list(INTEGRALS)),
        "\n".join(_figure(name, data) for name, data in pictures.items()),
        tables.errata(),
        tables.provenance(),
    )


def assemble(summary: str, figures: str, errata: str, provenance: str) -> str:
    """Give the page with the explorer and these sections, each in HTML."""
    parts = {
        "style": _packaged("report.css"),
        "quantities": _choices(),
        "summary": summary,
        "figures": figures,
        "errata": errata,
        "provenance": provenance,
        "script": script(),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda slot: parts[slot[1]], _packaged("report.html"))


def _packaged(name: str) -> str:
    return files("shadefit.report").joinpath(name).read_text(encoding="utf-8").rstrip()


def _choices() -> str:
    lines = []
    for index, name in enumerate(quantities()):
        chosen = " checked" if index == 0 else ""
        lines.append(
            f'<label><input type="radio" name="quantity" value="{name}"{chosen}> '
            f"{markup(INTEGRALS[name].symbol)}</label>"
        )
    return "\n".join(lines)


def _figure(name: str, png: bytes) -> str:
    picture = PICTURES[name]
    source = f"data:image/png;base64,{b64encode(png).decode()}"
    return (
        f'<figure id="figure-{name}">\n<h3>{markup(picture.title)}</h3>\n'
        f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(picture.title)}">'
        f'<img src="{source}" alt="{escape(picture.caption)}" width="{_width(png)}"></div>\n'
        f"<figcaption>{markup(picture.caption)}</figcaption>\n</figure>"
    )


def _width(png: bytes) -> int:
    # Of the first chunk: four bytes of width stand behind signature, length and name.
    return int.from_bytes(png[16:20], "big")

"""What the site adds to the pages of the checkout: its navigation, its start, and the commands."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).parents[2]
# Caption -> pages in the order of the navigation. A page that does not exist is left out.
NAVIGATION = {
    "Guides": ("docs/own-integral", "docs/gallery", "docs/site/explorer"),
    "Reference": (
        "docs/site/commands",
        "docs/json",
        "docs/table-format",
        "docs/performance",
        "docs/site/api",
    ),
    "Mathematics": (
        *("docs/closed-form", "docs/range", "docs/certify", "docs/r-theorem", "docs/brdf"),
        "docs/ambient-light",
        *("docs/microfacet", "docs/microfacet-sampling", "docs/piecewise-ndf"),
        *(
            "docs/sggx-maps",
            "docs/sggx-encodings",
            "docs/detail-maps",
            "docs/skin",
            "docs/curvature",
        ),
    ),
    "Project": ("CONTRIBUTING", "CHANGELOG"),
}
START = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>shadefit</title>
<meta http-equiv="refresh" content="0; url=README.html">
<a href="README.html">shadefit</a>
"""


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive of the commands, and what is done before and after the build."""
    app.add_directive("shadefit-commands", Commands)
    app.connect("source-read", add_navigation)
    app.connect("autodoc-process-docstring", as_restructured_text)
    app.connect("autodoc-process-signature", shorten_defaults)
    app.connect("build-finished", write_start)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def add_navigation(app: Sphinx, page: str, source: list[str]) -> None:
    """Add the navigation to the README, where no reader of the file itself would see its use."""
    if page != app.config.root_doc:
        return
    known = app.env.found_docs
    for caption, pages in NAVIGATION.items():
        listed = "\n".join(f"/{each}" for each in pages if each in known)
        source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n```\n"


def as_restructured_text(
    _app: Sphinx, _kind: str, _name: str, _object: Any, _how: Any, lines: list
) -> None:
    """Write what differs from Markdown in a docstring: |x|, which stands for itself, and code."""
    for index, line in enumerate(lines):
        # Every second part is code between backticks.
        parts = line.split("`")
        parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
        lines[index] = "`".join(parts)
    # Indented by four after an empty line, it is code, as in Markdown.
    for index in range(len(lines) - 1, 1, -1):
        before, empty, line = lines[index - 2 : index + 1]
        if line.startswith("    ") and not empty.strip() and not before.startswith(" "):
            lines[index - 1 : index] = ["", "::", ""]


def shorten_defaults(
    _app: Sphinx, _kind: str, _name: str, _object: Any, _how: Any, given: str | None, returns: Any
) -> tuple[str, Any] | None:
    """Write '...' for a default value that has no literal, such as a function."""
    if not given or "=" not in given:
        return None
    return re.sub(r"= <[\w ]+ .*?>(?=[,)])", "= ...", given), returns


def write_start(app: Sphinx, error: Exception | None) -> None:
    """Write index.html, which leads to the README."""
    if error is None and app.builder.name == "html":
        (Path(app.outdir) / "index.html").write_text(START, encoding="utf-8")


class Commands(SphinxDirective):
    """The help of every command, one section each."""

    def run(self) -> list[nodes.Node]:
        """Return the sections, with the help as the command line prints it."""
        from shadefit.cli import app  # noqa: PLC0415

        names = [command.name for command in app.registered_commands]
        for group in app.registered_groups:
            commands = group.typer_instance.registered_commands if group.typer_instance else []
            names += [f"{group.name} {command.name}" for command in commands]
        return [self._section(str(name)) for name in names]

    def _section(self, name: str) -> nodes.section:
        section = nodes.section(ids=[f"shadefit-{name.replace(' ', '-')}"])
        section += nodes.title(text=name)
        text = help_of(name)
        section += nodes.literal_block(text, text, language="text")
        return section


def help_of(name: str) -> str:
    """Return what `shadefit NAME --help` prints."""
    command = [sys.executable, "-m", "shadefit", *name.split(), "--help"]
    plain = {**os.environ, "TERMINAL_WIDTH": "84", "NO_COLOR": "1", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(command, capture_output=True, check=True, env=plain, cwd=ROOT)
    lines = done.stdout.decode("utf-8").strip("\n").splitlines()
    return "\n".join(line.rstrip() for line in lines).replace("python -m shadefit", "shadefit")

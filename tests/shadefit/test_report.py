"""The report: one file that loads nothing, and its tables of errors, errata and origins."""

import json
import re
import struct
import zlib
from dataclasses import replace
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import pytest

from coefficients.catalogue import entries, resolve, with_published
from coefficients.frontier import Mark
from coefficients.proof_text import proof_text
from coefficients.table import Table, serialise
from quantities import problem
from shadefit.cli import main
from shadefit.figures import pictures
from shadefit.report import page, sections


def png(width=3, height=2):
    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    rows = chunk(b"IDAT", zlib.compress(b"\0" * (width + 1) * height))
    return b"\x89PNG\r\n\x1a\n" + head + rows + chunk(b"IEND", b"")


class Outline(HTMLParser):
    """Collects ids, links, labels and sources, and checks that elements are closed in order."""

    EMPTY = frozenset({"meta", "link", "input", "img", "br"})
    OF_A_CELL = frozenset({"td", "th", "sub"})

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.targets, self.sources, self.cells = [], [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag not in self.EMPTY:
            self.open.append(tag)
        self.ids += [given["id"]] if "id" in given else []
        self.targets += [given["href"]] if "href" in given else []
        self.sources += [given["src"]] if "src" in given else []
        if tag in ("td", "th"):
            self.cells.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in self.OF_A_CELL and "table" in self.open:
            self.cells[-1] += data


@pytest.fixture(scope="module")
def assembled():
    with pytest.MonkeyPatch.context() as patch:
        # The explorer's script has tests of its own.
        patch.setattr(page, "script", lambda more: "if (1 < 2) { }")
        figure = page.figure("frontier", pictures()["frontier"], png())
        yield page.assemble("", figure, sections.errata(), sections.provenance())


def test_the_page_is_well_formed_and_self_contained(assembled):
    outline = Outline(assembled)
    assert len(set(outline.ids)) == len(outline.ids)
    for target in outline.targets:
        assert target == "data:," or target.removeprefix("#") in outline.ids
    assert all(source.startswith("data:image/png;base64,") for source in outline.sources)
    assert "default-src 'none'" in assembled
    assert not re.search(r"url\(|@import|import\(|fetch\(|XMLHttpRequest", assembled)
    assert "{{" not in assembled


def test_pictures_have_their_captions_and_widths():
    picture = pictures()["errors-g"]
    figure = page.figure("errors-g", picture, png(width=7))
    caption = picture.caption
    assert f'alt="{caption}" width="7"' in figure
    assert f"<figcaption>{caption}</figcaption>" in figure


def test_the_summary_says_what_was_measured(monkeypatch):
    measured = (
        Mark("published/q", "published", 5, 0.02, 0.01),
        Mark("q", "refitted", 5, 0.03, 0.004),
        Mark("closed form", "exact", 700, 2.5e-7, 3.5e-8),
    )
    monkeypatch.setattr(sections, "marks", lambda owner: measured)
    cells = Outline(sections.summary([problem("q")])).cells
    text = " | ".join(cells)
    for mark in measured:
        assert f"{mark.rms:.3e}" in text
        assert f"{mark.largest:.3e}" in text
    assert "Q = (1/π) ∫Ω exp(−d/(u·n))" in text
    row = cells.index("q")
    assert cells[row + 1 : row + 8] == [
        *("Eq. (4)", "2", "6", "4.000e-03", "0.4", "3.000e-02", "1.5"),
    ]
    assert cells[row + 8] == "; ".join(proof_text(table("q").certificates))


def table(name) -> Table:
    return resolve(name).require_table()


def test_the_summary_has_quantities_without_a_published_table_too():
    text = sections.summary([problem("velvet")])
    cells = Outline(text).cells
    stated = table("velvet").errors
    assert stated is not None
    row = cells.index("velvet")
    assert cells[row + 4 : row + 8] == [
        *(f"{stated.off_grid.rms:.3e}", "—", f"{stated.off_grid.max:.3e}", "—"),
    ]
    assert any(cell.startswith("r = ") for cell in cells)
    assert "p<sub>Schlick</sub>(k" in text


def test_the_summary_names_a_quantity_that_has_no_table(monkeypatch):
    monkeypatch.setattr(sections, "marks", lambda owner: ())
    cells = Outline(sections.summary([problem("q")])).cells
    assert cells[-2].startswith("Q = ")
    assert cells[-1] == "There is no table."


def test_the_proofs_of_a_table_are_those_that_it_records():
    assert sections._proofs(resolve("g")) == "; ".join(proof_text(table("g").certificates))
    assert sections._proofs(resolve("published/g")) == "—"
    assert sections._proofs(resolve("exact/g")) == "—"


def test_all_errata_and_all_origins_are_there(assembled):
    for entry in entries():
        known = entry.require_table()
        for erratum in known.publication.errata if known.publication else ():
            assert sections.escape(erratum.why) in assembled
        if known.provenance is not None:
            words = known.provenance.command.split(" ")
            command = escape(" ".join("NAME" if word == entry.name else word for word in words))
            (names,) = re.findall(rf"<li>{re.escape(command)}: <span[^>]*>(.*?)</span>", assembled)
            assert entry.name in names.split(", ")
            assert f"jax {known.provenance.versions['jax']}" in assembled


def test_what_tables_have_in_common_is_said_once():
    listed = re.findall(r"<li>(.*): <span", sections.provenance())
    assert len(set(listed)) == len(listed)
    versions = [line for line in listed if "jaxlib" in line]
    every = {
        table(e.name).provenance.versions["jaxlib"] for e in entries() if table(e.name).provenance
    }
    assert len(versions) == len(every)


def test_a_title_has_only_what_is_known_of_a_quantity():
    reference = problem("q").reference
    bare = replace(reference, definition="", meaning="")
    assert sections._title(problem("q").changed(reference=bare)) == "Q"
    assert sections._title(problem("q")) == f"Q = {reference.definition}, {reference.meaning}"


def test_a_table_in_a_file_is_measured_beside_the_published_one(tmp_path):
    path = tmp_path / "<b>.json"
    path.write_text(serialise(table("best/q-5")))
    entry = resolve(str(path))
    text = sections.summary([problem("q")], [entry])
    cells = Outline(text).cells
    row, packaged = cells.index(str(path)), cells.index("best/q-5")
    assert cells[row + 1 : row + 8] == cells[packaged + 1 : packaged + 8]
    assert "<b>" not in text
    assert escape(str(path)) in sections.provenance([entry])


def test_text_of_tables_is_escaped():
    hostile = "</dd><script>alert(1)</script>"
    known = table("q")
    assert known.provenance is not None
    provenance = known.provenance.model_copy(update={"command": hostile})
    changed = known.model_copy(update={"provenance": provenance})
    facts = {text: ["q"] for text in sections._origin(changed).values() if text}
    listed = sections._facts(hostile, facts)
    assert sections._origin(resolve("published/q").require_table())["printed in"]
    assert "<script>" not in listed
    assert "&lt;script&gt;" in listed
    assert sections.markup("a_b < ∫_Ω") == "a<sub>b</sub> &lt; ∫<sub>Ω</sub>"


def test_bad_places_are_refused_before_the_work(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    for place in (tmp_path, tmp_path / "file" / "report.html"):
        with pytest.raises(SystemExit) as stopped:
            main(["report", "--out", str(place)])
        assert stopped.value.code == 2
        captured = capsys.readouterr()
        assert captured.err.startswith("shadefit: ")
        assert captured.err.count("\n") == 1


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("exact/q", "exact/q has no coefficients"),
        ("best/q-99", "best/q-99"),
        ("file", "is a table of 'unheard', which is not known: allowed are tables of ps, g"),
    ],
)
def test_what_is_no_table_of_a_known_quantity_is_refused(tmp_path, capsys, name, message):
    if name == "file":
        known = json.loads(serialise(table("best/q-5")))
        name = str(tmp_path / "file.json")
        Path(name).write_text(json.dumps(known | {"quantity": "unheard"}))
    with pytest.raises(SystemExit) as stopped:
        main(["report", name, "--out", str(tmp_path / "report.html")])
    assert stopped.value.code == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1


def test_pictures_that_are_drawn_already_are_taken_as_they_are(tmp_path, monkeypatch, capsys):
    folder, out, asked = tmp_path / "drawn", tmp_path / "report.html", {}
    folder.mkdir()
    for width, name in enumerate(pictures(), 1):
        (folder / f"{name}.png").write_bytes(png(width))
    monkeypatch.setattr("shadefit.report.page.page", lambda drawn, _: asked.update(drawn) or "page")
    command = ["report", "--out", str(out), "--pictures", str(folder)]
    with pytest.raises(SystemExit) as stopped:
        main(command)
    assert not stopped.value.code
    assert out.read_text() == "page"
    assert asked == {name: png(width) for width, name in enumerate(pictures(), 1)}
    assert list(asked) == list(pictures())
    (folder / "frontier.png").write_text("no picture")
    for place, said in ((folder, "frontier.png is no picture"), (out, "allowed is a folder")):
        capsys.readouterr()
        with pytest.raises(SystemExit) as stopped:
            main([*command[:-1], str(place)])
        assert stopped.value.code == 2
        assert said in capsys.readouterr().err


@pytest.mark.slow
def test_the_command_writes_everything(tmp_path):
    out = tmp_path / "report.html"
    with pytest.raises(SystemExit) as stopped:
        main(["report", "--out", str(out)])
    assert not stopped.value.code
    text = out.read_text(encoding="utf-8")
    Outline(text)
    # That each picture has the same bytes in every run is tested for itself.
    assert text.count("<figure id=") == len(pictures())
    assert text.count("data:image/png;base64,") == len(pictures())
    for owner in with_published():
        assert f'<th scope="row">published/{owner.name}</th>' in text
    assert len(text) < 10 << 20

"""The report: one file that loads nothing, and its tables of errors, errata and origins."""

import re
import struct
import zlib
from html.parser import HTMLParser

import pytest

from coefficients.catalogue import entries, resolve, with_published
from coefficients.frontier import Mark
from coefficients.proof_text import proof_text
from coefficients.table import Table
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
        if self.open and self.open[-1] in ("td", "th", "sub") and self.cells:
            self.cells[-1] += data


@pytest.fixture(scope="module")
def assembled():
    with pytest.MonkeyPatch.context() as patch:
        # The explorer's script has tests of its own.
        patch.setattr(page, "script", lambda: "if (1 < 2) { }")
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
    assert cells[-1].startswith("Q = ")


def test_the_proofs_of_a_table_are_those_that_it_records():
    assert sections._proofs(table("g")) == "; ".join(proof_text(table("g").certificates))
    assert sections._proofs(table("published/g")) == "—"
    assert sections._proofs(None) == "—"


def test_all_errata_and_all_origins_are_there(assembled):
    for entry in entries():
        known = entry.require_table()
        for erratum in known.publication.errata if known.publication else ():
            assert sections.escape(erratum.why) in assembled
        if known.provenance is not None:
            assert f"<dd>{known.provenance.command}</dd>" in assembled
            assert f"jax {known.provenance.versions['jax']}" in assembled


def test_text_of_tables_is_escaped():
    hostile = "</dd><script>alert(1)</script>"
    known = table("q")
    assert known.provenance is not None
    provenance = known.provenance.model_copy(update={"command": hostile})
    changed = known.model_copy(update={"provenance": provenance})
    listed = sections._list(sections._origin(changed))
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


@pytest.mark.slow
def test_the_command_writes_everything(tmp_path):
    out = tmp_path / "report.html"
    with pytest.raises(SystemExit) as stopped:
        main(["report", "--out", str(out)])
    assert not stopped.value.code
    text = out.read_text(encoding="utf-8")
    Outline(text)
    with pytest.raises(SystemExit):
        main(["report", "--out", str(tmp_path / "again.html")])
    assert (tmp_path / "again.html").read_bytes() == out.read_bytes()
    assert text.count("<figure id=") == len(pictures())
    assert text.count("data:image/png;base64,") == len(pictures())
    for owner in with_published():
        assert f'<th scope="row">published/{owner.name}</th>' in text
    assert len(text) < 6 << 20

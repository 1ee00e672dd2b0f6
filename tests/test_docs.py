"""The documentation: links lead somewhere, and every public name is in the reference."""

import importlib.util
import re
from pathlib import Path

import pytest

import shadefit

ROOT = Path(__file__).parent.parent
SITE = ROOT / "docs" / "site"
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]


def load(name: str):
    spec = importlib.util.spec_from_file_location(name, SITE / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def broken(folder: Path) -> list[str]:
    return sorted(load("check_links").broken_links(folder))


def test_links_that_lead_nowhere_are_found(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.html").write_text(
        '<h1 id="top">A</h1><a href="sub/b.html#here">1</a><a href="#top">2</a>'
        '<a href="https://example.org/">3</a><a href="sub/">4</a><img src="data:image/png;base64,">'
    )
    (tmp_path / "sub" / "index.html").write_text('<a href="../a.html#top">1</a>')
    (tmp_path / "sub" / "b.html").write_text('<a name="here" href="b.html">1</a>')
    assert broken(tmp_path) == []
    (tmp_path / "c.html").write_text(
        '<a href="none.html">1</a><a href="a.html#no">2</a><a href="../../x">3</a>'
        '<script src="https://example.org/x.js"></script><img src="%20.png">'
    )
    assert broken(tmp_path) == [
        "c.html: %20.png: no such file",
        "c.html: ../../x: no such file",
        "c.html: a.html#no: no such place",
        "c.html: https://example.org/x.js: is on another host",
        "c.html: none.html: no such file",
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_to_a_file(page):
    text = re.sub(r"^    .*$|`[^`]*`", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    for link in re.findall(r"\]\(([^)#\s]+)", text):
        if "://" not in link:
            assert (page.parent / link).exists(), link


def test_every_public_name_is_in_the_reference():
    text = (SITE / "api.rst").read_text()
    named = re.findall(r"^.. (?:autofunction|autoclass|py:data):: (\w+)$", text, re.MULTILINE)
    named += re.findall(r"^ {13}(\w+)$", text, re.MULTILINE)
    assert sorted(named) == sorted(shadefit.__all__)


def test_every_page_is_in_the_navigation():
    source = (SITE / "site_pages.py").read_text()
    for page in (*PAGES, *SITE.glob("*.rst")):
        if page.name != "README.md":
            name = page.relative_to(ROOT).with_suffix("").as_posix()
            assert f'"{name}"' in source, name

"""What the project says of itself: versions, licence, and dependencies that agree."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def pins(name: str) -> dict[str, str]:
    """Return the locked versions by the names of the packages."""
    text = (ROOT / name).read_text()
    return dict(re.findall(r"^([A-Za-z0-9._-]+)==([^ ;\\]+)", text, re.MULTILINE))


def test_the_lock_is_within_the_ranges():
    locked = pins("requirements.lock")
    extras = PROJECT["optional-dependencies"]
    chosen = [*PROJECT["dependencies"], *extras["dev"], *extras["maps"], *extras["meshes"]]
    # The extra `dev` has the extras of users in it, by the project's own name.
    for each in map(Requirement, [text for text in chosen if not text.startswith("shadefit[")]):
        assert len(each.specifier) == 2, f"{each} is no range"
        assert locked[each.name] in each.specifier


def test_the_generator_of_the_site_is_locked_too():
    docs = PROJECT["optional-dependencies"]["docs"]
    lines = (ROOT / "requirements-docs.in").read_text().splitlines()
    assert [line for line in lines if not line.startswith("#")] == docs
    locked = pins("requirements-docs.lock")
    for each in map(Requirement, docs):
        assert locked[each.name] in each.specifier
    # What both have is the same, so that one may be installed after the other.
    shared = pins("requirements.lock")
    assert {name: locked[name] for name in locked.keys() & shared.keys()} == {
        name: shared[name] for name in locked.keys() & shared.keys()
    }


def test_no_range_is_wider_than_what_the_tests_run_with():
    locked = pins("requirements.lock")
    for each in map(Requirement, PROJECT["dependencies"]):
        least = [part.version for part in each.specifier if part.operator == ">="]
        assert least == [locked[each.name]]


def test_the_citation_is_of_this_version():
    lines = (ROOT / "CITATION.cff").read_text().splitlines()
    assert f"version: {PROJECT['version']}" in lines
    assert f"license: {PROJECT['license']}" in lines
    assert f"  - name: {PROJECT['authors'][0]['name']}" in lines


def test_the_licence_is_whole():
    text = (ROOT / "LICENSE").read_text()
    assert "Version 2.0, January 2004" in text
    assert all(f"\n   {number}. " in text for number in range(1, 10))

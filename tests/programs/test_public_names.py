"""Public names that are imported when they are used: what runs, and what a type checker reads."""

import ast
import importlib
import sys
from pathlib import Path

import pytest

from programs.public_names import import_when_used

LAZY = ("programs", "fitting", "shadefit", "shadefit.figures")


@pytest.mark.parametrize("package", LAZY)
def test_a_name_is_that_of_the_module_that_a_type_checker_reads(package):
    module = importlib.import_module(package)
    tree = ast.parse(Path(str(module.__file__)).read_text("utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    assert ast.unparse(block.test) == "TYPE_CHECKING"
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    homes = {alias.name: str(node.module) for node in imports for alias in node.names}
    assert sorted(homes) == sorted(module.__all__) == dir(module)
    for name, home in homes.items():
        assert getattr(module, name) is getattr(importlib.import_module(home), name)


@pytest.mark.parametrize("package", LAZY)
def test_a_name_that_is_not_public_is_refused(package):
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'nope'"):
        _ = importlib.import_module(package).nope


def test_a_module_is_imported_when_its_name_is_used(tmp_path, monkeypatch):
    (tmp_path / "home_of_a_name.py").write_text("name = 3\n")
    monkeypatch.syspath_prepend(tmp_path)
    imported, names, every = import_when_used("package", {"home_of_a_name": ("name",)})
    assert (names(), every) == (["name"], ("name",))
    assert "home_of_a_name" not in sys.modules
    assert imported("name") == 3
    del sys.modules["home_of_a_name"]

"""Fixtures for the tests of toolchains and of compiled interval arithmetic."""

import tempfile

import pytest

from programs.bounding import compiled

# GCC sees loops that leave their arrays, if the arrays' lengths are constants.
_ARRAYS = ("-Werror=array-bounds", "-Werror=aggressive-loop-optimizations")


@pytest.fixture(autouse=True)
def arrays_are_checked(monkeypatch):
    """Refuse code of the kernel that reads or writes beyond the end of an array."""
    monkeypatch.setattr(compiled, "_FLAGS", (*compiled._FLAGS, *_ARRAYS))


@pytest.fixture
def clean_folder(tmp_path, monkeypatch):
    """Fail a test after which the temporary folder is not empty."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    yield
    assert list(tmp_path.iterdir()) == []

"""A fixture for the tests of toolchains."""

import tempfile

import pytest


@pytest.fixture
def clean_folder(tmp_path, monkeypatch):
    """Fail a test after which the temporary folder is not empty."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    yield
    assert list(tmp_path.iterdir()) == []

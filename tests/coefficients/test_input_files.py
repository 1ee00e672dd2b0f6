"""Files that are read: regular ones of a limited size; others are refused without waiting."""

import os
from pathlib import Path

import pytest

from coefficients.input_files import read_bounded


def test_a_file_is_read_whole_up_to_the_limit(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    (tmp_path / "link").symlink_to("file")
    assert read_bounded(path, 5) == read_bounded(tmp_path / "link", 6) == b"12345"
    with pytest.raises(ValueError, match=r"file has 5 bytes: allowed are 4"):
        read_bounded(path, 4)


def test_a_file_that_states_no_size_is_bounded():
    # Files of /proc have no size, and some have no end.
    with pytest.raises(ValueError, match="allowed are 10"):
        read_bounded(Path("/proc/self/maps"), 10)


@pytest.mark.parametrize("name", ["pipe", "zero", "folder"])
def test_what_may_not_end_is_refused_at_once(tmp_path, name):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    (tmp_path / "folder").mkdir()
    with pytest.raises(ValueError, match=rf"{name}: it is no regular file"):
        read_bounded(tmp_path / name, 100)


def test_what_cannot_be_opened_is_one_line(tmp_path, monkeypatch):
    (tmp_path / "loop").symlink_to("loop")
    for name, why in (
        ("none", "No such file"),
        ("x" * 300, "File name too long"),
        ("loop", "symbolic links"),
    ):
        with pytest.raises(ValueError, match=f"cannot be read: .*{why}"):
            read_bounded(tmp_path / name, 100)
    (tmp_path / "file").touch()

    # The superuser has every permission.
    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(ValueError, match="file cannot be read: Permission denied"):
        read_bounded(tmp_path / "file", 100)

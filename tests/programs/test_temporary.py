"""Temporary files and folders: what is registered is removed, and nothing else."""

import pytest

from programs.toolchains.process import workspace
from programs.toolchains.temporary import discard_unfinished, unfinished


def test_registered_files_and_folders_are_removed(tmp_path):
    file, folder, other = tmp_path / "file", tmp_path / "folder", tmp_path / "other"
    file.touch(), other.touch()
    (folder / "deep").mkdir(parents=True)
    with unfinished(file), unfinished(folder):
        discard_unfinished()
        assert list(tmp_path.iterdir()) == [other]


def test_what_is_finished_is_kept(tmp_path):
    file = tmp_path / "file"
    file.touch()
    with unfinished(file) as path:
        assert path == file
    with pytest.raises(KeyError), unfinished(file):
        raise KeyError
    discard_unfinished()
    assert file.exists()


def test_a_workspace_is_registered_and_removed():
    with workspace() as folder:
        (folder / "code.c").touch()
        discard_unfinished()
        assert not folder.exists()
        folder.mkdir()
    assert not folder.exists()

"""Files are written whole or not at all, whatever is in their place and whichever step fails."""

import errno
import os
import re
import socket
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from coefficients import files
from coefficients.files import (
    ReaderGoneError,
    is_standard_output,
    require_writable,
    require_writable_file,
    write_whole,
    write_whole_bytes,
)
from programs.toolchains import temporary

# More than a pipe holds.
LONG = b"0123456789abcdef" * 8192


def one_line(error) -> str:
    message = str(error.value)
    assert "\n" not in message
    return message


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.fixture
def umask():
    """Set the umask of the process for a test."""
    old = os.umask(0o022)
    yield os.umask
    os.umask(old)


def test_writing_makes_the_folder_and_leaves_only_the_file(tmp_path):
    path = tmp_path / "new" / "deeper" / "r.json"
    write_whole(path, "ä longer text\n")
    assert path.read_bytes() == "ä longer text\n".encode()
    write_whole(path, "shorter\n")
    assert path.read_text() == "shorter\n"
    assert os.listdir(path.parent) == ["r.json"]


@pytest.mark.parametrize(("mask", "found"), [(0o022, 0o644), (0o077, 0o600), (0o002, 0o664)])
def test_a_new_file_obeys_the_umask(tmp_path, umask, mask, found):
    umask(mask)
    write_whole(tmp_path / "new", "text")
    assert mode(tmp_path / "new") == found


@pytest.mark.parametrize("kept", [0o600, 0o666, 0o755, 0o640])
def test_a_file_that_is_replaced_keeps_its_permissions(tmp_path, umask, kept):
    umask(0o027)
    path = tmp_path / "file"
    path.write_text("old")
    path.chmod(kept)
    write_whole(path, "new")
    assert (path.read_text(), mode(path)) == ("new", kept)


@pytest.mark.skipif(os.getuid() != 0, reason="only the superuser gives files away")
def test_a_file_that_is_replaced_keeps_its_owner(tmp_path):
    path = tmp_path / "file"
    path.write_text("old")
    os.chown(path, 1234, 4321)
    write_whole(path, "new")
    assert (path.stat().st_uid, path.stat().st_gid) == (1234, 4321)


def test_a_file_without_permission_to_write_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / "file"
    path.write_text("old")
    # The superuser has every permission.
    monkeypatch.setattr(os, "access", lambda *_: False)
    for write in (require_writable_file, lambda path: write_whole(path, "new")):
        with pytest.raises(ValueError, match="Permission denied") as error:
            write(path)
        assert str(path) in one_line(error)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["file"]


def test_the_target_of_links_is_replaced_and_the_links_stay(tmp_path):
    target = tmp_path / "there" / "target"
    target.parent.mkdir()
    target.write_text("old")
    (tmp_path / "second").symlink_to("there/target")
    (tmp_path / "first").symlink_to(tmp_path / "second")
    for path in (tmp_path / "first", target.parent / "dangling"):
        if path.name == "dangling":
            path.symlink_to("made")
        require_writable_file(path)
        write_whole(path, "new")
        assert path.is_symlink() and path.read_text() == "new"
    assert (tmp_path / "second").is_symlink()
    assert sorted(os.listdir(target.parent)) == ["dangling", "made", "target"]
    assert not (target.parent / "made").is_symlink()


def test_links_that_lead_nowhere_are_refused(tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "lost").symlink_to("no-folder/file")
    for name in ("loop", "lost"):
        with pytest.raises(ValueError, match="cannot be written"):
            write_whole(tmp_path / name, "new")
    with pytest.raises(ValueError, match="symbolic links"):
        require_writable_file(tmp_path / "loop")
    for folder in (tmp_path / "loop", tmp_path / "loop" / "deeper", tmp_path / "lost"):
        with pytest.raises(ValueError, match=r"is no folder|cannot be written"):
            require_writable(folder)
    assert sorted(os.listdir(tmp_path)) == ["loop", "lost"]


def test_other_names_of_a_file_keep_the_old_content(tmp_path):
    """This is documented: a file with two names cannot be replaced at once under both."""
    (tmp_path / "file").write_text("old")
    os.link(tmp_path / "file", tmp_path / "other")
    write_whole(tmp_path / "file", "new")
    assert ((tmp_path / "file").read_text(), (tmp_path / "other").read_text()) == ("new", "old")


def test_a_pipe_is_written_through(tmp_path):
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    (tmp_path / "link").symlink_to("pipe")
    for path in (pipe, tmp_path / "link"):
        reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
        reader.start()
        require_writable_file(path)
        write_whole_bytes(path, LONG)
        reader.join()
    assert read == [LONG, LONG]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert sorted(os.listdir(tmp_path)) == ["link", "pipe"]


def test_a_reader_that_is_gone_is_told_apart(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    handles = []

    def read_a_little():
        handles.append(os.open(pipe, os.O_RDONLY))
        os.read(handles[0], 1)
        os.close(handles[0])

    reader = threading.Thread(target=read_a_little)
    reader.start()
    with pytest.raises(ReaderGoneError, match="nothing reads from"):
        write_whole_bytes(pipe, LONG)
    reader.join()


@pytest.mark.skipif(os.getuid() != 0, reason="only the superuser makes devices")
def test_a_device_is_written_through_and_a_disk_is_refused(tmp_path):
    null, disk = tmp_path / "null", tmp_path / "disk"
    try:
        os.mknod(null, stat.S_IFCHR | 0o666, os.makedev(1, 3))
        # A number that no device has
        os.mknod(disk, stat.S_IFBLK | 0o666, os.makedev(240, 77))
    except PermissionError:
        pytest.skip("devices are not allowed here")
    before = null.lstat()
    require_writable_file(null)
    write_whole(null, "text")
    after = null.lstat()
    assert (after.st_ino, after.st_rdev, after.st_mode) == (
        before.st_ino,
        before.st_rdev,
        before.st_mode,
    )
    for write in (require_writable_file, lambda path: write_whole(path, "new")):
        with pytest.raises(ValueError, match="block device"):
            write(disk)
    assert stat.S_ISBLK(disk.lstat().st_mode)
    assert sorted(os.listdir(tmp_path)) == ["disk", "null"]


def test_a_socket_is_refused_and_stays(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as bound:
        bound.bind("socket")
        with pytest.raises(ValueError, match="cannot be written"):
            write_whole(tmp_path / "socket", "text")
    assert os.listdir(tmp_path) == ["socket"]


def test_an_open_file_is_written_from_where_it_stands(tmp_path):
    """As /dev/fd/N of a shell: what is in it before and after stays."""
    kept = tmp_path / "kept"
    with kept.open("wb") as file:
        file.write(b"before ")
        file.flush()
        for path in (f"/dev/fd/{file.fileno()}", f"/proc/self/fd/{file.fileno()}"):
            require_writable_file(Path(path))
            write_whole(Path(path), "within ")
        file.write(b"after")
    assert kept.read_bytes() == b"before within within after"
    assert os.listdir(tmp_path) == ["kept"]
    with pytest.raises(ValueError, match="cannot be written"):
        write_whole(Path("/dev/fd/999"), "text")


def test_a_minus_is_standard_output(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    print("said before")
    require_writable_file(Path("-"))
    write_whole(Path("-"), "text\n")
    assert capfd.readouterr().out == "said before\ntext\n"
    assert os.listdir(tmp_path) == []


def test_a_folder_that_cannot_be_made_or_written_is_named(tmp_path):
    in_the_way = tmp_path / "file"
    in_the_way.write_text("here")
    with pytest.raises(ValueError, match="cannot be written") as error:
        write_whole(in_the_way / "r.json", "text")
    assert str(in_the_way) in one_line(error)
    with pytest.raises(ValueError, match="cannot be written"):
        write_whole(Path("/proc/no-such-folder/r.json"), "text")
    assert in_the_way.read_text() == "here"
    assert os.listdir(tmp_path) == ["file"]


def test_a_folder_is_not_replaced_by_a_file(tmp_path):
    (tmp_path / "r.json").mkdir()
    with pytest.raises(ValueError, match="cannot be written"):
        write_whole(tmp_path / "r.json", "text")
    with pytest.raises(ValueError, match="is a folder"):
        require_writable_file(tmp_path / "r.json")
    assert os.listdir(tmp_path) == ["r.json"]


def test_names_that_are_too_long_are_one_line(tmp_path):
    for path in (tmp_path / ("x" * 300), tmp_path / ("x" * 300) / "file"):
        for write in (
            require_writable,
            require_writable_file,
            lambda path: write_whole(path, "text"),
        ):
            with pytest.raises(ValueError, match="File name too long"):
                write(path)
    # The name of the temporary file is not longer than this one.
    write_whole(tmp_path / ("x" * 255), "text")
    assert os.listdir(tmp_path) == ["x" * 255]


def test_a_folder_without_permission_is_one_line(tmp_path, monkeypatch):
    # The superuser has every permission.
    def refuse(*_, **__):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "stat", refuse)
    for check in (require_writable, require_writable_file):
        with pytest.raises(ValueError, match="cannot be written: Permission denied") as error:
            check(tmp_path / "folder" / "file")
        one_line(error)


def test_text_that_cannot_be_encoded_leaves_the_old_file(tmp_path):
    path = tmp_path / "r.json"
    path.write_text("old")
    with pytest.raises(ValueError):
        write_whole(path, "\ud800")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["r.json"]


# The operations of a save, in the order of the first call of each. Writing is in parts, so that a
# failure in the middle is one of the cases.
OPERATIONS = ["open", "fstat", "fchmod", "write", "fsync", "close", "replace"]
PART = 4


class Faulty:
    """The module `os` with operations that are counted, of which one fails or ends the process."""

    def __init__(self, at: int = 0, failure: BaseException | None = None):
        self.at, self.failure, self.log = at, failure, []

    def __getattr__(self, name: str):
        real = getattr(os, name)
        if name not in OPERATIONS:
            return real

        def operation(*arguments):
            self.log.append(name)
            if len(self.log) == self.at and name == "close":
                # The handle is closed even if closing reports an error.
                real(*arguments)
            if len(self.log) == self.at:
                raise self.failure or OSError(errno.EIO, os.strerror(errno.EIO))
            if name == "write":
                return real(arguments[0], arguments[1][:PART])
            return real(*arguments)

        return operation


OLD, NEW = b"the old content", b"what is new"


def operations(monkeypatch, path: Path) -> list[str]:
    """Write a file, and return the operations that this took."""
    faulty = Faulty()
    monkeypatch.setattr(files, "os", faulty)
    write_whole_bytes(path, NEW)
    monkeypatch.undo()
    return faulty.log


@pytest.mark.parametrize("failure", [None, OSError(errno.ENOSPC, "No space left"), MemoryError()])
@pytest.mark.parametrize("before", [OLD, None])
def test_a_failure_of_any_operation_leaves_a_whole_file_and_nothing_else(
    tmp_path, monkeypatch, before, failure
):
    def reset() -> Path:
        path = tmp_path / "file"
        path.unlink(missing_ok=True)
        if before is not None:
            path.write_bytes(before)
        return path

    log = operations(monkeypatch, reset())
    expected = [each for each in OPERATIONS if before or each not in ("fstat", "fchmod")]
    assert list(dict.fromkeys(log)) == expected
    assert log.count("write") == 3
    for at, name in enumerate(log, start=1):
        path = reset()
        monkeypatch.setattr(files, "os", Faulty(at, failure))
        with pytest.raises(MemoryError if isinstance(failure, MemoryError) else ValueError):
            write_whole_bytes(path, NEW)
        monkeypatch.undo()
        # After the renaming, the new file is there: its folder only was not synchronised.
        whole = NEW if "replace" in log[: at - 1] else before
        assert (path.read_bytes() if path.exists() else None) == whole, name
        assert os.listdir(tmp_path) == ([] if whole is None else ["file"]), name
        assert not temporary._UNFINISHED
        write_whole_bytes(path, NEW)
        assert path.read_bytes() == NEW


def test_a_file_system_that_does_not_synchronise_folders_is_no_error(tmp_path, monkeypatch):
    log = operations(monkeypatch, tmp_path / "file")
    second = [at for at, name in enumerate(log, start=1) if name == "fsync"][1]
    refusal = OSError(errno.EINVAL, os.strerror(errno.EINVAL))
    (tmp_path / "file").unlink()
    monkeypatch.setattr(files, "os", Faulty(second, refusal))
    write_whole_bytes(tmp_path / "file", NEW)
    monkeypatch.undo()
    assert (tmp_path / "file").read_bytes() == NEW


# In a process of its own, which is killed at an operation: what a crash of the process leaves.
_KILLED = """
import os, signal, sys
from pathlib import Path
from coefficients import files
from tests.coefficients.test_files import NEW, Faulty

class Killing(Faulty):
    def __getattr__(self, name):
        found = super().__getattr__(name)
        def operation(*arguments):
            if len(self.log) + 1 == self.at:
                os.kill(os.getpid(), signal.SIGKILL)
            return found(*arguments)
        return operation if name in ("open", "write", "fsync", "close", "replace") else found

for at in map(int, sys.argv[2:]):
    if os.fork() == 0:
        files.os = Killing(at)
        files.write_whole_bytes(Path(sys.argv[1]) / str(at) / "file", NEW)
        os._exit(0)
    print(os.waitstatus_to_exitcode(os.wait()[1]), flush=True)
"""


def test_a_kill_at_any_operation_leaves_the_old_file_or_the_new(tmp_path, monkeypatch):
    (tmp_path / "first").write_bytes(OLD)
    log = operations(monkeypatch, tmp_path / "first")
    # `fstat` and `fchmod` change nothing that is seen.
    chosen = [at for at, name in enumerate(log, 1) if name not in ("fstat", "fchmod")]
    for at in chosen:
        (tmp_path / str(at)).mkdir()
        (tmp_path / str(at) / "file").write_bytes(OLD)
    command = [sys.executable, "-c", _KILLED, str(tmp_path), *map(str, chosen)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["-9"] * len(chosen)
    for at in chosen:
        folder = tmp_path / str(at)
        whole = NEW if "replace" in log[: at - 1] else OLD
        assert (folder / "file").read_bytes() == whole
        left = [name for name in os.listdir(folder) if name != "file"]
        # What is left has a name that nothing reads, and is in nobody's way.
        assert len(left) <= 1
        assert all(re.fullmatch(r"\.shadefit-[0-9a-f]{16}\.partial", name) for name in left)
        write_whole_bytes(folder / "file", b"later")
        assert (folder / "file").read_bytes() == b"later"


def test_the_names_of_standard_output_are_known(tmp_path):
    (tmp_path / "link").symlink_to("/dev/stdout")
    (tmp_path / "file").touch()
    known = [Path("-"), Path("/dev/stdout"), Path("/dev/fd/1"), tmp_path / "link"]
    assert all(map(is_standard_output, known))
    others = [Path("/dev/stderr"), Path("/dev/null"), tmp_path / "file", tmp_path / "missing"]
    assert not any(map(is_standard_output, others))

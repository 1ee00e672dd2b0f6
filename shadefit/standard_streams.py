"""Standard input, output and error: those that are closed, full, or a pipe that nobody reads."""

import io
import os
import sys
from contextlib import suppress
from typing import IO, NoReturn

# The exit status if nobody reads the output any more: 128 + SIGPIPE, as that of cat and grep.
READER_GONE = 141


class OutputError(Exception):
    """Standard output cannot be written. It is no OSError, because libraries handle those."""

    def __init__(self, cause: OSError):
        super().__init__(f"standard output cannot be written: {cause.strerror or cause}")
        self.is_reader_gone = isinstance(cause, BrokenPipeError)


def install_streams() -> None:
    """Make the standard streams safe to write to, whatever the caller has done to them.

    A closed one is opened, so that no other file takes its place. What standard error does not take
    is lost. What standard output does not take raises `OutputError`.
    """
    # Standard output is opened for reading, so that writing to it fails.
    for number, mode in ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            opened = os.open(os.devnull, mode)
            if opened != number:
                os.dup2(opened, number)
                os.close(opened)
    if sys.stdin is None:
        sys.stdin = open(0, closefd=False, encoding="utf-8")  # noqa: SIM115
    sys.stdout = _text(_Output(1, "w", closefd=False), sys.stdout)
    sys.stderr = _text(_Lossy(2, "w", closefd=False), sys.stderr, line_buffering=True)


def end(status: int) -> NoReturn:
    """End the command with an exit status: another one if its output was not written."""
    try:
        sys.stdout.flush()
    except OutputError as error:
        end_without_output(error, status)
    except BrokenPipeError as error:
        end_without_output(OutputError(error), status)
    sys.exit(status)


def end_without_output(error: OutputError, status: int = 0) -> NoReturn:
    """End the command because standard output cannot be written. A reader that is gone is no news.

    `status` is the exit status that the command has otherwise.
    """
    # Python would try once more at exit, and print a message.
    with suppress(OSError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
    if error.is_reader_gone:
        sys.exit(status or READER_GONE)
    print(f"shadefit: {error}", file=sys.stderr)
    sys.exit(status or 2)


class _Output(io.FileIO):
    def write(self, data, /) -> int | None:
        try:
            return super().write(data)
        except OSError as error:
            raise OutputError(error) from None


class _Lossy(io.FileIO):
    def write(self, data, /) -> int:
        size = memoryview(data).nbytes
        try:
            written = super().write(data)
        except OSError:
            return size
        return size if written is None else written


def _text(raw: io.FileIO, old: IO[str] | None, line_buffering: bool = False) -> io.TextIOWrapper:
    """Return a text stream that encodes as the old one."""
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=getattr(old, "encoding", None) or "utf-8",
        errors=getattr(old, "errors", None) or "strict",
        line_buffering=line_buffering or getattr(old, "line_buffering", False),
        write_through=False,
    )

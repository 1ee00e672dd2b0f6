"""The start of the command line. A signal (Ctrl-C, SIGTERM) ends it at once, even within JAX."""

import gc
import os
import select
import signal
import sys
import threading

from shadefit.standard_streams import install_streams

# New objects before a search for unreachable ones, and searches before one of older objects. JAX
# makes and keeps very many objects: with Python's 700, a tenth of the time of `refit` is spent in
# searches that find next to nothing.
_GARBAGE = 50_000, 20, 50
# By command: a message about the files that an interruption leaves, if there are partial results.
_KEPT = {"search": "what it finished is in its folder, and the same command goes on from there"}
# Seconds to wait until standard error takes the last message
_PATIENCE = 0.5
_SHOW_CURSOR = "\x1b[?25h\r\x1b[K"
# Signals that ask a process to end, and what is said of them.
_SIGNALS = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "ended by SIGTERM",
    signal.SIGHUP: "ended, as its terminal was closed (SIGHUP)",
}


def main() -> None:
    """Run the command line. The exit status is 2 for bad input, and 128 + the number of a signal.

    A closed standard error is no obstacle: what would be written to it is lost. What is written to
    a closed standard output is an error.
    """
    gc.set_threshold(*_GARBAGE)
    try:
        install_streams()
        _watch_signals()
        from shadefit.cli import main as run
        from shadefit.compilation_cache import use_cache

        use_cache()
    except OSError as error:
        # Modules cannot be read, because the process may open too few files, for example.
        place = "" if error.filename is None else f"{error.filename}: "
        print(f"shadefit: does not start: {place}{error.strerror}", file=sys.stderr)
        sys.exit(2)
    run()


def _watch_signals() -> None:
    # Without this, Python raises KeyboardInterrupt only after compiled code returns, which may take
    # minutes, or in the middle of JAX, where the exception is lost or crashes. Instead, Python's
    # signal handler writes the number of the signal into a pipe at once, and another thread waits
    # for it. Signals that are ignored, such as SIGHUP under nohup, stay ignored.
    handled = [each for each in _SIGNALS if signal.getsignal(each) is not signal.SIG_IGN]
    if not handled:
        return
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    for each in handled:
        signal.signal(each, lambda *_: None)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    waiting = threading.Thread(target=_wait_for_signal, args=[reader, handled], daemon=True)
    try:
        waiting.start()
    except RuntimeError:
        # The system allows no further thread: signals end the process as they do others.
        for each in handled:
            signal.signal(each, signal.SIG_DFL)


def _wait_for_signal(reader: int, handled: list[signal.Signals]) -> None:
    received = None
    while received not in handled:
        received = os.read(reader, 1)[0]
    try:
        _clean_up(_SIGNALS[signal.Signals(received)])
    finally:
        # Whatever could not be removed or said, the process ends.
        os._exit(128 + received)


def _clean_up(reason: str) -> None:
    running = sys.modules.get("programs.toolchains.running")
    if running is not None:
        running.end_all()
    temporary = sys.modules.get("programs.toolchains.temporary")
    if temporary is not None:
        temporary.discard_unfinished(at_end=True)
    progress = sys.modules.get("shadefit.progress")
    if progress is not None:
        progress.clear()
    kept = _KEPT.get(next(iter(sys.argv[1:]), ""), "no file is half written")
    # The terminal has written ^C at the start of the line, which the message replaces.
    codes = "\r" if os.environ.get("TERM") == "dumb" else _SHOW_CURSOR
    cursor = codes if os.isatty(2) else ""
    # Standard error may be broken, a terminal that is halted, or a pipe that nobody reads.
    if select.select([], [2], [], _PATIENCE)[1]:
        os.write(2, f"{cursor}shadefit: {reason}; {kept}\n".encode())


if __name__ == "__main__":
    main()

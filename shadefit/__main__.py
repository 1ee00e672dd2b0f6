"""The start of the command line. An interruption (Ctrl-C) ends it at once, even within JAX."""

import os
import signal
import sys
import threading

# The exit status of an interrupted command in shells: 128 + SIGINT.
_INTERRUPTED = 130
# By command: a message about the files that an interruption leaves, if there are partial results.
_KEPT = {"search": "what it finished is in its folder, and the same command goes on from there"}
_SHOW_CURSOR = "\x1b[?25h\r\x1b[K"


def main() -> None:
    """Run the command line. The exit status is 2 for bad input and 130 for an interruption."""
    # Without this, Python raises KeyboardInterrupt only after compiled code returns, which may take
    # minutes, or in the middle of JAX, where the exception is lost or crashes. Instead, Python's
    # signal handler writes a byte into a pipe at once, and another thread waits for it.
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        reader, writer = os.pipe()
        os.set_blocking(writer, False)
        signal.signal(signal.SIGINT, lambda *_: None)
        signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
        threading.Thread(target=_wait_for_interruption, args=[reader], daemon=True).start()
    from shadefit.cli import main as run

    run()


def _wait_for_interruption(reader: int) -> None:
    os.read(reader, 1)
    temporary = sys.modules.get("programs.toolchains.temporary")
    if temporary is not None:
        temporary.discard_unfinished()
    progress = sys.modules.get("shadefit.progress")
    if progress is not None:
        progress.clear()
    kept = _KEPT.get(next(iter(sys.argv[1:]), ""), "no file is half written")
    # The terminal has written ^C at the start of the line, which the message replaces.
    codes = "\r" if os.environ.get("TERM") == "dumb" else _SHOW_CURSOR
    cursor = codes if sys.stderr.isatty() else ""
    os.write(2, f"{cursor}shadefit: interrupted; {kept}\n".encode())
    os._exit(_INTERRUPTED)


if __name__ == "__main__":
    main()

"""Where the command line starts: an interruption ends it at once, whatever is being computed."""

import os
import signal
import sys
import threading

# 128 + SIGINT, as shells have it.
_INTERRUPTED = 130
# What an interruption leaves, where it is more than whole files or none.
_KEPT = {"search": "what it finished is in its folder, and the same command goes on from there"}
_SHOW_CURSOR = "\x1b[?25h\r\x1b[K"


def main() -> None:
    """Run the command line; exit status 2 for bad input, 130 for an interruption."""
    # Python would raise in the midst of compiled code, where the exception is lost or fatal, or
    # wait for minutes until that ends. The byte is written at once, and read by another thread.
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
    kept = _KEPT.get(next(iter(sys.argv[1:]), ""), "no file is half written")
    cursor = _SHOW_CURSOR if sys.stderr.isatty() else ""
    os.write(2, f"{cursor}shadefit: interrupted; {kept}\n".encode())
    os._exit(_INTERRUPTED)


if __name__ == "__main__":
    main()

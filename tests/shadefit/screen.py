"""A terminal: commands run in a pseudo-terminal, and the screen that they leave."""

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
import time

_CONTROL = re.compile(r"\x1b\[([?0-9;]*)([A-Za-z])|\x1b\][^\x07]*\x07|\x1b[=>]")
_ENDS_WITHIN = 120.0
# The terminal becomes that of the session, so that its keys send signals. Tests that run in the
# background may have been started with SIGINT ignored.
_IN_OWN_TERMINAL = (
    "import fcntl, signal, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0)\n"
    "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from shadefit.__main__ import main; main()"
)


class Session:
    """A command line that runs in a terminal of a given width."""

    def __init__(self, *arguments: str, width: int = 80, **environment: str):
        controller, terminal = pty.openpty()
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, width, 0, 0))
        # What the caller's terminal is must not matter.
        kept = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LINES", "NO_COLOR")}
        self.process = subprocess.Popen(
            [sys.executable, "-c", _IN_OWN_TERMINAL, *arguments],
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
            env={**kept, "TERM": "xterm-256color", **environment},
            start_new_session=True,
        )
        os.close(terminal)
        self.controller = controller
        self.output = ""

    def read_until(self, wanted: str) -> None:
        """Read until a text is in the output."""
        deadline = time.monotonic() + _ENDS_WITHIN
        while wanted not in self.output:
            assert time.monotonic() < deadline, self.output
            assert self._read(), self.output

    def type(self, keys: str) -> None:
        """Press keys."""
        os.write(self.controller, keys.encode())

    def end(self) -> int:
        """Read until the command has ended. Returns its exit status."""
        while self._read():
            pass
        os.close(self.controller)
        return self.process.wait(_ENDS_WITHIN)

    def _read(self) -> bool:
        ready, _, _ = select.select([self.controller], [], [], _ENDS_WITHIN)
        assert ready, self.output
        try:
            data = os.read(self.controller, 1 << 16)
        except OSError:  # Linux reports so that no program has the terminal open any more.
            return False
        self.output += data.decode()
        return bool(data)


def screen(output: str) -> list[str]:
    """Return the lines that a terminal shows after this output. Lines must not be too long."""
    lines, row, column, position = [""], 0, 0, 0
    while position < len(output):
        control = _CONTROL.match(output, position)
        if control:
            count = int(control[1] or 1) if (control[1] or "1").isdigit() else 1
            if control[2] == "A":
                row = max(row - count, 0)
            elif control[2] == "K":
                lines[row] = "" if control[1] == "2" else lines[row][:column]
            position = control.end()
            continue
        character = output[position]
        if character == "\r":
            column = 0
        elif character == "\n":
            row += 1
            lines += [""] * (row + 1 - len(lines))
        else:
            lines[row] = lines[row].ljust(column)[:column] + character + lines[row][column + 1 :]
            column += 1
        position += 1
    return [line.rstrip() for line in lines]

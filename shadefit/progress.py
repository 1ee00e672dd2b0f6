"""What a long command is doing, shown on standard error while it runs, if that is a terminal."""

import math
import sys
import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass

from rich.console import Console
from rich.progress import Progress, ProgressColumn, SpinnerColumn, Task, TaskID, TextColumn
from rich.text import Text

from shadefit.encoding import has_all, visible

_SPINNER = "dots"
# The same without characters that an encoding may lack.
_PLAIN_SPINNER = "line"
# Where there is no terminal, at least this many seconds are between two lines.
_PAUSE = 10.0
# The display that is on the terminal now, if there is one.
_shown: list[Progress] = []


@dataclass(frozen=True)
class Stages:
    """The lines of the display, one for each stage of the work."""

    progress: Progress

    def begin(self, text: str, total: int | None = None) -> "Stage":
        """Start a stage. `total` is the number of its steps, if it is known."""
        return Stage(self.progress, self.progress.add_task(visible(text), total=total))


@dataclass(frozen=True)
class Stage:
    """One line of the display: what is done, how many steps of how many, and the time left."""

    progress: Progress
    task: TaskID

    def show(self, text: str, done: int | None = None, total: int | None = None) -> None:
        """Say what is being done now; `done` and `total` count steps."""
        self.progress.update(self.task, description=visible(text), completed=done, total=total)

    def advance(self) -> None:
        """Count one step more as done."""
        self.progress.advance(self.task)

    def end(self, text: str | None = None) -> None:
        """Stop the clock of the stage."""
        total = self.progress.tasks[self.task].total or 1
        said = None if text is None else visible(text)
        self.progress.update(self.task, description=said, completed=total, total=total)


@contextmanager
def stages() -> Generator[Stages]:
    """Show on standard error what a long command is doing. Show nothing if it is no terminal."""
    terminal = sys.stderr.isatty()
    spinner = _SPINNER if has_all("⠋", getattr(sys.stderr, "encoding", None)) else _PLAIN_SPINNER
    columns = (
        SpinnerColumn(spinner),
        TextColumn("{task.description}", markup=False),
        _Steps(),
        _Clock(),
    )
    console = Console(stderr=True)
    # Rich would send what is printed to standard output to the console, which is standard error.
    with Progress(
        *columns, console=console, transient=True, redirect_stdout=False, disable=not terminal
    ) as progress:
        _shown.append(progress)
        try:
            yield Stages(progress)
        finally:
            _shown.remove(progress)


def line_in_pipe(pause: float = _PAUSE) -> Callable[[str, int, int], None]:
    """Return a function that says on standard error what is done, if that is no terminal.

    It takes a text, the number of steps that are done, and that of all. It writes a line at the
    first call, and then at most one in `pause` seconds.
    """
    began, last = time.monotonic(), -math.inf
    terminal = sys.stderr.isatty()

    def tell(text: str, done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        if terminal or now - last < pause:
            return
        last = now
        left = time_left(now - began, float(done), float(total))
        estimate = "" if left is None else f", about {clock(left)} left"
        steps = f"; {done} of {total}, {clock(now - began)}{estimate}" if total else ""
        print(visible(f"{text}{steps}"), file=sys.stderr)

    return tell


def clear(patience: float = 1.0) -> None:
    """Erase the display from the terminal, if there is one. Another thread may call this.

    It is given up after `patience` seconds: the thread that draws may be held up.
    """

    def stop() -> None:
        for each in list(_shown):
            each.stop()

    if _shown:
        worker = threading.Thread(target=stop, daemon=True)
        worker.start()
        worker.join(patience)


class _Steps(ProgressColumn):
    """The steps that are done and their number: '3 of 40'. Nothing if there is but one."""

    def render(self, task: Task) -> Text:
        if task.total is None or task.total <= 1:
            return Text()
        return Text(f"{task.completed:.0f} of {task.total:.0f}")


class _Clock(ProgressColumn):
    """The time since the stage began, and an estimate of the time that is left."""

    def render(self, task: Task) -> Text:
        elapsed = (task.finished_time if task.finished else task.elapsed) or 0.0
        total = None if task.total is None else float(task.total)
        left = time_left(elapsed, float(task.completed), total)
        estimate = "" if left is None or task.finished else f", about {clock(left)} left"
        return Text(f"{clock(elapsed)}{estimate}")


def time_left(elapsed: float, done: float, total: float | None) -> float | None:
    """Return the seconds that are left if steps go on at their mean pace; None if none is done."""
    if total is None or not done:
        return None
    return elapsed / done * (total - done)


def clock(seconds: float) -> str:
    """Write a time: '0:07', '12:30', '1:02:03'."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"

"""The display of progress: steps, times, and clocks that stop."""

import io
import sys
import time

import pytest
from rich.progress import Progress

from shadefit import progress
from shadefit.progress import clock, line_in_pipe, stages, time_left


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "0:00"), (7.4, "0:07"), (59.6, "1:00"), (3723.0, "1:02:03")]
)
def test_a_clock(seconds, text):
    assert clock(seconds) == text


def test_the_time_left_is_that_of_the_mean_pace():
    assert time_left(30.0, 3.0, 12.0) == pytest.approx(90.0)
    assert time_left(30.0, 12.0, 12.0) == 0
    assert time_left(30.0, 0.0, 12.0) is None
    assert time_left(30.0, 3.0, None) is None


class Terminal(io.StringIO):
    """Standard error of a terminal."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


def test_a_finished_stage_stops_its_clock(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    with stages() as shown:
        first, second = shown.begin("first"), shown.begin("second", total=4)
        first.end("first: done")
        second.advance()
        stopped = _elapsed(shown.progress, 0)
        running = _elapsed(shown.progress, 1)
        time.sleep(0.05)
        assert _elapsed(shown.progress, 0) == stopped
        assert _elapsed(shown.progress, 1) > running
        text = sys.stderr.getvalue()
    assert "second" in text


def _elapsed(shown: Progress, index: int) -> float:
    task = shown.tasks[index]
    return (task.finished_time if task.finished else task.elapsed) or 0.0


def test_steps_and_the_time_left_are_shown(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    with stages() as shown:
        stage = shown.begin("forms", total=40)
        stage.show("forms: fitting", done=3, total=40)
        shown.progress.refresh()
        text = screen.getvalue()
    assert "forms: fitting" in text and "3 of 40" in text and "left" in text


def test_a_name_is_no_markup_and_does_not_steer_the_terminal(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    with stages() as shown:
        stage = shown.begin("[/bold] a.json")
        shown.progress.refresh()
        assert "[/bold] a.json" in screen.getvalue()
        stage.show("\x1b]0;owned\x07")
        shown.progress.refresh()
        stage.end("\u202e")
        text = screen.getvalue()
    assert r"\x1b]0;owned\x07" in text and "\x1b]0" not in text
    assert "\u202e" not in text


def test_nothing_is_shown_without_a_terminal(capsys):
    with stages() as shown:
        shown.begin("forms", total=2).advance()
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_the_display_is_erased_by_another_thread(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    with stages() as shown:
        shown.begin("forms")
        progress.clear()
        assert not shown.progress.live.is_started
    assert progress._shown == []


def test_where_there_is_no_terminal_a_line_says_what_is_done(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    tell = line_in_pipe(pause=10.0)
    for seconds, done, total in [
        (100, 0, 0),
        (103, 0, 40),
        (130, 3, 40),
        (139, 4, 40),
        (140, 5, 40),
    ]:
        now[0] = float(seconds)
        tell("q: pole-q", done, total)
    assert capsys.readouterr().err.splitlines() == [
        "q: pole-q",
        "q: pole-q; 3 of 40, 0:30, about 6:10 left",
        "q: pole-q; 5 of 40, 0:40, about 4:40 left",
    ]


def test_on_a_terminal_these_lines_are_left_out(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    line_in_pipe()("q", 1, 2)
    assert sys.stderr.getvalue() == ""

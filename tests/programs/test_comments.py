"""Comments: a command that is copied from one is read by a shell as the words that it shows."""

import shlex
import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from programs.languages import LANGUAGES
from programs.printing.comments import command_again, command_text, header_comment

HOSTILE = [
    "it\u2019s.json",
    "\u2019; touch hacked; \u2018",
    "\u2019$(touch hacked)\u2019",
    "\u2032`touch hacked`\u2032",
    "\u201d$(touch hacked)\u201d",
    "'; touch hacked; '",
    "\\'; touch hacked; \\'",
    "\uff07; touch hacked; \uff07",
    "a\nb; touch hacked",
    "a\u2028touch hacked",
    "a  b",
    " ",
    "",
    "-n",
    "*",
    "$HOME",
    "!!",
    "~",
    "a*/b",
    "#comment",
    "√q, θf ≤ ½ °",
    "x" * 300,
    "word " * 60,
    "\x1b]0;owned\x07",
    "\u202egnp.exe",
    "\udcff",
]


def words_read(lines: list[str], folder) -> list[str]:
    """Return the words that a shell reads from a comment, without its first one."""
    text = " ".join(line.removeprefix("//").strip() for line in lines).removeprefix("Made by: ")
    script = text.replace("shadefit", "printf '%s\\0'", 1)
    done = subprocess.run(["sh", "-c", script], cwd=folder, capture_output=True, check=True)
    assert done.stderr == b""
    assert not list(folder.iterdir())
    return done.stdout.decode("ascii").split("\0")[:-1]


def comment(command: str) -> list[str]:
    return header_comment(LANGUAGES["hlsl"], {"Made by": command})


@pytest.mark.parametrize("word", HOSTILE)
def test_a_shell_reads_the_words_that_are_shown(tmp_path, word):
    read = words_read(comment(command_text(["shadefit", "export", word, "--to", "c"])), tmp_path)
    assert [read[0], *read[2:]] == ["export", "--to", "c"]
    # Text that a comment can show is shown exactly.
    if word.isascii() and word.isprintable() and "\\" not in word and word.split() == [word]:
        assert read[1] == word


@settings(max_examples=30, deadline=None)
@given(words=st.lists(st.text(alphabet=st.sampled_from("'\"\u2019\u2018\u201d\u2032$`(;)\\ a#\n"))))
def test_no_words_become_others(tmp_path_factory, words):
    folder = tmp_path_factory.mktemp("empty")
    shown = comment(command_text(["shadefit", *words, "end"]))
    read = words_read(shown, folder)
    assert len(read) == len(words) + 1
    assert comment(command_text(["shadefit", *read])) == shown


@pytest.mark.parametrize("word", HOSTILE)
def test_a_command_of_a_file_is_quoted_again(tmp_path, word):
    said = shlex.join(["shadefit", "ndf", word, "--segments", "8"])
    read = words_read(comment(command_again(said)), tmp_path)
    assert [read[0], *read[2:]] == ["ndf", "--segments", "8"]


@pytest.mark.parametrize("text", ["touch hacked", "shadefit 'a", "shadefitx; touch hacked", ""])
def test_what_is_no_command_is_one_word(text):
    assert shlex.split(command_again(text)) == [text]


def test_a_usual_command_is_as_it_was_typed():
    words = ["shadefit", "export", "-p", "my files/a.py", "best/q-9", "--to", "hlsl"]
    assert command_text(words) == command_again(shlex.join(words)) == shlex.join(words)

"""Output in encodings that lack characters: plain text instead of an error, and correct JSON."""

import json
import os
import subprocess
import sys

import pytest

from coefficients.packaged import packaged_table
from coefficients.table import parse
from shadefit.encoding import shown, shown_json, visible


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("α ≥ 0.05", "alpha >= 0.05"),
        ("θf in [0, π/2]", "theta_f in [0, pi/2]"),
        ("θ", "theta"),
        ("∫_Ω p(u·n)", "int_Omega p(u*n)"),
        ("──", "--"),
        ("c₃ − d²", "c3 - d^2"),
        ("漢", "?"),
        ("\u200b", "?"),
        ("plain", "plain"),
    ],
)
def test_what_ascii_lacks_is_written_in_words(text, plain):
    assert shown(text, "ascii") == plain
    assert shown(text, "utf-8") == text


def test_what_the_encoding_has_is_kept():
    assert shown("±½ μ", "cp1252") == "±½ mu"


def test_json_escapes_what_the_encoding_lacks(monkeypatch):
    class Ascii:
        encoding = "ascii"

    monkeypatch.setattr(sys, "stdout", Ascii)
    text = json.dumps({"d²": 'θ 漢 \\ " 🎨'}, ensure_ascii=False)
    escaped = shown_json(text)
    assert escaped.isascii()
    assert json.loads(escaped) == json.loads(text)


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("\x1b]0;owned\x07.json", r"\x1b]0;owned\x07.json"),
        ("\x9b31m", r"\x9b31m"),
        ("gpj\u202eexe", r"gpj\u202eexe"),
        ("a\u200bb\u2066c\ufeff", r"a\u200bb\u2066c\ufeff"),
        ("\udcff\u2028", r"\udcff\u2028"),
        ("a\rb\tc\x7f", r"a\rb\tc\x7f"),
        ("two\nlines", "two\nlines"),
        ("θf ≥ ½, 漢字 🎨 65\u202f%", "θf ≥ ½, 漢字 🎨 65\u202f%"),
    ],
)
def test_hidden_characters_are_made_visible(text, seen):
    assert visible(text) == seen
    data = json.dumps({"text": text}, ensure_ascii=False)
    assert json.loads(shown_json(data)) == {"text": text}
    assert visible(shown_json(data)) == shown_json(data)


def run(*arguments: str, encoding: str) -> str:
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    command = [sys.executable, "-m", "shadefit", *arguments]
    done = subprocess.run(command, capture_output=True, env=environment, check=True)
    assert done.stderr == b""
    return done.stdout.decode(encoding)


@pytest.mark.slow
def test_commands_print_in_an_old_encoding():
    text = run("evaluate", "q", "--density", "0.3", encoding="cp1252")
    assert text.startswith("Q = (1/pi) int_Omega exp(-d/(u·n)) (u·n) domega_u")
    assert "closed form" in text
    assert "α" not in run("refit", "--help", encoding="cp1252")


def test_an_exported_table_is_the_same_in_an_old_encoding():
    assert parse(run("export", "q", encoding="cp1252"), "q") == packaged_table("q")


@pytest.mark.slow
def test_exported_code_is_printed_in_an_old_encoding():
    assert "FuzzAveragePenetration" in run("export", "q", "--to", "python", encoding="cp1252")

"""How tables are laid out: numbers are whole at any width."""

import pytest

from shadefit.layout import laid_out

COLUMNS = ["table", "rms error", "ratio", "largest error", "ratio", "at"]
ROWS = [
    ["published, as printed", "5.0196e-02", "4.6017", "3.0789e-01", "1.7181", "α 0.15, θf 1.43"],
    ["best/ps-40", "8.2880e-04", "0.0760", "2.4210e-03", "0.0135", ""],
]


@pytest.mark.parametrize("width", [10, 20, 40, 60, 66, 80, 100, 10_000])
def test_every_cell_is_whole(width):
    header, lines = laid_out(COLUMNS, ROWS, 1, width)
    words = " ".join([*header, *lines]).split()
    for row in ROWS:
        for cell in row:
            assert set(cell.split()) <= set(words)
    # Only a line that is a single word may be too long.
    for line in [*header, *lines]:
        assert len(line) <= width or len(line.split()) <= 2


def test_columns_stand_side_by_side_where_they_fit():
    header, lines = laid_out(COLUMNS, ROWS, 1, 80)
    assert header == ["table                   rms error   ratio  largest error   ratio"]
    assert lines == [
        "published, as printed  5.0196e-02  4.6017     3.0789e-01  1.7181",
        "    at α 0.15, θf 1.43",
        "best/ps-40             8.2880e-04  0.0760     2.4210e-03  0.0135",
    ]


def test_headers_and_then_names_are_wrapped():
    header, lines = laid_out(COLUMNS, ROWS, 1, 62)
    assert [line.split() for line in header] == [
        ["largest"],
        ["table", "rms", "error", "ratio", "error", "ratio"],
    ]
    assert lines[0].startswith("published, as printed  5.0196e-02")
    header, lines = laid_out(COLUMNS, ROWS, 1, 56)
    assert lines[0].startswith("published, as ")
    assert lines[1] == "printed"


def test_in_a_narrow_terminal_each_number_has_its_name():
    header, lines = laid_out(COLUMNS, ROWS, 1, 40)
    assert header == []
    assert lines[:3] == [
        "published, as printed",
        "    rms error 5.0196e-02  ratio 4.6017",
        "    largest error 3.0789e-01",
    ]


def test_wide_characters_are_counted_by_the_cells_they_take():
    _, lines = laid_out(["a", "b"], [["漢字", "1"], ["xy", "2"]], 0, 80)
    assert lines == ["漢字  1", "xy    2"]


def test_a_table_without_rows_has_its_header():
    assert laid_out(["name", "rms"], [], 0, 80) == (["name  rms"], [])

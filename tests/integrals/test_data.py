"""Data as a reference: what is read, what is refused, which rows are fitted and which judge."""

import io
import os
import struct

import numpy as np
import pytest

from integrals import data
from integrals.data import PROBLEM_FOLDER, samples, table
from integrals.reference import Axis
from integrals.reference_of_source import make_reference

TEXT = "NdotV, alpha,E,sigma\n# a comment\n0.1,0.5,0.25,0.01\n0.2,0.5,0.5,0.02\n\n0.3,1,0.75,0.04\n"
AXES = [Axis("mu", 0, 1), Axis("alpha", 0, 1)]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(TEXT)
    return path


def test_csv_npy_and_npz_give_the_same_data(file, tmp_path):
    found = table(file, ["NdotV", "alpha"], "E", "sigma")
    assert found.points.tolist() == [[0.1, 0.5], [0.2, 0.5], [0.3, 1.0]]
    assert found.values.tolist() == [0.25, 0.5, 0.75]
    assert found.sigma.tolist() == [0.01, 0.02, 0.04]
    assert found.source == "data.csv"
    columns = {"NdotV": found.points[:, 0], "alpha": found.points[:, 1], "E": found.values}
    np.savez(tmp_path / "data.npz", **columns)
    rows = np.array(list(zip(*columns.values(), strict=True)), dtype=[(k, float) for k in columns])
    np.save(tmp_path / "data.npy", rows)
    np.save(tmp_path / "plain.npy", np.stack(list(columns.values()), axis=1))
    for name, x, y in (
        ("data.npz", ["NdotV", "alpha"], "E"),
        ("data.npy", ["NdotV", "alpha"], "E"),
        ("plain.npy", ["0", "1"], "2"),
    ):
        other = table(tmp_path / name, x, y)
        np.testing.assert_array_equal(other.points, found.points)
        np.testing.assert_array_equal(other.values, found.values)


def test_the_digest_is_that_of_the_file(file):
    first = table(file, ["NdotV"], "E").digest
    assert len(first) == 64
    file.write_text(TEXT.replace("0.75", "0.76"))
    assert table(file, ["NdotV"], "E").digest != first


def test_a_file_beside_the_problem_file_is_found(file, monkeypatch):
    monkeypatch.chdir(file.parent.parent)
    with pytest.raises(ValueError, match=r"data.csv: no such file"):
        table("data.csv", ["NdotV"], "E")
    token = PROBLEM_FOLDER.set(file.parent)
    assert len(table("data.csv", ["NdotV"], "E").values) == 3
    PROBLEM_FOLDER.reset(token)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "data.csv has no rows"),
        ("a,b\n", "data.csv has no rows"),
        ("a,a\n1,2\n", "two columns of one name"),
        ("a,b\n1,2,3\n", "data.csv:2 has 3 fields, the header has 2"),
        ("a,c\n1,2\n", "has no column 'b': allowed are a, c"),
        ("a,b\n1,two\n", "b of row 1 is nan: allowed is a finite number"),
        ("a,b\n1,2\n1,inf\n", "b of row 2 is inf"),
        ("a,b\n1,2\n2,1_0\n", "b of row 2 is nan"),
        (
            "a,b\n1,2\n2,1e200\n",
            "the value of row 2 is 1e+200: allowed is a finite number, at most",
        ),
        (b"a,b\n\xff,1\n", "is no UTF-8 text"),
        ("a,b\n1," + 200_000 * "2", "data.csv is no CSV file: field larger than field limit"),
    ],
)
def test_a_wrong_csv_is_refused_in_one_line(tmp_path, text, message):
    path = tmp_path / "data.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError, match=r"data\.csv") as caught:
        table(path, ["a"], "b")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def hostile_npy() -> dict[str, bytes]:
    objects, whole = io.BytesIO(), io.BytesIO()
    np.save(objects, np.array([{}], dtype=object), allow_pickle=True)
    np.save(whole, np.zeros((2, 2)))
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (9999999999999, 2), }"
    header += b" " * (-(len(header) + 11) % 64) + b"\n"
    return {
        "Python objects": objects.getvalue(),
        "a shorter file than stated": whole.getvalue()[:-8],
        "a shape beyond all memory": b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header,
        "no NPY file": b"hello",
    }


@pytest.mark.parametrize("case", hostile_npy())
def test_a_hostile_npy_is_refused_in_one_line(tmp_path, case):
    path = tmp_path / "data.npy"
    path.write_bytes(hostile_npy()[case])
    with pytest.raises(ValueError, match=r"data\.npy is no NPY data") as caught:
        table(path, ["0"], "1")
    assert "\n" not in str(caught.value)


def test_an_archive_that_is_damaged_or_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "data.npz"
    np.savez_compressed(path, a=np.zeros(4096), b=np.zeros(4096))
    whole = path.read_bytes()
    # The bit of a zip file that says that it is encrypted, and a compression that nobody knows
    encrypted, unknown = bytearray(whole), bytearray(whole)
    for start in range(len(whole)):
        if whole[start : start + 4] == b"PK\x01\x02":
            encrypted[start + 8] |= 1
            unknown[start + 10] = 77
    for content in (encrypted, unknown, whole[:90], whole[:60] + b"?" + whole[61:]):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"data\.npz is no NP[YZ]"):
            table(path, ["a"], "b")
    path.write_bytes(whole)
    with monkeypatch.context() as small:
        small.setattr(data, "_UNPACKED", 60_000)
        with pytest.raises(ValueError, match=r"data\.npz unpacks to more than"):
            table(path, ["a"], "b")
        np.savez(path, a=np.arange(8192.0), b=np.zeros(8192))
        assert len(table(path, ["a"], "b").values) == 8192
    path.write_bytes(whole)
    monkeypatch.setattr(data, "MAX_BYTES", 60_000)
    with pytest.raises(ValueError, match=r"data\.npz unpacks to more than"):
        table(path, ["a"], "b")
    monkeypatch.setattr(data, "MAX_BYTES", len(whole) - 1)
    with pytest.raises(ValueError, match=r"data\.npz is larger than"):
        table(path, ["a"], "b")


@pytest.mark.parametrize("name", ["none.csv", "data.txt", "folder.csv", "pipe.csv", "zero.csv"])
def test_what_is_no_file_of_data_is_refused(tmp_path, name):
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    (tmp_path / "data.txt").write_text(TEXT)
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(ValueError, match=r"no such file|is no data: allowed are files \.csv"):
        table(tmp_path / name, ["NdotV"], "E")


def test_rows_are_held_out_always_the_same_and_no_fit_uses_them():
    x = np.linspace(0, 1, 103)
    found = samples(x, x * x, hold_out=5)
    assert found.held_out.sum() == 103 // 5
    assert set(found.fitted) | set(found.judging) == set(range(103))
    assert not set(found.fitted) & set(found.judging)
    np.testing.assert_array_equal(found.held_out, samples(x, -x, hold_out=5).held_out)
    every = samples(x, x)
    assert list(every.judging) == list(every.fitted) == list(range(103))


@pytest.mark.parametrize("hold_out", [-1, 1, 4])
def test_a_wrong_number_of_rows_to_hold_out_is_refused(hold_out):
    with pytest.raises(ValueError, match=f"hold_out = {hold_out}: allowed are 0 and 2 to 3"):
        samples([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], hold_out=hold_out)


def test_weights_are_those_of_the_standard_deviations():
    found = samples([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], sigma=[0.1, 0.2, 0.4])
    np.testing.assert_allclose(found.weights(np.arange(3)), [1.0, 0.5, 0.25])
    with pytest.raises(ValueError, match="sigma of row 2 is 0: allowed is a positive number"):
        samples([1.0, 2.0], [1.0, 2.0], sigma=[0.1, 0.0])


def test_data_are_a_reference_without_values_between_their_points(file):
    data = table(file, ["NdotV", "alpha"], "E")
    reference = make_reference(data, name="e", axes=AXES)
    assert reference.data is data
    assert reference.compared_with == "the data's own points"
    with pytest.raises(ValueError, match="e is known at the points of its data only"):
        reference.values(np.array([[0.1, 0.5]]))


def test_data_outside_the_domain_and_of_other_axes_are_refused(file):
    data = table(file, ["NdotV", "alpha"], "E")
    narrow = [Axis("mu", 0, 0.25), AXES[1]]
    with pytest.raises(ValueError, match=r"data.csv, row 3: mu = 0.3 is outside its domain"):
        make_reference(data, name="e", axes=narrow)
    with pytest.raises(ValueError, match=r"data\.csv has 2 columns of points: expected is one"):
        make_reference(data, name="e", axes=AXES[:1])

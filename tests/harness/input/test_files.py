"""Text as users hand it in: how much of it is read, in which encoding, and what is a number in it."""

import gzip
import os
import tracemalloc
import zipfile
from pathlib import Path

import pytest

from harness import InputError, read_history
from harness.input.files import MOST_BYTES, decimal, decimals, decoded, fortran, read_bytes
from harness.input.motions.readers import read_record

NO_NUMBERS = (
    "1_0.0",
    "nan",
    "-inf",
    "infinity",
    "0x10",
    "١٢",
    "1.0d",
    "d5",
    "",
    " ",
    "1,5",
    "--1",
    "1e",
    "e5",
    ".",
    "5 5",
)
BOMB_BYTES = 3 * 2**30


def test_a_decimal_number_is_digits_a_point_and_an_exponent() -> None:
    assert [decimal(text) for text in ("1", " -1.5 ", "+.5", "2.", "1E-02", "1.e+2", "1.D-2")] == [
        1.0,
        -1.5,
        0.5,
        2.0,
        0.01,
        100.0,
        0.01,
    ]
    for text in NO_NUMBERS:
        with pytest.raises(ValueError, match=r"decimal|float"):
            decimal(text)
        with pytest.raises(ValueError, match=r"decimal|float"):
            decimals(["1.0", text])


def test_fortran_writes_its_exponent_in_four_ways() -> None:
    assert [fortran(text) for text in ("1.E-02", "1d-2", "1D-02", "1.0-102", "-.5+100")] == [
        0.01,
        0.01,
        0.01,
        1e-102,
        -0.5e100,
    ]
    for text in ("1_0", "0x1", "nan", "inf", "d", "1-2"):
        with pytest.raises(ValueError, match=r"decimal|float"):
            fortran(text)


@pytest.fixture(scope="module")
def bomb(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """3 MB of gzip that hold 3 GB: members one after the other, which gzip reads as one."""
    path = tmp_path_factory.mktemp("bomb") / "member.gz"
    path.write_bytes(gzip.compress(b"0 " * 2**23))
    return path.read_bytes() * (BOMB_BYTES // 2**24)


def test_an_archive_that_lost_bytes_anywhere_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cut.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.csv", "t_s,a (g)\n" + "0.01,0.1\n" * 100)
    whole = path.read_bytes()
    for lost in (1, 7, 50, 900):
        path.write_bytes(whole[:5] + whole[5 + lost :])
        with pytest.raises(InputError, match=r"cut\.zip: .* whole gzip or ZIP file"):
            read_bytes(path, "a record")


def test_a_bomb_is_refused_and_little_of_it_unpacked(tmp_path: Path, bomb: bytes) -> None:
    path = tmp_path / "bomb.AT2.gz"
    path.write_bytes(bomb)
    tracemalloc.start()
    with pytest.raises(InputError, match=r"bomb\.AT2\.gz: .* 64 MiB"):
        read_record(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 4 * MOST_BYTES


def test_what_is_no_file_or_too_large_is_refused_before_it_is_read(tmp_path: Path) -> None:
    sparse = tmp_path / "sparse.AT2"
    with sparse.open("wb") as stream:
        stream.truncate(MOST_BYTES + 1)
    with pytest.raises(InputError, match=r"got 64 MiB$"):
        read_record(sparse)
    for other in (tmp_path, Path("/dev/zero")):
        with pytest.raises(InputError, match=str(other)):
            read_bytes(other, "a record")


def test_names_that_are_too_long_or_no_text_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="name too long"):
        read_record(tmp_path / ("a" * 300 + ".AT2"))
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff\xfe.csv"))
    odd.write_text("t_s,theta_rad\n0,0\n1,0\n")
    for read in (read_record, read_history):
        with pytest.raises(InputError, match=r"\\xff\\xfe.csv: wanted .* UTF-8") as caught:
            read(odd)
        str(caught.value).encode("utf-8")


def test_utf_16_is_read_by_its_mark_and_refused_in_words_without(tmp_path: Path) -> None:
    text = "t_s,theta_rad\n0,0\n0.5,0.001\n"
    path = tmp_path / "history.csv"
    for encoding in ("utf-16", "utf-8-sig", "utf-8"):
        path.write_bytes(text.encode(encoding))
        assert read_history(path).t_s.tolist() == [0.0, 0.5]
    for encoding in ("utf-16-le", "utf-16-be"):
        path.write_bytes(text.encode(encoding))
        with pytest.raises(InputError, match=r"got UTF-16 .* UTF-8"):
            read_history(path)
    with pytest.raises(InputError, match=r"^x: .* got UTF-16 "):
        decoded(b"\xff\xfea", "x", "text")
    with pytest.raises(InputError, match=r"^x: .* got a ZIP "):
        decoded(b"PK\x03\x04....", "x", "text")

"""History files of whatever software: read where their meaning is clear, refused with their place where it is not."""

from pathlib import Path

import numpy as np
import pytest

from harness.input.history_file import gaps, read_history
from harness.model import InputError

T_S = np.array([0.0, 0.01, 0.02, 0.03])
THETA_RAD = np.array([0.0, 0.01, -0.02, 0.5])
PLAIN = "t_s,theta_rad\n0,0\n0.01,0.01\n0.02,-0.02\n0.03,0.5\n"
EXACT_REL = 1e-15
"""A change of unit rounds once: 1.1e-16 of the value."""


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "theirs.csv"
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        (PLAIN, "utf-8"),
        (PLAIN, "utf-8-sig"),
        (PLAIN, "utf-16"),
        (PLAIN.replace("\n", "\r\n"), "utf-8"),
        ("# made elsewhere\n\n" + PLAIN, "utf-8"),
        (PLAIN.replace("\n", ",\n"), "utf-8"),
        (PLAIN.replace(",", ";"), "utf-8"),
        (PLAIN.replace(",", "\t"), "utf-8"),
        (PLAIN.replace(",", ";").replace(".", ","), "utf-8"),
        ('"t_s","theta_rad"\n' + PLAIN.split("\n", 1)[1], "utf-8"),
        (" t_s , theta_rad\n" + PLAIN.split("\n", 1)[1], "utf-8"),
        ("t_ms,theta_mrad\n0,0\n10,10\n20,-20\n30,500\n", "utf-8"),
    ],
)
def test_every_way_to_write_one_history_reads_as_that_history(tmp_path: Path, text: str, encoding: str) -> None:
    history = read_history(written(tmp_path, text, encoding))
    assert history.t_s == pytest.approx(T_S, rel=EXACT_REL)
    assert history.theta_rad == pytest.approx(THETA_RAD, rel=EXACT_REL)
    assert not history.slip_m.any()


def test_units_stand_in_the_names_of_columns(tmp_path: Path) -> None:
    text = "t_s,theta_deg,theta_rate_deg_s,slip_mm,slip_rate_cm_s,load_kn\n0,180,90,5,1,7\n1,0,0,0,0,7\n"
    history = read_history(written(tmp_path, text))
    first = (history.theta_rad[0], history.theta_rate_rad_s[0], history.slip_m[0], history.slip_rate_m_s[0])
    assert first == pytest.approx((np.pi, np.pi / 2, 0.005, 0.01), rel=EXACT_REL)
    assert history.extra["load_kn"].tolist() == [7.0, 7.0]


def test_rates_that_are_not_given_are_differences(tmp_path: Path) -> None:
    history = read_history(written(tmp_path, "t_s,theta_rad\n0,0\n1,2\n2,4\n"))
    assert history.theta_rate_rad_s.tolist() == [2.0, 2.0, 2.0]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "a header line and at least one row"),
        ("t_s,theta_rad\n", "1 lines"),
        ("0,0\n1,0\n", "line 1: wanted a header that names the columns, got numbers — put t_s,theta_rad"),
        ("time,theta\n0,1\n", r"a column t_s \(or t_ms\), got time, theta — name the columns"),
        ("t_s,angle\n0,1\n", r"a column theta_rad \(or theta_deg, theta_mrad\)"),
        ("t_s,theta_rad,theta_deg\n0,1,1\n", r"theta_rad \(in one unit\) once"),
        ("t_s,theta_rad,a,a\n0,1,1,1\n", "each column once"),
        ("t_s theta_rad\n0 1\n", "a column t_s"),
        ("t_s,theta_rad\ns,rad\n0,1\n", "line 2: t_s: wanted a number, got 's'"),
        ("# note\nt_s,theta_rad\n0,1\n1\n", "line 4: wanted 2 numbers, got 1 cells"),
        ("t_s,theta_rad\n0,x\n", "line 2: theta_rad: wanted a number, got 'x'"),
        ("t_s,theta_rad\n0,\n1,0\n", "line 2: theta_rad: wanted a number, got an empty cell"),
        ("t_s,theta_rad\n1,0\n0,0\n", "line 3: wanted increasing times, got times that do not increase"),
        ("t_s,theta_rad\n0,0\n0,0\n", "0 s after 0 s"),
        ("t_s,theta_rad\n0,nan\n", r"line 2: theta_rad: wanted a finite number, got nan \(NaN or infinite\)"),
        ("t_s,theta_rad\n0,-inf\n", "finite number"),
        ("t_s,theta_rad\n0,-30\n", "at most 10 rad, got 30 rad — name a column in degrees theta_deg"),
        ('t_s,theta_rad\n0,"1\n2"\n', "a quoted cell over several lines"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(tmp_path: Path, text: str, says: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError, match=says) as caught:
        read_history(path)
    assert str(path) in str(caught.value)


def test_text_in_another_encoding_is_refused_with_advice(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="UTF-8"):
        read_history(written(tmp_path, "# Körper\n" + PLAIN, "latin-1"))


def test_a_thousand_mistakes_are_told_in_twenty_lines(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_history(written(tmp_path, "t_s,theta_rad\n" + "0,x\n" * 1000))
    assert len(caught.value.mistakes) == 21
    assert "980 more" in str(caught.value)


def test_a_gap_is_told_where_the_statue_moves_and_only_there(tmp_path: Path) -> None:
    times = [*(0.01 * k for k in range(50)), *(2.0 + 0.01 * k for k in range(50))]
    moving, still = (
        read_history(written(tmp_path, "t_s,theta_rad\n" + "".join(f"{t:.9g},{level}\n" for t in times)))
        for level in (0.02, 0.0)
    )
    assert gaps(moving) == [(pytest.approx(0.49), pytest.approx(2.0))]
    assert gaps(still) == []

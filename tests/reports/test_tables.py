"""Tables: exact numbers in files, rounded ones on a terminal, which may be narrow."""

import csv
import io
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from gaincert.models.files.gains_file import load_gains
from gaincert.models.gains import GAIN_NAMES
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import SCALE_NAMES, Saturation
from gaincert.reports.tables.gain_table import COLUMNS, for_terminal, rows, write_csv
from gaincert.reports.tables.terminal import TerminalTable
from rich.console import Console


@pytest.fixture
def scaled():
    """The paper's gains with other scales, speed and turn rate one per vehicle."""
    each = np.array([Fraction(1 + i, 8) for i in range(6)], dtype=object)
    return replace(paper_gains(), saturation=Saturation(Fraction("2.5"), Fraction("0.5"), each, Fraction("0.25")))


def printed(table, width):
    console = Console(width=width, file=io.StringIO())
    console.print(table)
    return console.file.getvalue()


def test_gains_csv_has_the_columns_of_the_contract_and_is_read_back(scaled, tmp_path):
    fleet = paper_fleet()
    path = write_csv(tmp_path / "gains.csv", rows(fleet, paper_excitation(), scaled))
    with path.open() as file:
        heading = next(csv.reader(file))
    assert ",".join(heading) == (
        "vehicle,p_v,d_v,p_omega,d_omega,k_alpha,position_scale,heading_scale,speed_scale,turn_rate_scale,"
        "torque_bound,torque_limit,margin"
    )
    read = load_gains(path, fleet).gains
    for name in GAIN_NAMES:
        assert list(getattr(read, name)) == list(getattr(scaled, name))
    before, after = scaled.saturation.columns(6), read.saturation.columns(6)
    for name in SCALE_NAMES:
        assert list(before[name]) == list(after[name])


def test_the_terminal_shows_scales_where_they_are_not_unit(scaled):
    table = rows(paper_fleet(), paper_excitation(), scaled)
    assert "position 2.5 m, heading 0.5 rad" in for_terminal(table).caption
    assert {"s", "o"} < set(for_terminal(table).headings)
    unit = for_terminal(rows(paper_fleet(), paper_excitation(), paper_gains()))
    assert "scales" not in unit.caption
    assert "s" not in unit.headings


@pytest.mark.parametrize("width", [30, 40, 60, 80, 200])
def test_no_number_is_cut_on_a_narrow_terminal(scaled, width):
    shown = for_terminal(rows(paper_fleet(), paper_excitation(), scaled))
    text = printed(shown, width)
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= width
    words = text.split()
    for row in shown.rows:
        for number in row[1:]:
            assert number in words
    for heading in shown.headings:
        assert heading in words


def test_a_long_name_is_folded_and_not_cut():
    name = "robot_" * 12
    text = printed(TerminalTable(["vehicle", "gain"], [[name, "1.5"]]), 40)
    assert "".join(text.split()).replace("1.5", "").count("robot_") == 12
    assert "1.5" in text


def test_the_columns_of_a_row_are_the_columns_of_the_file():
    assert len(COLUMNS) == len(rows(paper_fleet(), paper_excitation(), paper_gains())[0])

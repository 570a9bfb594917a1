"""The columns of a certificate: read exactly, refused strictly."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from gaincert.verify import kernel

from tests.verify.certificate_documents import check, document, refusal, single


def read(text: Any, count: int | None = None, **more: Any) -> list[Fraction]:
    reader = kernel.Reader(4, 3)
    return [Fraction(value, 10**4) for value in reader.column(text, "x", count, **more)]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("1 2 3", [1, 2, 3]),
        ("0.50 10.00 0.25", [Fraction(1, 2), 10, Fraction(1, 4)]),
        ("1.0001 1.0002 123456789.0000", [Fraction("1.0001"), Fraction("1.0002"), 123456789]),
    ],
)
def test_columns_are_read_exactly(text: str, values: list[Fraction]) -> None:
    assert read(text) == values


def test_a_column_may_be_negative_or_zero_where_that_makes_sense() -> None:
    assert read("-1.5 0.0 2.5", least=None) == [Fraction(-3, 2), 0, Fraction(5, 2)]
    assert read("0 0 1", least=0) == [0, 0, 1]
    assert read("", 0) == []
    for text, least, words in (("0 1 1", 1, "> 0 (A2)"), ("-1 1 1", 0, ">= 0"), ("-0.5 1.0 1.0", 1, "> 0 (A2)")):
        with pytest.raises(kernel.FalseError) as caught:
            read(text, least=least)
        assert words in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["", "-", ".5", "5.", "05", "00", "+1", "1e3", "1,5", "0x1", "1/2", "--1", "1.2.3", "1\n", " 1", "1 ", "\u0662",
     "1_0", "1\u00a02", "nan", "Infinity", "9" * 61, "1." + "1" * 101],
)  # fmt: skip
def test_what_is_no_decimal_is_refused(text: str) -> None:
    with pytest.raises(kernel.UnreadableError, match="x: expected a string of 1 decimals of one form"):
        kernel.Reader(100, 1).column(text, "x", 1)


@pytest.mark.parametrize("text", ["1 2.0 3", "1.0 2 3.0", "1.00 2.0 3.00", "1  2 3", "1 2", "1 2 3 4", "1\t2\t3"])
def test_all_numbers_of_a_column_have_one_form(text: str) -> None:
    with pytest.raises(kernel.UnreadableError, match="x: expected a string of 3 decimals"):
        read(text)


@pytest.mark.parametrize("value", [1.5, 1, True, False, None, [1], ["1 2 3"], {"1": 1}, [], {}])
def test_a_column_is_a_text(value: Any) -> None:
    for count in (3, 1, 0):
        with pytest.raises(kernel.UnreadableError, match="x: expected a string"):
            read(value, count)


def test_indices_are_integers_in_their_range() -> None:
    reader = kernel.Reader(4, 3)
    assert reader.column("0 2 1", "x", None, 0, 3) == [0, 2, 1]
    assert reader.column("-1 2 1", "x", None, -1, 3) == [-1, 2, 1]
    for text in ("0 1 3", "-1 0 1", "0 1 99999999999999999999"):
        with pytest.raises(kernel.FalseError, match="x: all must be from 0 to 2"):
            reader.column(text, "x", None, 0, 3)
    with pytest.raises(kernel.FalseError):
        reader.column("0 -1 -1", "x", None, -1, 0)
    for text in ("0.0 1.0 2.0", "0 1", "0 1 x"):
        with pytest.raises(kernel.UnreadableError):
            reader.column(text, "x", None, 0, 3)


@pytest.mark.parametrize("digits", [59, 60, 61])
def test_numbers_have_at_most_60_digits_before_the_point(digits: int) -> None:
    content = single("1" * digits)
    if digits <= 60:
        assert check(content).valid
    else:
        assert "torque_left: expected" in refusal(content)


@pytest.mark.parametrize("places", [99, 100, 101])
def test_numbers_have_at_most_100_digits_after_the_point(places: int) -> None:
    content = single("6." + "0" * (places - 1) + "1")
    if places <= 100:
        assert check(content).valid
    else:
        assert f"1 vehicles with {places} digits after the point are not checked" in refusal(content)


def test_many_vehicles_have_fewer_places(monkeypatch: pytest.MonkeyPatch) -> None:
    content = document("mixed_ring")
    places = kernel.places_of({**content, "provenance": ""})
    monkeypatch.setattr(kernel, "MAX_SIZE", 10 * places)
    assert check(content).valid
    monkeypatch.setattr(kernel, "MAX_SIZE", 10 * places - 1)
    assert f"10 vehicles with {places} digits" in refusal(content)


@pytest.mark.parametrize("value", ["6", 6.5, True, None, 0, -1, [], "6 6"])
def test_the_number_of_vehicles_is_a_positive_integer(value: Any) -> None:
    content = single()
    content["fleet"]["vehicles"] = value
    assert "vehicles with 1 digits after the point are not checked" in refusal(content)


def test_a_parameter_is_a_column_or_two() -> None:
    reader = kernel.Reader(1, 1)
    assert reader.ends("2.5", "x", 1) == [[25], [25]]
    assert reader.ends("25", "x", 1) == [[250], [250]]
    assert reader.ends(["2", "3"], "x", 1) == [[20], [30]]
    assert reader.ends(["2", "2"], "x", 1) == [[20], [20]]
    for false in ("0", "-1", ["0", "1"], ["-1", "1"], ["3", "2"]):
        with pytest.raises(kernel.FalseError, match=r"\(A2\)"):
            reader.ends(false, "x", 1)
    for unreadable in (["1"], ["1", "2", "3"], [], None, True, {"low": "1"}, ["1", 2]):
        with pytest.raises(kernel.UnreadableError):
            reader.ends(unreadable, "x", 1)


def test_places_are_those_of_the_first_number() -> None:
    assert kernel.places_of({"a": {}, "b": [], "c": None, "d": 5}) == 0
    assert kernel.places_of({"a": "1.25 1.5", "b": ["1.125", "2"]}) == 3
    assert kernel.places_of("1." + "1" * 99 + " 1") == 99
    assert kernel.places_of("-" + "1" * 60 + "." + "1" * 100 + " 1") == 100
    assert kernel.places_of("1." + "1" * 10_000) == 198  # no more than 200 characters are looked at


def test_what_is_out_of_range_is_said_with_its_ends() -> None:
    with pytest.raises(kernel.FalseError, match=r"^x: all must be > 0 \(A2\), not -1\.5 to 2$"):
        read("0.5 -1.5 2.0")
    with pytest.raises(kernel.FalseError, match=r"^x: all must be from 0 to 2, not 1 to 7$"):
        kernel.Reader(4, 3).column("1 7 2", "x", None, 0, 3)


def test_a_column_of_no_numbers_is_empty() -> None:
    for text in ("1", "1 1{-1}", " "):
        with pytest.raises(kernel.UnreadableError, match="x: expected a string of 0 decimals"):
            read(text, 0)


def test_the_least_number_is_one_unit() -> None:
    assert kernel.Reader(0, 1).column("1", "x") == [1]
    for text in ("0", "-1"):
        with pytest.raises(kernel.FalseError, match=r"x: all must be > 0 \(A2\)"):
            kernel.Reader(0, 1).column(text, "x")


@pytest.mark.parametrize("distinct", [7, 10**6])
@pytest.mark.parametrize("count", [1, 19_999, 20_000, 20_001, 50_000])
def test_a_long_column_is_read_in_pieces_of_whole_numbers(count: int, distinct: int) -> None:
    numbers = [(-1) ** i * (i % distinct) for i in range(count)]
    assert list(kernel.integers(" ".join(map(str, numbers)), 10)) == [10 * number for number in numbers]


def test_equal_long_numbers_are_one_object() -> None:
    """A file of short numbers that are all alike is not blown up by the places of another."""
    assert len({id(number) for number in kernel.integers("700 800 700 700 700", 10**50)}) == 2


def test_a_column_has_no_more_places_than_the_certificate() -> None:
    with pytest.raises(kernel.UnreadableError, match="x: expected a string of 1 decimals"):
        kernel.Reader(1, 1).column("1.25", "x")


def test_one_vehicle_is_not_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel, "MAX_SIZE", 1)
    assert kernel.Reader(0, 1).unit == 1
    with pytest.raises(kernel.UnreadableError):
        kernel.Reader(0, 2)

"""Exact decimal numbers: in from files, out as text."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from numbers import Integral, Real
from typing import Annotated, Any, NamedTuple

from pydantic import PlainSerializer, PlainValidator
from pydantic_core import PydanticCustomError

MAX_DIGITS = 60  # significant digits of a number that is read
MAX_EXPONENT = 60  # its decimal exponent; both keep exact arithmetic bounded on hostile files


def exact(value: Any) -> Fraction:
    """The number that `value` (int, float, Decimal, Fraction or decimal text) prints as.

    Raises ValueError for anything else, for NaN and infinities, and for numbers of absurd size or length.
    """
    if isinstance(value, Fraction):
        return value
    return _of_text(value) if isinstance(value, str) else _checked(value)


@lru_cache(maxsize=2**14)
def _of_text(text: str) -> Fraction:
    """Large fleets repeat a few numbers: they share them."""
    return _checked(text)


def _checked(value: Any) -> Fraction:
    if isinstance(value, bool) or not isinstance(value, (Real, Decimal, str)):
        raise ValueError("is not a number")
    if isinstance(value, Real):  # NumPy's numbers, too
        value = int(value) if isinstance(value, Integral) else float(value)
    if isinstance(value, int) and abs(value) >= 10 ** (MAX_EXPONENT + 1):
        raise ValueError(f"is larger than 1e{MAX_EXPONENT}")
    try:
        number = Decimal(repr(value) if isinstance(value, float) else value)
    except ArithmeticError:
        raise ValueError("is not a number") from None
    if not number.is_finite():
        raise ValueError("is not finite")
    digits = number.as_tuple().digits
    count = len(digits) - (digits[-1] == 0)  # 1e60 written out has one digit more, a zero, and must be readable
    if number and (abs(number.adjusted()) > MAX_EXPONENT or count > MAX_DIGITS):
        raise ValueError(f"has more than {MAX_DIGITS} digits or an exponent beyond {MAX_EXPONENT}")
    return Fraction(number)


def decimal_text(number: Fraction) -> str:
    """The exact decimal expansion of a fraction whose denominator has no prime factor but 2 and 5.

    Raises ValueError for a fraction that no decimal equals.
    """
    if number.denominator == 1:
        return str(number.numerator)
    places = decimal_places(number.denominator)
    if places is None:
        raise ValueError(f"{number} is no decimal number")
    digits = str(abs(number.numerator) * 10**places // number.denominator).rjust(places + 1, "0")
    return ("-" if number.numerator < 0 else "") + digits[:-places] + "." + digits[-places:]


@lru_cache(maxsize=2**10)
def decimal_places(denominator: int) -> int | None:
    """How many places after the point a fraction in lowest terms has; None if no decimal equals it."""
    twos = (denominator & -denominator).bit_length() - 1
    rest, fives = denominator >> twos, 0
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    return max(twos, fives) if rest == 1 else None


class Interval(NamedTuple):
    """Bounds of a parameter that is not known exactly."""

    low: Fraction
    high: Fraction


def low(parameter: Fraction | Interval) -> Fraction:
    """The smallest value that a parameter may have."""
    return parameter.low if isinstance(parameter, Interval) else parameter


def high(parameter: Fraction | Interval) -> Fraction:
    """The largest value that a parameter may have."""
    return parameter.high if isinstance(parameter, Interval) else parameter


def nominal(parameter: Fraction | Interval) -> Fraction:
    """The value for simulations: the midpoint of an interval."""
    return (parameter.low + parameter.high) / 2 if isinstance(parameter, Interval) else parameter


def _validated(requirement: str, admits: Any) -> PlainValidator:
    def check(value: Any) -> Fraction:
        try:
            number = exact(value)
        except ValueError as error:
            raise PydanticCustomError(
                "number", "{why}; it must be {what}", {"why": str(error), "what": requirement}
            ) from None
        if not admits(number):
            raise PydanticCustomError("number", "must be {what}", {"what": requirement})
        return number

    return PlainValidator(check)


_AS_TEXT = PlainSerializer(decimal_text, return_type=str)

Number = Annotated[Fraction, _validated("a finite number", lambda _: True), _AS_TEXT]
Positive = Annotated[Fraction, _validated("a number > 0", lambda q: q > 0), _AS_TEXT]
NotNegative = Annotated[Fraction, _validated("a number >= 0", lambda q: q >= 0), _AS_TEXT]


def _interval(relation: str, admits: Callable[[Fraction], bool]) -> PlainValidator:
    """A number, or [low, high] with low <= high; an interval of one point is that number."""

    def check(value: Any) -> Fraction | Interval:
        ends = list(value) if isinstance(value, (list, tuple)) else [value, value]
        try:
            numbers = [exact(end) for end in ends]
        except ValueError as error:
            raise PydanticCustomError(
                "number", "{why}; it must be a number {relation} 0", {"why": str(error), "relation": relation}
            ) from None
        if len(numbers) != 2 or not admits(numbers[0]) or numbers[0] > numbers[1]:
            raise PydanticCustomError(
                "number",
                "must be a number {relation} 0, or [low, high] with 0 {turned} low <= high",
                {"relation": relation, "turned": relation.replace(">", "<")},
            )
        return numbers[0] if numbers[0] == numbers[1] else Interval(*numbers)

    return PlainValidator(check)


def _uncertain_text(parameter: Fraction | Interval) -> str | list[str]:
    return list(map(decimal_text, parameter)) if isinstance(parameter, Interval) else decimal_text(parameter)


_AS_TEXTS = PlainSerializer(_uncertain_text, return_type=str | list[str])

Uncertain = Annotated[Fraction | Interval, _interval(">", lambda q: q > 0), _AS_TEXTS]
UncertainOrZero = Annotated[Fraction | Interval, _interval(">=", lambda q: q >= 0), _AS_TEXTS]

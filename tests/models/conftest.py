"""The laws of the model hold for every choice of the saturation scales: here gains come with random ones."""

from fractions import Fraction

import numpy as np
import pytest
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.saturation import Saturation


@pytest.fixture
def draw_gains(random):
    """n -> exact random gains and scales for n vehicles."""

    def numbers(low, high, n):
        return np.array([Fraction(int(value), 1000) for value in random.integers(low, high, n)], dtype=object)

    def draw(n):
        position, heading = numbers(200, 3000, 2)
        saturation = Saturation(position, heading, numbers(200, 3000, n), numbers(200, 3000, n))
        return Gains(*(numbers(100, 9000, n) for _ in GAIN_NAMES), saturation)

    return draw

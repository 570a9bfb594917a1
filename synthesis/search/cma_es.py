"""CMA-ES, the evolution strategy with an adapted covariance matrix (Hansen, "The CMA Evolution Strategy: A Tutorial").

Samples are drawn with the symmetric root of the covariance. Unlike its eigenvectors that is a smooth function of the
matrix: processors that round differently draw the same samples, up to rounding.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LEAST = 1e-12  # of an eigenvalue of the covariance


class CmaEs:
    """One run of the strategy, with positive and negative weights."""

    def __init__(self, begin: Floats, spread: float, population: int, seed: int) -> None:
        """Begin at a point (n,) with a standard deviation, the same for all variables."""
        n, half = len(begin), population // 2
        raw = math.log((population + 1) / 2) - np.log(np.arange(1, population + 1))
        positive, negative = raw[:half], raw[half:]
        mu = float(positive.sum() ** 2 / (positive**2).sum())
        mu_negative = float(negative.sum() ** 2 / (negative**2).sum())
        self.mean, self.spread = np.array(begin, dtype=float), spread
        self._population, self._half, self._mu = population, half, mu
        self._c_c = (4 + mu / n) / (n + 4 + 2 * mu / n)
        self._c_sigma = (mu + 2) / (n + mu + 5)
        self._c_1 = 2 / ((n + 1.3) ** 2 + mu)
        self._c_mu = min(1 - self._c_1, 2 * (0.25 + mu - 2 + 1 / mu) / ((n + 2) ** 2 + mu))
        self._damping = 1 + 2 * max(0.0, math.sqrt((mu - 1) / (n + 1)) - 1) + self._c_sigma
        most = min(
            1 + self._c_1 / self._c_mu,
            1 + 2 * mu_negative / (mu + 2),
            (1 - self._c_1 - self._c_mu) / (n * self._c_mu),
        )
        self._weights = np.concatenate([positive / positive.sum(), negative / np.abs(negative).sum() * most])
        self._covariance = np.eye(n)
        self._path, self._sigma_path = np.zeros(n), np.zeros(n)
        self._expected = math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))  # length of a standard normal vector
        self._generation = 0
        self._random = np.random.default_rng(seed)
        self._inverse = np.eye(n)  # of the root of the covariance

    def ask(self) -> Floats:
        """The points (population, n) of the next generation."""
        values, vectors = np.linalg.eigh(self._covariance)
        roots = np.sqrt(np.maximum(values, LEAST))
        self._inverse = (vectors / roots) @ vectors.T
        normal = self._random.standard_normal((self._population, len(self.mean)))
        return np.asarray(self.mean + self.spread * normal @ ((vectors * roots) @ vectors.T))

    def tell(self, points: Floats, costs: Floats) -> None:
        """Learn from the costs (population,) of points (population, n), of which only the order counts."""
        n, mu = len(self.mean), self._mu
        steps = (points[np.argsort(costs, kind="stable")] - self.mean) / self.spread
        step = self._weights[: self._half] @ steps[: self._half]
        self.mean = self.mean + self.spread * step
        self._generation += 1
        remembered = math.sqrt(self._c_sigma * (2 - self._c_sigma) * mu)
        self._sigma_path = (1 - self._c_sigma) * self._sigma_path + remembered * (self._inverse @ step)
        length = float(np.sqrt((self._sigma_path**2).sum()))
        settled = math.sqrt(1 - (1 - self._c_sigma) ** (2 * self._generation))
        moving = length / settled < (1.4 + 2 / (n + 1)) * self._expected
        remembered = math.sqrt(self._c_c * (2 - self._c_c) * mu)
        self._path = (1 - self._c_c) * self._path + moving * remembered * step
        squares = np.maximum(((steps @ self._inverse) ** 2).sum(axis=1), LEAST)
        weights = np.where(self._weights >= 0, self._weights, self._weights * n / squares)
        forgotten = (
            self._c_1 + self._c_mu * self._weights.sum() - (not moving) * self._c_1 * self._c_c * (2 - self._c_c)
        )
        learned = self._c_1 * np.outer(self._path, self._path) + self._c_mu * (steps.T * weights) @ steps
        self._covariance = (1 - forgotten) * self._covariance + learned
        self.spread *= math.exp(min(1.0, self._c_sigma / self._damping * (length / self._expected - 1)))

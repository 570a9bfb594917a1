"""Candidates from the convex programs: each channel as fast as its share of the torque admits."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING

import numpy as np

from ...models.errors import UndecidedError
from ...models.gains import Gains
from .convex import fastest, nearest, rotation, translation

if TYPE_CHECKING:
    from ..design import Task

LOG = logging.getLogger(__name__)
DENSE_VEHICLES = 60  # beyond, the matrix inequalities take too long for a candidate
TRANSLATION_SHARES = (0.3, 0.6)  # of the torque limit
EXCITATION = 1.0  # sqrt2 k psi_bar / p_omega that the heading channel is given room for


def convex_designs(task: Task) -> list[tuple[Gains, float]]:
    """(gains as floats, tempo of psi) with the fastest heading and along-track rates; none for large fleets."""
    if len(task.fleet) > DENSE_VEHICLES:
        return []
    designs = []
    try:
        for share in TRANSLATION_SHARES:
            designs += _designs(task, share)
    except UndecidedError as error:
        LOG.warning("convex programs: broken off: %s", error)
    if not designs:
        LOG.warning("convex programs: left out, because Clarabel finds no gains that it calls optimal")
    return designs


def _designs(task: Task, share: float) -> list[tuple[Gains, float]]:
    """The design with a share of the torque for the translation, if Clarabel finds it."""
    laplacian = task.plant.graph.composed_laplacian().toarray()
    k_ratio = EXCITATION / (math.sqrt(2) * float(task.limits.psi_bar))
    along = fastest(translation(task.plant, task.limits, share), laplacian)
    heading = fastest(rotation(task.plant, task.limits, 1 - share, EXCITATION), laplacian, EXCITATION / math.tanh(1))
    if along is None or heading is None:
        return []
    (gamma_v, p_v, d_v), (_, p_omega, d_omega) = along, heading
    gains = nearest(task.conditions, task.limits, Gains(p_v, d_v, p_omega, d_omega, k_ratio * p_omega))
    # psi moves the vehicles best where the along-track channel still answers: about its own rate.
    return [] if gains is None else [(gains, float(np.clip(gamma_v, *task.tempo_range)))]

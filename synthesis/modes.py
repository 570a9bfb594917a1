"""The slowest modes of D^-1 L_l. The last remaining errors have the shape of these modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..models.graph import Graph

Floats = NDArray[np.float64]

MODES = 8  # number of modes used in a large fleet


@dataclass(frozen=True)
class Modes:
    """The slowest modes of D^-1 L_l."""

    eigenvalues: Floats  # (J,), lambda
    vectors: Floats  # (N, J), U with U^T D U = 1


def modes(graph: Graph, count: int = MODES) -> Modes:
    """The `count` slowest modes of a graph with float weights."""
    from scipy.linalg import eigh
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import eigsh

    root = diags_array(1 / np.sqrt(graph.degree))
    normalised = root @ graph.composed_laplacian() @ root
    if graph.vehicles <= 4 * count:
        eigenvalues, vectors = eigh(normalised.toarray())
        eigenvalues, vectors = eigenvalues[:count], vectors[:, :count]
    else:
        eigenvalues, vectors = eigsh(normalised.tocsc(), k=count, sigma=0, which="LM", v0=np.ones(graph.vehicles))
    return Modes(eigenvalues, root @ vectors)

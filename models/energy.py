"""The energies of the proof: V (17), W (19), and the modified energy W-hat of the corrected theorem (lemma L5)."""

from __future__ import annotations

from .algebra.ops import Ops
from .arrays import Array
from .equations import (
    Plant,
    State,
    along,
    consensus_errors,
    excitation_input,
    formation_coordinates,
    leader_coordinates,
)
from .gains import Gains
from .graph import Graph


def potential(ops: Ops, graph: Graph, scale: Array, z: Array, z_leader: Array) -> Array:
    """sum_i a_il l log cosh((z_i - z_l) / l) + sum over edges of a_ij l log cosh((z_i - z_j) / l), with the scale l.

    Its gradient is (8) or (10). (17) and (19) count each edge twice and halve. Here each edge counts once, so
    there is no 1/2.
    """
    to_leader = graph.leader_weight * scale * ops.log_cosh((z - z_leader) / scale)
    between = graph.weight * scale * ops.log_cosh(ops.edge_difference(graph, z) / scale)
    return total(to_leader) + total(between)


def translational(ops: Ops, plant: Plant, gains: Gains, state: State) -> Array:
    """V of (17)."""
    kinetic = plant.m / gains.p_v * state.v * state.v / 2
    scale, graph = gains.saturation.position, plant.graph
    x, y, _ = zip(formation_coordinates(plant, state), leader_coordinates(plant), strict=True)
    return total(kinetic) + potential(ops, graph, scale, *x) + potential(ops, graph, scale, *y)


def rotational(ops: Ops, plant: Plant, gains: Gains, state: State) -> Array:
    """W of (19)."""
    kinetic = plant.inertia / gains.p_omega * state.omega * state.omega / 2
    scale = gains.saturation.heading
    return total(kinetic) + potential(ops, plant.graph, scale, state.theta, plant.leader_theta)


def translational_dissipation(ops: Ops, gains: Gains, state: State) -> Array:
    """P_v of (18): V' = -P_v."""
    return total(gains.d_v / gains.p_v * state.v * ops.tanh(state.v / gains.saturation.speed))


def rotational_dissipation(ops: Ops, gains: Gains, state: State) -> Array:
    """P_w of (20): W' = -P_w + sum omega alpha / p_omega."""
    return total(gains.d_omega / gains.p_omega * state.omega * ops.tanh(state.omega / gains.saturation.turn_rate))


def rotational_input(ops: Ops, plant: Plant, gains: Gains, psi: Array, state: State) -> Array:
    """sum omega_i alpha_i / p_omega_i of (20)."""
    errors = consensus_errors(ops, plant, gains.saturation, state)
    return total(state.omega * excitation_input(ops, gains, psi, state, errors) / gains.p_omega)


def modified(ops: Ops, plant: Plant, gains: Gains, psi: Array, psi_rate: Array, state: State) -> Array:
    """W-hat of lemma L5: W - sum (k / p_omega) [psi q + (m / p_v) psi' v]."""
    errors = consensus_errors(ops, plant, gains.saturation, state)
    q = along(ops, state.theta, errors.x, errors.y)
    correction = gains.k_alpha / gains.p_omega * (psi * q + plant.m / gains.p_v * psi_rate * state.v)
    return rotational(ops, plant, gains, state) - total(correction)


def total(terms: Array) -> Array:
    """The sum over vehicles or edges: the last axis of an array, all of a CasADi column."""
    if hasattr(terms, "is_column"):
        import casadi as ca

        return ca.sum1(terms)
    return terms.sum(axis=-1)

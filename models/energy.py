"""The energies of the proof: V (17), W (19), and the modified energy W-hat of the corrected theorem (lemma L5)."""

from __future__ import annotations

from .algebra.ops import Ops
from .arrays import Array
from .equations import Plant, State, along, excitation_input, position_error
from .gains import Gains
from .graph import Graph


def potential(ops: Ops, graph: Graph, z: Array, z_leader: Array) -> Array:
    """sum_i a_il log cosh(z_i - z_l) + sum over edges of a_ij log cosh(z_i - z_j); its gradient is (8) or (10).

    The 1/2 of (17) and (19) is the one that undoes their counting every edge twice.
    """
    to_leader = graph.leader_weight * ops.log_cosh(z - z_leader)
    between = graph.weight * ops.log_cosh(ops.edge_difference(graph, z))
    return total(to_leader) + total(between)


def translational(ops: Ops, plant: Plant, gains: Gains, state: State) -> Array:
    """V of (17)."""
    kinetic = plant.m / gains.p_v * state.v * state.v / 2
    in_x = potential(ops, plant.graph, state.x - plant.offset_x, plant.leader_x)
    in_y = potential(ops, plant.graph, state.y - plant.offset_y, plant.leader_y)
    return total(kinetic) + in_x + in_y


def rotational(ops: Ops, plant: Plant, gains: Gains, state: State) -> Array:
    """W of (19)."""
    kinetic = plant.inertia / gains.p_omega * state.omega * state.omega / 2
    return total(kinetic) + potential(ops, plant.graph, state.theta, plant.leader_theta)


def translational_dissipation(ops: Ops, gains: Gains, state: State) -> Array:
    """P_v of (18): V' = -P_v."""
    return total(gains.d_v / gains.p_v * state.v * ops.tanh(state.v))


def rotational_dissipation(ops: Ops, gains: Gains, state: State) -> Array:
    """P_w of (20): W' = -P_w + sum omega alpha / p_omega."""
    return total(gains.d_omega / gains.p_omega * state.omega * ops.tanh(state.omega))


def rotational_input(ops: Ops, plant: Plant, gains: Gains, psi: Array, state: State) -> Array:
    """sum omega_i alpha_i / p_omega_i of (20)."""
    return total(state.omega * excitation_input(ops, plant, gains, psi, state) / gains.p_omega)


def modified(ops: Ops, plant: Plant, gains: Gains, psi: Array, psi_rate: Array, state: State) -> Array:
    """W-hat of lemma L5: W - sum (k / p_omega) [psi q + (m / p_v) psi' v]."""
    q = along(ops, state.theta, *position_error(ops, plant, state))
    correction = gains.k_alpha / gains.p_omega * (psi * q + plant.m / gains.p_v * psi_rate * state.v)
    return rotational(ops, plant, gains, state) - total(correction)


def total(terms: Array) -> Array:
    """The sum over vehicles or edges: the last axis of an array, all of a CasADi column."""
    if hasattr(terms, "is_column"):
        import casadi as ca

        return ca.sum1(terms)
    return terms.sum(axis=-1)

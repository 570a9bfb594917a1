"""The paper's equations, once: the vehicle (1)-(2), the controller (6)-(11) and the closed loop (13)-(14).

Every function is written over `ops` and over arrays of shape (..., N); `unbounded(ops)` turns the bounded scheme
into the comparison scheme of Section 4. Both drive conventions are one formula with a signed lever arm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import NamedTuple

from .algebra.ops import Ops
from .arrays import Array
from .excitation import Excitation
from .gains import Gains
from .graph import Graph


class State(NamedTuple):
    """Poses and velocities of the fleet; as a derivative, their rates."""

    x: Array  # (..., N), m
    y: Array  # (..., N), m
    theta: Array  # (..., N), rad, on the real line
    v: Array  # (..., N), m/s
    omega: Array  # (..., N), rad/s


@dataclass(frozen=True, eq=False)
class Plant:
    """The numbers in (1)-(14) that are not gains, all of one number type."""

    graph: Graph
    m: Array  # (N,), kg
    inertia: Array  # (N,), kg m^2, I_i
    r: Array  # (N,), m, wheel radius
    arm: Array  # (N,), m, lever arm of the left wheel: 2R in (2) as printed, -R on a physical drive
    offset_x: Array  # (N,), m, delta_x
    offset_y: Array  # (N,), m, delta_y
    leader_x: Array  # m
    leader_y: Array  # m
    leader_theta: Array  # rad

    def map(self, convert: Callable[[Array], Array]) -> Plant:
        """The same plant with every array converted."""
        values = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "graph"}
        return Plant(self.graph.map(convert), **{name: convert(value) for name, value in values.items()})


def wheel_torques(plant: Plant, u_v: Array, u_omega: Array) -> tuple[Array, Array]:
    """(6): left and right torque, N m, from the force u_v (N) and the moment u_omega (N m)."""
    return plant.r / 2 * (u_v + u_omega / plant.arm), plant.r / 2 * (u_v - u_omega / plant.arm)


def accelerations(plant: Plant, tau_left: Array, tau_right: Array) -> tuple[Array, Array]:
    """(2): v' and omega' from the wheel torques."""
    force = (tau_left + tau_right) / plant.r
    moment = plant.arm * (tau_left - tau_right) / plant.r
    return force / plant.m, moment / plant.inertia


def consensus_error(ops: Ops, graph: Graph, z: Array, z_leader: Array) -> Array:
    """(8) for one coordinate and (10): a_il tanh(z_i - z_l) + sum_j a_ij tanh(z_i - z_j)."""
    to_leader = graph.leader_weight * ops.tanh(z - z_leader)
    between = graph.weight * ops.tanh(ops.edge_difference(graph, z))
    return to_leader + ops.edge_sum(graph, between)


def position_error(ops: Ops, plant: Plant, state: State) -> tuple[Array, Array]:
    """(8): the two components of e_z."""
    return (
        consensus_error(ops, plant.graph, state.x - plant.offset_x, plant.leader_x),
        consensus_error(ops, plant.graph, state.y - plant.offset_y, plant.leader_y),
    )


def heading_error(ops: Ops, plant: Plant, state: State) -> Array:
    """(10): e_theta."""
    return consensus_error(ops, plant.graph, state.theta, plant.leader_theta)


def along(ops: Ops, theta: Array, e_x: Array, e_y: Array) -> Array:
    """phi(theta)^T e, the component along the heading."""
    return ops.cos(theta) * e_x + ops.sin(theta) * e_y


def across(ops: Ops, theta: Array, e_x: Array, e_y: Array) -> Array:
    """phi_perp(theta)^T e, the component across the heading."""
    return ops.cos(theta) * e_y - ops.sin(theta) * e_x


Error = tuple[Array, Array]  # e_z of (8), where it is known already


def linear_input(ops: Ops, plant: Plant, gains: Gains, state: State, error: Error | None = None) -> Array:
    """(7): u_v, N."""
    e_along = along(ops, state.theta, *(error or position_error(ops, plant, state)))
    return -gains.p_v * e_along - gains.d_v * ops.tanh(state.v)


def excitation_input(
    ops: Ops, plant: Plant, gains: Gains, psi: Array, state: State, error: Error | None = None
) -> Array:
    """(11): alpha, N m, where psi is the value of the excitation now."""
    return gains.k_alpha * psi * across(ops, state.theta, *(error or position_error(ops, plant, state)))


def angular_input(ops: Ops, plant: Plant, gains: Gains, psi: Array, state: State, error: Error | None = None) -> Array:
    """(9): u_omega, N m."""
    alpha = excitation_input(ops, plant, gains, psi, state, error)
    return -gains.p_omega * heading_error(ops, plant, state) - gains.d_omega * ops.tanh(state.omega) + alpha


def control(
    ops: Ops, plant: Plant, gains: Gains, excitation: Excitation, t: Array, state: State
) -> tuple[Array, Array]:
    """The controller: left and right wheel torque, N m, at time t."""
    error = position_error(ops, plant, state)
    u_v = linear_input(ops, plant, gains, state, error)
    u_omega = angular_input(ops, plant, gains, excitation.value(ops, t), state, error)
    return wheel_torques(plant, u_v, u_omega)


def closed_loop(ops: Ops, plant: Plant, gains: Gains, excitation: Excitation, t: Array, state: State) -> State:
    """(13)-(14): the rate of change of the state under the controller, through the torques (6) and the vehicle (2)."""
    return motion(ops, plant, state, *control(ops, plant, gains, excitation, t, state))


def motion(ops: Ops, plant: Plant, state: State, tau_left: Array, tau_right: Array) -> State:
    """(1)-(2): the rate of change of the state under wheel torques, N m."""
    v_rate, omega_rate = accelerations(plant, tau_left, tau_right)
    return State(
        ops.cos(state.theta) * state.v,
        ops.sin(state.theta) * state.v,
        state.omega,
        v_rate,
        omega_rate,
    )

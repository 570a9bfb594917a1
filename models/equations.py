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
from .gains import Gains
from .graph import Graph
from .saturation import Saturation


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


class Errors(NamedTuple):
    """The consensus errors: e_z of (8), and e_theta of (10)."""

    x: Array  # (..., N)
    y: Array  # (..., N)
    theta: Array  # (..., N)


def pull(ops: Ops, weight: Array, scale: Array, distance: Array) -> Array:
    """One term of (8) or (10): a link of weight a over a distance d pulls with a tanh(d / scale)."""
    return weight * ops.tanh(distance / scale)


def formation_coordinates(plant: Plant, state: State) -> tuple[Array, Array, Array]:
    """zbar = z - delta, m, of both coordinates, and theta, rad, (..., N) each. The graph compares these."""
    return state.x - plant.offset_x, state.y - plant.offset_y, state.theta


def leader_coordinates(plant: Plant) -> tuple[Array, Array, Array]:
    """z_l, m, and theta_l, rad: the values of the formation coordinates at the goal."""
    return plant.leader_x, plant.leader_y, plant.leader_theta


def coordinate_scales(saturation: Saturation) -> tuple[Array, Array, Array]:
    """The scales of the three formation coordinates: l, l (m) and rho (rad)."""
    return saturation.position, saturation.position, saturation.heading


def consensus_error(ops: Ops, graph: Graph, scale: Array, z: Array, z_leader: Array) -> Array:
    """(8) for one coordinate and (10): a_il tanh((z_i - z_l) / scale) + sum_j a_ij tanh((z_i - z_j) / scale)."""
    to_leader = pull(ops, graph.leader_weight, scale, z - z_leader)
    between = pull(ops, graph.weight, scale, ops.edge_difference(graph, z))
    return to_leader + ops.edge_sum(graph, between)


def consensus_errors(ops: Ops, plant: Plant, saturation: Saturation, state: State) -> Errors:
    """(8) and (10): e_z and e_theta."""
    parts = coordinate_scales(saturation), formation_coordinates(plant, state), leader_coordinates(plant)
    return Errors(*(consensus_error(ops, plant.graph, *part) for part in zip(*parts, strict=True)))


def along(ops: Ops, theta: Array, e_x: Array, e_y: Array) -> Array:
    """phi(theta)^T e, the component along the heading."""
    return ops.cos(theta) * e_x + ops.sin(theta) * e_y


def across(ops: Ops, theta: Array, e_x: Array, e_y: Array) -> Array:
    """phi_perp(theta)^T e, the component across the heading."""
    return ops.cos(theta) * e_y - ops.sin(theta) * e_x


def linear_input(ops: Ops, gains: Gains, state: State, errors: Errors) -> Array:
    """(7): u_v, N."""
    e_along = along(ops, state.theta, errors.x, errors.y)
    return -gains.p_v * e_along - gains.d_v * ops.tanh(state.v / gains.saturation.speed)


def excitation_input(ops: Ops, gains: Gains, psi: Array, state: State, errors: Errors) -> Array:
    """(11): alpha, N m, where psi is the value of the excitation now."""
    return gains.k_alpha * psi * across(ops, state.theta, errors.x, errors.y)


def angular_input(ops: Ops, gains: Gains, psi: Array, state: State, errors: Errors) -> Array:
    """(9): u_omega, N m, where psi is the value of the excitation now."""
    alpha = excitation_input(ops, gains, psi, state, errors)
    damping = gains.d_omega * ops.tanh(state.omega / gains.saturation.turn_rate)
    return -gains.p_omega * errors.theta - damping + alpha


def control(
    ops: Ops, plant: Plant, gains: Gains, psi: Array, state: State, errors: Errors | None = None
) -> tuple[Array, Array]:
    """The controller: left and right wheel torque, N m, where psi is the value of the excitation now.

    `errors` are (8) and (10) if they are known already.
    """
    errors = errors or consensus_errors(ops, plant, gains.saturation, state)
    u_v = linear_input(ops, gains, state, errors)
    u_omega = angular_input(ops, gains, psi, state, errors)
    return wheel_torques(plant, u_v, u_omega)


def closed_loop(ops: Ops, plant: Plant, gains: Gains, psi: Array, state: State, errors: Errors | None = None) -> State:
    """(13)-(14): the rate of change of the state under the controller, through the torques (6) and the vehicle (2)."""
    return motion(ops, plant, state, *control(ops, plant, gains, psi, state, errors))


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

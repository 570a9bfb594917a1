"""The ROS 2 export: parameters of one controller node per vehicle, and the node."""

from __future__ import annotations

import math
import re
from importlib.resources import files
from typing import Any

from ...models.conditions import exact_numbers
from ...models.equations import Plant
from ...models.gains import GAIN_NAMES
from ...models.motion_bounds import motion_bounds
from ...models.numbers import low, nominal
from ..deployment import Deployment
from ..escapes import yaml_text
from ..rendering import render
from ..tables.neighbours import Neighbours, neighbours

NODE = "gaincert_node.py"
RATE = 100.0  # Hz, of a fleet file without a sample_time
AGE = 0.1  # s, smallest age limit of poses
MISSED = 5  # poses in a row that may be lost before a robot stops
_ROS_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def ros2_files(deployed: Deployment, interface: str = "effort") -> dict[str, str]:
    """gaincert.yaml and gaincert_node.py, for wheels that take torques or for a base that takes velocities."""
    names, plant = namespaces(deployed.fleet.names), deployed.fleet.plant()
    near = neighbours(plant.graph)
    motion = motion_parameters(deployed) if interface == "velocity" else [{}] * len(names)
    nodes = [
        {
            "namespace": name,
            "parameters": {"interface": interface, **parameters(deployed, plant, near, names, i), **motion[i]},
        }
        for i, name in enumerate(names)
    ]
    return {
        "gaincert.yaml": render(
            "ros2.yaml", fleet=deployed.fleet, evidence=deployed.evidence, nodes=nodes, interface=interface
        ),
        NODE: (files("gaincert.reports") / "templates" / NODE).read_text(),
    }


def namespaces(names: list[str]) -> list[str]:
    """ROS namespaces: the vehicles' names if ROS accepts every name of the fleet, otherwise `vehicle_0`, ..."""
    if all(_ROS_NAME.fullmatch(name) and "__" not in name for name in names):
        return names
    return [f"vehicle_{i}" for i in range(len(names))]


def parameters(deployed: Deployment, plant: Plant, near: Neighbours, names: list[str], i: int) -> dict[str, str]:
    """Name -> YAML value for vehicle i. The names are those of ros2_control's diff_drive_controller, if it has them."""
    fleet, psi = deployed.fleet, deployed.excitation
    vehicle, links = fleet.vehicles[i], near.of(i)
    unit = 1 / math.pi if psi.over_pi else 1.0
    scales = deployed.gains.saturation.columns(len(fleet))
    origin = {key: value for key, value in deployed.evidence.items() if key != "casadi"}
    values: dict[str, Any] = {
        "vehicle": i,
        "fleet_size": len(fleet),
        "vehicle_name": vehicle.name,
        "drive": fleet.drive,
        "wheel_separation": float(2 * nominal(vehicle.half_track)),  # m
        "wheel_radius": float(nominal(vehicle.wheel_radius)),  # m
        "torque_limit_left": float(low(vehicle.torque_limit.left)),  # N m
        "torque_limit_right": float(low(vehicle.torque_limit.right)),  # N m
        "torque_bound": float(deployed.torque_bounds[i]),  # N m
        **{name: float(getattr(deployed.gains, name)[i]) for name in GAIN_NAMES},
        **{f"{name}_scale": float(column[i]) for name, column in scales.items()},  # m, rad, m/s, rad/s
        **timing(deployed),
        "leader_pose": [plant.leader_x, plant.leader_y, plant.leader_theta],  # m, m, rad
        "leader_weight": float(plant.graph.leader_weight[i]),
        "offset": [float(plant.offset_x[i]), float(plant.offset_y[i])],  # m
        "neighbours": [j for j, _ in links],
        "neighbour_namespaces": [names[j] for j, _ in links],
        "neighbour_weights": [weight for _, weight in links],
        "psi_mean": float(psi.mean),
        "psi_frequency": float(psi.frequency),  # rad/s
        "psi_sin": [unit * float(value) for value in psi.sin],
        "psi_cos": [unit * float(value) for value in psi.cos],
        **origin,
    }
    # ROS has no empty lists: leave the entry out and use the node's default.
    return {key: _yaml(value) for key, value in values.items() if value != []}


def timing(deployed: Deployment) -> dict[str, float]:
    """The rate (Hz) and the age limit of poses (s) that [disturbance] asks for, and the time when psi begins (s)."""
    table = deployed.fleet.disturbance
    sample_time = float(table.sample_time) if table and table.sample_time else 1 / RATE
    delay = float(table.delay) if table else 0.0
    return {"rate": 1 / sample_time, "max_age": max(AGE, MISSED * sample_time + delay), "start_time": 0.0}


def motion_parameters(deployed: Deployment) -> list[dict[str, str]]:
    """Certified bounds of every vehicle's motion from rest, under diff_drive_controller's names for limits.

    Rounded up: a base that allows them allows every commanded motion. A speed without a bound is left out.
    """
    numbers = exact_numbers()
    bounds = motion_bounds(numbers, deployed.fleet.condition_data(deployed.excitation), deployed.gains)
    rows = []
    for v, omega, a, a_omega in zip(*bounds, strict=True):
        limits: dict[str, Any] = {}
        for axis, speed, acceleration in (("linear.x", v, a), ("angular.z", omega, a_omega)):
            limits |= {f"{axis}.max_velocity": speed, f"{axis}.min_velocity": -speed}
            limits |= {f"{axis}.max_acceleration": acceleration, f"{axis}.max_deceleration": -acceleration}
        rows.append({key: _yaml(_away(value)) for key, value in limits.items() if abs(value) != math.inf})
    return rows


def _away(value: Any) -> float:
    """The float next to an exact number, away from 0."""
    return math.nextafter(float(value), math.copysign(math.inf, value))


def _yaml(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    if isinstance(value, float):
        text = repr(value)  # ROS reads a number with a point as a double
        return text if "." in text else text.replace("e", ".0e")
    return yaml_text(value) if isinstance(value, str) else str(value)

#!/usr/bin/env python3
"""A ROS 2 node that runs the generated gaincert controller on one robot of the fleet.

    make -f gaincert_controller.mk                                    builds libgaincert_controller.so
    python3 gaincert_node.py --ros-args -r __ns:=/v1 --params-file gaincert.yaml

Subscribes  odom (nav_msgs/Odometry)            the robot's own pose and velocity, in the frame that the fleet shares
            /NEIGHBOUR/gaincert_controller/pose what each neighbour's node publishes
Publishes   ~/pose (std_msgs/Float64MultiArray) x, y (m), theta (rad, on the real line)
            effort_controller/commands (std_msgs/Float64MultiArray)   left and right wheel torque, N m

The controller commands torques, so the wheels need the *effort* interface of ros2_control and an
effort_controllers/JointGroupEffortController with the joints [left, right]. The stock diff_drive_controller commands
velocities: its loop would stand between the proof and the wheels.

Headings live on the real line, not modulo 2 pi. Each node unwraps its own heading from the first reading on and
publishes it, so that all nodes mean the same number by it. The torques are 0 while a pose that is needed is older than
`max_age`. The proof is about continuous time: see `gaincert simulate --sample-time` before choosing `rate`.

Everything above `main` runs without ROS.
"""

from __future__ import annotations

import ctypes
import math
import sys
from pathlib import Path

try:
    import rclpy
    from nav_msgs.msg import Odometry
    from rclpy.node import Node
    from std_msgs.msg import Float64MultiArray
except ImportError:  # the pure part is used without ROS
    rclpy = None
    Node = object


class Library:
    """The generated C controller, loaded as a shared library."""

    def __init__(self, path: Path, gains_digest: str, size: int) -> None:
        """Load it. Raises ValueError where it was generated from other gains than the parameters."""
        self._c = ctypes.CDLL(str(path.resolve()))
        self._c.gaincert_gains_digest.restype = ctypes.c_char_p
        for name in ("gaincert_torque_bound", "gaincert_torque_limit"):
            getattr(self._c, name).restype = ctypes.c_double
        built = self._c.gaincert_gains_digest().decode()
        if built != gains_digest:
            raise ValueError(f"{path}: is of gains {built}, the parameters are of {gains_digest}; export both again")
        self.size = size  # vehicles in the fleet

    def neighbours(self, vehicle: int) -> list[int]:
        """The vehicles whose poses `torques` reads."""
        return [self._c.gaincert_neighbour(vehicle, k) for k in range(self._c.gaincert_neighbour_count(vehicle))]

    def torque_limit(self, vehicle: int) -> float:
        """The smaller torque limit of the vehicle's wheels, N m."""
        return float(self._c.gaincert_torque_limit(vehicle))

    def torques(self, vehicle: int, t: float, state: FleetState) -> tuple[float, float]:
        """Left and right wheel torque, N m, at time t (s)."""
        left, right = ctypes.c_double(), ctypes.c_double()
        arrays = (state.x, state.y, state.theta, state.v, state.omega)
        self._c.gaincert_torques(vehicle, ctypes.c_double(t), *arrays, ctypes.byref(left), ctypes.byref(right))
        return left.value, right.value


class FleetState:
    """What one robot knows of the fleet: C arrays over the vehicles, NaN where nothing is known, and how old it is."""

    def __init__(self, size: int) -> None:
        """Know nothing."""
        unknown = [math.nan] * size
        self.x, self.y, self.theta, self.v, self.omega = ((ctypes.c_double * size)(*unknown) for _ in range(5))
        self.heard = [-math.inf] * size  # s

    def own(self, vehicle: int, now: float, pose: tuple[float, float, float], v: float, omega: float) -> float:
        """Take the robot's own pose (m, m, rad modulo 2 pi) and velocities; returns the unwrapped heading."""
        theta = unwrapped(pose[2], self.theta[vehicle])
        self.hear(vehicle, now, (pose[0], pose[1], theta))
        self.v[vehicle], self.omega[vehicle] = v, omega
        return theta

    def hear(self, vehicle: int, now: float, pose: tuple[float, float, float]) -> None:
        """Take a pose whose heading is on the real line. One that is not finite is not heard."""
        if all(map(math.isfinite, pose)):
            self.x[vehicle], self.y[vehicle], self.theta[vehicle] = pose
            self.heard[vehicle] = now

    def fresh(self, vehicles: list[int], now: float, max_age: float) -> bool:
        """Whether the poses of these vehicles are no older than `max_age`, s."""
        return all(now - self.heard[vehicle] <= max_age for vehicle in vehicles)


def yaw(x: float, y: float, z: float, w: float) -> float:
    """The heading of a unit quaternion, rad in (-pi, pi]."""
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def unwrapped(angle: float, last: float) -> float:
    """The number equal to `angle` modulo 2 pi that is nearest to `last`; `angle` itself where `last` is not known."""
    return angle if math.isnan(last) else last + math.remainder(angle - last, math.tau)


def command(library: Library, vehicle: int, t: float, now: float, state: FleetState, max_age: float) -> list[float]:
    """What the wheels get: the controller's torques, N m, or 0 where a pose is too old or the result is no number."""
    if not state.fresh([vehicle, *library.neighbours(vehicle)], now, max_age):
        return [0.0, 0.0]
    torques = library.torques(vehicle, t, state)
    return list(torques) if all(map(math.isfinite, torques)) else [0.0, 0.0]


class GaincertNode(Node):  # type: ignore[misc]
    """Reads parameters, subscribes, and publishes torques at a fixed rate."""

    def __init__(self) -> None:
        """Load the library and start the timer."""
        super().__init__("gaincert_controller", automatically_declare_parameters_from_overrides=True)
        self.vehicle = self._parameter("vehicle")
        size = self._parameter("fleet_size")
        self.max_age = self._parameter("max_age", 0.1)  # s
        path = Path(self._parameter("library", "libgaincert_controller.so"))
        self.library = Library(path, self._parameter("gains_digest"), size)
        self.state = FleetState(size)
        self.start = self._now()
        self.torques = self.create_publisher(Float64MultiArray, "effort_controller/commands", 1)
        self.pose = self.create_publisher(Float64MultiArray, "~/pose", 1)
        self.create_subscription(Odometry, "odom", self._odometry, 1)
        names = self._parameter("neighbour_namespaces", [])
        for other, name in zip(self._parameter("neighbours", []), names, strict=True):
            topic = f"/{name}/gaincert_controller/pose"
            self.create_subscription(Float64MultiArray, topic, lambda message, j=other: self._neighbour(j, message), 1)
        self.create_timer(1 / self._parameter("rate", 100.0), self._step)

    def _parameter(self, name: str, default: object = None) -> object:
        if not self.has_parameter(name):
            if default is None:
                raise ValueError(f"parameter {name} is missing; start the node with --params-file gaincert.yaml")
            return default
        return self.get_parameter(name).value

    def _now(self) -> float:
        return self.get_clock().now().nanoseconds * 1e-9

    def _odometry(self, message: Odometry) -> None:
        place, turn, twist = message.pose.pose.position, message.pose.pose.orientation, message.twist.twist
        pose = (place.x, place.y, yaw(turn.x, turn.y, turn.z, turn.w))
        theta = self.state.own(self.vehicle, self._now(), pose, twist.linear.x, twist.angular.z)
        self.pose.publish(Float64MultiArray(data=[place.x, place.y, theta]))

    def _neighbour(self, vehicle: int, message: Float64MultiArray) -> None:
        if len(message.data) == 3:
            self.state.hear(vehicle, self._now(), tuple(message.data))

    def _step(self) -> None:
        now = self._now()
        data = command(self.library, self.vehicle, now - self.start, now, self.state, self.max_age)
        self.torques.publish(Float64MultiArray(data=data))


def main() -> None:
    """Run the node."""
    if rclpy is None:
        sys.exit("gaincert_node.py needs ROS 2 (rclpy, nav_msgs, std_msgs): source its setup file first")
    rclpy.init()
    rclpy.spin(GaincertNode())


if __name__ == "__main__":
    main()

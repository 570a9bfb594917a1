#!/usr/bin/env python3
"""A ROS 2 node that runs the generated gaincert controller on one robot of the fleet.

    make -f gaincert_controller.mk                                    builds libgaincert_controller.so
    python3 gaincert_node.py --ros-args -r __ns:=/v1 --params-file gaincert.yaml

Subscribes  odom (nav_msgs/Odometry)            the robot's own pose and velocity, in the frame that the fleet shares
            /NEIGHBOUR/gaincert_controller/pose from each neighbour's node
Publishes   ~/pose (std_msgs/Float64MultiArray) x, y (m), theta (rad, on the real line)
            effort_controller/commands (std_msgs/Float64MultiArray)   left and right wheel torque, N m
            cmd_vel (geometry_msgs/Twist)           for the interface `velocity`: m/s, rad/s

With the interface `effort` the wheels need the *effort* interface of ros2_control and an
effort_controllers/JointGroupEffortController with the joints [left, right].

The interface `velocity` is for any base that takes twists, such as diff_drive_controller. The node integrates the
controller's accelerations from the velocities that it *commanded*, so the commanded motion is the certified one. The
base has to follow: its own limits must not lie below the parameters linear.x.* and angular.z.*, which are certified.
If a pose is too old, the command goes to 0 within the certified acceleration.

Headings live on the real line, not modulo 2 pi. Each node unwraps its own heading from the first reading on and
publishes it, so that all nodes use the same number for it. The torques are 0 while a pose that is needed is older than
`max_age`. The proof is about continuous time: see `gaincert simulate --sample-time` before choosing `rate`.

All robots need the same time, because psi(t) must be the same for all: the node takes t = ROS time - `start_time`.
Keep the robots' clocks together (NTP or chrony do), and give all nodes the same `start_time`. The leader stands at
`leader_pose`: x, y (m), heading (rad).

Everything above `main` runs without ROS.
"""

from __future__ import annotations

import ctypes
import math
import sys
from pathlib import Path

try:
    import rclpy
    from geometry_msgs.msg import Twist, TwistStamped
    from nav_msgs.msg import Odometry
    from rclpy.node import Node
    from std_msgs.msg import Float64MultiArray
except ImportError:  # the pure part is used without ROS
    rclpy = None
    Node = object


class Library:
    """The generated C controller, loaded as a shared library."""

    def __init__(self, path: Path, controller_digest: str, size: int, leader: list[float] | None = None) -> None:
        """Load it for a leader at this pose (m, m, rad); None takes the pose that is compiled in.

        Raises ValueError if it was generated from other gains than the parameters.
        """
        self._c = ctypes.CDLL(str(path.resolve()))
        self._c.gaincert_controller_digest.restype = ctypes.c_char_p
        for name in ("gaincert_torque_bound", "gaincert_torque_limit"):
            getattr(self._c, name).restype = ctypes.c_double
        built = self._c.gaincert_controller_digest().decode()
        if built != controller_digest:
            raise ValueError(
                f"{path}: was built for the controller {built}, the parameters for {controller_digest}; "
                "export both again"
            )
        self.size = size  # vehicles in the fleet
        self._leader = None if leader is None else (ctypes.c_double * 3)(*leader)

    def neighbours(self, vehicle: int) -> list[int]:
        """The vehicles whose poses `torques` reads."""
        return [self._c.gaincert_neighbour(vehicle, k) for k in range(self._c.gaincert_neighbour_count(vehicle))]

    def torque_limit(self, vehicle: int) -> float:
        """The smaller torque limit of the vehicle's wheels, N m."""
        return float(self._c.gaincert_torque_limit(vehicle))

    def torques(self, vehicle: int, t: float, state: FleetState) -> tuple[float, float]:
        """Left and right wheel torque, N m, at time t (s)."""
        return self._pair("gaincert_torques", vehicle, t, state)

    def accelerations(self, vehicle: int, t: float, state: FleetState) -> tuple[float, float]:
        """The accelerations v' and omega' under these torques, m/s^2 and rad/s^2."""
        return self._pair("gaincert_accelerations", vehicle, t, state)

    def _pair(self, name: str, vehicle: int, t: float, state: FleetState) -> tuple[float, float]:
        first, second = ctypes.c_double(), ctypes.c_double()
        arrays = (state.x, state.y, state.theta, state.v, state.omega)
        function = getattr(self._c, name if self._leader is None else f"{name}_led")
        leader = () if self._leader is None else (self._leader,)
        function(*leader, vehicle, ctypes.c_double(t), *arrays, ctypes.byref(first), ctypes.byref(second))
        return first.value, second.value


class FleetState:
    """One robot's knowledge of the fleet: C arrays over the vehicles, NaN if unknown, and its age."""

    def __init__(self, size: int) -> None:
        """Start without knowledge."""
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
        """Take a pose whose heading is on the real line. Poses that are not finite are ignored."""
        if all(map(math.isfinite, pose)):
            self.x[vehicle], self.y[vehicle], self.theta[vehicle] = pose
            self.heard[vehicle] = now

    def pose(self, vehicle: int) -> tuple[float, float, float]:
        """The last known pose of a vehicle."""
        return self.x[vehicle], self.y[vehicle], self.theta[vehicle]

    def place(self, vehicle: int, values: list[float]) -> None:
        """Set x, y, theta, v and omega of a vehicle, without hearing it."""
        arrays = (self.x, self.y, self.theta, self.v, self.omega)
        for array, value in zip(arrays, values, strict=True):
            array[vehicle] = value

    def fresh(self, vehicles: list[int], now: float, max_age: float) -> bool:
        """Whether the poses of these vehicles are no older than `max_age`, s."""
        return all(now - self.heard[vehicle] <= max_age for vehicle in vehicles)


def yaw(x: float, y: float, z: float, w: float) -> float:
    """The heading of a unit quaternion, rad in (-pi, pi]."""
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def unwrapped(angle: float, last: float) -> float:
    """The number equal to `angle` modulo 2 pi that is nearest to `last`; `angle` itself if `last` is not known."""
    return angle if math.isnan(last) else last + math.remainder(angle - last, math.tau)


def command(library: Library, vehicle: int, t: float, now: float, state: FleetState, max_age: float) -> list[float]:
    """The command for the wheels: the controller's torques, N m, or 0 if a pose is too old or the result is NaN."""
    if not state.fresh([vehicle, *library.neighbours(vehicle)], now, max_age):
        return [0.0, 0.0]
    torques = library.torques(vehicle, t, state)
    return list(torques) if all(map(math.isfinite, torques)) else [0.0, 0.0]


class CommandedVelocity:
    """The commanded twist of a base: (13)-(14) integrated from the last commanded twist."""

    def __init__(self, library: Library, vehicle: int, acceleration: float, turn_acceleration: float) -> None:
        """Start at rest. The accelerations (m/s^2, rad/s^2) are for stopping."""
        self.library, self.vehicle = library, vehicle
        self.limits = acceleration, turn_acceleration
        self.twist = 0.0, 0.0  # m/s, rad/s

    def advance(self, t: float, step: float, now: float, state: FleetState, max_age: float) -> tuple[float, float]:
        """The twist at t + step, if all required poses are new enough, else a step towards 0."""
        near = [self.vehicle, *self.library.neighbours(self.vehicle)]
        ahead = self._integrated(t, step, state) if state.fresh(near, now, max_age) else self._slower(step)
        self.twist = ahead if all(map(math.isfinite, ahead)) else self._slower(step)
        return self.twist

    def _integrated(self, t: float, step: float, state: FleetState) -> tuple[float, float]:
        """One step of the classical Runge-Kutta method for the robot's own motion, with fixed neighbours."""
        start = [*state.pose(self.vehicle), *self.twist]
        slope, total = [0.0] * 5, [0.0] * 5
        for share, weight in ((0.0, 1), (0.5, 2), (0.5, 2), (1.0, 1)):
            own = [value + share * step * rate for value, rate in zip(start, slope, strict=True)]
            slope = self._slope(t + share * step, own, state)
            total = [before + weight * rate for before, rate in zip(total, slope, strict=True)]
        state.place(self.vehicle, start)
        return start[3] + step / 6 * total[3], start[4] + step / 6 * total[4]

    def _slope(self, t: float, own: list[float], state: FleetState) -> list[float]:
        """The rate of change of own x, y, theta, v, omega on a base that follows its commands."""
        state.place(self.vehicle, own)
        _, _, theta, v, omega = own
        return [v * math.cos(theta), v * math.sin(theta), omega, *self.library.accelerations(self.vehicle, t, state)]

    def _slower(self, step: float) -> tuple[float, float]:
        v, omega = (
            math.copysign(max(0.0, abs(speed) - limit * step), speed)
            for speed, limit in zip(self.twist, self.limits, strict=True)
        )
        return v, omega


class GaincertNode(Node):  # type: ignore[misc]
    """Reads parameters, subscribes, and publishes torques at a fixed rate."""

    def __init__(self) -> None:
        """Load the library and start the timer."""
        super().__init__("gaincert_controller", automatically_declare_parameters_from_overrides=True)
        self.vehicle = self._parameter("vehicle")
        size = self._parameter("fleet_size")
        self.max_age = self._parameter("max_age", 0.1)  # s
        path = Path(self._parameter("library", "libgaincert_controller.so"))
        self.library = Library(path, self._parameter("controller_digest"), size, self._parameter("leader_pose"))
        self.state = FleetState(size)
        self.start = self._parameter("start_time", 0.0)  # s, ROS time; the same for all nodes
        self.velocity = self._parameter("interface", "effort") == "velocity"
        if self.velocity:
            limits = (self._parameter(f"{axis}.max_acceleration") for axis in ("linear.x", "angular.z"))
            self.commanded = CommandedVelocity(self.library, self.vehicle, *limits)
            self.twist = TwistStamped if self._parameter("use_stamped_vel", False) else Twist
            self.twists = self.create_publisher(self.twist, "cmd_vel", 1)
        else:
            self.torques = self.create_publisher(Float64MultiArray, "effort_controller/commands", 1)
        self.pose = self.create_publisher(Float64MultiArray, "~/pose", 1)
        self.create_subscription(Odometry, "odom", self._odometry, 1)
        names = self._parameter("neighbour_namespaces", [])
        for other, name in zip(self._parameter("neighbours", []), names, strict=True):
            topic = f"/{name}/gaincert_controller/pose"
            self.create_subscription(Float64MultiArray, topic, lambda message, j=other: self._neighbour(j, message), 1)
        self.period = 1 / self._parameter("rate", 100.0)  # s
        self.create_timer(self.period, self._step)

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
        if self.velocity:
            twist = self.commanded.advance(now - self.start, self.period, now, self.state, self.max_age)
            self._publish_twist(*twist)
            return
        data = command(self.library, self.vehicle, now - self.start, now, self.state, self.max_age)
        self.torques.publish(Float64MultiArray(data=data))

    def _publish_twist(self, v: float, omega: float) -> None:
        message = self.twist()
        body = message
        if self.twist is TwistStamped:
            message.header.stamp = self.get_clock().now().to_msg()
            body = message.twist
        body.linear.x, body.angular.z = v, omega
        self.twists.publish(message)


def main() -> None:
    """Run the node."""
    if rclpy is None:
        sys.exit("gaincert_node.py needs ROS 2 (rclpy, geometry_msgs, nav_msgs, std_msgs): source its setup file first")
    rclpy.init()
    rclpy.spin(GaincertNode())


if __name__ == "__main__":
    main()

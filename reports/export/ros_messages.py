"""ROS 2 messages as bytes: definitions and their CDR encoding, as recorders write them into MCAP files."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence

_BAR = "\n" + "=" * 80 + "\nMSG: "
_TIME = "builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
_HEADER = f"std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n{_BAR}{_TIME}"
_POINT = "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
_VECTOR = "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
_QUATERNION = "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
DEFINITIONS = {
    "geometry_msgs/msg/PoseStamped": (
        f"std_msgs/Header header\ngeometry_msgs/Pose pose\n{_BAR}{_HEADER}"
        f"{_BAR}geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"
        f"{_BAR}{_POINT}{_BAR}{_QUATERNION}"
    ),
    "geometry_msgs/msg/TwistStamped": (
        f"std_msgs/Header header\ngeometry_msgs/Twist twist\n{_BAR}{_HEADER}"
        f"{_BAR}geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n{_BAR}{_VECTOR}"
    ),
    "sensor_msgs/msg/JointState": (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
        f"{_BAR}{_HEADER}"
    ),
    "tf2_msgs/msg/TFMessage": (
        f"geometry_msgs/TransformStamped[] transforms\n{_BAR}geometry_msgs/TransformStamped\n"
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"
        f"{_BAR}{_HEADER}{_BAR}geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
        f"geometry_msgs/Quaternion rotation\n{_BAR}{_VECTOR}{_BAR}{_QUATERNION}"
    ),
}


class Message:
    """One message, written field by field in little-endian CDR: each number is aligned to its own size."""

    def __init__(self) -> None:
        """Begin with the encapsulation header."""
        self._bytes = bytearray()

    def number(self, kind: str, *values: float) -> Message:
        """Numbers of one struct format: i and I (4 bytes), d (8 bytes)."""
        size = struct.calcsize(kind)
        self._bytes += b"\0" * (-len(self._bytes) % size) + struct.pack(f"<{len(values)}{kind}", *values)
        return self

    def text(self, text: str) -> Message:
        """A string: its length with the closing zero, then its bytes."""
        data = text.encode() + b"\0"
        self.number("I", len(data))
        self._bytes += data
        return self

    def numbers(self, values: Sequence[float]) -> Message:
        """A sequence of doubles."""
        self.number("I", len(values))
        return self.number("d", *values) if len(values) else self

    def header(self, nanoseconds: int, frame: str) -> Message:
        """A std_msgs/Header."""
        seconds, rest = divmod(nanoseconds, 10**9)
        return self.number("i", seconds).number("I", rest).text(frame)

    def data(self) -> bytes:
        """The encoded message."""
        return b"\0\1\0\0" + bytes(self._bytes)


def pose(nanoseconds: int, x: float, y: float, theta: float) -> bytes:
    """A PoseStamped in the frame `map`."""
    return Message().header(nanoseconds, "map").number("d", x, y, 0.0, *_quaternion(theta)).data()


def twist(nanoseconds: int, frame: str, v: float, omega: float) -> bytes:
    """A TwistStamped in the vehicle's frame."""
    return Message().header(nanoseconds, frame).number("d", v, 0.0, 0.0, 0.0, 0.0, omega).data()


def wheels(nanoseconds: int, frame: str, speeds: tuple[float, float], torques: tuple[float, float]) -> bytes:
    """A JointState of the left and the right wheel: rad/s and N m."""
    message = Message().header(nanoseconds, frame).number("I", 2).text("left_wheel").text("right_wheel")
    return message.numbers(()).numbers(speeds).numbers(torques).data()


def transform(nanoseconds: int, frame: str, x: float, y: float, theta: float) -> bytes:
    """A TFMessage with the vehicle's frame in `map`."""
    message = Message().number("I", 1).header(nanoseconds, "map").text(frame)
    return message.number("d", x, y, 0.0, *_quaternion(theta)).data()


def _quaternion(theta: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2)

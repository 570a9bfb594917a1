"""A run as logs for other tools: trajectory.mcap (Foxglove, Rerun) and trajectory.csv (PlotJuggler, spreadsheets)."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ... import __version__
from ...models.digests import KEYS
from ...models.errors import InputError
from ...models.files.text import write_text, write_whole
from ...models.fleet import Fleet
from ...verify.simulation.trajectory import Trajectory, read_labels, read_trajectory
from . import ros_messages as ros
from .ros2 import namespaces

MCAP, TABLE = "trajectory.mcap", "trajectory.csv"
_COLUMNS = ("x", "y", "theta", "v", "omega", "tau_left", "tau_right")


def write_run_log(folder: Path, fleet: Fleet) -> list[Path]:
    """Write both logs of DIR/trajectory.npz. Raises InputError if there is no run of this fleet, or no mcap."""
    path = folder / "trajectory.npz"
    if not path.is_file():
        raise InputError(f"{path}: is not there; run gaincert simulate first")
    run, labels = read_trajectory(path), read_labels(path, KEYS)
    if run.state.x.shape[1] != len(fleet) or labels.get("fleet_digest", fleet.digest) != fleet.digest:
        raise InputError(f"{path}: belongs to another fleet; simulate again")
    _mcap_package(folder)
    return [
        write_whole(folder / MCAP, lambda file: write_mcap(file, fleet, run, labels)),
        write_text(folder / TABLE, table(fleet, run)),
    ]


def table(fleet: Fleet, run: Trajectory) -> str:
    """One row per time: t, then NAME/x, NAME/y, ... of every vehicle (m, rad, m/s, rad/s, N m), then V and W."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = namespaces(fleet.names)
    writer.writerow(("t", *(f"{name}/{column}" for name in names for column in _COLUMNS), "V", "W"))
    arrays = np.stack([*run.state, run.tau_left, run.tau_right], axis=2)  # (K, N, 7)
    for t, row, V, W in zip(run.t, arrays.reshape(len(run.t), -1), run.V, run.W, strict=True):
        writer.writerow((repr(float(t)), *map(repr, row.tolist()), repr(float(V)), repr(float(W))))
    return text.getvalue()


def write_mcap(file: IO[bytes], fleet: Fleet, run: Trajectory, labels: dict[str, str]) -> None:
    """ROS 2 messages per vehicle: NAME/pose, NAME/twist, NAME/wheels, and its frame in /tf."""
    from mcap.writer import Writer

    writer: Any = Writer(file)
    writer.start(profile="ros2", library=f"gaincert {__version__}")
    writer.add_metadata("gaincert", {"fleet": fleet.name, **labels})
    topics = {
        "pose": "geometry_msgs/msg/PoseStamped",
        "twist": "geometry_msgs/msg/TwistStamped",
        "wheels": "sensor_msgs/msg/JointState",
        "tf": "tf2_msgs/msg/TFMessage",
    }
    schemas = {
        topic: writer.register_schema(kind, "ros2msg", ros.DEFINITIONS[kind].encode()) for topic, kind in topics.items()
    }
    names = namespaces(fleet.names)
    channels = [
        {kind: writer.register_channel(f"/{name}/{kind}", "cdr", schemas[kind]) for kind in ("pose", "twist", "wheels")}
        for name in names
    ]
    frames = writer.register_channel("/tf", "cdr", schemas["tf"])
    left, right = wheel_speeds(fleet, run)
    for k, t in enumerate(run.t):
        stamp = round(float(t) * 1e9)  # ns
        for i, name in enumerate(names):
            x, y, theta, v, omega = (float(column[k, i]) for column in run.state)
            torques = float(run.tau_left[k, i]), float(run.tau_right[k, i])
            speeds = float(left[k, i]), float(right[k, i])
            for channel, data in (
                (channels[i]["pose"], ros.pose(stamp, x, y, theta)),
                (channels[i]["twist"], ros.twist(stamp, name, v, omega)),
                (channels[i]["wheels"], ros.wheels(stamp, name, speeds, torques)),
                (frames, ros.transform(stamp, name, x, y, theta)),
            ):
                writer.add_message(channel, stamp, data, stamp)
    writer.finish()


def wheel_speeds(fleet: Fleet, run: Trajectory) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Left and right wheel speed when rolling, rad/s, (K, N) each. As in (2), power is torque times speed."""
    plant = fleet.plant()
    turning = plant.arm * run.state.omega
    return (run.state.v + turning) / plant.r, (run.state.v - turning) / plant.r


def _mcap_package(folder: Path) -> None:
    from importlib.util import find_spec

    if find_spec("mcap") is None:
        raise InputError(f"{folder / MCAP}: needs the package mcap: pip install 'gaincert[logs]'")

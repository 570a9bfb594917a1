"""animation.gif and animation.mp4: the formation moving, drawn by matplotlib."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.errors import InputError, UndecidedError
from ...models.files.text import write_whole
from ...models.fleet import Fleet
from ...verify.simulation.trajectory import Trajectory, read_trajectory
from ..deployment import fleet_of_folder
from .style import COLOURS, LABELLED, STYLE, plain, shown_vehicles

FRAMES = {"gif": 150, "mp4": 450}
PER_SECOND = {"gif": 15, "mp4": 30}
SIZE, RESOLUTION = (7.2, 5.4), 100  # inches, dots per inch: both sides are even, as mp4 requires

Progress = Callable[[str, float], None]


def write_movie(folder: Path, kind: str, fleet_path: Path | None, progress: Progress) -> Path:
    """DIR/animation.gif or .mp4 from DIR/trajectory.npz.

    Raises InputError if there is no trajectory, no fleet or, for mp4, no ffmpeg.
    """
    ffmpeg = shutil.which("ffmpeg")
    if kind == "mp4" and ffmpeg is None:
        raise InputError("--animate mp4: needs ffmpeg, which is not installed; install it or use --animate gif")
    fleet, path = fleet_of_folder(folder, fleet_path), folder / "trajectory.npz"
    run = read_trajectory(path)
    if (count := run.state.x.shape[1]) != len(fleet):
        raise InputError(f"{path}: has {count} vehicles, the fleet has {len(fleet)}; simulate again")
    pictures = _pictures(fleet, run, FRAMES[kind], progress)
    write = _gif if kind == "gif" else lambda images, file: _mp4(images, file, str(ffmpeg))
    return write_whole(folder / f"animation.{kind}", lambda file: write(pictures, file))


def _pictures(fleet: Fleet, run: Trajectory, count: int, progress: Progress) -> Iterator[NDArray[np.uint8]]:
    """RGB images (height, width, 3) of the run at evenly spaced times."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = shown_vehicles(len(fleet))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=SIZE, dpi=RESOLUTION)
        canvas = FigureCanvasAgg(figure)
        axis = figure.subplots()
        moving = _scene(axis, fleet, run, shown)
        canvas.draw()
        figure.set_layout_engine("none")  # the layout is fixed now; computing it is the slowest part of a frame
        frames = np.searchsorted(run.t, np.linspace(run.t[0], run.t[-1], count))
        for number, k in enumerate(frames):
            _move(moving, fleet, run, shown, int(k))
            canvas.draw()
            progress("drawing the animation", (number + 1) / count)
            yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _scene(axis: Any, fleet: Fleet, run: Trajectory, shown: list[int]) -> dict[str, Any]:
    """The axes with all fixed artists, and the moving artists."""
    plant = fleet.plant()
    colours = [COLOURS[i % len(COLOURS)] for i in shown]
    goal = plant.leader_x + plant.offset_x[shown], plant.leader_y + plant.offset_y[shown]
    axis.scatter(*goal, s=70, facecolors="none", edgecolors=colours, lw=0.8)
    axis.plot(plant.leader_x, plant.leader_y, "k*", ms=9)
    xs, ys = (np.append(values[:, shown], ends) for values, ends in zip((run.state.x, run.state.y), goal, strict=True))
    unit = 0.05 * max(float(np.ptp(xs)), float(np.ptp(ys)), 1.0)
    axis.set(xlabel="x / m", ylabel="y / m", xlim=(xs.min() - unit, xs.max() + unit), aspect="equal")
    axis.set_ylim(ys.min() - unit, ys.max() + unit)
    few = len(fleet) <= LABELLED
    return {
        "title": axis.set_title("0 s"),
        "links": axis.plot([], [], color="0.6", lw=0.7, zorder=1)[0],
        "trails": [axis.plot([], [], color=colour, lw=0.9, alpha=0.6)[0] for colour in colours],
        "dots": axis.scatter(run.state.x[0, shown], run.state.y[0, shown], c=colours, s=22, zorder=3),
        "headings": [axis.plot([], [], color=colour, lw=1.8, zorder=3)[0] for colour in colours],
        "names": [axis.text(0, 0, plain(fleet.names[i]), color=COLOURS[i]) for i in shown] if few else [],
        "unit": unit,
    }


def _move(moving: dict[str, Any], fleet: Fleet, run: Trajectory, shown: list[int], k: int) -> None:
    """Move the artists to the vehicles' places at stored point k."""
    x, y, theta = (values[k] for values in run.state[:3])
    graph, unit = fleet.graph, moving["unit"]
    gaps = np.full(graph.edges, np.nan)  # between one link and the next
    moving["links"].set_data(
        np.column_stack([x[graph.tail], x[graph.head], gaps]).ravel(),
        np.column_stack([y[graph.tail], y[graph.head], gaps]).ravel(),
    )
    moving["title"].set_text(f"{run.t[k]:.0f} s")
    moving["dots"].set_offsets(np.column_stack([x[shown], y[shown]]))
    past = np.arange(0, k + 1, max(1, (k + 1) // 800))
    for number, i in enumerate(shown):
        moving["trails"][number].set_data(run.state.x[past, i], run.state.y[past, i])
        tip = x[i] + unit * np.cos(theta[i]), y[i] + unit * np.sin(theta[i])
        moving["headings"][number].set_data([x[i], tip[0]], [y[i], tip[1]])
    for text, i in zip(moving["names"], shown, strict=False):
        text.set_position((x[i] + 0.4 * unit, y[i] + 0.4 * unit))


def _gif(pictures: Iterator[NDArray[np.uint8]], file: Any) -> None:
    from PIL import Image

    first, *others = [Image.fromarray(picture).quantize(64) for picture in pictures]
    duration = 1000 // PER_SECOND["gif"]
    first.save(file, format="GIF", save_all=True, append_images=others, duration=duration, loop=0)


def _mp4(pictures: Iterator[NDArray[np.uint8]], file: Any, ffmpeg: str) -> None:
    """Pipe raw pictures through ffmpeg into a temporary file, because an mp4 is not written in one pass."""
    width, height = (round(side * RESOLUTION) for side in SIZE)
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(PER_SECOND["mp4"]), "-i", "-"]
    with tempfile.TemporaryDirectory() as folder:
        path, log = Path(folder) / "animation.mp4", Path(folder) / "log"
        command = [ffmpeg, "-loglevel", "error", *raw, "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)]
        with log.open("wb") as errors, subprocess.Popen(command, stdin=subprocess.PIPE, stderr=errors) as process:  # noqa: S603 -- no shell
            pipe: Any = process.stdin
            try:
                for picture in pictures:
                    pipe.write(picture.tobytes())
                pipe.close()
            except BrokenPipeError:
                pass  # ffmpeg's own message gives the reason
        if process.returncode:
            reason = log.read_text(errors="replace").strip().splitlines()
            raise UndecidedError(f"--animate mp4: ffmpeg failed: {reason[-1] if reason else process.returncode}")
        with path.open("rb") as video:
            shutil.copyfileobj(video, file)

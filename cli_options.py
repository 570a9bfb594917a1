"""The options and arguments of the command line, each declared once: its type, its limits and its help."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Template(StrEnum):
    """Fleets that `init` writes."""

    paper = "paper"
    line = "line"
    ring = "ring"
    star = "star"
    grid = "grid"
    v = "v"
    turtlebot3 = "turtlebot3"


class Mode(StrEnum):
    """How long `design` searches."""

    draft = "draft"
    fast = "fast"
    best = "best"


class Conditions(StrEnum):
    """Condition sets."""

    paper = "paper"
    corrected = "corrected"
    rate_bounded = "rate-bounded"


class Source(StrEnum):
    """Whether psi or the weights come from the fleet file or are designed."""

    given = "given"
    designed = "designed"


class Scales(StrEnum):
    """Whether the saturation scales come from the fleet file, are designed, or are the paper's."""

    given = "given"
    designed = "designed"
    unit = "unit"


class Format(StrEnum):
    """The formats of `export`."""

    ros2 = "ros2"
    c = "c"
    latex = "latex"
    csv = "csv"
    markdown = "markdown"
    mcap = "mcap"


class Interface(StrEnum):
    """The commands of the exported ROS 2 node: torques or velocities."""

    effort = "effort"
    velocity = "velocity"


class Plant(StrEnum):
    """What `validate` runs the controller on."""

    model = "model"
    mujoco = "mujoco"


class Animation(StrEnum):
    """File formats of an animation."""

    gif = "gif"
    mp4 = "mp4"


class Scheme(StrEnum):
    """The paper's controller, or its comparison with tanh(s) replaced by s."""

    bounded = "bounded"
    unbounded = "unbounded"


class Engine(StrEnum):
    """The integrator of `simulate`."""

    auto = "auto"
    cvodes = "cvodes"
    scale = "scale"


class Method(StrEnum):
    """The integrator of `validate`."""

    auto = "auto"
    cvodes = "cvodes"
    dop853 = "dop853"


# Switches of every verb.
Json = Annotated[bool, typer.Option("--json", help="print one JSON document; messages go to standard error")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="print errors only")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="print more")]

# Files and folders.
FleetPath = Annotated[Path, typer.Argument(metavar="FLEET.toml", help="the fleet file")]
CertificatePath = Annotated[Path, typer.Argument(metavar="CERTIFICATE.json", help="the certificate")]
ResultFolder = Annotated[Path, typer.Argument(metavar="DIR", help="a folder with results of other verbs")]
Folder = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="the output folder")]
ProofFolder = Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help="also write the report here")]
GainsPath = Annotated[Path, typer.Option("--gains", help="the gains: a design.json, gains.csv or gains.toml")]
GivenGains = Annotated[
    Path | None, typer.Option("--gains", help="take these gains (design.json, gains.csv or gains.toml), design none")
]
FolderFleet = Annotated[
    Path | None, typer.Option("--fleet", metavar="FLEET.toml", help="the fleet file [default: its copy in DIR]")
]
ProofFormal = Annotated[
    bool, typer.Option("--formal", help="also compile the machine-checked theorem, if Coq is installed")
]
ProofFleet = Annotated[
    Path | None,
    typer.Option("--fleet", metavar="FLEET.toml", help="prove facts about this fleet [default: the paper's]"),
]
CertifiedFleet = Annotated[
    Path | None,
    typer.Option("--fleet", metavar="FLEET.toml", help="also check that the certificate belongs to this fleet"),
]

# init, export, report
TemplateOption = Annotated[Template, typer.Option(help="the kind of fleet")]
Vehicles = Annotated[
    int | None, typer.Option(min=1, max=1_000_000, help="number of vehicles, for all but the paper's fleet")
]
FormatOption = Annotated[Format, typer.Option("--format", help="the format of the gains, or mcap for a run")]
InterfaceOption = Annotated[Interface, typer.Option(help="the commands of the ROS 2 node: wheel torques or twists")]
Animate = Annotated[
    Animation | None, typer.Option(help="also write animation.gif, or animation.mp4 (which needs ffmpeg)")
]

# design
ConditionsOption = Annotated[Conditions, typer.Option(help="(15) and (16); (16*) alone; (15') and (16*)")]
CertifiedConditions = Annotated[
    Conditions | None,
    typer.Option("--conditions", help="the condition set [default: the one in the gains file, else paper]"),
]
ModeOption = Annotated[Mode, typer.Option(help="draft: some seconds; fast: a minute; best: until the time limit")]
ExcitationOption = Annotated[
    Source | None, typer.Option(help="psi of the fleet file, or a designed one [default: given if the file has one]")
]
SaturationOption = Annotated[
    Scales | None,
    typer.Option(
        help="scales of the fleet file, designed ones, or unit: the paper's [default: given where it has some]"
    ),
]
WeightsOption = Annotated[Source, typer.Option(help="a_ij and a_il of the fleet file, or designed ones on its links")]
Seed = Annotated[int, typer.Option(min=0, help="seed of the random starts and of the search")]
TimeLimit = Annotated[float, typer.Option(min=1, help="wall-clock time that --mode best searches for, s")]
Digits = Annotated[int, typer.Option(min=2, max=15, help="significant digits of every gain")]
ToleranceOption = Annotated[
    tuple[float, float], typer.Option(metavar="M RAD", help="largest errors of a settled vehicle: m, rad")
]
TorqueFactor = Annotated[
    float, typer.Option(min=0.01, max=1, metavar="F", help="use at most this share of the torque limits")
]
Box = Annotated[
    float | None,
    typer.Option(
        min=0,
        max=1e6,
        metavar="M",
        help="random starts lie in a square of this side around the goal, m [default: from the size of the fleet]",
    ),
]
Compare = Annotated[
    bool,
    typer.Option("--compare", help="also design with every other choice of conditions, psi and weights, and compare"),
]
Against = Annotated[
    Path | None, typer.Option(metavar="GAINS", help="also measure the gains of this file from the same starts")
]

# simulate, validate
SchemeOption = Annotated[Scheme, typer.Option(help="the paper's controller, or its unbounded comparison")]
EngineOption = Annotated[
    Engine, typer.Option(help="auto: cvodes below 1000 vehicles, else scale, the explicit one for large fleets")
]
MethodOption = Annotated[
    Method,
    typer.Option(
        "--integrator",
        help="auto: cvodes with a test for chaos below 1000 vehicles, else the explicit one for large fleets; "
        "dop853: an independent, slow check",
    ),
]
OpenHorizon = Annotated[
    float | None,
    typer.Option("--horizon", min=0.1, max=1e6, help="simulated time, s [default: until some time after settling]"),
]
Horizon = Annotated[
    float | None,
    typer.Option(min=0.1, max=1e6, help="simulated time of every start, s [default: six times the predicted tail]"),
]
NoiseSeed = Annotated[int, typer.Option("--seed", min=0, help="seed of the noise and mismatch of [disturbance]")]
Starts = Annotated[int, typer.Option(min=1, max=1_000_000, help="number of random starts, all at rest")]
StartsFile = Annotated[
    Path | None, typer.Option(metavar="CSV", help="starts instead of random ones: start,vehicle,x,y,theta,v,omega")
]
Workers = Annotated[int | None, typer.Option(min=1, max=1024, help="number of processes [default: one for every core]")]
Scheduler = Annotated[
    str | None, typer.Option(metavar="tcp://HOST:PORT", help="run the work on this Dask cluster instead")
]
PlantOption = Annotated[
    Plant, typer.Option(help="equations (1)-(2), or MuJoCo driven by the exported C controller (extra [robots])")
]
Margins = Annotated[
    bool,
    typer.Option(
        "--margins", help="find the largest sample time, delay, friction and noise with which all starts settle"
    ),
]
Replay = Annotated[
    int | None, typer.Option(min=0, metavar="K", help="only run start K again, and store its trajectory")
]

# Disturbances; the [disturbance] table of the fleet file is the default.
SampleTime = Annotated[
    float | None,
    typer.Option(min=1e-4, max=10, metavar="S", help="compute the torques at this interval and hold them in between"),
]
Delay = Annotated[float | None, typer.Option(metavar="S", help="time from a measurement to its torques, s")]
Noise = Annotated[
    tuple[float, float] | None,
    typer.Option(metavar="M RAD", help="standard deviation of measured positions and headings: m, rad"),
]
NoiseSpeed = Annotated[
    float | None,
    typer.Option(metavar="V", help="standard deviation of measured speeds (m/s) and turn rates (rad/s)"),
]
Mismatch = Annotated[float | None, typer.Option(help="relative error of mass, inertia, wheel radius and track")]
Friction = Annotated[
    tuple[float, float] | None,
    typer.Option(metavar="NM NMS", help="Coulomb (N m) and viscous (N m s) friction at every wheel"),
]
ComOffset = Annotated[bool, typer.Option("--com-offset", help="centres of mass where com_offset of the vehicles says")]
LostLink = Annotated[
    tuple[str, str, float] | None,
    typer.Option(metavar="V1 V2 S", help="the edge between these vehicles fails at this time, s"),
]

"""C source of the control law for one vehicle with a given number of neighbours, generated from `models.equations`."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...models.algebra.ops import casadi_ops
from ...models.equations import Plant, State, control
from ...models.errors import UndecidedError
from ...models.excitation import Excitation
from ...models.gains import GAIN_NAMES, Gains
from ...models.graph import Graph
from ...models.saturation import SCALE_NAMES, Saturation

# The vectors that a generated function reads, in this order; `pose` and `link` have a column for every neighbour.
OWN = ("x", "y", "theta", "v", "omega")  # the vehicle's state
LEADER = ("x", "y", "theta")
SCALES = tuple(f"{name}_scale" for name in SCALE_NAMES)
ROBOT = (*GAIN_NAMES, *SCALES, "r", "arm", "offset_x", "offset_y", "leader_weight")
POSE = ("x", "y", "theta")  # of a neighbour
LINK = ("weight", "offset_x", "offset_y")  # of the edge to it, and its place in the formation


class _Inputs(NamedTuple):
    t: Any
    own: Any
    leader: Any
    robot: Any
    pose: Any
    link: Any


def control_source(excitation: Excitation, degrees: Iterable[int]) -> str:
    """Static C functions `casadi_torques_D` for every number of neighbours D, and the helpers that they call.

    Raises UndecidedError if CasADi writes C that this module does not recognise: nothing unchecked is exported.
    """
    import casadi as ca

    generator = ca.CodeGenerator("torques.c", {"with_header": False})
    wanted = sorted(set(degrees))
    for degree in wanted:
        inputs = _inputs(degree)
        generator.add(ca.Function(f"torques_{degree}", list(inputs), list(_torques(excitation, degree, inputs))))
    with tempfile.TemporaryDirectory() as folder:
        text = Path(generator.generate(folder + "/")).read_text()
    return "\n".join(_cleaned(text, number, degree) for number, degree in enumerate(wanted))


def _inputs(degree: int) -> _Inputs:
    import casadi as ca

    sizes = {"own": OWN, "leader": LEADER, "robot": ROBOT}
    vectors = {name: ca.SX.sym(name, len(entries)) for name, entries in sizes.items()}
    columns = {"pose": ca.SX.sym("pose", len(POSE), degree), "link": ca.SX.sym("link", len(LINK), degree)}
    return _Inputs(ca.SX.sym("t"), **vectors, **columns)


def _torques(excitation: Excitation, degree: int, inputs: _Inputs) -> tuple[Any, Any]:
    """(6) for the centre of a star: `control` of a fleet whose vehicle 0 has `degree` neighbours and no other link."""
    import casadi as ca

    others = ca.SX(degree, 1)  # values that vehicle 0 does not depend on

    def of_centre(value: Any) -> Any:
        return ca.vertcat(value, others)

    def of_all(number: int, own: Any, columns: Any) -> Any:
        return ca.vertcat(own, columns[number, :].T)

    robot = dict(zip(ROBOT, ca.vertsplit(inputs.robot), strict=True))
    star = Graph(
        np.zeros(degree, dtype=np.int64),
        np.arange(1, degree + 1),
        inputs.link[0, :].T,
        of_centre(robot["leader_weight"]),
    )
    plant = Plant(
        graph=star,
        m=None,
        inertia=None,
        r=robot["r"],
        arm=robot["arm"],
        offset_x=of_all(1, robot["offset_x"], inputs.link),
        offset_y=of_all(2, robot["offset_y"], inputs.link),
        leader_x=inputs.leader[0],
        leader_y=inputs.leader[1],
        leader_theta=inputs.leader[2],
    )
    x, y, theta = (of_all(k, inputs.own[k], inputs.pose) for k in range(3))
    state = State(x, y, theta, of_centre(inputs.own[3]), of_centre(inputs.own[4]))
    saturation = Saturation(  # two scales of the network, then two of the vehicle
        robot["position_scale"],
        robot["heading_scale"],
        of_centre(robot["speed_scale"]),
        of_centre(robot["turn_rate_scale"]),
    )
    own = {name: of_centre(robot[name]) for name in GAIN_NAMES}
    gains = Gains(**own, saturation=saturation)
    left, right = control(casadi_ops(), plant, gains, excitation.value(casadi_ops(), inputs.t), state)
    return left[0], right[0]


_HEAD = re.compile(
    r"static int casadi_f\d+\(const casadi_real\*\* arg, casadi_real\*\* res, "
    r"casadi_int\* iw, casadi_real\* w, int mem\) \{"
)
_READ = re.compile(r"arg\[(\d)\]\? arg\[\1\]\[(\d+)\] : 0")
_LINE = re.compile(
    r"  (double( a\d+,?)+;"  # declarations, which may take several lines
    r"|a\d+=(-?\d+\.\d*(e[-+]\d+)?|\(?-?a\d+\)?|\(a\d+[-+*/]a\d+\)|(sin|cos|tanh|casadi_sq)\(a\d+\)|arg\[\d\]\[\d+\]);"
    r"|res\[[01]\]\[0\]=a\d+;)"
)


def _cleaned(text: str, number: int, degree: int) -> str:
    """CasADi's static function `casadi_f<number>` as plain C99, every line of it recognised."""
    begin = text.find(f"static int casadi_f{number}(")
    end = text.find("\n}\n", begin)
    if begin < 0 or end < 0:
        raise UndecidedError("CasADi's generated code has no function where one was expected; use another version")
    head, *lines = text[begin:end].split("\n")
    body = [_plain_line(line) for line in lines if line.strip() not in ("", "return 0;")]
    unknown = [line for line in ([] if _HEAD.fullmatch(head) else [head]) + body if not _LINE.fullmatch(line)]
    if unknown:
        raise UndecidedError(f"CasADi's generated code has a line that is not known: {unknown[0].strip()!r}")
    comment = f"/* Left and right torque, N m, of a vehicle with {degree} neighbour{'s' * (degree != 1)}. */"
    signature = f"static void casadi_torques_{degree}(const double **arg, double **res)"
    return "\n".join([comment, signature, "{", *body, "}", ""])


def _plain_line(line: str) -> str:
    """The line without CasADi's types and null checks: every input and output is given."""
    line = line.replace("casadi_real", "double")
    line = re.sub(r"^  if \(res\[([01])\]!=0\) ", "  ", line)
    return _READ.sub(lambda found: f"arg[{found[1]}][{found[2]}]", line)

"""The fleets, gains, excitations and states over which laws are tested: every graph family, both drives, both schemes.

Also the tools that some tests need: `@pytest.mark.needs("ffmpeg")` skips a test if ffmpeg is missing and says what
to install. With CI=true in the environment any other skipped test is a failure.
"""

import importlib.util
import os
import shutil
import zlib
from collections import Counter
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gaincert.models.algebra.ops import unbounded
from gaincert.models.arrays import floats
from gaincert.models.equations import State
from gaincert.models.excitation import Excitation
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains

# Public robot descriptions and fleets, read in place: beside the project, or where GAINCERT_SHARED says.
SHARED = Path(os.environ.get("GAINCERT_SHARED") or Path(__file__).resolve().parents[2] / "shared")
# What a test may need: any of these programs, Python modules or folders, and how to get it.
TOOLS = {
    "gcc": (["gcc"], "apt-get install gcc"),
    "make": (["make"], "apt-get install make"),
    "latex": (["pdflatex"], "apt-get install texlive-latex-recommended"),
    "ffmpeg": (["ffmpeg"], "apt-get install ffmpeg"),
    "chromium": (["chromium", "chromium-browser", "google-chrome"], "apt-get install chromium"),
    "coqc": (["coqc"], "apt-get install coq libcoq-coquelicot libcoq-interval"),
    "playwright": (["playwright.sync_api"], "pip install '.[browser]'"),
    "yaml": (["yaml"], "pip install '.[test]'"),
    "z3": (["z3"], "pip install '.[test]'"),
    "xacro": (["xacro"], "pip install '.[robots]'"),
    "mcap": (["mcap_ros2"], "pip install '.[test]'"),
    "mujoco": (["mujoco"], "pip install '.[robots]'"),
    "distributed": (["distributed"], "pip install '.[test]'"),
    "shared": ([str(SHARED)], "put the folder `shared` beside the project or name it in GAINCERT_SHARED"),
    "proc": (["/proc/self/stat"], "the tests of processes read /proc, which Linux has"),
}


def _is_there(name):
    """Whether a program on the PATH, a Python module or a file has this name."""
    if "/" in name:
        return Path(name).exists()
    if shutil.which(name):
        return True
    return importlib.util.find_spec(name.split(".")[0]) is not None


def _missing():
    """{tool: what to install} of every tool that is not there."""
    return {
        tool: f"{tool} is missing: {remedy}"
        for tool, (names, remedy) in TOOLS.items()
        if not any(map(_is_there, names))
    }


def pytest_collection_modifyitems(config, items):
    """On several processes, files with slow tests first: none of them is left for the end, when others are idle."""
    if hasattr(config, "workerinput"):
        slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
        items.sort(key=lambda item: -slow[item.path])  # stable: the order within a file stays


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    missing = _missing()
    for marker in item.iter_markers("needs"):
        for tool in marker.args:
            assert tool in TOOLS, f"{tool!r} is not in TOOLS of tests/conftest.py"
            if tool in missing:
                # Public inputs are part of CI: there their absence is a failure.
                (pytest.fail if tool == "shared" and os.environ.get("CI") == "true" else pytest.skip)(missing[tool])


def pytest_sessionfinish(session):
    """In CI a test may be skipped for a missing tool alone."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if os.environ.get("CI") != "true" or reporter is None:
        return
    for report in reporter.stats.get("skipped", []):
        reason = str(report.longrepr[2]).removeprefix("Skipped: ")
        if reason not in _missing().values():
            reporter.write_line(f"\nskipped without a missing tool: {report.nodeid}: {reason}", red=True)
            session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.fixture(scope="session")
def shared():
    """The folder of public inputs; a test that takes it is marked `needs("shared")`."""
    return SHARED


def _random_tree(random, n):
    return {(int(random.integers(i)), i): 1 for i in range(1, n)}


def _weight(random):
    return str(round(float(np.exp(random.uniform(-2, 2))), 3))


def _single(_):
    return 1, {}, {0: 1}


def _line(_):
    return 5, {(i, i + 1): 1 for i in range(4)}, {0: 1}


def _ring(_):
    return 6, {(i, (i + 1) % 6): 1 for i in range(6)}, {3: 2}


def _star(_):
    return 5, {(4, i): 1 for i in range(4)}, {4: 10}


def _complete(_):
    return 5, {(i, j): 1 for i in range(5) for j in range(i)}, {2: 1}


def _tree(random):
    return 8, _random_tree(random, 8), {7: 1}


def _random(random):
    edges = _random_tree(random, 7) | {(i, j): 1 for j in range(7) for i in range(j) if random.random() < 0.3}
    return 7, edges, {0: 1, 5: 3}


def _weighted(random):
    n, edges, _ = _random(random)
    return n, {pair: _weight(random) for pair in edges}, {i: _weight(random) for i in range(n)}


def _islands(_):
    """Two components and a vehicle on its own, each with its leader link."""
    return 6, {(0, 1): "2.5", (1, 2): 1, (4, 3): "0.5"}, {0: 1, 3: "0.25", 5: 4}


def _paper(_):
    ring = {(i, (i + 1) % 6): 1 for i in range(6)}
    return 6, {**ring, (1, 3): 1}, {1: 10, 3: 10}


FAMILIES = {
    build.__name__[1:]: build
    for build in (_single, _line, _ring, _star, _complete, _tree, _random, _weighted, _islands, _paper)
}


def _decimal(random, low, high):
    return str(round(float(random.uniform(low, high)), 3))


def fleet_content(family, drive, random):
    """The content of a fleet file: a graph of one family, vehicles that all differ."""
    n, edges, led = FAMILIES[family](random)
    ranges = {
        "mass": (0.5, 40),
        "inertia": (0.1, 20),
        "half_track": (0.05, 0.4),
        "wheel_radius": (0.02, 0.2),
        "torque_limit": (20, 200),
    }
    return {
        "name": family,
        "drive": drive,
        "leader": {"position": ["-3.5", "2.25"], "heading": "0.75"},
        "graph": {
            "edges": [[f"v{i}", f"v{j}", weight] for (i, j), weight in edges.items()],
            "leader_links": {f"v{i}": weight for i, weight in led.items()},
        },
        "vehicle": [
            {
                "name": f"v{i}",
                **{key: _decimal(random, *ends) for key, ends in ranges.items()},
                "offset": [_decimal(random, -5, 5), _decimal(random, -5, 5)],
            }
            for i in range(n)
        ],
    }


@pytest.fixture
def random(request):
    """A generator that is the same in every run and differs from test to test."""
    return np.random.default_rng(zlib.crc32(request.node.nodeid.encode()))


@pytest.fixture(params=FAMILIES)
def family(request):
    return request.param


@pytest.fixture(params=["physical", "paper"])
def drive(request):
    return request.param


@pytest.fixture(params=["bounded", "unbounded"])
def scheme(request):
    """The controller's saturation, as a function from ops to ops."""
    return unbounded if request.param == "unbounded" else lambda ops: ops


@pytest.fixture
def content(family, drive, random):
    """A fleet file's content, to be changed by a test."""
    return fleet_content(family, drive, random)


@pytest.fixture
def fleet(content):
    """Every graph family x both drives."""
    return Fleet.model_validate(content)


@pytest.fixture
def draw_gains(random):
    """n -> exact random gains for n vehicles."""

    def draw(n):
        values = [[Fraction(int(value), 1000) for value in random.integers(100, 9000, n)] for _ in GAIN_NAMES]
        return Gains(*(np.array(row, dtype=object) for row in values))

    return draw


@pytest.fixture
def gains(fleet, draw_gains):
    """Random gains of the fleet, floats."""
    return draw_gains(len(fleet)).map(floats)


@pytest.fixture
def psi(random):
    """A random Fourier sum of three harmonics with a mean."""
    mean, *tones = (Fraction(int(value), 100) for value in random.integers(-150, 150, 7))
    return Excitation(mean, Fraction(7, 5), tuple(tones[:3]), tuple(tones[3:]))


@pytest.fixture
def draw_state(random):
    """(n, batch shape) -> a random state of n vehicles, far enough out that every tanh shows its curvature."""

    def draw(n, batch=()):
        spreads = State(6, 6, 3, 2, 2)
        return State(*(random.uniform(-spread, spread, (*batch, n)) for spread in spreads))

    return draw


@pytest.fixture
def paper():
    return paper_fleet()


@pytest.fixture
def gains_of_paper():
    return paper_gains()


@pytest.fixture
def psi_of_paper():
    return paper_excitation()

"""A run of the whole pipeline that tests of the command line share; they copy what they change."""

import contextlib
import io
from dataclasses import replace
from pathlib import Path

import pytest
from gaincert.console import Printer
from gaincert.models.tolerance import Tolerance
from gaincert.synthesis.settings import FAST, Settings
from gaincert.workflows.design import DesignOptions
from gaincert.workflows.inputs import read_fleet
from gaincert.workflows.run import Pipeline
from gaincert.workflows.simulate import Simulation

PAPER = Path(__file__).parents[2] / "examples" / "paper.toml"


@pytest.fixture(scope="session")
def short() -> Settings:
    """A search of a second, for tests of what is done with its result."""
    return replace(FAST, work=1e6, explored=8, ranking_starts=2, generations=1, training_starts=2, heldout_starts=2)


@pytest.fixture(scope="session")
def options(short: Settings) -> DesignOptions:
    """Such a search under the paper's conditions."""
    return DesignOptions(
        mode="fast",
        conditions="paper",
        excitation=None,
        saturation=None,
        weights="given",
        seed=0,
        digits=4,
        time_limit=600.0,
        tolerance=Tolerance(),
        torque_factor=1.0,
        box=None,
        settings=short,
    )


@pytest.fixture(scope="session")
def out(tmp_path_factory: pytest.TempPathFactory, options: DesignOptions) -> Path:
    """The paper's fleet through the whole pipeline; stdout.json is what is printed."""
    folder, printed = tmp_path_factory.mktemp("run"), io.StringIO()
    printer = Printer(True, False, False)
    pipeline = Pipeline(printer, read_fleet(PAPER), Simulation(("bounded", "unbounded"), None, Tolerance()), folder)
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
        outcome = pipeline.run(options)
        printer.document(outcome.document)
    assert outcome.exit_code == 0
    (folder / "stdout.json").write_text(printed.getvalue())
    return folder

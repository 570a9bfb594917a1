"""A run of the whole pipeline that tests of the command line share; they copy what they change."""

import contextlib
import io
from pathlib import Path

import pytest
from gaincert.console import Printer
from gaincert.models.tolerance import Tolerance
from gaincert.workflows.design import DesignOptions
from gaincert.workflows.inputs import read_fleet
from gaincert.workflows.run import Pipeline
from gaincert.workflows.simulate import Simulation

PAPER = Path(__file__).parents[2] / "examples" / "paper.toml"


@pytest.fixture(scope="session")
def options() -> DesignOptions:
    """A short search under the paper's conditions."""
    return DesignOptions(
        mode="draft",
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

"""Initial states: drawn around the fleet's own scale, and read from files."""

from pathlib import Path

import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.starts_file import COLUMNS, load_starts
from gaincert.models.fleet import Fleet
from gaincert.models.paper import paper_fleet
from gaincert.models.starts import Draw, random_starts, scale
from gaincert.synthesis.task import Options, prepare

GOOD = [f"a,v{i},{i},{-i},0.5,0.1,-0.1" for i in range(1, 7)]


def without_starts(fleet: Fleet) -> Fleet:
    vehicles = tuple(vehicle.model_copy(update={"start": None}) for vehicle in fleet.vehicles)
    return fleet.model_copy(update={"vehicles": vehicles})


def written(folder: Path, rows: list[str], heading: str = ",".join(COLUMNS)) -> Path:
    path = folder / "starts.csv"
    path.write_text("\n".join([heading, *rows]) + "\n")
    return path


def test_the_scale_is_the_farthest_start_or_the_formation() -> None:
    fleet = paper_fleet()
    plant, start = fleet.plant(), fleet.start()
    assert start is not None
    far = max(
        np.abs(start.x - plant.offset_x - plant.leader_x).max(), np.abs(start.y - plant.offset_y - plant.leader_y).max()
    )
    size = np.ptp(plant.offset_x) + np.ptp(plant.offset_y)
    assert scale(fleet) == max(far, size)
    assert scale(without_starts(fleet)) == 2 * size


def test_a_start_is_the_same_however_many_are_drawn() -> None:
    fleet = paper_fleet()
    few, many = random_starts(fleet, 2, 5), random_starts(fleet, 4, 5)
    assert all(np.array_equal(a, b) for a, b in zip(few, many[:2], strict=True))
    assert not np.array_equal(many[0], many[1])
    plant = fleet.plant()
    for state in random_starts(fleet, 20, 0, half_width=3.0):
        assert np.abs(state.x - plant.leader_x).max() <= 3 and np.abs(state.y - plant.leader_y).max() <= 3
        assert np.abs(state.theta).max() <= np.pi and not state.v.any() and not state.omega.any()


def test_the_rows_of_a_start_may_stand_in_any_order(tmp_path: Path) -> None:
    rows = [*reversed(GOOD), *(row.replace("a,", "b,", 1) for row in GOOD)]
    first, second = load_starts(written(tmp_path, rows), paper_fleet())
    assert np.array_equal(first, second)
    assert list(first.x) == [1, 2, 3, 4, 5, 6] and list(first.y) == [-1, -2, -3, -4, -5, -6]
    assert (first.theta == 0.5).all() and (first.v == 0.1).all() and (first.omega == -0.1).all()


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ([*GOOD, "a,v7,0,0,0,0,0"], "row 8: start 'a', vehicle 'v7': the fleet has no such vehicle"),
        (
            [*GOOD, "a,v11,0,0,0,0,0"],
            "row 8: start 'a', vehicle 'v11': the fleet has no such vehicle (did you mean 'v1'",
        ),
        ([*GOOD, GOOD[0]], "row 8: start 'a', vehicle 'v1': it is listed twice"),
        ([*GOOD[:5], "a,v6,0,0,nan,0,0"], "row 7: a number is not finite"),
        (GOOD[:5], "start 'a' has no row for vehicle 'v6'"),
        ([*GOOD[:5], "a,v6,0,0"], "row 7 must have 7 columns"),
        ([], "holds no start"),
    ],
)
def test_each_mistake_has_its_line(rows: list[str], says: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        load_starts(written(tmp_path, rows), paper_fleet())
    (line,) = caught.value.mistakes
    assert line.startswith(f"{tmp_path}/starts.csv: {says}")


def test_the_heading_is_that_of_the_contract(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the first line must be start,vehicle,x,y,theta,v,omega"):
        load_starts(written(tmp_path, GOOD, "start,vehicle,x,y"), paper_fleet())


def test_a_design_is_validated_from_starts_that_it_has_not_seen() -> None:
    """With the same seed too: it is 0 for every command that is given none."""
    fleet = paper_fleet()
    firsts = [random_starts(fleet, 3, 0, 30.0, draw)[k].x.tolist() for draw in Draw for k in range(3)]
    assert len({tuple(first) for first in firsts}) == 3 * len(Draw)
    task = prepare(fleet, Options("corrected", "designed", box=60.0))
    # The search's starts are singles, relative to the goal.
    seen = {draw: {tuple(x) for x in task.far_starts(draw, 4)[0].T.tolist()} for draw in Draw}
    goal = task.plant.offset_x + task.plant.leader_x
    fresh = {tuple((start.x - goal).astype(np.float32).tolist()) for start in random_starts(fleet, 3, 0, 30.0)}
    assert fresh <= seen.pop(Draw.VALIDATION)
    assert not any(fresh & starts for starts in seen.values())

"""The robots of the examples are those of their makers' descriptions."""

from pathlib import Path

import pytest
from gaincert.models.files.fleet_file import load_fleet
from gaincert.models.files.robots.description import read_robot

EXAMPLES = Path(__file__).parents[3] / "examples"
FILES = {"waffle": "tb3_waffle", "kobuki": "kobuki", "create3": "create3"}


@pytest.mark.needs("shared")
@pytest.mark.parametrize("name", FILES)
def test_three_robots_are_what_their_descriptions_say(name, shared):
    fleet = load_fleet(EXAMPLES / "three_robots.toml")
    vehicle = fleet.vehicles[fleet.names.index(name)]
    for key, value in read_robot(shared / "data" / "robots" / f"{FILES[name]}.urdf").vehicle_keys().items():
        if key == "com_offset":
            assert list(map(float, vehicle.com_offset)) == pytest.approx(list(map(float, value)), abs=1e-4)  # m
        else:
            assert float(getattr(vehicle, key)) == pytest.approx(float(value), rel=1e-4)


def test_five_robots_are_five_of_one_kind():
    fleet = load_fleet(EXAMPLES / "five_robots.toml")
    first, *others = (
        vehicle.model_copy(update={"name": "", "offset": (0, 0), "start": None}) for vehicle in fleet.vehicles
    )
    assert len(others) == 4
    assert all(vehicle == first for vehicle in others)
    assert float(first.mass) == 3.2
    assert (float(first.limits.speed), float(fleet.disturbance.coulomb), float(fleet.disturbance.delay)) == (
        0.8,
        0.02,
        0.04,
    )

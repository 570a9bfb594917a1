"""Large fleets are searched on a part of them, whose scalars mean the same for the whole."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gaincert.models.conditions import float_numbers
from gaincert.models.files.fleet_file import load_fleet
from gaincert.models.files.templates import template_text
from gaincert.models.fleet import Fleet
from gaincert.synthesis.search.part import part_of
from gaincert.synthesis.search.search import search
from gaincert.synthesis.settings import FAST, Settings
from gaincert.synthesis.task import Options, Task, prepare

from tests.synthesis.test_search import TINY, silent


def fleet_of(kind: str, vehicles: int, folder: Path) -> Fleet:
    path = folder / "fleet.toml"
    path.write_text(template_text(kind, vehicles))
    return load_fleet(path)


def task_of(kind: str, vehicles: int, folder: Path, settings: Settings = TINY, **options: Any) -> Task:
    return prepare(fleet_of(kind, vehicles, folder), Options("corrected", **options), settings)


def test_small_fleets_are_searched_as_they_are(tmp_path: Path) -> None:
    task = task_of("ring", FAST.roles_vehicles, tmp_path)
    assert part_of(task) is task


@pytest.mark.parametrize("kind", ["ring", "line"])
def test_a_part_is_connected_led_and_starts_as_far_from_its_goal(kind: str, tmp_path: Path) -> None:
    task = task_of(kind, 64, tmp_path, torque_factor=0.5, box=30.0)
    part = part_of(task)
    assert len(part.fleet) == FAST.part_vehicles
    assert np.all(part.plant.graph.leader_tree() >= 0)  # hears the leader
    whole = {frozenset(edge[:2]): edge[2] for edge in task.fleet.links.edges}
    assert all(whole[frozenset(edge[:2])] == edge[2] for edge in part.fleet.links.edges)
    assert part.half_width == task.half_width == 15
    assert part.options.torque_factor == 0.5
    names = [vehicle.name for vehicle in task.fleet.vehicles if vehicle in part.fleet.vehicles]
    assert part.fleet.names == names


def test_where_no_vehicle_around_the_slowest_hears_the_leader_the_whole_is_searched(tmp_path: Path) -> None:
    task = task_of("grid", 64, tmp_path)
    assert np.count_nonzero(task.plant.graph.leader_weight) == 8  # one side of it
    assert part_of(task) is task


def test_what_the_search_finds_on_a_part_is_of_the_whole(tmp_path: Path) -> None:
    task = task_of("ring", 44, tmp_path)
    found = search(task, [], None, silent)
    assert 1 <= len(found) <= FAST.part_elite
    for one in found:
        assert one.gains.p_v.shape == (44,)
        for condition in task.conditions.inequalities(float_numbers(), task.data, one.gains):
            assert np.all(condition.holds)

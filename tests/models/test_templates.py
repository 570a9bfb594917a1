"""Fleets that `init` writes: of every size, every robot in a place and a start of its own, all joined to the leader."""

import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import load_fleet
from gaincert.models.files.templates import SHAPES, template_text
from gaincert.models.fleet import Fleet


def fleet_of(text: str, folder) -> Fleet:
    path = folder / "fleet.toml"
    path.write_text(text)
    return load_fleet(path)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 12, 30])
@pytest.mark.parametrize("kind", [*SHAPES, "turtlebot3"])
def test_every_shape_of_every_size_is_a_fleet_without_collisions(kind: str, count: int, tmp_path) -> None:
    fleet = fleet_of(template_text(kind, count), tmp_path)
    assert len(fleet) == count
    start, plant = fleet.start(), fleet.plant()
    for x, y in ((start.x, start.y), (plant.offset_x, plant.offset_y)):
        i, j = np.triu_indices(count, 1)
        apart = np.hypot(x[i] - x[j], y[i] - y[j])
        assert apart.min(initial=np.inf) > 0.3


def test_shapes_are_what_their_names_say(tmp_path) -> None:
    star = fleet_of(template_text("star", 6), tmp_path)
    assert sorted(star.graph.degree.tolist()) == [1, 1, 1, 1, 1, 6]
    grid = fleet_of(template_text("grid", 9), tmp_path)
    assert grid.graph.edges == 12
    v = fleet_of(template_text("v", 7), tmp_path)
    assert v.plant().offset_y.tolist() == [0, 2, -2, 4, -4, 6, -6]
    assert [edge[:2] for edge in v.links.edges][:4] == [("v1", "v2"), ("v1", "v3"), ("v2", "v4"), ("v3", "v5")]


def test_the_papers_fleet_has_six_vehicles() -> None:
    with pytest.raises(InputError, match="the paper's fleet has 6; use another --template"):
        template_text("paper", 5)

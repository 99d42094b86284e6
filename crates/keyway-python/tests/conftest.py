"""What tests share: maps and scenes of the repository."""

import pathlib

import numpy as np
import pytest
from numpy.typing import NDArray

import keyway

REPOSITORY = pathlib.Path(__file__).parents[3]
SCENES = REPOSITORY / "crates" / "keyway-cli" / "scenes"


@pytest.fixture(scope="session")
def house() -> keyway.Map:
    """A real ROS map."""
    return keyway.Map.read(SCENES / "small_house.yaml")


@pytest.fixture(scope="session")
def rooms() -> keyway.Map:
    """A MovingAI map."""
    return keyway.Map.read(SCENES / "rooms.map")


@pytest.fixture()
def clutter() -> NDArray[np.bool_]:
    """A third of the cells is occupied, but for the corners."""
    occupied = np.random.default_rng(5).random((30, 40)) < 0.33
    occupied[0, 0] = occupied[-1, -1] = False
    return occupied


@pytest.fixture()
def scene() -> keyway.Scene:
    """Across an empty room, around a post that is on no map."""
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    return keyway.Scene(grid, (1, 2), (7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])

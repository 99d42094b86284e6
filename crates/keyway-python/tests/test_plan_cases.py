"""The cases of testdata/plan, which every shell of the library runs."""

import math
import tomllib
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY

import keyway

STATES = {".": 0, "#": 100, "?": -1}
CASES = [
    case
    for file in sorted((REPOSITORY / "testdata" / "plan").glob("*.toml"))
    for case in tomllib.loads(file.read_text())["case"]
]


@pytest.mark.parametrize("planner", ["jps", "astar", "dijkstra", "bidirectional-optimal", "prepared"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_a_plan_costs_what_the_case_says(case: dict[str, Any], planner: str) -> None:
    # Rows of an array go up, those of a drawing down.
    rows = [[STATES[cell] for cell in row] for row in reversed(case["map"].split())]
    grid = keyway.Map.from_array(np.array(rows, dtype=np.int8), resolution=1.0)
    (x0, y0), (x1, y1) = case["start"], case["goal"]
    ends = (x0 + 0.5, y0 + 0.5), (x1 + 0.5, y1 + 0.5)
    parameters: dict[str, Any] = {}
    if case.get("corners") == "allow":
        if planner != "astar":
            pytest.skip("its rule of corners is not a parameter")
        parameters = {"planner": {"name": "astar", "corners": "allow"}}
    if "cost" not in case:
        with pytest.raises(keyway.NoPath):
            keyway.plan(grid, *ends, planner=planner, parameters=parameters)
        return
    straight, diagonal = case["cost"]
    plan = keyway.plan(grid, *ends, planner=planner, parameters=parameters)
    assert plan.cost == pytest.approx(straight + diagonal * math.sqrt(2), abs=1e-9)

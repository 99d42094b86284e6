"""Plans, compared with published lengths and with a search of a few lines."""

import concurrent.futures
import heapq
import math
import re
from typing import Any

import numpy as np
import pytest
from conftest import SCENES
from numpy.typing import NDArray

import keyway


def shortest_cost(occupied: NDArray[np.bool_], start: tuple[int, int], goal: tuple[int, int]) -> float:
    """Dijkstra's algorithm without corner cutting, by heapq."""
    rows, columns = occupied.shape

    def is_free(x: int, y: int) -> bool:
        return 0 <= x < columns and 0 <= y < rows and not occupied[y, x]

    best, heap = {start: 0.0}, [(0.0, start)]
    while heap:
        cost, (x, y) = heapq.heappop(heap)
        if (x, y) == goal:
            return cost
        if cost > best[x, y]:
            continue
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                if (dx or dy) and is_free(x + dx, y + dy) and is_free(x + dx, y) and is_free(x, y + dy):
                    new = cost + math.hypot(dx, dy)
                    if new < best.get((x + dx, y + dy), math.inf) - 1e-9:
                        best[x + dx, y + dy] = new
                        heapq.heappush(heap, (new, (x + dx, y + dy)))
    return math.inf


@pytest.mark.parametrize("planner", ["jps", "astar", "dijkstra", "bidirectional-optimal", "prepared"])
def test_costs_are_those_of_another_search(clutter: NDArray[np.bool_], planner: str) -> None:
    clutter &= np.random.default_rng(9).random(clutter.shape) < 0.6
    grid = keyway.Map.from_array(clutter, resolution=1.0)
    cells = np.argwhere(~clutter)[::41]
    joined = 0
    for (y0, x0), (y1, x1) in zip(cells, cells[::-1], strict=True):
        expected = shortest_cost(clutter, (x0, y0), (x1, y1))
        ends = (x0 + 0.5, y0 + 0.5), (x1 + 0.5, y1 + 0.5)
        if math.isinf(expected):
            with pytest.raises(keyway.NoPath):
                keyway.plan(grid, *ends, planner=planner)
            continue
        plan = keyway.plan(grid, *ends, planner=planner)
        joined += 1
        assert plan.cost == pytest.approx(expected, abs=1e-9)
        assert plan.cells[0].tolist() == [x0, y0] and plan.cells[-1].tolist() == [x1, y1]
        assert not clutter[plan.cells[:, 1], plan.cells[:, 0]].any()
        assert plan.length <= plan.cost + 1e-9
    assert joined > 10


def test_published_lengths_on_a_benchmark_map(rooms: keyway.Map) -> None:
    lines = (SCENES / "rooms.map.scen").read_text().splitlines()[1:]
    rows = np.array([[float(n) for n in line.split("\t")[4:9]] for line in lines if line.strip()])
    height = rooms.shape[0]
    # Row 0 of such a file is at the top.
    starts = np.column_stack([rows[:, 0] + 0.5, height - 0.5 - rows[:, 1]])
    goals = np.column_stack([rows[:, 2] + 0.5, height - 0.5 - rows[:, 3]])
    plans = keyway.plan_many(rooms, starts, goals)
    # A cost of 0 between two places says that no path joins them.
    has_path = (rows[:, 4] > 0) | (rows[:, :2] == rows[:, 2:4]).all(axis=1)
    assert [isinstance(plan, keyway.Plan) for plan in plans] == has_path.tolist()
    costs = [plan.cost for plan in plans if isinstance(plan, keyway.Plan)]
    assert len(costs) > 30 and np.allclose(costs, rows[has_path, 4], atol=1e-4)


def test_every_planner_and_smoother_has_a_path(house: keyway.Map) -> None:
    ends = (-8.175, -2.825), (8.725, 0.875)
    for planner in keyway.names("planners"):
        plan = keyway.plan(house, *ends, radius=0.2, planner=planner)
        assert plan.planner == planner and plan.xy[0].tolist() == list(ends[0])
    shortest = keyway.plan(house, *ends, radius=0.2).length
    for smoother in keyway.names("smoothers"):
        plan = keyway.plan(house, *ends, radius=0.2, smoother=smoother)
        assert (plan.smoother, plan.xy[-1].tolist()) == (smoother, list(ends[1]))
        assert plan.length <= shortest * 1.001
    assert plan._repr_svg_().startswith("<svg") and plan._repr_png_().startswith(b"\x89PNG")


def test_arrays_are_handed_out_without_a_copy(house: keyway.Map) -> None:
    plan = keyway.plan(house, (-8.175, -2.825), (8.725, 0.875), radius=0.2, smoother="taut")
    for name, dtype, columns in [("xy", np.float64, 2), ("cells", np.int32, 2)]:
        first, second = getattr(plan, name), getattr(plan, name)
        assert first.ctypes.data == second.ctypes.data
        assert (first.dtype, first.shape[1], first.flags.writeable) == (dtype, columns, False)
        # The memory is that of the library, not of numpy.
        assert not first.flags.owndata
    curve = plan.curve(spacing=0.05)
    assert curve.base is not None and curve.view(np.float64).reshape(-1, 8).ctypes.data == curve.ctypes.data
    del plan
    assert np.isfinite(first).all()


def test_curves_keep_the_limits_of_the_robot(house: keyway.Map) -> None:
    plan = keyway.plan(house, (-8.175, -2.825), (8.725, 0.875), radius=0.2, smoother="continuous-curvature")
    curve = plan.curve(spacing=0.02, robot="small")
    assert curve.dtype.names == (
        "s_m", "x_m", "y_m", "heading_rad", "curvature_per_m", "t_s", "v_mps", "omega_radps"
    )
    assert curve["s_m"][-1] == pytest.approx(plan.length)
    assert (np.diff(curve["t_s"]) >= 0).all() and curve["v_mps"].max() <= 0.5 + 1e-12
    assert np.allclose(curve["omega_radps"], curve["v_mps"] * curve["curvature_per_m"])
    steps = np.hypot(np.diff(curve["x_m"]), np.diff(curve["y_m"]))
    assert (steps <= np.diff(curve["s_m"]) + 1e-9).all()
    for spacing in (0.0, -1.0, math.nan, 1e-9):
        with pytest.raises(ValueError):
            plan.curve(spacing=spacing)


def test_published_values_are_those_of_the_papers(house: keyway.Map) -> None:
    for as_published, safe_m in ((False, 0.23), (True, 0.8)):
        comparison = keyway.compare(
            house, planners=["jps"], smoothers=["hierarchical"], robot="small", as_published=as_published, times=False
        )
        assert comparison.report["config"]["smoothers"][0]["safe_distance_m"] == pytest.approx(safe_m)
    ends = (-8.175, -2.825), (8.725, 0.875)
    lengths = {
        keyway.plan(house, *ends, robot="small", smoother="hierarchical", as_published=as_published).length
        for as_published in (False, True)
    }
    assert len(lengths) == 2


def test_parameters_are_those_of_the_files() -> None:
    # A diagonal gap: only who cuts corners gets through.
    grid = keyway.Map.from_array(np.array([[False, True], [True, False]]), resolution=1.0)
    ends = (0.5, 0.5), (1.5, 1.5)
    with pytest.raises(keyway.NoPath, match="corners"):
        keyway.plan(grid, *ends, planner="astar")
    parameters = {"planner": {"name": "astar", "corners": "allow"}}
    assert keyway.plan(grid, *ends, parameters=parameters).cost == math.sqrt(2)
    unknown = keyway.Map.from_array(np.array([[0, -1, 0]], dtype=np.int8), resolution=1.0)
    with pytest.raises(keyway.NoPath, match="unknown space"):
        keyway.plan(unknown, (0.5, 0.5), (2.5, 0.5))
    free = {"map": {"unknown": "free"}}
    assert keyway.plan(unknown, (0.5, 0.5), (2.5, 0.5), parameters=free).cost == 2.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"planner": "jsp"}, "`planner.name` must be one of .*, got `jsp`"),
        ({"smoother": "silk"}, "`smoother.name` must be one of .*, got `silk`"),
        ({"radius": -0.5}, "map.clearance_m must be a length of at least 0.*, got -0.5"),
        ({"radius": math.nan}, "map.clearance_m must be .* got NaN"),
        ({"robot": "hal"}, "there is no robot `hal`, expected one of small, jackal, .*, pallet-truck, or a file"),
        ({"robot": {"like": "small", "cycle_s": -1}}, "robot: cycle_s must be a time from 0.001 to 10 s, got -1"),
        ({"robot": {"like": "small", "speed": 1}}, "robot: `speed`: unknown field `speed`"),
        ({"robot": {"radius_m": 0.2}}, "robot: the robot needs `v_max_mps`, the top speed"),
        ({"parameters": {"map": {"clearance": 1.0}}}, "there is no field `map.clearance`; `map` has: "),
        ({"parameters": {"map": {"unknown": 3}}}, "`map.unknown`: invalid type, expected a string"),
        ({"parameters": {"map": {"unknown": "maybe"}}}, "`map.unknown`: "),
        ({"parameters": {"smoother": {"name": "taut", "tension": 1}}}, "there is no field `smoother.tension`"),
        ({"parameters": {"map": None}}, "`map`|None|unit"),
        ({"start": (math.nan, 1)}, r"start: both coordinates must be finite numbers, got \(NaN, 1\)"),
        ({"goal": (1, 2, 3)}, r"goal: expected \(x, y\) in metres, got 3 numbers"),
    ],
)
def test_bad_values_are_named(arguments: dict[str, Any], message: str) -> None:
    grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    with pytest.raises(ValueError, match=message):
        keyway.plan(grid, **{"start": (1, 1), "goal": (9, 9), **arguments})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"start": "ab"}, "(?s)expected numbers such as .* got str.*start"),
        ({"goal": None}, "(?s)expected numbers.*goal"),
        ({"goal": np.zeros((2, 2))}, "goal.*"),
        ({"planner": 3}, "planner"),
        ({"parameters": [1]}, "(?s)expected a dictionary of parameters, got list.*parameters"),
        ({"budget": "ten"}, "budget"),
    ],
)
def test_wrong_types_are_named(arguments: dict[str, Any], message: str) -> None:
    grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    with pytest.raises(TypeError, match=message):
        keyway.plan(grid, **{"start": (1, 1), "goal": (9, 9), **arguments})


def test_why_there_is_no_plan() -> None:
    occupied = np.zeros((20, 40), dtype=bool)
    occupied[:, 20] = True
    occupied[8:11, 20] = False
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    ends = (0.5, 0.5), (3.5, 0.5)
    assert keyway.plan(grid, *ends, radius=0.1).expanded > 0
    with pytest.raises(keyway.NoPath, match="for a radius of 0.3 m; the largest feasible radius is 0.15 m") as raised:
        keyway.plan(grid, *ends, radius=0.3)
    assert isinstance(raised.value, keyway.KeywayError)
    with pytest.raises(keyway.NoRoom, match=r"start \(2.050, 0.500\), cell \(20, 5\), is inside an obstacle; the nearest free position is \(1.950, 0.550\)"):
        keyway.plan(grid, (2.05, 0.5), ends[1])
    with pytest.raises(keyway.NoRoom, match=r"goal \(1e300, 1e0\), cell .*, is outside the map; the nearest free position is"):
        keyway.plan(grid, ends[0], (1e300, 1))
    with pytest.raises(keyway.BudgetExhausted, match="budget of 3 expanded nodes"):
        keyway.plan(grid, *ends, planner="dijkstra", budget=3)
    with pytest.raises(keyway.Missed, match=r'; to draw more samples, pass parameters={"planner": {"samples": 10}}$'):
        keyway.plan(grid, *ends, parameters={"planner": {"name": "rrt", "samples": 1}})
    closed = keyway.plan(grid, ends[0], (3.5, 0.5), radius=0.3, nearest_reachable=True)
    assert closed.xy[-1][0] < 2.0


def test_the_clearance_is_lifted_around_the_ends() -> None:
    occupied = np.zeros((20, 40), dtype=bool)
    occupied[0, :] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    arguments: dict[str, Any] = {"radius": 0.3, "start": (0.55, 0.15), "goal": (3.5, 1.0)}
    with pytest.raises(keyway.NoRoom):
        keyway.plan(grid, **arguments)
    for _ in range(2):
        plan = keyway.plan(grid, **arguments, parameters={"map": {"free_ends_m": 0.5}})
        assert plan.cells[0].tolist() == [5, 1]


def test_many_plans_are_the_single_ones_in_their_order(house: keyway.Map) -> None:
    free = house.free_positions()
    picked = np.random.default_rng(1).choice(len(free), (200, 2))
    starts, goals = free[picked[:, 0]], free[picked[:, 1]]
    seen: list[tuple[int, int | None]] = []
    plans = keyway.plan_many(house, starts, goals, radius=0.1, smoother="taut", jobs=4, progress=lambda *at: seen.append(at))
    planner = keyway.Planner(house, radius=0.1, smoother="taut")
    kinds = set()
    for start, goal, plan in zip(starts, goals, plans, strict=True):
        kinds.add(type(plan))
        if isinstance(plan, keyway.Plan):
            alone = planner.plan(start, goal)
            assert np.array_equal(alone.xy, plan.xy) and alone.cost == plan.cost
        else:
            with pytest.raises(type(plan)):
                planner.plan(start, goal)
    assert {keyway.Plan, keyway.NoRoom} <= kinds
    assert seen[-1] == (200, 200)
    assert keyway.plan_many(house, [], []) == []
    with pytest.raises(ValueError, match="as many goals as starts, got 200 and 199"):
        keyway.plan_many(house, starts, goals[1:])
    with pytest.raises(ValueError, match=r"goals\[0\]"):
        keyway.plan_many(house, [(0, 0)], [(math.inf, 0)])


def test_threads_share_a_planner(house: keyway.Map) -> None:
    planner = keyway.Planner(house, radius=0.2, smoother="taut")
    ends = (-8.175, -2.825), (8.725, 0.875)
    expected = planner.plan(*ends).xy

    def other_paths(_: int) -> int:
        return sum(not np.array_equal(planner.plan(*ends).xy, expected) for _ in range(50))

    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        assert sum(threads.map(other_paths, range(4))) == 0


def test_the_nearest_of_several_goals(house: keyway.Map) -> None:
    planner = keyway.Planner(house, radius=0.2, smoother="taut")
    start, goals = (-8.175, -2.825), [(8.725, 0.875), (0.0, 2.0), (100.0, 0.0), (-4.875, 2.025)]
    costs = {i: planner.plan(start, goals[i]).cost for i in (0, 1, 3)}
    index, plan = planner.plan_nearest(start, goals)
    assert index == min(costs, key=lambda i: costs[i]) and plan.cost == costs[index]
    assert np.array_equal(plan.xy, planner.plan(start, goals[index]).xy)
    assert planner.plan_nearest(start, goals[:1])[0] == 0
    with pytest.raises(keyway.NoRoom, match=r"goal \(100.000, 0.000\)"):
        planner.plan_nearest(start, goals[2:3])
    with pytest.raises(keyway.NoRoom, match="start"):
        planner.plan_nearest((100, 0), goals)
    with pytest.raises(keyway.KeywayError):
        planner.plan_nearest(start, [(100, 0), (0, 100)])
    with pytest.raises(ValueError, match="goals: expected at least one"):
        planner.plan_nearest(start, [])


def test_a_picture_says_what_was_smoothed(house: keyway.Map) -> None:
    ends = (-8.175, -2.825), (8.725, 0.875)
    for smoother, is_smoothed in (("none", False), ("taut", True)):
        picture = keyway.plan(house, *ends, radius=0.2, smoother=smoother)._repr_svg_()
        assert ("smoothed path" in picture) == is_smoothed and "planned path" in picture


def test_advice_is_an_argument_that_helps() -> None:
    """Every message that advises something names it as it is written in Python, and following it helps."""
    values = np.zeros((30, 60), dtype=np.int8)
    values[:, 30] = -1
    unknown = keyway.Map.from_array(values, resolution=0.1)
    occupied = np.zeros((30, 60), dtype=bool)
    occupied[15:, 20:24] = occupied[0, :] = True
    walls = keyway.Map.from_array(occupied, resolution=0.1)
    corner = keyway.Map.from_array(np.array([[False, True], [True, False]]), resolution=1.0)
    ends: Any = (0.55, 1.05), (5.55, 1.05)
    cases: list[tuple[keyway.Map, Any, dict[str, Any]]] = [
        (unknown, ends, {}),
        (unknown, (ends[0], (3.05, 1.05)), {}),
        (unknown, (ends[0], (2.95, 1.05)), {"radius": 0.2}),
        (walls, ends, {"parameters": {"planner": {"name": "rrt", "samples": 3}}}),
        (walls, ((0.55, 0.15), ends[1]), {"parameters": {"map": {"published": {"expansion_cells": 1}}}}),
        (corner, ((0.5, 0.5), (1.5, 1.5)), {"planner": "astar"}),
        (corner, ((0.5, 0.5), (1.5, 1.5)), {"planner": "jps"}),
        (walls, ((0.55, 0.15), ends[1]), {"planner": "hsta", "parameters": {"planner": {"if_no_path": "fail"}}}),
    ]
    followed = 0
    for grid, (start, goal), arguments in cases:
        try:
            keyway.plan(grid, start, goal, **arguments)
        except keyway.KeywayError as error:
            text = str(error)
            assert " --" not in text and "`--" not in text and "set the parameter" not in text, text
            advised = re.search(r"parameters=(\{.*\})", text)
            if advised:
                merged = {name: dict(table) for name, table in arguments.get("parameters", {}).items()}
                for name, table in eval(advised[1]).items():
                    merged.setdefault(name, {}).update(table)
                named = dict(re.findall(r'(planner)="(.*?)"', text))
                keyway.plan(grid, start, goal, **{**arguments, **named, "parameters": merged})
                followed += 1
    assert followed >= 4

"""Bad input from Python never aborts the interpreter: nothing but the exceptions that are documented comes out."""

import concurrent.futures
import math
import os
import random
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import keyway

ALLOWED = (ValueError, TypeError, OverflowError, OSError, AttributeError, keyway.KeywayError)


def grids() -> list[Any]:
    frozen = np.zeros((4, 5), dtype=bool)
    frozen.flags.writeable = False
    return [
        None, 0, "map", [], [[]], [[True]], b"bytes", object(), np.zeros(()), np.zeros(3, dtype=bool),
        np.zeros((0, 0), dtype=bool), np.zeros((0, 7), dtype=np.int8), np.zeros((2, 3, 4), dtype=bool),
        np.zeros((3, 3)), np.zeros((3, 3), dtype=object), np.zeros((3, 3), dtype="U3"), frozen,
        np.ones((6, 8), dtype=bool)[::-1, ::-2], np.broadcast_to(np.array([[True]]), (50, 60)),
        np.full((5, 5), -1, dtype=np.int8), np.asfortranarray(np.eye(7, dtype=bool)),
        np.lib.stride_tricks.as_strided(np.zeros(9, dtype=np.int8), (3, 3), (1, 1)),
        np.zeros((3, 3), dtype=">i8"), np.ma.masked_array(np.zeros((3, 3), dtype=bool)), np.zeros((1, 1), dtype=bool),
        np.broadcast_to(np.array([[False]]), (1 << 20, 1 << 20)),
    ]


NUMBERS: list[Any] = [
    None, 0, 1, -1, 0.5, -0.0, math.nan, math.inf, -math.inf, 1e308, 1e-308, -1e308, 2**63, 2**64, -(2**63), 10**400,
    True, "1", b"1", [], (1,), 1j, np.float32(2), np.int64(3), np.array(4.0), np.array([1.0]), object(),
]
PLACES: list[Any] = [
    None, 0, "ab", b"ab", "abc", (), (1,), (1, 2), (1, 2, 3), (1, 2, 3, 4), [math.nan, 1], [math.inf, -math.inf], (1e308, -1e308),
    ("a", "b"), (None, None), {1: 2, 3: 4}, {1, 2}, np.zeros(2), np.zeros((2, 2)), np.zeros(2, dtype=">f4"), np.array([1j, 2j]),
    np.zeros(4)[::-2], iter([1, 2]), range(2), (10**400, 1), ((1, 2), (3, 4)), object(), np.zeros((0, 2)), np.zeros((3, 3)),
    np.full((4, 2), math.nan), np.zeros(1_000_000), [[0.5, 0.5]] * 5, [[0.5, 0.5], [1.0]],
]
TEXTS: list[Any] = [
    None, "", "jps", "taut", "none", "small", "key-point-fusion", "keyway", "\0", "\ud800", "ü" * 1000, "a/b.toml", "..", "/dev/null",
    "--help", "x,y", 3, b"jps", ["jps"], ["all"], ["jps", "jps"], [], "planners",
]
TABLES: list[Any] = [
    None, {}, {"map": {}}, {"map": 3}, {"map": {"clearance_m": math.nan}}, {"map": {"clearance_m": 1e300}}, {1: 2}, {"": {"": {}}},
    {"map": {"unknown": "free"}}, {"planner": {"name": "hsta"}}, {"planner": {"name": None}}, {"a": object()}, {"a": [1, "b", None]},
    {"a": 2**70}, {"a": b"b"}, [], "map", {"local": {"window": {"horizon_s": 1e-300}}}, {"map": {"free_ends_m": 1e9}}, {"x\ny": 1},
    {"rules": {"time_limit_s": 0.2}}, {"planner.name": "jps"}, {"seed": -1}, {"unknown": [{}]}, {"random": {}},
]
NO_FOLDERS: list[Any] = ["/nowhere/out", "\0", 3]
COMMANDS: list[Any] = [["--help"], ["plan"], ["\0"], 3, [3], ["list", "hsta"]]
_deep: dict[str, Any] = {}
for _ in range(500):
    _deep = {"map": _deep}
_in_itself: dict[str, Any] = {}
_in_itself["map"] = _in_itself
TABLES += [_deep, _in_itself]


#: All threads share these.
GOOD = keyway.Map.from_array(np.zeros((12, 16), dtype=bool), resolution=0.5)
NAVIGATOR = keyway.Navigator(GOOD)
NAVIGATOR.relocate((1, 1, 0))
NAVIGATOR.set_goal((6, 4))
SIMULATION = keyway.Simulation(keyway.Scene(GOOD, (1, 1), (6, 4)))


def calls(random: random.Random) -> list[Callable[[], object]]:
    """Calls of everything that there is, with arguments of which some are wrong."""
    pick = random.choice
    good = GOOD

    def place() -> Any:
        return pick(PLACES) if random.random() < 0.4 else (pick([1, 2, 3]), pick([1, 2, 3]))

    def pose() -> Any:
        return pick(PLACES) if random.random() < 0.1 else (pick([1, 2, 3]), pick([1, 2, 3]), 0.5)

    def grid() -> Any:
        return pick([None, 3, "map", np.zeros((3, 3), dtype=bool)]) if random.random() < 0.1 else good

    def some(**choices: list[Any]) -> dict[str, Any]:
        return {name: pick(values) for name, values in choices.items() if random.random() < 0.4}

    def navigator() -> object:
        made = pick([NAVIGATOR, keyway.Navigator(good)])
        scans: list[Any] = [keyway.Scan(np.full(360, value), -math.pi, math.tau / 360, **some(stamp=NUMBERS)) for value in (0, -1, math.nan, math.inf, 1e308)]
        steps = []
        # Mostly right ones, so that threads meet.
        for cycle in range(5):
            made.observe(cycle * 0.1, pose(), pick([(0.1, 0.0), (0.2, -0.3)]), pick(scans))
            steps.append(made.step())
        answer = repr(steps)
        changes: list[Callable[[], object]] = [made.cancel, lambda: made.relocate(pose()), lambda: made.set_goal(place()), lambda: made.set_goals(pick(PLACES), place())]
        pick(changes)()
        made.observe(pick(NUMBERS), place(), place(), pick([*PLACES, *scans, np.zeros(360)]))
        return answer, made.step(), made.goal, made.remaining, made.route

    def simulation() -> object:
        made = pick([SIMULATION, keyway.Simulation(keyway.Scene(good, (1, 1), (6, 4), **some(seed=NUMBERS, via=PLACES)))])
        return [made.step(pick(NUMBERS), pick(NUMBERS), **some(remaining=NUMBERS)) for _ in range(3)]

    options = {"radius": NUMBERS, "planner": TEXTS, "smoother": TEXTS, "robot": TEXTS, "parameters": TABLES}
    plan = keyway.plan(good, (1, 1), (6, 4))
    return [
        lambda: keyway.Map.from_array(pick(grids()), **some(resolution=NUMBERS, origin=PLACES)),
        lambda: keyway.Map.read(pick(TEXTS), **some(resolution=NUMBERS, origin=PLACES)),
        lambda: good.cells(pick(PLACES)),
        lambda: keyway.Scan(pick(PLACES), **some(angle_min=NUMBERS, angle_increment=NUMBERS)),
        lambda: good.write(pick(["\0", "", "a.b", "/nowhere/a.map", 3])),  # type: ignore[arg-type]
        lambda: keyway.plan(grid(), place(), place(), **some(**options, budget=NUMBERS, nearest_reachable=NUMBERS)),
        lambda: keyway.Planner(grid(), **some(**options, progress=NUMBERS)).plan(place(), place(), **some(progress=NUMBERS)),
        lambda: keyway.Planner(good).plan_nearest(place(), pick(PLACES), **some(budget=NUMBERS)),
        lambda: keyway.plan_many(grid(), pick(PLACES), pick(PLACES), **some(**options, jobs=NUMBERS, progress=NUMBERS)),
        lambda: plan.curve(**some(spacing=NUMBERS, robot=TEXTS)),
        navigator,
        lambda: keyway.Navigator(grid(), **some(robot=TEXTS, stack=TEXTS, parameters=TABLES, radius=NUMBERS)),
        simulation,
        lambda: keyway.Scene(grid(), place(), place(), **some(robot=TEXTS, stack=TEXTS, seed=NUMBERS, rules=TABLES, moving=TABLES, unknown=TABLES)),
        lambda: keyway.Scene.from_toml(pick(TEXTS)),
        lambda: keyway.Scene.read(pick(TEXTS)),
        lambda: keyway.simulate(pick([None, good, 3])),  # type: ignore[arg-type]
        lambda: keyway.compare(grid(), **some(planners=TEXTS, smoothers=TEXTS, queries=[-1, 0, 2, 2**65, "x"], seed=NUMBERS, radius=NUMBERS, parameters=TABLES, columns=TEXTS, times=[0, True, "x"])),
        lambda: keyway.batch(pick(TEXTS), pick(NO_FOLDERS), **some(stacks=TEXTS, seeds=NUMBERS, shard=PLACES, jobs=NUMBERS)),
        lambda: keyway.merge(pick(TEXTS), "/nowhere/out"),
        lambda: keyway.names(pick(TEXTS)),
        lambda: keyway.program(pick(COMMANDS)),
    ]


def storm(seed: int, rounds: int) -> tuple[int, int]:
    """How many calls gave an answer and how many an exception that is allowed."""
    numbers, answers, refusals = random.Random(seed), 0, 0
    for _ in range(rounds):
        for call in calls(numbers):
            try:
                repr(call())
                answers += 1
            except ALLOWED as error:
                assert str(error) or isinstance(error, (TypeError, AttributeError)), repr(error)
                refusals += 1
    return answers, refusals


def test_only_exceptions_come_out() -> None:
    answers, refusals = storm(1, 150)
    assert answers > 150 and refusals > 500


def test_also_under_load_from_several_threads() -> None:
    with concurrent.futures.ThreadPoolExecutor(6) as threads:
        results = list(threads.map(lambda seed: storm(seed, 25), range(10, 22)))
    assert all(answers > 10 and refusals > 50 for answers, refusals in results)


def test_a_dictionary_may_have_itself_in_it() -> None:
    """Or many others: the stack is not used up."""
    grid = keyway.Map.from_array(np.zeros((5, 5), dtype=bool), resolution=1.0)
    deep: Any = {}
    for _ in range(100_000):
        deep = {"map": deep}
    lists: Any = []
    lists.append(lists)
    for table in (deep, _in_itself, {"map": {"unknown": lists}}):
        for call in (
            lambda table: keyway.plan(grid, (1, 1), (2, 2), parameters=table),
            lambda table: keyway.compare(grid, parameters=table),
            lambda table: keyway.Scene(grid, (1, 1), (2, 2), rules=table),
        ):
            with pytest.raises(ValueError, match="nested too deeply"):
                call(table)
    # Python takes them apart one in the other, too.
    while deep:
        deep = deep.pop("map")


def test_numbers_of_numpy_are_numbers() -> None:
    grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    rrt = {"name": "rrt", "samples": np.int64(9000), "goal_bias": np.float32(0.5)}
    plan = keyway.plan(grid, np.array([1, 1], dtype=np.float32), np.array([9, 9]), parameters={"planner": rrt, "map": {"clearance_m": np.array(0.5)}})
    assert plan.planner == "rrt"
    post = {"position": np.array([4.0, 4.0]), "radius_m": np.float32(0.25)}
    scene = keyway.Scene(grid, (1, 1), (9, 9), unknown=[post], seed=np.uint8(3), via=np.array([[2, 2], [3, 5]]))
    assert scene.seed == 3 and "radius_m = 0.25" in scene.to_toml()
    for wrong in (1j, b"x", {1}, np.complex128(1), np.datetime64(0, "s"), np.array([1j]), object(), 2**63, None):
        with pytest.raises(ValueError, match="`samples`: expected a"):
            keyway.plan(grid, (1, 1), (2, 2), parameters={"planner": {"name": "rrt", "samples": wrong}})


#: With too little memory: what Python does where an allocation of the library would end the process.
SHORT_OF_MEMORY = """
import pathlib, pickle, resource, sys
import numpy as np
import keyway
cells = np.broadcast_to(np.array([[{cell}]]), (8000, 8000))
grid = keyway.Map.from_array(cells[:{side}, :{side}], resolution=1.0)
used = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (40 << 20), used + (40 << 20)))
try:
    {call}
except MemoryError as error:
    assert "a map of this size needs " in str(error), error
    sys.exit(3)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")
@pytest.mark.parametrize(
    ("call", "cell", "side"),
    [
        ("keyway.Map.from_array(cells, resolution=1.0)", "np.int8(0)", 1), ("grid.occupied", "False", 8000), ("grid.unknown", "False", 8000),
        ("grid.occupancy", "False", 8000), ("grid.free_positions()", "False", 3000), ("pickle.dumps(grid)", "False", 8000),
        ("keyway.plan(grid, (1, 1), (2, 2))", "False", 8000),
    ],
)
def test_a_map_without_memory_is_an_exception(call: str, cell: str, side: int) -> None:
    program = SHORT_OF_MEMORY.format(call=call, cell=cell, side=side)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 3, done.stderr[-500:]


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")
def test_no_more_threads_than_there_can_be() -> None:
    program = """
import pathlib, resource, keyway, numpy as np
grid = keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0)
used = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
# Room for the stacks of `{room}` threads of 1 GiB: one that ends, one that does the work, and one to help.
limit = used + (2 * {room} + 1 << 29)
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
plans = keyway.plan_many(grid, [(1, 1)] * 5000, [(8, 8)] * 5000, jobs=1000)
assert len(plans) == 5000 and all(isinstance(plan, keyway.Plan) for plan in plans)
"""
    environment = {**os.environ, "RUST_MIN_STACK": str(1 << 30)}

    def errors(room: int) -> str:
        words = [sys.executable, "-c", program.format(room=room)]
        return subprocess.run(words, capture_output=True, text=True, env=environment).stderr

    assert errors(room=3) == ""
    assert "RuntimeError: cannot start a thread for the work" in errors(room=0)

"""Long calls let other threads run, can be stopped, and say how far they are."""

import os
import pathlib
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

import keyway


@pytest.fixture(scope="module")
def long_scene() -> keyway.Scene:
    """A run of several minutes of simulated time, and of many seconds of the clock."""
    occupied = np.zeros((1500, 1500), dtype=bool)
    occupied[20:-20:20, 20:-20:20] = True
    grid = keyway.Map.from_array(occupied, resolution=0.1)
    return keyway.Scene(grid, (1, 1), (149, 149), via=[(149, 3), (3, 147)], stack="keyway")


def long_calls(scene: keyway.Scene, folder: pathlib.Path) -> dict[str, Callable[..., object]]:
    grid = keyway.Map.from_array(np.random.default_rng(3).random((700, 700)) < 0.2, resolution=1.0)
    free = grid.free_positions()
    ends = np.random.default_rng(4).choice(len(free), (20000, 2))
    (folder / "scene.toml").write_text(
        'version = 2\nmap = "map.map"\nstart = [5.5, 5.5]\ngoal = [35.5, 35.5]\n[disturbances.sensor]\nrange_m = 0.01\n'
    )
    keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=1.0).write(folder / "map.map")
    return {
        "simulate": lambda **to: keyway.simulate(scene, **to),
        "plan_many": lambda **to: keyway.plan_many(grid, free[ends[:, 0]], free[ends[:, 1]], planner="dijkstra", **to),
        "compare": lambda **to: keyway.compare(grid, planners=["dijkstra", "astar"], queries=5000, **to),
        "batch": lambda **to: keyway.batch([folder / "scene.toml"], folder / "out", seeds=5000, **to),
    }


NAMES = ["simulate", "plan_many", "compare", "batch"]


def calls_of_one_piece() -> dict[str, Callable[..., object]]:
    """Each of them would take more than half a second, and does one thing only."""
    clutter = np.random.default_rng(3).random((3000, 3000)) < 0.2
    grid = keyway.Map.from_array(clutter, resolution=1.0)
    free = grid.free_positions()
    small = keyway.Map.from_array(clutter[:200, :200], resolution=1.0)
    near = small.free_positions()
    # Walls with gaps at their ends in turn, which a random tree does not find.
    maze = np.zeros((1024, 1024), dtype=bool)
    maze[2:-2:8, 1:] = maze[6:-2:8, :-1] = True
    walls = keyway.Map.from_array(maze, resolution=1.0)
    slow = keyway.Navigator(grid, parameters={"planner": {"name": "lazy-theta-star"}}, radius=0.1)
    slow.relocate((*free[0], 0.0))
    return {
        "plan": lambda **to: keyway.plan(grid, free[0], free[-1], planner="lazy-theta-star", **to),
        "plan with a random tree": lambda **to: keyway.plan(walls, (0.5, 0.5), (1023.5, 1023.5), planner="rrt", **to),
        "plan_nearest": lambda **to: keyway.Planner(grid, planner="theta-star").plan_nearest(free[0], free[-3:], **to),
        "Planner": lambda **to: keyway.Planner(small, planner="prepared", **to),
        "plan, prepared": lambda **to: keyway.plan(small, near[0], near[-1], planner="prepared", radius=0.01, **to),
        "compare, prepared": lambda **to: keyway.compare(small, planners=["prepared"], queries=3, **to),
        "set_goal": lambda **to: slow.set_goal(free[-1], **to),
        "Simulation": lambda **to: keyway.Simulation(keyway.Scene(grid, free[0], free[-1]), **to),
    }


OF_ONE_PIECE = [
    "plan", "plan with a random tree", "plan_nearest", "Planner", "plan, prepared", "compare, prepared", "set_goal", "Simulation",
]


@pytest.fixture(scope="module")
def single_calls() -> dict[str, Callable[..., object]]:
    return calls_of_one_piece()


@pytest.fixture()
def interruptible() -> Iterator[None]:
    """Who is started in the background ignores Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def ctrl_c_after(time_s: float, call: Callable[[], object]) -> None:
    """Calls it, and no Ctrl-C comes later than in here."""
    timer = threading.Timer(time_s, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        call()
        pytest.fail("it has ended before")
    finally:
        timer.cancel()


def eventually(holds: Callable[[], bool]) -> None:
    """It holds sooner or later, however slow the machine is."""
    for _ in range(200):
        if holds():
            return
        time.sleep(0.1)
    pytest.fail("it never held")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_it(name: str, long_scene: keyway.Scene, tmp_path: pathlib.Path) -> None:
    call = long_calls(long_scene, tmp_path)[name]
    # To its end each of them takes longer.
    with pytest.raises(KeyboardInterrupt):
        ctrl_c_after(0.4, call)


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted as on Linux")
@pytest.mark.usefixtures("interruptible")
def test_a_batch_that_is_stopped_has_ended(tmp_path: pathlib.Path) -> None:
    """Nobody writes into its folder any more, though each run takes a while."""
    keyway.Map.from_array(np.zeros((400, 400), dtype=bool), resolution=1.0).write(tmp_path / "map.map")
    text = 'version = 2\nmap = "map.map"\nstart = [5.5, 5.5]\ngoal = [395.5, 395.5]\n[disturbances.sensor]\nrange_m = 0.01\n'
    (tmp_path / "scene.toml").write_text(text)
    threads = len(os.listdir("/proc/self/task"))
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            ctrl_c_after(0.2, lambda: keyway.batch([tmp_path / "scene.toml"], tmp_path / "out", seeds=500))
        # The batch would go on for minutes.
        eventually(lambda: len(os.listdir("/proc/self/task")) <= threads)


def test_what_is_usually_a_mistake_is_a_warning(tmp_path: pathlib.Path, capfd: pytest.CaptureFixture[str]) -> None:
    keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=1.0).write(tmp_path / "map.map")
    (tmp_path / "scene.toml").write_text('version = 2\nmap = "map.map"\nstart = [5.5, 5.5]\ngoal = [6.5, 6.5]\n')
    with pytest.warns(UserWarning, match="scene: nothing in the scene is random, so every seed gives the same run"):
        keyway.batch([tmp_path / "scene.toml"], tmp_path / "out", seeds=2)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("name", NAMES)
def test_progress_is_called_and_may_stop_it(name: str, long_scene: keyway.Scene, tmp_path: pathlib.Path) -> None:
    call = long_calls(long_scene, tmp_path)[name]
    seen: list[tuple[int, int | None]] = []

    def progress(done: int, expected: int | None) -> None:
        seen.append((done, expected))
        if len(seen) >= 6 and done > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        call(progress=progress)
    done = [at for at, _ in seen]
    assert done == sorted(done) and done[-1] > 0
    expected = {"simulate": None, "plan_many": 20000, "compare": 10000, "batch": 5000}[name]
    assert seen[-1][1] == expected


@pytest.mark.parametrize("name", NAMES)
def test_other_threads_go_on(name: str, long_scene: keyway.Scene, tmp_path: pathlib.Path) -> None:
    call = long_calls(long_scene, tmp_path)[name]
    ticks, is_over = 0, threading.Event()

    def count() -> None:
        nonlocal ticks
        while not is_over.wait(0.01):
            ticks += 1

    def progress(done: int, expected: int | None) -> None:
        if ticks >= 20:
            raise RuntimeError("enough")

    thread = threading.Thread(target=count)
    thread.start()
    with pytest.raises(RuntimeError, match="enough"):
        call(progress=progress)
    is_over.set()
    thread.join()


def test_a_stopped_batch_goes_on_where_it_was(tmp_path: pathlib.Path, long_scene: keyway.Scene) -> None:
    long_calls(long_scene, tmp_path)
    seen: list[tuple[int, int | None]] = []

    def stop(done: int, expected: int | None) -> None:
        seen.append((done, expected))
        if done >= 3:
            raise RuntimeError("enough")

    for _ in range(2):
        with pytest.raises(RuntimeError, match="enough"):
            keyway.batch([tmp_path / "scene.toml"], tmp_path / "out", seeds=200, jobs=1, progress=stop)
    missing = [expected for done, expected in seen if done >= 3]
    assert missing[0] == 200
    assert missing[1] is not None and missing[1] <= 200 - 3


def test_a_preparation_is_counted_and_its_end_said() -> None:
    clutter = np.random.default_rng(3).random((120, 120)) < 0.2
    seen: list[tuple[int, int | None]] = []

    def progress(done: int, expected: int | None) -> None:
        seen.append((done, expected))

    keyway.Planner(keyway.Map.from_array(clutter, resolution=1.0), planner="prepared", progress=progress)
    done = [at for at, _ in seen]
    assert done == sorted(done) and len(done) > 1
    assert seen[-1][0] == seen[-1][1] and seen[-1][0] > 2000


def test_a_preparation_that_is_stopped_has_ended() -> None:
    """It uses no core any more, though its map would take a while."""
    clutter = np.random.default_rng(3).random((200, 200)) < 0.2

    def progress(done: int, expected: int | None) -> None:
        if done > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        keyway.Planner(keyway.Map.from_array(clutter, resolution=1.0), planner="prepared", progress=progress)

    def rests() -> bool:
        before = time.process_time()
        time.sleep(0.1)
        return time.process_time() - before < 0.03

    eventually(rests)


# The last ones: most leave a thread at work behind.
@pytest.mark.parametrize("name", OF_ONE_PIECE)
def test_a_single_one_may_be_watched(name: str, single_calls: dict[str, Callable[..., object]]) -> None:
    seen: list[tuple[int, int | None]] = []

    def progress(done: int, expected: int | None) -> None:
        seen.append((done, expected))
        if len(seen) == 3:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        single_calls[name](progress=progress)
    assert len(seen) == 3


@pytest.mark.parametrize("name", OF_ONE_PIECE)
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_a_single_one_at_once(name: str, single_calls: dict[str, Callable[..., object]]) -> None:
    with pytest.raises(KeyboardInterrupt):
        ctrl_c_after(0.1, single_calls[name])


def test_a_search_on_a_large_map_is_the_same_with_and_without_a_thread() -> None:
    """Who watches has a thread at once; otherwise a search gets one after 2,048 nodes."""
    grid = keyway.Map.from_array(np.random.default_rng(7).random((1100, 1100)) < 0.2, resolution=1.0)
    free = grid.free_positions()
    for planner in ("astar", "jps"):
        assert keyway.plan(grid, free[0], free[30], planner=planner).expanded < 2048
        for goal in (free[30], free[-1]):
            alone = keyway.plan(grid, free[0], goal, planner=planner)
            watched = keyway.plan(grid, free[0], goal, planner=planner, progress=lambda done, expected: None)
            assert alone.cost == watched.cost and alone.expanded == watched.expanded
            assert np.array_equal(alone.cells, watched.cells) and np.array_equal(alone.xy, watched.xy)
    far = keyway.plan(grid, free[0], free[-1], planner="astar")
    assert far.expanded > 2048
    for budget in (100, 20000, far.expanded - 1):
        with pytest.raises(keyway.BudgetExhausted):
            keyway.plan(grid, free[0], free[-1], planner="astar", budget=budget)

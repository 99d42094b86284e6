"""Keyway beside other packages for Python, measured in one run; prints the tables of docs/python.md.

    pip install keyway-nav pathfinding pyastar2d scikit-image ir-sim
    python side_by_side.py small_house.yaml nav2_depot.yaml Berlin_0_1024.map

Every package plans the same queries on the same map, in turns, on a map that is in its own form already; of a call's rounds the
fastest counts. Who needs longer than its share of time answers fewer queries, and the table says how many. A package that is not
installed is left out.
"""

import argparse
import heapq
import math
import pathlib
import statistics
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import keyway

Cell = tuple[int, int]
#: From a start and a goal to the cost of the path in cells; `None` where there is none.
Plan = Callable[[Cell, Cell], float | None]


def length(path: Any) -> float:
    """Cost of a path over cells: straight and diagonal steps."""
    steps = np.diff(np.asarray(path, dtype=float), axis=0)
    return float(np.hypot(steps[:, 0], steps[:, 1]).sum())


def keyway_planner(occupied: np.ndarray, name: str) -> Plan:
    planner = keyway.Planner(keyway.Map.from_array(occupied, resolution=1.0), planner=name)

    def plan(start: Cell, goal: Cell) -> float | None:
        return planner.plan((start[0] + 0.5, start[1] + 0.5), (goal[0] + 0.5, goal[1] + 0.5)).cost

    return plan


def textbook(occupied: np.ndarray) -> Plan:
    """A* with heapq and dictionaries, in the form of PythonRobotics; no corner is cut."""
    rows, columns = occupied.shape
    blocked = occupied.tolist()
    moves = [(dx, dy, math.hypot(dx, dy)) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]

    def is_free(x: int, y: int) -> bool:
        return 0 <= x < columns and 0 <= y < rows and not blocked[y][x]

    def plan(start: Cell, goal: Cell) -> float | None:
        costs, parents, closed = {start: 0.0}, {start: start}, set()
        heap = [(0.0, start)]
        while heap:
            _, at = heapq.heappop(heap)
            if at == goal:
                path = [at]
                while path[-1] != start:
                    path.append(parents[path[-1]])
                return length(path)
            if at in closed:
                continue
            closed.add(at)
            x, y = at
            for dx, dy, step in moves:
                there = (x + dx, y + dy)
                if not is_free(*there) or not is_free(x + dx, y) or not is_free(x, y + dy):
                    continue
                cost = costs[at] + step
                if cost < costs.get(there, math.inf):
                    costs[there], parents[there] = cost, at
                    heapq.heappush(heap, (cost + math.hypot(goal[0] - there[0], goal[1] - there[1]), there))
        return None

    return plan


def pathfinding(occupied: np.ndarray) -> Plan:
    from pathfinding.core.diagonal_movement import DiagonalMovement
    from pathfinding.core.grid import Grid
    from pathfinding.finder.a_star import AStarFinder

    grid = Grid(matrix=(~occupied).astype(int).tolist())
    finder = AStarFinder(diagonal_movement=DiagonalMovement.only_when_no_obstacle)

    def plan(start: Cell, goal: Cell) -> float | None:
        grid.cleanup()
        path, _ = finder.find_path(grid.node(*start), grid.node(*goal), grid)
        return length([(node.x, node.y) for node in path]) if path else None

    return plan


def pyastar2d(occupied: np.ndarray) -> Plan:
    import pyastar2d as package

    weights = np.where(occupied, np.inf, 1.0).astype(np.float32)

    def plan(start: Cell, goal: Cell) -> float | None:
        path = package.astar_path(weights, start[::-1], goal[::-1], allow_diagonal=True)
        return None if path is None else length(path)

    return plan


def scikit_image(occupied: np.ndarray) -> Plan:
    from skimage.graph import route_through_array

    costs = np.where(occupied, -1.0, 1.0)

    def plan(start: Cell, goal: Cell) -> float | None:
        path, _ = route_through_array(costs, start[::-1], goal[::-1], fully_connected=True, geometric=True)
        return length(path)

    return plan


METHODS: list[tuple[str, str, Callable[[np.ndarray], Plan]]] = [
    ("keyway `jps`", "no", lambda occupied: keyway_planner(occupied, "jps")),
    ("keyway `astar`", "no", lambda occupied: keyway_planner(occupied, "astar")),
    ("keyway `prepared`", "no", lambda occupied: keyway_planner(occupied, "prepared")),
    ("pyastar2d", "yes", pyastar2d),
    ("scikit-image `route_through_array`", "yes", scikit_image),
    ("textbook A*, `heapq`", "no", textbook),
    ("pathfinding `AStarFinder`", "no", pathfinding),
]


def queries_on(occupied: np.ndarray, count: int) -> tuple[list[tuple[Cell, Cell]], list[float]]:
    """Random ones between connected cells, and what their shortest paths cost."""
    grid, free = keyway.Map.from_array(occupied, resolution=1.0), np.argwhere(~occupied)
    picked = np.random.default_rng(0).choice(len(free), (20 * count, 2))
    starts, goals = free[picked[:, 0], ::-1], free[picked[:, 1], ::-1]
    plans = keyway.plan_many(grid, starts + 0.5, goals + 0.5)
    found = [
        ((tuple(map(int, start)), tuple(map(int, goal))), plan.cost)
        for start, goal, plan in zip(starts, goals, plans, strict=True)
        if isinstance(plan, keyway.Plan) and plan.cost > 0
    ][:count]
    return [ends for ends, _ in found], [cost for _, cost in found]  # type: ignore[misc]


def measure_planning(name: str, occupied: np.ndarray, count: int, rounds: int, share_s: float) -> list[list[str]]:
    queries, optima = queries_on(occupied, count)
    planners: dict[str, Plan] = {}
    for title, _, make in METHODS:
        try:
            planners[title] = make(occupied)
        except ImportError:
            print(f"{title} is not installed")
    times: dict[str, list[float]] = {title: [math.inf] * len(queries) for title in planners}
    spent = dict.fromkeys(planners, 0.0)
    costs: dict[str, dict[int, float | None]] = {title: {} for title in planners}
    for _ in range(rounds):
        for title, plan in planners.items():
            for index, (start, goal) in enumerate(queries):
                if spent[title] > share_s:
                    break
                begin = time.perf_counter()
                cost = plan(start, goal)
                elapsed = time.perf_counter() - begin
                spent[title] += elapsed
                times[title][index] = min(times[title][index], elapsed)
                costs[title][index] = cost
    rows = []
    for title, cuts, _ in METHODS:
        if title not in planners:
            continue
        answered = [elapsed * 1e3 for elapsed in times[title] if elapsed < math.inf]
        off = [cost / optima[i] - 1 for i, cost in costs[title].items() if cost is not None]
        low, median, high = np.quantile(answered, [0.05, 0.5, 0.95])
        rows.append(
            [name, title, str(len(answered)), f"{short(median)} ({short(low)} to {short(high)})", f"{round(100 * statistics.mean(off), 2) + 0.0:.2f}", cuts]
        )
    return rows


def short(number: float) -> str:
    """In three digits."""
    return f"{number:.{max(0, 2 - math.floor(math.log10(number)))}f}"


def per_call(call: Callable[[], object], seconds: float = 0.5) -> str:
    """Microseconds of a call: the median of seven batches, and the fastest to the slowest."""
    count = 1
    while True:
        begin = time.perf_counter()
        for _ in range(count):
            call()
        if time.perf_counter() - begin > seconds / 7:
            break
        count *= 2
    batches = []
    for _ in range(7):
        begin = time.perf_counter()
        for _ in range(count):
            call()
        batches.append((time.perf_counter() - begin) / count)
    return spread([batch * 1e6 for batch in batches], 2)


def spread(values: list[float], digits: int) -> str:
    """The median, and the least to the largest."""
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"{middle:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def measure_overhead() -> list[list[str]]:
    """Calls for which the library has next to nothing to do: nearly all of their time is the way from Python and back."""
    grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    planner = keyway.Planner(grid)
    here = (5.5, 5.5)
    plan = planner.plan(here, (8.5, 5.5))
    plan.xy  # noqa: B018
    simulation = keyway.Simulation(keyway.Scene(grid, (3, 3), (17, 17)))
    return [
        ["`planner.plan(here, here)`", per_call(lambda: planner.plan(here, here))],
        ["`keyway.plan(grid, here, here)`", per_call(lambda: keyway.plan(grid, here, here))],
        ["`keyway.plan(...)` with radius, planner and smoother", per_call(lambda: keyway.plan(grid, here, here, radius=0.2, planner='jps', smoother='taut'))],
        ["`plan.xy`", per_call(lambda: plan.xy)],
        ["`simulation.pose`", per_call(lambda: simulation.pose)],
    ]


def steps_per_second(step: Callable[[], None], seconds: float) -> str:
    rates = []
    for _ in range(5):
        begin, count = time.perf_counter(), 0
        while time.perf_counter() - begin < seconds / 5:
            step()
            count += 1
        rates.append(count / (time.perf_counter() - begin))
    return spread(rates, 0)


def measure_environments(seconds: float) -> list[list[str]]:
    import keyway.gym

    occupied = np.zeros((200, 200), dtype=bool)
    occupied[60:140:20, 60:140:20] = True
    occupied[[0, -1], :] = occupied[:, [0, -1]] = True
    grid = keyway.Map.from_array(occupied, resolution=0.05)
    env = keyway.gym.Drive(keyway.Scene(grid, (1, 1), (9, 9)))
    env.reset(seed=0)
    env.action_space.seed(0)

    def drive() -> None:
        _, _, terminated, truncated, _ = env.step(env.action_space.sample())
        if terminated or truncated:
            env.reset()

    rows = [["keyway.gym.Drive", "360", steps_per_second(drive, seconds)]]
    try:
        rows.append(["ir-sim", "360", steps_per_second(ir_sim(), seconds)])
    except ImportError:
        print("ir-sim is not installed")
    return rows


def ir_sim() -> Callable[[], None]:
    """The same room in IR-SIM: a differential drive with a lidar of 360 beams among sixteen boxes, without a window."""
    import tempfile

    import irsim

    boxes = "\n".join(
        f"  - shape: {{name: rectangle, length: 0.05, width: 0.05}}\n    state: [{3.025 + x}, {3.025 + y}, 0]"
        for x in range(4)
        for y in range(4)
    )
    world = f"""
world: {{height: 10, width: 10, step_time: 0.1, sample_time: 0.1, collision_mode: stop}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.2}}
    state: [1, 1, 0]
    goal: [9, 9, 0]
    vel_max: [0.5, 1.5]
    vel_min: [0, -1.5]
    sensors:
      - {{name: lidar2d, range_min: 0, range_max: 3.5, angle_range: 6.283, number: 360, noise: False}}
obstacle:
{boxes}
"""
    file = pathlib.Path(tempfile.mkdtemp()) / "world.yaml"
    file.write_text(world)
    env = irsim.make(str(file), display=False, log_level="ERROR", disable_all_plot=True)
    numbers = np.random.default_rng(0)

    def drive() -> None:
        env.step(np.array([[numbers.uniform(0, 0.5)], [numbers.uniform(-1.5, 1.5)]]))
        env.get_lidar_scan()
        if env.done():
            env.reset()

    return drive


def table(header: list[str], rows: list[list[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="+", type=pathlib.Path, help="map files")
    parser.add_argument("--queries", type=int, default=50)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--share", type=float, default=60.0, help="seconds for each package on each map")
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    for path in args.maps:
        grid = keyway.Map.read(path)
        rows += measure_planning(path.stem, grid.occupied | grid.unknown, args.queries, args.rounds, args.share)
    header = ["map", "package", "queries", "ms (5 to 95 %)", "longer %", "cuts corners"]
    print(f"\n{table(header, rows)}\n")
    print(table(["call", "us (fastest to slowest)"], measure_overhead()), "\n")
    print(table(["environment", "beams", "steps/s (slowest to fastest)"], measure_environments(5.0)))


if __name__ == "__main__":
    main()

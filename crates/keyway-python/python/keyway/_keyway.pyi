"""
The compiled part of Keyway. Import `keyway` instead.
"""

from collections.abc import Sequence
from keyway.typing import LaserScans, Plans, Progress
from numpy import bool_, float64, int32, int8, void
from numpy.typing import NDArray
from os import PathLike
from pathlib import Path
from typing import Any, final

__all__ = ["Comparison", "Map", "Navigator", "Plan", "Planner", "Points", "Run", "Scan", "Scene", "Simulation", "Step", "batch", "compare", "merge", "names", "plan", "plan_many", "program", "simulate", "simulate_team"]

@final
class Comparison:
    """
    What a comparison gave: a row for each planner with each smoother.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.eye(30, dtype=bool)[::-1] & (np.arange(30) % 3 > 0), resolution=0.1)
    >>> comparison = keyway.compare(grid, planners=["jps", "theta-star"], smoothers=["none"], times=False)
    >>> comparison
    <keyway.Comparison 2 rows>
    >>> [row["planner"] for row in comparison.rows]
    ['jps', 'theta-star']
    """
    def __len__(self, /) -> int: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def report(self, /) -> dict[str, Any]:
        """
        The whole report, `keyway.compare/1` of `docs/reference/json.md`: also every query, and the tests of each row against the first.
        """
    @property
    def rows(self, /) -> list[dict[str, Any]]:
        """
        The rows as dictionaries, with the names of the columns of `table.csv` in `docs/reference/json.md`.
        """
    def to_latex(self, /) -> str:
        """
        The table as LaTeX, as a paper would print it.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
        >>> "tabular" in keyway.compare(grid, planners=["jps"], times=False).to_latex()
        True
        """
    def to_pandas(self, /) -> Any:
        """
        The rows as a `pandas.DataFrame`; pandas has to be installed.
        """

@final
class Map:
    """
    An occupancy grid: for every cell occupied, unknown or free.

    Row 0 of all arrays is the bottom row of the map, as in `nav_msgs/OccupancyGrid`. Lengths are in metres.

    >>> import keyway, numpy as np
    >>> occupied = np.zeros((40, 60), dtype=bool)
    >>> occupied[10:30, 25] = True
    >>> keyway.Map.from_array(occupied, resolution=0.1, origin=(-1, 0))
    <keyway.Map 60 x 40 cells of 0.1 m from (-1, 0), 20 occupied, 0 unknown>
    """
    def __reduce__(self, /) -> tuple[Any, tuple[NDArray[int8], tuple[int, int], float, tuple[float, float, float], str, tuple[float, list[float]] | None]]:
        """
        Maps can be copied, pickled, and sent to other processes.
        """
    def __repr__(self, /) -> str: ...
    def _repr_png_(self, /) -> bytes: ...
    def _repr_svg_(self, /) -> str: ...
    @staticmethod
    def _restored(values: NDArray[bool_] | NDArray[int8], thresholds: tuple[int, int], resolution: float, origin: tuple[float, float, float], name: str, placement: tuple[float, Sequence[float]] | None) -> Map: ...
    def cells(self, /, positions: Sequence[Sequence[float]] | NDArray[Any]) -> NDArray[int32]:
        """
        The cells (column, row) in which positions lie [m]: an array of int32 of shape (n, 2). A `ValueError` names the first
        position that is outside the map.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((4, 4), dtype=bool), resolution=0.5)
        >>> grid.cells([(0.1, 0.1), (1.9, 0.6)]).tolist()
        [[0, 0], [3, 1]]
        """
    @property
    def digest(self, /) -> str:
        """
        A number that identifies the map: equal maps have equal ones.
        """
    def free_positions(self, /) -> NDArray[float64]:
        """
        The centres of all free cells [m]: an array of float64 of shape (n, 2), row by row from the bottom.
        """
    @staticmethod
    def from_array(occupied: NDArray[bool_] | NDArray[int8], resolution: float, origin: Sequence[float] | NDArray[Any] | None = None, occupied_threshold: int = 65, free_threshold: int = 25) -> Map:
        """
        A map from an array of shape (rows, columns), row 0 at the bottom.

        `occupied` is an array of bool, or of int8 with the occupancy of each cell, 0 to 100, as in `nav_msgs`: from
        `occupied_threshold` on a cell is occupied, up to `free_threshold` it is free, and between the two, as below 0, it is
        unknown. That is the rule by which Nav2 saves maps. Values that are not all 0 and all below `free_threshold` are a
        `ValueError`: a mask is of bool. The array is read where it is, whatever its strides.

        `resolution` is the side of a cell [m]; `origin` is where the lower left corner lies [m], or with a yaw [m, m, rad].

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.array([[0, 65, 50, -1]], dtype=np.int8), resolution=0.5)
        >>> grid.occupied.tolist(), grid.unknown.tolist()
        ([[False, True, False, False]], [[False, False, True, True]])
        >>> keyway.Map.from_array(np.eye(2, dtype=np.int8), resolution=0.5)
        Traceback (most recent call last):
        ValueError: the largest occupancy is 1 of 100, so that every cell would be free: a mask of what is occupied must be of type bool
        """
    @property
    def occupancy(self, /) -> NDArray[int8]:
        """
        The map as in `nav_msgs`: a new array of int8, -1 unknown, 0 free, 100 occupied.
        """
    @property
    def occupied(self, /) -> NDArray[bool_]:
        """
        Which cells are occupied: a new array of bool of shape (rows, columns).
        """
    @property
    def origin(self, /) -> tuple[float, float, float]:
        """
        Pose of the lower left corner [m, m, rad].
        """
    @staticmethod
    def read(path: str | PathLike[str], resolution: float | None = None, origin: Sequence[float] | NDArray[Any] | None = None, max_cells: int | None = None) -> Map:
        """
        Reads a map file: ROS (`.yaml` with its image), MovingAI (`.map`), or an image (`.png`, `.pgm`).

        A YAML file says itself where its map lies. For other files `resolution` [m] and `origin` say so. What is usually a
        mistake in such a file is a `UserWarning`. A map of more than `max_cells` [2^29] is a `ValueError`,
        before memory is taken for it.

        >>> import keyway
        >>> keyway.Map.read("nowhere.yaml")
        Traceback (most recent call last):
        FileNotFoundError: cannot read nowhere.yaml: there is no such file or folder
        """
    @property
    def resolution(self, /) -> float:
        """
        Side of a cell [m].
        """
    @property
    def shape(self, /) -> tuple[int, int]:
        """
        Rows and columns.
        """
    @property
    def unknown(self, /) -> NDArray[bool_]:
        """
        Which cells are unknown: a new array of bool of shape (rows, columns).
        """
    def write(self, /, path: str | PathLike[str]) -> None:
        """
        Writes the map; the extension of the file names its format, as for `read`.

        >>> import keyway, numpy as np, pathlib, tempfile
        >>> grid = keyway.Map.from_array(np.eye(3, dtype=bool), resolution=1.0)
        >>> folder = pathlib.Path(tempfile.mkdtemp())
        >>> grid.write(folder / "eye.map")
        >>> keyway.Map.read(folder / "eye.map").digest == grid.digest
        True
        """

@final
class Navigator:
    """
    Drives a robot to goals: plans on the known map, remembers what scans show, and decides on a
    velocity in every cycle.

    `robot` and `stack` are names of `keyway.names`, or files; a robot may also be a dictionary with
    the fields of its file, such as `dict(like="jackal", limits=dict(v_max_mps=0.5))`, and is the
    `small` one unless given. `parameters` are laid over the stack, as a dictionary with the names
    of the TOML files. With `as_published` the stack has the values
    of its paper. With `safe` only commands are issued after which the robot can still stop before
    it touches anything, whatever the stack wants. `progress(done, expected)` is called while the
    layers of the map are made, which are not counted: (0, None).

    It has no goal at first. Goals come and go while the robot drives; what was sensed stays.

    Raises `ValueError` for a value that cannot be used.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    >>> navigator = keyway.Navigator(grid, robot="small", stack="keyway")
    >>> navigator.relocate((1, 1, 0))
    >>> navigator.set_goal((3, 1))
    >>> navigator
    <keyway.Navigator keyway: 2.000 m to go, 360 beams>
    """
    def __new__(cls, /, grid: Map, robot: str | PathLike[str] | dict[str, Any] | None = None, stack: str = "keyway", parameters: dict[str, Any] | None = None, as_published: bool = False, radius: float | None = None, safe: bool = False, progress: Progress | None = None) -> Navigator: ...
    def __reduce__(self, /) -> tuple[Any, tuple[bytes]]: ...
    def __repr__(self, /) -> str: ...
    def back_up(self, /, distance: float, allowance: float) -> None:
        """
        Drives straight back by a distance [m] in the same way.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.back_up(0.5, allowance=20)
        Traceback (most recent call last):
        ValueError: distance_m cannot be driven: the robot does not drive backwards (`v_min_mps`)
        """
    def cancel(self, /) -> None:
        """
        Gives up what it was asked to do: the robot brakes, and stands.
        """
    @property
    def clear_scan(self, /) -> Scan:
        """
        A scan of the robot's first sensor in which nothing was met.
        """
    @property
    def cycle(self, /) -> float:
        """
        Time between two commands [s].
        """
    @property
    def doubts(self, /) -> list[str]:
        """
        Contradictions in what was observed lately, for people, such as a velocity that is always 0
        although the pose moves.
        """
    def drive_on_heading(self, /, distance: float, allowance: float) -> None:
        """
        Drives straight ahead by a distance [m] in the same way.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.drive_on_heading(0.5, allowance=20)
        """
    def edit_map(self, /, window: Map) -> None:
        """
        Changes a part of the map to that of another one, cell by cell at the centres of the cells
        of `window`.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> wall = np.ones((2, 5), dtype=bool)
        >>> navigator.edit_map(keyway.Map.from_array(wall, resolution=0.1, origin=(2, 1)))
        >>> navigator.map
        <keyway.Map 40 x 40 cells of 0.1 m from (0, 0), 10 occupied, 0 unknown>
        """
    def follow(self, /, path: Sequence[Sequence[float]] | NDArray[Any]) -> None:
        """
        Drives along a path from elsewhere, an array of shape (n, 2) [m] that begins near the robot,
        to its end, as closely as along a route of its own. Where something is in the way, such a
        route to the end takes its place.

        Raises `NoRoom` where the map shows that the robot does not fit along it, and `ValueError`
        for what is no path. Then it goes on as before.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.follow([(1, 1), (1, 3), (3, 3)])
        >>> round(navigator.remaining, 3)
        4.0
        """
    def forget_sensed(self, /) -> None:
        """
        Forgets all that was sensed, standing and moving.
        """
    @property
    def goal(self, /) -> list[float] | None:
        """
        The goal (x, y) [m], or with a heading (x, y, heading) [m, m, rad]; `None` where there is
        none.
        """
    @property
    def guide_points(self, /) -> NDArray[float64]:
        """
        The points that the guide hands out along the route, its end last: a read-only array of
        float64 of shape (n, 2) [m].
        """
    def is_path_valid(self, /, path: Sequence[Sequence[float]] | NDArray[Any]) -> bool:
        """
        True if the robot fits along all of a path among what is known and sensed, turning on the
        spot at its corners.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.is_path_valid([(1, 1), (3, 1)]), navigator.is_path_valid([(1, 1), (9, 1)])
        (True, False)
        """
    @property
    def map(self, /) -> Map:
        """
        The map, as it was given and edited.
        """
    def nearest_reachable(self, /, start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any]) -> tuple[float, float] | None:
        """
        The place nearest to a goal that can be reached from a start, on what is known and sensed
        [m]; `None` where nothing can be reached.

        >>> import keyway, numpy as np
        >>> walls = np.zeros((40, 40), dtype=bool)
        >>> walls[:, 20] = True
        >>> navigator = keyway.Navigator(keyway.Map.from_array(walls, resolution=0.1))
        >>> navigator.nearest_reachable((1, 1), (3, 1))[0] < 2
        True
        """
    def note_override(self, /, now: float, command: Sequence[float] | NDArray[Any]) -> None:
        """
        Notes that the robot was given a command (v, omega) [m/s, rad/s] of somebody else in the
        place of the last step's, at a time by the clock of the stamps [s]: of a person with a
        joystick, or of a safety controller. To be called whenever such a command is given.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.note_override(0.1, (0, 0))
        """
    @property
    def notice(self, /) -> str | None:
        """
        That the robot was nearer to something than it can stand when it got its goal, until it has
        left it, for people; otherwise `None`.
        """
    def observe(self, /, stamp: float, pose: Sequence[float] | NDArray[Any], velocity: Sequence[float] | NDArray[Any], scan: LaserScans | None = None, points: Points | Sequence[Points] | None = None) -> None:
        """
        Takes in what was measured: at a time [s], where the robot is (x, y, theta) [m, m, rad], how
        it moves (v, omega) [m/s, rad/s], and what its sensors see. Stamps are by any clock, the
        same for all. They say when something was measured, not when it arrived.

        `scan` is a `keyway.Scan`, which says where each beam looks: `Simulation.scan`, or
        `keyway.Scan(ranges, angle_min, angle_increment)`. A message of ROS,
        `sensor_msgs/LaserScan`, is taken as it is, with the stamp of its header. A scan without a
        stamp was made when the pose was measured. A robot with several sensors gives a list with
        one scan of each, in their order, `None` where a sensor has made none. Without `scan` none
        has arrived. `points` are those of other sensors: a `keyway.Points`, or a list of them.

        An observation that cannot be true, or is older than the last one, is not taken in; the next
        `step` then stops the robot and says why.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> scan = keyway.Scan(np.full(360, np.inf), angle_min=-np.pi, angle_increment=np.pi / 180)
        >>> navigator.observe(12.5, (1, 1, 0), (0.2, 0), scan)
        >>> navigator.set_goal((3, 1))
        >>> step = navigator.step()
        >>> step.v > 0.2, step.status
        (True, 'drive')
        """
    def plan(self, /, start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any]) -> NDArray[float64]:
        """
        A route between two positions on what is known and sensed: a read-only array of float64 of
        shape (n, 2) [m]. Nothing changes by it. An error where the robot touches something at the
        start.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.plan((1, 1), (3, 1)).tolist()
        [[1.0, 1.0], [3.0, 1.0]]
        """
    def recoveries(self, /) -> dict[str, Any]:
        """
        Counts of what was tried because the robot got no farther, by kind.
        """
    def relocate(self, /, pose: Sequence[float] | NDArray[Any]) -> None:
        """
        Tells it where the robot is (x, y, theta) [m, m, rad]: before the first observation, or when
        the localisation has been corrected.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        """
    @property
    def remaining(self, /) -> float | None:
        """
        Remaining length of the way [m]; `None` without a goal.
        """
    def restart_clock(self, /) -> None:
        """
        The clock of all stamps begins anew: the next observation may have any stamp.
        """
    @staticmethod
    def restore(snapshot: bytes) -> Navigator:
        """
        The navigator of a snapshot.

        Raises `ValueError` for bytes that are none, or of another version of Keyway.

        >>> import keyway
        >>> keyway.Navigator.restore(b"nonsense")
        Traceback (most recent call last):
        ValueError: snapshot: ...
        """
    @property
    def route(self, /) -> NDArray[float64]:
        """
        The route being followed: a read-only array of float64 of shape (n, 2) [m]; empty without a
        goal.
        """
    @property
    def routes_planned(self, /) -> int:
        """
        Number of searches for a route: at first for each goal, when a scan showed something on it,
        at way-points, after waits, and in recoveries.
        """
    def set_goal(self, /, goal: Sequence[float] | NDArray[Any], progress: Progress | None = None) -> None:
        """
        Drives to a goal from now on, in the place of the last one: a position [m], or with a
        heading [m, m, rad].

        The robot may drive on in another thread while the route is searched. `progress(done,
        expected)` is called meanwhile; nothing is counted: (0, None).

        Raises `NoRoom` where the robot does not fit where it is or at the goal, `NoPath` where no
        way leads there, and `ValueError` where nobody has said where the robot is. Then it goes on
        as before.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.set_goal((3, 1))
        >>> navigator.goal
        [3.0, 1.0]
        """
    def set_goals(self, /, via: Sequence[Sequence[float]] | NDArray[Any], goal: Sequence[float] | NDArray[Any], progress: Progress | None = None) -> None:
        """
        The same by way of some positions, in their order [m].

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.set_goals([(3, 1)], (3, 3))
        >>> round(navigator.remaining, 3)
        4.0
        """
    def set_map(self, /, grid: Map) -> None:
        """
        Drives on another map from now on: one that has grown, or whose origin has moved. What was
        sensed keeps its place in the world.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> free = np.zeros((80, 80), dtype=bool)
        >>> navigator.set_map(keyway.Map.from_array(free, resolution=0.1, origin=(-2, -2)))
        >>> navigator.set_goal((-1, -1))
        """
    def set_masks(self, /, keep_out: Map | None = None, slow: tuple[Map, float] | None = None) -> None:
        """
        Keeps out of the occupied cells of one map, and drives no faster than a speed [m/s] on those
        of another one, in the place of what was given before. Their frames need not be that of the
        navigator's map.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> zone = keyway.Map.from_array(np.ones((1, 1), dtype=bool), resolution=1.0, origin=(2, 2))
        >>> navigator.set_masks(keep_out=zone)
        """
    def set_speed_limit(self, /, speed: float | None = None) -> None:
        """
        Drives no faster than this from now on [m/s]; `None`: as fast as the robot can.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.set_speed_limit(0.2)
        """
    def smooth(self, /, path: Sequence[Sequence[float]] | NDArray[Any]) -> NDArray[float64]:
        """
        A line of positions, smoothed as its routes are, with the same clearance among what is known
        and sensed where it is clear: a read-only array of float64 of shape (n, 2) [m].

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.smooth([(1, 1), (2, 1.5), (3, 1)]).tolist()
        [[1.0, 1.0], [3.0, 1.0]]
        """
    def snapshot(self, /) -> bytes:
        """
        All that it knows, wants and does, as bytes: `Navigator.restore` makes the same navigator of
        them, which gives the same steps from here on. Navigators are copied and pickled so.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.set_goal((3, 1))
        >>> keyway.Navigator.restore(navigator.snapshot())
        <keyway.Navigator keyway: 2.000 m to go, 360 beams>
        """
    def spin(self, /, angle: float, allowance: float) -> None:
        """
        Turns on the spot by an angle [rad], positive to the left, within a time [s]. The robot
        brakes first, and has arrived when it stands again. Nothing is touched: where there is no
        room it waits, until its time is over.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.spin(1.5, allowance=20)
        """
    def step(self, /) -> Step:
        """
        One control cycle: what the robot is to do, from what was observed. It counts for the time
        that has passed by the stamps since the last step; the first one for a cycle of the robot.
        """

@final
class Plan:
    """
    A planned and smoothed path.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
    >>> keyway.plan(grid, (0.5, 0.5), (3.5, 6.5))
    <keyway.Plan jps with none: 7.243 m, 3 points, 7 cells, 1 expanded>
    """
    def __len__(self, /) -> int: ...
    def __repr__(self, /) -> str: ...
    def _repr_png_(self, /) -> bytes: ...
    def _repr_svg_(self, /) -> str: ...
    @property
    def cells(self, /) -> NDArray[int32]:
        """
        The planner's path, before smoothing: a read-only array of int32 of shape (n, 2), column and row of each cell.
        """
    @property
    def cost(self, /) -> float:
        """
        Cost of the planner's path [cells]: for the planners of the grid an exact number of straight and diagonal steps.
        """
    def curve(self, /, spacing: float = 0.05, robot: str | PathLike[str] | dict[str, Any] | None = None) -> NDArray[void]:
        """
        The smoothed path by arc length, with the fastest way to drive along it within the limits of a robot (`keyway.names`,
        a file, or a dictionary of its values).

        A structured array of shape (n,) with the fields `s_m`, `x_m`, `y_m`, `heading_rad`, `curvature_per_m`, `t_s`, `v_mps`
        and `omega_radps`, all float64. At a corner the robot stops and turns on the spot.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
        >>> curve = keyway.plan(grid, (0.5, 0.5), (4.5, 0.5)).curve(spacing=1.0)
        >>> curve["s_m"].tolist()
        [0.0, 1.0, 2.0, 3.0, 4.0]
        """
    @property
    def expanded(self, /) -> int:
        """
        Nodes taken from the open list.
        """
    @property
    def generated(self, /) -> int:
        """
        Nodes put into the open list, or improved there.
        """
    @property
    def jump_points(self, /) -> list[int]:
        """
        Which of the cells are jump points, as ascending indices.
        """
    @property
    def length(self, /) -> float:
        """
        Length of the smoothed path [m].
        """
    def metrics(self, /) -> dict[str, Any]:
        """
        Measures of the smoothed path: `length_m`, `points`, `redundant_points`, `turns`, `turning_angle_deg`, `non_smooth_turns`
        and `min_clearance_m`. They are worked out at every call.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
        >>> keyway.plan(grid, (0.5, 0.5), (3.5, 6.5)).metrics()["turns"]
        1
        """
    @property
    def planner(self, /) -> str:
        """
        Name of the planner.
        """
    @property
    def shortfall(self, /) -> float | None:
        """
        The distance that the path certainly keeps [m], where that is less than was asked for; otherwise `None`.
        """
    @property
    def smoother(self, /) -> str:
        """
        Name of the smoother.
        """
    @property
    def xy(self, /) -> NDArray[float64]:
        """
        The smoothed path as a line: a read-only array of float64 of shape (n, 2) [m]. Of a curve, chords along it.
        """

@final
class Planner:
    """
    Plans many paths on one map: its layers, its planner and its smoother are made once.

    The arguments are those of `keyway.plan`. `progress(done, expected)` is called meanwhile: the planner `prepared` counts twice
    the cells at which paths may turn; `expected` is `None` for the others, which make a map's layers only.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((50, 50), dtype=bool), resolution=0.1)
    >>> planner = keyway.Planner(grid, radius=0.2, planner="theta-star")
    >>> planner.plan((0.55, 0.55), (4.55, 0.55)).length
    4.0
    """
    def __new__(cls, /, grid: Map, radius: float | None = None, planner: str = "jps", smoother: str = "none", robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, progress: Progress | None = None) -> Planner: ...
    def __repr__(self, /) -> str: ...
    def plan(self, /, start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any], budget: int | None = None, nearest_reachable: bool = False, progress: Progress | None = None) -> Plan:
        """
        Plans a path between two positions [m]; see `keyway.plan`.

        >>> import keyway, numpy as np
        >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
        >>> planner.plan((0.5, 0.5), (8.5, 4.5)).cost == 4 + 4 * 2 ** 0.5
        True
        """
    def plan_many(self, /, starts: Sequence[Sequence[float]] | NDArray[Any], goals: Sequence[Sequence[float]] | NDArray[Any], jobs: int | None = None, progress: Progress | None = None) -> Plans:
        """
        Plans many paths on all cores; see `keyway.plan_many`.

        >>> import keyway, numpy as np
        >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
        >>> [plan.cost for plan in planner.plan_many([(0.5, 0.5), (1.5, 1.5)], [(8.5, 0.5), (1.5, 4.5)])]
        [8.0, 3.0]
        """
    def plan_nearest(self, /, start: Sequence[float] | NDArray[Any], goals: Sequence[Sequence[float]] | NDArray[Any], budget: int | None = None, progress: Progress | None = None) -> tuple[int, Plan]:
        """
        Plans a path to the nearest of several goals, by the cost of its path: `goals` are an array of shape (n, 2) [m]. Gives
        the index of that goal, and the plan. Raises what `keyway.plan` does where no path leads to any of them.

        >>> import keyway, numpy as np
        >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
        >>> index, plan = planner.plan_nearest((0.5, 0.5), [(8.5, 8.5), (0.5, 3.5), (5.5, 0.5)])
        >>> index, plan.cost
        (1, 3.0)
        """

@final
class Points:
    """
    Places at which a depth camera, a sonar or a bumper has met something, as points on the ground.

    `positions` is an array of shape (n, 2), in the frame of the sensor [m]; points that are not
    finite say nothing. `mount` is the pose of the sensor on the robot (x, y, theta) [m, m, rad].
    Robots with several such sensors number them by `sensor`, from 0 to 7. `stamp` is the time at
    which they were measured [s]; without one it is that of the pose with which they are given.

    They mark obstacles, which stay until the same sensor says that it sees nothing there. It does
    where it has `bearings`, those of its right and left edge [rad] (0 where it looks, positive to
    the left), and `ranges`, the nearest and the farthest at which it sees [m]: within these
    everything that stands, unless something hides it.

    >>> import keyway
    >>> keyway.Points([(1.0, 0.2), (1.0, 0.3)], bearings=(-0.7, 0.7), ranges=(0.3, 3.0))
    <keyway.Points 2 of sensor 0, which sees from 0.3 to 3 m>
    >>> keyway.Points([(0.2, 0.0)], sensor=1)
    <keyway.Points 1 of sensor 1, which only marks>
    """
    def __len__(self, /) -> int: ...
    def __new__(cls, /, positions: Sequence[Sequence[float]] | NDArray[Any], mount: Sequence[float] | NDArray[Any] | None = None, sensor: int = 0, stamp: float | None = None, bearings: tuple[float, float] | None = None, ranges: tuple[float, float] | None = None) -> Points: ...
    def __repr__(self, /) -> str: ...

@final
class Run:
    """
    A simulated run, and what was measured of it.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> run = keyway.simulate(keyway.Scene(grid, (1, 2), (4, 2)))
    >>> run
    <keyway.Run reached: 2.980 m in 7.1 s>
    """
    def __repr__(self, /) -> str: ...
    def _repr_png_(self, /) -> bytes: ...
    def _repr_svg_(self, /) -> str: ...
    @property
    def metrics(self, /) -> dict[str, Any]:
        """
        What was measured, with the names of `run` in `docs/reference/json.md`: `time_s`, `length_m`, `min_clearance_m` and more. Without a
        route it is empty.
        """
    @property
    def outcome(self, /) -> str:
        """
        How it ended: `reached`, `collided`, `timeout`, `stuck` or `no_path`.
        """
    @property
    def reason(self, /) -> str | None:
        """
        Why the goal was not reached, for people; otherwise `None`.
        """
    @property
    def report(self, /) -> dict[str, Any]:
        """
        The whole report, `keyway.navigate/4` of `docs/reference/json.md`.
        """
    @property
    def route(self, /) -> NDArray[float64]:
        """
        The first route after smoothing: a read-only array of float64 of shape (n, 2) [m]; of a curve, chords along it. Without a
        route it is empty.
        """
    @property
    def trajectory(self, /) -> NDArray[void]:
        """
        The start, the end of every cycle, and the contact if there was one: a structured array of shape (n,) with the fields
        `t_s`, `x_m`, `y_m`, `yaw_rad`, `v_mps` and `omega_radps`, all float64. Without a route it is empty.
        """

@final
class Scan:
    """
    One turn of a range sensor, with the names and the meaning of `sensor_msgs/LaserScan`.

    `ranges` are those of all beams [m]: infinity means that nothing was met, and NaN or 0 that the
    beam says nothing. Beam i looks at the bearing `angle_min + i * angle_increment` [rad], 0
    straight ahead and positive to the left: where the beams go clockwise, `angle_increment` is
    negative. Sensors begin at the back, ahead or at a side; so neither angle has a default. `stamp`
    is the time at which it was made [s]; without one it belongs to the pose with which it is given.

    >>> import keyway, numpy as np
    >>> scan = keyway.Scan(np.full(360, np.inf), angle_min=0.0, angle_increment=np.pi / 180)
    >>> scan, round(float(scan.bearings[90]), 3)
    (<keyway.Scan 360 beams from 0.000 to 6.266 rad>, 1.571)
    """
    def __len__(self, /) -> int: ...
    def __new__(cls, /, ranges: Sequence[float] | NDArray[Any], angle_min: float, angle_increment: float, stamp: float | None = None) -> Scan: ...
    def __repr__(self, /) -> str: ...
    @property
    def angle_increment(self, /) -> float:
        """
        Bearing from one beam to the next [rad], negative where they go clockwise.
        """
    @property
    def angle_min(self, /) -> float:
        """
        Bearing of beam 0 [rad], 0 straight ahead, positive to the left.
        """
    @property
    def bearings(self, /) -> NDArray[float64]:
        """
        Bearings of all beams: a new array of float64 [rad].
        """
    @property
    def ranges(self, /) -> NDArray[float64]:
        """
        Ranges of all beams: a new array of float64 [m].
        """
    @property
    def stamp(self, /) -> float | None:
        """
        Time at which it was made [s]; `None` where it was not said.
        """

@final
class Scene:
    """
    A run to be made: map, robot, start, goal, and what stands or moves in the world but is not on the map.

    On a map in memory the arguments are those of a scene file, with the same names: `robot`, `stack`, `safe`, `via`, `seed`, `unknown`,
    `moving`, `random`, `rules`, `disturbances`. `start` and `goal` are positions [m], or with a heading [m, m, rad]; in a scene
    file the heading is in degrees. `Scene.read` reads a scene file.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> keyway.Scene(grid, start=(1, 2), goal=(7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])
    <keyway.Scene small with keyway, 1 unknown, 0 moving, seed 0>
    """
    def __new__(cls, /, grid: Map, start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any], **fields: "object") -> Scene: ...
    def __reduce__(self, /) -> tuple[Any, tuple[str, Path, Map | None]]:
        """
        Scenes can be copied, pickled, and sent to other processes.
        """
    def __repr__(self, /) -> str: ...
    @staticmethod
    def _restored(text: str, folder: str | PathLike[str], map: Map | None) -> Scene: ...
    @staticmethod
    def from_toml(text: str, folder: str | PathLike[str] | None = None) -> Scene:
        """
        A scene from the text of a file; the files that it names are found from `folder`.

        >>> import keyway
        >>> keyway.Scene.from_toml("version = 2")
        Traceback (most recent call last):
        ValueError: a scene has either a `map` or a `[world]`, got neither
        """
    @property
    def is_random(self, /) -> bool:
        """
        True if another seed gives another run.
        """
    @staticmethod
    def read(path: str | PathLike[str]) -> Scene:
        """
        Reads a scene file. The files that it names are found from its folder.

        >>> import keyway
        >>> keyway.Scene.read("nowhere.toml")
        Traceback (most recent call last):
        FileNotFoundError: cannot read nowhere.toml: there is no such file or folder
        """
    def replace(self, /, seed: int | None = None, robot: str | PathLike[str] | dict[str, Any] | None = None, stack: str | None = None, safe: bool | None = None) -> Scene:
        """
        The same scene with another seed, robot or stack, with the stop rule or without it.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> keyway.Scene(grid, (1, 2), (7, 2)).replace(seed=3, stack="s1-adaptive")
        <keyway.Scene small with s1-adaptive, 0 unknown, 0 moving, seed 3>
        """
    @property
    def robot(self, /) -> str:
        """
        Name of the robot.
        """
    @property
    def seed(self, /) -> int:
        """
        Of all that is random.
        """
    @property
    def stack(self, /) -> str:
        """
        Name of the stack.
        """
    def to_toml(self, /) -> str:
        """
        The text of its file. A map in memory is called `array` there.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> keyway.Scene(grid, (1, 2), (7, 2)).to_toml().splitlines()[0]
        'version = 2'
        """

@final
class Simulation:
    """
    The world of a scene, in which somebody else drives: one control cycle per call, as learning
    agents want it.

    The goal is reached when the robot comes within its tolerance; it need not stand. The stack of
    the scene plans the first route, by which the robot's heading at the start and the time limit
    are chosen, and drives nothing. `progress(done, expected)` is called meanwhile, which is not
    counted: (0, None).

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> simulation = keyway.Simulation(keyway.Scene(grid, (1, 2), (7, 2)))
    >>> while simulation.outcome is None:
    ...     outcome = simulation.step(0.5, 0.0)
    >>> simulation.outcome
    'reached'
    """
    def __new__(cls, /, scene: Scene, progress: Progress | None = None) -> Simulation: ...
    def __repr__(self, /) -> str: ...
    @property
    def cycle(self, /) -> float:
        """
        Time of a step [s].
        """
    @property
    def goal(self, /) -> tuple[float, float]:
        """
        Where the robot is to go (x, y) [m].
        """
    @property
    def limits(self, /) -> tuple[tuple[float, float], tuple[float, float]]:
        """
        The lowest and the highest velocity that the robot can drive: (v, omega) of each [m/s,
        rad/s].
        """
    @property
    def outcome(self, /) -> str | None:
        """
        How the run has ended, `reached`, `collided`, `timeout` or `stuck`; `None` while it goes on.
        """
    @property
    def pose(self, /) -> tuple[float, float, float]:
        """
        Where the robot takes itself to be (x, y, theta) [m, m, rad].
        """
    @property
    def range(self, /) -> float:
        """
        Range of the sensor [m]; of several the longest.
        """
    @property
    def scan(self, /) -> Scan:
        """
        The present scan of the first sensor: ranges, and where their beams look.
        `Navigator.observe` takes it as it is for a robot with a single sensor.
        """
    @property
    def scans(self, /) -> list[Scan | None]:
        """
        The present scans of all sensors, in their order; `None` where a sensor has made none in
        this cycle. `Navigator.observe` takes them as they are.
        """
    @property
    def stamp(self, /) -> float:
        """
        Time at which `pose` and `velocity` were measured [s].
        """
    def step(self, /, v: float, omega: float, remaining: float | None = None) -> str | None:
        """
        One control cycle: the robot drives towards the velocity (v, omega) [m/s, rad/s], as far as
        its limits allow. Gives the outcome once the run has ended, and `None` before; a run that
        has ended stays as it is.

        `remaining` is the way that is left [m], by which the robot counts as stuck; without it, the
        straight line to the goal.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> simulation = keyway.Simulation(keyway.Scene(grid, (1, 2, 0), (7, 2)))
        >>> simulation.step(0.5, 0.0) is None, round(simulation.velocity[0], 3)
        (True, 0.05)
        """
    @property
    def velocity(self, /) -> tuple[float, float]:
        """
        How the robot takes itself to move (v, omega) [m/s, rad/s].
        """

@final
class Step:
    """
    Command until the next cycle, and its reason.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    >>> navigator = keyway.Navigator(grid)
    >>> navigator.observe(0.0, pose=(1, 1, 0), velocity=(0, 0), scan=navigator.clear_scan)
    >>> navigator.set_goal((3, 1))
    >>> navigator.step()
    <keyway.Step drive: 0.050 m/s, 0.000 rad/s>
    """
    def __repr__(self, /) -> str: ...
    @property
    def kind(self, /) -> int | None:
        """
        The kind of that as a number, which never changes, for programs; otherwise `None`.
        """
    @property
    def notice(self, /) -> str | None:
        """
        A notice for people: the robot began nearer to something than it can stand, and is leaving
        it. Otherwise `None`.
        """
    @property
    def omega(self, /) -> float:
        """
        Turn rate, positive to the left [rad/s].
        """
    @property
    def status(self, /) -> str:
        """
        `drive`, `blocked` (there is no good way on at the moment; the command is safe), `arrived`,
        or `idle` (there is no goal).
        """
    @property
    def v(self, /) -> float:
        """
        Forward speed [m/s].
        """
    @property
    def why(self, /) -> str | None:
        """
        The reason why the robot is blocked, for people; otherwise `None`.
        """

def batch(scenes: Sequence[str | PathLike[str]], out: str | PathLike[str], stacks: Sequence[str] | None = None, seeds: int = 1, jobs: int | None = None, shard: tuple[int, int] | None = None, keep: str | None = None, robot: str | PathLike[str] | dict[str, Any] | None = None, disturbances: str | PathLike[str] | None = None, reached_by: str | None = None, safe: bool = False, parameters: dict[str, Any] | None = None, progress: Progress | None = None) -> dict[str, Any]:
    """
    Drives scenes with stacks and seeds, as `keyway batch` does, and writes the same files, byte
    for byte, into the folder `out`.

    `scenes` are scene files, and folders of them. `stacks` are names or files, or `["all"]`.
    `seeds` is the number of seeds with which each scene is driven. `shard=(i, n)` makes only the
    i-th of n parts; `keyway.merge` puts parts together. `jobs` is the number of threads. `keep`
    chooses the runs whose full records are stored: `"none"`, `"failures"` or `"all"`. `robot` and
    `disturbances` are names or files. `reached_by` is the pose by which a goal is reached,
    `"truth"` or `"belief"`. With `safe` the stop rule stands behind every stack. `parameters` are
    laid over every stack, those of `robot` in them over every robot. Runs that the folder holds are
    not made again, so a batch that was stopped goes on where it was. `progress(done, expected)` is
    called meanwhile.

    Gives the report `keyway.batch/1` of `docs/reference/json.md`.

    >>> import keyway
    >>> keyway.batch(["nowhere.toml"], out="unused")
    Traceback (most recent call last):
    ValueError: cannot read nowhere.toml: there is no such file or folder
    """

def compare(grid: Map, planners: Sequence[str] | None = None, smoothers: Sequence[str] | None = None, queries: int = 10, seed: int = 0, repeat: int = 1, radius: float | None = None, robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, columns: Sequence[str] | None = None, times: bool = True, progress: Progress | None = None) -> Comparison:
    """
    Compares the paths of planners and smoothers on a map, with each other and with the shortest line, as `keyway compare`
    does.

    `planners` and `smoothers` are lists of names, or `["all"]`. `queries` random queries are made from `seed`. `radius` is what
    paths keep from every obstacle [m], `robot` a robot whose radius they keep. `parameters` are those of the TOML files as a
    dictionary; by their names, of one planner or smoother only: `{"hsta": {"if_no_path": "fail"}}`.
    With `as_published` they begin with the values of their papers, for maps with cells of 1 m,
    whatever the robot. Without `times`, the same arguments give the same report.
    `progress(done, expected)` is called meanwhile.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    >>> keyway.compare(grid, planners=["jps", "jsp"])
    Traceback (most recent call last):
    ValueError: planners: `planner.name` must be one of ...
    """

def merge(parts: Sequence[str | PathLike[str]], out: str | PathLike[str]) -> dict[str, Any]:
    """
    Puts together what `keyway.batch` has made in other folders, such as the parts of one batch.
    Nothing is driven.

    >>> import keyway
    >>> keyway.merge([], out="unused")
    Traceback (most recent call last):
    ValueError: parts: expected at least one folder
    """

def names(kind: str) -> list[str]:
    """
    Names of what there is: of `planners`, `smoothers`, `guides`, `local-planners`, `stacks` or `robots`. `keyway list NAME`, a
    command of the program, says what each of them is and what parameters it has.

    >>> import keyway
    >>> keyway.names("robots")[:3]
    ['small', 'jackal', 'paper']
    """

def plan(grid: Map, start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any], radius: float | None = None, planner: str = "jps", smoother: str = "none", robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, budget: int | None = None, nearest_reachable: bool = False, progress: Progress | None = None) -> Plan:
    """
    Plans a path on a map, from one position to another [m], and smooths it.

    `planner` and `smoother` are names of `keyway.names`; `radius` is what the path keeps from every obstacle [m], `robot` a
    robot whose inscribed radius it keeps instead. `parameters` are those of the TOML files, as a dictionary:
    `{"planner": {"corners": "allow"}, "map": {"unknown": "free"}}`. With `as_published`, planner
    and smoother begin with the values of their papers, for maps with cells of 1 m, whatever the
    robot. `budget` limits the expanded nodes; with `nearest_reachable` the path ends in the cell
    nearest to the goal that can be reached.

    What a map needs for a choice of parameters is kept with the map, so a second call is fast.

    `progress(done, expected)` is called meanwhile. What a `keyway.Planner` prepares is counted; a search is not, as nobody knows
    how far it has to go: (0, None).

    Raises `NoPath` where no path joins the two and says what parts them, `NoRoom` where one of them is blocked or outside the
    map, `Missed` where the planner finds none although there is one, `BudgetExhausted`, and `ValueError` for a parameter that
    cannot be used.

    >>> import keyway, numpy as np
    >>> occupied = np.zeros((60, 100), dtype=bool)
    >>> occupied[:50, 50] = True
    >>> grid = keyway.Map.from_array(occupied, resolution=0.1)
    >>> plan = keyway.plan(grid, start=(1, 1), goal=(9, 4), radius=0.2, smoother="taut")
    >>> plan.xy[0].tolist(), plan.xy[-1].tolist()
    ([1.0, 1.0], [9.0, 4.0])
    >>> round(plan.length, 2)
    10.0
    """

def plan_many(grid: Map, starts: Sequence[Sequence[float]] | NDArray[Any], goals: Sequence[Sequence[float]] | NDArray[Any], radius: float | None = None, planner: str = "jps", smoother: str = "none", robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, jobs: int | None = None, progress: Progress | None = None) -> Plans:
    """
    Plans many paths on all cores: from `starts` to `goals`, arrays of shape (n, 2) [m].

    The other arguments are those of `keyway.plan`; `jobs` is the number of threads. Gives a list with a plan for each query, in
    their order; where there is none, the exception that says why is in its place. `progress(done, expected)` is called meanwhile.

    >>> import keyway, numpy as np
    >>> occupied = np.zeros((5, 5), dtype=bool)
    >>> occupied[4, 4] = True
    >>> grid = keyway.Map.from_array(occupied, resolution=1.0)
    >>> first, second = keyway.plan_many(grid, [(0.5, 0.5), (0.5, 0.5)], [(3.5, 0.5), (4.5, 4.5)])
    >>> first.cost, type(second).__name__
    (3.0, 'NoRoom')
    """

def program(words: Sequence[str]) -> int:
    """
    The program `keyway` with these words of a command line; gives its exit code.

    >>> import keyway
    >>> keyway.program(["map", "info", "nowhere.map", "--format", "xml"])
    2
    """

def simulate(scene: Scene, progress: Progress | None = None, times: bool = False) -> Run:
    """
    Makes the run that a scene describes. The same scene gives the same run, to the last digit.

    Start without a route, collision and timeout are outcomes and no exceptions. `progress(cycles, None)` is called meanwhile.
    With `times` the times of decisions are measured; then two reports differ in them.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> scene = keyway.Scene(grid, (1, 2), (7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])
    >>> run = keyway.simulate(scene)
    >>> run.outcome, run.metrics["min_clearance_m"] > 0
    ('reached', True)
    """

def simulate_team(scene: Scene, progress: Progress | None = None) -> list[Run]:
    """
    Makes the runs of all robots of a scene, which drive in one world at the same time: a run for each, in their order.

    >>> import keyway, numpy as np
    >>> text = '''
    ... version = 2
    ... map = "empty.map"
    ... [[robots]]
    ... start = [1.0, 1.0]
    ... goal = [7.0, 1.0]
    ... [[robots]]
    ... start = [7.0, 4.0]
    ... goal = [1.0, 4.0]
    ... '''
    >>> import tempfile
    >>> folder = tempfile.mkdtemp()
    >>> keyway.Map.from_array(np.zeros((5, 8), dtype=bool), resolution=1.0).write(folder + "/empty.map")
    >>> [run.outcome for run in keyway.simulate_team(keyway.Scene.from_toml(text, folder))]
    ['reached', 'reached']
    """

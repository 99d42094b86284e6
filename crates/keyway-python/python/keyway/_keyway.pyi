"""
The compiled part of Keyway. Import `keyway` instead.
"""

from collections.abc import Mapping, Sequence
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
    Result of a comparison: a row for each combination of planner and smoother.

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
        The whole report: `keyway.compare/1` of `docs/reference/json.md`. It also has every query,
        and the tests of each row against the first.
        """
    @property
    def rows(self, /) -> list[dict[str, Any]]:
        """
        The rows as dictionaries. Their keys are the columns of `table.csv`.
        """
    def to_latex(self, /) -> str:
        """
        The table as LaTeX, for use in a paper.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
        >>> "tabular" in keyway.compare(grid, planners=["jps"], times=False).to_latex()
        True
        """
    def to_pandas(self, /) -> Any:
        """
        The rows as a `pandas.DataFrame`; requires pandas.
        """

@final
class Map:
    """
    An occupancy grid: every cell is occupied, unknown or free.

    Row 0 of all arrays is the bottom row of the map, as in `nav_msgs/OccupancyGrid`. Lengths are
    in metres.

    >>> import keyway, numpy as np
    >>> occupied = np.zeros((40, 60), dtype=bool)
    >>> occupied[10:30, 25] = True
    >>> keyway.Map.from_array(occupied, resolution=0.1, origin=(-1, 0))
    <keyway.Map 60 x 40 cells of 0.1 m from (-1, 0), 20 occupied, 0 unknown>
    """
    def __reduce__(self, /) -> tuple[Any, tuple[NDArray[int8], tuple[int, int], float, tuple[float, float, float], str, tuple[float, list[float]] | None]]:
        """
        Supports copying, pickling and sending maps to other processes.
        """
    def __repr__(self, /) -> str: ...
    def _repr_png_(self, /) -> bytes: ...
    def _repr_svg_(self, /) -> str: ...
    @staticmethod
    def _restored(values: NDArray[bool_] | NDArray[int8], thresholds: tuple[int, int], resolution: float, origin: tuple[float, float, float], name: str, placement: tuple[float, Sequence[float]] | None) -> Map: ...
    def cells(self, /, positions: Sequence[Sequence[float]] | NDArray[Any]) -> NDArray[int32]:
        """
        Returns the cells (column, row) of positions [m]: an array of int32 of shape (n, 2).
        Raises a `ValueError` that names the first position outside the map.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((4, 4), dtype=bool), resolution=0.5)
        >>> grid.cells([(0.1, 0.1), (1.9, 0.6)]).tolist()
        [[0, 0], [3, 1]]
        """
    @property
    def digest(self, /) -> str:
        """
        Identifier of the map's content: equal maps have equal digests.
        """
    def free_positions(self, /) -> NDArray[float64]:
        """
        Returns the centres of all free cells [m]: an array of float64 of shape (n, 2), row by row
        from the bottom.
        """
    @staticmethod
    def from_array(occupied: NDArray[bool_] | NDArray[int8], resolution: float, origin: Sequence[float] | NDArray[Any] | None = None, occupied_threshold: int = 65, free_threshold: int = 25) -> Map:
        """
        Creates a map from an array of shape (rows, columns), row 0 at the bottom.

        `occupied` is an array of bool, or of int8 with the occupancy of each cell, 0 to 100, as
        in `nav_msgs`. A cell is occupied from `occupied_threshold` on and free up to
        `free_threshold`; it is unknown between the two and below 0. Nav2 saves maps by the same
        rule. Raises `ValueError` if the values are not all 0 but all below `free_threshold`: a
        mask must be of type bool. The array is read in place, whatever its strides.

        `resolution` is the cell size [m]; `origin` is the position [m] of the lower left corner,
        or its pose [m, m, rad].

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.array([[0, 65, 50, -1]], dtype=np.int8), resolution=0.5)
        >>> grid.occupied.tolist(), grid.unknown.tolist()
        ([[False, True, False, False]], [[False, False, True, True]])
        >>> keyway.Map.from_array(np.eye(2, dtype=np.int8), resolution=0.5)
        Traceback (most recent call last):
        ValueError: the largest occupancy is 1 of 100, so every cell would be free; pass an occupancy mask as type bool
        """
    @property
    def occupancy(self, /) -> NDArray[int8]:
        """
        The map as in `nav_msgs`: a new array of int8, -1 unknown, 0 free, 100 occupied.
        """
    @property
    def occupied(self, /) -> NDArray[bool_]:
        """
        Mask of the occupied cells: a new array of bool of shape (rows, columns).
        """
    @property
    def origin(self, /) -> tuple[float, float, float]:
        """
        Pose of the lower left corner [m, m, rad].
        """
    @staticmethod
    def read(path: str | PathLike[str], resolution: float | None = None, origin: Sequence[float] | NDArray[Any] | None = None, max_cells: int | None = None) -> Map:
        """
        Reads a map file: ROS (`.yaml` with its image), MovingAI (`.map`), or an image (`.png`,
        `.pgm`).

        A YAML file contains the placement of its map. For other files it is given by `resolution`
        [m] and `origin`. A likely mistake in such a file is a `UserWarning`. Raises `ValueError`
        for a map of more than `max_cells` [2^29], before memory is allocated.

        >>> import keyway
        >>> keyway.Map.read("nowhere.yaml")
        Traceback (most recent call last):
        FileNotFoundError: cannot read nowhere.yaml: there is no such file or folder
        """
    @property
    def resolution(self, /) -> float:
        """
        Cell size [m].
        """
    @property
    def shape(self, /) -> tuple[int, int]:
        """
        Number of rows and columns.
        """
    @property
    def unknown(self, /) -> NDArray[bool_]:
        """
        Mask of the unknown cells: a new array of bool of shape (rows, columns).
        """
    def write(self, /, path: str | PathLike[str]) -> None:
        """
        Writes the map; the extension of the file selects the format, as for `read`.

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
    Drives a robot to goals: plans on the known map, remembers sensed obstacles, and decides on a
    velocity in every cycle.

    `robot` and `stack` are names of `keyway.names`, or files. A robot may also be a dictionary
    with the fields of its file, such as `dict(like="jackal", limits=dict(v_max_mps=0.5))`; the
    default is `small`. `parameters` override those of the stack, as a dictionary with the names
    of the TOML files. With `as_published` the stack has the parameters of its paper. With `safe`,
    only commands are issued after which the robot can still stop before a contact, overriding the
    stack. `progress(done, expected)` is called while the layers of the map are built; they are
    not counted: (0, None).

    A new navigator has no goal. Goals may change while the robot drives; sensed obstacles are
    kept.

    Raises `ValueError` for an invalid value.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    >>> navigator = keyway.Navigator(grid, robot="small", stack="keyway")
    >>> navigator.relocate((1, 1, 0))
    >>> navigator.set_goal((3, 1))
    >>> navigator
    <keyway.Navigator keyway: 2.000 m to go, 360 beams>
    """
    def __new__(cls, /, grid: Map | str | PathLike[str], robot: str | PathLike[str] | dict[str, Any] | None = None, stack: str = "keyway", parameters: dict[str, Any] | None = None, as_published: bool = False, radius: float | None = None, safe: bool = False, progress: Progress | None = None) -> Navigator: ...
    def __reduce__(self, /) -> tuple[Any, tuple[bytes]]: ...
    def __repr__(self, /) -> str: ...
    def back_up(self, /, distance: float, allowance: float) -> None:
        """
        Drives straight back by a distance [m], with the same rules as `spin`.

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
        Cancels the current task: the robot brakes to a stop.
        """
    @property
    def clear_scan(self, /) -> Scan:
        """
        A scan of the robot's first sensor without hits.
        """
    @property
    def cycle(self, /) -> float:
        """
        Time between two commands [s].
        """
    @property
    def doubts(self, /) -> list[str]:
        """
        Messages about inconsistencies in recent observations, such as a velocity that is always 0
        although the pose changes.
        """
    def drive_on_heading(self, /, distance: float, allowance: float) -> None:
        """
        Drives straight ahead by a distance [m], with the same rules as `spin`.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.drive_on_heading(0.5, allowance=20)
        """
    def edit_map(self, /, window: Map | str | PathLike[str]) -> None:
        """
        Replaces a part of the map by that of another one, cell by cell at the centres of the
        cells of `window`.

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
        Follows an external path to its end, as closely as a route of its own. `path` is an array
        of shape (n, 2) [m] that starts near the robot. If an obstacle blocks it, a new route to
        its end replaces it.

        Raises `NoRoom` if the robot does not fit along it on the map, and `ValueError` for an
        invalid path. The navigator then continues as before.

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
        Clears everything sensed, static and moving.
        """
    @property
    def goal(self, /) -> list[float] | None:
        """
        The goal (x, y) [m], or with a heading (x, y, heading) [m, m, rad]; `None` if there is
        none.
        """
    @property
    def guide_points(self, /) -> NDArray[float64]:
        """
        The points of the guide along the route, its end last: a read-only array of float64 of
        shape (n, 2) [m].
        """
    def is_path_valid(self, /, path: Sequence[Sequence[float]] | NDArray[Any]) -> bool:
        """
        True if the robot fits along the whole path on the map and among the sensed obstacles,
        turning on the spot at its corners.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.is_path_valid([(1, 1), (3, 1)]), navigator.is_path_valid([(1, 1), (9, 1)])
        (True, False)
        """
    @property
    def map(self, /) -> Map:
        """
        The map as given, with all edits.
        """
    def nearest_reachable(self, /, start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any]) -> tuple[float, float] | None:
        """
        Returns the position nearest to a goal that is reachable from a start, on the map and the
        sensed obstacles [m]; `None` if nothing is reachable.

        >>> import keyway, numpy as np
        >>> walls = np.zeros((40, 40), dtype=bool)
        >>> walls[:, 20] = True
        >>> navigator = keyway.Navigator(keyway.Map.from_array(walls, resolution=0.1))
        >>> navigator.nearest_reachable((1, 1), (3, 1))[0] < 2
        True
        """
    def note_override(self, /, now: float, command: Sequence[float] | NDArray[Any]) -> None:
        """
        Notes that the robot received a command (v, omega) [m/s, rad/s] from another source, such
        as a joystick or a safety controller, in place of that of the last step. `now` is the time
        by the clock of the stamps [s]. Call it for every such command.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.note_override(0.1, (0, 0))
        """
    @property
    def notice(self, /) -> str | None:
        """
        Message that the robot had less clearance than it needs when it got its goal, until it has
        left the obstacle; otherwise `None`.
        """
    def observe(self, /, stamp: float, pose: Sequence[float] | NDArray[Any], velocity: Sequence[float] | NDArray[Any], scan: LaserScans | None = None, points: Points | Sequence[Points] | None = None) -> None:
        """
        Passes an observation: at a time [s], the pose (x, y, theta) [m, m, rad] and velocity (v,
        omega) [m/s, rad/s] of the robot, and the data of its sensors. Stamps may be of any clock,
        the same for all. They are the times of the measurements, not of their arrival.

        `scan` is a `keyway.Scan`, which has the bearing of each beam: `Simulation.scan`, or
        `keyway.Scan(ranges, angle_min, angle_increment)`. A ROS message, `sensor_msgs/LaserScan`,
        is accepted as it is, with the stamp of its header. A scan without a stamp has that of the
        pose. For a robot with several sensors it is a list with one scan per sensor, in their
        order, `None` for a sensor without a new scan. Without `scan`, there is no new scan.
        `points` are those of other sensors: a `keyway.Points`, or a list of them.

        An implausible observation, or one older than the last, is ignored; the next `step` then
        stops the robot and gives the reason.

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
        Plans a route between two positions on the map and the sensed obstacles: a read-only array
        of float64 of shape (n, 2) [m]. The navigator does not change. Raises an exception if the
        robot is in contact at the start.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.plan((1, 1), (3, 1)).tolist()
        [[1.0, 1.0], [3.0, 1.0]]
        """
    def recoveries(self, /) -> dict[str, Any]:
        """
        Returns the number of recoveries, by kind.
        """
    def relocate(self, /, pose: Sequence[float] | NDArray[Any]) -> None:
        """
        Sets the pose of the robot (x, y, theta) [m, m, rad]: before the first observation, or
        after a correction of the localisation.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        """
    @property
    def remaining(self, /) -> float | None:
        """
        Remaining length of the route [m]; `None` without a goal.
        """
    def restart_clock(self, /) -> None:
        """
        Restarts the clock of all stamps: the next observation may have any stamp.
        """
    @staticmethod
    def restore(snapshot: bytes) -> Navigator:
        """
        Restores the navigator of a snapshot.

        Raises `ValueError` for bytes that are not a snapshot, or of another version of Keyway.

        >>> import keyway
        >>> keyway.Navigator.restore(b"nonsense")
        Traceback (most recent call last):
        ValueError: snapshot: ...
        """
    @property
    def route(self, /) -> NDArray[float64]:
        """
        The current route: a read-only array of float64 of shape (n, 2) [m]; empty without a goal.
        """
    @property
    def routes_planned(self, /) -> int:
        """
        Number of route searches: one for each goal, and more when a scan shows an obstacle on the
        route, at waypoints, after waits, and in recoveries.
        """
    def set_goal(self, /, goal: Sequence[float] | NDArray[Any], progress: Progress | None = None) -> None:
        """
        Sets the goal, in place of the last one: a position [m], or with a heading [m, m, rad].

        The robot may continue to drive in another thread during the search.
        `progress(done, expected)` is called meanwhile; nothing is counted: (0, None).

        Raises `NoRoom` if the robot does not fit at its pose or at the goal, `NoPath` if no path
        leads there, and `ValueError` if the pose of the robot is unknown. The navigator then
        continues as before.

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
        Sets a goal with waypoints before it, in their order [m].

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.set_goals([(3, 1)], (3, 3))
        >>> round(navigator.remaining, 3)
        4.0
        """
    def set_map(self, /, grid: Map | str | PathLike[str]) -> None:
        """
        Replaces the map, such as by one that has grown, or whose origin has moved. Sensed
        obstacles keep their positions in the world.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> free = np.zeros((80, 80), dtype=bool)
        >>> navigator.set_map(keyway.Map.from_array(free, resolution=0.1, origin=(-2, -2)))
        >>> navigator.set_goal((-1, -1))
        """
    def set_masks(self, /, keep_out: Map | str | PathLike[str] | None = None, slow: tuple[Map | str | PathLike[str], float] | None = None) -> None:
        """
        Keeps out of the occupied cells of one map, and limits the speed [m/s] on those of another
        one. They replace earlier masks. Their frames may differ from that of the navigator's map.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> zone = keyway.Map.from_array(np.ones((1, 1), dtype=bool), resolution=1.0, origin=(2, 2))
        >>> navigator.set_masks(keep_out=zone)
        """
    def set_speed_limit(self, /, speed: float | None = None) -> None:
        """
        Limits the speed from now on [m/s]; `None` removes the limit.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.set_speed_limit(0.2)
        """
    def smooth(self, /, path: Sequence[Sequence[float]] | NDArray[Any]) -> NDArray[float64]:
        """
        Smooths a line of positions as the navigator's routes are, with the same clearance to the
        map and the sensed obstacles where the line has it. Returns a read-only array of float64
        of shape (n, 2) [m].

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.smooth([(1, 1), (2, 1.5), (3, 1)]).tolist()
        [[1.0, 1.0], [3.0, 1.0]]
        """
    def snapshot(self, /) -> bytes:
        """
        Returns the complete state as bytes. `Navigator.restore` creates the same navigator from
        them, which gives the same steps from here on. Copying and pickling use snapshots.

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
        brakes first, and the turn ends when it is stationary again. It avoids contact: without
        enough clearance it waits, until the time is over. A car-like robot refuses (`ValueError`).

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
        >>> navigator = keyway.Navigator(grid)
        >>> navigator.relocate((1, 1, 0))
        >>> navigator.spin(1.5, allowance=20)
        """
    def step(self, /) -> Step:
        """
        Runs one control cycle: returns the command for the robot, based on the observations. The
        cycle covers the time between the stamps of the last step and now; the first one lasts one
        cycle of the robot.
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
        The planner's path before smoothing: a read-only array of int32 of shape (n, 2), column
        and row of each cell.
        """
    @property
    def cost(self, /) -> float:
        """
        Cost of the planner's path [cells]. For grid planners it is an exact number of straight
        and diagonal steps.
        """
    def curve(self, /, spacing: float = 0.05, robot: str | PathLike[str] | dict[str, Any] | None = None) -> NDArray[void]:
        """
        Samples the smoothed path by arc length, with the fastest speeds within the limits of a
        robot (a name of `keyway.names`, a file, or a dictionary of its values).

        Returns a structured array of shape (n,) with the fields `s_m`, `x_m`, `y_m`,
        `heading_rad`, `curvature_per_m`, `t_s`, `v_mps` and `omega_radps`, all float64. At a
        corner the robot stops and turns on the spot.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
        >>> curve = keyway.plan(grid, (0.5, 0.5), (4.5, 0.5)).curve(spacing=1.0)
        >>> curve["s_m"].tolist()
        [0.0, 1.0, 2.0, 3.0, 4.0]
        """
    @property
    def expanded(self, /) -> int:
        """
        Number of expanded nodes: nodes taken from the open list.
        """
    @property
    def generated(self, /) -> int:
        """
        Number of generated nodes: nodes inserted or improved in the open list.
        """
    @property
    def jump_points(self, /) -> list[int]:
        """
        Indices of the cells that are jump points, ascending.
        """
    @property
    def kept_clearance(self, /) -> float | None:
        """
        Clearance that the path guarantees [m], if it is less than requested; otherwise `None`.
        """
    @property
    def length(self, /) -> float:
        """
        Length of the smoothed path [m].
        """
    def metrics(self, /) -> dict[str, Any]:
        """
        Returns metrics of the smoothed path: `length_m`, `points`, `redundant_points`, `turns`,
        `turning_angle_deg`, `non_smooth_turns` and `min_clearance_m`. They are computed at every
        call.

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
    def smoother(self, /) -> str:
        """
        Name of the smoother.
        """
    @property
    def xy(self, /) -> NDArray[float64]:
        """
        The smoothed path as a line: a read-only array of float64 of shape (n, 2) [m]. A curve is
        approximated by chords.
        """

@final
class Planner:
    """
    Plans many paths on one map. Its layers, planner and smoother are built once.

    The arguments are those of `keyway.plan`. `progress(done, expected)` is called during the
    construction. The planner `prepared` counts twice the number of cells at which paths may turn;
    for the other planners, which build only the layers, `expected` is `None`.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((50, 50), dtype=bool), resolution=0.1)
    >>> planner = keyway.Planner(grid, radius=0.2, planner="theta-star")
    >>> planner.plan((0.55, 0.55), (4.55, 0.55)).length
    4.0
    """
    def __new__(cls, /, grid: Map | str | PathLike[str], radius: float | None = None, planner: str = "jps", smoother: str = "none", robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, progress: Progress | None = None) -> Planner: ...
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
        Plans a path to the nearest of several goals, by path cost. `goals` are an array of shape
        (n, 2) [m]. Returns the index of that goal, and the plan. Raises the exceptions of
        `keyway.plan` if no goal has a path.

        >>> import keyway, numpy as np
        >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
        >>> index, plan = planner.plan_nearest((0.5, 0.5), [(8.5, 8.5), (0.5, 3.5), (5.5, 0.5)])
        >>> index, plan.cost
        (1, 3.0)
        """

@final
class Points:
    """
    Hits of a depth camera, a sonar or a bumper, as points on the ground.

    `positions` is an array of shape (n, 2), in the frame of the sensor [m]; non-finite points are
    ignored. `mount` is the pose of the sensor on the robot (x, y, theta) [m, m, rad]. Robots with
    several such sensors number them by `sensor`, from 0 to 7. `stamp` is the time of the
    measurement [s]; by default it is that of the pose given with it.

    The points mark obstacles, which stay until the same sensor clears them. A sensor clears if it
    has `bearings`, those of its right and left edge [rad] (0 straight ahead, positive to the
    left), and `ranges`, its minimum and maximum range [m]. Within these it detects every static
    obstacle that is not occluded.

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
    A simulated run, and its measurements.

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
    def goal(self, /) -> list[float]:
        """
        Goal of the robot (x, y) [m], or with a given heading (x, y, yaw) [m, m, rad].
        """
    @property
    def map(self, /) -> Map:
        """
        The map that was known to the robot.
        """
    @property
    def metrics(self, /) -> dict[str, Any]:
        """
        Metrics of the run, with the names of `run` in `docs/reference/json.md`: `time_s`,
        `length_m`, `min_clearance_m` and more. It is empty if there was no route.
        """
    @property
    def moving(self, /) -> list[NDArray[void]]:
        """
        The moving obstacles during the run: for each, a structured array with the fields `t_s`,
        `x_m`, `y_m` and `radius_m`, all float64, at the times of `trajectory`. Where an obstacle
        jumps, a row has a position of NaN.
        """
    @property
    def outcome(self, /) -> str:
        """
        Outcome of the run: `reached`, `collided`, `timeout`, `stuck` or `no_path`.
        """
    @property
    def reason(self, /) -> str | None:
        """
        Message with the reason for not reaching the goal; otherwise `None`.
        """
    @property
    def report(self, /) -> dict[str, Any]:
        """
        The whole report, `keyway.navigate/4` of `docs/reference/json.md`.
        """
    @property
    def route(self, /) -> NDArray[float64]:
        """
        The first route after smoothing: a read-only array of float64 of shape (n, 2) [m]. A curve
        is approximated by chords. It is empty if there was no route.
        """
    @property
    def start(self, /) -> list[float]:
        """
        Start of the robot (x, y) [m], or with a given heading (x, y, yaw) [m, m, rad]. In `report`
        headings are in degrees.
        """
    @property
    def trajectory(self, /) -> NDArray[void]:
        """
        The start, the end of every cycle, and the contact if there was one: a structured array of
        shape (n,) with the fields `t_s`, `x_m`, `y_m`, `yaw_rad`, `v_mps` and `omega_radps`, all
        float64. It is empty if there was no route.
        """

@final
class Scan:
    """
    One scan of a range sensor, with the names and the meaning of `sensor_msgs/LaserScan`.

    `ranges` are those of all beams [m]: infinity means no hit, and NaN or 0 an invalid beam. Beam
    i has the bearing `angle_min + i * angle_increment` [rad], 0 straight ahead and positive to
    the left; if the beams go clockwise, `angle_increment` is negative. Sensors start at the back,
    at the front or at a side, so neither angle has a default. `stamp` is the time of the scan
    [s]; by default it is that of the pose given with it.

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
        Bearing from one beam to the next [rad], negative if they go clockwise.
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
        Time of the scan [s]; `None` if it was not given.
        """

@final
class Scene:
    """
    Description of a run: map, robot, start, goal, and the static and moving obstacles that are
    not on the map.

    For a map in memory, the arguments are those of a scene file, with the same names: `robot`,
    `stack`, `safe`, `via`, `seed`, `unknown`, `moving`, `random`, `rules`, `disturbances`.
    `start` and `goal` are positions [m], or poses [m, m, rad]; only in scene files, and so in
    `to_toml`, headings are in degrees. `Scene.read` reads a scene file.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> keyway.Scene(grid, start=(1, 2), goal=(7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])
    <keyway.Scene small with keyway, 1 unknown, 0 moving, seed 0>
    """
    def __new__(cls, /, grid: Map | str | PathLike[str], start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any], **fields: "object") -> Scene: ...
    def __reduce__(self, /) -> tuple[Any, tuple[str, Path, Map | None, str | None]]:
        """
        Supports copying, pickling and sending scenes to other processes.
        """
    def __repr__(self, /) -> str: ...
    @staticmethod
    def _restored(text: str, folder: str | PathLike[str], map: Map | None, name: str | None) -> Scene: ...
    @staticmethod
    def from_toml(text: str, folder: str | PathLike[str] | None = None) -> Scene:
        """
        Parses the text of a scene file; paths in it are relative to `folder`.

        >>> import keyway
        >>> keyway.Scene.from_toml("version = 2")
        Traceback (most recent call last):
        ValueError: a scene has either a `map` or a `[world]`, got neither
        """
    @property
    def goal(self, /) -> list[float] | None:
        """
        Goal (x, y) [m], or with a heading (x, y, yaw) [m, m, rad]; `None` for several robots.
        """
    @property
    def is_random(self, /) -> bool:
        """
        True if the run depends on the seed.
        """
    @property
    def name(self, /) -> str | None:
        """
        Name of the scene's file without `.toml`; `None` for a scene that was not read from a file.
        """
    @staticmethod
    def read(path: str | PathLike[str]) -> Scene:
        """
        Reads a scene file. Paths in it are relative to its folder.

        >>> import keyway
        >>> keyway.Scene.read("nowhere.toml")
        Traceback (most recent call last):
        FileNotFoundError: cannot read nowhere.toml: there is no such file or folder
        """
    def replace(self, /, seed: int | None = None, robot: str | PathLike[str] | dict[str, Any] | None = None, stack: str | None = None, safe: bool | None = None) -> Scene:
        """
        Returns the same scene with another seed, robot or stack, with or without the stop rule.

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
        Seed of all random values.
        """
    @property
    def stack(self, /) -> str:
        """
        Name of the stack.
        """
    @property
    def start(self, /) -> list[float] | None:
        """
        Start (x, y) [m], or with a heading (x, y, yaw) [m, m, rad]; `None` for several robots.
        """
    def to_toml(self, /) -> str:
        """
        Returns the text of the scene file. A map in memory is called `array` there.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> keyway.Scene(grid, (1, 2), (7, 2)).to_toml().splitlines()[0]
        'version = 2'
        """

@final
class Simulation:
    """
    The world of a scene, driven by the caller: one control cycle per call, as in reinforcement
    learning.

    The goal is reached as soon as the robot is within its tolerance, even while moving. The stack
    of the scene plans only the first route, which determines the initial heading and the time
    limit; it does not drive. `progress(done, expected)` is called meanwhile; the work is not
    counted: (0, None).

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> simulation = keyway.Simulation(keyway.Scene(grid, (1, 2), (7, 2)))
    >>> while simulation.outcome is None:
    ...     outcome = simulation.step(0.5, 0.0)
    >>> simulation.outcome
    'reached'
    """
    def __new__(cls, /, scene: Scene | str | PathLike[str], progress: Progress | None = None) -> Simulation: ...
    def __repr__(self, /) -> str: ...
    @property
    def cycle(self, /) -> float:
        """
        Duration of a step [s].
        """
    @property
    def goal(self, /) -> tuple[float, float]:
        """
        Position of the goal (x, y) [m].
        """
    @property
    def goal_heading(self, /) -> float | None:
        """
        Heading that the robot is to have at the goal [rad]; `None` if any will do. The run ends at
        the goal with any heading.
        """
    @property
    def hidden(self, /) -> NDArray[bool_]:
        """
        Mask of the cells that are occupied and that the map shows as free: a new array of bool of
        shape (rows, columns).
        """
    @property
    def limits(self, /) -> tuple[tuple[float, float], tuple[float, float]]:
        """
        Lowest and highest velocity of the robot: (v, omega) of each [m/s, rad/s].
        """
    @property
    def map(self, /) -> Map:
        """
        The map that the robot knows.
        """
    @property
    def moving(self, /) -> NDArray[float64]:
        """
        Moving obstacles at this time: a read-only array of float64 of shape (n, 3) with the centre
        (x, y) and the radius of each [m].
        """
    @property
    def obstacles(self, /) -> NDArray[float64]:
        """
        Static obstacles that are not on the map and are present now: a read-only array of float64
        of shape (n, 3) with the centre (x, y) and the radius of each [m].
        """
    @property
    def outcome(self, /) -> str | None:
        """
        Outcome of the run, `reached`, `collided`, `timeout` or `stuck`; `None` while it is
        running.
        """
    @property
    def outline(self, /) -> NDArray[float64]:
        """
        Outline of the robot at its true pose: a read-only array of float64 of shape (n, 2) [m]. A
        circle is approximated by chords.
        """
    @property
    def polygons(self, /) -> list[NDArray[float64]]:
        """
        Vertices of static obstacles that are not on the map and are present now: for each, a
        read-only array of float64 of shape (n, 2) [m].
        """
    @property
    def pose(self, /) -> tuple[float, float, float]:
        """
        Estimated pose of the robot (x, y, theta) [m, m, rad].
        """
    @property
    def range(self, /) -> float:
        """
        Range of the sensor [m]; the longest one of several.
        """
    @property
    def scan(self, /) -> Scan:
        """
        The current scan of the first sensor: ranges and bearings of its beams.
        `Navigator.observe` accepts it for a robot with a single sensor.
        """
    @property
    def scans(self, /) -> list[Scan | None]:
        """
        The current scans of all sensors, in their order; `None` for a sensor without a scan in
        this cycle. `Navigator.observe` accepts them.
        """
    @property
    def stamp(self, /) -> float:
        """
        Time at which `pose` and `velocity` were measured [s].
        """
    def step(self, /, v: float, omega: float, remaining: float | None = None) -> str | None:
        """
        Runs one control cycle: the robot accelerates towards the velocity (v, omega) [m/s,
        rad/s], within its limits. Returns the outcome once the run has ended, and `None` before
        that. A run that has ended does not change.

        `remaining` is the remaining distance to the goal [m], which decides whether the robot is
        stuck; by default it is the straight-line distance.

        >>> import keyway, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> simulation = keyway.Simulation(keyway.Scene(grid, (1, 2, 0), (7, 2)))
        >>> simulation.step(0.5, 0.0) is None, round(simulation.velocity[0], 3)
        (True, 0.05)
        """
    @property
    def true_pose(self, /) -> tuple[float, float, float]:
        """
        True pose of the robot (x, y, theta) [m, m, rad].
        """
    @property
    def velocity(self, /) -> tuple[float, float]:
        """
        Estimated velocity of the robot (v, omega) [m/s, rad/s].
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
        Number of the reason for `blocked`, which never changes; otherwise `None`.
        """
    @property
    def notice(self, /) -> str | None:
        """
        Message that the robot started with less clearance than it needs, and is leaving the
        obstacle; otherwise `None`.
        """
    @property
    def omega(self, /) -> float:
        """
        Turn rate, positive to the left [rad/s].
        """
    @property
    def status(self, /) -> str:
        """
        `drive`, `blocked` (there is no acceptable command at the moment; the given one is safe),
        `arrived`, or `idle` (there is no goal).
        """
    @property
    def v(self, /) -> float:
        """
        Forward speed [m/s].
        """
    @property
    def why(self, /) -> str | None:
        """
        Message with the reason for `blocked`; otherwise `None`.
        """

def batch(scenes: Sequence[str | PathLike[str] | Scene] | Mapping[str, str | PathLike[str] | Scene], out: str | PathLike[str], stacks: Sequence[str] | None = None, seeds: int = 1, jobs: int | None = None, shard: tuple[int, int] | None = None, keep: str | None = None, robot: str | PathLike[str] | dict[str, Any] | None = None, disturbances: str | PathLike[str] | None = None, reached_by: str | None = None, safe: bool = False, parameters: dict[str, Any] | None = None, progress: Progress | None = None) -> dict[str, Any]:
    """
    Drives scenes with stacks and seeds, as `keyway batch` does, and writes the same files, byte
    for byte, into the folder `out`.

    `scenes` is a list of scene files, folders of them, and objects of `keyway.Scene`. A file has
    its own name in the results, without `.toml`, and so has a scene that was read from it; a scene
    in memory is called `scene-0`, by its index in the list. Other names are the keys of a
    dictionary of scenes and scene files.

    `stacks` are names or files, or `["all"]`. `seeds` is the number of seeds for each scene.
    `shard=(i, n)` runs only the i-th of n parts; `keyway.merge` merges the parts. `jobs` is the
    number of threads. `keep` selects the runs that get a full record: `"none"`, `"failures"` or
    `"all"`. `robot` and `disturbances` are names or files. `reached_by` is the pose that counts
    as reaching a goal, `"truth"` or `"belief"`. `safe` enables the stop rule for every stack.
    `parameters` override those of every stack, and their `robot` table those of every robot.
    Finished runs in the folder are not repeated, so an interrupted batch is resumed.
    `progress(done, expected)` is called meanwhile.

    Returns the report `keyway.batch/1` of `docs/reference/json.md`.

    >>> import keyway
    >>> keyway.batch(["nowhere.toml"], out="unused")
    Traceback (most recent call last):
    ValueError: cannot read nowhere.toml: there is no such file or folder
    """

def compare(grid: Map | str | PathLike[str], planners: Sequence[str] | None = None, smoothers: Sequence[str] | None = None, queries: int = 10, seed: int = 0, repeat: int = 1, radius: float | None = None, robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, columns: Sequence[str] | None = None, times: bool = True, progress: Progress | None = None) -> Comparison:
    """
    Compares the paths of planners and smoothers on a map, with each other and with the shortest
    line, as `keyway compare` does.

    `planners` and `smoothers` are lists of names, or `["all"]`. `queries` random queries are
    drawn from `seed`. `radius` is the clearance of paths to every obstacle [m]; `robot` is a
    robot whose radius is used as clearance. `parameters` are those of the TOML files, as a
    dictionary; those of one planner or smoother are set by its name:
    `{"hsta": {"if_no_path": "fail"}}`. With `as_published`, planners and smoothers use the
    parameters of their papers, for maps with cells of 1 m, whatever the robot. Without `times`,
    the report is deterministic. `progress(done, expected)` is called meanwhile.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    >>> keyway.compare(grid, planners=["jps", "jsp"])
    Traceback (most recent call last):
    ValueError: planners: `planner.name` must be one of ...
    """

def merge(parts: Sequence[str | PathLike[str]], out: str | PathLike[str]) -> dict[str, Any]:
    """
    Merges results of `keyway.batch` from several folders, such as the parts of one batch. Nothing
    is driven.

    >>> import keyway
    >>> keyway.merge([], out="unused")
    Traceback (most recent call last):
    ValueError: parts: expected at least one folder
    """

def names(kind: str) -> list[str]:
    """
    Returns the available names of `planners`, `smoothers`, `guides`, `local-planners`, `stacks`
    or `robots`. The command `keyway list NAME` describes each of them and its parameters.

    >>> import keyway
    >>> keyway.names("robots")[:3]
    ['small', 'jackal', 'paper']
    """

def plan(grid: Map | str | PathLike[str], start: Sequence[float] | NDArray[Any], goal: Sequence[float] | NDArray[Any], radius: float | None = None, planner: str = "jps", smoother: str = "none", robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, budget: int | None = None, nearest_reachable: bool = False, progress: Progress | None = None) -> Plan:
    """
    Plans a path on a map from one position to another [m], and smooths it.

    `grid` is a map, or the path of its file, which is then read at every call.

    `planner` and `smoother` are names of `keyway.names`. `radius` is the clearance of the path to
    every obstacle [m]; with `robot` it is the robot's inscribed radius instead. `parameters` are
    those of the TOML files, as a dictionary:
    `{"planner": {"corners": "allow"}, "map": {"unknown": "free"}}`. With `as_published`, planner
    and smoother use the parameters of their papers, for maps with cells of 1 m, whatever the
    robot. `budget` limits the expanded nodes. With `nearest_reachable` the path ends in the
    reachable cell nearest to the goal.

    The layers for a choice of parameters are cached with the map, so a second call is fast.

    `progress(done, expected)` is called meanwhile. The preparation of a `keyway.Planner` is
    counted. A search is not, as its length is unknown: (0, None).

    Raises `NoPath` if no path connects the two, with the reason; `NoRoom` if one of them is
    blocked or outside the map; `Missed` if the planner finds no path although there is one;
    `BudgetExhausted`; and `ValueError` for an invalid parameter.

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

def plan_many(grid: Map | str | PathLike[str], starts: Sequence[Sequence[float]] | NDArray[Any], goals: Sequence[Sequence[float]] | NDArray[Any], radius: float | None = None, planner: str = "jps", smoother: str = "none", robot: str | PathLike[str] | dict[str, Any] | None = None, parameters: dict[str, Any] | None = None, as_published: bool = False, jobs: int | None = None, progress: Progress | None = None) -> Plans:
    """
    Plans many paths on all cores: from `starts` to `goals`, arrays of shape (n, 2) [m].

    The other arguments are those of `keyway.plan`; `jobs` is the number of threads. Returns a
    list with a plan for each query, in their order; for a query without one, the list contains
    the exception. `progress(done, expected)` is called meanwhile.

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
    Runs the program `keyway` with the words of a command line and returns its exit code.

    >>> import keyway
    >>> keyway.program(["map", "info", "nowhere.map", "--format", "xml"])
    2
    """

def simulate(scene: Scene | str | PathLike[str], progress: Progress | None = None, times: bool = False) -> Run:
    """
    Simulates the run of a scene. The same scene gives the same run, to the last digit. A scene may
    be the path of its file.

    A start without a route, a collision and a timeout are outcomes, not exceptions.
    `progress(cycles, None)` is called meanwhile. With `times`, the times of decisions are
    measured; two reports then differ in them.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> scene = keyway.Scene(grid, (1, 2), (7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])
    >>> run = keyway.simulate(scene)
    >>> run.outcome, run.metrics["min_clearance_m"] > 0
    ('reached', True)
    """

def simulate_team(scene: Scene | str | PathLike[str], progress: Progress | None = None) -> list[Run]:
    """
    Simulates the runs of all robots of a scene, which drive in one world at the same time.
    Returns one run per robot, in their order.

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

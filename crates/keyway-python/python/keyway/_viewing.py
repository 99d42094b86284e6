"""Pictures of a simulation for environments of gymnasium."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from keyway._keyway import Simulation
from keyway.plotting import _GOAL, _MOVING, _UNKNOWN, _plot_end, _plot_map, _plot_mask, _plot_unknown

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

__all__ = ["Picture", "Window"]

#: Length of the longer side [px].
_SIDE = 640
_DPI = 100
#: Names of backends with windows of their own in a notebook.
_IN_NOTEBOOKS = ("nbagg", "ipympl")


class Picture:
    """A map with a robot, its scan, its goal and the obstacles, drawn into a figure."""

    def __init__(self, simulation: Simulation, figure: Figure) -> None:
        self._simulation = simulation
        self.figure = figure
        figure.clear()
        width, height = _size(simulation)
        figure.set_size_inches(width / _DPI, height / _DPI)
        self._ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._ax.set_axis_off()
        grid = simulation.map
        _plot_map(self._ax, grid, {})
        hidden = simulation.hidden
        if hidden.any():
            _plot_mask(self._ax, grid, hidden)
        goal = simulation.goal if simulation.goal_heading is None else (*simulation.goal, simulation.goal_heading)
        _plot_end(self._ax, goal, "goal", marker="*", markersize=14, color=_GOAL)
        self._ax.set_aspect("equal")
        self._moving: list[Artist] = []

    @staticmethod
    def of(simulation: Simulation) -> Picture:
        """A picture without a window."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(dpi=_DPI)
        FigureCanvasAgg(figure)
        return Picture(simulation, figure)

    def update(self) -> None:
        """Draws what is different in this cycle."""
        from matplotlib.patches import Circle, Polygon

        for artist in self._moving:
            artist.remove()
        simulation, ax = self._simulation, self._ax
        x, y, theta = simulation.true_pose
        scan = simulation.scan
        hit = (scan.ranges > 0) & (scan.ranges < simulation.range)
        angles = theta + scan.bearings[hit]
        hits = ax.scatter(
            x + scan.ranges[hit] * np.cos(angles), y + scan.ranges[hit] * np.sin(angles), s=4, color="tab:blue", zorder=2.5
        )
        self._moving = [hits, *_plot_unknown(ax, simulation.obstacles, simulation.polygons)]
        for obstacle in simulation.moving:
            disc = Circle((obstacle[0], obstacle[1]), obstacle[2], facecolor=_MOVING, alpha=0.7, zorder=1.6)
            self._moving.append(ax.add_patch(disc))
        outline = simulation.outline
        robot = Polygon(outline, closed=True, facecolor="tab:cyan", edgecolor="k", zorder=3.0)
        self._moving.append(ax.add_patch(robot))
        nose = x + np.cos(theta) * np.ptp(outline[:, 0]) / 2, y + np.sin(theta) * np.ptp(outline[:, 0]) / 2
        self._moving += ax.plot([x, nose[0]], [y, nose[1]], color="k", linewidth=1.5, zorder=3.1)

    def pixels(self) -> NDArray[np.uint8]:
        """The picture as an array of shape (rows, columns, 3)."""
        self.update()
        canvas: Any = self.figure.canvas
        canvas.draw()
        return np.array(np.asarray(canvas.buffer_rgba())[:, :, :3])


class Window:
    """A window of matplotlib."""

    def __init__(self) -> None:
        import matplotlib
        import matplotlib.pyplot as plt

        self._figure = plt.figure(dpi=_DPI)
        backend = matplotlib.get_backend().lower()
        has_window = getattr(type(self._figure.canvas), "required_interactive_framework", None) is not None
        self._is_shown = has_window or any(name in backend for name in _IN_NOTEBOOKS)
        if not self._is_shown:
            text = f"the backend `{backend}` of matplotlib opens no window; choose another with matplotlib.use, or use rgb_array"
            warnings.warn(text, UserWarning, stacklevel=4)
        self._picture: Picture | None = None

    def draw(self, simulation: Simulation, pause: float) -> None:
        """Shows a simulation for a time [s]. A window that was closed stays closed."""
        import matplotlib.pyplot as plt

        if not plt.fignum_exists(self._figure.number):  # type: ignore[attr-defined,unused-ignore]
            return
        if self._picture is None or self._picture._simulation is not simulation:
            self._picture = Picture(simulation, self._figure)
        self._picture.update()
        self._figure.canvas.draw_idle()
        if self._is_shown:
            plt.show(block=False)
            self._figure.canvas.start_event_loop(pause)
        else:
            self._figure.canvas.draw()

    def close(self) -> None:
        """Closes the window."""
        import matplotlib.pyplot as plt

        plt.close(self._figure)


def _size(simulation: Simulation) -> tuple[int, int]:
    """Width and height of a picture of the map [px], at least a tenth of its longer side."""
    grid = simulation.map
    rows, columns = grid.shape
    cos, sin = abs(np.cos(grid.origin[2])), abs(np.sin(grid.origin[2]))
    sides = np.array([columns * cos + rows * sin, columns * sin + rows * cos])
    width, height = np.maximum(sides * _SIDE / sides.max(), _SIDE / 10).round().astype(int)
    return int(width), int(height)

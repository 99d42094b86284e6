"""Figures with matplotlib, which must be installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from keyway._keyway import Map, Plan, Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["plot"]


def plot(ax: Axes, *things: Map | Plan | Run, **style: Any) -> Axes:
    """Draws maps, plans and runs into axes of matplotlib, in metres, and returns the axes.

    ``style`` is passed to matplotlib: to ``plot`` for plans and runs, such as ``color="tab:red"`` or ``label="taut"``, and to
    ``imshow`` if there are only maps.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import keyway, numpy as np, matplotlib.pyplot as plt
    >>> grid = keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0)
    >>> figure, ax = plt.subplots()
    >>> ax = keyway.plot(ax, grid, keyway.plan(grid, (0.5, 0.5), (8.5, 4.5)), color="tab:red")
    >>> len(ax.lines), len(ax.images)
    (1, 1)
    >>> plt.close(figure)
    """
    has_lines = any(not isinstance(thing, Map) for thing in things)
    for thing in things:
        if isinstance(thing, Map):
            _plot_map(ax, thing, {} if has_lines else style)
        elif isinstance(thing, Plan):
            ax.plot(thing.xy[:, 0], thing.xy[:, 1], **style)
        elif isinstance(thing, Run):
            trajectory = thing.trajectory
            ax.plot(trajectory["x_m"], trajectory["y_m"], **style)
        else:
            raise TypeError(f"expected a Map, a Plan or a Run, got {type(thing).__name__}")
    ax.set_aspect("equal")
    # Whoever has named an axis keeps that name.
    ax.set_xlabel(ax.get_xlabel() or "x [m]")
    ax.set_ylabel(ax.get_ylabel() or "y [m]")
    return ax


def _plot_map(ax: Axes, grid: Map, style: dict[str, Any]) -> None:
    """Occupied cells black, unknown ones grey."""
    from matplotlib.transforms import Affine2D

    occupancy = grid.occupancy
    shades = {-1: 0.75, 0: 1.0, 100: 0.0}
    image = sum((occupancy == value) * shade for value, shade in shades.items())
    rows, columns = grid.shape
    width, height = columns * grid.resolution, rows * grid.resolution
    x, y, yaw = grid.origin
    usual: dict[str, Any] = {"cmap": "gray", "vmin": 0.0, "vmax": 1.0, "interpolation": "nearest", "zorder": 0}
    drawn = ax.imshow(image, origin="lower", extent=(0, width, 0, height), **{**usual, **style})
    place = Affine2D().rotate(yaw).translate(x, y)
    drawn.set_transform(place + ax.transData)
    corners = place.transform([(0, 0), (width, 0), (0, height), (width, height)])
    ax.set_xlim(corners[:, 0].min(), corners[:, 0].max())
    ax.set_ylim(corners[:, 1].min(), corners[:, 1].max())

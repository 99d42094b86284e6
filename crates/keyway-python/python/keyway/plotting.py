"""Figures with matplotlib, which has to be installed to use this."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from keyway._keyway import Map, Plan, Run

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

__all__ = ["plot"]

#: Unknown obstacles, moving obstacles, start, goal.
_UNKNOWN, _MOVING, _START, _GOAL = "tab:orange", "tab:purple", "tab:green", "tab:red"
#: Instants at which moving obstacles are drawn.
_INSTANTS = 6


def plot(
    *things: Axes | Map | Plan | Run | str | PathLike[str],
    ax: Axes | None = None,
    speed: bool = False,
    details: bool = True,
    **style: Any,
) -> Axes:
    """Draws maps, plans and runs into axes of matplotlib, in metres; returns the axes.

    A map may be the path of its file. The axes are ``ax``, or the first argument, as in ``keyway.plot(ax, grid, run)``; without
    them, the current axes of ``pyplot``.

    A plan or a run is a line with its start and goal. A run also has the obstacles that its map does not show: unknown ones
    hatched; moving ones with their paths, as outlines at equal intervals of time, darker the later, and a dot on the robot's path
    for each of these times. ``details=False`` draws only the lines.

    With ``speed``, the colour of the lines is the speed, with a colour bar: that of the robot for a run, the fastest one for a
    plan.

    ``style`` goes to matplotlib: to ``plot`` for plans and runs, such as ``color="tab:red"`` or ``label="taut"``, to
    ``LineCollection`` with ``speed``, such as ``cmap="plasma"``, and to ``imshow`` where there are maps alone.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import keyway, numpy as np, matplotlib.pyplot as plt
    >>> grid = keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0)
    >>> figure, ax = plt.subplots()
    >>> ax = keyway.plot(grid, keyway.plan(grid, (0.5, 0.5), (8.5, 4.5)), ax=ax, color="tab:red")
    >>> len(ax.lines), len(ax.images)
    (3, 1)
    >>> ax = keyway.plot(grid, keyway.simulate(keyway.Scene(grid, (1, 1), (7, 4))), speed=True)
    >>> figure.axes[-1].get_ylabel()
    'speed [m/s]'
    >>> plt.close(figure)
    """
    ax, drawn = _axes_of(ax, things)
    lines = [thing for thing in drawn if not isinstance(thing, Map)]
    for thing in drawn:
        if isinstance(thing, Map):
            _plot_map(ax, thing, {} if lines else style)
    if details:
        for thing in lines:
            if isinstance(thing, Run):
                _plot_obstacles_of(ax, thing)
    if speed:
        _plot_speeds(ax, lines, style)
    else:
        for thing in lines:
            x, y, _ = _line_of(thing)
            ax.plot(x, y, **style)
    if details:
        for thing in lines:
            _plot_ends_of(ax, thing)
    ax.set_aspect("equal")
    # Whoever has named an axis keeps that name.
    ax.set_xlabel(ax.get_xlabel() or "x [m]")
    ax.set_ylabel(ax.get_ylabel() or "y [m]")
    return ax


def _axes_of(ax: Axes | None, things: Sequence[Any]) -> tuple[Axes, list[Map | Plan | Run]]:
    from matplotlib.axes import Axes

    if things and isinstance(things[0], Axes):
        if ax is not None:
            raise TypeError("the axes are given twice: as the first argument, and as ax")
        ax, things = things[0], things[1:]
    drawn: list[Map | Plan | Run] = []
    for thing in things:
        if isinstance(thing, (str, PathLike)):
            thing = Map.read(thing)
        if not isinstance(thing, (Map, Plan, Run)):
            raise TypeError(f"expected a Map, a Plan, a Run, or the path of a map file, got {type(thing).__name__}")
        drawn.append(thing)
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.gca()
    return ax, drawn


def _line_of(thing: Plan | Run) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """The positions [m] along a line, and the speeds there [m/s]."""
    if isinstance(thing, Run):
        trajectory = thing.trajectory
        return trajectory["x_m"], trajectory["y_m"], trajectory["v_mps"]
    return thing.xy[:, 0], thing.xy[:, 1], np.empty(0)


def _plot_speeds(ax: Axes, lines: Iterable[Plan | Run], style: dict[str, Any]) -> None:
    from matplotlib.collections import LineCollection

    if not {"color", "colors", "c"}.isdisjoint(style):
        raise ValueError("with speed, the colours are those of the speeds: choose them with cmap")
    pieces = []
    for thing in lines:
        along = thing.curve() if isinstance(thing, Plan) else thing.trajectory
        points = np.column_stack([along["x_m"], along["y_m"]])
        speeds = np.abs(along["v_mps"])
        pieces.append((np.stack([points[:-1], points[1:]], axis=1), (speeds[:-1] + speeds[1:]) / 2))
    fastest = max((speeds.max() for _, speeds in pieces if speeds.size), default=0.0)
    collection = None
    for segments, speeds in pieces:
        usual: dict[str, Any] = {"linewidths": 2.0, "capstyle": "round", "zorder": 2.0}
        if not {"linewidth", "lw"}.isdisjoint(style):
            del usual["linewidths"]
        collection = LineCollection(list(segments), **{**usual, **style})
        collection.set_array(speeds)
        collection.set_clim(0.0, fastest or 1.0)
        ax.add_collection(collection)
    ax.autoscale_view()
    figure = ax.get_figure()
    if collection is not None and figure is not None:
        figure.colorbar(collection, ax=ax, label="speed [m/s]")


def _plot_ends_of(ax: Axes, thing: Plan | Run) -> None:
    start, goal = (thing.start, thing.goal) if isinstance(thing, Run) else (thing.xy[0], thing.xy[-1])
    _plot_end(ax, start, "start", marker="o", color=_START)
    _plot_end(ax, goal, "goal", marker="*", markersize=14, color=_GOAL)


def _plot_end(ax: Axes, at: Sequence[float] | NDArray[Any], label: str, **style: Any) -> list[Artist]:
    """A start or a goal, with a stroke along its heading, if it has one."""
    mark = {"linestyle": "none", "markeredgecolor": "white", "markersize": 8, "zorder": 4.0, "label": _once(ax, label)}
    artists: list[Artist] = list(ax.plot([at[0]], [at[1]], **{**mark, **style}))
    if len(at) > 2:
        ahead = (np.cos(at[2]), np.sin(at[2]))
        artists.append(
            ax.quiver(*at[:2], *ahead, color=style["color"], scale=20, scale_units="width", width=0.006, zorder=3.9)
        )
    return artists


def _plot_obstacles_of(ax: Axes, run: Run) -> None:
    inputs = run.report["inputs"]
    elusive = inputs["elusive"]
    discs = [*inputs["obstacles"], *([*one["position"], one["radius_m"]] for one in elusive if "position" in one)]
    polygons = [*inputs["polygons"], *(one["vertices_m"] for one in elusive if "vertices_m" in one)]
    _plot_unknown(ax, discs, polygons)
    if inputs["hidden_cells"]:
        hidden = np.zeros(run.map.shape, dtype=bool)
        columns, rows = np.array(inputs["hidden_cells"]).T
        hidden[rows, columns] = True
        _plot_mask(ax, run.map, hidden)
    _plot_moving(ax, run)


def _plot_unknown(
    ax: Axes, discs: Iterable[Sequence[float] | NDArray[Any]], polygons: Iterable[Any], color: str = _UNKNOWN
) -> list[Artist]:
    """Obstacles that the map does not show: discs (x, y, radius) and polygons [m]."""
    from matplotlib.patches import Circle, Patch, Polygon

    style: dict[str, Any] = {"facecolor": "none", "edgecolor": color, "hatch": "/////", "zorder": 1.5}
    patches: list[Patch] = [Circle((x, y), radius, **style) for x, y, radius in discs]
    patches += [Polygon(np.asarray(vertices), closed=True, **style) for vertices in polygons]
    for patch in patches:
        patch.set_label(_once(ax, "unknown obstacle"))
        ax.add_patch(patch)
    return list(patches)


def _plot_moving(ax: Axes, run: Run) -> None:
    from matplotlib.patches import Circle

    trajectory = run.trajectory
    if not trajectory.size:
        return
    instants = np.linspace(trajectory["t_s"][0], trajectory["t_s"][-1], _INSTANTS)
    for moving in run.moving:
        label = _once(ax, "moving obstacle")
        ax.plot(moving["x_m"], moving["y_m"], color=_MOVING, linestyle="--", linewidth=1.0, label=label, zorder=1.6)
        is_place = np.isfinite(moving["x_m"])
        times = np.where(is_place, moving["t_s"], np.inf)
        for number, instant in enumerate(instants):
            x, y, radius = (moving[name][np.abs(times - instant).argmin()] for name in ("x_m", "y_m", "radius_m"))
            style = {"edgecolor": _MOVING, "alpha": 0.3 + 0.7 * number / (_INSTANTS - 1), "zorder": 1.6}
            ax.add_patch(Circle((x, y), radius, fill=False, **style))
    if run.moving:
        dots = np.searchsorted(trajectory["t_s"], instants[1:-1])
        ax.plot(trajectory["x_m"][dots], trajectory["y_m"][dots], ".", color="k", markersize=5, zorder=3.0)


def _once(ax: Axes, label: str) -> str:
    """The label, unless the axes have it already: then one that legends leave out."""
    return "_" + label if label in ax.get_legend_handles_labels()[1] else label


def _plot_map(ax: Axes, grid: Map, style: dict[str, Any]) -> None:
    """Occupied cells black, unknown ones grey."""
    occupancy = grid.occupancy
    shades = {-1: 0.75, 0: 1.0, 100: 0.0}
    image = sum((occupancy == value) * shade for value, shade in shades.items())
    usual: dict[str, Any] = {"cmap": "gray", "vmin": 0.0, "vmax": 1.0, "zorder": 0}
    corners = _plot_cells(ax, grid, image, {**usual, **style})
    ax.set_xlim(corners[:, 0].min(), corners[:, 0].max())
    ax.set_ylim(corners[:, 1].min(), corners[:, 1].max())


def _plot_mask(ax: Axes, grid: Map, mask: NDArray[np.bool_]) -> None:
    """Cells that are occupied, and not on the map."""
    from matplotlib.colors import to_rgba

    image = np.zeros((*mask.shape, 4))
    image[mask] = to_rgba(_UNKNOWN)
    _plot_cells(ax, grid, image, {"zorder": 0.5})


def _plot_cells(ax: Axes, grid: Map, image: Any, style: dict[str, Any]) -> Any:
    """An image with a pixel for each cell, where the map lies; returns the map's corners."""
    from matplotlib.transforms import Affine2D

    rows, columns = grid.shape
    width, height = columns * grid.resolution, rows * grid.resolution
    x, y, yaw = grid.origin
    usual: dict[str, Any] = {"interpolation": "nearest", "origin": "lower", "extent": (0, width, 0, height)}
    drawn = ax.imshow(image, **{**usual, **style})
    place = Affine2D().rotate(yaw).translate(x, y)
    drawn.set_transform(place + ax.transData)
    return place.transform([(0, 0), (width, 0), (0, height), (width, height)])

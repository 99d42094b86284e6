"""Figures with matplotlib."""

from typing import Any

import numpy as np
import pytest
from conftest import SCENES

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

import keyway  # noqa: E402


def test_axes_are_in_metres(scene: keyway.Scene) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1, origin=(5, -3))
    run = keyway.simulate(scene)
    figure, (first, second) = plt.subplots(1, 2)
    second.set_xlabel("east [m]")
    for ax in (first, second):
        keyway.plot(ax, grid, run, color="k")
    assert (first.get_xlabel(), first.get_ylabel()) == ("x [m]", "y [m]")
    assert (second.get_xlabel(), second.get_ylabel()) == ("east [m]", "y [m]")
    assert (first.get_xlim(), first.get_ylim()) == ((5, 13), (-3, 1))
    assert np.array_equal(first.lines[0].get_xdata(), run.trajectory["x_m"])
    with pytest.raises(TypeError, match="expected a Map, a Plan, a Run, or the path of a map file, got int"):
        keyway.plot(first, 3)  # type: ignore[arg-type]
    plt.close(figure)


@pytest.fixture()
def busy() -> keyway.Run:
    """A run among obstacles of every kind that its map does not show."""
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1, origin=(1, -2))
    scene = keyway.Scene(
        grid, (2, 0, 0), (8, 0.5, np.pi / 2),
        unknown=[
            {"position": [4, 0.1], "radius_m": 0.3},
            {"vertices_m": [[5, -1.5], [5.6, -1.4], [5.2, -0.8]]},
            {"position": [2.5, -1.5], "radius_m": 0.1, "seen": 0.5},
            {"cells": [[20, 30], [21, 30], [22, 31]]},
        ],
        moving=[{"way_points": [[6.5, -1.5], [6.5, 1.5]], "speed_mps": 0.4, "radius_m": 0.25}],
    )
    return keyway.simulate(scene)


def labels(ax: Any) -> list[str]:
    return list(ax.get_legend_handles_labels()[1])


def test_a_run_has_its_ends_and_its_obstacles(busy: keyway.Run) -> None:
    from matplotlib.patches import Circle, Polygon
    from matplotlib.quiver import Quiver

    figure, ax = plt.subplots()
    assert keyway.plot(busy.map, busy, ax=ax, color="k", label="driven") is ax
    assert {"driven", "start", "goal", "unknown obstacle", "moving obstacle"} == set(labels(ax))
    points = {line.get_label(): np.column_stack(line.get_data())[0].tolist() for line in ax.lines}
    assert points["start"] == [2, 0] and points["goal"] == [8, 0.5]
    circles = [(patch.center, patch.radius) for patch in ax.patches if isinstance(patch, Circle)]
    assert ((4, 0.1), 0.3) in circles and ((2.5, -1.5), 0.1) in circles
    path = np.column_stack([busy.moving[0][name] for name in ("x_m", "y_m", "radius_m")])
    assert path[0].tolist() == [6.5, -1.5, 0.25] and (path[:, 0] == 6.5).all() and len(path) == len(busy.trajectory)
    assert sum(center in path[:, :2].tolist() for center in (list(center) for center, _ in circles)) >= 6
    corners = [patch.get_xy()[:3].tolist() for patch in ax.patches if isinstance(patch, Polygon)]
    assert [[5, -1.5], [5.6, -1.4], [5.2, -0.8]] in corners
    # The heading of the goal is an arrow.
    arrows = [np.column_stack([arrow.U, arrow.V]).round(9).tolist() for arrow in ax.collections if isinstance(arrow, Quiver)]
    assert [[0, 1]] in arrows
    # Another run in the same axes adds no second entry to a legend.
    keyway.plot(busy, ax=ax)
    assert sorted(labels(ax)) == sorted(set(labels(ax)))
    plt.close(figure)


def test_lines_alone(busy: keyway.Run) -> None:
    figure, ax = plt.subplots()
    keyway.plot(ax, busy, details=False)
    assert (len(ax.lines), len(ax.patches), labels(ax)) == (1, 0, [])
    plt.close(figure)


def test_speed_is_a_colour(busy: keyway.Run) -> None:
    from matplotlib.collections import LineCollection

    plan = keyway.plan(busy.map, (2, 0), (8, 0.5), smoother="taut")
    figure, ax = plt.subplots()
    keyway.plot(ax, busy.map, busy, plan, speed=True, cmap="plasma", linewidth=3)
    driven, planned = (one for one in ax.collections if isinstance(one, LineCollection))
    assert driven.get_linewidth() == [3] and driven.get_cmap().name == "plasma"
    speeds = np.asarray(driven.get_array())
    assert len(speeds) == len(busy.trajectory) - 1 == len(driven.get_segments())
    assert speeds.max() == pytest.approx(busy.trajectory["v_mps"].max(), abs=0.03)
    # One scale, and one colour bar.
    assert driven.get_clim() == planned.get_clim() and driven.get_clim()[0] == 0
    assert [bar.get_ylabel() for bar in figure.axes[1:]] == ["speed [m/s]"]
    with pytest.raises(ValueError, match="choose them with cmap"):
        keyway.plot(ax, busy, speed=True, color="k")
    plt.close(figure)


def test_axes_are_given_or_current(busy: keyway.Run) -> None:
    figure, (first, second) = plt.subplots(1, 2)
    plt.sca(first)
    assert keyway.plot(SCENES / "small_house.yaml") is first and len(first.images) == 1
    assert keyway.plot(str(SCENES / "small_house.yaml"), ax=second) is second and len(second.images) == 1
    with pytest.raises(TypeError, match="the axes are given twice"):
        keyway.plot(first, busy, ax=second)
    plt.close(figure)

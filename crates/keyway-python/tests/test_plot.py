"""Figures with matplotlib."""

import numpy as np
import pytest

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
    with pytest.raises(TypeError, match="expected a Map, a Plan or a Run, got int"):
        keyway.plot(first, 3)  # type: ignore[arg-type]
    plt.close(figure)

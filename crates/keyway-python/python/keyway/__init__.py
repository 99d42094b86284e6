"""A path planner for wheeled robots: search, smoothing and local planning on occupancy grids.

Lengths are in metres, angles in radians unless a name or a text says otherwise; frames follow ROS REP 103. The same inputs
give the same results.

>>> import keyway, numpy as np
>>> occupied = np.zeros((60, 100), dtype=bool)
>>> occupied[:50, 50] = True
>>> grid = keyway.Map.from_array(occupied, resolution=0.1)
>>> plan = keyway.plan(grid, start=(1, 1), goal=(9, 4), radius=0.2, planner="jps", smoother="taut")
>>> plan.xy.shape[1], plan.xy.dtype.name
(2, 'float64')
"""

from importlib.metadata import version as _version

from keyway._keyway import (
    Comparison,
    Map,
    Navigator,
    Plan,
    Planner,
    Points,
    Run,
    Scan,
    Scene,
    Simulation,
    Step,
    batch,
    compare,
    merge,
    names,
    plan,
    plan_many,
    program,
    simulate,
    simulate_team,
)
from keyway.errors import BudgetExhausted, KeywayError, Missed, NoPath, NoRoom
from keyway.plotting import plot

__all__ = [
    "BudgetExhausted",
    "Comparison",
    "KeywayError",
    "Map",
    "Missed",
    "Navigator",
    "NoPath",
    "NoRoom",
    "Plan",
    "Planner",
    "Points",
    "Run",
    "Scan",
    "Scene",
    "Simulation",
    "Step",
    "batch",
    "compare",
    "merge",
    "names",
    "plan",
    "plan_many",
    "plot",
    "program",
    "simulate",
    "simulate_team",
]
__version__ = _version("keyway-nav")

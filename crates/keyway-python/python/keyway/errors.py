"""Exceptions. Invalid values raise a ``ValueError``, unreadable files an ``OSError``."""

__all__ = ["BudgetExhausted", "KeywayError", "Missed", "NoPath", "NoRoom"]


class KeywayError(Exception):
    """Base class: no plan was found, or a navigator refused its goal.

    >>> import keyway
    >>> issubclass(keyway.NoPath, keyway.KeywayError)
    True
    """


class NoPath(KeywayError):
    """No path exists from start to goal; the message says what separates them.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.array([[False, True, False]]), resolution=1.0)
    >>> try:
    ...     keyway.plan(grid, (0.5, 0.5), (2.5, 0.5))
    ... except keyway.NoPath as error:
    ...     print(type(error).__name__)
    NoPath
    """


class NoRoom(KeywayError):
    """Start or goal is blocked, outside the map, or too narrow for the robot.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.array([[False, True, False]]), resolution=1.0)
    >>> try:
    ...     keyway.plan(grid, (0.5, 0.5), (1.5, 0.5))
    ... except keyway.NoRoom as error:
    ...     print(type(error).__name__)
    NoRoom
    """


class Missed(KeywayError):
    """A path exists, but the planner did not find it; the message gives the reason and a remedy.

    >>> import keyway
    >>> issubclass(keyway.Missed, keyway.NoPath)
    False
    """


class BudgetExhausted(KeywayError):
    """The budget of expanded nodes was used up before a path was found.

    >>> import keyway, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((50, 50), dtype=bool), resolution=1.0)
    >>> try:
    ...     keyway.plan(grid, (0.5, 0.5), (49.5, 20.5), planner="dijkstra", budget=10)
    ... except keyway.BudgetExhausted as error:
    ...     print(error)
    no path was found within the budget of 10 expanded nodes
    """

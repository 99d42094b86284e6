"""Types of arguments and results."""

from collections.abc import Callable
from typing import TypeAlias

from keyway._keyway import Plan
from keyway.errors import KeywayError

__all__ = ["Plans", "Progress"]

#: Is called with what is done and what is expected, which may be unknown. What it raises stops the work.
Progress: TypeAlias = Callable[[int, int | None], object]

#: A plan for each query; where there is none, why.
Plans: TypeAlias = list[Plan | KeywayError]

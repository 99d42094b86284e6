"""Types of arguments and results."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeAlias

from numpy.typing import NDArray

from keyway._keyway import Plan
from keyway.errors import KeywayError

__all__ = ["LaserScan", "LaserScans", "Plans", "Progress"]

#: Called with the numbers of finished and of expected steps; the latter may be unknown. An
#: exception stops the work.
Progress: TypeAlias = Callable[[int, int | None], object]

#: A plan for each query, or the exception with the reason for its absence.
Plans: TypeAlias = list[Plan | KeywayError]


class LaserScan(Protocol):
    """A scan: a ``keyway.Scan``, or a ROS message."""

    @property
    def ranges(self) -> Sequence[float] | NDArray[Any]:
        """Ranges of all beams [m]."""

    @property
    def angle_min(self) -> float:
        """Bearing of beam 0 [rad]."""

    @property
    def angle_increment(self) -> float:
        """Bearing from one beam to the next [rad]."""


#: The scan of a robot's only sensor, or a list with one scan per sensor, ``None`` for a sensor
#: without a scan.
LaserScans: TypeAlias = LaserScan | Sequence[LaserScan | None]

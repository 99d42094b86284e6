"""A robot in a world of cells. It knows no ROS: each test tells of it in its own way."""

import math
import time
from dataclasses import dataclass

import numpy as np

RADIUS_M = 0.18
ACCELERATION_MPS2, ANGULAR_ACCELERATION_RADPS2 = 1.0, 3.0


@dataclass
class Grid:
    """Cells, row 0 at the bottom; 100 is occupied, -1 unknown. Its origin is that of the map."""

    cells: np.ndarray
    resolution_m: float
    origin: tuple[float, float] = (0.0, 0.0)

    def index(self, x, y):
        """Row and column of places, on the grid."""
        height, width = self.cells.shape
        column = np.floor((x - self.origin[0]) / self.resolution_m).astype(int)
        row = np.floor((y - self.origin[1]) / self.resolution_m).astype(int)
        return row.clip(0, height - 1), column.clip(0, width - 1)

    def touches(self, x: float, y: float, radius_m: float) -> bool:
        """Whether a disc touches an occupied cell."""
        reach = math.ceil(radius_m / self.resolution_m) + 1
        row, column = (int(value) for value in self.index(np.float64(x), np.float64(y)))
        low, left = max(row - reach, 0), max(column - reach, 0)
        near = self.cells[low : row + reach + 1, left : column + reach + 1]
        rows, columns = np.nonzero(near == 100)
        half = 0.5 * self.resolution_m
        dx = np.abs((columns + left + 0.5) * self.resolution_m + self.origin[0] - x) - half
        dy = np.abs((rows + low + 0.5) * self.resolution_m + self.origin[1] - y) - half
        return bool((np.hypot(dx.clip(0), dy.clip(0)) < radius_m).any())

    def ranges(self, x: float, y: float, bearings: np.ndarray, range_m: float) -> np.ndarray:
        """What beams meet; infinite where they meet nothing."""
        cosines, sines, coarse = np.cos(bearings), np.sin(bearings), np.arange(0.1, range_m, self.resolution_m)
        hit = self.is_met(x + np.outer(cosines, coarse), y + np.outer(sines, coarse))
        first = coarse[hit.argmax(1)]
        # Where in the last step it is met.
        fine = first[:, None] - np.linspace(self.resolution_m, 0.0, 6)[1:]
        within = self.is_met(x + cosines[:, None] * fine, y + sines[:, None] * fine)
        return np.where(hit.any(1), fine[np.arange(len(fine)), within.argmax(1)], np.inf)

    def is_met(self, x, y):
        row, column = self.index(x, y)
        return self.cells[row, column] == 100


def room() -> Grid:
    """8 m x 6 m, with a wall in the middle that leaves 2.5 m at its end."""
    cells = np.zeros((120, 160), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:70, 78:82] = 100
    return Grid(cells, 0.05)


class Body:
    """A disc that obeys its commands within its accelerations."""

    def __init__(self, grid: Grid, at: tuple[float, float, float]) -> None:
        self.grid = grid
        self.x, self.y, self.theta = at
        self.v = self.omega = 0.0
        self.command = (0.0, 0.0)
        self.commanded_at: list[float] = []
        self.contacts = 0
        self.watchdog_s = math.inf
        """It stops when no command has come for so long."""
        self.last = time.monotonic()

    def obey(self, v: float, omega: float) -> None:
        self.command = (v, omega)
        self.commanded_at.append(time.monotonic())

    def stands(self) -> bool:
        return self.v == 0.0 and self.omega == 0.0

    def step(self) -> None:
        """Moves for the time since the last step."""
        now = time.monotonic()
        passed, self.last = now - self.last, now
        if self.commanded_at and now - self.commanded_at[-1] > self.watchdog_s:
            self.command = (0.0, 0.0)
        change, turn = ACCELERATION_MPS2 * passed, ANGULAR_ACCELERATION_RADPS2 * passed
        self.v += min(max(self.command[0] - self.v, -change), change)
        self.omega += min(max(self.command[1] - self.omega, -turn), turn)
        self.x += self.v * math.cos(self.theta) * passed
        self.y += self.v * math.sin(self.theta) * passed
        self.theta += self.omega * passed
        self.contacts += self.grid.touches(self.x, self.y, RADIUS_M)

    def beams_met(self, beams: int, range_m: float) -> tuple[float, np.ndarray]:
        """The step between two beams, of which the first looks back, and what they meet."""
        step = 2 * math.pi / beams
        return step, self.grid.ranges(self.x, self.y, self.theta - math.pi + step * np.arange(beams), range_m)

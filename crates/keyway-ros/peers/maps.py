"""Maps of files, and places on them."""

import zlib
from collections import deque
from pathlib import Path

import numpy as np
from world import Grid


def read_map(path: Path) -> Grid:
    """A map server's map: YAML beside a picture, PGM or PNG of 8 bits of grey."""
    lines = (line.split("#")[0].partition(":") for line in path.read_text().splitlines())
    given = {name.strip(): value.strip().strip("\"'") for name, _, value in lines if value.strip()}
    picture = path.parent / given["image"]
    grey = (read_png if picture.suffix == ".png" else read_pgm)(picture.read_bytes())
    occupancy = grey / 255 if given["negate"] in ("1", "true") else 1 - grey / 255
    cells = np.full(grey.shape, -1, np.int8)
    cells[occupancy >= float(given["occupied_thresh"])] = 100
    cells[occupancy <= float(given["free_thresh"])] = 0
    x, y = (float(part) for part in given["origin"].strip("[]").split(",")[:2])
    return Grid(np.flipud(cells).copy(), float(given["resolution"]), (x, y))


def read_pgm(data: bytes) -> np.ndarray:
    tokens, at = [], 0
    while len(tokens) < 4:
        end = data.index(b"\n", at)
        tokens += data[at:end].split(b"#")[0].split()
        at = end + 1
    assert tokens[0] == b"P5" and tokens[3] == b"255", tokens
    width, height = int(tokens[1]), int(tokens[2])
    return np.frombuffer(data, np.uint8, width * height, at).reshape(height, width)


def read_png(data: bytes) -> np.ndarray:
    at, packed, size = 8, b"", (0, 0)
    while at < len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        part = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            size = int.from_bytes(part[:4], "big"), int.from_bytes(part[4:8], "big")
            assert part[8:10] == b"\x08\x00" and part[12] == 0, "8 bits of grey, in rows"
        elif kind == b"IDAT":
            packed += part
        at += 12 + length
    width, height = size
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, width + 1)
    picture = np.zeros((height, width), np.uint8)
    above = np.zeros(width, np.int64)
    for row, line in enumerate(rows):
        method, values = line[0], line[1:].astype(np.int64)
        if method == 2:
            values = values + above
        elif method != 0:
            for column in range(width):
                left = values[column - 1] if column else 0
                corner = above[column - 1] if column else 0
                values[column] = (values[column] + predicted(method, left, above[column], corner)) % 256
        picture[row] = above = values % 256
    return picture


def predicted(method: int, left: int, above: int, corner: int) -> int:
    if method == 1:
        return left
    if method == 3:
        return (left + above) // 2
    guess = left + above - corner
    return min((left, above, corner), key=lambda value: abs(guess - value))


def places(grid: Grid, room_m: float, count: int, near_m: float, far_m: float, seed: int) -> list[tuple[float, float]]:
    """Places with room, each between so near and so far from the one before, that can be reached from another."""
    reach = int(np.ceil(room_m / grid.resolution_m))
    wide = np.pad(grid.cells != 0, reach, constant_values=True)
    height, width = grid.cells.shape
    closed = np.zeros((height, width), bool)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            if dx * dx + dy * dy <= reach * reach:
                closed |= wide[reach + dy : reach + dy + height, reach + dx : reach + dx + width]
    largest = max_component(~closed)
    rows, columns = np.nonzero(largest)
    x = (columns + 0.5) * grid.resolution_m + grid.origin[0]
    y = (rows + 0.5) * grid.resolution_m + grid.origin[1]
    chosen, random = [], np.random.default_rng(seed)
    index = random.integers(len(x))
    while len(chosen) < count:
        chosen.append((float(x[index]), float(y[index])))
        off = np.hypot(x - x[index], y - y[index])
        index = random.choice(np.nonzero((off >= near_m) & (off <= far_m))[0])
    return chosen


def max_component(free: np.ndarray) -> np.ndarray:
    left, best = free.copy(), np.zeros_like(free)
    for row, column in zip(*np.nonzero(free)):
        if not left[row, column]:
            continue
        found, open_ = np.zeros_like(free), deque([(row, column)])
        left[row, column] = False
        found[row, column] = True
        while open_:
            y, x = open_.popleft()
            for ny, nx in ((y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)):
                if 0 <= ny < free.shape[0] and 0 <= nx < free.shape[1] and left[ny, nx]:
                    left[ny, nx] = False
                    found[ny, nx] = True
                    open_.append((ny, nx))
        if found.sum() > best.sum():
            best = found
    return best

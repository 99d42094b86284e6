"""A gymnasium environment; gymnasium must be installed.

A robot drives to the goal of a scene: it observes a laser scan and commands velocities. Two environments of the same scene and
seed are the same.

>>> import gymnasium, keyway, keyway.gym, numpy as np
>>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
>>> env = keyway.gym.Drive(keyway.Scene(grid, (1, 2), (7, 2)))
>>> observation, info = env.reset(seed=1)
>>> sorted(observation), observation["ranges"].shape
(['goal', 'ranges', 'velocity'], (360,))
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from keyway._keyway import Scene, Simulation
from keyway._viewing import Picture, Window

if TYPE_CHECKING:
    import gymnasium

    Base = gymnasium.Env[dict[str, NDArray[np.float32]], NDArray[np.float32]]
else:
    try:
        import gymnasium

        Base = gymnasium.Env
    except ImportError:
        gymnasium = None
        Base = object

__all__ = ["Drive"]

#: Seeds of scenes are drawn below this.
_SEEDS = 2**32
#: Bound of the distance to the goal [m].
_FARTHEST = 1e5


def _listed(given: Scene | str | os.PathLike[str] | Sequence[Scene | str | os.PathLike[str]]) -> list[Scene]:
    """Returns scenes, read from their files where paths are given."""
    one_or_all: Any = given
    items = [one_or_all] if isinstance(one_or_all, (Scene, str, os.PathLike)) or not hasattr(one_or_all, "__iter__") else list(one_or_all)
    scenes = []
    for item in items:
        if isinstance(item, (str, os.PathLike)):
            scenes.append(Scene.read(item))
        elif isinstance(item, Scene):
            scenes.append(item)
        else:
            raise TypeError(f"scenes: expected a Scene, a path of a scene file, or a list of them, got {type(item).__name__}")
    if not scenes:
        raise ValueError("scenes: expected at least one")
    return scenes


class Drive(Base):
    """A robot in the worlds of scenes.

    Observation: ``ranges`` [m], one for each beam of the robot's sensor, the sensor's range where nothing was met (``bearings``
    says where the beams look); ``goal``, its distance [m] and its bearing [rad], positive to the left; ``velocity`` [m/s, rad/s].

    Action: the velocity (v, omega) to drive towards in the next cycle [m/s, rad/s], within the robot's limits; its accelerations
    are those that the robot can do. With ``normalized``, both numbers are from -1 to 1 instead, from the lowest to the highest
    velocity.

    Reward: the metres that the robot came nearer to the goal, ``reached`` when it is there, ``collided`` when it touches something.
    An episode ends with one of these two; it is truncated when the robot is stuck or the time limit of the scene has passed.

    All scenes have the same robot. Each reset draws one of them, and a seed for it where ``is_random`` says that another seed is another world. Draws follow
    from the seed of ``reset``.

    ``render_mode`` is ``rgb_array``, with which ``render`` returns a picture as an array of uint8 of shape (rows, columns, 3), or
    ``human``, with which a window of matplotlib shows every step, no faster than in reality. Both show the map, the robot, the hits of
    its scan, its goal, and the obstacles that the map does not show.

    >>> import keyway, keyway.gym, numpy as np
    >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    >>> env = keyway.gym.Drive(keyway.Scene(grid, (1, 2), (7, 2)))
    >>> observation, info = env.reset(seed=1)
    >>> total, is_over = 0.0, False
    >>> while not is_over:
    ...     observation, reward, terminated, truncated, info = env.step(np.array([0.5, observation["goal"][1]], dtype=np.float32))
    ...     total, is_over = total + reward, terminated or truncated
    >>> info["outcome"], total > 10
    ('reached', True)
    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 10}

    def __init__(
        self,
        scenes: Scene | str | os.PathLike[str] | Sequence[Scene | str | os.PathLike[str]],
        reached: float = 10.0,
        collided: float = -10.0,
        render_mode: str | None = None,
        normalized: bool = False,
    ) -> None:
        if gymnasium is None:
            raise ImportError("keyway.gym needs gymnasium: pip install keyway-nav[gym]")
        modes = self.metadata["render_modes"]
        if render_mode is not None and render_mode not in modes:
            raise ValueError(f"render_mode: expected one of {', '.join(modes)}, or None, got {render_mode!r}")
        if render_mode is not None:
            _check_matplotlib()
        self.render_mode = render_mode
        self._picture: Picture | None = None
        self._window: Window | None = None
        self._scenes = _listed(scenes)
        self._is_reset = False
        robots = sorted({scene.robot for scene in self._scenes})
        if len(robots) > 1:
            raise ValueError(f"scenes: expected the same robot in all of them, got {', '.join(robots)}")
        self._rewards = {"reached": reached, "collided": collided}
        self._simulation = Simulation(self._scenes[0])
        #: Bearings of the beams [rad], 0 straight ahead, positive to the left.
        self.bearings: NDArray[np.float64] = self._simulation.scan.bearings
        self.metadata = {**self.metadata, "render_fps": max(1, round(1 / self._simulation.cycle))}
        self._distance = 0.0
        low, high = (np.array(limit, dtype=np.float32) for limit in self._simulation.limits)
        beams, reach = len(self._simulation.scan), self._simulation.range
        # Noise may add to velocities.
        fastest = 2 * np.maximum(abs(low), abs(high))
        space: Any = gymnasium.spaces.Dict(
            {
                "ranges": gymnasium.spaces.Box(0.0, reach, (beams,), np.float32),
                "goal": gymnasium.spaces.Box(
                    np.array([0, -np.pi], dtype=np.float32), np.array([_FARTHEST, np.pi], dtype=np.float32)
                ),
                "velocity": gymnasium.spaces.Box(-fastest, fastest, dtype=np.float32),
            }
        )
        self._fastest = fastest
        self.observation_space = space
        self._range = (low, high) if normalized else None
        if normalized:
            low, high = -np.ones(2, dtype=np.float32), np.ones(2, dtype=np.float32)
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[np.float32]], dict[str, Any]]:
        """Draws a world, puts the robot at its start, and returns the first observation.

        >>> import keyway, keyway.gym, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> env = keyway.gym.Drive(keyway.Scene(grid, (1, 2), (7, 2)))
        >>> env.reset(seed=1)[0]["goal"].tolist()
        [6.0, 0.0]
        """
        super().reset(seed=seed)
        scene = self._scenes[int(self.np_random.integers(len(self._scenes)))]
        if scene.is_random:
            scene = scene.replace(seed=int(self.np_random.integers(_SEEDS)))
        self._simulation, self._picture, self._is_reset = Simulation(scene), None, True
        observation = self._observation()
        self._distance = float(observation["goal"][0])
        self._show()
        return observation, {"seed": scene.seed, "outcome": self._simulation.outcome}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[dict[str, NDArray[np.float32]], float, bool, bool, dict[str, Any]]:
        """Drives one control cycle and returns the observation, the reward, the flags terminated and truncated, and the info.

        >>> import keyway, keyway.gym, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> env = keyway.gym.Drive(keyway.Scene(grid, (1, 2), (7, 2)))
        >>> _ = env.reset(seed=1)
        >>> env.step(np.array([0.5, 0.0], dtype=np.float32))[2:]
        (False, False, {'outcome': None})
        """
        action = np.asarray(action)
        if action.shape != (2,):
            raise ValueError(f"action: expected (v, omega), got an array of shape {action.shape}")
        if not self._is_reset:
            raise gymnasium.error.ResetNeeded("call reset() before the first step()")
        if not np.isfinite(action).all():
            raise ValueError(f"action: expected finite numbers, got {action.tolist()}")
        if self._range is not None:
            low, high = self._range
            action = low + (action + 1) / 2 * (high - low)
        outcome = self._simulation.step(float(action[0]), float(action[1]))
        observation = self._observation()
        distance = float(observation["goal"][0])
        reward = self._distance - distance + self._rewards.get(outcome or "", 0.0)
        self._distance = distance
        self._show()
        terminated = outcome in self._rewards
        return observation, reward, terminated, outcome is not None and not terminated, {"outcome": outcome}

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override,unused-ignore]
        """Returns the picture of this cycle with ``rgb_array``; with ``human``, draws the window again.

        >>> import keyway, keyway.gym, numpy as np
        >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
        >>> env = keyway.gym.Drive(keyway.Scene(grid, (1, 2), (7, 2)), render_mode="rgb_array")
        >>> _ = env.reset(seed=1)
        >>> env.render().shape
        (320, 640, 3)
        """
        if self.render_mode == "human":
            self._show()
        if self.render_mode != "rgb_array":
            return None
        if self._picture is None:
            self._picture = Picture.of(self._simulation)
        return self._picture.pixels()

    def close(self) -> None:
        """Closes the window, if there is one."""
        self._picture = None
        if self._window is not None:
            self._window.close()
            self._window = None

    def _show(self) -> None:
        """Updates the window."""
        if self.render_mode == "human":
            self._window = self._window or Window()
            self._window.draw(self._simulation, self._simulation.cycle)

    def _observation(self) -> dict[str, NDArray[np.float32]]:
        simulation = self._simulation
        x, y, theta = simulation.pose
        goal_x, goal_y = simulation.goal
        dx, dy = goal_x - x, goal_y - y
        bearing = np.arctan2(dy, dx) - theta
        bearing = (bearing + np.pi) % (2 * np.pi) - np.pi
        # A beam that says nothing, which is NaN or 0, says nothing of an obstacle.
        ranges = simulation.scan.ranges
        ranges = np.where(ranges > 0.0, ranges, simulation.range)
        return {
            "ranges": np.clip(ranges, 0.0, simulation.range).astype(np.float32),
            "goal": np.array([min(np.hypot(dx, dy), _FARTHEST), bearing], dtype=np.float32),
            "velocity": np.array(simulation.velocity, dtype=np.float32).clip(-self._fastest, self._fastest),
        }


def _check_matplotlib() -> None:
    try:
        import matplotlib  # noqa: F401
    except ImportError as error:
        raise ImportError("rendering needs matplotlib: pip install keyway-nav[plot]") from error

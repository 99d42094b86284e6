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

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from keyway._keyway import Scene, Simulation

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


class Drive(Base):
    """A robot in the worlds of scenes.

    Observation: ``ranges`` [m], one for each beam of the robot's sensor, the sensor's range where nothing was met (``bearings``
    says where the beams look); ``goal``, its distance [m] and its bearing [rad], positive to the left; ``velocity`` [m/s, rad/s].

    Action: the velocity (v, omega) to drive towards in the next cycle [m/s, rad/s], within the robot's limits; its accelerations
    are those that the robot can do.

    Reward: the metres that the robot came nearer to the goal, ``reached`` when it is there, ``collided`` when it touches something.
    An episode ends with one of these two; it is truncated when the robot is stuck or the time limit of the scene has passed.

    All scenes have the same robot. Each reset draws one of them, and a seed for it where ``is_random`` says that another seed is another world. Draws follow
    from the seed of ``reset``.

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

    metadata = {"render_modes": []}

    def __init__(
        self,
        scenes: Scene | Sequence[Scene],
        reached: float = 10.0,
        collided: float = -10.0,
        render_mode: None = None,
    ) -> None:
        if gymnasium is None:
            raise ImportError("keyway.gym needs gymnasium: pip install keyway-nav[gym]")
        self.render_mode = render_mode
        self._scenes = [scenes] if isinstance(scenes, Scene) else list(scenes)
        if not self._scenes:
            raise ValueError("scenes: expected at least one")
        robots = sorted({scene.robot for scene in self._scenes})
        if len(robots) > 1:
            raise ValueError(f"scenes: expected the same robot in all of them, got {', '.join(robots)}")
        self._rewards = {"reached": reached, "collided": collided}
        self._simulation = Simulation(self._scenes[0])
        #: Bearings of the beams [rad], 0 straight ahead, positive to the left.
        self.bearings: NDArray[np.float64] = self._simulation.scan.bearings
        self._distance = 0.0
        low, high = (np.array(limit, dtype=np.float32) for limit in self._simulation.limits)
        beams, reach = len(self._simulation.scan), self._simulation.range
        # Noise may add to ranges and velocities.
        space: Any = gymnasium.spaces.Dict(
            {
                "ranges": gymnasium.spaces.Box(0.0, reach, (beams,), np.float32),
                "goal": gymnasium.spaces.Box(
                    np.array([0, -np.pi], dtype=np.float32), np.array([np.inf, np.pi], dtype=np.float32)
                ),
                "velocity": gymnasium.spaces.Box(-np.inf, np.inf, (2,), np.float32),
            }
        )
        self.observation_space = space
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
        self._simulation = Simulation(scene)
        observation = self._observation()
        self._distance = float(observation["goal"][0])
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
        outcome = self._simulation.step(float(action[0]), float(action[1]))
        observation = self._observation()
        distance = float(observation["goal"][0])
        reward = self._distance - distance + self._rewards.get(outcome or "", 0.0)
        self._distance = distance
        terminated = outcome in self._rewards
        return observation, reward, terminated, outcome is not None and not terminated, {"outcome": outcome}

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
            "goal": np.array([np.hypot(dx, dy), bearing], dtype=np.float32),
            "velocity": np.array(simulation.velocity, dtype=np.float32),
        }

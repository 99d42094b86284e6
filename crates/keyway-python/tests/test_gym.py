"""The environment of gymnasium: its checker passes, and a seed is a world."""

import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

import keyway  # noqa: E402
import keyway.gym  # noqa: E402


@pytest.fixture()
def noisy() -> keyway.Scene:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    return keyway.Scene(grid, (1, 2), (7, 2), disturbances={"sensor": {"range_m": 0.02}})


def test_the_checker_of_gymnasium_passes(scene: keyway.Scene, noisy: keyway.Scene) -> None:
    from gymnasium.utils.env_checker import check_env

    for scenes in (scene, [scene, noisy]):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", message=".*(infinity|different from the unwrapped|spec|symmetric and normalized).*")
            check_env(keyway.gym.Drive(scenes), skip_render_check=True)


def test_the_same_seed_is_the_same_episode(noisy: keyway.Scene) -> None:
    def episode(seed: int) -> list[float]:
        env = keyway.gym.Drive(noisy)
        observation, info = env.reset(seed=seed)
        numbers, is_over = [float(info["seed"])], False
        env.action_space.seed(seed)
        while not is_over:
            action = np.array([0.3, env.action_space.sample()[1] / 4], dtype=np.float32)
            observation, reward, terminated, truncated, info = env.step(action)
            numbers += [reward, *observation["ranges"][::40].tolist(), *observation["goal"].tolist()]
            is_over = terminated or truncated
        return numbers

    assert episode(1) == episode(1)
    assert episode(1)[:30] != episode(2)[:30]


def test_a_beam_that_says_nothing_shows_no_obstacle() -> None:
    grid = keyway.Map.from_array(np.pad(np.zeros((38, 78), dtype=bool), 1, constant_values=True), resolution=0.1)
    # Some ranges are off by more than they are long: the sensor then says 0.
    scene = keyway.Scene(grid, (1, 2), (7, 2), disturbances={"sensor": {"range_m": 1.0}})
    env = keyway.gym.Drive(scene)
    observation, _ = env.reset(seed=0)
    for _ in range(10):
        assert observation["ranges"].min() > 0.0
        observation, *_ = env.step(np.array([0.0, 0.3], dtype=np.float32))


@pytest.mark.parametrize(("speed", "turn", "outcome", "last"), [(0.5, 0.0, "collided", -10), (0.0, 0.0, "stuck", 0)])
def test_how_an_episode_ends(scene: keyway.Scene, speed: float, turn: float, outcome: str, last: float) -> None:
    env = keyway.gym.Drive(scene)
    observation, _ = env.reset(seed=0)
    way = float(observation["goal"][0])
    total, is_over = 0.0, False
    while not is_over:
        observation, reward, terminated, truncated, info = env.step(np.array([speed, turn], dtype=np.float32))
        total += reward
        assert env.observation_space.contains(observation)
        is_over = terminated or truncated
    assert info["outcome"] == outcome and terminated == (outcome == "collided")
    assert total == pytest.approx(way - float(observation["goal"][0]) + last, abs=1e-4)
    with pytest.raises(ValueError, match="scenes: expected at least one"):
        keyway.gym.Drive([])


def test_what_an_environment_refuses(scene: keyway.Scene) -> None:
    with pytest.raises(ValueError, match="expected the same robot in all of them, got jackal, small"):
        keyway.gym.Drive([scene, scene.replace(robot="jackal")])
    env = keyway.gym.Drive(scene)
    env.reset(seed=0)
    for action in ([0.1], np.zeros((2, 2)), None, [0.1, 0.2, 0.3]):
        with pytest.raises(ValueError, match=r"action: expected \(v, omega\), got an array of shape"):
            env.step(action)  # type: ignore[arg-type]


def test_environments_run_in_other_processes(scene: keyway.Scene) -> None:
    envs = gymnasium.vector.AsyncVectorEnv([lambda: keyway.gym.Drive(scene)] * 2, context="spawn")
    observations, _ = envs.reset(seed=[1, 1])
    assert observations["ranges"].shape == (2, 360)
    envs.close()

"""The environment of gymnasium: its checker passes, and a seed is a world."""

import pathlib
import warnings
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

gymnasium = pytest.importorskip("gymnasium")
matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

import keyway  # noqa: E402
import keyway.gym  # noqa: E402


@pytest.fixture()
def noisy() -> keyway.Scene:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    return keyway.Scene(grid, (1, 2), (7, 2), disturbances={"sensor": {"range_m": 0.02}})


def test_the_checker_of_gymnasium_passes(scene: keyway.Scene, noisy: keyway.Scene) -> None:
    from gymnasium.utils.env_checker import check_env

    for number, scenes in enumerate((scene, [scene, noisy])):
        name = f"KeywayDrive{number}-v0"
        gymnasium.register(name, keyway.gym.Drive, kwargs={"scenes": scenes, "normalized": True})
        for mode in (None, "rgb_array"):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                # Tests have no window.
                warnings.filterwarnings("ignore", message="the backend `agg` of matplotlib opens no window")
                check_env(gymnasium.make(name, render_mode=mode).unwrapped)
                # The recommendation of numbers from -1 to 1 is the only thing that it says of
                # velocities.
                warnings.filterwarnings("ignore", message=".*symmetric and normalized")
                check_env(gymnasium.make(name, render_mode=mode, normalized=False).unwrapped)


def test_normalized_actions_are_the_same_velocities(scene: keyway.Scene) -> None:
    plain, normalized = keyway.gym.Drive(scene), keyway.gym.Drive(scene, normalized=True)
    spaces: list[Any] = [plain.action_space, normalized.action_space]
    low, high = spaces[0].low, spaces[0].high
    assert spaces[1].low.tolist() == [-1, -1] and spaces[1].high.tolist() == [1, 1]
    for env in (plain, normalized):
        env.reset(seed=0)
    for share in (np.array([1.0, 0.5]), np.array([0.25, 0.75]), np.array([0.0, 0.0])):
        first = plain.step((low + share * (high - low)).astype(np.float32))
        second = normalized.step((2 * share - 1).astype(np.float32))
        assert np.allclose(first[0]["velocity"], second[0]["velocity"], atol=1e-6)


def test_a_picture_shows_the_world(scene: keyway.Scene) -> None:
    env = keyway.gym.Drive(scene, render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    assert first is not None and first.shape == (320, 640, 3) and first.dtype == np.uint8

    def is_near(pixels: NDArray[np.uint8], x: float, y: float, color: tuple[int, int, int]) -> bool:
        """True if some of the pixels within 0.2 m have this colour."""
        row, column = round(320 - 80 * y), round(80 * x)
        window = pixels[row - 16 : row + 16, column - 16 : column + 16].astype(int)
        return bool((np.abs(window - color).max(axis=2) < 40).any())

    orange, cyan, red, white = (255, 127, 14), (23, 190, 207), (214, 39, 40), (255, 255, 255)
    assert is_near(first, 1, 2, cyan) and is_near(first, 7, 2, red) and is_near(first, 4, 2.1, orange)
    assert (first[20:60, 20:60] == white).all()
    for _ in range(40):
        env.step(np.array([0.5, 0.0], dtype=np.float32))
    later = env.render()
    assert later is not None and not is_near(later, 1, 2, cyan) and is_near(later, env._simulation.true_pose[0], 2, cyan)
    # The picture that was given does not change, and a new episode has its own.
    assert is_near(first, 1, 2, cyan)
    env.reset(seed=0)
    again = env.render()
    assert again is not None and np.array_equal(again, first)
    env.close()
    assert keyway.gym.Drive(scene).render() is None


def test_a_picture_shows_moving_obstacles() -> None:
    grid = keyway.Map.from_array(np.zeros((80, 40), dtype=bool), resolution=0.1)
    moving = [{"way_points": [[1, 6], [3, 6]], "speed_mps": 0.5, "radius_m": 0.3}]
    unknown = [{"vertices_m": [[1, 1], [3, 1], [3, 1.3]]}, {"cells": [[20, 40], [21, 40], [22, 41]]}]
    env = keyway.gym.Drive(keyway.Scene(grid, (2, 2), (2, 7, 1.5), moving=moving, unknown=unknown), render_mode="rgb_array")
    env.reset(seed=0)
    pictures: list[Any] = []
    for _ in range(2):
        pictures.append(env.render())
        for _ in range(10):
            env.step(np.zeros(2, dtype=np.float32))
    assert pictures[0].shape == (640, 320, 3)
    assert not np.array_equal(pictures[0], pictures[1])


def test_a_window_is_drawn_at_every_step(scene: keyway.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib.pyplot as plt

    with pytest.warns(UserWarning, match="the backend `agg` of matplotlib opens no window"):
        env = keyway.gym.Drive(scene, render_mode="human")
        env.reset(seed=0)
    assert env._window is not None and env.metadata["render_fps"] == 10
    number = env._window._figure.number
    drawn: list[object] = []
    monkeypatch.setattr(plt.figure(number).canvas, "draw_idle", lambda: drawn.append(1))
    for _ in range(3):
        env.step(np.array([0.5, 0.0], dtype=np.float32))
    assert len(drawn) == 3 and env.render() is None and len(drawn) == 4
    # With a window, each step takes as long as in reality.
    shown: list[object] = []
    monkeypatch.setattr(env._window, "_is_shown", True)
    monkeypatch.setattr(plt, "show", lambda block: shown.append(block))
    monkeypatch.setattr(plt.figure(number).canvas, "start_event_loop", shown.append)
    env.step(np.array([0.5, 0.0], dtype=np.float32))
    assert shown == [False, 0.1]
    # Whoever closes the window goes on without.
    plt.close(number)
    env.step(np.array([0.5, 0.0], dtype=np.float32))
    env.close()
    env.close()
    assert not plt.fignum_exists(number)


@pytest.mark.parametrize("mode", ["ansi", "", 3])
def test_unknown_modes_are_refused(scene: keyway.Scene, mode: Any) -> None:
    with pytest.raises(ValueError, match="render_mode: expected one of human, rgb_array, or None, got "):
        keyway.gym.Drive(scene, render_mode=mode)


def test_observations_are_bounded(noisy: keyway.Scene) -> None:
    env = keyway.gym.Drive(noisy)
    spaces: Any = env.observation_space
    for space in spaces.values():
        assert np.isfinite(space.low).all() and np.isfinite(space.high).all()


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


def test_scenes_are_given_or_read(scene: keyway.Scene, tmp_path: pathlib.Path) -> None:
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    grid.write(tmp_path / "empty.map")
    (tmp_path / "scene.toml").write_text('version = 2\nmap = "empty.map"\nstart = [5.5, 5.5]\ngoal = [15.5, 5.5]\n')
    for given in (tmp_path / "scene.toml", str(tmp_path / "scene.toml"), [tmp_path / "scene.toml"]):
        assert keyway.gym.Drive(given).reset(seed=0)[0]["goal"][0] == pytest.approx(10.0)
    for wrong, got in ((3, "int"), (grid, "Map"), ([scene, None], "NoneType")):
        with pytest.raises(TypeError, match=f"scenes: expected a Scene, a path of a scene file, or a list of them, got {got}"):
            keyway.gym.Drive(wrong)  # type: ignore[arg-type]


def test_an_environment_is_reset_first(scene: keyway.Scene) -> None:
    env = keyway.gym.Drive(scene)
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset"):
        env.step(np.zeros(2, dtype=np.float32))
    env.reset(seed=0)
    with pytest.raises(ValueError, match="action: expected finite numbers"):
        env.step(np.array([np.nan, 0.0], dtype=np.float32))


def test_environments_run_in_other_processes(scene: keyway.Scene) -> None:
    envs = gymnasium.vector.AsyncVectorEnv([lambda: keyway.gym.Drive(scene)] * 2, context="spawn")
    observations, _ = envs.reset(seed=[1, 1])
    assert observations["ranges"].shape == (2, 360)
    envs.close()

"""Maps from arrays and files."""

import copy
import multiprocessing
import pathlib
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import SCENES
from numpy.typing import NDArray

import keyway


@pytest.mark.parametrize("layout", ["c", "fortran", "reversed", "strided", "read-only"])
def test_any_layout_gives_the_same_map(clutter: NDArray[np.bool_], layout: str) -> None:
    wide = np.zeros((60, 80), dtype=bool)
    wide[::2, ::2] = clutter
    frozen = clutter.copy()
    frozen.flags.writeable = False
    same = {
        "c": clutter,
        "fortran": np.asfortranarray(clutter),
        "reversed": clutter[::-1, ::-1].copy()[::-1, ::-1],
        "strided": wide[::2, ::2],
        "read-only": frozen,
    }[layout]
    grid = keyway.Map.from_array(same, resolution=0.5)
    assert np.array_equal(grid.occupied, clutter)
    assert grid.shape == clutter.shape
    assert grid.digest == keyway.Map.from_array(clutter, resolution=0.5).digest


def test_occupancy_is_read_as_nav2_saves_it() -> None:
    values = np.array([[-1, 0, 25, 26, 64, 65, 90, 100], [-128, 1, 127, 101, 50, 99, 25, 100]], dtype=np.int8)
    grid = keyway.Map.from_array(values, resolution=1.0)
    assert grid.occupancy.tolist() == [[-1, 0, 0, -1, -1, 100, 100, 100], [-1, 0, -1, -1, -1, 100, 0, 100]]
    assert np.array_equal(grid.occupied, grid.occupancy == 100) and np.array_equal(grid.unknown, grid.occupancy < 0)
    other = keyway.Map.from_array(values, resolution=1.0, occupied_threshold=100, free_threshold=99)
    assert other.occupancy.tolist() == [[-1, 0, 0, 0, 0, 0, 0, 100], [-1, 0, -1, -1, 0, 0, 0, 100]]
    again = keyway.Map.from_array(grid.occupancy, resolution=1.0)
    assert again.digest == grid.digest


def test_a_map_that_is_silently_free_is_refused(tmp_path: pathlib.Path) -> None:
    mask = np.eye(3, dtype=np.int8)
    with pytest.raises(ValueError, match="largest occupancy is 1 of 100.* type bool"):
        keyway.Map.from_array(mask, resolution=1.0)
    assert keyway.Map.from_array(mask.astype(bool), resolution=1.0).occupied.sum() == 3
    for empty in (0 * mask, 0 * mask - 1, np.array([[-1, 0]], dtype=np.int8)):
        assert not keyway.Map.from_array(empty, resolution=1.0).occupied.any()
    with pytest.raises(ValueError, match="free threshold below it, got 25 and 65"):
        keyway.Map.from_array(mask, resolution=1.0, occupied_threshold=25, free_threshold=65)
    with pytest.raises(TypeError, match="resolution"):
        keyway.Map.from_array(mask.astype(bool))  # type: ignore[call-arg]
    # A file of somebody else's is read, with a warning.
    (tmp_path / "mask.pgm").write_bytes(b"P5 2 1 255\n\x00\x01")
    text = "image: mask.pgm\nmode: raw\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    (tmp_path / "mask.yaml").write_text(text)
    with pytest.warns(UserWarning, match="largest occupancy is 1 of 100"):
        grid = keyway.Map.read(tmp_path / "mask.yaml")
    assert copy.copy(grid).digest == grid.digest


def test_row_0_is_at_the_bottom() -> None:
    occupied = np.zeros((2, 3), dtype=bool)
    occupied[0, 2] = True
    grid = keyway.Map.from_array(occupied, resolution=0.5, origin=(-1, 4))
    assert grid.cells([(0.25, 4.25), (-0.75, 4.75)]).tolist() == [[2, 0], [0, 1]]
    assert grid.free_positions().tolist() == [
        [-0.75, 4.25], [-0.25, 4.25], [-0.75, 4.75], [-0.25, 4.75], [0.25, 4.75]
    ]
    turned = keyway.Map.from_array(occupied, resolution=1.0, origin=(0, 0, np.pi / 2))
    assert turned.cells([(-0.5, 2.5)]).tolist() == [[2, 0]]
    assert turned.origin == (0.0, 0.0, np.pi / 2)


def test_files_are_read_and_written(house: keyway.Map, tmp_path: pathlib.Path) -> None:
    assert (house.resolution, house.shape[0] > 100) == (0.05, True)
    house.write(tmp_path / "house.yaml")
    again = keyway.Map.read(tmp_path / "house.yaml")
    assert again.digest == house.digest
    with pytest.raises(ValueError, match="expected a file name that ends in"):
        house.write(tmp_path / "house.tiff")
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(OSError, match="it is a folder"):
        keyway.Map.read(tmp_path / "folder.yaml")
    with pytest.raises(ValueError, match="already contains the map's resolution"):
        keyway.Map.read(SCENES / "small_house.yaml", resolution=0.1)
    rooms = keyway.Map.read(SCENES / "rooms.map", resolution=0.5, origin=(1, 2))
    assert (rooms.resolution, rooms.origin) == (0.5, (1.0, 2.0, 0.0))


def test_what_is_wrong_with_a_file_is_said(tmp_path: pathlib.Path) -> None:
    (tmp_path / "bad.map").write_text("type octile\nheight 2\nwidth 2\nmap\n..\n")
    with pytest.raises(ValueError, match=r"bad\.map: "):
        keyway.Map.read(tmp_path / "bad.map")
    with pytest.raises(ValueError, match=r"larger than the limit of 9 cells; .* with keyway.Map.read\(path, max_cells=\d+\)$"):
        keyway.Map.read(SCENES / "rooms.map", max_cells=9)
    with pytest.raises(ValueError, match="no cells|at least one"):
        keyway.Map.from_array(np.zeros((0, 5), dtype=bool), resolution=1.0)
    with pytest.raises(ValueError, match="resolution|side"):
        keyway.Map.from_array(np.zeros((5, 5), dtype=bool), resolution=0.0)
    with pytest.raises(TypeError, match=r"an array of float64 of shape \(2,\)"):
        keyway.Map.from_array(np.zeros(2), resolution=1.0)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"an array of uint8 of shape \(2, 2\)"):
        keyway.Map.from_array(np.zeros((2, 2), dtype=np.uint8), resolution=1.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"positions\[1\] \(9, 9\) is outside the map"):
        keyway.Map.from_array(np.zeros((5, 5), dtype=bool), resolution=1.0).cells([(1, 1), (9, 9)])


def test_a_usual_mistake_is_a_warning() -> None:
    image = SCENES / "small_house.png"
    with pytest.warns(UserWarning, match="small_house.png"):
        assert keyway.Map.read(image).resolution == 1.0
    assert keyway.Map.read(image, resolution=0.05).resolution == 0.05


def test_pictures(rooms: keyway.Map) -> None:
    assert rooms._repr_svg_().startswith("<svg")
    assert rooms._repr_png_().startswith(b"\x89PNG")
    assert repr(rooms).startswith("<keyway.Map ")


def test_maps_and_scenes_go_to_other_processes(house: keyway.Map, scene: keyway.Scene) -> None:
    values = keyway.Map.from_array(np.array([[-1, 0, 30, 99, 100]], dtype=np.int8), resolution=0.5, origin=(1, 2, 0.3), occupied_threshold=100)
    placed = keyway.Map.read(SCENES / "rooms.map", resolution=0.5, origin=(1, 2))
    for grid in (house, values, placed):
        for again in (pickle.loads(pickle.dumps(grid)), copy.copy(grid), copy.deepcopy(grid)):
            assert (again.digest, again.origin, repr(again)) == (grid.digest, grid.origin, repr(grid))
    inputs = [keyway.simulate(keyway.Scene(grid, (3, 4), (4, 4.5))).report["inputs"] for grid in (placed, pickle.loads(pickle.dumps(placed)))]
    assert inputs[0] == inputs[1] and inputs[0]["placement"] and "rooms.map" in inputs[0]["map"]
    file = keyway.Scene.read(SCENES / "small_house.toml")
    for one in (scene, file, scene.replace(seed=9)):
        again = copy.deepcopy(pickle.loads(pickle.dumps(one)))
        assert again.to_toml() == one.to_toml()
        assert keyway.simulate(again).report == keyway.simulate(one).report
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(repr, (scene,)) == repr(scene)
    with pytest.raises(TypeError, match="cannot pickle"):
        pickle.dumps(keyway.Planner(house))


def test_a_position_far_away_is_short() -> None:
    with pytest.raises(ValueError, match=r"positions\[0\] \(1e300, 1e0\) is outside"):
        keyway.Map.from_array(np.zeros((5, 5), dtype=bool), resolution=1.0).cells([(1e300, 1)])


def test_a_path_stands_for_its_map(house: keyway.Map) -> None:
    file = SCENES / "small_house.yaml"
    ends = (-8.175, -2.825), (8.725, 0.875)
    expected = keyway.plan(house, *ends, radius=0.2)
    for path in (file, str(file)):
        assert keyway.plan(path, *ends, radius=0.2).cost == expected.cost
        (several,) = keyway.plan_many(path, [ends[0]], [ends[1]], radius=0.2)
        assert isinstance(several, keyway.Plan) and several.cost == expected.cost
        assert keyway.Planner(path, radius=0.2).plan(*ends).cost == expected.cost
        navigator = keyway.Navigator(path)
        assert navigator.map.digest == house.digest
        compared = keyway.compare(path, planners=["jps"], smoothers=["none"], queries=3, times=False)
        assert compared.rows == keyway.compare(house, planners=["jps"], smoothers=["none"], queries=3, times=False).rows
        assert repr(keyway.Scene(path, *ends)) == repr(keyway.Scene(house, *ends))
        free = keyway.Navigator(keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.05))
        free.set_map(path)
        assert free.map.digest == house.digest
        free.edit_map(path)
        free.set_masks(keep_out=path, slow=(path, 0.2))
    with pytest.warns(UserWarning, match=r"small_house.png.*; set it with keyway.Map.read\(path, resolution=...\), or use"):
        keyway.Navigator(SCENES / "small_house.png")


def test_what_is_no_map_is_named() -> None:
    with pytest.raises(FileNotFoundError, match="cannot read nowhere.yaml: there is no such file or folder"):
        keyway.plan("nowhere.yaml", (1, 1), (2, 2))
    calls: list[Callable[[Any], object]] = [
        lambda wrong: keyway.plan(wrong, (1, 1), (2, 2)), keyway.Planner, keyway.Navigator, keyway.compare,
        lambda wrong: keyway.Scene(wrong, (1, 1), (2, 2)),
    ]
    for call in calls:
        for wrong, got in ((3, "int"), (None, "NoneType"), (np.zeros((2, 3)), r"an array of float64 of shape \(2, 3\)")):
            with pytest.raises(TypeError, match=f"^expected a keyway.Map, or the path of a map file, got {got}"):
                call(wrong)
    with pytest.raises(TypeError, match=r"array .*: Map.from_array makes a map of an array"):
        keyway.plan(np.zeros((2, 3), dtype=bool), (1, 1), (2, 2))  # type: ignore[arg-type]

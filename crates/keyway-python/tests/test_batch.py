"""Comparisons and batches: the same as those of the program, byte for byte; on a cluster of Ray, too."""

import json
import pathlib
import pickle
import subprocess
import sys
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import REPOSITORY, SCENES

import keyway

KEYWAY = [sys.executable, "-m", "keyway"]
#: Measured by a clock, or names of places.
NOT_THE_SAME = {"times.jsonl", "part.json"}


def results(folder: pathlib.Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and not path.name.startswith("."))
    return {path.name: path.read_bytes() for path in files if path.name not in NOT_THE_SAME}


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """Two scenes, of which one has something random."""
    folder = tmp_path_factory.mktemp("scenes")
    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    grid.write(folder / "room.yaml")
    text = 'version = 2\nmap = "room.yaml"\nstart = [1, 2]\ngoal = [4, 2]\n'
    (folder / "a.toml").write_text(text.replace("[4, 2]", "[3, 3]"))
    (folder / "b.toml").write_text(text + "[disturbances.sensor]\nrange_m = 0.02\n")
    return folder


@pytest.fixture(scope="module")
def expected(scenes: pathlib.Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What the program makes of them."""
    out = tmp_path_factory.mktemp("expected") / "out"
    words = [*KEYWAY, "batch", str(scenes), "--stacks", "key-point-fusion,dwa-to-goal", "--seeds", "2", "--out", str(out)]
    subprocess.run(words, check=True, capture_output=True)
    return results(out)


@pytest.mark.filterwarnings("ignore:a. nothing in it is random")
def test_a_batch_is_that_of_the_program(
    scenes: pathlib.Path, expected: dict[str, bytes], tmp_path: pathlib.Path
) -> None:
    out = tmp_path / "out"
    report = keyway.batch([scenes], out, stacks=["key-point-fusion", "dwa-to-goal"], seeds=2)
    assert results(out) == expected and {"runs.jsonl", "runs.csv", "summary.csv"} <= set(expected)
    assert report["schema"] == "keyway.batch/1" and report["runs"] == 8
    assert len(expected["runs.jsonl"].splitlines()) == 8
    with pytest.raises(ValueError, match="stacks: .*given twice|the stack `keyway` is given twice"):
        keyway.batch([scenes], out, stacks=["keyway", "keyway"])
    with pytest.raises(ValueError, match="shard"):
        keyway.batch([scenes], out, shard=(3, 2))


def test_a_sweep_on_ray_is_the_same(
    scenes: pathlib.Path, expected: dict[str, bytes], tmp_path: pathlib.Path
) -> None:
    pytest.importorskip("ray")
    script = REPOSITORY / "crates" / "keyway-python" / "examples" / "sweep_ray.py"
    words = [str(scenes), "--stacks", "key-point-fusion,dwa-to-goal", "--seeds", "2", "--parts", "3", "--workers", "2"]
    done = subprocess.run(
        [sys.executable, str(script), *words, "--out", str(tmp_path / "out")], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "3 of 3 parts" in done.stdout and "8 runs in " in done.stdout
    assert results(tmp_path / "out") == expected


def test_a_comparison_is_that_of_the_program(house: keyway.Map, tmp_path: pathlib.Path) -> None:
    comparison = keyway.compare(
        house, planners=["jps", "hsta"], smoothers=["none", "taut"], queries=5, seed=3, radius=0.2, times=False,
        parameters={"hsta": {"if_no_path": "relax"}},
    )
    words = "--planners jps,hsta --smoothers none,taut --queries 5 --seed 3 --radius 0.2 --no-times".split()
    map_file = SCENES / "small_house.yaml"
    command = [*KEYWAY, "compare", str(map_file), *words, "--set", "hsta.if_no_path=relax", "--out", str(tmp_path / "out")]
    answer = subprocess.run([*command, "--format", "json"], capture_output=True, text=True, check=True)
    report = json.loads(answer.stdout)
    for row in report["rows"] + report["against_first"]:
        row["map"] = "map"
    assert comparison.rows == report["rows"] and len(comparison) == 4
    assert comparison.report["against_first"] == report["against_first"]
    latex = (tmp_path / "out" / "table.tex").read_text()
    assert comparison.to_latex().splitlines()[3:] == latex.replace("small\\_house.yaml", "map").splitlines()[3:]
    again = keyway.compare(house, planners=["jps"], queries=5, seed=3, radius=0.2, times=False)
    assert again.rows[0]["mean_length_m"] == comparison.rows[0]["mean_length_m"]


def test_a_comparison_as_a_data_frame(rooms: keyway.Map) -> None:
    pandas = pytest.importorskip("pandas")
    frame = keyway.compare(rooms, queries=4, seed=1).to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame["planner"].unique()) == ["jps", "theta-star"] and frame["mean_excess"].between(-1, 1).all()
    assert (frame["median_plan_us"] > 0).all()


def test_a_comparison_as_html(rooms: keyway.Map) -> None:
    comparison = keyway.compare(rooms, planners=["jps", "hsta"], smoothers=["none"], queries=4, seed=1, times=False)
    root = ElementTree.fromstring(comparison._repr_html_())
    header = [cell.text for cell in root.iter("th")]
    rows = [[cell.text for cell in row] for row in root.iterfind("tbody/tr")]
    assert header[:3] == ["planner", "smoother", "solved"] and [row[0] for row in rows] == ["jps", "hsta"]
    assert all(len(row) == len(header) for row in rows)
    # The same cells as in the table for papers.
    latex = [line for line in comparison.to_latex().splitlines() if line.strip().startswith("jps &")]
    assert latex[0].strip(" \\").split(" & ")[2:5] == [text or "" for text in rows[0][2:5]]
    assert repr(comparison) == "<keyway.Comparison 2 rows>"


def test_names_of_files_stay_as_they_are(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="cannot read .*a--seeds-b.toml: "):
        keyway.batch([tmp_path / "a--seeds-b.toml"], tmp_path / "out")


def test_a_wrong_list_is_named(tmp_path: pathlib.Path) -> None:
    grid = keyway.Map.from_array(np.zeros((5, 5), dtype=bool), resolution=1.0)
    lists: list[tuple[Any, str]] = [("jps", "str: put it into a list"), (3, "int"), (["jps", 3], "int at index 1"), ({"jps": 1}, "dict")]
    for wrong, got in lists:
        for name in ("planners", "smoothers", "columns"):
            arguments: dict[str, Any] = {name: wrong}
            with pytest.raises(TypeError, match=f"^{name}: expected a list of strings, got {got}$"):
                keyway.compare(grid, **arguments)
    with pytest.raises(TypeError, match="^stacks: expected a list of strings, got str: put it into a list$"):
        keyway.batch([tmp_path], tmp_path / "out", stacks="keyway")
    for got, wrong in (("str: put it into a list", "a.toml"), ("int at index 0", [3]), ("int", 3)):
        with pytest.raises(TypeError, match=f"^scenes: expected a list of paths and scenes, or a dictionary of scenes, got {got}$"):
            keyway.batch(wrong, tmp_path / "out")  # type: ignore[arg-type]
        with pytest.raises(TypeError, match=f"^parts: expected a list of paths, got {got}$"):
            keyway.merge(wrong, tmp_path / "out")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="names of parameters are strings, got int"):
        keyway.plan(grid, (1, 1), (2, 2), parameters={1: 2})  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="`map`: expected a string, a number, a boolean, a list or a dictionary, got object"):
        keyway.plan(grid, (1, 1), (2, 2), parameters={"map": object()})


@pytest.mark.filterwarnings("ignore:a. nothing in it is random")
def test_scenes_in_memory_give_the_same_files(
    scenes: pathlib.Path, expected: dict[str, bytes], tmp_path: pathlib.Path
) -> None:
    def drive(given: Any, out: str) -> dict[str, bytes]:
        keyway.batch(given, tmp_path / out, stacks=["key-point-fusion", "dwa-to-goal"], seeds=2)
        return results(tmp_path / out)

    grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    made = {
        "a": keyway.Scene(grid, (1, 2), (3, 3)),
        "b": keyway.Scene(grid, (1, 2), (4, 2), disturbances={"sensor": {"range_m": 0.02}}),
    }
    read = keyway.Scene.read(scenes / "b.toml")
    assert drive(made, "named") == expected
    assert drive([scenes / "a.toml", pickle.loads(pickle.dumps(read))], "mixed") == expected
    assert drive({"a": scenes / "a.toml", "b": read}, "files") == expected
    report = keyway.batch([scenes / "a.toml", made["b"]], tmp_path / "numbered", stacks=["dwa-to-goal"])
    rows = [json.loads(line) for line in (tmp_path / "numbered" / "runs.jsonl").read_text().splitlines()]
    assert [row["scene"] for row in rows] == ["a", "scene-1"] and report["runs"] == 2


def test_scenes_need_names_of_their_own(scenes: pathlib.Path, tmp_path: pathlib.Path) -> None:
    read = keyway.Scene.read(scenes / "a.toml")
    lists: list[list[Any]] = [[read, read.replace(seed=5)], [read, scenes / "a.toml"], [scenes, read]]
    for given in lists:
        with pytest.raises(ValueError, match="two scenes are named `a`; .*dictionary"):
            keyway.batch(given, tmp_path / "out")
    with pytest.raises(ValueError, match="scenes: the name of a scene must not be empty"):
        keyway.batch({"": read}, tmp_path / "out")
    with pytest.raises(TypeError, match="scenes: expected a Scene or a scene file as `a`, got int"):
        keyway.batch({"a": 3}, tmp_path / "out")  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="scenes must name at least one scene"):
        keyway.batch({}, tmp_path / "out")


def test_records_of_scenes_in_memory_are_replayed(tmp_path: pathlib.Path) -> None:
    values = np.zeros((40, 80), dtype=np.int8)
    values[:3, :], values[38:, :40], values[38:, 40:] = 100, -1, 30
    grid = keyway.Map.from_array(values, resolution=0.1, origin=(-1, 2), occupied_threshold=90, free_threshold=30)
    out = tmp_path / "out"
    with pytest.raises(ValueError, match="seeds must be a whole number"):
        keyway.batch({"room": keyway.Scene(grid, (1, 4), (4, 4))}, out, keep="all", seeds=0)
    assert not out.exists()
    keyway.batch({"room": keyway.Scene(grid, (1, 4), (4, 4))}, out, keep="all")
    (record,) = (out / "records").rglob("*.json*")
    done = subprocess.run([*KEYWAY, "replay", str(record)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_what_cannot_be_compared_is_said(rooms: keyway.Map) -> None:
    with pytest.raises(ValueError, match="planners: jps is given twice"):
        keyway.compare(rooms, planners=["jps", "jps"])
    with pytest.raises(ValueError, match="no_planner|there is no field"):
        keyway.compare(rooms, parameters={"no_planner": {"a": 1}})
    with pytest.raises(ValueError, match="queries"):
        keyway.compare(rooms, queries=0)
    with pytest.raises(ValueError, match="radius of 100 m leaves no cell free"):
        keyway.compare(rooms, radius=100.0)
    with pytest.raises(OverflowError):
        keyway.compare(rooms, seed=-1)

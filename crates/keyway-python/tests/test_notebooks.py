"""Notebooks run, and print what they say they print. With KEYWAY_WRITE_NOTEBOOKS=1 their outputs are written anew."""

import os
import pathlib
from typing import Any

import pytest
from conftest import REPOSITORY

nbclient = pytest.importorskip("nbclient")
nbformat: Any = pytest.importorskip("nbformat")

NOTEBOOKS = sorted((REPOSITORY / "docs" / "notebooks").glob("*.ipynb"))


def texts(notebook: Any) -> list[str]:
    """What every cell printed, in however many pieces it came; pictures are left out, as they depend on fonts."""

    def of_output(output: Any) -> str:
        return str(output["text"] if output["output_type"] == "stream" else output["data"].get("text/plain", ""))

    return ["".join(of_output(output) for output in cell.get("outputs", [])) for cell in notebook.cells]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_it_shows(path: pathlib.Path) -> None:
    committed = nbformat.read(path, 4)
    executed = nbformat.read(path, 4)
    nbclient.NotebookClient(executed, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
    if os.environ.get("KEYWAY_WRITE_NOTEBOOKS"):
        for cell in executed.cells:
            cell.metadata.pop("execution", None)
        nbformat.write(executed, path)
        return
    assert texts(executed) == texts(committed)
    assert any(cell.get("outputs") for cell in committed.cells)


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) == 4

"""What the documents show runs."""

import re

import pytest
from conftest import REPOSITORY

DOCUMENTS = [REPOSITORY / "docs" / "python.md", REPOSITORY / "crates" / "keyway-python" / "README.md", REPOSITORY / "README.md"]


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.parent.name + "/" + path.name)
def test_examples_of_a_document_run(path) -> None:  # type: ignore[no-untyped-def]
    blocks = re.findall(r"```python\n(.*?)```", path.read_text(), flags=re.DOTALL)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, str(path), "exec"), names)

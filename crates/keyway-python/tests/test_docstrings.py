"""Every public item says what it does and shows it; the examples are run."""

import doctest
import inspect
from collections.abc import Iterator
from typing import Any

import pytest

import keyway
import keyway.gym


def documented() -> Iterator[tuple[str, Any]]:
    yield "keyway", keyway
    yield "gym", keyway.gym
    for module in (keyway, keyway.gym):
        for name in module.__all__:
            item = getattr(module, name)
            yield name, item
            if inspect.isclass(item) and not issubclass(item, Exception):
                for member_name in vars(item):
                    if not member_name.startswith("_"):
                        yield f"{name}.{member_name}", inspect.getattr_static(item, member_name)


ITEMS = dict(documented())


@pytest.mark.parametrize("name", ITEMS)
def test_it_is_documented_and_its_example_holds(name: str) -> None:
    item = ITEMS[name]
    item = item.__func__ if isinstance(item, staticmethod) else item
    text = inspect.getdoc(item) or ""
    assert len(text) > 10, f"{name} is not documented"
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    if inspect.isclass(item) or (inspect.isroutine(item) and has_arguments(item)):
        assert test.examples, f"{name} has no example"
    output: list[str] = []
    runner.run(test, out=output.append)
    assert runner.failures == 0, "".join(output)


def has_arguments(item: Any) -> bool:
    return bool(set(inspect.signature(item).parameters) - {"self"})

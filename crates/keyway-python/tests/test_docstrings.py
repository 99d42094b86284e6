"""Every public item says what it does and shows it; the examples are run."""

import doctest
import inspect
from collections.abc import Iterator
from typing import Any

import pytest

import keyway
import keyway.errors
import keyway.plotting

FLAGS = doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL


def documented() -> Iterator[tuple[str, Any]]:
    yield "keyway", keyway
    for name in keyway.__all__:
        item = getattr(keyway, name)
        yield name, item
        if inspect.isclass(item) and not issubclass(item, Exception):
            for member_name, member in vars(item).items():
                if not member_name.startswith("_"):
                    yield f"{name}.{member_name}", getattr(item, member_name, member)


ITEMS = dict(documented())


@pytest.mark.parametrize("name", ITEMS)
def test_it_is_documented_and_its_example_holds(name: str) -> None:
    item = ITEMS[name]
    text = inspect.getdoc(item)
    assert text and text.strip().endswith((".", ")", "'", "]", "True", ">", "}", "exists") + tuple("0123456789")) or ">>>" in text, name
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    # A class, a function and a method of arguments have an example; what is only looked at need not.
    if inspect.isclass(item) or inspect.isroutine(item) and has_arguments(item):
        assert test.examples, f"{name} has no example"
    output: list[str] = []
    runner.run(test, out=output.append)
    assert runner.failures == 0, "".join(output)


def has_arguments(item: Any) -> bool:
    names = set(inspect.signature(item).parameters) - {"self"}
    return bool(names)

"""A function does one thing: what is done of a value by its class stands in a table keyed by classes. And a
module gives a name once.
"""

import ast

import pytest

from tests.layers import ROOT

# Functions that ask twice, and why no table would say it better.
ASKS_TWICE = {
    ("pipeline/validation/types.py", "check"): "one class is right, and a string is a likely slip for it",
}
FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


def own_nodes(function):
    """The nodes of a function, without those of functions within it."""
    waiting = list(ast.iter_child_nodes(function))
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, FUNCTIONS):
            waiting += ast.iter_child_nodes(node)


def asked(test):
    """What a condition asks the class of, as code."""
    return {
        ast.unparse(node.args[0])
        for node in ast.walk(test)
        if isinstance(node, ast.Call) and getattr(node.func, "id", None) == "isinstance"
    }


def asks_twice(source):
    """Names of functions that choose between two branches or more by the class of one value."""
    found = set()
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, FUNCTIONS):
            continue
        choices = [node for node in own_nodes(function) if isinstance(node, ast.If | ast.IfExp)]
        values = [value for choice in choices for value in asked(choice.test)]
        if len(values) > len(set(values)):
            found.add(getattr(function, "name", "lambda"))
    return found


@pytest.mark.parametrize("folder", ["raster", "pipeline", "effects", "bench"])
def test_what_is_done_of_a_value_by_its_class_stands_in_a_table(folder):
    paths = sorted((ROOT / folder).rglob("*.py"))
    found = {(p.relative_to(ROOT).as_posix(), name) for p in paths for name in asks_twice(p.read_text())}
    assert found == {key for key in ASKS_TWICE if key[0].startswith(f"{folder}/")}


CHAIN = """
def chain(x):
    if isinstance(x, int):
        return 1
    elif isinstance(x, str):
        return 2
"""
ROW = """
def row(x):
    if isinstance(x.y, int) and x.z:
        return 1
    return 2 if isinstance(x.y, str) else 3
"""
APART = """
def apart(x, y):
    def inner(x):
        return 1 if isinstance(x, int) else 2
    if isinstance(x, int):
        return isinstance(x, bool)
    return 3 if isinstance(y, int) else inner(x)
"""


@pytest.mark.parametrize(("source", "names"), [(CHAIN, {"chain"}), (ROW, {"row"}), (APART, set())])
def test_a_chain_is_seen_and_one_question_is_none(source, names):
    assert asks_twice(source) == names


def given_twice(source):
    """Names that a module gives to two functions, classes or values, of which the first is never read: not
    by a statement between them. What a function reads is the last.
    """
    unread, found = set(), set()
    for node in ast.parse(source).body:
        defines = isinstance(node, ast.FunctionDef | ast.ClassDef)
        targets = node.targets if isinstance(node, ast.Assign) else ()
        parts = (*node.decorator_list, node.args) if isinstance(node, ast.FunctionDef) else (node,)
        names = [name for part in parts for name in ast.walk(part) if isinstance(name, ast.Name)]
        unread -= {name.id for name in names if isinstance(name.ctx, ast.Load)}
        names = [name for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)]
        given = {node.name} if defines else {name.id for name in names if isinstance(name.ctx, ast.Store)}
        found |= unread & given
        unread |= given
    return found


@pytest.mark.parametrize("folder", ["raster", "pipeline", "effects", "bench"])
def test_a_module_gives_a_name_once(folder):
    assert not [(p.stem, n) for p in (ROOT / folder).rglob("*.py") for n in given_twice(p.read_text())]


def test_a_name_that_is_given_twice_is_seen():
    assert given_twice("x = 1\ndef f(): return x\ny, x = 2, 3\nf = {z: z for z in y}") == {"x", "f"}
    assert given_twice("x = 1\ny = x\nx = 2\nclass C: x = y\ny = x") == set()

"""Meshes by content: found again while they are in use, and forgotten within a bound."""

import numpy as np

from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.opengl.meshes import Meshes, content_key, make_mesh


def _mesh(count=100):
    return make_mesh(PrimitiveType.POINTS, {"positions": np.zeros((count, 4))})


def test_a_mesh_is_made_once():
    made = []
    meshes = Meshes()
    for key in ("a", "b", "a"):
        meshes.find(key, lambda key=key: made.append(key) or _mesh())
    assert made == ["a", "b"]


def test_what_is_used_stays_and_what_is_not_goes():
    made = []
    meshes = Meshes(kept_bytes=20_000)  # some four meshes
    for number in range(50):
        meshes.find("used", lambda: made.append("used") or _mesh())
        meshes.find(number, _mesh)
    assert made == ["used"]
    assert len(meshes._young) + len(meshes._old) <= 12
    meshes.find(0, lambda: made.append("again") or _mesh())
    assert made == ["used", "again"]


def test_the_bytes_of_keys_count():
    meshes = Meshes(kept_bytes=20_000)
    for number in range(10):
        meshes.find(number, lambda: _mesh(1), key_bytes=15_000)
    assert len(meshes._young) + len(meshes._old) <= 4


def test_keys_differ_where_meshes_do():
    def key(primitive=PrimitiveType.LINES, indices=None, counts=None, **columns):
        columns = {"positions": np.zeros((2, 4)), "texture_coordinates": ()} | columns
        return content_key(primitive, columns, indices, counts)[0]

    ones = np.ones((2, 4))
    keys = [
        key(),
        key(PrimitiveType.POINTS),
        key(indices=np.array([0, 1])),
        key(indices=np.array([1, 0])),
        key(counts=(2,)),
        key(positions=np.zeros((4, 2))),
        key(positions=np.zeros((2, 4), np.int64)),
        key(colors=ones),
        key(secondary_colors=ones),
        key(texture_coordinates=(ones,)),
        key(texture_coordinates=(ones, ones)),
    ]
    assert len(set(keys)) == len(keys)
    assert key(colors=ones) == key(colors=ones.copy())

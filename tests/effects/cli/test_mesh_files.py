"""OBJ and PLY files as tools write them: what is read, what is left out and told, and what is refused."""

import random
import re
import struct
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.geometry import triangle_meshes
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.inputs import read_mesh
from tests.effects.cli.test_damaged_files import check_sentence
from tests.effects.cli.test_shadows import run, shadows
from tests.support.memory import largest_memory

pytest.importorskip("plyfile")

POINTS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
FACES = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
VERTICES = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)
CUBE = VERTICES + "".join(f"f {' '.join(str(v + 1) for v in face)}\n" for face in FACES)
MADE = "creases; spherical texture coordinates"


def read(tmp_path, data, name="mesh.obj"):
    """(surface, the line that tells what was understood, without the file's name)."""
    told = []
    (tmp_path / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    surface = read_mesh(str(tmp_path / name), tell=told.append)
    (line,) = told
    return surface, line.removeprefix(f"{tmp_path / name}: ").replace(str(tmp_path) + "/", "")


def same(a, b):
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("positions", "normals", "texture_coordinates", "triangles")
    )


# ------------------------------------------------------------------------------------------------ OBJ

WHOLE = {
    "a backslash in a vertex": CUBE.replace("v 1 1 -1\n", "v 1 1 \\\n -1\n"),
    "a backslash in a face": CUBE.replace("f 4 3 2 1\n", "f 4 3 \\  \n\t2 \\\n1\n"),
    "a backslash at the end": CUBE.removesuffix("\n") + " \\",
    "a backslash at the end of a comment": CUBE.replace("v 1 1 -1\n", "# C:\\dir\\\nv 1 1 -1 # \\\n"),
    "a backslash at the end of a name": "mtllib C:\\dir\\\n" + CUBE,
    "Latin-1 in a comment": b"# Gr\xfc\xdfe\n" + CUBE.encode(),
    "GBK in a name": CUBE.replace("f 4", "usemtl \u6750\u8d28\nf 4").encode("gbk"),
    "UTF-16": CUBE.encode("utf-16"),
    "UTF-8 with a mark": CUBE.encode("utf-8-sig"),
    "lines of Windows": CUBE.replace("\n", "\r\n"),
    "lines of the Macintosh": CUBE.replace("\n", "\r"),
    "other line ends in a comment": "# \u2028v 9 9\x0cv 9\x0bv 9\x85v 9\u2029v 9\n" + CUBE,
    "tabs and blanks": "\n".join("\t " + line.replace(" ", "\t\t") for line in CUBE.split("\n")),
    "a comment behind a face": CUBE.replace("f 4 3 2 1", "f 4 3 2 1#5"),
    "faces before their vertices": CUBE[len(VERTICES) :] + VERTICES,
    "negative indices": VERTICES + "".join(f"f {' '.join(str(v - 8) for v in face)}\n" for face in FACES),
    "a normal that no face uses": "vn 0 0 1\n" + CUBE,
    "a NUL at the end": CUBE + "\0",
}


@pytest.mark.parametrize("data", WHOLE.values(), ids=WHOLE)
def test_a_cube_is_a_cube_however_it_is_written(tmp_path, data):
    plain, _ = read(tmp_path, CUBE)
    surface, told = read(tmp_path, data)
    assert told == f"8 vertices, 6 faces in 12 triangles; {MADE}"
    assert same(surface, plain)


# A bend of 60 degrees, which the file's normals make flat and creases do not.
BEND = "v -1 0 0\nv -1 1 0\nv 0 0 0\nv 0 1 0\nv 0.5 0 0.866\nv 0.5 1 0.866\nvn 0 0 1\nvn -0.5 0 0.866\n"
BENT = BEND + "f 1//1 3//1 4//1 2//1\nf 3//2 5//2 6//2 4//2\n"


@pytest.mark.parametrize("spelled", ["vn\t", " vn ", "\t vn\t "])
def test_normals_that_a_face_uses_are_used_however_their_lines_begin(tmp_path, spelled):
    plain, told = read(tmp_path, BENT)
    assert told.endswith("; the file's normals; spherical texture coordinates")
    assert same(read(tmp_path, BENT.replace("vn ", spelled))[0], plain)
    creased = read(tmp_path, BENT.replace("//1", "").replace("//2", ""))[0]
    assert not same(creased, plain)


def test_corners_without_a_normal_have_creases_beside_others_that_have_one(tmp_path):
    slanted = "vn 0 0.6 0.8\n" + CUBE.replace("f 5 6 7 8\n", "f 5//1 6//1 7//1 8//1\n")
    surface, told = read(tmp_path, slanted)
    assert "normals of 6 of 36 corners in the file, creases elsewhere" in told
    plain = {tuple(n) for n in read(tmp_path, CUBE)[0].normals.round(9).tolist()}
    assert {tuple(n) for n in surface.normals.round(9).tolist()} == plain - {(0, 0, 1)} | {(0, 0.6, 0.8)}


def test_texture_coordinates_are_kept_beside_creases_and_told_of_where_some_lack(tmp_path):
    lines = [
        line if line[0] != "f" else "f " + " ".join(f"{v}/{k + 1}" for k, v in enumerate(line.split()[1:]))
        for line in CUBE.splitlines()
    ]
    mapped = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + "\n".join(lines) + "\n"
    surface, told = read(tmp_path, mapped)
    assert told.endswith("creases; the file's texture coordinates")
    assert set(map(tuple, surface.texture_coordinates.tolist())) == {(0, 0), (1, 0), (1, 1), (0, 1)}
    _, told = read(tmp_path, mapped.replace("f 5/1 6/2 7/3 8/4", "f 5 6 7 8"))
    assert told.endswith("texture coordinates of 30 of 36 corners in the file, so spherical ones are taken")


LEFT_OUT = {
    "a face of two corners": (
        CUBE + "f 1 2\n",
        "1 face that cannot be drawn (mesh.obj, line 15: a face has 2 corners; it needs at least three)",
    ),
    "vertices that are not there": (
        CUBE + "f 1 2 9\nf 1 2 0\nf 1 2 -9\n",
        "3 faces that cannot be drawn (mesh.obj, line 15: vertex index 9 does not exist; there are 8)",
    ),
    "corners that are none": (CUBE + "f a b c\nf 1/2/3/4 1 1\n", "2 faces that cannot be drawn"),
    "texture coordinates that are not there": (
        CUBE.replace("f 4 3 2 1", "f 4/1 3/2 2 1/0"),
        "3 indices of what is not there (mesh.obj, line 9: texture coordinate index 1 does not exist; there "
        "are 0)",
    ),
    "normals that are not there": (CUBE.replace("f 4 3 2 1", "f 4//7 3 2 1"), "1 index of what is not there"),
    "a normal of NaN": (
        "vn nan 0 0\nvn -1.#IND00 0 1\nvn 1.#QNAN0 inf -nan(ind)\n" + CUBE.replace("f 4 3", "f 4//1 3//2"),
        "3 vectors without numbers (mesh.obj, line 1: a normal is no finite numbers)",
    ),
}


@pytest.mark.parametrize(("data", "words"), LEFT_OUT.values(), ids=LEFT_OUT)
def test_one_bad_line_does_not_lose_a_mesh(tmp_path, data, words):
    surface, told = read(tmp_path, data)
    assert f"{MADE}; left out: {words}" in told
    assert same(surface, read(tmp_path, CUBE)[0])


def test_a_command_tells_what_it_understood_of_a_mesh(tmp_path):
    (tmp_path / "mesh.obj").write_text(CUBE + "f 1 2\n")
    result = run(*shadows(tmp_path / "mesh.obj", tmp_path / "out.png", "--algorithm", "alpha-multitexture"))
    assert result.exit_code == 0
    first = result.stdout.splitlines()[0]
    assert first.startswith(
        f"{tmp_path / 'mesh.obj'}: 8 vertices, 6 faces in 12 triangles; {MADE}; left out: 1"
    )


def test_concave_faces_of_a_file_share_a_budget(tmp_path, monkeypatch):
    angles = np.arange(60) * (np.pi / 30)
    radii = np.where(np.arange(60) % 2, 1.0, 0.4)
    star = "".join(f"v {x} {y} 0\n" for x, y in np.stack([radii * np.cos(angles), radii * np.sin(angles)], 1))
    face = "f " + " ".join(map(str, range(1, 61))) + "\n"
    assert "3 faces in 174 triangles" in read(tmp_path, star + 3 * face)[1]
    monkeypatch.setattr(triangle_meshes, "_MOST_CANDIDATES", 200)
    with pytest.raises(ValueError, match="line 63: the file's concave faces take too long to cut up"):
        read(tmp_path, star + 3 * face)


# ------------------------------------------------------------------------------------------------ PLY

CODES = {
    "char": "b",
    "uchar": "B",
    "short": "h",
    "ushort": "H",
    "int": "i",
    "uint": "I",
    "float": "f",
    "double": "d",
}
BINARY = {"binary_little_endian": "<", "binary_big_endian": ">"}


def ply(kind, elements, comment="a comment"):
    """The bytes of a PLY file. elements: [(name, [(type, name) or (count's type, type, name)], rows)]."""
    header = ["ply", f"format {kind} 1.0", f"comment {comment}"]
    body = bytearray()
    for name, properties, rows in elements:
        header.append(f"element {name} {len(rows)}")
        for each in properties:
            header.append(f"property {'list ' if len(each) == 3 else ''}{' '.join(each)}")
        for row in rows:
            words = []
            for value, each in zip(row, properties, strict=True):
                listed = value if len(each) == 3 else [value]
                types = [each[0], *[each[1]] * len(listed)] if len(each) == 3 else [each[0]]
                values = [len(listed), *listed] if len(each) == 3 else listed
                if kind in BINARY:
                    body += struct.pack(BINARY[kind] + "".join(CODES[t] for t in types), *values)
                words += map(str, values)
            if kind == "ascii":
                body += " ".join(words).encode() + b"\n"
    return "\n".join([*header, "end_header", ""]).encode("latin-1") + bytes(body)


XYZ = [("float", axis) for axis in "xyz"]
INDICES = [("uchar", "int", "vertex_indices")]
FACE = ("face", INDICES, [(face,) for face in FACES])
MIXED = [(f,) for f in (FACES[0][:3], (FACES[0][0], *FACES[0][2:]), *FACES[1:])]
EVERY = ("ascii", *BINARY)


@pytest.mark.parametrize("kind", EVERY)
def test_a_cube_of_any_kind_of_ply_is_the_cube(tmp_path, kind):
    plain = read(tmp_path, CUBE)[0]
    vertex = ("vertex", XYZ, POINTS)
    more = ("vertex", [*XYZ, ("uchar", "red"), ("double", "quality")], [(*p, 9, 0.5) for p in POINTS])
    lists = [*INDICES, ("uchar", "float", "texcoord"), ("uchar", "red")]
    for elements in (
        [vertex, FACE],
        [FACE, vertex],
        [vertex, ("face", INDICES, MIXED)],
        [vertex, ("face", [("uint", "ushort", "vertex_index")], FACE[2])],
        [more, ("face", lists, [(face, (), 7) for face in FACES]), ("edge", [("int", "vertex1")], [(3,)])],
    ):
        data = ply(kind, elements, "Gr\xfc\xdfe")
        for trail in (b"", b"\0" * 7 if kind in BINARY else b"\nmore\n"):
            surface, told = read(tmp_path, data + trail, "mesh.ply")
            assert told.startswith("8 vertices, ") and told.endswith(f" in 12 triangles; {MADE}")
            assert same(surface, plain)
    for cut in (1, 2, 5, 30):
        data = ply(kind, [vertex, FACE]).rstrip(b"\n")
        with pytest.raises(Refusal, match=r"fewer vertices and faces than it names.* Give a whole PLY"):
            read(tmp_path, data[: -cut if kind in BINARY else -2 * cut], "mesh.ply")


@pytest.mark.parametrize("kind", EVERY)
def test_normals_and_coordinates_of_a_ply_file_are_used(tmp_path, kind):
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    pairs = [(0, 0), (3, 0), (3, 3), (0, 3)]
    normals = [("float", f"n{axis}") for axis in "xyz"]
    for names in (("s", "t"), ("u", "v"), ("texture_u", "texture_v")):
        properties = [*XYZ, *normals, *[("float", name) for name in names]]
        rows = [(*p, 0.6, 0, 0.8, *pair) for p, pair in zip(square, pairs, strict=True)]
        surface, told = read(
            tmp_path, ply(kind, [("vertex", properties, rows), ("face", INDICES, [((0, 1, 2, 3),)])]), "a.ply"
        )
        assert told.endswith("the file's normals; the file's texture coordinates")
        np.testing.assert_allclose(surface.normals, np.tile([0.6, 0, 0.8], (4, 1)), atol=1e-7)
        assert sorted(map(tuple, surface.texture_coordinates.tolist())) == sorted(pairs)
    lists = [*INDICES, ("uchar", "float", "texcoord")]
    faces = [((0, 1, 2, 3), [c for pair in pairs for c in pair])]
    surface, told = read(tmp_path, ply(kind, [("vertex", XYZ, square), ("face", lists, faces)]), "a.ply")
    assert told.endswith("creases; the file's texture coordinates")
    at = {
        tuple(p): tuple(c)
        for p, c in zip(surface.positions.tolist(), surface.texture_coordinates.tolist(), strict=True)
    }
    assert at == dict(zip(square, pairs, strict=True))


@pytest.mark.parametrize("kind", EVERY)
def test_triangle_strips_are_triangles_all_wound_one_way(tmp_path, kind):
    square = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 2, 0)]
    strips = ("tristrips", [("int", "int", "vertex_indices")], [((0, 1, 2, 3, 4, -1, 1, 0, 2, -1),)])
    surface, told = read(tmp_path, ply(kind, [("vertex", XYZ, square), strips]), "a.ply")
    assert told.startswith("5 vertices, 4 faces; ")
    points = surface.positions[surface.triangles]
    turns = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])[:, 2]
    assert turns.tolist() == [1.0, 1.0, 1.0, -1.0]


def test_elements_over_several_lines_are_read_where_they_end_with_a_line(tmp_path):
    plain = ply("ascii", [("vertex", XYZ, POINTS), FACE]).decode()
    broken = plain.replace("-1 -1 -1\n", "-1\n\n-1 -1\n").replace("4 3 2 1 0\n", "4 3\n2 1 0\n")
    assert same(read(tmp_path, broken, "a.ply")[0], read(tmp_path, CUBE)[0])
    with pytest.raises(Refusal, match="vertex 0 is not whole"):
        read(tmp_path, plain.replace("-1 -1 -1\n1 -1 -1\n", "-1 -1\n-1 1 -1 -1\n"), "a.ply")


@pytest.mark.parametrize(
    ("name", "count", "words"),
    [
        ("face", 10**11, "has 100000000000 faces; up to 500000"),
        ("face", 400_000, "they need 2000"),
        ("vertex", 10**18 - 1, "up to 1500000 are read"),
        ("vertex", 10**6, "at least, and"),
    ],
)
@pytest.mark.parametrize("kind", EVERY)
def test_a_header_that_names_too_many_is_refused_before_room_is_made(tmp_path, kind, name, count, words):
    data = ply(kind, [("vertex", XYZ, POINTS), FACE])
    data = data.replace(
        f"element {name} {6 if name == 'face' else 8}".encode(), f"element {name} {count}".encode()
    )
    with pytest.raises(Refusal, match=words if count != 400_000 else "at least, and"):
        read(tmp_path, data, "a.ply")


def test_properties_of_kinds_that_no_mesh_has_are_refused(tmp_path):
    rows = [((x,), y, z) for x, y, z in POINTS]
    listed = ply("ascii", [("vertex", [("uchar", "int", "x"), *XYZ[1:]], rows), FACE])
    floats = ply(
        "ascii", [("vertex", XYZ, POINTS), ("face", [("uchar", "float", "vertex_indices")], FACE[2])]
    )
    for data in (listed, floats):
        with pytest.raises(Refusal, match="has properties of kinds that are not read"):
            read(tmp_path, data, "a.ply")


@settings(max_examples=60)
@given(
    st.lists(st.lists(st.integers(0, 7), min_size=0, max_size=5), min_size=1, max_size=12),
    st.sampled_from(EVERY),
    st.booleans(),
)
def test_random_polygons_are_the_same_by_either_format(tmp_path_factory, polygons, kind, wide):
    folder = tmp_path_factory.mktemp("m")
    lists = [("uint" if wide else "uchar", "int" if wide else "uchar", "vertex_indices")]
    data = ply(kind, [("vertex", XYZ, POINTS), ("face", lists, [(p,) for p in polygons])])
    text = VERTICES + "".join(f"f {' '.join(str(v + 1) for v in p)}\n" for p in polygons)
    outcomes = []
    for name, given_ in (("a.ply", data), ("a.obj", text)):
        try:
            outcomes.append(read(folder, given_, name))
        except ValueError as error:
            outcomes.append((None, str(error)))
    (first, told), (second, also) = outcomes
    assert (first is None) == (second is None)
    if first is not None:
        assert same(first, second)
        assert told.split("(")[0] == also.split("(")[0]


# ------------------------------------------------------------------------------------------ mutations

SEEDS = {
    "a.obj": [data if isinstance(data, bytes) else data.encode() for data in (*WHOLE.values(), BENT)]
    + [data.encode() for data, _ in LEFT_OUT.values()],
    "a.ply": [
        ply(kind, elements)
        for kind in EVERY
        for elements in (
            [("vertex", XYZ, POINTS), ("face", INDICES, MIXED)],
            [
                (
                    "vertex",
                    [*XYZ, *[("double", f"n{a}") for a in "xyz"], ("float", "s"), ("float", "t")],
                    [(*p, 0, 0, 1, 0.5, 0.25) for p in POINTS],
                ),
                (
                    "face",
                    [*INDICES, ("uchar", "float", "texcoord"), ("uchar", "red")],
                    [(f, (0, 0, 1, 0, 1, 1, 0, 1), 7) for f in FACES],
                ),
            ],
            [("vertex", XYZ, POINTS), ("tristrips", [("int", "int", "vertex_indices")], [((0, 1, 2, -1),)])],
        )
    ],
}
_BYTES = b"0123456789-.#/\\ \t\r\n\0\xffvnftnaeE"


def mutant(data, chance):
    """One to four changes: bytes exchanged, taken out, doubled, moved; numbers made large."""
    out = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        at, how = chance.randrange(len(out)), chance.randrange(6)
        if how == 0:
            out[at] = chance.randrange(256)
        elif how == 1:
            out[at] = chance.choice(_BYTES)
        elif how == 2:
            del out[at : at + chance.randint(1, 20)]
        elif how == 3:
            out[at:at] = out[at : at + chance.randint(1, 40)] * chance.choice((1, 1, 1, 50))
        elif how == 4:
            out[at:at] = chance.choice((b"999999999", b"4294967295", b"1e308", b"nan", b"-1", b" \\\n"))
        else:
            out[at : at + 4] = chance.choice((b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\0\0\xc0\x7f"))
        out = out or bytearray(b"v")
    return bytes(out)


def try_mutants(tmp_path, name, count, seed):
    """How many of so many mutants were read; the others were refused."""
    chance, read_, path = random.Random(seed), 0, tmp_path / name
    before = largest_memory()
    for number in range(count):
        data = mutant(chance.choice(SEEDS[name]), chance)
        path.write_bytes(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                read_mesh(str(path))
            read_ += 1
        except ValueError as refused:
            # What a sentence quotes of the file may look like anything.
            check_sentence(re.sub(r"found (['\"]).*\1\.$", "found it.", str(refused)), path)
        except Exception as error:
            error.add_note(f"mutant {number} of seed {seed}: {data!r}")
            raise
    assert largest_memory() - before < 1_500_000_000
    return read_


@pytest.mark.parametrize("name", SEEDS)
def test_a_mutant_is_read_or_refused(tmp_path, name):
    assert 0 < try_mutants(tmp_path, name, 300, 0) < 300


@pytest.mark.slow
@pytest.mark.parametrize("name", SEEDS)
def test_ten_thousand_mutants_are_read_or_refused(tmp_path, name):
    assert 0 < try_mutants(tmp_path, name, 10_000, 1) < 10_000

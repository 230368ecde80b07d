"""A folder as ``fixedpipe figures`` leaves it, of small figures that are made up, each odd in its way."""

import json
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.reports.figure_files import write_page
from fixedpipe.effects.reports.pictures import LOSSLESS, OF_GRID, WIDE, Pictures

# What a page must show as it is written and never run.
HOSTILE = "</script><script>window.ran = 1</script><img src=x onerror='window.ran = 1'> \u2028 & \"quoted\""
NAMES = {
    "GEFORCE_3": "GeForce 3",
    "NV2A": "NV2A",
    "OCTANE": "SGI Octane",
    "INFINITE_REALITY": "SGI InfiniteReality",
    "IDEAL": "ideal",
}
FIGURES = ("F003-21", "K12", "F004-4")
VARIANT = "F004-4+alpha_x=0.15"
EDGE = 40


@dataclass
class Made:
    """The folder, and codes [height, width, 3], or 4 with an alpha, by (figure, machine, view)."""

    folder: object
    codes: dict[tuple[str, str, str], NDArray[np.int64]] = field(default_factory=dict)
    records: dict[str, dict] = field(default_factory=dict)


def write_picture(folder, pixels):
    """The files of a picture, uint8 [height, width, 3 or 4]; its digest. Without an alpha it is told from one
    that is a byte apart.
    """
    kept = Pictures()
    bases = [kept.add(pixels ^ 1, LOSSLESS)] if pixels.shape[2] == 3 else ()
    digest = kept.add(pixels, LOSSLESS, WIDE, OF_GRID, bases=bases)
    for name, data in kept.files():
        (folder / name).write_bytes(data())
    return digest


def pictures_of(codes, bits, folder):
    """What a record says of a picture whose codes are [height, width, 3], or 4 with an alpha in bytes."""
    full = 2**bits - 1
    shown = np.floor(codes[..., :3] * 255 / full + 0.5).astype(np.uint8)
    finer = None
    if bits > 8:
        scaled = np.floor(shown.astype(np.int64) * full / 255 + 0.5).astype(np.int64)
        finer = write_picture(folder, (codes[..., :3] - scaled + 128).astype(np.uint8))
    if codes.shape[2] == 4:
        shown = np.dstack([shown, codes[..., 3].astype(np.uint8)])
    height, width = codes.shape[:2]
    return {
        "digest": write_picture(folder, np.ascontiguousarray(shown)),
        "width": width,
        "height": height,
        "bits": bits,
        "finer": finer,
    }


def told_from(said, codes, machine, folder):
    """What a record says of a picture of twelve bits whose codes are told from the machine's."""
    delta = write_picture(folder, (codes - machine + 128).astype(np.uint8))
    return {"delta": delta, "of": {name: said["machine"][name] for name in ("digest", "finer")}}


def difference_of(machine, other, bits):
    """What a record says of two pictures' difference."""
    where = other[..., 3] > 0 if other.shape[2] == 4 else np.ones(machine.shape[:2], bool)
    delta = np.where(where[..., None], machine[..., :3] - other[..., :3], 0)
    size, full = np.abs(delta).max(axis=-1), 2**bits - 1
    row, column = np.unravel_index(int(size.argmax()), size.shape)
    return {
        "identical": not size.any(),
        "gain": 16,
        "rms": float(np.sqrt((delta**2).mean()) / full),
        "max": float(size.max() / full),
        "at": [int(column), int(row)] if size.any() else None,
        "pixels": int((size > 0).sum()),
    }


def drawn(made, figure, machine, method, bits, pictures, **more):
    """A machine of a record: ``pictures`` are codes by view."""
    folder = made.folder / "pictures"
    for view, codes in pictures.items():
        made.codes[figure, machine, view] = codes
    said = {view: pictures_of(codes, bits, folder) for view, codes in pictures.items()}
    if bits > 8 and "ideal" in pictures:
        said["ideal"] |= told_from(said, pictures["ideal"], pictures["machine"], folder)
    for view in said:
        said[view]["caption"] = f"{NAMES[machine]}, {view}"
    record = {
        "profile": machine,
        "name": NAMES[machine],
        "method": method,
        "bits": bits,
        "same_bits_as": None,
        "parameters": {},
        "pictures": said,
        "checks": [],
        "provenance": {"fixedpipe": "0.1.0"},
    }
    for view in ("ideal", "reference"):
        if view in pictures:
            key = "difference" if view == "ideal" else "reference_difference"
            record[key] = difference_of(pictures["machine"], pictures[view], bits)
            said[key] = {"caption": "machine minus the other, x 16"}
    return record | more


def check(name, value, passed=True, on="machine"):
    return {
        "name": name,
        "value": value,
        "relation": "<=",
        "bound": 1.0,
        "on": on,
        "reason": "asked for",
        "passed": passed,
    }


def figure(made, figure_id, title, machines, labels, **more):
    """Writes a figure's record in both of its forms."""
    record = {
        "id": figure_id,
        "title": title,
        "caption": f"What {figure_id} shows.",
        "must_see": "Stripes at the left. None, cf. Eq. 2 and n.l, in the middle! Right a gap.",
        "source": "Zwicker2016",
        "techniques": ["Z10"],
        "parameters": {"offsets": [[0.0, 0.0], [1.5, 4.0]], "ratio": 1},
        "size": EDGE,
        "width": EDGE * len(labels),
        "height": EDGE,
        "panels": [
            {"x": EDGE * i, "y": 0, "width": EDGE, "height": EDGE, "label": label}
            for i, label in enumerate(labels)
        ],
        "citation": {
            "authors": "Matthias Zwicker",
            "title": "Bump Mapping and Shadows",
            "year": "2016",
            "key": "Zwicker2016",
            "bibtex": "@misc{Zwicker2016,\n  year = {2016}\n}",
        },
        "page": f"docs/papers/003.md#{figure_id.lower()}",
        "command": f"fixedpipe figures {figure_id} --check",
        "machines": machines,
    } | more
    record = {key: value for key, value in record.items() if key != "must_see" or value is not None}
    made.records[figure_id] = record
    text = json.dumps(record)
    (made.folder / f"{figure_id}.json").write_text(text)
    (made.folder / "records" / f"{figure_id}.js").write_text(f"record({text})\n")


def codes_of(random, bits=8, panels=3, over=0):
    """Noise that uses all codes, [EDGE, panels * EDGE, 3]."""
    return random.integers(over, 2**bits - over, (EDGE, panels * EDGE, 3))


def make_gallery(folder):
    """A Made: three figures of two papers and a variant, with index.html."""
    made, random = Made(folder), np.random.default_rng(18)
    for name in ("pictures", "records"):
        (folder / name).mkdir()

    machine = codes_of(random, over=60)
    ideal = machine + random.integers(-3, 4, machine.shape)
    ideal[30, 101] = machine[30, 101] + [0, 50, 0]
    reference = np.dstack([machine + random.integers(-9, 10, machine.shape), np.full(machine.shape[:2], 255)])
    reference[:, 2 * EDGE :] = 0
    reference[7, 50, :3] = machine[7, 50] - [55, 0, 0]
    pictures = {"machine": machine, "ideal": ideal, "reference": reference}
    checks = [check("gap", 0.5, on="ideal"), check("gap", 0.6)]
    preview = write_picture(folder / "pictures", machine.astype(np.uint8))
    passes = [{"number": 1, "label": "clear <all>", "commands": "Clear()", "preview": preview}]
    first = drawn(made, "F003-21", "GEFORCE_3", "depth texture", 8, pictures, checks=checks, passes=passes)
    first["pictures"]["difference"]["digest"] = preview
    same = drawn(made, "F003-21", "NV2A", "depth texture", 8, pictures, same_bits_as="GEFORCE_3")
    other = np.clip(machine + random.integers(-2, 3, machine.shape), 0, 255)
    other[3, 4] = [255, 255, 255]
    octane = drawn(made, "F003-21", "OCTANE", "imaging subset", 8, {"machine": other, "ideal": ideal})
    deep = codes_of(random, bits=12, over=200)
    deep_ideal = deep + random.integers(-3, 4, deep.shape)
    twelve = drawn(
        made, "F003-21", "INFINITE_REALITY", "depth texture", 12, {"machine": deep, "ideal": deep_ideal}
    )
    labels = ("too little", "correct", "too much")
    figure(made, "F003-21", "Bias: not enough", [first, same, octane, twelve], labels)

    machine = codes_of(random, panels=1)
    pictures = {"machine": machine, "ideal": machine}
    identical = drawn(made, "K12", "OCTANE", "imaging subset", 8, pictures)
    figure(made, "K12", HOSTILE, [identical], ("",), caption=HOSTILE, must_see=HOSTILE, command=HOSTILE)

    machine = codes_of(random, panels=2)
    pictures = {"machine": machine, "ideal": np.clip(machine + 1, 0, 255)}
    failing = drawn(
        made, "F004-4", "GEFORCE_3", "combiners", 8, pictures, checks=[check("rings", 2.5, passed=False)]
    )
    kautz = {
        "authors": "Jan Kautz and Hans-Peter Seidel",
        "title": "Towards",
        "year": "2000",
        "key": "KautzSeidel2000",
        "bibtex": "@x{}",
    }
    paper = {"source": "KautzSeidel2000", "citation": kautz}
    figure(
        made,
        "F004-4",
        "Two brushed spheres",
        [failing],
        ("left", "right"),
        **paper,
    )

    exact = drawn(made, VARIANT, "IDEAL", "combiners", 8, {"machine": machine}, difference=None)
    variant = {"figure": "F004-4", "set": {"alpha_x": 0.15}, "page": None, "must_see": None} | paper
    figure(made, VARIANT, "Two brushed spheres", [exact], ("left", "right"), **variant)

    write_page(folder, FIGURES)
    return made

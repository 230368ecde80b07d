"""The JSON Schema of small states, made of the types that are read: docs/pixel-state.schema.json.

``python -m fixedpipe.effects.pixel_states.schema`` prints it.
"""

import json
from dataclasses import MISSING, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from fixedpipe.effects.pixel_states.states import (
    ARRAYS,
    CLEAR_KEYS,
    DRAW_KEYS,
    FORMAT,
    KEYS,
    MESH_KEYS,
    MOST_DRAWS,
    MOST_EDGE,
    MOST_VERTICES,
    POSITIONS,
)
from fixedpipe.effects.pixel_states.textures import KEYS as TEXTURE_KEYS
from fixedpipe.effects.pixel_states.textures import KINDS
from fixedpipe.effects.pixel_states.values import FRACTION, SINGLE
from fixedpipe.pipeline.enums import DepthFormat, InternalFormat, PrimitiveType, TexelWord, TextureTarget
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import Color, PassState

_TEXT, _WHOLE = {"type": "string", "minLength": 1}, {"type": "integer"}
_PLAIN: dict[Any, dict[str, Any]] = {
    str: _TEXT,
    int: _WHOLE,
    bool: {"type": "boolean"},
    float: {"$ref": "#/$defs/number"},
    bytes: {"type": "string", "pattern": "^([0-9a-fA-F]{2})+$"},
    NoneType: {"type": "null"},
}


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of what ``read_state`` takes."""
    described: dict[str, Any] = {
        "number": {
            "description": "A number; a fraction, 200/255; or the bits of a single, 0x3f800000.",
            "anyOf": [{"type": "number"}, {"type": "string", "pattern": f"^({FRACTION}|{SINGLE})$"}],
        },
    }
    described["texture"] = _object(_texture(described), TEXTURE_KEYS)
    described["texture"]["oneOf"] = [{"required": [kind]} for kind in KINDS]
    described["mesh"] = _object(_mesh(), MESH_KEYS)
    described["draw"] = _object(_draw(described), DRAW_KEYS)
    top = _object(_top(described), KEYS)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A small state, whose pixel a machine draws: fixedpipe pixel",
        **top,
        "required": ["draws"],
        "$defs": described,
    }


def _object(properties, keys):
    """An object of these properties, which are all that is read."""
    assert set(properties) == set(keys), set(properties) ^ set(keys)
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _said(description, **more):
    return {"description": description, **more}


def _list(items, **more):
    return {"type": "array", "items": items, **more}


def _top(described):
    edge = {"type": "integer", "minimum": 1, "maximum": MOST_EDGE, "default": 1}
    clear = {
        "color": _described(Color, described),
        "depth": {"$ref": "#/$defs/number"},
        "stencil": _WHOLE,
    }
    depths = [_WHOLE, {"enum": list(DepthFormat.__members__)}]
    return {
        "format": {"const": FORMAT},
        "machine": _said("The profile that draws, unless --profile names another.", enum=list(PROFILES)),
        "width": _said("Pixels of the window.", **edge),
        "height": _said("Pixels of the window.", **edge),
        "pixel": _said(
            "x and y of the pixel, from the top left of the window, y downwards; otherwise 0, 0.",
            **_list(_WHOLE, minItems=2, maxItems=2),
        ),
        "depth_bits": _said("Of the depth buffer; otherwise the machine's widest.", anyOf=depths),
        "color_bits": _said("Of a component of the color buffer.", **_WHOLE),
        "clear": _said(
            "What the window holds first: colour 0, depth 1, stencil 0 otherwise.",
            **_object(clear, CLEAR_KEYS),
        ),
        "textures": _said(
            "Textures by the names that texture units give.",
            type="object",
            additionalProperties={"$ref": "#/$defs/texture"},
        ),
        "draws": _said(
            "Polygons, drawn one after the other.",
            **_list({"$ref": "#/$defs/draw"}, maxItems=MOST_DRAWS),
        ),
    }


def _texture(described):
    numbers = _list({}, minItems=1)
    return {
        "target": _said("TEXTURE_2D otherwise.", enum=list(TextureTarget.__members__)),
        "texels": _said(
            "Bytes [height][width][1, 3 or 4]; the first row is t = 0, as TexImage2D takes it. 1D: [width]; "
            "cube: [6][height][width]; 3D: [depth][height][width].",
            **numbers,
        ),
        "levels": _said("Texels of each level, level 0 first.", **numbers),
        "words": _said("Words of memory, [height][width], in the layout that `word` names.", **numbers),
        "indices": _said("Indices of `palette`, [height][width].", **numbers),
        "blocks": _said("S3TC blocks of all levels.", **_PLAIN[bytes]),
        "internal_format": _said("RGBA8 otherwise.", enum=list(InternalFormat.__members__)),
        "mipmaps": _said("Whether smaller levels are made, by halving.", **_PLAIN[bool]),
        "border": _said("Texels of a border on either side.", **_WHOLE),
        "word": {"enum": list(TexelWord.__members__)},
        "palette": _said("Words A8R8G8B8; a power of two of them.", **_list(_WHOLE)),
        "width": _said("Of blocks, texels; 4 otherwise.", **_WHOLE),
        "height": _said("Of blocks, texels; 4 otherwise.", **_WHOLE),
        "level_count": _said("Of blocks; 1 otherwise.", **_WHOLE),
    }


def _rows(components):
    number = {"$ref": "#/$defs/number"}
    if components is None:
        return _list(number, minItems=1, maxItems=MOST_VERTICES)
    row = _list(number, minItems=min(components), maxItems=max(components))
    return _list(row, minItems=1, maxItems=MOST_VERTICES)


def _mesh():
    said = {
        "primitive": _said("TRIANGLES otherwise.", enum=list(PrimitiveType.__members__)),
        "positions": "Object coordinates; without a matrix they are clip coordinates.",
        "window": "x and y in pixels from the top left, z from 0 to 1 (0), w (1), in place of positions.",
    }
    arrays = {name: _said(said[name], **_rows(components)) for name, components in POSITIONS.items()}
    arrays |= {name: _rows(components) for name, components in ARRAYS.items()}
    sets = _list(_rows((1, 4)))
    return {
        "primitive": said["primitive"],
        **arrays,
        "texture_coordinates": _said("Sets of coordinates; unit i reads set `coordinates`.", **sets),
    }


def _draw(described):
    return {
        "label": _TEXT,
        "mesh": {
            "description": "The polygon. Without positions it is a triangle over the whole window. An array "
            "with one row gives it to every vertex.",
            "$ref": "#/$defs/mesh",
        },
        "program": _said(
            "Combiners and texture shaders: RC1.0, TS1.0, ps.1.x, or words of the NV2A's registers; a text, "
            "or a list of lines.",
            anyOf=[_TEXT, _list(_TEXT)],
        ),
        "state": _described(PassState, described),
    }


def _described(kind, described):
    """The schema of a type's values. Schemas of dataclasses go into ``described``, by name."""
    if kind in _PLAIN:
        return _PLAIN[kind]
    if get_origin(kind) in (UnionType, Union):
        return {"anyOf": [_described(one, described) for one in get_args(kind)]}
    if get_origin(kind) is tuple:
        of, *more = get_args(kind)
        length = {} if more == [...] else {"minItems": 1 + len(more), "maxItems": 1 + len(more)}
        return _list(_described(of, described), **length)
    if not is_dataclass(kind):
        return {"enum": list(kind.__members__)}
    if kind.__name__ not in described:
        described[kind.__name__] = {}  # a type that holds its own kind finds this entry
        types = get_type_hints(kind)
        described[kind.__name__] = {
            "type": "object",
            "description": (kind.__doc__ or "").partition("\n\n")[0].replace("\n    ", " "),
            "properties": {f.name: _described(types[f.name], described) for f in fields(kind)},
            "required": [
                f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING
            ],
            "additionalProperties": False,
        }
    return {"$ref": f"#/$defs/{kind.__name__}"}


if __name__ == "__main__":
    print(json.dumps(json_schema(), indent=1))

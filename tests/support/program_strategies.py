"""Hypothesis strategies of programs in the notations of nvparse, as text."""

from hypothesis import strategies as st

_SOURCES = {
    "mov": 1,
    "add": 2,
    "sub": 2,
    "mul": 2,
    "dp3": 2,
    "dp4": 2,
    "mad": 3,
    "lrp": 3,
    "cnd": 3,
    "cmp": 3,
}
_SIGNS = ("", "", "", "-", "1-")
_MODIFIERS = ("", "", "", "_bx2", "_bias")
_SCALES = ("", "", "_x2", "_x4", "_d2")


@st.composite
def _sources(draw, registers, halves):
    register = draw(st.sampled_from(registers))
    sign = draw(st.sampled_from(_SIGNS))
    modifier = "" if sign == "1-" else draw(st.sampled_from(_MODIFIERS))
    selectors = ("", "", ".a", ".b") if halves == "a" else ("", "", ".a")
    return f"{sign}{register}{modifier}{draw(st.sampled_from(selectors))}"


@st.composite
def _instructions(draw, halves, paired=False):
    """An instruction that writes "rgba", "rgb" or "a"."""
    impossible = {"dp3"} if halves == "a" else set()
    impossible |= {"dp4"} if halves != "rgba" else set()
    impossible |= {"cmp"} if paired else set()
    name = draw(st.sampled_from([n for n in _SOURCES if n not in impossible]))
    registers = ["r0", "r1", "t0", "t1", "v0", "v1", "c0", "c1"]
    sources = [draw(_sources(registers, halves)) for _ in range(_SOURCES[name])]
    if name == "cnd":
        sources[0] = "r0.a"
    elif name == "lrp":
        sources[0] = draw(st.sampled_from(("", "1-"))) + draw(
            st.sampled_from(("r0", "r1.a", "t0", "v1.a", "c0"))
        )
    elif name == "cmp" and halves != "a":
        sources[0] = draw(st.sampled_from(("", "-"))) + draw(
            st.sampled_from(("r1.a", "t0_bx2.a", "v0_bias.a"))
        )
    modifiers = draw(st.sampled_from(_SCALES)) + draw(st.sampled_from(("", "_sat")))
    destination = draw(st.sampled_from(("r0", "r0", "r1", "t1"))) + ("" if halves == "rgba" else f".{halves}")
    return f"{name}{modifiers} {destination}, {', '.join(sources)}"


@st.composite
def pixel_shaders(draw, most=6):
    """ps.1.3 programs of two textures, two colors and two constants; some take more than the machine has."""
    lines = ["ps.1.3"]
    for number in (0, 1):
        color = draw(st.tuples(*[st.integers(0, 255)] * 4))
        signs = draw(st.sampled_from(((1,) * 4, (1,) * 4, (-1,) * 4, (1, -1, 1, -1))))
        values = (f"{sign * c / 255:.6f}" for sign, c in zip(signs, color, strict=True))
        lines.append(f"def c{number}, {', '.join(values)}")
    lines += [
        "tex t0",
        "tex t1",
        "mov r0, v0",
        draw(st.sampled_from(("mov r1, v1", "dp3 r1, t0_bx2, v0_bx2"))),
    ]
    for _ in range(draw(st.integers(1, most))):
        if draw(st.booleans()):
            lines.append(draw(_instructions(draw(st.sampled_from(("rgba", "rgba", "rgb", "a"))))))
            continue
        color, alpha = draw(_instructions("rgb", True)), draw(_instructions("a", True))
        lines += [color, f"+ {alpha}"]
    return "\n".join(lines) + "\n"


_GROUPS = {
    "dot_product_2d": 2,
    "dot_product_rectangle": 2,
    "dot_product_depth_replace": 2,
    "dot_product_3d": 3,
    "dot_product_cube_map": 3,
    "dot_product_reflect_cube_map_eye_from_qs": 3,
    "dot_product_reflect_cube_map_const_eye": 3,
    "dot_product_cube_map_and_reflect_cube_map_eye_from_qs": 3,
    "dot_product_cube_map_and_reflect_cube_map_const_eye": 3,
}
_numbers = st.floats(-8, 8).map(lambda x: format(x, ".6f"))


@st.composite
def texture_shaders(draw):
    """!!TS1.0 programs that NV_texture_shader finds consistent."""
    lines = [f"texture_{draw(st.sampled_from(('1d', '2d', '3d', 'rectangle', 'cube_map')))}();"]
    results = [0]
    while len(lines) < 4 and draw(st.integers(0, 3)):
        unit = len(lines)
        previous = f"tex{draw(st.sampled_from(results))}"
        kind = draw(st.sampled_from(("plain", "nop", "cull", "offset", "dependent", "group", "group")))
        numbers = ", ".join(draw(_numbers) for _ in range(4))
        if kind == "plain":
            lines.append(draw(st.sampled_from(("texture_2d();", "pass_through();", "texture_3d();"))))
        elif kind == "nop":
            lines.append("nop();")
        elif kind == "cull":
            modes = (draw(st.sampled_from(("GEQUAL_TO_ZERO", "LESS_THAN_ZERO"))) for _ in range(4))
            lines.append(f"cull_fragment({', '.join(modes)});")
        elif kind == "offset":
            shape, scaled = draw(st.sampled_from(("2d", "rectangle"))), draw(st.booleans())
            more = f", {draw(_numbers)}, {draw(_numbers)}" if scaled else ""
            lines.append(f"offset_{shape}{'_scale' if scaled else ''}({previous}, {numbers}{more});")
        elif kind == "dependent":
            lines.append(f"dependent_{draw(st.sampled_from(('ar', 'gb')))}({previous});")
        else:
            group = draw(
                st.sampled_from([g for g, length in _GROUPS.items() if unit + length <= 4] or ["nop"])
            )
            for k in range(_GROUPS.get(group, 0)):
                source = f"expand({previous})" if draw(st.booleans()) else previous
                eye = f", {numbers.rpartition(', ')[0]}" if group.endswith("const_eye") and k == 0 else ""
                lines.append(f"{group}_{k + 1}of{_GROUPS[group]}({source}{eye});")
            if group == "nop":
                lines.append("nop();")
            continue
        if kind not in ("nop", "cull"):
            results.append(unit)
    return "!!TS1.0\n" + "\n".join(lines) + "\n"


@st.composite
def mutated(draw, texts):
    """A text with a few characters, words or lines lost, doubled, changed or exchanged."""
    text = draw(texts)
    for _ in range(draw(st.integers(1, 4))):
        at, length = draw(st.integers(0, len(text))), draw(st.integers(0, 8))
        piece = text[at : at + length]
        other = draw(st.integers(0, len(text)))
        inserted = draw(
            st.sampled_from(
                ("", piece * 2, text[other : other + length], "+", ",", "1-", "_x2", ".a", "\n", "t3", "é")
            )
            | st.text(max_size=3)
        )
        text = text[:at] + inserted + text[at + length :]
    return text


_XBOX_OPERANDS = {
    "mov": (1, 1),
    "add": (1, 2),
    "sub": (1, 2),
    "mul": (1, 2),
    "dp3": (1, 2),
    "mad": (1, 3),
    "lrp": (1, 3),
    "cnd": (1, 3),
    "xmma": (3, 4),
    "xmmc": (3, 4),
    "xdm": (2, 4),
    "xdd": (2, 4),
}


@st.composite
def _xbox_instructions(draw, halves):
    """An instruction of xps.1.1 that writes "rgba", "rgb" or "a"."""
    dotted = {"dp3", "xdm", "xdd"} if halves == "a" else set()
    name = draw(st.sampled_from([name for name in _XBOX_OPERANDS if name not in dotted]))
    of_destinations, of_sources = _XBOX_OPERANDS[name]
    mask = "" if halves == "rgba" else f".{halves}"
    first = draw(st.sampled_from(("r0", "r0", "r1", "t1", "discard")))
    others = draw(st.permutations([r for r in ("r0", "r1", "t1", "v0", "discard", "discard") if r != first]))
    kept = draw(st.permutations((first, *others[: of_destinations - 1])))
    destinations = [register + mask for register in kept]
    sources = []
    for _ in range(of_sources):
        sign = draw(st.sampled_from(_SIGNS))
        modifiers = {"": ("", "", "_bx2", "_bias", "_sat"), "-": ("", "_bx2", "_bias"), "1-": ("", "_sat")}
        register = draw(st.sampled_from(("c0", "c1", "r0", "r1", "t0", "t1", "v0", "v1", "c0", "c1", "zero")))
        selector = draw(st.sampled_from(("", "", ".a", ".b", ".rgb")))
        sources.append(f"{sign}{register}{draw(st.sampled_from(modifiers[sign]))}{selector}")
    if name == "cnd":
        sources[0] = draw(st.sampled_from(("r0", "r0.a")))
    elif name == "lrp":
        sources[0] = draw(st.sampled_from(("r0", "1-t0.a", "c0", "1-v0_sat")))
    modifier = draw(st.sampled_from(("", "", "_x2", "_x4", "_d2", "_bias", "_bx2")))
    return f"{name}{modifier} {', '.join((*destinations, *sources))}"


@st.composite
def xbox_pixel_shaders(draw, most=5):
    """xps.1.1 programs of two textures, two colors and two constants, with a final combiner or without."""
    color = st.tuples(*[st.integers(0, 255)] * 4).map(lambda c: ", ".join(f"{x / 255:.6f}" for x in c))
    lines = ["xps.1.1", f"def c0, {draw(color)}", f"def c1, {draw(color)}", "tex t0", "tex t1"]
    lines += ["mov r0, v0", "mov r1, v1"]
    for _ in range(draw(st.integers(1, most))):
        if draw(st.booleans()):
            lines.append(draw(_xbox_instructions(draw(st.sampled_from(("rgba", "rgb", "a"))))))
        else:
            lines += [draw(_xbox_instructions("rgb")), f"+ {draw(_xbox_instructions('a'))}"]
    if draw(st.booleans()):
        plain = ("r0", "r0", "r1.a", "t0", "v0", "1-v1", "1-r1", "c1", "zero", "fog.a", "1-fog")
        inputs = [draw(st.sampled_from((*plain, "prod") if k < 4 else plain)) for k in range(6)]
        inputs[1] = draw(st.sampled_from((inputs[1], "sum")))
        lines.append(f"xfc {', '.join((*inputs, draw(st.sampled_from(('r0.a', '1-r1.a', 't0.b', 'v0')))))}")
    return "\n".join(lines) + "\n"

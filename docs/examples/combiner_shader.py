"""A shader generator in small: the NV2A's combiner registers as a fragment shader of the exported functions.

    fixedpipe golden export code --code glsl
    python combiner_shader.py code WORDS > shader.frag

WORDS is a text of lines such as NV097_SET_COMBINER_COLOR_ICW[0] = 0xc8c40000. The registers become
constants of the shader, so its compiler keeps what they choose and drops the rest.
"""

import re
import sys
from pathlib import Path


def words_of(text):
    """{(method, number): word} of lines that name a method; one without a number has number 0."""
    found = re.findall(r"NV097_(\w+?)(?:\[(\d+)\])?\s*=\s*(0x[0-9a-fA-F]+)", text)
    return {(method, int(number or 0)): int(word, 16) for method, number, word in found}


def main_function(words):
    """GLSL of ``ivec4 combined(ivec4 texels[4], ivec4 primary, ivec4 secondary, ivec4 fog)``, bytes in and
    out.
    """

    def word(method, number=0):
        return f"{words.get((method, number), 0):#x}u"

    control = words[("SET_COMBINER_CONTROL", 0)]
    lines = ["    ivec4 file[16];", "    for (int k = 0; k < 4; k++) file[8 + k] = texels[k];"]
    lines += [f"    file[{row}] = {name};" for row, name in ((3, "fog"), (4, "primary"), (5, "secondary"))]
    lines.append("    nv2a_first_registers(file);")
    for stage in range(control & 0xFF):
        for constant, each_stage in ((0, control >> 12 & 1), (1, control >> 16 & 1)):
            factor = word(f"SET_COMBINER_FACTOR{constant}", stage if each_stage else 0)
            lines.append(f"    nv2a_constant({factor}, file[{1 + constant}]);")
        methods = ("COLOR_ICW", "COLOR_OCW", "ALPHA_ICW", "ALPHA_OCW")
        registers = ", ".join(word(f"SET_COMBINER_{method}", stage) for method in methods)
        lines.append(f"    nv2a_general_combiner(file, {registers}, {control >> 8 & 1});")
    for constant in (0, 1):
        lines.append(f"    nv2a_constant({word('SET_SPECULAR_FOG_FACTOR', constant)}, file[{1 + constant}]);")
    cw0, cw1 = (word(f"SET_COMBINER_SPECULAR_FOG_CW{k}") for k in (0, 1))
    lines += ["    ivec4 color;", f"    nv2a_final_combiner(file, {cw0}, {cw1}, color);", "    return color;"]
    head = "ivec4 combined(ivec4 texels[4], ivec4 primary, ivec4 secondary, ivec4 fog) {"
    return "\n".join([head, *lines, "}"])


def fragment_shader(library, words):
    """A whole shader for GLSL 3.30: textures and colours in, an integer target out."""
    return f"""#version 330 core
{library}
{main_function(words)}
uniform usampler2D textures[4];
flat in ivec4 primary, secondary;
in vec2 places[4]; // texels
out uvec4 color;
void main() {{
    ivec4 texels[4];
    texels[0] = ivec4(texelFetch(textures[0], ivec2(floor(places[0])), 0));
    texels[1] = ivec4(texelFetch(textures[1], ivec2(floor(places[1])), 0));
    texels[2] = ivec4(texelFetch(textures[2], ivec2(floor(places[2])), 0));
    texels[3] = ivec4(texelFetch(textures[3], ivec2(floor(places[3])), 0));
    color = uvec4(combined(texels, primary, secondary, ivec4(0)));
}}
"""


if __name__ == "__main__":
    code, text = (Path(argument) for argument in sys.argv[1:])
    print(fragment_shader((code / "nv2a.glsl").read_text(), words_of(text.read_text())))

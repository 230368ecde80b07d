"""The grammars of the notations of the time, as data; ``notation_states`` says what texts of them mean.

Written from what defines the notations and from nothing that reads them here. Source: ``!!RC1.0`` and
``!!TS1.0``: nvparse's own description of the two ("nvparse.pdf", NVIDIA 2000) and the productions of its
parsers, for what NV_register_combiners and NV_texture_shader have; ``ps.1.0`` to ``ps.1.3``: the DirectX 8.1
reference of pixel shaders (instructions, modifiers, selectors, write masks).
"""

from tests.support.grammar import Grammar

_NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)"

REGISTER_COMBINERS = Grammar(
    r"""
    program = "!!RC1.0" { constant } { stage } { before } output [ output ] .
    constant = /const[01]/ "=" "(" number "," number "," number "," number ")" ";" .
    number = /[-+]?\.?[0-9].*/ .

    stage = "{" { constant } portion [ portion ] "}" .
    portion = /rgb|alpha/ "{" product [ product [ total ] ] [ scale ] "}" .
    product = target "=" input [ ( "*" | "." ) input ] ";" .
    total = target "=" /sum|mux/ "(" ")" ";" .
    scale = /scale_by_(one_half|two|four)|bias_by_negative_one_half(_scale_by_two)?/ "(" ")" ";" .
    target = /(zero|const[01]|fog|col[01]|tex[0-3]|spare[01])(\.(rgb|a|b))?|discard|color_sum|final_product/ .
    input = "-" /expand|half_bias/ "(" register ")"
          | /expand|half_bias|unsigned|unsigned_invert/ "(" register ")"
          | [ "-" ] register .
    register = /(zero|one|const[01]|fog|col[01]|tex[0-3]|spare[01])(\.(rgb|a|b))?/ .

    before = product_of_two | clamp .
    product_of_two = "final_product" "=" last "*" last ";" .
    clamp = "clamp_color_sum" "(" ")" ";" .
    output = "out.rgb" "=" ( blend [ "+" last ] | last "+" blend | last "*" last [ "+" last ]
                           | last [ "+" last ] ) ";"
           | "out.a" "=" last ";" .
    blend = "lerp" "(" last "," last "," last ")" .
    last = /unsigned|unsigned_invert/ "(" any ")" | any .
    any = /(zero|one|const[01]|fog|col[01]|tex[0-3]|spare[01])(\.(rgb|a|b))?|color_sum|final_product/ .
    """,
    rf"""\s+ | (?://|\#)[^\n]* | /\*.*?\*/
       | (?P<word> !!RC1\.0(?![0-9.]) | [-+]?{_NUMBER}(?![A-Za-z0-9_.])
         | [A-Za-z_][A-Za-z0-9_]*(?:\.(?:rgb|a|b)(?![A-Za-z0-9_]))? | [-+*.,;=(){{}}] )""",
)

TEXTURE_SHADERS = Grammar(
    r"""
    program = "!!TS1.0" instruction { instruction } .
    instruction = ( plain | cull | offset | scaled_offset | dependent | eye | dot ) ";" .
    plain = /nop|texture_(1d|2d|3d|rectangle|cube_map)|pass_through/ "(" ")" .
    cull = "cull_fragment" "(" condition "," condition "," condition "," condition ")" .
    condition = /GEQUAL_TO_ZERO|LESS_THAN_ZERO/ .
    offset = /offset_(2d|rectangle)/ "(" texel "," number "," number "," number "," number ")" .
    scaled_offset = /offset_(2d|rectangle)_scale/
                    "(" texel "," number "," number "," number "," number "," number "," number ")" .
    dependent = /dependent_(ar|gb)/ "(" texel ")" .
    eye = /dot_product_(cube_map_and_)?reflect_cube_map_const_eye_1of3/
          "(" mapped "," number "," number "," number ")" .
    dot = ( /dot_product_(2d|rectangle|depth_replace)_[12]of2/ | /dot_product_(3d|cube_map)_[123]of3/
          | /dot_product_(cube_map_and_)?reflect_cube_map_eye_from_qs_[123]of3/
          | /dot_product_(cube_map_and_)?reflect_cube_map_const_eye_[23]of3/ ) "(" mapped ")" .
    mapped = "expand" "(" texel ")" | texel .
    texel = /tex[012]/ .
    number = /[-+]?\.?[0-9].*/ .
    """,
    rf"""\s+ | (?://|\#)[^\n]* | /\*.*?\*/
       | (?P<word> !!TS1\.0(?![0-9.]) | [-+]?{_NUMBER}(?![A-Za-z0-9_.])
         | [A-Za-z_][A-Za-z0-9_]* | [,;()] )""",
)

_SELECTOR = r"(\.(rgba?|xyzw?|aaaa|aaa|a|wwww|www|w|bbbb|bbb|b|zzzz|zzz|z))?"
_CHANGES = "((_x2|_x4|_d2)?(_sat)?|_sat(_x2|_x4|_d2))"
PIXEL_SHADER = Grammar(
    rf"""
    program = /ps[._]1[._][0123]/ {{ nop | definition }} {{ nop | texture }} {{ nop | pair }} .
    nop = "nop" .
    definition = "def" /c[0-7]/ "," number "," number "," number "," number .
    number = [ "+" | "-" ] /[.0-9].*/ .

    texture = /tex|texcoord|texkill/ place
            | /texbeml?|texreg2(ar|gb|rgb)|texm3x2(pad|tex|depth)|texm3x3(pad|tex|vspec)?|texdp3(tex)?/
              place "," source
            | "texm3x3spec" place "," source "," source .
    place = /t[0-3](\.(rgba|xyzw))?/ .

    pair = arithmetic [ "+" arithmetic ] .
    arithmetic = /mov{_CHANGES}/ target "," source
               | /(add|sub|mul|dp3|dp4){_CHANGES}/ target "," source "," source
               | /(mad|lrp|cnd|cmp){_CHANGES}/ target "," source "," source "," source .
    target = /[rv][01](\.(rgba?|xyzw?|a|w))?|t[0-3](\.(rgba?|xyzw?|a|w))?/ .
    source = [ "-" | one "-" ] /([rv][01]|t[0-3]|c[0-7])(_bx2|_bias)?{_SELECTOR}/ .
    one = /[.0-9].*/ .
    """,
    rf"""\s+ | (?://|;)[^\n]* | /\*.*?\*/
       | (?P<word> [px]?[pv]s[._][0-9x]+[._][0-9x]+ | {_NUMBER}(?:e[-+]?[0-9]+)?f?(?![a-z0-9_.])
         | [a-z_][a-z0-9_]*(?:\.[a-z]+)? | [-+,] )""",
    fold=True,
)

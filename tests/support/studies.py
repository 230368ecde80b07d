"""What tests of studies share."""

# Studies that take longer than about half a second.
<<<<<<< HEAD
SLOW = {"P4", "P7", "P8", "P11", "P14", "P19", "P22", "P23", "P24", "P31", "P32", "P36", "P38", "P40"}
=======
SLOW = {"P4", "P7", "P8", "P11", "P12", "P13", "P19", "P22", "P23", "P24", "P32", "P36", "P38", "P40"}
>>>>>>> 0f766a5 (P12: which texel a coordinate of few bits leads to, asked of samplers; P13: squares of the nearest texel at first hits)

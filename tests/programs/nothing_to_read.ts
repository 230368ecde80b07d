!!TS1.0
texture_2d();
nop();
dependent_ar(tex1);

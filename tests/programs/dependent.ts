!!TS1.0
texture_2d();
dependent_ar(tex0);
dependent_gb(tex1);

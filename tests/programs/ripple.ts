!!TS1.0
texture_2d();
offset_rectangle(tex0, 0.5, 0, 0, .5);
offset_2d_scale(tex0, 1, -0.25, +0.25, 1, 2, -0.5);

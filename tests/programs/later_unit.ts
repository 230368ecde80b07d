!!TS1.0
texture_2d();
offset_2d(tex2, 1, 0, 0, 1);

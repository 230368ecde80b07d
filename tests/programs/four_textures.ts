!!TS1.0
texture_2d();
texture_cube_map();
texture_3d();
texture_1d();

!!TS1.0
texture_2d();
dot_product_2d_1of2(tex0);
nop();
dot_product_2d_2of2(tex0);

!!TS1.0
texture_2d();
offset_2d(tex0, 0.1, 0, 0, 0.1);
nop();
nop();
// End of program
!!RC1.0
{
  rgb {
    spare0 = tex1 * col0;
  }
  alpha {
    spare0 = tex1;
  }
}
out.rgb = spare0;
out.a = spare0;

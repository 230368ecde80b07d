!!TS1.0
texture_rectangle();
nop();
pass_through();

"""What a pass is (frozen state), what a machine is (a profile), and running one on the other."""

"""The fleet in a physics engine that gaincert did not write, driven by the exported controller."""

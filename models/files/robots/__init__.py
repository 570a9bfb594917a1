"""Robot descriptions: URDF and xacro in, the numbers of (2) out, each with its source."""

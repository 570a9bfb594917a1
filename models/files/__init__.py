"""Files in and out: fleets, gains, starts, robots, templates."""

"""How much a fleet gains from hearing the leader: the slowest mode of D^-1 L_l for more and more leader links.

The fleet is the file that is named, else the ring of ten robots.
"""

import sys
from fractions import Fraction
from pathlib import Path

from gaincert.models.files.fleet_file import load_fleet
from gaincert.models.fleet_tables import Links
from gaincert.synthesis.modes import modes
from gaincert.synthesis.programs.weights import design_weights

RING = Path(__file__).parent.parent / "mixed_ring.toml"

fleet = load_fleet(Path(sys.argv[1]) if len(sys.argv) > 1 else RING)


def slowest(links: Links) -> float:
    """lambda_1, to which the settling times are inversely proportional."""
    return float(modes(fleet.with_links(links).plant().graph).eigenvalues[0])


print("vehicles that hear the leader, lambda_1")
for count in sorted({count for count in (1, 2, len(fleet) // 2, len(fleet)) if 1 <= count <= len(fleet)}):
    led = dict.fromkeys(fleet.names[:count], Fraction(1))
    print(f"{count:29}  {slowest(Links(edges=fleet.links.edges, leader_links=led)):.3f}")
own = len(fleet.links.leader_links)
print(f"as in the file, {own} of them      {slowest(fleet.links):.3f}")
print(f"the same {own}, designed weights   {slowest(design_weights(fleet)):.3f}")

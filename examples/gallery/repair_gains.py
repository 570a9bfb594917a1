"""Certify gains that somebody else chose, and repair the ones that break a condition."""

from dataclasses import replace
from pathlib import Path

from gaincert.models.files.fleet_file import load_fleet
from gaincert.models.files.gains_file import load_gains
from gaincert.verify.certificates.certify import certify

EXAMPLES = Path(__file__).parent.parent

fleet = load_fleet(EXAMPLES / "paper.toml")
chosen = load_gains(EXAMPLES / "paper_gains.toml", fleet)
print("the paper's gains:", certify(fleet, chosen.excitation, chosen.gains, "paper").verdict.valid)

louder = replace(chosen.gains, k_alpha=chosen.gains.k_alpha * 2)
certificate = certify(fleet, chosen.excitation, louder, "paper")
print("twice the excitation:", certificate.valid)
for violation in certificate.violations:
    print(" ", violation)

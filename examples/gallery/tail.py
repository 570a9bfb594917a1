"""The algebraic tail: the largest cross-track error of the paper's fleet against the averaged flow y' = -c(y)."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from gaincert.models.arrays import floats
from gaincert.models.files.fleet_file import load_fleet
from gaincert.models.files.gains_file import load_gains
from gaincert.synthesis.rates import CrossTrack
from gaincert.verify.simulation.simulate import simulate
from scipy.integrate import solve_ivp

EXAMPLES = Path(__file__).parent.parent
BEGIN, END = 10_000, 15_000  # s, where the two are compared

fleet = load_fleet(EXAMPLES / "paper.toml")
paper = load_gains(EXAMPLES / "paper_gains.toml", fleet)
plant = fleet.plant()

run = simulate(fleet, paper.gains, paper.excitation, horizon=END)
aside = np.array([-np.sin(plant.leader_theta), np.cos(plant.leader_theta)])
errors = np.stack([run.state.x - plant.offset_x - plant.leader_x, run.state.y - plant.offset_y - plant.leader_y])
across = np.tensordot(aside, errors, 1)

begin = np.searchsorted(run.t, BEGIN)
flow = CrossTrack(plant, paper.gains.map(floats), paper.excitation).flow
averaged = solve_ivp(lambda _, y: -flow(y), (BEGIN, END), across[begin], "LSODA", np.linspace(BEGIN, END, 50))

simulated, predicted = np.abs(across[-1]).max(), np.abs(averaged.y[:, -1]).max()
print(f"largest cross-track error at {END} s: simulated {simulated:.3f} m, averaged flow {predicted:.3f} m")
plt.loglog(run.t[::100], np.abs(across).max(axis=1)[::100], label="simulation")
plt.loglog(averaged.t, np.abs(averaged.y).max(axis=0), "k--", label="averaged flow")
plt.gca().set(xlabel="time / s", ylabel="largest cross-track error / m")
plt.legend()
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "tail.png", dpi=150)

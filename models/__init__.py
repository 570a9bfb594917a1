"""What the paper defines: vehicles, graph, excitation, controller, energies and conditions; no solver, no plot."""

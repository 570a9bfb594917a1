(** * Energies.v : the energies of the closed loop (L1, L3-L8), collected.
    EnergyDerivatives: what V and W are and how they change.  CouplingRates: how fast the pulls change.
    EnergyBounds, EnergyCoercive: V and W measure the distance to the formation, from above and from below.
    EnergyFamily: the combination of both that falls up to any prescribed rate. *)
From Gaincert Require Export PullBounds EnergyDerivatives CouplingRates EnergyBounds EnergyCoercive EnergyFamily.

(** * PaperAssumptions.v : what the theorems on the paper's own fleet rest on.
    The same four axioms as in Assumptions.v.  They stand apart because these proofs load coq-interval, which makes an
    independent check (coqchk) of everything below them slow; the main theorems do not need it. *)
From Gaincert Require Import Statement Formation UnitScales PaperFleet PaperErrorAfter20 PaperErrorRotationalEnergy
  PaperErrorTorque PaperErrorConstantExcitation PaperConclusion.

Print Assumptions formation_is_a_solution.
Print Assumptions equation_9_11.
Print Assumptions paper_fleet_meets_the_hypotheses.
Print Assumptions paper_fleet_reaches_its_formation.
Print Assumptions paper_fleet_keeps_its_torque_limits.
Print Assumptions inequality_after_20_is_false.
Print Assumptions rotational_energy_can_rise.
Print Assumptions rotational_energy_rises_on_a_solution.
Print Assumptions paragraph_bound_is_exceeded.
Print Assumptions proposition_1_bound_holds.
Print Assumptions constant_psi_is_not_enough.

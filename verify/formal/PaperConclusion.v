(** * PaperConclusion.v : what follows for the paper's own fleet.
    Idea: the hypotheses hold (PaperFleet), and so do (15) and (16) (PaperWitness); so Section 4 is as Proposition 1 says: the
    formation is reached from everywhere, uniformly, and no wheel torque ever passes the limits of Table 1.
    The lever arm is 2 R, as printed.  With arm R, for R half the distance between the wheels, (16 star) asks for more than
    the limits of vehicles 2, 4, 5 and 6. *)
From Coq Require Import Reals.
From Gaincert Require Import Statement Definitions PaperFleet PaperProposition1 PaperWitness.
Open Scope R_scope.

(** Its controller is that of the paper, word for word (PaperEquations). *)
Theorem paper_fleet_has_unit_scales : unit_scales paper_fleet.
Proof. repeat split. Qed.

Theorem paper_fleet_reaches_its_formation :
  uniformly_bounded paper_fleet /\ uniformly_stable paper_fleet /\ uniformly_attractive paper_fleet /\
  forall i t s, (i < 6)%nat -> 0 <= t ->
    Rabs (torque_plus paper_fleet t s i) < paper_torque_limit i /\
    Rabs (torque_minus paper_fleet t s i) < paper_torque_limit i.
Proof.
  destruct paper_fleet_meets_the_hypotheses as [H1 [H2 H3]]. destruct paper_fleet_meets_conditions_15_16 as [H15 H16].
  exact (proposition_1 paper_fleet paper_torque_limit paper_fleet_has_unit_scales H1 H2 H3 H15 H16).
Qed.

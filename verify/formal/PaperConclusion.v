(** * PaperConclusion.v : what the corrected theorem says of the paper's own fleet.
    Idea: the hypotheses hold (PaperFleet), so the theorem applies to Section 4 as it stands: the formation is reached
    from everywhere, uniformly, and no wheel torque ever passes the limits of Table 1, which are compared with (16 star).
    The lever arm is 2 R, as printed.  With arm R, for R half the distance between the wheels, (16 star) asks for more than
    the limits of vehicles 2, 4, 5 and 6. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics Torques PaperEquations PaperFleet PaperWitness.
Require Import Gaincert.Theorem. (* in full, since Theorem alone is a keyword *)
Open Scope R_scope.

(** Its controller is that of the paper, word for word (PaperEquations). *)
Theorem paper_fleet_has_unit_scales : unit_scales paper_fleet.
Proof. repeat split. Qed.

Theorem paper_fleet_reaches_its_formation :
  uniformly_bounded paper_fleet /\ uniformly_stable paper_fleet /\ uniformly_attractive paper_fleet.
Proof.
  destruct paper_fleet_meets_the_hypotheses as [H1 [H2 H3]].
  destruct (corrected_theorem_holds paper_fleet H1 H2 H3) as [Hbounded [Hstable [Hattractive _]]].
  exact (conj Hbounded (conj Hstable Hattractive)).
Qed.

Lemma paper_limits_suffice : forall i, (i < 6)%nat -> torque_limit paper_fleet i <= paper_torque_limit i.
Proof.
  intros i Hi. unfold torque_limit. rewrite (paper_degrees i Hi). revert i Hi.
  refine (six_cases _ _ _ _ _ _ _); cbn; interval.
Qed.

Theorem paper_fleet_keeps_its_torque_limits : forall i t s, (i < 6)%nat -> 0 <= t ->
  Rabs (torque_plus paper_fleet t s i) < paper_torque_limit i /\
  Rabs (torque_minus paper_fleet t s i) < paper_torque_limit i.
Proof.
  intros i t s Hi Ht. destruct paper_fleet_meets_the_hypotheses as [H1 [H2 H3]].
  pose proof (torque_bound_holds paper_fleet H1 H2 H3 i t s Hi Ht) as [Hplus Hminus].
  pose proof (paper_limits_suffice i Hi). split; lra.
Qed.

(** * PaperWitness.v : states and numbers for the theorems on the paper's errors.
    A witness is a state given by its errors (zbar_i - z_l), headings, speeds and turn rates (Formation.v); of the
    paper's fleet every quantity of the controller is then a closed number, which interval arithmetic bounds. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics Sums Saturations EnergyDerivatives Formation Existence PaperFleet.
Open Scope R_scope.

Lemma displaced_alpha : forall F dx dy heading speed turn t i,
  alpha F t (displaced F dx dy heading speed turn) i
  = k F i * psi F i t * (- sin (heading i) * coupling F (ls F) dx i + cos (heading i) * coupling F (ls F) dy i).
Proof.
  intros F dx dy heading speed turn t i. unfold alpha, across. rewrite displaced_ex, displaced_ey. reflexivity.
Qed.

(** D_i = a_il + l_ii of the paper's graph. *)
Lemma paper_degrees : forall i, (i < 6)%nat -> deg paper_fleet i = by_link 2 13 i.
Proof. refine (six_cases _ _ _ _ _ _ _); unfold deg, paper_fleet; cbn; lra. Qed.

(** The paper's gains meet both with its own psi, and with any other that is no larger. *)
Lemma paper_conditions : forall p dp ddp b0 b1 b2 window level, 0 <= b0 <= 24323283 / 10000000 ->
  let F := paper_fleet_excited_by p dp ddp b0 b1 b2 window level in condition_15 F /\ condition_16 F paper_torque_limit.
Proof.
  intros p dp ddp b0 b1 b2 window level Hb F.
  assert (D : forall i, (i < 6)%nat -> deg F i = by_link 2 13 i) by exact paper_degrees.
  split; [unfold condition_15|unfold condition_16, ubar_v, ubar_w]; change (N F) with 6%nat;
    intros i Hi; rewrite !(D i Hi); revert i Hi;
    refine (six_cases _ _ _ _ _ _ _); cbn; unfold tanh, sinh, cosh; interval.
Qed.

Lemma paper_fleet_meets_conditions_15_16 : condition_15 paper_fleet /\ condition_16 paper_fleet paper_torque_limit.
Proof. apply paper_conditions. lra. Qed.

(** ** Numbers that the witnesses share *)
Lemma far_is_saturated : forall x, 8 <= x -> 999999 / 1000000 <= tanh x <= 1.
Proof.
  intros x Hx. pose proof (tanh_le 8 x Hx) as Hmono. pose proof (tanh_lt_1 x).
  assert (H8 : 999999 / 1000000 <= tanh 8) by (unfold tanh, sinh, cosh; interval). lra.
Qed.

Lemma psi_at_its_peak : 24323282 / 10000000 <= paper_psi (PI / 5) <= 24323283 / 10000000.
Proof.
  pose proof paper_psi_peak. pose proof (paper_psi_bound (PI / 5)) as Hbound. apply Rabs_le_between in Hbound. lra.
Qed.

(** From every state there is a motion of the paper's fleet when psi is at its peak, and W changes there at [W_rate]. *)
Lemma motion_at_the_peak : forall s, exists X, X (PI / 5) = s /\ solution paper_fleet (PI / 5) X /\
  is_derive (fun t => W paper_fleet (X t)) (PI / 5) (W_rate paper_fleet (PI / 5) s).
Proof.
  intros s. destruct paper_fleet_meets_the_hypotheses as [H1 [H2 H3]].
  assert (Ht0 : 0 <= PI / 5) by (pose proof PI_RGT_0; lra).
  destruct (existence_holds paper_fleet H1 H2 H3 (PI / 5) s Ht0) as [X [Hstart HX]].
  exists X. split; [exact Hstart|]. split; [exact HX|].
  rewrite <- Hstart. apply (W_derivative paper_fleet (PI / 5) X (PI / 5) H1 H2 HX); lra.
Qed.

(** Every tanh in the goal is that of 0, of x or of - x: call the second t. *)
Ltac tanh_of x t :=
  repeat match goal with
  | |- context [tanh ?y] =>
      first [ replace (tanh y) with 0 by (symmetry; replace y with 0 by field; apply tanh_0)
            | replace (tanh y) with t by (unfold t; f_equal; field)
            | replace (tanh y) with (- t) by (unfold t; rewrite <- tanh_odd; f_equal; field) ]
  end.

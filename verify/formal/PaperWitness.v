(** * PaperWitness.v : states and numbers for the theorems on the paper's errors.
    A witness is a state given by its errors (zbar_i - z_l), headings, speeds and turn rates (Formation.v); of the
    paper's fleet every quantity of the controller is then a closed number, which interval arithmetic bounds. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Numerics Sums Saturations EnergyDerivatives Formation PaperFleet.
Open Scope R_scope.

Lemma displaced_alpha : forall F dx dy heading speed turn t i,
  alpha F t (displaced F dx dy heading speed turn) i
  = k F i * psi F i t * (- sin (heading i) * coupling F (ls F) dx i + cos (heading i) * coupling F (ls F) dy i).
Proof.
  intros F dx dy heading speed turn t i. unfold alpha, across. rewrite displaced_ex, displaced_ey. reflexivity.
Qed.

(** The derivative of W according to (20), with the controller's own alpha. *)
Definition W_rate (F : fleet) (t : R) (s : state) : R :=
  - Pw F s + sum (N F) (fun i => om s i * alpha F t s i / pw F i).

(** Condition (15) at unit scales, and D_i = a_il + l_ii of the paper's graph. *)
Definition condition_15 (F : fleet) : Prop := forall i, (i < N F)%nat -> cmax F i / tanh 1 <= dw F i.

Lemma paper_degrees : forall i, (i < 6)%nat -> deg paper_fleet i = by_link 2 13 i.
Proof. refine (six_cases _ _ _ _ _ _ _); unfold deg, paper_fleet; cbn; lra. Qed.

Lemma paper_condition_15 : condition_15 paper_fleet.
Proof.
  unfold condition_15, cmax. change (N paper_fleet) with 6%nat.
  intros i Hi. rewrite (paper_degrees i Hi). revert i Hi.
  refine (six_cases _ _ _ _ _ _ _); cbn; unfold tanh, sinh, cosh; interval.
Qed.

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

(** Every tanh in the goal is that of 0, of x or of - x: call the second t. *)
Ltac tanh_of x t :=
  repeat match goal with
  | |- context [tanh ?y] =>
      first [ replace (tanh y) with 0 by (symmetry; replace y with 0 by field; apply tanh_0)
            | replace (tanh y) with t by (unfold t; f_equal; field)
            | replace (tanh y) with (- t) by (unfold t; rewrite <- tanh_odd; f_equal; field) ]
  end.

(** * PaperProposition1.v : Proposition 1 of the paper is true as it is stated, although its proof is not.
    Idea: the corrected theorem needs neither (15) nor unit scales; and (16) asks for no less than (16 star), since the root
    of a sum of squares is at most the sum. *)
From Coq Require Import Reals Lra.
From Gaincert Require Import Statement Definitions Sums Torques.
Require Import Gaincert.Theorem. (* in full, since Theorem alone is a keyword *)
Open Scope R_scope.

Lemma root_of_squares_le : forall x y, 0 <= x -> 0 <= y -> sqrt (x ^ 2 + y ^ 2) <= x + y.
Proof. intros x y Hx Hy. rewrite <- (sqrt_pow2 (x + y)) by lra. apply sqrt_le_1_alt. nra. Qed.

Lemma condition_16_suffices : forall F limit, A1 F -> A2 F -> A3 F -> condition_16 F limit ->
  forall i, (i < N F)%nat -> torque_limit F i <= limit i.
Proof.
  intros F limit [Ha [Hal _]] [_ [_ HA2]] [_ [_ HA3]] H16 i Hi.
  destruct (HA2 i Hi) as (_ & _ & Hwr & Harm & Hpv & _ & _ & _ & Hk & _).
  destruct (HA3 i Hi 0 (Rle_refl 0)) as (_ & _ & Hpsi & _).
  assert (Hpsi0 : 0 <= psi0 F) by (pose proof (Rabs_pos (psi F i 0)); lra).
  assert (Hdeg : 0 <= deg F i).
  { unfold deg. pose proof (Hal i Hi).
    assert (0 <= sum (N F) (fun j => a F i j)) by (apply sum_nonneg; intros j Hj; apply (Ha i j Hi Hj)). lra. }
  set (q := sqrt 2 * deg F i).
  assert (Hq : 0 <= q) by (apply Rmult_le_pos; [apply sqrt_pos|exact Hdeg]).
  set (c := k F i * psi0 F / arm F i).
  assert (Hc : 0 <= c) by (apply Rmult_le_pos; [nra|apply Rlt_le, Rinv_0_lt_compat; exact Harm]).
  pose proof (Rmult_le_compat_l q _ _ Hq (root_of_squares_le (pv F i) c (Rlt_le _ _ Hpv) Hc)) as Hroot.
  specialize (H16 i Hi). unfold ubar_v, ubar_w in H16.
  replace (arm F i * (dv F i + sqrt 2 * pv F i * deg F i) + (dw F i + pw F i * deg F i + sqrt 2 * k F i * psi0 F * deg F i))
    with (arm F i * (dv F i + q * (pv F i + c) + (dw F i + pw F i * deg F i) / arm F i)) in H16
    by (unfold q, c; field; lra).
  replace (2 * arm F i / wr F i * limit i) with (arm F i * (2 / wr F i * limit i)) in H16 by (field; lra).
  apply Rmult_lt_reg_l in H16; [|exact Harm].
  unfold torque_limit. fold q. fold c.
  apply Rle_trans with (wr F i / 2 * (2 / wr F i * limit i)); [|right; field; lra].
  apply Rmult_le_compat_l; lra.
Qed.

(** The lever arm of Definitions.v is 2 R, as printed.  Unit scales and (15) are not used. *)
Theorem proposition_1 : forall F limit, unit_scales F -> A1 F -> A2 F -> A3 F -> condition_15 F -> condition_16 F limit ->
  uniformly_bounded F /\ uniformly_stable F /\ uniformly_attractive F /\
  forall i t s, (i < N F)%nat -> 0 <= t ->
    Rabs (torque_plus F t s i) < limit i /\ Rabs (torque_minus F t s i) < limit i.
Proof.
  intros F limit _ H1 H2 H3 _ H16.
  destruct (corrected_theorem_holds F H1 H2 H3) as (Hbounded & Hstable & Hattractive & Htorque & _).
  split; [exact Hbounded|]. split; [exact Hstable|]. split; [exact Hattractive|].
  intros i t s Hi Ht. destruct (Htorque i t s Hi Ht) as [Hplus Hminus].
  pose proof (condition_16_suffices F limit H1 H2 H3 H16 i Hi). split; lra.
Qed.

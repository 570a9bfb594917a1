(** * Dichotomy.v : L13, over a window either the energy falls or the error is small at its start.
    If some vehicle is fast at some moment of a window, the energy Y falls by a fixed amount over it.
    If all are slow all the time, the window lemma says that the error was small at the start.
    The energy cannot fall for ever: the error is small at some moment before a time known in advance. *)
From Coq Require Import Reals Lra Lia Classical.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Calculus Energies Spikes Window.
Open Scope R_scope.

(** A solution from t0 on is one from any later time on. *)
Lemma solution_later : forall F t0 t1 X, solution F t0 X -> t0 <= t1 -> solution F t1 X.
Proof. intros F t0 t1 X HX H i Hi t Ht. apply (HX i Hi). lra. Qed.

Lemma window_dichotomy : forall F, A1 F -> A2 F -> A3 F -> forall eps, 0 < eps ->
  exists gam, 0 < gam /\ forall t0 X t (Y : R -> R) e, 0 <= t0 -> t0 <= t -> solution F t0 X ->
    (forall x, t <= x <= t + T F -> exists l, is_derive Y x l /\ l <= - (Pw F (X x) + Pv F (X x)) + e) ->
    err F (X t) <= eps \/ Y (t + T F) <= Y t + e * T F - gam.
Proof.
  intros F HA1 HA2 HA3 eps Heps.
  destruct (window_small F HA1 HA2 HA3 eps Heps) as [eta [Heta Hsmall]].
  destruct (driving_window_falls F HA1 HA2 HA3 eta Heta) as [g1 [Hg1 Hdrive]].
  destruct (turning_window_falls F HA1 HA2 HA3 eta Heta) as [g2 [Hg2 Hturn]].
  exists (Rmin g1 g2). split; [apply Rmin_glb_lt; assumption |].
  intros t0 X t Y e Ht0 Ht HX HY.
  destruct (classic (exists s i, t <= s <= t + T F /\ (i < N F)%nat /\ eta < Rabs (v (X s) i))) as [H1 | H1].
  - right. assert (H : Y (t + T F) <= Y t + e * T F - g1).
    { apply (Hdrive t0 X t Y e Ht0 Ht HX); [| assumption].
      intros x Hx. destruct (HY x Hx) as [l [Hl Hle]]. exists l. split; [assumption |].
      generalize (Pw_nonneg F (X x) HA1 HA2). lra. }
    generalize (Rmin_l g1 g2). lra.
  - destruct (classic (exists s i, t <= s <= t + T F /\ (i < N F)%nat /\ eta < Rabs (om (X s) i))) as [H2 | H2].
    + right. assert (H : Y (t + T F) <= Y t + e * T F - g2).
      { apply (Hturn t0 X t Y e Ht0 Ht HX); [| assumption].
        intros x Hx. destruct (HY x Hx) as [l [Hl Hle]]. exists l. split; [assumption |].
        generalize (Pv_nonneg F (X x) HA1 HA2). lra. }
      generalize (Rmin_r g1 g2). lra.
    + left. apply (Hsmall t0 X t Ht0 Ht HX). intros s i Hs Hi. split.
      * apply Rnot_lt_le. intro Hfast. apply H1. exists s, i. auto.
      * apply Rnot_lt_le. intro Hfast. apply H2. exists s, i. auto.
Qed.

(** Uniform reach: from any error below r the error is below eps at some moment before tau. *)
Lemma uniform_reach : forall F, A1 F -> A2 F -> A3 F -> forall r eps, 0 < eps ->
  exists tau, 0 <= tau /\ forall t0 X, 0 <= t0 -> solution F t0 X -> err F (X t0) <= r ->
    exists t, t0 <= t <= t0 + tau /\ err F (X t) <= eps.
Proof.
  intros F HA1 HA2 HA3 r eps Heps.
  assert (HT : 0 < T F) by apply HA3.
  destruct (window_dichotomy F HA1 HA2 HA3 eps Heps) as [gam [Hgam Hdich]].
  destruct (energy_family F HA1 HA2 HA3) as [C0 [HC0 Hfam]].
  set (e := gam / (2 * T F)).
  assert (He : 0 < e) by (apply Rdiv_lt_0_compat; lra).
  assert (HeT : e * T F = gam / 2) by (unfold e; field; lra).
  destruct (Hfam e He) as [K [Y [HK [HYb HYd]]]].
  destruct (energies_bounded F HA1 HA2 r) as [B HB].
  set (top := B + (K + 2) * B + C0).
  destruct (nfloor_ex (Rmax 0 ((top + C0) / (gam / 2)))) as [n [_ Hn]]; [apply Rmax_l |].
  assert (Hn1 : top + C0 < INR (S n) * (gam / 2)).
  { rewrite S_INR. replace (top + C0) with ((top + C0) / (gam / 2) * (gam / 2)) by (field; lra).
    apply Rmult_lt_compat_r; [lra |]. apply Rle_lt_trans with (2 := Hn). apply Rmax_r. }
  exists (INR (S n) * T F). split; [apply Rmult_le_pos; [apply pos_INR | lra] |].
  intros t0 X Ht0 HX Hr. apply NNPP. intro Hnone.
  assert (Hfall : forall p, (p <= S n)%nat ->
            Y (t0 + INR p * T F) (X (t0 + INR p * T F)) <= top - INR p * (gam / 2)).
  { induction p as [| p IH]; intros Hp.
    - simpl. rewrite !Rmult_0_l, Rplus_0_r.
      destruct (HYb t0 (X t0) Ht0) as [_ Hup]. destruct (HB (X t0) Hr) as [HV HW].
      apply Rle_trans with (1 := Hup). unfold top.
      assert ((K + 2) * V F (X t0) <= (K + 2) * B) by (apply Rmult_le_compat_l; lra). lra.
    - specialize (IH ltac:(lia)).
      assert (Hp0 : 0 <= INR p * T F) by (apply Rmult_le_pos; [apply pos_INR | lra]).
      assert (Hp1 : INR p * T F <= INR (S n) * T F).
      { apply Rmult_le_compat_r; [lra |]. apply le_INR. lia. }
      assert (Heq : t0 + INR (S p) * T F = t0 + INR p * T F + T F) by (rewrite S_INR; ring).
      rewrite Heq.
      destruct (Hdich t0 X (t0 + INR p * T F) (fun x => Y x (X x)) e Ht0 ltac:(lra) HX) as [Hs | Hs].
      + intros x Hx. apply (HYd t0 X Ht0 HX x). lra.
      + exfalso. apply Hnone. exists (t0 + INR p * T F). split; [lra | assumption].
      + rewrite S_INR. simpl in Hs. lra. }
  specialize (Hfall (S n) (le_n _)).
  set (t1 := t0 + INR (S n) * T F) in *.
  assert (Ht1 : 0 <= t1).
  { unfold t1. assert (0 <= INR (S n) * T F) by (apply Rmult_le_pos; [apply pos_INR | lra]). lra. }
  destruct (HYb t1 (X t1) Ht1) as [Hlow _].
  generalize (W_nonneg F (X t1) HA1 HA2). intro HW.
  assert (0 <= K * V F (X t1)) by (apply Rmult_le_pos; [assumption | apply V_nonneg; assumption]).
  lra.
Qed.

(** The energy V never rises. *)
Lemma V_nonincreasing : forall F t0 X, A1 F -> A2 F -> solution F t0 X ->
  forall t, t0 <= t -> V F (X t) <= V F (X t0).
Proof.
  intros F t0 X HA1 HA2 HX t Ht.
  assert (H : (fun x => V F (X x)) t - (fun x => V F (X x)) t0 <= 0 * (t - t0)).
  { apply (increment_le (fun x => V F (X x)) t0 t 0); [assumption |]. intros x Hx. exists (- Pv F (X x)). split.
    - apply (V_derivative F t0 X x HA1 HA2 HX). lra.
    - generalize (Pv_nonneg F (X x) HA1 HA2). lra. }
  simpl in H. lra.
Qed.

(** Up to any fixed time after the start the error is bounded in terms of the error at the start. *)
Lemma bounded_meanwhile : forall F, A1 F -> A2 F -> A3 F -> forall r tau, exists B,
  forall t0 X, 0 <= t0 -> solution F t0 X -> err F (X t0) <= r ->
  forall t, t0 <= t <= t0 + tau -> err F (X t) <= B.
Proof.
  intros F HA1 HA2 HA3 r tau.
  destruct (energy_family F HA1 HA2 HA3) as [C0 [HC0 Hfam]].
  destruct (Hfam 1 Rlt_0_1) as [K [Y [HK [HYb HYd]]]].
  destruct (energies_bounded F HA1 HA2 r) as [B HB].
  set (top := B + (K + 2) * B + C0).
  destruct (err_bounded F HA1 HA2 (Rmax B (top + tau + C0))) as [B' HB'].
  exists B'. intros t0 X Ht0 HX Hr t Ht. destruct (HB (X t0) Hr) as [HV HW]. apply HB'.
  - apply Rle_trans with B; [| apply Rmax_l].
    apply Rle_trans with (V F (X t0)); [| assumption]. apply V_nonincreasing; try assumption; lra.
  - apply Rle_trans with (top + tau + C0); [| apply Rmax_r].
    assert (Hrise : (fun x => Y x (X x)) t - (fun x => Y x (X x)) t0 <= 1 * (t - t0)).
    { apply (increment_le (fun x => Y x (X x)) t0 t 1); [lra |]. intros x Hx.
      destruct (HYd t0 X Ht0 HX x) as [l [Hl Hle]]; [lra |]. exists l. split; [assumption |].
      generalize (Pw_nonneg F (X x) HA1 HA2) (Pv_nonneg F (X x) HA1 HA2). lra. }
    simpl in Hrise.
    destruct (HYb t0 (X t0) Ht0) as [_ Hup]. destruct (HYb t (X t)) as [Hlow _]; [lra |].
    assert ((K + 2) * V F (X t0) <= (K + 2) * B) by (apply Rmult_le_compat_l; lra).
    assert (0 <= K * V F (X t)) by (apply Rmult_le_pos; [assumption | apply V_nonneg; assumption]).
    unfold top. lra.
Qed.

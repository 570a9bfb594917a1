(** * Stability.v : L14, small errors stay small, by the window dichotomy once more.
    V never rises, so positions and speeds stay small for ever, and with them the input alpha of the turning channel.
    Over a window either some turn rate is fast, and W falls by more than the small input can add,
    or none is, and the heading error was small at its start: W never climbs above its level. *)
From Coq Require Import Reals Lra Lia Classical.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus Energies WindowIncrements Spikes Window Dichotomy.
Open Scope R_scope.

(** The error is the error of position and speed plus the error of heading and turn rate. *)
Lemma err_split : forall F s, err F s =
  sum (N F) (fun i => Rabs (zx F s i) + Rabs (zy F s i) + Rabs (v s i))
  + sum (N F) (fun i => Rabs (tha F s i) + Rabs (om s i)).
Proof. intros F s. unfold err. rewrite <- sum_plus. apply sum_ext. intros i _. ring. Qed.

(** Where all errors are small, so is every pull. *)
Lemma coupling_small : forall F scale z d, A1 F -> 0 < scale ->
  (forall j, (j < N F)%nat -> Rabs (z j) <= d) ->
  forall i, (i < N F)%nat -> Rabs (coupling F scale z i) <= 2 * deg F i / scale * d.
Proof.
  intros F scale z d HA1 Hs Hz i Hi.
  assert (H0 : coupling F scale (fun _ => 0) i = 0).
  { assert (Ht : tanh (0 / scale) = 0) by (unfold Rdiv; rewrite Rmult_0_l; apply tanh_0).
    unfold coupling. rewrite Ht, sum_zero; [ring |].
    intros j _. rewrite Rminus_0_r, Ht. ring. }
  replace (coupling F scale z i) with (coupling F scale z i - coupling F scale (fun _ => 0) i) by (rewrite H0; ring).
  apply (coupling_increment F HA1 scale Hs (fun _ => 0)); [exact Hi |].
  intros j Hj. rewrite Rminus_0_r. apply Hz; exact Hj.
Qed.

Lemma across_le : forall F s i, Rabs (across F s i) <= Rabs (ex F s i) + Rabs (ey F s i).
Proof.
  intros F s i. unfold across. apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat.
  - rewrite <- Ropp_mult_distr_l, Rabs_Ropp. apply abs_mult_le_1, sin_abs_le_1.
  - apply abs_mult_le_1, cos_abs_le_1.
Qed.

(** Where all positions are close to the formation, the input alpha is small. *)
Lemma alpha_small : forall F, A1 F -> A2 F -> A3 F -> forall abar, 0 < abar -> exists d, 0 < d /\
  forall t s, 0 <= t -> (forall i, (i < N F)%nat -> Rabs (zx F s i) <= d /\ Rabs (zy F s i) <= d) ->
  forall i, (i < N F)%nat -> Rabs (alpha F t s i) <= abar.
Proof.
  intros F HA1 HA2 HA3 abar Habar.
  destruct (finite_upper_bound (N F) (fun i => k F i * psi0 F * (deg F i * 4 / ls F))) as [B [HB Hall]].
  exists (abar / B). split; [apply Rdiv_lt_0_compat; assumption |].
  intros t s Ht Hz i Hi.
  assert (Hls : 0 < ls F) by apply HA2.
  assert (Hk : 0 < k F i) by (apply HA2; assumption).
  assert (Hpsi : Rabs (psi F i t) <= psi0 F) by (apply HA3; assumption).
  unfold alpha. rewrite !Rabs_mult, (Rabs_right (k F i)) by lra.
  assert (Hac : Rabs (across F s i) <= deg F i * 4 / ls F * (abar / B)).
  { apply Rle_trans with (1 := across_le F s i).
    assert (H1 : Rabs (ex F s i) <= 2 * deg F i / ls F * (abar / B)).
    { apply coupling_small; try assumption. intros j Hj. apply Hz; assumption. }
    assert (H2 : Rabs (ey F s i) <= 2 * deg F i / ls F * (abar / B)).
    { apply coupling_small; try assumption. intros j Hj. apply Hz; assumption. }
    replace (deg F i * 4 / ls F * (abar / B))
      with (2 * deg F i / ls F * (abar / B) + 2 * deg F i / ls F * (abar / B)) by (field; lra).
    lra. }
  apply Rle_trans with (k F i * psi0 F * (deg F i * 4 / ls F * (abar / B))).
  - apply Rmult_le_compat; try assumption.
    + apply Rmult_le_pos; [lra | apply Rabs_pos].
    + apply Rabs_pos.
    + apply Rmult_le_compat_l; lra.
  - replace abar with (B * (abar / B)) at 2 by (field; lra).
    rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [| apply Hall; assumption].
    apply Rlt_le, Rdiv_lt_0_compat; assumption.
Qed.

(** What a small input can add to W: half the damping pays for fast turns, slow ones gain little. *)
Lemma input_power_small : forall F, A2 F -> exists C abar0, 0 <= C /\ 0 < abar0 /\
  forall t s abar, abar <= abar0 -> (forall i, (i < N F)%nat -> Rabs (alpha F t s i) <= abar) ->
  sum (N F) (fun i => om s i * alpha F t s i / pw F i) <= Pw F s / 2 + C * abar.
Proof.
  intros F [_ [_ HA2]].
  destruct (finite_positive_lower_bound (N F) (fun i => dw F i * tanh 1 / 2)) as [abar0 [Habar0 Hlow]].
  { intros i Hi. assert (0 < dw F i) by (apply HA2; assumption).
    assert (0 < tanh 1) by (apply tanh_pos; lra).
    assert (0 < dw F i * tanh 1) by (apply Rmult_lt_0_compat; assumption). lra. }
  exists (sum (N F) (fun i => ws F i / pw F i)), abar0. split; [| split; [assumption |]].
  { apply sum_nonneg. intros i Hi. apply Rlt_le, Rdiv_lt_0_compat; apply HA2; assumption. }
  intros t s abar Habar Hal.
  replace (Pw F s / 2) with (/ 2 * Pw F s) by field.
  unfold Pw. rewrite <- sum_scal_l, <- sum_scal_r, <- sum_plus. apply sum_le. intros i Hi.
  assert (Hp : 0 < pw F i) by (apply HA2; assumption).
  assert (Hd : 0 < dw F i) by (apply HA2; assumption).
  assert (Hw : 0 < ws F i) by (apply HA2; assumption).
  specialize (Hal i Hi). specialize (Hlow i Hi). simpl in Hlow.
  set (w := om s i) in *. set (al := alpha F t s i) in *.
  assert (Hterm : w * al <= dw F i * (w * tanh (w / ws F i)) / 2 + ws F i * abar).
  { assert (Hal0 : 0 <= abar) by (apply Rle_trans with (2 := Hal); apply Rabs_pos).
    apply Rle_trans with (Rabs w * abar).
    { apply Rle_trans with (1 := Rle_abs _). rewrite Rabs_mult.
      apply Rmult_le_compat_l; [apply Rabs_pos | assumption]. }
    destruct (Rle_dec (Rabs w) (ws F i)) as [Hslow | Hfast].
    - assert (0 <= dw F i * (w * tanh (w / ws F i))).
      { apply Rmult_le_pos; [lra | apply x_tanh_scaled_nonneg; assumption]. }
      assert (Rabs w * abar <= ws F i * abar) by (apply Rmult_le_compat_r; assumption). lra.
    - assert (0 <= ws F i * abar) by (apply Rmult_le_pos; lra).
      assert (Hge : Rabs w * tanh 1 <= w * tanh (w / ws F i)).
      { rewrite (x_tanh_scaled_abs w) by assumption.
        apply Rmult_le_compat_l; [apply Rabs_pos |]. apply tanh_le.
        replace 1 with (ws F i / ws F i) by (field; lra). apply div_le; lra. }
      assert (Rabs w * abar <= Rabs w * (dw F i * tanh 1 / 2)).
      { apply Rmult_le_compat_l; [apply Rabs_pos | lra]. }
      assert (dw F i * (Rabs w * tanh 1) <= dw F i * (w * tanh (w / ws F i))).
      { apply Rmult_le_compat_l; lra. }
      lra. }
  replace (/ 2 * (dw F i / pw F i * (w * tanh (w / ws F i))) + ws F i / pw F i * abar)
    with ((dw F i * (w * tanh (w / ws F i)) / 2 + ws F i * abar) / pw F i) by (field; lra).
  apply div_le; assumption.
Qed.

(** Windows laid end to end from the start cover all later times. *)
Lemma window_cover : forall t0 T0 t, 0 < T0 -> t0 <= t ->
  exists n, t0 + INR n * T0 <= t <= t0 + INR n * T0 + T0.
Proof.
  intros t0 T0 t HT Ht.
  destruct (nfloor_ex ((t - t0) / T0)) as [n [Hn1 Hn2]]; [apply div_nonneg; lra |].
  assert (Heq : t - t0 = (t - t0) / T0 * T0) by (field; lra).
  exists n. split.
  - assert (INR n * T0 <= (t - t0) / T0 * T0) by (apply Rmult_le_compat_r; lra). lra.
  - assert ((t - t0) / T0 * T0 <= (INR n + 1) * T0) by (apply Rmult_le_compat_r; lra). lra.
Qed.

(** W, started below half its level d with a small input for ever, stays below d. *)
Lemma turning_stays_small : forall F, A1 F -> A2 F -> A3 F -> forall d dE, 0 < d -> 0 < dE ->
  (forall s, err F s <= dE -> W F s <= d / 2) ->
  exists abar, 0 < abar /\ forall t0 X, 0 <= t0 -> solution F t0 X ->
    (forall t, t0 <= t -> sum (N F) (fun i => Rabs (zx F (X t) i) + Rabs (zy F (X t) i) + Rabs (v (X t) i)) <= dE / 2) ->
    (forall t i, t0 <= t -> (i < N F)%nat -> Rabs (alpha F t (X t) i) <= abar) ->
    W F (X t0) <= d / 2 -> forall t, t0 <= t -> W F (X t) <= d.
Proof.
  intros F HA1 HA2 HA3 d dE Hd HdE Hlevel.
  assert (HT : 0 < T F) by apply HA3.
  destruct (window_heading F HA1 HA2 HA3 (dE / 2)) as [eta [Heta Hheading]]; [lra |].
  destruct (turning_window_falls F HA1 HA2 HA3 eta Heta) as [gam [Hgam Hturn]].
  destruct (input_power_small F HA2) as [C [abar0 [HC [Habar0 Hinput]]]].
  set (mx := Rmin (gam / 2) (d / 4)).
  assert (Hmx : 0 < mx) by (apply Rmin_glb_lt; lra).
  set (abar := Rmin (Rmin eta abar0) (mx / ((C + 1) * T F))).
  assert (Habar : 0 < abar).
  { apply Rmin_glb_lt; [apply Rmin_glb_lt; assumption |]. apply Rdiv_lt_0_compat; [assumption |].
    apply Rmult_lt_0_compat; lra. }
  assert (H1 : abar <= Rmin eta abar0) by apply Rmin_l.
  assert (H2 : abar <= eta) by (generalize (Rmin_l eta abar0); lra).
  assert (H3 : abar <= abar0) by (generalize (Rmin_r eta abar0); lra).
  assert (H4 : C * abar * T F <= mx).
  { apply Rle_trans with ((C + 1) * T F * abar).
    - assert (0 <= T F * abar) by (apply Rmult_le_pos; lra). nra.
    - apply Rle_trans with ((C + 1) * T F * (mx / ((C + 1) * T F))).
      + apply Rmult_le_compat_l; [apply Rmult_le_pos; lra | apply Rmin_r].
      + right. field. split; lra. }
  assert (H5 : C * abar * T F <= gam / 2) by (apply Rle_trans with (1 := H4); apply Rmin_l).
  assert (H6 : C * abar * T F <= d / 4) by (apply Rle_trans with (1 := H4); apply Rmin_r).
  assert (H7 : 0 <= C * abar) by (apply Rmult_le_pos; lra).
  exists abar. split; [assumption |]. intros t0 X Ht0 HX Hpos Hal Hstart.
  assert (Hrate : forall x, t0 <= x -> exists l, is_derive (fun x => W F (X x)) x l /\
            l <= C * abar - Pw F (X x) / 2).
  { intros x Hx. eexists. split; [apply (W_derivative F t0 X x HA1 HA2 HX Hx) |].
    assert (Hin := Hinput x (X x) abar H3 (fun i Hi => Hal x i Hx Hi)). lra. }
  assert (Hrise : forall p q, t0 <= p <= q -> q <= p + T F -> W F (X q) <= W F (X p) + C * abar * T F).
  { intros p q Hpq Hq.
    assert (H : (fun x => W F (X x)) q - (fun x => W F (X x)) p <= C * abar * (q - p)).
    { apply (increment_le (fun x => W F (X x)) p q (C * abar)); [lra |]. intros x Hx.
      destruct (Hrate x) as [l [Hl Hle]]; [lra |]. exists l. split; [assumption |].
      generalize (Pw_nonneg F (X x) HA1 HA2). lra. }
    simpl in H. assert (C * abar * (q - p) <= C * abar * T F) by (apply Rmult_le_compat_l; lra). lra. }
  assert (Hwindow : forall p, t0 <= p -> W F (X p) <= d / 2 \/ W F (X (p + T F)) <= W F (X p)).
  { intros p Hp.
    destruct (classic (exists s i, p <= s <= p + T F /\ (i < N F)%nat /\ eta < Rabs (om (X s) i))) as [Hf | Hf].
    - right.
      assert (H : (fun x => 2 * W F (X x)) (p + T F) <= (fun x => 2 * W F (X x)) p + 2 * (C * abar) * T F - gam).
      { apply (Hturn t0 X p (fun x => 2 * W F (X x)) (2 * (C * abar)) Ht0 Hp HX); [| assumption].
        intros x Hx. destruct (Hrate x) as [l [Hl Hle]]; [lra |]. exists (2 * l). split; [| lra].
        apply (is_derive_scal (fun x => W F (X x)) x 2 l Hl). }
      simpl in H. lra.
    - left. apply Hlevel. rewrite err_split.
      assert (Hh : sum (N F) (fun i => Rabs (tha F (X p) i) + Rabs (om (X p) i)) <= dE / 2).
      { apply (Hheading t0 X p Ht0 Hp HX). intros s i Hs Hi. split.
        - apply Rnot_lt_le. intro Hfast. apply Hf. exists s, i. auto.
        - apply Rle_trans with abar; [| assumption]. apply Hal; [lra | assumption]. }
      generalize (Hpos p Hp). lra. }
  assert (Hall : forall n, W F (X (t0 + INR n * T F)) <= d / 2 + C * abar * T F).
  { induction n as [| n IH].
    - simpl. rewrite Rmult_0_l, Rplus_0_r. assert (0 <= C * abar * T F) by (apply Rmult_le_pos; lra). lra.
    - assert (Hn : 0 <= INR n * T F) by (apply Rmult_le_pos; [apply pos_INR | lra]).
      replace (t0 + INR (S n) * T F) with (t0 + INR n * T F + T F) by (rewrite S_INR; ring).
      destruct (Hwindow (t0 + INR n * T F)) as [Hw | Hw]; [lra | |].
      + assert (W F (X (t0 + INR n * T F + T F)) <= W F (X (t0 + INR n * T F)) + C * abar * T F).
        { apply Hrise; lra. }
        lra.
      + lra. }
  intros t Ht. destruct (window_cover t0 (T F) t HT Ht) as [n Hn].
  assert (Hn0 : 0 <= INR n * T F) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  assert (W F (X t) <= W F (X (t0 + INR n * T F)) + C * abar * T F) by (apply Hrise; lra).
  generalize (Hall n). lra.
Qed.

Lemma uniformly_stable_holds : forall F, A1 F -> A2 F -> A3 F -> uniformly_stable F.
Proof.
  intros F HA1 HA2 HA3 eps Heps.
  destruct (W_small F HA1 HA2 (eps / 2)) as [d [Hd HWsmall]]; [lra |].
  destruct (energies_small F HA1 HA2 (d / 2)) as [dE [HdE HEsmall]]; [lra |].
  destruct (turning_stays_small F HA1 HA2 HA3 d dE Hd HdE) as [abar [Habar Hstay]].
  { intros s Hs. apply HEsmall. assumption. }
  destruct (alpha_small F HA1 HA2 HA3 abar Habar) as [dz [Hdz Halpha]].
  set (ez := Rmin (Rmin dz (eps / 2)) (dE / 2)).
  assert (Hez : 0 < ez) by (apply Rmin_glb_lt; [apply Rmin_glb_lt |]; lra).
  assert (E1 : ez <= Rmin dz (eps / 2)) by apply Rmin_l.
  assert (E2 : ez <= dz) by (generalize (Rmin_l dz (eps / 2)); lra).
  assert (E3 : ez <= eps / 2) by (generalize (Rmin_r dz (eps / 2)); lra).
  assert (E4 : ez <= dE / 2) by apply Rmin_r.
  destruct (V_small F HA1 HA2 ez Hez) as [dV [HdV HVsmall]].
  destruct (energies_small F HA1 HA2 (Rmin dV (d / 2))) as [delta [Hdelta Hstart]].
  { apply Rmin_glb_lt; lra. }
  exists delta. split; [assumption |]. intros t0 X Ht0 HX Herr.
  destruct (Hstart (X t0) Herr) as [HV0 HW0].
  assert (HVdV : V F (X t0) <= dV) by (apply Rle_trans with (1 := HV0); apply Rmin_l).
  assert (HWd : W F (X t0) <= d / 2) by (apply Rle_trans with (1 := HW0); apply Rmin_r).
  assert (Hpos : forall t, t0 <= t ->
            sum (N F) (fun i => Rabs (zx F (X t) i) + Rabs (zy F (X t) i) + Rabs (v (X t) i)) <= ez).
  { intros t Ht. apply HVsmall. apply Rle_trans with (2 := HVdV). apply V_nonincreasing; assumption. }
  assert (HW : forall t, t0 <= t -> W F (X t) <= d).
  { apply (Hstay t0 X Ht0 HX); [| | assumption].
    - intros t Ht. generalize (Hpos t Ht). lra.
    - intros t i Ht Hi. apply Halpha; [lra | | assumption]. intros j Hj.
      assert (Hj' := sum_term_le (N F)
        (fun i => Rabs (zx F (X t) i) + Rabs (zy F (X t) i) + Rabs (v (X t) i)) j).
      simpl in Hj'. specialize (Hpos t Ht).
      assert (Hnn : forall i, (i < N F)%nat -> 0 <= Rabs (zx F (X t) i) + Rabs (zy F (X t) i) + Rabs (v (X t) i)).
      { intros q _. generalize (Rabs_pos (zx F (X t) q)) (Rabs_pos (zy F (X t) q)) (Rabs_pos (v (X t) q)). lra. }
      specialize (Hj' Hnn Hj).
      generalize (Rabs_pos (zx F (X t) j)) (Rabs_pos (zy F (X t) j)) (Rabs_pos (v (X t) j)). lra. }
  intros t Ht. rewrite err_split.
  generalize (Hpos t Ht) (HWsmall (X t) (HW t Ht)). lra.
Qed.

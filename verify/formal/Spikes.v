(** * Spikes.v : a fast moment costs energy (this replaces the integrals of L11).
    A speed has a bounded rate, so where it once exceeds eta it stays above eta/2 for a fixed while.
    During that while the saturated damping takes energy at a fixed rate, and a fixed amount in all.
    Everything is the mean value theorem on three pieces of a window; no integral is needed. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus Energies.
Open Scope R_scope.

(** The spike: Y never rises faster than e, and falls by c faster wherever |f| >= eta/2. *)
Lemma spike_falls : forall (f Y : R -> R) (t T0 B eta c e : R),
  0 < T0 -> 0 < B -> 0 < eta ->
  (forall x, t <= x <= t + T0 -> exists l, is_derive f x l /\ Rabs l <= B) ->
  (forall x, t <= x <= t + T0 -> exists l, is_derive Y x l /\ l <= e) ->
  (forall x, t <= x <= t + T0 -> eta / 2 <= Rabs (f x) -> exists l, is_derive Y x l /\ l <= e - c) ->
  (exists s, t <= s <= t + T0 /\ eta < Rabs (f s)) ->
  Y (t + T0) <= Y t + e * T0 - c * Rmin (T0 / 2) (eta / (2 * B)).
Proof.
  intros f Y t T0 B eta c e HT HB Heta Hf HY HYc [s [Hs Hfs]].
  set (h := Rmin (T0 / 2) (eta / (2 * B))).
  assert (Hh1 : h <= T0 / 2) by apply Rmin_l.
  assert (Hh2 : B * h <= eta / 2).
  { replace (eta / 2) with (B * (eta / (2 * B))) by (field; lra).
    apply Rmult_le_compat_l; [lra | apply Rmin_r]. }
  assert (Hh0 : 0 < h).
  { apply Rmin_glb_lt; [lra |]. apply Rdiv_lt_0_compat; lra. }
  assert (Hpiece : forall p, t <= p -> p + h <= t + T0 -> p <= s <= p + h ->
            Y (t + T0) <= Y t + e * T0 - c * h).
  { intros p Hp1 Hp2 Hps.
    assert (H1 : Y p - Y t <= e * (p - t)).
    { apply increment_le; [lra |]. intros x Hx. apply HY; lra. }
    assert (H2 : Y (p + h) - Y p <= (e - c) * (p + h - p)).
    { apply increment_le; [lra |]. intros x Hx. apply HYc; [lra |].
      assert (Hfx : Rabs (f s - f x) <= eta / 2).
      { destruct (Rle_dec x s) as [Hxs | Hxs].
        - apply Rle_trans with (B * (s - x)).
          + apply increment_abs; [assumption |]. intros y Hy. apply Hf; lra.
          + apply Rle_trans with (B * h); [| assumption]. apply Rmult_le_compat_l; lra.
        - rewrite Rabs_minus_sym. apply Rle_trans with (B * (x - s)).
          + apply increment_abs; [lra |]. intros y Hy. apply Hf; lra.
          + apply Rle_trans with (B * h); [| assumption]. apply Rmult_le_compat_l; lra. }
      generalize (Rabs_triang_inv (f s) (f x)). lra. }
    assert (H3 : Y (t + T0) - Y (p + h) <= e * (t + T0 - (p + h))).
    { apply increment_le; [lra |]. intros x Hx. apply HY; lra. }
    nra. }
  destruct (Rle_dec (s + h) (t + T0)) as [Hr | Hr].
  - apply (Hpiece s); lra.
  - apply (Hpiece (s - h)); lra.
Qed.

(** A fast vehicle dissipates at no less than a fixed rate, whichever it is. *)
Lemma damped_sum_above : forall n (gain scale : nat -> R) e, 0 < e ->
  (forall i, (i < n)%nat -> 0 < gain i /\ 0 < scale i) -> exists c, 0 < c /\
  forall x i, (i < n)%nat -> e <= Rabs (x i) ->
    c <= sum n (fun i => gain i * (x i * tanh (x i / scale i))).
Proof.
  intros n gain scale e He Hpos.
  destruct (finite_positive_lower_bound n (fun i => gain i * (e * tanh (e / scale i)))) as [c [Hc Hall]].
  { intros i Hi. destruct (Hpos i Hi) as [Hg Hs]. apply Rmult_lt_0_compat; [assumption |].
    apply Rmult_lt_0_compat; [assumption |]. apply tanh_pos, Rdiv_lt_0_compat; assumption. }
  exists c. split; [assumption |]. intros x i Hi Hx.
  apply Rle_trans with (1 := Hall i Hi).
  apply Rle_trans with (gain i * (x i * tanh (x i / scale i))).
  - destruct (Hpos i Hi) as [Hg Hs]. apply Rmult_le_compat_l; [lra |]. apply x_tanh_scaled_ge; lra.
  - apply (sum_term_le n (fun i => gain i * (x i * tanh (x i / scale i))) i); [| assumption].
    intros j Hj. destruct (Hpos j Hj) as [Hg Hs].
    apply Rmult_le_pos; [lra |]. apply x_tanh_scaled_nonneg; assumption.
Qed.

Lemma driving_costs : forall F, A2 F -> forall e, 0 < e -> exists c, 0 < c /\
  forall s i, (i < N F)%nat -> e <= Rabs (v s i) -> c <= Pv F s.
Proof.
  intros F HA2 e He.
  destruct (damped_sum_above (N F) (fun i => dv F i / pv F i) (ss F) e He) as [c [Hc H]].
  { intros i Hi. destruct HA2 as [_ [_ H2]].
    destruct (H2 i Hi) as [_ [_ [_ [_ [Hp [Hd [_ [_ [_ [Hs _]]]]]]]]]].
    split; [apply Rdiv_lt_0_compat; assumption | assumption]. }
  exists c. split; [assumption |]. intros s i Hi Hv. apply (H (v s) i Hi Hv).
Qed.

Lemma turning_costs : forall F, A2 F -> forall e, 0 < e -> exists c, 0 < c /\
  forall s i, (i < N F)%nat -> e <= Rabs (om s i) -> c <= Pw F s.
Proof.
  intros F HA2 e He.
  destruct (damped_sum_above (N F) (fun i => dw F i / pw F i) (ws F) e He) as [c [Hc H]].
  { intros i Hi. destruct HA2 as [_ [_ H2]].
    destruct (H2 i Hi) as [_ [_ [_ [_ [_ [_ [Hp [Hd [_ [_ Hs]]]]]]]]]].
    split; [apply Rdiv_lt_0_compat; assumption | assumption]. }
  exists c. split; [assumption |]. intros s i Hi Hv. apply (H (om s) i Hi Hv).
Qed.

(** One window with a fast turn: what falls at the rate Pw, but for e, falls by gam, but for e T. *)
Lemma turning_window_falls : forall F, A1 F -> A2 F -> A3 F -> forall eta, 0 < eta ->
  exists gam, 0 < gam /\ forall t0 X t (Y : R -> R) e, 0 <= t0 -> t0 <= t -> solution F t0 X ->
    (forall x, t <= x <= t + T F -> exists l, is_derive Y x l /\ l <= e - Pw F (X x)) ->
    (exists s i, t <= s <= t + T F /\ (i < N F)%nat /\ eta < Rabs (om (X s) i)) ->
    Y (t + T F) <= Y t + e * T F - gam.
Proof.
  intros F HA1 HA2 HA3 eta Heta.
  destruct (rates_bounded F HA1 HA2 HA3) as [B [HB Hrate]].
  destruct (turning_costs F HA2 (eta / 2)) as [c [Hc Hcost]]; [lra |].
  assert (HT : 0 < T F) by apply HA3.
  exists (c * Rmin (T F / 2) (eta / (2 * B))). split.
  { apply Rmult_lt_0_compat; [assumption |]. apply Rmin_glb_lt; [lra |].
    apply Rdiv_lt_0_compat; lra. }
  intros t0 X t Y e Ht0 Ht HX HY [s [i [Hs [Hi Hfast]]]].
  apply (spike_falls (fun x => om (X x) i) Y t (T F) B eta c e HT HB Heta).
  - intros x Hx. exists (u_w F x (X x) i / J F i). split.
    + apply (HX i Hi x). lra.
    + apply (Hrate x (X x) i); [lra | assumption].
  - intros x Hx. destruct (HY x Hx) as [l [Hl Hle]]. exists l. split; [assumption |].
    generalize (Pw_nonneg F (X x) HA1 HA2). lra.
  - intros x Hx Hbig. destruct (HY x Hx) as [l [Hl Hle]]. exists l. split; [assumption |].
    generalize (Hcost (X x) i Hi Hbig). lra.
  - exists s. split; assumption.
Qed.

(** One window with a fast drive. *)
Lemma driving_window_falls : forall F, A1 F -> A2 F -> A3 F -> forall eta, 0 < eta ->
  exists gam, 0 < gam /\ forall t0 X t (Y : R -> R) e, 0 <= t0 -> t0 <= t -> solution F t0 X ->
    (forall x, t <= x <= t + T F -> exists l, is_derive Y x l /\ l <= e - Pv F (X x)) ->
    (exists s i, t <= s <= t + T F /\ (i < N F)%nat /\ eta < Rabs (v (X s) i)) ->
    Y (t + T F) <= Y t + e * T F - gam.
Proof.
  intros F HA1 HA2 HA3 eta Heta.
  destruct (rates_bounded F HA1 HA2 HA3) as [B [HB Hrate]].
  destruct (driving_costs F HA2 (eta / 2)) as [c [Hc Hcost]]; [lra |].
  assert (HT : 0 < T F) by apply HA3.
  exists (c * Rmin (T F / 2) (eta / (2 * B))). split.
  { apply Rmult_lt_0_compat; [assumption |]. apply Rmin_glb_lt; [lra |].
    apply Rdiv_lt_0_compat; lra. }
  intros t0 X t Y e Ht0 Ht HX HY [s [i [Hs [Hi Hfast]]]].
  apply (spike_falls (fun x => v (X x) i) Y t (T F) B eta c e HT HB Heta).
  - intros x Hx. exists (u_v F (X x) i / m F i). split.
    + apply (HX i Hi x). lra.
    + apply (Hrate x (X x) i); [lra | assumption].
  - intros x Hx. destruct (HY x Hx) as [l [Hl Hle]]. exists l. split; [assumption |].
    generalize (Pv_nonneg F (X x) HA1 HA2). lra.
  - intros x Hx Hbig. destruct (HY x Hx) as [l [Hl Hle]]. exists l. split; [assumption |].
    generalize (Hcost (X x) i Hi Hbig). lra.
  - exists s. split; assumption.
Qed.

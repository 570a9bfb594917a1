(** * Window.v : L12, the window lemma.
    If every speed and turn rate is small over one window of length T, then at its start all errors are small.
    Idea: the pulls across and along are small (WindowAcross, WindowSpeed); a small pull across makes the excitation
    torque small, so the heading errors are small (WindowHeading); small pulls mean small position errors by L9. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations EnergyDerivatives InverseBound WindowIncrements.
From Gaincert Require Export WindowHeading.
From Gaincert Require Import WindowSpeed WindowAcross.
Open Scope R_scope.

(** One constant for all vehicles: pulls along (at the start) and across (all through), and excitation torque. *)
Lemma pulls_small : forall F, A1 F -> A2 F -> A3 F -> exists c, 0 < c /\
  forall t0 X t eta, 0 <= t0 -> t0 <= t -> solution F t0 X -> slow F X t eta ->
    forall i, (i < N F)%nat -> Rabs (along F (X t) i) <= c * eta /\
      forall s, t <= s <= t + T F -> Rabs (across F (X s) i) <= c * eta /\ Rabs (alpha F s (X s) i) <= c * eta.
Proof.
  intros F HA1 HA2 HA3.
  assert (HT : 0 < T F) by apply HA3.
  destruct (finite_common_large (N F) (fun i c => forall t0 X t eta, 0 <= t0 -> t0 <= t -> solution F t0 X -> slow F X t eta ->
    Rabs (along F (X t) i) <= c * eta /\
      forall s, t <= s <= t + T F -> Rabs (across F (X s) i) <= c * eta /\ Rabs (alpha F s (X s) i) <= c * eta)) as [c [Hc H]].
  - intros i x y Hi Hxy H t0 X t eta Ht0 Ht HX Hq.
    assert (Heta : 0 <= eta) by (apply Rle_trans with (2 := proj1 (Hq t i ltac:(lra) Hi)); apply Rabs_pos).
    assert (Hle : x * eta <= y * eta) by (apply Rmult_le_compat_r; assumption).
    destruct (H t0 X t eta Ht0 Ht HX Hq) as [H1 H2]. split; [lra |].
    intros s Hs. destruct (H2 s Hs) as [H3 H4]. split; lra.
  - intros i Hi.
    destruct (along_small F HA1 HA2 HA3 i Hi) as [ca Ha].
    destruct (across_small F HA1 HA2 HA3 i Hi) as [cb Hb].
    assert (Hk : 0 < k F i) by apply (proj2 (proj2 HA2) i Hi).
    set (cm := Rmax ca (Rmax cb (k F i * psi0 F * cb))).
    assert (Hm1 : ca <= cm) by apply Rmax_l.
    assert (Hm2 : cb <= cm) by (apply Rle_trans with (2 := Rmax_r _ _); apply Rmax_l).
    assert (Hm3 : k F i * psi0 F * cb <= cm) by (apply Rle_trans with (2 := Rmax_r _ _); apply Rmax_r).
    exists cm. intros t0 X t eta Ht0 Ht HX Hq.
    assert (Heta : 0 <= eta) by (apply Rle_trans with (2 := proj1 (Hq t i ltac:(lra) Hi)); apply Rabs_pos).
    split.
    + apply Rle_trans with (1 := Ha t0 X t eta Ht HX Hq). apply Rmult_le_compat_r; assumption.
    + intros s Hs. assert (H1 := Hb t0 X t eta Ht0 Ht HX Hq s Hs). split.
      * apply Rle_trans with (1 := H1). apply Rmult_le_compat_r; assumption.
      * apply Rle_trans with (k F i * psi0 F * cb * eta); [| apply Rmult_le_compat_r; assumption].
        assert (Hp : Rabs (psi F i s) <= psi0 F) by (apply (proj2 (proj2 HA3) i Hi s); lra).
        unfold alpha. rewrite !Rabs_mult, (Rabs_pos_eq (k F i)), (Rmult_assoc (k F i * psi0 F)) by lra.
        apply Rmult_le_compat; try assumption.
        -- apply Rmult_le_pos; [lra | apply Rabs_pos].
        -- apply Rabs_pos.
        -- apply Rmult_le_compat_l; lra.
  - exists c. split; [exact Hc |]. intros t0 X t eta Ht0 Ht HX Hq i Hi. apply (H i Hi t0 X t eta Ht0 Ht HX Hq).
Qed.

(** Small pulls along and across mean small pulls in both coordinates. *)
Lemma pulls_in_coordinates : forall F s i b, Rabs (along F s i) <= b -> Rabs (across F s i) <= b ->
  Rabs (ex F s i) <= 2 * b /\ Rabs (ey F s i) <= 2 * b.
Proof.
  intros F s i b Ha Hb.
  assert (E := sin2_cos2 (th s i)). unfold Rsqr in E.
  split.
  - replace (ex F s i) with ((sin (th s i) * sin (th s i) + cos (th s i) * cos (th s i)) * ex F s i) by (rewrite E; ring).
    replace ((sin (th s i) * sin (th s i) + cos (th s i) * cos (th s i)) * ex F s i)
      with (cos (th s i) * along F s i + - (sin (th s i) * across F s i)) by (unfold along, across; ring).
    apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp.
    assert (H1 := abs_mult_le_1 _ (along F s i) (cos_abs_le_1 (th s i))).
    assert (H2 := abs_mult_le_1 _ (across F s i) (sin_abs_le_1 (th s i))). lra.
  - replace (ey F s i) with ((sin (th s i) * sin (th s i) + cos (th s i) * cos (th s i)) * ey F s i) by (rewrite E; ring).
    replace ((sin (th s i) * sin (th s i) + cos (th s i) * cos (th s i)) * ey F s i)
      with (sin (th s i) * along F s i + cos (th s i) * across F s i) by (unfold along, across; ring).
    apply Rle_trans with (1 := Rabs_triang _ _).
    assert (H1 := abs_mult_le_1 _ (along F s i) (sin_abs_le_1 (th s i))).
    assert (H2 := abs_mult_le_1 _ (across F s i) (cos_abs_le_1 (th s i))). lra.
Qed.

Lemma window_small : forall F, A1 F -> A2 F -> A3 F -> forall eps, 0 < eps -> exists eta, 0 < eta /\
  forall t0 X t, 0 <= t0 -> t0 <= t -> solution F t0 X ->
    (forall s i, t <= s <= t + T F -> (i < N F)%nat -> Rabs (v (X s) i) <= eta /\ Rabs (om (X s) i) <= eta) ->
    err F (X t) <= eps.
Proof.
  intros F HA1 HA2 HA3 eps Heps.
  assert (HT : 0 < T F) by apply HA3.
  assert (Hls : 0 < ls F) by apply HA2.
  set (e1 := eps / 2 / INR (S (N F))).
  assert (He1 : 0 < e1) by (apply div_pos; [lra | apply lt_0_INR; lia]).
  destruct (inverse_bound F HA1 (ls F) Hls (e1 / 3) ltac:(lra)) as [chi [Hchi Hinv]].
  destruct (window_heading F HA1 HA2 HA3 (eps / 2) ltac:(lra)) as [eta1 [Heta1 Hhead]].
  destruct (pulls_small F HA1 HA2 HA3) as [c [Hc Hpulls]].
  set (eta := Rmin (Rmin (e1 / 3) eta1) (Rmin (eta1 / c) (chi / (2 * c)))).
  assert (Hb1 : eta <= e1 / 3) by (apply Rle_trans with (1 := Rmin_l _ _); apply Rmin_l).
  assert (Hb2 : eta <= eta1) by (apply Rle_trans with (1 := Rmin_l _ _); apply Rmin_r).
  assert (Hb3 : c * eta <= eta1).
  { apply Rle_trans with (c * (eta1 / c)); [| right; field; lra]. apply Rmult_le_compat_l; [lra |].
    apply Rle_trans with (1 := Rmin_r _ _); apply Rmin_l. }
  assert (Hb4 : 2 * (c * eta) <= chi).
  { apply Rle_trans with (2 * (c * (chi / (2 * c)))); [| right; field; lra].
    apply Rmult_le_compat_l; [lra |]. apply Rmult_le_compat_l; [lra |].
    apply Rle_trans with (1 := Rmin_r _ _); apply Rmin_r. }
  exists eta. split.
  - unfold eta. repeat apply Rmin_glb_lt; try lra; apply div_pos; lra.
  - intros t0 X t Ht0 Ht HX Hq.
    assert (Hp := Hpulls t0 X t eta Ht0 Ht HX Hq).
    assert (Hh : sum (N F) (fun i => Rabs (tha F (X t) i) + Rabs (om (X t) i)) <= eps / 2).
    { apply (Hhead t0 X t Ht0 Ht HX). intros s i Hs Hi.
      assert (H1 := proj2 (Hq s i Hs Hi)). assert (H2 := proj2 (proj2 (Hp i Hi) s Hs)). split; lra. }
    assert (Hxy : forall j, (j < N F)%nat -> Rabs (ex F (X t) j) <= chi /\ Rabs (ey F (X t) j) <= chi).
    { intros j Hj. destruct (Hp j Hj) as [H1 H2]. destruct (H2 t ltac:(lra)) as [H3 _].
      destruct (pulls_in_coordinates F (X t) j (c * eta) H1 H3) as [H4 H5]. split; lra. }
    assert (Hr : sum (N F) (fun i => Rabs (zx F (X t) i) + Rabs (zy F (X t) i) + Rabs (v (X t) i)) <= eps / 2).
    { apply (sum_small _ _ e1 (eps / 2)); [lra | apply Rle_refl |]. intros i Hi.
      assert (H1 := Hinv (zx F (X t)) (fun j Hj => proj1 (Hxy j Hj)) i Hi).
      assert (H2 := Hinv (zy F (X t)) (fun j Hj => proj2 (Hxy j Hj)) i Hi).
      assert (H3 := proj1 (Hq t i ltac:(lra) Hi)). lra. }
    unfold err.
    rewrite (sum_ext _ _ (fun i => (Rabs (zx F (X t) i) + Rabs (zy F (X t) i) + Rabs (v (X t) i))
      + (Rabs (tha F (X t) i) + Rabs (om (X t) i)))) by (intros i _; ring).
    rewrite sum_plus. lra.
Qed.

(** * Excitation.v : L10, what the excitation condition (12) gives on one window.
    Condition (12) only speaks of an integral of psi'^2.  What the window argument needs is simpler:
    in every window of length T there is a stretch of fixed length on which psi has a slope of at
    least q in size, with q > 0 the same for every vehicle and every window: where psi'^2 is large
    at one moment, the bound on psi'' keeps it large for a while. *)
From Coq Require Import Reals Lra Lia Classical.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement.
Open Scope R_scope.

(** In every window psi' reaches the size sqrt (mu / T) / 2 somewhere. *)
Lemma slope_somewhere : forall F, A3 F -> forall i t, (i < N F)%nat -> 0 <= t ->
  exists s, t <= s <= t + T F /\ sqrt (mu F / T F) / 2 <= Rabs (dpsi F i s).
Proof.
  intros F HA i t Hi Ht.
  destruct HA as [HT [Hmu HA]].
  assert (HA' := HA i Hi). clear HA.
  destruct (classic (exists s, t <= s <= t + T F /\ sqrt (mu F / T F) / 2 <= Rabs (dpsi F i s))) as [H | H].
  - exact H.
  - exfalso.
    assert (Hr : 0 < mu F / T F) by (apply Rdiv_lt_0_compat; assumption).
    assert (Hsq : sqrt (mu F / T F) * sqrt (mu F / T F) = mu F / T F) by (apply sqrt_sqrt; lra).
    assert (Hsp : 0 < sqrt (mu F / T F)) by (apply sqrt_lt_R0; exact Hr).
    set (q := sqrt (mu F / T F)) in *.
    assert (Hsmall : forall s, t <= s <= t + T F -> (dpsi F i s) ^ 2 <= mu F / T F / 4).
    { intros s Hs.
      assert (Hlt : Rabs (dpsi F i s) < q / 2).
      { apply Rnot_le_lt. intros Hc. apply H. exists s. split; assumption. }
      assert (Hp := Rabs_pos (dpsi F i s)).
      rewrite <- (pow2_abs (dpsi F i s)). nra. }
    assert (HI : RInt (fun s => (dpsi F i s) ^ 2) t (t + T F) <= RInt (fun _ => mu F / T F / 4) t (t + T F)).
    { apply RInt_le.
      - lra.
      - apply (@ex_RInt_continuous R_CompleteNormedModule). intros z Hz.
        rewrite Rmin_left in Hz by lra.
        destruct (HA' z ltac:(lra)) as [_ [Hd _]].
        apply (continuous_comp (dpsi F i) (fun y : R => y ^ 2)).
        + apply (@ex_derive_continuous R_AbsRing R_NormedModule). exists (ddpsi F i z). exact Hd.
        + apply (@ex_derive_continuous R_AbsRing R_NormedModule).
          apply ex_derive_Reals_1. apply derivable_pt_pow.
      - apply ex_RInt_const.
      - intros s Hs. apply Hsmall. lra. }
    rewrite RInt_const in HI. unfold scal in HI. simpl in HI. unfold mult in HI. simpl in HI.
    replace ((t + T F - t) * (mu F / T F / 4)) with (mu F / 4) in HI by (field; lra).
    destruct (HA' t Ht) as [_ [_ [_ [_ [_ Hm]]]]].
    simpl in Hm, HI. lra.
Qed.

(** psi' changes by at most psi2 times the time that passes. *)
Lemma slope_lipschitz : forall F, A3 F -> forall i r s, (i < N F)%nat -> 0 <= r -> 0 <= s ->
  Rabs (dpsi F i s - dpsi F i r) <= psi2 F * Rabs (s - r).
Proof.
  intros F HA i r s Hi Hr Hs.
  destruct HA as [HT [Hmu HA]].
  assert (HA' := HA i Hi). clear HA.
  assert (Hmin : 0 <= Rmin r s) by (apply Rmin_glb; assumption).
  destruct (MVT_gen (dpsi F i) r s (ddpsi F i)) as [c [Hc Heq]].
  - intros x Hx. destruct (HA' x ltac:(lra)) as [_ [Hd _]]. exact Hd.
  - intros x Hx. destruct (HA' x ltac:(lra)) as [_ [Hd _]].
    apply derivable_continuous_pt. exists (ddpsi F i x). apply is_derive_Reals. exact Hd.
  - rewrite Heq. rewrite Rabs_mult.
    apply Rmult_le_compat_r.
    + apply Rabs_pos.
    + destruct (HA' c ltac:(lra)) as [_ [_ [_ [_ [Hb _]]]]]. exact Hb.
Qed.

(** L10: a stretch of length 2 h in every window on which psi' is at least q in size. *)
Lemma excitation : forall F, A3 F -> exists h q, 0 < h /\ 0 < q /\
  forall i t, (i < N F)%nat -> 0 <= t ->
    exists r, t <= r /\ r + 2 * h <= t + T F /\
      forall s, r <= s <= r + 2 * h -> q <= Rabs (dpsi F i s).
Proof.
  intros F HA.
  assert (HT : 0 < T F) by apply HA.
  assert (Hmu : 0 < mu F) by apply HA.
  assert (Hsp : 0 < sqrt (mu F / T F)).
  { apply sqrt_lt_R0. apply Rdiv_lt_0_compat; assumption. }
  set (q := sqrt (mu F / T F) / 4).
  assert (Hq : 0 < q) by (unfold q; lra).
  set (p2 := Rabs (psi2 F) + 1).
  assert (Hp2 : 0 < p2) by (unfold p2; assert (H := Rabs_pos (psi2 F)); lra).
  assert (Hpp : psi2 F <= p2) by (unfold p2; assert (H := Rle_abs (psi2 F)); lra).
  set (h := Rmin (T F / 4) (q / p2 / 2)).
  assert (Hqp : 0 < q / p2) by (apply Rdiv_lt_0_compat; assumption).
  assert (Hh : 0 < h) by (unfold h; apply Rmin_glb_lt; lra).
  assert (HhT : h <= T F / 4) by apply Rmin_l.
  assert (Hhq : h <= q / p2 / 2) by apply Rmin_r.
  assert (Hhq' : p2 * (2 * h) <= q).
  { apply Rle_trans with (p2 * (2 * (q / p2 / 2))).
    - apply Rmult_le_compat_l; lra.
    - right. field. lra. }
  exists h, q. split; [exact Hh | split; [exact Hq |]].
  intros i t Hi Ht.
  destruct (slope_somewhere F HA i t Hi Ht) as [c [Hc Hbig]].
  assert (Hnear : forall s, t <= s -> Rabs (s - c) <= 2 * h -> q <= Rabs (dpsi F i s)).
  { intros s Hs Hd.
    assert (Hl := slope_lipschitz F HA i c s Hi ltac:(lra) ltac:(lra)).
    assert (Hq2 : sqrt (mu F / T F) / 2 = 2 * q) by (unfold q; field).
    assert (Hle : psi2 F * Rabs (s - c) <= q).
    { apply Rle_trans with (p2 * Rabs (s - c)).
      - apply Rmult_le_compat_r; [apply Rabs_pos | exact Hpp].
      - apply Rle_trans with (p2 * (2 * h)); [| exact Hhq'].
        apply Rmult_le_compat_l; lra. }
    assert (Htri := Rabs_triang_inv (dpsi F i c) (dpsi F i s)).
    rewrite Rabs_minus_sym in Htri. lra. }
  destruct (Rle_dec (c + 2 * h) (t + T F)) as [Hr | Hr].
  - exists c. split; [lra | split; [exact Hr |]].
    intros s Hs. apply Hnear; [lra |]. apply Rabs_le. lra.
  - exists (c - 2 * h). split; [lra | split; [lra |]].
    intros s Hs. apply Hnear; [lra |]. apply Rabs_le. lra.
Qed.

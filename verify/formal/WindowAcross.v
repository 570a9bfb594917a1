(** * WindowAcross.v : L12, the pull across the heading.  This is where the excitation (L10) enters.
    If every speed and turn rate is small over one window, then so is the pull b across the heading, all through it.
    Idea: in such a window the turning torque is nearly k b psi(t) plus a constant.  Where psi is steep, the torque at two
    moments differs by about k b times the rise of psi, while turn rates that stay small allow only a small difference. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus Excitation WindowIncrements.
Open Scope R_scope.

(** A quantity that stays below eta: somewhere its rates at two moments h apart differ by at most 4 eta / h. *)
Lemma small_rate_difference : forall (f df : R -> R) r h eta, 0 < h ->
  (forall s, r <= s <= r + 2 * h -> is_derive f s (df s)) -> (forall s, r <= s <= r + 2 * h -> Rabs (f s) <= eta) ->
  exists s, r <= s <= r + h /\ Rabs (df (s + h) - df s) <= 4 * eta / h.
Proof.
  intros f df r h eta Hh Hd Hs.
  destruct (mean_value (fun s => f (s + h) - f s) (fun s => df (s + h) - df s) r (r + h) ltac:(lra)) as [c [Hc E]].
  - intros s Hrs. apply derive_minus; [| apply Hd; lra].
    apply (derive_value _ s (df (s + h) * (1 + 0))); [| ring].
    apply (derive_comp f (fun x => x + h)); [apply Hd; lra |].
    apply derive_plus; [apply derive_id | apply derive_const].
  - exists c. split; [exact Hc |].
    assert (H1 := Hs (r + h + h) ltac:(lra)). assert (H2 := Hs (r + h) ltac:(lra)). assert (H3 := Hs r ltac:(lra)).
    apply Rabs_le_between in H1. apply Rabs_le_between in H2. apply Rabs_le_between in H3.
    replace (r + h - r) with h in E by ring.
    assert (H4 : Rabs (h * (df (c + h) - df c)) <= 4 * eta).
    { rewrite Rmult_comm, <- E. apply Rabs_le. lra. }
    apply (abs_of_scaled _ _ _ Hh) in H4. exact H4.
Qed.

(** Where psi' is at least q in size, psi changes by at least q h over a time h. *)
Lemma steep_rise : forall F, A3 F -> forall i r h q, (i < N F)%nat -> 0 <= r -> 0 < h ->
  (forall s, r <= s <= r + 2 * h -> q <= Rabs (dpsi F i s)) ->
  forall s, r <= s <= r + h -> q * h <= Rabs (psi F i (s + h) - psi F i s).
Proof.
  intros F HA3 i r h q Hi Hr Hh Hq s Hs.
  destruct (mean_value (psi F i) (dpsi F i) s (s + h) ltac:(lra)) as [c [Hc E]].
  - intros x Hx. destruct (proj2 (proj2 HA3) i Hi x ltac:(lra)) as [H _]. exact H.
  - rewrite E, Rabs_mult. replace (s + h - s) with h by ring. rewrite (Rabs_pos_eq h) by lra.
    apply Rmult_le_compat_r; [lra |]. apply Hq. lra.
Qed.

(** k b (psi' - psi) from two torques: the other terms hardly change. *)
Lemma excitation_difference : forall pw dw k e e' g g' p p' b b' b0 u u' psi0 ce cg cb cu,
  0 < pw -> 0 < dw -> 0 < k -> Rabs p <= psi0 -> Rabs p' <= psi0 ->
  u = - pw * e - dw * g + k * p * b -> u' = - pw * e' - dw * g' + k * p' * b' ->
  Rabs (u' - u) <= cu -> Rabs (e' - e) <= ce -> Rabs (dw * g) <= cg -> Rabs (dw * g') <= cg ->
  Rabs (b - b0) <= cb -> Rabs (b' - b0) <= cb ->
  Rabs (k * b0 * (p' - p)) <= cu + pw * ce + 2 * cg + 2 * (k * psi0 * cb).
Proof.
  intros pw dw k e e' g g' p p' b b' b0 u u' psi0 ce cg cb cu Hpw Hdw Hk Hp Hp' Hu Hu' Hdu He Hg Hg' Hb Hb'.
  assert (He2 : Rabs (pw * (e' - e)) <= pw * ce).
  { rewrite Rabs_mult, (Rabs_pos_eq pw) by lra. apply Rmult_le_compat_l; lra. }
  assert (Hterm : forall x y, Rabs x <= psi0 -> Rabs (y - b0) <= cb -> Rabs (k * x * (y - b0)) <= k * psi0 * cb).
  { intros x y Hx Hy. rewrite !Rabs_mult, (Rabs_pos_eq k) by lra.
    apply Rmult_le_compat; try assumption; try apply Rabs_pos.
    - apply Rmult_le_pos; [lra | apply Rabs_pos].
    - apply Rmult_le_compat_l; lra. }
  assert (H1 := Hterm p b Hp Hb). assert (H2 := Hterm p' b' Hp' Hb').
  replace (k * b0 * (p' - p)) with
    ((u' - u) + pw * (e' - e) + (dw * g' - dw * g) - (k * p' * (b' - b0)) + k * p * (b - b0))
    by (rewrite Hu, Hu'; ring).
  apply Rabs_le_between in Hdu. apply Rabs_le_between in He2. apply Rabs_le_between in Hg. apply Rabs_le_between in Hg'.
  apply Rabs_le_between in H1. apply Rabs_le_between in H2.
  apply Rabs_le. lra.
Qed.

Lemma across_small : forall F, A1 F -> A2 F -> A3 F -> forall i, (i < N F)%nat -> exists c,
  forall t0 X t eta, 0 <= t0 -> t0 <= t -> solution F t0 X -> slow F X t eta ->
    forall s, t <= s <= t + T F -> Rabs (across F (X s) i) <= c * eta.
Proof.
  intros F HA1 HA2 HA3 i Hi.
  assert (HT : 0 < T F) by apply HA3.
  assert (Hrs : 0 < rs F) by apply HA2.
  destruct (excitation F HA3) as [h [q [Hh [Hqp Hexc]]]].
  destruct (proj2 (proj2 HA2) i Hi) as [_ [HJ [_ [_ [_ [_ [Hpw [Hdw [Hk [_ Hws]]]]]]]]]].
  set (ce := 2 * deg F i / rs F * T F).
  set (ctot := J F i * (4 / h) + pw F i * ce + 2 * (dw F i / ws F i) + 2 * (k F i * psi0 F * pull_change F i)).
  exists (ctot / (k F i * (q * h)) + pull_change F i).
  intros t0 X t eta Ht0 Ht HX Hq.
  assert (Hturn := slow_is_slow_turning F X t eta Hq).
  destruct (Hexc i t Hi ltac:(lra)) as [r [Hr [Hrh Hsteep]]].
  assert (Hpull := fun a b Ha Hb => proj2 (pull_increment F HA1 HA2 t0 X t eta HX Ht Hq i a b Hi Ha Hb)).
  destruct (small_rate_difference (fun s => om (X s) i) (fun s => u_w F s (X s) i / J F i) r h eta Hh) as [c [Hc Hrate]].
  - intros s Hs. destruct (HX i Hi s ltac:(lra)) as [_ [_ [_ [_ H]]]]. exact H.
  - intros s Hs. apply (Hq s i ltac:(lra) Hi).
  - assert (Hc1 : t <= c <= t + T F) by lra. assert (Hc2 : t <= c + h <= t + T F) by lra.
    assert (Hu : Rabs (u_w F (c + h) (X (c + h)) i - u_w F c (X c) i) <= J F i * (4 * eta / h)).
    { replace (u_w F (c + h) (X (c + h)) i - u_w F c (X c) i)
        with (J F i * (u_w F (c + h) (X (c + h)) i / J F i - u_w F c (X c) i / J F i)) by (field; lra).
      rewrite Rabs_mult, (Rabs_pos_eq (J F i)) by lra. apply Rmult_le_compat_l; lra. }
    assert (Hpsi : forall s, t <= s -> Rabs (psi F i s) <= psi0 F).
    { intros s Hs. apply (proj2 (proj2 HA3) i Hi s). lra. }
    assert (Hdiff := excitation_difference (pw F i) (dw F i) (k F i) _ _ _ _ _ _ _ _ (across F (X t) i) _ _ (psi0 F) _ _ _ _
      Hpw Hdw Hk (Hpsi c ltac:(lra)) (Hpsi (c + h) ltac:(lra)) eq_refl eq_refl Hu
      (eth_increment F HA1 HA2 t0 X t eta HX Ht Hturn i c (c + h) Hi Hc1 Hc2)
      (damping_small (dw F i) _ (ws F i) eta Hdw Hws (proj2 (Hq c i Hc1 Hi)))
      (damping_small (dw F i) _ (ws F i) eta Hdw Hws (proj2 (Hq (c + h) i Hc2 Hi)))
      (Hpull t c ltac:(lra) Hc1) (Hpull t (c + h) ltac:(lra) Hc2)).
    assert (Hrise := steep_rise F HA3 i r h q Hi ltac:(lra) Hh Hsteep c Hc).
    assert (Hqh : 0 < q * h) by (apply Rmult_lt_0_compat; assumption).
    assert (Hkqh : 0 < k F i * (q * h)) by (apply Rmult_lt_0_compat; assumption).
    assert (Hb : Rabs (across F (X t) i) <= ctot * eta / (k F i * (q * h))).
    { apply abs_of_scaled; [exact Hkqh |].
      apply Rle_trans with (Rabs (k F i * across F (X t) i * (psi F i (c + h) - psi F i c))).
      - rewrite !Rabs_mult, (Rabs_pos_eq (k F i)), (Rabs_pos_eq q), (Rabs_pos_eq h) by lra.
        rewrite !Rmult_assoc. apply Rmult_le_compat_l; [lra |].
        rewrite <- Rmult_assoc, Rmult_comm. apply Rmult_le_compat_l; [apply Rabs_pos | exact Hrise].
      - apply Rle_trans with (1 := Hdiff). right. unfold ctot, ce. field. repeat split; lra. }
    intros s Hs. assert (Hinc := Hpull t s ltac:(lra) Hs).
    replace (across F (X s) i) with (across F (X t) i + (across F (X s) i - across F (X t) i)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _).
    rewrite Rmult_plus_distr_r. apply Rplus_le_compat; [| exact Hinc].
    apply Rle_trans with (1 := Hb). right. field. split; lra.
Qed.

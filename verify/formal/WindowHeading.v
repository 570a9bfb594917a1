(** * WindowHeading.v : L12, the heading.
    If every turn rate and every excitation torque is small over one window, then so are the heading errors.
    Idea: a turn rate that stays small over a window has a small mean acceleration, so at some moment the heading's
    restoring torque is small; headings hardly move in that window, so it is small at the window's start; then L9. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus EnergyDerivatives InverseBound WindowIncrements.
Open Scope R_scope.

(** Three small terms leave the fourth small. *)
Lemma restoring_small : forall pull damping drive total b1 b2 b3,
  total = - pull - damping + drive -> Rabs total <= b1 -> Rabs damping <= b2 -> Rabs drive <= b3 -> Rabs pull <= b1 + b2 + b3.
Proof.
  intros pull damping drive total b1 b2 b3 E H1 H2 H3.
  replace pull with (- total + (- damping + drive)) by lra.
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp.
  assert (H4 := Rabs_triang (- damping) drive). rewrite Rabs_Ropp in H4. lra.
Qed.

(** A quantity that stays below eta over a window has at some moment a rate of at most 2 eta / T. *)
Lemma small_rate_somewhere : forall (f df : R -> R) t len eta, 0 < len ->
  (forall s, t <= s <= t + len -> is_derive f s (df s)) -> (forall s, t <= s <= t + len -> Rabs (f s) <= eta) ->
  exists s, t <= s <= t + len /\ Rabs (df s) <= 2 * eta / len.
Proof.
  intros f df t len eta Hlen Hd Hs.
  destruct (mean_value f df t (t + len) ltac:(lra) Hd) as [c [Hc E]].
  exists c. split; [exact Hc |].
  apply abs_of_scaled; [exact Hlen |].
  replace (len * df c) with (f (t + len) - f t) by (rewrite E; ring).
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp.
  assert (H1 := Hs t ltac:(lra)). assert (H2 := Hs (t + len) ltac:(lra)). lra.
Qed.

Lemma eth_small : forall F, A1 F -> A2 F -> A3 F -> forall i, (i < N F)%nat -> exists c,
  forall t0 X t eta, t0 <= t -> solution F t0 X ->
    (forall s j, t <= s <= t + T F -> (j < N F)%nat -> Rabs (om (X s) j) <= eta /\ Rabs (alpha F s (X s) j) <= eta) ->
    Rabs (eth F (X t) i) <= c * eta.
Proof.
  intros F HA1 HA2 HA3 i Hi.
  assert (HT : 0 < T F) by apply HA3.
  assert (Hrs : 0 < rs F) by apply HA2.
  destruct (proj2 (proj2 HA2) i Hi) as [_ [HJ [_ [_ [_ [_ [Hpw [Hdw [_ [_ Hws]]]]]]]]]].
  exists ((J F i * (2 / T F) + dw F i / ws F i + 1) / pw F i + 2 * deg F i / rs F * T F).
  intros t0 X t eta Ht HX Hq.
  assert (Hturn : slow_turning F X t eta) by (intros s j Hs Hj; apply (Hq s j Hs Hj)).
  destruct (small_rate_somewhere (fun s => om (X s) i) (fun s => u_w F s (X s) i / J F i) t (T F) eta HT) as [c [Hc Hrate]].
  - intros s Hs. destruct (HX i Hi s ltac:(lra)) as [_ [_ [_ [_ H]]]]. exact H.
  - intros s Hs. apply (Hq s i Hs Hi).
  - assert (Huw : Rabs (u_w F c (X c) i) <= J F i * (2 * eta / T F)).
    { replace (u_w F c (X c) i) with (J F i * (u_w F c (X c) i / J F i)) by (field; lra).
      rewrite Rabs_mult, (Rabs_pos_eq (J F i)) by lra. apply Rmult_le_compat_l; lra. }
    assert (Hdamp := damping_small (dw F i) _ (ws F i) eta Hdw Hws (proj1 (Hq c i Hc Hi))).
    assert (Hpull := restoring_small (pw F i * eth F (X c) i) (dw F i * tanh (om (X c) i / ws F i)) (alpha F c (X c) i) (u_w F c (X c) i) _ _ _
      ltac:(unfold u_w, alpha; ring) Huw Hdamp (proj2 (Hq c i Hc Hi))).
    apply (abs_of_scaled _ _ _ Hpw) in Hpull.
    assert (Hinc := eth_increment F HA1 HA2 t0 X t eta HX Ht Hturn i c t Hi Hc ltac:(lra)).
    replace (eth F (X t) i) with (eth F (X c) i + (eth F (X t) i - eth F (X c) i)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _).
    rewrite Rmult_plus_distr_r. apply Rplus_le_compat; [| exact Hinc].
    apply Rle_trans with (1 := Hpull). right. field. lra.
Qed.

(** One constant for all vehicles. *)
Lemma eth_small_all : forall F, A1 F -> A2 F -> A3 F -> exists c, 0 < c /\
  forall t0 X t eta, t0 <= t -> solution F t0 X ->
    (forall s j, t <= s <= t + T F -> (j < N F)%nat -> Rabs (om (X s) j) <= eta /\ Rabs (alpha F s (X s) j) <= eta) ->
    forall i, (i < N F)%nat -> Rabs (eth F (X t) i) <= c * eta.
Proof.
  intros F HA1 HA2 HA3.
  destruct (finite_common_large (N F) (fun i c => forall t0 X t eta, t0 <= t -> solution F t0 X ->
    (forall s j, t <= s <= t + T F -> (j < N F)%nat -> Rabs (om (X s) j) <= eta /\ Rabs (alpha F s (X s) j) <= eta) ->
    Rabs (eth F (X t) i) <= c * eta)) as [c [Hc H]].
  - intros i x y Hi Hxy H t0 X t eta Ht HX Hq.
    apply Rle_trans with (1 := H t0 X t eta Ht HX Hq).
    apply Rmult_le_compat_r; [| exact Hxy].
    assert (HT : 0 < T F) by apply HA3.
    apply Rle_trans with (2 := proj1 (Hq t i ltac:(lra) Hi)). apply Rabs_pos.
  - intros i Hi. apply (eth_small F HA1 HA2 HA3 i Hi).
  - exists c. split; [exact Hc |]. intros t0 X t eta Ht HX Hq i Hi. apply (H i Hi t0 X t eta Ht HX Hq).
Qed.

(** N terms of at most eps / (N + 1) each add up to at most eps. *)
Lemma sum_small : forall n (f : nat -> R) b eps, 0 <= eps -> b <= eps / INR (S n) ->
  (forall i, (i < n)%nat -> f i <= b) -> sum n f <= eps.
Proof.
  intros n f b eps Heps Hb Hf.
  assert (Hn : 0 < INR (S n)) by (apply lt_0_INR; lia).
  apply Rle_trans with (sum n (fun _ => eps / INR (S n))).
  - apply sum_le. intros i Hi. apply Rle_trans with (2 := Hb). apply Hf. exact Hi.
  - rewrite sum_const. apply Rle_trans with (INR (S n) * (eps / INR (S n))).
    + apply Rmult_le_compat_r; [apply div_nonneg; assumption | apply le_INR; lia].
    + right. field. lra.
Qed.

Lemma window_heading : forall F, A1 F -> A2 F -> A3 F -> forall eps, 0 < eps -> exists eta, 0 < eta /\
  forall t0 X t, 0 <= t0 -> t0 <= t -> solution F t0 X ->
    (forall s i, t <= s <= t + T F -> (i < N F)%nat -> Rabs (om (X s) i) <= eta /\ Rabs (alpha F s (X s) i) <= eta) ->
    sum (N F) (fun i => Rabs (tha F (X t) i) + Rabs (om (X t) i)) <= eps.
Proof.
  intros F HA1 HA2 HA3 eps Heps.
  assert (HT : 0 < T F) by apply HA3.
  assert (Hrs : 0 < rs F) by apply HA2.
  set (e1 := eps / INR (S (N F))).
  assert (He1 : 0 < e1) by (apply div_pos; [exact Heps | apply lt_0_INR; lia]).
  destruct (inverse_bound F HA1 (rs F) Hrs (e1 / 2) ltac:(lra)) as [chi [Hchi Hinv]].
  destruct (eth_small_all F HA1 HA2 HA3) as [c [Hc Heth]].
  assert (Hcc : 0 < chi / c) by (apply div_pos; assumption).
  exists (Rmin (chi / c) (e1 / 2)).
  split; [apply Rmin_glb_lt; lra |].
  intros t0 X t Ht0 Ht HX Hq.
  assert (Hl := Rmin_l (chi / c) (e1 / 2)). assert (Hr := Rmin_r (chi / c) (e1 / 2)).
  set (eta := Rmin (chi / c) (e1 / 2)) in *.
  apply (sum_small _ _ e1 eps); [lra | apply Rle_refl |].
  intros i Hi.
  assert (H1 : Rabs (tha F (X t) i) <= e1 / 2).
  { apply (Hinv (tha F (X t))); [| exact Hi]. intros j Hj.
    apply Rle_trans with (1 := Heth t0 X t eta Ht HX Hq j Hj).
    apply Rle_trans with (c * (chi / c)); [apply Rmult_le_compat_l; lra | right; field; lra]. }
  assert (H2 := proj1 (Hq t i ltac:(lra) Hi)). lra.
Qed.

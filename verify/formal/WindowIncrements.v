(** * WindowIncrements.v : what can change over a window in which everything is slow (for L12).
    If all speeds and turn rates stay below eta over a window of length T, then positions and headings move by at
    most T eta, and hence every coupling term and every pull on a vehicle changes by at most a constant times eta. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus EnergyDerivatives Torques.
Open Scope R_scope.

(** A function with slope at most eta moves by at most T eta over a window of length T. *)
Lemma window_increment : forall (f : R -> R) t len eta, 0 <= eta ->
  (forall s, t <= s <= t + len -> exists l, is_derive f s l /\ Rabs l <= eta) ->
  forall r s, t <= r <= t + len -> t <= s <= t + len -> Rabs (f s - f r) <= len * eta.
Proof.
  intros f t len eta Heta Hf.
  assert (H : forall r s, t <= r -> r <= s -> s <= t + len -> Rabs (f s - f r) <= len * eta).
  { intros r s Hr Hrs Hs.
    apply Rle_trans with (eta * (s - r)).
    - apply increment_abs; [exact Hrs |]. intros x Hx. apply Hf. lra.
    - rewrite Rmult_comm. apply Rmult_le_compat_r; lra. }
  intros r s Hr Hs. destruct (Rle_dec r s) as [L | L].
  - apply H; lra.
  - rewrite Rabs_minus_sym. apply H; lra.
Qed.

Lemma cos_lipschitz : forall x y, Rabs (cos y - cos x) <= Rabs (y - x).
Proof.
  intros x y. destruct (MVT_gen cos x y (fun c => - sin c)) as [c [_ E]].
  - intros z _. apply is_derive_Reals. apply derivable_pt_lim_cos.
  - intros z _. apply continuity_cos.
  - rewrite E, Rabs_mult. rewrite <- (Rmult_1_l (Rabs (y - x))) at 2.
    apply Rmult_le_compat_r; [apply Rabs_pos |]. apply Rabs_le. assert (B := SIN_bound c). lra.
Qed.

Lemma sin_lipschitz : forall x y, Rabs (sin y - sin x) <= Rabs (y - x).
Proof.
  intros x y. destruct (MVT_gen sin x y cos) as [c [_ E]].
  - intros z _. apply is_derive_Reals. apply derivable_pt_lim_sin.
  - intros z _. apply continuity_sin.
  - rewrite E, Rabs_mult. rewrite <- (Rmult_1_l (Rabs (y - x))) at 2.
    apply Rmult_le_compat_r; [apply Rabs_pos |]. apply Rabs_le. apply COS_bound.
Qed.

Lemma cos_abs_le_1 : forall x, Rabs (cos x) <= 1.
Proof. intros x. apply Rabs_le. apply COS_bound. Qed.

Lemma sin_abs_le_1 : forall x, Rabs (sin x) <= 1.
Proof. intros x. apply Rabs_le. assert (B := SIN_bound x). lra. Qed.

(** |c x| <= |x| for a cosine or sine c. *)
Lemma abs_mult_le_1 : forall c x, Rabs c <= 1 -> Rabs (c * x) <= Rabs x.
Proof.
  intros c x Hc. rewrite Rabs_mult. rewrite <- (Rmult_1_l (Rabs x)) at 2.
  apply Rmult_le_compat_r; [apply Rabs_pos | exact Hc].
Qed.

(** Change of a product with a factor of size at most 1. *)
Lemma product_increment : forall c c' x x' D dc dx, Rabs c <= 1 -> Rabs x' <= D ->
  Rabs (c' - c) <= dc -> Rabs (x' - x) <= dx -> Rabs (c' * x' - c * x) <= dc * D + dx.
Proof.
  intros c c' x x' D dc dx Hc Hx Hdc Hdx.
  replace (c' * x' - c * x) with ((c' - c) * x' + c * (x' - x)) by ring.
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat.
  - rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; assumption.
  - apply Rle_trans with (2 := Hdx). apply abs_mult_le_1. exact Hc.
Qed.

(** A factor is small when the product is. *)
Lemma abs_of_scaled : forall p x b, 0 < p -> Rabs (p * x) <= b -> Rabs x <= b / p.
Proof.
  intros p x b Hp H. rewrite Rabs_mult, (Rabs_pos_eq p) in H by lra.
  apply Rmult_le_reg_l with p; [exact Hp |]. replace (p * (b / p)) with b by (field; lra). exact H.
Qed.

(** A saturated damping term is at most the linear one. *)
Lemma damping_small : forall d x scale eta, 0 < d -> 0 < scale -> Rabs x <= eta ->
  Rabs (d * tanh (x / scale)) <= d / scale * eta.
Proof.
  intros d x scale eta Hd Hs Hx. rewrite Rabs_mult, (Rabs_pos_eq d) by lra.
  replace (d / scale * eta) with (d * (eta / scale)) by (field; lra).
  apply Rmult_le_compat_l; [lra |]. apply Rle_trans with (1 := tanh_abs_le _).
  rewrite abs_div_pos by exact Hs. apply div_le; assumption.
Qed.

(** A coupling term changes by at most 2 D / scale times the largest change of an error. *)
Lemma coupling_increment : forall F, A1 F -> forall scale, 0 < scale -> forall z z' d i, (i < N F)%nat ->
  (forall j, (j < N F)%nat -> Rabs (z' j - z j) <= d) ->
  Rabs (coupling F scale z' i - coupling F scale z i) <= 2 * deg F i / scale * d.
Proof.
  intros F [Ha [Hal _]] scale Hs z z' d i Hi Hd.
  assert (Hdi := Hd i Hi).
  assert (Hd0 : 0 <= d) by (apply Rle_trans with (2 := Hdi); apply Rabs_pos).
  assert (Hth : forall x x', Rabs (x' - x) <= 2 * d -> Rabs (tanh (x' / scale) - tanh (x / scale)) <= 2 * d / scale).
  { intros x x' Hx. apply Rle_trans with (1 := tanh_lipschitz _ _).
    replace (x' / scale - x / scale) with ((x' - x) / scale) by (field; lra).
    rewrite abs_div_pos by exact Hs. apply div_le; assumption. }
  unfold coupling, deg.
  match goal with |- Rabs (?A + ?B - (?C + ?D)) <= _ => replace (A + B - (C + D)) with ((A - C) + (B - D)) by ring end.
  replace (2 * (al F i + sum (N F) (fun j => a F i j)) / scale * d)
    with (al F i * (2 * d / scale) + sum (N F) (fun j => a F i j) * (2 * d / scale)) by (field; lra).
  apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat.
  - rewrite <- Rmult_minus_distr_l, Rabs_mult, (Rabs_pos_eq (al F i)) by (apply Hal; exact Hi).
    apply Rmult_le_compat_l; [apply Hal; exact Hi |]. apply Hth. lra.
  - rewrite <- sum_minus, <- sum_scal_r. apply sum_abs_le. intros j Hj.
    assert (Hij := proj2 (Ha i j Hi Hj)).
    rewrite <- Rmult_minus_distr_l, Rabs_mult, (Rabs_pos_eq (a F i j)) by exact Hij.
    apply Rmult_le_compat_l; [exact Hij |]. apply Hth.
    replace (z' i - z' j - (z i - z j)) with ((z' i - z i) - (z' j - z j)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp. assert (Hdj := Hd j Hj). lra.
Qed.

(** ** Along a motion.  [slow_turning]: turn rates below eta over the window; [slow]: speeds too. *)
Definition slow_turning (F : fleet) (X : R -> state) (t eta : R) : Prop :=
  forall s i, t <= s <= t + T F -> (i < N F)%nat -> Rabs (om (X s) i) <= eta.
Definition slow (F : fleet) (X : R -> state) (t eta : R) : Prop :=
  forall s i, t <= s <= t + T F -> (i < N F)%nat -> Rabs (v (X s) i) <= eta /\ Rabs (om (X s) i) <= eta.

Lemma slow_is_slow_turning : forall F X t eta, slow F X t eta -> slow_turning F X t eta.
Proof. intros F X t eta H s i Hs Hi. apply (H s i Hs Hi). Qed.

Lemma heading_increment : forall F t0 X t eta, solution F t0 X -> t0 <= t -> slow_turning F X t eta ->
  forall i r s, (i < N F)%nat -> t <= r <= t + T F -> t <= s <= t + T F -> Rabs (th (X s) i - th (X r) i) <= T F * eta.
Proof.
  intros F t0 X t eta HX Ht Hq i r s Hi Hr Hs.
  assert (Heta : 0 <= eta) by (apply Rle_trans with (2 := Hq r i Hr Hi); apply Rabs_pos).
  apply (window_increment (fun x => th (X x) i) t (T F) eta Heta); try assumption.
  intros x Hx. exists (om (X x) i). split; [| apply Hq; assumption].
  destruct (HX i Hi x ltac:(lra)) as [_ [_ [H _]]]. exact H.
Qed.

Lemma position_increment : forall F t0 X t eta, solution F t0 X -> t0 <= t -> slow F X t eta ->
  forall i r s, (i < N F)%nat -> t <= r <= t + T F -> t <= s <= t + T F ->
    Rabs (px (X s) i - px (X r) i) <= T F * eta /\ Rabs (py (X s) i - py (X r) i) <= T F * eta.
Proof.
  intros F t0 X t eta HX Ht Hq i r s Hi Hr Hs.
  assert (Heta : 0 <= eta) by (apply Rle_trans with (2 := proj1 (Hq r i Hr Hi)); apply Rabs_pos).
  split.
  - apply (window_increment (fun x => px (X x) i) t (T F) eta Heta); try assumption.
    intros x Hx. exists (cos (th (X x) i) * v (X x) i).
    destruct (HX i Hi x ltac:(lra)) as [H _]. split; [exact H |].
    apply Rle_trans with (2 := proj1 (Hq x i Hx Hi)). apply abs_mult_le_1, cos_abs_le_1.
  - apply (window_increment (fun x => py (X x) i) t (T F) eta Heta); try assumption.
    intros x Hx. exists (sin (th (X x) i) * v (X x) i).
    destruct (HX i Hi x ltac:(lra)) as [_ [H _]]. split; [exact H |].
    apply Rle_trans with (2 := proj1 (Hq x i Hx Hi)). apply abs_mult_le_1, sin_abs_le_1.
Qed.

Lemma eth_increment : forall F, A1 F -> A2 F -> forall t0 X t eta, solution F t0 X -> t0 <= t -> slow_turning F X t eta ->
  forall i r s, (i < N F)%nat -> t <= r <= t + T F -> t <= s <= t + T F ->
    Rabs (eth F (X s) i - eth F (X r) i) <= 2 * deg F i / rs F * T F * eta.
Proof.
  intros F HA1 HA2 t0 X t eta HX Ht Hq i r s Hi Hr Hs.
  rewrite Rmult_assoc. apply (coupling_increment F HA1); [apply HA2 | exact Hi |].
  intros j Hj. unfold tha.
  replace (th (X s) j - leadth F - (th (X r) j - leadth F)) with (th (X s) j - th (X r) j) by ring.
  apply (heading_increment F t0 X t eta HX Ht Hq); assumption.
Qed.

(** By how much the pull along and across the heading can change, per eta. *)
Definition pull_change (F : fleet) (i : nat) : R := 2 * (T F * deg F i + 2 * deg F i / ls F * T F).

Lemma pull_increment : forall F, A1 F -> A2 F -> forall t0 X t eta, solution F t0 X -> t0 <= t -> slow F X t eta ->
  forall i r s, (i < N F)%nat -> t <= r <= t + T F -> t <= s <= t + T F ->
    Rabs (along F (X s) i - along F (X r) i) <= pull_change F i * eta /\
    Rabs (across F (X s) i - across F (X r) i) <= pull_change F i * eta.
Proof.
  intros F HA1 HA2 t0 X t eta HX Ht Hq i r s Hi Hr Hs.
  assert (Hls : 0 < ls F) by apply HA2.
  assert (Hth := heading_increment F t0 X t eta HX Ht (slow_is_slow_turning F X t eta Hq) i r s Hi Hr Hs).
  assert (Hpos := fun j (Hj : (j < N F)%nat) => position_increment F t0 X t eta HX Ht Hq j r s Hj Hr Hs).
  assert (Hex : Rabs (ex F (X s) i - ex F (X r) i) <= 2 * deg F i / ls F * (T F * eta)).
  { apply (coupling_increment F HA1); [exact Hls | exact Hi |]. intros j Hj. unfold zx.
    match goal with |- Rabs ?A <= _ => replace A with (px (X s) j - px (X r) j) by ring end.
    apply (Hpos j Hj). }
  assert (Hey : Rabs (ey F (X s) i - ey F (X r) i) <= 2 * deg F i / ls F * (T F * eta)).
  { apply (coupling_increment F HA1); [exact Hls | exact Hi |]. intros j Hj. unfold zy.
    match goal with |- Rabs ?A <= _ => replace A with (py (X s) j - py (X r) j) by ring end.
    apply (Hpos j Hj). }
  assert (Hc := Rle_trans _ _ _ (cos_lipschitz (th (X r) i) (th (X s) i)) Hth).
  assert (Hsn := Rle_trans _ _ _ (sin_lipschitz (th (X r) i) (th (X s) i)) Hth).
  assert (Bx : Rabs (ex F (X s) i) <= deg F i) by (apply coupling_bound; assumption).
  assert (By : Rabs (ey F (X s) i) <= deg F i) by (apply coupling_bound; assumption).
  assert (Hcx := product_increment _ _ _ _ _ _ _ (cos_abs_le_1 (th (X r) i)) Bx Hc Hex).
  assert (Hcy := product_increment _ _ _ _ _ _ _ (cos_abs_le_1 (th (X r) i)) By Hc Hey).
  assert (Hsx := product_increment _ _ _ _ _ _ _ (sin_abs_le_1 (th (X r) i)) Bx Hsn Hex).
  assert (Hsy := product_increment _ _ _ _ _ _ _ (sin_abs_le_1 (th (X r) i)) By Hsn Hey).
  replace (pull_change F i * eta) with ((T F * eta * deg F i + 2 * deg F i / ls F * (T F * eta))
    + (T F * eta * deg F i + 2 * deg F i / ls F * (T F * eta))) by (unfold pull_change; field; lra).
  unfold along, across. split.
  - match goal with |- Rabs (?A + ?B - (?C + ?D)) <= _ => replace (A + B - (C + D)) with ((A - C) + (B - D)) by ring end.
    apply Rle_trans with (1 := Rabs_triang _ _). apply Rplus_le_compat; assumption.
  - match goal with |- Rabs (- ?a * ?A + ?B - (- ?c * ?C + ?D)) <= _ =>
      replace (- a * A + B - (- c * C + D)) with (- (a * A - c * C) + (B - D)) by ring end.
    apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp. apply Rplus_le_compat; assumption.
Qed.

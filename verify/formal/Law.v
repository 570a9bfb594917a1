(** * Law.v : the closed loop obeys a law of motion x' = f(t, x) that Picard.v takes (theorem, part (a); L1).
    Every term of the controller varies at a bounded rate with the state: its factors are bounded.
    The one exception is cos(th) v; but speeds change at a bounded rate, so over a bounded time they are bounded, too. *)
From Coq Require Import Reals Lra Psatz Lia FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus PullBounds Picard Tame.
Open Scope R_scope.

Section Law.
Variables (F : fleet) (t0 C B : R).
Local Notation P := (region F t0 C B).
Local Notation ok := (vehicle F).
Local Notation tame := (tame F t0 C B).
Local Notation limited := (limited F t0 C B).
Hypothesis B_pos : 0 < B.
Hypothesis HA1 : A1 F.
Hypothesis HA2 : A2 F.
Hypothesis HA3 : A3 F.
Hypothesis start_nonneg : 0 <= t0.


(** ** The terms of the closed loop *)
(** A coupling of errors z that are tame. *)
Lemma tame_coupling scale (z : (place -> R) -> nat -> R) i : (i < N F)%nat ->
  (forall j, (j < N F)%nat -> tame (fun _ x => z x j)) -> tame (fun _ x => coupling F scale (z x) i).
Proof.
  intros Hi Z. unfold coupling. apply tame_plus.
  - apply tame_scal, tame_tanh, (tame_div (fun _ x => z x i)), Z; exact Hi.
  - apply (tame_sum (N F) (fun j _ x => a F i j * tanh ((z x i - z x j) / scale))). intros j Hj.
    apply tame_scal, tame_tanh, (tame_div (fun _ x => z x i - z x j)), tame_minus; apply Z; assumption.
Qed.

Lemma tame_error q (o l : nat -> R) j : (j < N F)%nat -> tame (fun _ x => x (q, j) - o j - l j).
Proof.
  intros Hj. apply (tame_minus (fun _ x => x (q, j) - o j)); [ apply tame_minus |]; try apply tame_const.
  apply tame_coordinate; exact Hj.
Qed.

Lemma tame_ex i : (i < N F)%nat -> tame (fun _ x => ex F (state_of x) i).
Proof.
  intros Hi. apply tame_coupling; [ exact Hi |]. intros j Hj. apply (tame_error X_part (offx F) (fun _ => leadx F)); exact Hj.
Qed.

Lemma tame_ey i : (i < N F)%nat -> tame (fun _ x => ey F (state_of x) i).
Proof.
  intros Hi. apply tame_coupling; [ exact Hi |]. intros j Hj. apply (tame_error Y_part (offy F) (fun _ => leady F)); exact Hj.
Qed.

Lemma tame_eth i : (i < N F)%nat -> tame (fun _ x => eth F (state_of x) i).
Proof.
  intros Hi. apply tame_coupling; [ exact Hi |]. intros j Hj.
  apply (tame_minus (fun _ x => x (Heading, j)) (fun _ _ => leadth F)); [ apply tame_coordinate; exact Hj | apply tame_const ].
Qed.

Lemma tame_heading i : (i < N F)%nat -> tame (fun _ x => x (Heading, i)).
Proof. intros Hi. apply tame_coordinate; exact Hi. Qed.

Lemma limited_cos (g : R -> (place -> R) -> R) : limited (fun t x => cos (g t x)).
Proof. apply (limited_by 1). intros t x _ _. apply Rabs_le. apply COS_bound. Qed.

Lemma limited_sin (g : R -> (place -> R) -> R) : limited (fun t x => sin (g t x)).
Proof. apply (limited_by 1). intros t x _ _. apply Rabs_le. apply SIN_bound. Qed.

Lemma limited_coupling scale (z : (place -> R) -> nat -> R) i : (i < N F)%nat -> limited (fun _ x => coupling F scale (z x) i).
Proof. intros Hi. apply (limited_by (deg F i)). intros t x _ _. apply coupling_bound; assumption. Qed.

Lemma tame_along i : (i < N F)%nat -> tame (fun _ x => along F (state_of x) i).
Proof.
  intros Hi. apply (tame_plus (fun _ x => cos (x (Heading, i)) * ex F (state_of x) i) (fun _ x => sin (x (Heading, i)) * ey F (state_of x) i)).
  - apply tame_mult; [ apply tame_cos, tame_heading | apply tame_ex | apply limited_cos | apply limited_coupling ]; exact Hi.
  - apply tame_mult; [ apply tame_sin, tame_heading | apply tame_ey | apply limited_sin | apply limited_coupling ]; exact Hi.
Qed.

Lemma tame_across i : (i < N F)%nat -> tame (fun _ x => across F (state_of x) i).
Proof.
  intros Hi. apply (tame_plus (fun _ x => - sin (x (Heading, i)) * ex F (state_of x) i) (fun _ x => cos (x (Heading, i)) * ey F (state_of x) i)).
  - apply tame_mult; [ | apply tame_ex; exact Hi | | apply limited_coupling; exact Hi ].
    + replace (fun (_ : R) (x : place -> R) => - sin (x (Heading, i))) with (fun (_ : R) (x : place -> R) => -1 * sin (x (Heading, i))).
      * apply tame_scal, tame_sin, tame_heading; exact Hi.
      * do 2 (apply functional_extensionality; intro). ring.
    + apply (limited_by 1). intros t x _ _. rewrite Rabs_Ropp. apply Rabs_le. apply SIN_bound.
  - apply tame_mult; [ apply tame_cos, tame_heading | apply tame_ey | apply limited_cos | apply limited_coupling ]; exact Hi.
Qed.

Lemma tame_psi i : (i < N F)%nat -> tame (fun t _ => psi F i t) /\ limited (fun t _ => psi F i t).
Proof.
  intros Hi. split.
  - split.
    + intros S _. exists 0. split; [ lra |]. intros t x y e _ _ _ _ _. rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. lra.
    + intros Y _ _ t. apply (continuous_comp (fun s => Rmax t0 s) (psi F i) t); [ apply clamp_continuous |].
      apply (derive_continuous _ _ (dpsi F i (Rmax t0 t))). apply (proj2 (proj2 HA3) i Hi). pose proof (Rmax_l t0 t). lra.
  - apply (limited_by (psi0 F)). intros t x Ht _. apply (proj2 (proj2 HA3) i Hi). lra.
Qed.

Lemma tame_u_v i : (i < N F)%nat -> tame (fun _ x => u_v F (state_of x) i).
Proof.
  intros Hi. apply (tame_minus (fun _ x => - pv F i * along F (state_of x) i) (fun _ x => dv F i * tanh (x (Speed, i) / ss F i))).
  - apply tame_scal, tame_along; exact Hi.
  - apply tame_scal, tame_tanh, (tame_div (fun _ x => x (Speed, i))), tame_coordinate; exact Hi.
Qed.

Lemma tame_u_w i : (i < N F)%nat -> tame (fun t x => u_w F t (state_of x) i).
Proof.
  intros Hi.
  apply (tame_plus (fun _ x => - pw F i * eth F (state_of x) i - dw F i * tanh (x (Turning, i) / ws F i)) (fun t x => k F i * psi F i t * across F (state_of x) i)).
  - apply (tame_minus (fun _ x => - pw F i * eth F (state_of x) i) (fun _ x => dw F i * tanh (x (Turning, i) / ws F i))).
    + apply tame_scal, tame_eth; exact Hi.
    + apply tame_scal, tame_tanh, (tame_div (fun _ x => x (Turning, i))), tame_coordinate; exact Hi.
  - destruct (tame_psi i Hi) as [Tp Lp].
    apply (tame_mult (fun t _ => k F i * psi F i t) (fun _ x => across F (state_of x) i)).
    + apply tame_scal; exact Tp.
    + apply tame_across; exact Hi.
    + apply (limited_mult (fun _ _ => k F i) (fun t _ => psi F i t)); [ apply (limited_by (Rabs (k F i))); intros; lra | exact Lp ].
    + apply (limited_by (sqrt 2 * deg F i)). intros t x _ _. apply across_bound; assumption.
Qed.

Lemma law_tame c : ok c -> tame (fun t x => law F t x c).
Proof.
  destruct c as [q i]. unfold vehicle. simpl. intros Hi. destruct q; unfold law; simpl.
  - apply tame_mult; [ apply tame_cos, tame_heading; exact Hi | apply tame_coordinate; exact Hi | apply limited_cos | apply limited_in_region; auto ].
  - apply tame_mult; [ apply tame_sin, tame_heading; exact Hi | apply tame_coordinate; exact Hi | apply limited_sin | apply limited_in_region; auto ].
  - apply tame_coordinate; exact Hi.
  - apply (tame_div (fun _ x => u_v F (state_of x) i)), tame_u_v; exact Hi.
  - apply (tame_div (fun t x => u_w F t (state_of x) i)), tame_u_w; exact Hi.
Qed.

Lemma law_limited c : (forall t s i, 0 <= t -> (i < N F)%nat -> Rabs (u_v F s i / m F i) <= B /\ Rabs (u_w F t s i / J F i) <= B) ->
  ok c -> limited (fun t x => law F t x c).
Proof.
  intros HB. destruct c as [q i]. unfold vehicle. simpl. intros Hi. destruct q; unfold law; simpl.
  - apply limited_mult; [ apply limited_cos | apply limited_in_region; auto ].
  - apply limited_mult; [ apply limited_sin | apply limited_in_region; auto ].
  - apply limited_in_region; auto.
  - apply (limited_by B). intros t x Ht _. apply (HB t); [ lra | exact Hi ].
  - apply (limited_by B). intros t x Ht _. apply HB; [ lra | exact Hi ].
Qed.

(** ** One bound for all coordinates *)
Lemma common_bound (Q : place -> R -> Prop) : (forall c x y, ok c -> x <= y -> Q c x -> Q c y) -> (forall c, ok c -> exists x, Q c x) ->
  exists x, 0 < x /\ forall c, ok c -> Q c x.
Proof.
  intros Hm He.
  assert (G : forall q, exists x, 0 < x /\ forall i, (i < N F)%nat -> Q (q, i) x).
  { intros q. apply finite_common_large.
    - intros i x y Hi. apply Hm; exact Hi.
    - intros i Hi. apply He; exact Hi. }
  destruct (G X_part) as [x1 [P1 Q1]]. destruct (G Y_part) as [x2 [P2 Q2]]. destruct (G Heading) as [x3 [P3 Q3]].
  destruct (G Speed) as [x4 [P4 Q4]]. destruct (G Turning) as [x5 [P5 Q5]].
  exists (x1 + x2 + x3 + x4 + x5). split; [ lra |]. intros [q i] Hi. destruct q.
  - apply (Hm _ x1); [ exact Hi | lra | apply Q1; exact Hi ].
  - apply (Hm _ x2); [ exact Hi | lra | apply Q2; exact Hi ].
  - apply (Hm _ x3); [ exact Hi | lra | apply Q3; exact Hi ].
  - apply (Hm _ x4); [ exact Hi | lra | apply Q4; exact Hi ].
  - apply (Hm _ x5); [ exact Hi | lra | apply Q5; exact Hi ].
Qed.

Lemma law_lipschitz S : 0 <= S -> exists L, lipschitz_until _ ok (law F) t0 P S L.
Proof.
  intros HS.
  destruct (common_bound (fun c L => 0 <= L /\ forall t x y e, t0 <= t <= t0 + S -> P t x -> P t y -> 0 <= e ->
     (forall c, ok c -> Rabs (x c - y c) <= e) -> Rabs (law F t x c - law F t y c) <= L * e)) as [L [HL G]].
  - intros c p q _ Hpq [Hp H]. split; [ lra |]. intros t x y e Ht Hx Hy He Hd.
    eapply Rle_trans; [ apply (H t x y e); assumption |]. apply Rmult_le_compat_r; assumption.
  - intros c Hc. apply (proj1 (law_tame c Hc) S HS).
  - exists L. split; [ exact HL |]. intros t x y e Ht Hx Hy Hd c Hc. apply (G c Hc); try assumption.
    eapply Rle_trans; [ apply Rabs_pos | apply (Hd c Hc) ].
Qed.

Lemma law_bounded : (forall t s i, 0 <= t -> (i < N F)%nat -> Rabs (u_v F s i / m F i) <= B /\ Rabs (u_w F t s i / J F i) <= B) ->
  forall S, 0 <= S -> exists M, 0 <= M /\ forall t x, t0 <= t <= t0 + S -> P t x -> forall c, ok c -> Rabs (law F t x c) <= M.
Proof.
  intros HB S HS.
  destruct (common_bound (fun c M => forall t x, t0 <= t <= t0 + S -> P t x -> Rabs (law F t x c) <= M)) as [M [HM G]].
  - intros c p q _ Hpq H t x Ht Hx. eapply Rle_trans; [ apply H; assumption | exact Hpq ].
  - intros c Hc. destruct (law_limited c HB Hc S HS) as [M [_ H]]. exists M. exact H.
  - exists M. split; [ lra |]. intros t x Ht Hx c Hc. apply (G c Hc); assumption.
Qed.

Lemma driven_in_region Y Z : (forall t s i, 0 <= t -> (i < N F)%nat -> Rabs (u_v F s i / m F i) <= B /\ Rabs (u_w F t s i / J F i) <= B) ->
  (forall i, (i < N F)%nat -> Rabs (Z t0 (Speed, i)) <= C /\ Rabs (Z t0 (Turning, i)) <= C) ->
  driven _ ok (law F) t0 Y Z -> inside _ t0 P Z.
Proof.
  intros HB Hs HZ t Ht i Hi. destruct (Hs i Hi) as [S1 S2].
  assert (I1 : Rabs (Z t (Speed, i) - Z t0 (Speed, i)) <= B * (t - t0)).
  { apply (increment_abs (fun s => Z s (Speed, i)) t0 t B Ht). intros x Hx. eexists. split.
    - apply (HZ (Speed, i)); [ exact Hi | lra ].
    - apply (HB x); [ lra | exact Hi ]. }
  assert (I2 : Rabs (Z t (Turning, i) - Z t0 (Turning, i)) <= B * (t - t0)).
  { apply (increment_abs (fun s => Z s (Turning, i)) t0 t B Ht). intros x Hx. eexists. split.
    - apply (HZ (Turning, i)); [ exact Hi | lra ].
    - apply HB; [ lra | exact Hi ]. }
  pose proof (Rabs_triang_inv (Z t (Speed, i)) (Z t0 (Speed, i))). pose proof (Rabs_triang_inv (Z t (Turning, i)) (Z t0 (Turning, i))).
  split; lra.
Qed.
End Law.

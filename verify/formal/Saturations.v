(** * Saturations.v : tanh and its primitive ln cosh.
    tanh is a smooth, odd, increasing saturation with values in (-1, 1) and slope 1 - tanh^2 <= 1.
    ln cosh is its primitive: even, positive away from 0, and like |x| far out (between |x| - ln 2 and |x|).
    They carry every bound (L1) and both energies (L3, L4). *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

Definition lncosh (x : R) : R := ln (cosh x).

(** ** cosh and sinh *)
Lemma cosh_pos : forall x, 0 < cosh x.
Proof. intros x. unfold cosh. assert (A := exp_pos x). assert (B := exp_pos (- x)). lra. Qed.

Lemma cosh_square : forall x, cosh x * cosh x - sinh x * sinh x = 1.
Proof.
  intros x. unfold cosh, sinh.
  replace ((exp x + exp (- x)) / 2 * ((exp x + exp (- x)) / 2)
           - (exp x - exp (- x)) / 2 * ((exp x - exp (- x)) / 2)) with (exp x * exp (- x)) by field.
  rewrite <- exp_plus. replace (x + - x) with 0 by ring. apply exp_0.
Qed.

Lemma cosh_ge_1 : forall x, 1 <= cosh x.
Proof.
  intros x. assert (A := cosh_square x). assert (B := cosh_pos x). assert (C := Rle_0_sqr (sinh x)). unfold Rsqr in C.
  nra.
Qed.

Lemma cosh_even : forall x, cosh (- x) = cosh x.
Proof. intros x. unfold cosh. rewrite Ropp_involutive. field. Qed.

Lemma sinh_odd : forall x, sinh (- x) = - sinh x.
Proof. intros x. unfold sinh. rewrite Ropp_involutive. field. Qed.

(** ** tanh *)
Lemma tanh_0 : tanh 0 = 0.
Proof. unfold tanh. rewrite sinh_0. field. apply Rgt_not_eq, cosh_pos. Qed.

Lemma tanh_odd : forall x, tanh (- x) = - tanh x.
Proof. intros x. unfold tanh. rewrite sinh_odd, cosh_even. field. apply Rgt_not_eq, cosh_pos. Qed.

Lemma tanh_derive : forall x, is_derive tanh x (1 - tanh x ^ 2).
Proof.
  intros x. assert (C := Rgt_not_eq _ _ (cosh_pos x)).
  apply is_derive_Reals. unfold tanh.
  replace (1 - (sinh x / cosh x) ^ 2) with ((cosh x * cosh x - sinh x * sinh x) / (Rsqr (cosh x)))
    by (unfold Rsqr; field; exact C).
  apply (derivable_pt_lim_div sinh cosh x (cosh x) (sinh x)).
  - apply derivable_pt_lim_sinh.
  - apply derivable_pt_lim_cosh.
  - exact C.
Qed.

Lemma tanh_square_lt_1 : forall x, tanh x ^ 2 < 1.
Proof.
  intros x. assert (C := cosh_pos x). assert (E := cosh_square x).
  replace (tanh x ^ 2) with (1 - / (cosh x * cosh x)).
  - assert (P : 0 < / (cosh x * cosh x)) by (apply Rinv_0_lt_compat; nra). lra.
  - unfold tanh. replace ((sinh x / cosh x) ^ 2) with (sinh x * sinh x / (cosh x * cosh x)) by (field; lra).
    replace (sinh x * sinh x) with (cosh x * cosh x - 1) by lra. field. lra.
Qed.

Lemma tanh_lt_1 : forall x, tanh x < 1.
Proof. intros x. assert (A := tanh_square_lt_1 x). nra. Qed.

Lemma tanh_gt_m1 : forall x, -1 < tanh x.
Proof. intros x. assert (A := tanh_square_lt_1 x). nra. Qed.

Lemma tanh_abs_lt_1 : forall x, Rabs (tanh x) < 1.
Proof. intros x. apply Rabs_def1; [apply tanh_lt_1|]. assert (A := tanh_gt_m1 x). lra. Qed.

Lemma tanh_slope_pos : forall x, 0 < 1 - tanh x ^ 2.
Proof. intros x. assert (A := tanh_square_lt_1 x). lra. Qed.

Lemma tanh_slope_le_1 : forall x, 1 - tanh x ^ 2 <= 1.
Proof. intros x. assert (A := pow2_ge_0 (tanh x)). lra. Qed.

Lemma tanh_continuity_pt : forall x, continuity_pt tanh x.
Proof.
  intros x. apply derivable_continuous_pt. exists (1 - tanh x ^ 2).
  apply is_derive_Reals, tanh_derive.
Qed.

Lemma tanh_increment : forall x y, exists c, Rmin x y <= c <= Rmax x y /\
  tanh y - tanh x = (1 - tanh c ^ 2) * (y - x).
Proof.
  intros x y. apply (MVT_gen tanh x y (fun c => 1 - tanh c ^ 2)).
  - intros c _. apply tanh_derive.
  - intros c _. apply tanh_continuity_pt.
Qed.

Lemma tanh_lt : forall x y, x < y -> tanh x < tanh y.
Proof.
  intros x y H. destruct (tanh_increment x y) as [c [_ E]]. assert (P := tanh_slope_pos c). nra.
Qed.

Lemma tanh_le : forall x y, x <= y -> tanh x <= tanh y.
Proof. intros x y [H| ->]; [apply Rlt_le, tanh_lt; exact H|apply Rle_refl]. Qed.

Lemma tanh_pos : forall x, 0 < x -> 0 < tanh x.
Proof. intros x H. rewrite <- tanh_0. apply tanh_lt; exact H. Qed.

Lemma tanh_nonneg : forall x, 0 <= x -> 0 <= tanh x.
Proof. intros x H. rewrite <- tanh_0. apply tanh_le; exact H. Qed.

Lemma tanh_lt_inv : forall x y, tanh x < tanh y -> x < y.
Proof. intros x y H. destruct (Rlt_le_dec x y) as [L|L]; [exact L|]. apply tanh_le in L; lra. Qed.

Lemma tanh_lipschitz : forall x y, Rabs (tanh y - tanh x) <= Rabs (y - x).
Proof.
  intros x y. destruct (tanh_increment x y) as [c [_ E]]. rewrite E, Rabs_mult.
  assert (P := tanh_slope_pos c). assert (Q := tanh_slope_le_1 c). rewrite (Rabs_pos_eq (1 - tanh c ^ 2)) by lra.
  assert (A := Rabs_pos (y - x)). nra.
Qed.

Lemma tanh_abs_le : forall x, Rabs (tanh x) <= Rabs x.
Proof. intros x. assert (A := tanh_lipschitz 0 x). rewrite tanh_0, !Rminus_0_r in A. exact A. Qed.

Lemma x_tanh_abs : forall x, x * tanh x = Rabs x * tanh (Rabs x).
Proof.
  intros x. destruct (Rle_lt_dec 0 x) as [H|H].
  - rewrite (Rabs_pos_eq x H). reflexivity.
  - rewrite (Rabs_left x H), tanh_odd. ring.
Qed.

Lemma abs_div_pos : forall x s, 0 < s -> Rabs (x / s) = Rabs x / s.
Proof.
  intros x s Hs. unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ s)); [reflexivity|].
  apply Rlt_le, Rinv_0_lt_compat; exact Hs.
Qed.

(** The dissipated power x tanh(x/s), as a function of |x|. *)
Lemma x_tanh_scaled_abs : forall x s, 0 < s -> x * tanh (x / s) = Rabs x * tanh (Rabs x / s).
Proof.
  intros x s Hs. destruct (Rle_lt_dec 0 x) as [H|H].
  - rewrite (Rabs_pos_eq x H). reflexivity.
  - rewrite (Rabs_left x H). replace (- x / s) with (- (x / s)) by (field; lra). rewrite tanh_odd. ring.
Qed.

Lemma div_nonneg : forall x s, 0 <= x -> 0 < s -> 0 <= x / s.
Proof. intros x s Hx Hs. unfold Rdiv. apply Rmult_le_pos; [exact Hx|apply Rlt_le, Rinv_0_lt_compat; exact Hs]. Qed.

Lemma div_pos : forall x s, 0 < x -> 0 < s -> 0 < x / s.
Proof. intros x s Hx Hs. unfold Rdiv. apply Rmult_lt_0_compat; [exact Hx|apply Rinv_0_lt_compat; exact Hs]. Qed.

Lemma div_le : forall x y s, x <= y -> 0 < s -> x / s <= y / s.
Proof. intros x y s H Hs. unfold Rdiv. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat; exact Hs|exact H]. Qed.

Lemma x_tanh_scaled_nonneg : forall x s, 0 < s -> 0 <= x * tanh (x / s).
Proof.
  intros x s Hs. rewrite (x_tanh_scaled_abs x s Hs).
  apply Rmult_le_pos; [apply Rabs_pos|apply tanh_nonneg, div_nonneg; [apply Rabs_pos|exact Hs]].
Qed.

(** Above a level h of |x| the dissipated power is at least that of the level, and at least |x| tanh(h/s). *)
Lemma x_tanh_scaled_ge : forall x s h, 0 < s -> 0 <= h -> h <= Rabs x ->
  Rabs x * tanh (h / s) <= x * tanh (x / s) /\ h * tanh (h / s) <= x * tanh (x / s).
Proof.
  intros x s h Hs Hh Hx. rewrite (x_tanh_scaled_abs x s Hs).
  assert (A := tanh_le (h / s) (Rabs x / s) (div_le _ _ _ Hx Hs)).
  assert (B := tanh_nonneg (h / s) (div_nonneg _ _ Hh Hs)).
  split; nra.
Qed.

(** Every value in (-1, 1) is attained: the inverse of tanh. *)
Lemma tanh_onto : forall y, -1 < y < 1 -> tanh (ln ((1 + y) / (1 - y)) / 2) = y.
Proof.
  intros y [H1 H2]. set (q := (1 + y) / (1 - y)).
  assert (Q : 0 < q) by (apply div_pos; lra).
  set (x := ln q / 2).
  assert (E : exp x * exp x = q).
  { rewrite <- exp_plus. replace (x + x) with (ln q) by (unfold x; field). apply exp_ln; exact Q. }
  assert (P := exp_pos x).
  unfold tanh, sinh, cosh. rewrite exp_Ropp.
  replace ((exp x - / exp x) / 2 / ((exp x + / exp x) / 2)) with ((exp x * exp x - 1) / (exp x * exp x + 1)).
  - rewrite E. unfold q. field. split; [lra|]. replace (1 + y + (1 - y)) with 2 by ring. lra.
  - assert (S : 0 < exp x * exp x) by (apply Rmult_lt_0_compat; exact P). field. repeat split; nra.
Qed.

Lemma tanh_tends_to_1 : forall c, c < 1 -> exists x, 0 < x /\ forall y, x <= y -> c < tanh y.
Proof.
  intros c Hc. set (d := (Rmax c 0 + 1) / 2).
  assert (D : c < d < 1 /\ 0 < d).
  { unfold d. unfold Rmax. destruct (Rle_dec c 0); lra. }
  assert (E := tanh_onto d ltac:(lra)). set (x := ln ((1 + d) / (1 - d)) / 2) in E.
  exists x; split.
  - apply tanh_lt_inv. rewrite tanh_0; lra.
  - intros y Hy. apply tanh_le in Hy; lra.
Qed.

(** ** ln cosh *)
Lemma lncosh_0 : lncosh 0 = 0.
Proof. unfold lncosh. rewrite cosh_0. apply ln_1. Qed.

Lemma lncosh_even : forall x, lncosh (- x) = lncosh x.
Proof. intros x. unfold lncosh. rewrite cosh_even. reflexivity. Qed.

Lemma lncosh_abs : forall x, lncosh (Rabs x) = lncosh x.
Proof. intros x. unfold Rabs. destruct (Rcase_abs x); [apply lncosh_even|reflexivity]. Qed.

Lemma lncosh_derive : forall x, is_derive lncosh x (tanh x).
Proof.
  intros x. apply is_derive_Reals. unfold lncosh, tanh.
  replace (sinh x / cosh x) with (/ cosh x * sinh x) by (unfold Rdiv; ring).
  apply (derivable_pt_lim_comp cosh ln x (sinh x) (/ cosh x)).
  - apply derivable_pt_lim_cosh.
  - apply derivable_pt_lim_ln, cosh_pos.
Qed.

Lemma lncosh_continuity_pt : forall x, continuity_pt lncosh x.
Proof.
  intros x. apply derivable_continuous_pt. exists (tanh x).
  apply is_derive_Reals, lncosh_derive.
Qed.

Lemma lncosh_increment : forall x y, exists c, Rmin x y <= c <= Rmax x y /\
  lncosh y - lncosh x = tanh c * (y - x).
Proof.
  intros x y. apply (MVT_gen lncosh x y tanh).
  - intros c _. apply lncosh_derive.
  - intros c _. apply lncosh_continuity_pt.
Qed.

Lemma lncosh_nonneg : forall x, 0 <= lncosh x.
Proof.
  intros x. unfold lncosh. rewrite <- ln_1. destruct (cosh_ge_1 x) as [H| <-]; [|lra].
  apply Rlt_le, ln_increasing; [lra|exact H].
Qed.

Lemma lncosh_le_abs : forall x, lncosh x <= Rabs x.
Proof.
  intros x. rewrite <- (lncosh_abs x). assert (A := Rabs_pos x).
  destruct (lncosh_increment 0 (Rabs x)) as [c [_ E]]. rewrite lncosh_0 in E.
  assert (P := tanh_lt_1 c). nra.
Qed.

Lemma lncosh_ge : forall x, Rabs x - ln 2 <= lncosh x.
Proof.
  intros x. rewrite <- (lncosh_abs x). unfold lncosh.
  rewrite <- (ln_exp (Rabs x)) at 1. assert (P := exp_pos (Rabs x)).
  rewrite <- ln_div by lra.
  assert (Q := exp_pos (- Rabs x)).
  apply Rlt_le, ln_increasing; [lra|]. unfold cosh. lra.
Qed.

Lemma lncosh_pos : forall x, x <> 0 -> 0 < lncosh x.
Proof.
  intros x H. unfold lncosh. rewrite <- ln_1. apply ln_increasing; [lra|].
  assert (A := cosh_square x). assert (B := cosh_ge_1 x).
  assert (S : sinh x <> 0).
  { intros E. destruct (Rtotal_order x 0) as [L|[L|L]]; [|contradiction|];
    apply sinh_lt in L; rewrite sinh_0 in L; lra. }
  assert (C := Rsqr_pos_lt (sinh x) S). unfold Rsqr in C. nra.
Qed.

(** Convexity in one form: lncosh x <= x tanh x. *)
Lemma lncosh_le_x_tanh : forall x, lncosh x <= x * tanh x.
Proof.
  intros x. rewrite x_tanh_abs, <- (lncosh_abs x). assert (A := Rabs_pos x).
  destruct (lncosh_increment 0 (Rabs x)) as [c [[_ Hc] E]]. rewrite lncosh_0 in E.
  rewrite Rmax_right in Hc by exact A. apply tanh_le in Hc. nra.
Qed.

(** A small value of ln cosh forces a small argument. *)
Lemma lncosh_small : forall eps x, 0 < eps -> lncosh x <= lncosh eps -> Rabs x <= eps.
Proof.
  intros eps x He H. destruct (Rle_lt_dec (Rabs x) eps) as [L|L]; [exact L|exfalso].
  rewrite <- (lncosh_abs x) in H.
  destruct (lncosh_increment eps (Rabs x)) as [c [[Hc _] E]].
  rewrite Rmin_left in Hc by lra. assert (P := tanh_pos c ltac:(lra)). nra.
Qed.

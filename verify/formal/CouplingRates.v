(** * CouplingRates.v : how fast the pulls of the network change (L1, second half, and q' of L4).
    A saturated position error has slope at most 1 / scale, so the network's pull changes no faster than the speeds.
    As a vehicle turns, the pull across its heading becomes one along it, at its turn rate. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus PullBounds EnergyDerivatives.
Open Scope R_scope.

(** Derivative of the coupling where the errors change at the rates dz. *)
Definition coupling_rate (F : fleet) (scale : R) (z dz : nat -> R) (i : nat) : R :=
  al F i * ((1 - tanh (z i / scale) ^ 2) * (dz i / scale))
  + sum (N F) (fun j => a F i j * ((1 - tanh ((z i - z j) / scale) ^ 2) * ((dz i - dz j) / scale))).

Definition ex_rate (F : fleet) (s : state) i := coupling_rate F (ls F) (zx F s) (fun j => cos (th s j) * v s j) i.
Definition ey_rate (F : fleet) (s : state) i := coupling_rate F (ls F) (zy F s) (fun j => sin (th s j) * v s j) i.

(** The network's part of the derivative of the pull along: phi^T e_z'. *)
Definition along_rate (F : fleet) (s : state) i := cos (th s i) * ex_rate F s i + sin (th s i) * ey_rate F s i.

(** Its bound: the weighted speeds of a vehicle and its neighbours, over the scale. *)
Definition speed_spread (F : fleet) (s : state) i :=
  (deg F i * Rabs (v s i) + sum (N F) (fun j => a F i j * Rabs (v s j))) / ls F.

(** ** Derivatives *)
Lemma coupling_derivative : forall F scale (Z : R -> nat -> R) t (dz : nat -> R) i, (i < N F)%nat ->
  (forall j, (j < N F)%nat -> is_derive (fun r => Z r j) t (dz j)) ->
  is_derive (fun r => coupling F scale (Z r) i) t (coupling_rate F scale (Z t) dz i).
Proof.
  intros F scale Z t dz i Hi D. unfold coupling, coupling_rate. apply derive_plus.
  - apply derive_scal, (derive_tanh (fun r => Z r i / scale)), derive_div, D; exact Hi.
  - apply (derive_sum (N F) (fun j r => a F i j * tanh ((Z r i - Z r j) / scale))). intros j Hj.
    apply derive_scal, (derive_tanh (fun r => (Z r i - Z r j) / scale)), derive_div, derive_minus; apply D; assumption.
Qed.

Lemma ex_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => ex F (X r) i) t (ex_rate F (X t) i).
Proof.
  intros F t0 X t i HX Ht Hi.
  apply (coupling_derivative F (ls F) (fun r => zx F (X r)) t (fun j => cos (th (X t) j) * v (X t) j)); [exact Hi|].
  intros j Hj. apply (zx_derivative F t0); assumption.
Qed.

Lemma ey_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => ey F (X r) i) t (ey_rate F (X t) i).
Proof.
  intros F t0 X t i HX Ht Hi.
  apply (coupling_derivative F (ls F) (fun r => zy F (X r)) t (fun j => sin (th (X t) j) * v (X t) j)); [exact Hi|].
  intros j Hj. apply (zy_derivative F t0); assumption.
Qed.

Lemma heading_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => th (X r) i) t (om (X t) i).
Proof. intros F t0 X t i HX Ht Hi. apply (HX i Hi t Ht). Qed.

(** q' = w b + phi^T e_z'. *)
Lemma along_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => along F (X r) i) t (om (X t) i * across F (X t) i + along_rate F (X t) i).
Proof.
  intros F t0 X t i HX Ht Hi. assert (Dth := heading_derivative F t0 X t i HX Ht Hi).
  unfold along.
  apply (derive_value _ t
    ((- sin (th (X t) i) * om (X t) i) * ex F (X t) i + cos (th (X t) i) * ex_rate F (X t) i
     + ((cos (th (X t) i) * om (X t) i) * ey F (X t) i + sin (th (X t) i) * ey_rate F (X t) i))).
  - apply derive_plus.
    + apply (derive_mult (fun r => cos (th (X r) i)) (fun r => ex F (X r) i)).
      * apply derive_cos; exact Dth.
      * apply (ex_derivative F t0); assumption.
    + apply (derive_mult (fun r => sin (th (X r) i)) (fun r => ey F (X r) i)).
      * apply derive_sin; exact Dth.
      * apply (ey_derivative F t0); assumption.
  - unfold across, along_rate. ring.
Qed.

(** ** Bounds *)
Lemma slope_in_unit : forall x, 0 <= 1 - tanh x ^ 2 <= 1.
Proof. intros x. assert (A := tanh_slope_pos x). assert (B := tanh_slope_le_1 x). lra. Qed.

(** Two unit vectors, one of them with its components scaled down: their product is at most 1. *)
Lemma damped_product_le_1 : forall p q c s g h, p ^ 2 + q ^ 2 = 1 -> c ^ 2 + s ^ 2 = 1 ->
  0 <= g <= 1 -> 0 <= h <= 1 -> Rabs (p * (g * c) + q * (h * s)) <= 1.
Proof.
  intros p q c s g h H1 H2 Hg Hh.
  assert (A : forall x y w, 0 <= w <= 1 -> Rabs (x * (w * y)) <= (x ^ 2 + y ^ 2) / 2).
  { intros x y w Hw. replace (x * (w * y)) with (w * (x * y)) by ring. rewrite Rabs_mult, (Rabs_pos_eq w) by lra.
    assert (B : Rabs (x * y) <= (x ^ 2 + y ^ 2) / 2).
    { apply Rabs_le. assert (P := pow2_ge_0 (x - y)). assert (Q := pow2_ge_0 (x + y)). split; nra. }
    assert (P := Rabs_pos (x * y)). nra. }
  eapply Rle_trans; [apply Rabs_triang|].
  assert (B := A p c g Hg). assert (C := A q s h Hh). lra.
Qed.

(** In every direction (p, q) the network's pull changes at most at the weighted speeds over the scale. *)
Lemma pull_rate_bound : forall F s i p q, A1 F -> 0 < ls F -> (i < N F)%nat -> p ^ 2 + q ^ 2 = 1 ->
  Rabs (p * ex_rate F s i + q * ey_rate F s i) <= speed_spread F s i.
Proof.
  intros F s i p q [Ha [Hal _]] Hls Hi Hpq.
  set (l := ls F) in *.
  set (G := fun r => 1 - tanh (r / l) ^ 2).
  assert (HG : forall r, 0 <= G r <= 1) by (intros r; apply slope_in_unit).
  set (U := fun g h j => p * (g * cos (th s j)) + q * (h * sin (th s j))).
  assert (HU : forall r r' j, Rabs (U (G r) (G r') j * v s j) <= Rabs (v s j)).
  { intros r r' j. rewrite Rabs_mult.
    assert (B := damped_product_le_1 p q _ _ (G r) (G r') Hpq (unit_circle (th s j)) (HG r) (HG r')).
    fold (U (G r) (G r') j) in B. assert (P := Rabs_pos (v s j)). nra. }
  assert (E : p * ex_rate F s i + q * ey_rate F s i =
    (al F i * (U (G (zx F s i)) (G (zy F s i)) i * v s i)
     + sum (N F) (fun j => a F i j *
         (U (G (zx F s i - zx F s j)) (G (zy F s i - zy F s j)) i * v s i
          - U (G (zx F s i - zx F s j)) (G (zy F s i - zy F s j)) j * v s j))) / l).
  { unfold ex_rate, ey_rate, coupling_rate. fold l.
    rewrite !Rmult_plus_distr_l, <- !sum_scal_l. unfold Rdiv at 9. rewrite Rmult_plus_distr_r, <- sum_scal_r.
    match goal with |- ?x + sum _ ?f + (?y + sum _ ?g) = ?z + sum _ ?h =>
      replace (x + sum (N F) f + (y + sum (N F) g)) with ((x + y) + sum (N F) (fun j => f j + g j))
        by (rewrite sum_plus; ring) end.
    f_equal.
    - unfold U, G, Rdiv. ring.
    - apply sum_ext; intros j Hj. unfold U, G, Rdiv. ring. }
  rewrite E, abs_div_pos by exact Hls. unfold speed_spread. fold l. apply div_le; [|exact Hls].
  eapply Rle_trans; [apply Rabs_triang|].
  unfold deg. rewrite Rmult_plus_distr_r, <- sum_scal_r, Rplus_assoc, <- sum_plus.
  apply Rplus_le_compat.
  - rewrite Rabs_mult, (Rabs_pos_eq (al F i)) by (apply Hal; exact Hi).
    apply Rmult_le_compat_l; [apply Hal; exact Hi|apply HU].
  - apply sum_abs_le. intros j Hj. destruct (Ha i j Hi Hj) as [_ Haij].
    rewrite Rabs_mult, (Rabs_pos_eq (a F i j)), <- Rmult_plus_distr_l by exact Haij.
    apply Rmult_le_compat_l; [exact Haij|].
    eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_Ropp. apply Rplus_le_compat; apply HU.
Qed.

Lemma along_rate_bound : forall F s i, A1 F -> 0 < ls F -> (i < N F)%nat ->
  Rabs (along_rate F s i) <= speed_spread F s i.
Proof. intros F s i H1 Hls Hi. apply pull_rate_bound; [exact H1|exact Hls|exact Hi|apply unit_circle]. Qed.

(** Where all speeds are at most eta, the pulls change at most at 2 D eta over the scale. *)
Lemma speed_spread_le : forall F s i eta, A1 F -> 0 < ls F -> (i < N F)%nat ->
  (forall j, (j < N F)%nat -> Rabs (v s j) <= eta) -> speed_spread F s i <= 2 * deg F i * eta / ls F.
Proof.
  intros F s i eta [Ha [Hal _]] Hls Hi H. unfold speed_spread. apply div_le; [|exact Hls].
  assert (P : 0 <= sum (N F) (fun j => a F i j)) by (apply sum_nonneg; intros j Hj; apply (Ha i j Hi Hj)).
  assert (Q := Hal i Hi). assert (Hvi := H i Hi). assert (P' := Rabs_pos (v s i)).
  assert (S : sum (N F) (fun j => a F i j * Rabs (v s j)) <= sum (N F) (fun j => a F i j) * eta).
  { rewrite <- sum_scal_r. apply sum_le; intros j Hj.
    apply Rmult_le_compat_l; [apply (Ha i j Hi Hj)|apply H; exact Hj]. }
  unfold deg. nra.
Qed.

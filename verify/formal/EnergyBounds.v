(** * EnergyBounds.v : energies and powers are nonnegative; small errors mean small energies (first half of L8).
    Every term of V, W, Pv, Pw is a square, a ln cosh or x tanh x with a positive factor.
    ln cosh x is at most |x|, so V and W are small where all errors are small and bounded where they are bounded. *)
From Coq Require Import Reals Lra.
From Gaincert Require Import Statement Definitions Sums Saturations PullBounds EnergyDerivatives.
Open Scope R_scope.

(** ** Energies and powers are nonnegative *)
Lemma kinetic_nonneg : forall c x, 0 < c -> 0 <= c * x ^ 2 / 2.
Proof. intros c x Hc. assert (A := pow2_ge_0 x). nra. Qed.

Lemma leader_term_nonneg : forall F scale z i, A1 F -> 0 < scale -> (i < N F)%nat ->
  0 <= al F i * scale * ln (cosh (z i / scale)).
Proof.
  intros F scale z i [_ [Hal _]] Hs Hi. assert (A := Hal i Hi). assert (B := lncosh_nonneg (z i / scale)).
  unfold lncosh in B. apply Rmult_le_pos; [apply Rmult_le_pos; lra|exact B].
Qed.

Lemma edge_term_nonneg : forall F scale z i j, A1 F -> 0 < scale -> (i < N F)%nat -> (j < N F)%nat ->
  0 <= a F i j * scale * ln (cosh ((z i - z j) / scale)).
Proof.
  intros F scale z i j [Ha _] Hs Hi Hj. destruct (Ha i j Hi Hj) as [_ A].
  assert (B := lncosh_nonneg ((z i - z j) / scale)).
  unfold lncosh in B. apply Rmult_le_pos; [apply Rmult_le_pos; lra|exact B].
Qed.

Lemma potential_nonneg : forall F scale z, A1 F -> 0 < scale -> 0 <= potential F scale z.
Proof.
  intros F scale z H1 Hs. unfold potential.
  assert (A : 0 <= sum (N F) (fun i => al F i * scale * ln (cosh (z i / scale)))).
  { apply sum_nonneg; intros i Hi. apply leader_term_nonneg; assumption. }
  assert (B : 0 <= sum (N F) (fun i => sum (N F) (fun j => a F i j * scale * ln (cosh ((z i - z j) / scale))))).
  { apply sum_nonneg; intros i Hi. apply sum_nonneg; intros j Hj. apply edge_term_nonneg; assumption. }
  lra.
Qed.

Lemma kinetic_sum_nonneg : forall n (M p x : nat -> R), (forall i, (i < n)%nat -> 0 < M i /\ 0 < p i) ->
  0 <= sum n (fun i => M i / p i * (x i) ^ 2 / 2).
Proof.
  intros n M p x H. apply sum_nonneg; intros i Hi. destruct (H i Hi) as [HM Hp].
  apply kinetic_nonneg, div_pos; assumption.
Qed.

Lemma travel_gains : forall F, A2 F -> forall i, (i < N F)%nat -> 0 < m F i /\ 0 < pv F i.
Proof. intros F [_ [_ H]] i Hi. destruct (H i Hi) as (Hm & _ & _ & _ & Hpv & _). split; assumption. Qed.

Lemma turn_gains : forall F, A2 F -> forall i, (i < N F)%nat -> 0 < J F i /\ 0 < pw F i.
Proof. intros F [_ [_ H]] i Hi. destruct (H i Hi) as (_ & HJ & _ & _ & _ & _ & Hpw & _). split; assumption. Qed.

Lemma V_nonneg : forall F s, A1 F -> A2 F -> 0 <= V F s.
Proof.
  intros F s H1 H2. unfold V.
  assert (A := kinetic_sum_nonneg (N F) (m F) (pv F) (v s) (travel_gains F H2)).
  assert (B := potential_nonneg F (ls F) (zx F s) H1 (proj1 H2)).
  assert (C := potential_nonneg F (ls F) (zy F s) H1 (proj1 H2)). lra.
Qed.

Lemma W_nonneg : forall F s, A1 F -> A2 F -> 0 <= W F s.
Proof.
  intros F s H1 H2. unfold W.
  assert (A := kinetic_sum_nonneg (N F) (J F) (pw F) (om s) (turn_gains F H2)).
  assert (B := potential_nonneg F (rs F) (tha F s) H1 (proj1 (proj2 H2))). lra.
Qed.

Lemma Pv_nonneg : forall F s, A1 F -> A2 F -> 0 <= Pv F s.
Proof.
  intros F s _ [_ [_ H2]]. apply sum_nonneg; intros i Hi.
  destruct (H2 i Hi) as (_ & _ & _ & _ & Hpv & Hdv & _ & _ & _ & Hss & _).
  apply Rmult_le_pos; [apply Rlt_le, div_pos; assumption|apply x_tanh_scaled_nonneg; exact Hss].
Qed.

Lemma Pw_nonneg : forall F s, A1 F -> A2 F -> 0 <= Pw F s.
Proof.
  intros F s _ [_ [_ H2]]. apply sum_nonneg; intros i Hi.
  destruct (H2 i Hi) as (_ & _ & _ & _ & _ & _ & Hpw & Hdw & _ & _ & Hws).
  apply Rmult_le_pos; [apply Rlt_le, div_pos; assumption|apply x_tanh_scaled_nonneg; exact Hws].
Qed.

(** ** Small errors mean small energies *)
Lemma scaled_lncosh_le_abs : forall scale x, 0 < scale -> scale * ln (cosh (x / scale)) <= Rabs x.
Proof.
  intros scale x Hs. assert (A := lncosh_le_abs (x / scale)). unfold lncosh in A. rewrite abs_div_pos in A by exact Hs.
  replace (Rabs x) with (scale * (Rabs x / scale)) by (field; lra).
  apply Rmult_le_compat_l; lra.
Qed.

Lemma potential_le : forall F scale z r, A1 F -> 0 < scale -> (forall i, (i < N F)%nat -> Rabs (z i) <= r) ->
  potential F scale z <= r * sum (N F) (deg F).
Proof.
  intros F scale z r [Ha [Hal _]] Hs Hz. unfold potential, deg.
  rewrite sum_plus.
  assert (A : sum (N F) (fun i => al F i * scale * ln (cosh (z i / scale))) <= r * sum (N F) (al F)).
  { rewrite <- sum_scal_l. apply sum_le; intros i Hi. rewrite Rmult_assoc, (Rmult_comm r).
    apply Rmult_le_compat_l; [apply Hal; exact Hi|].
    eapply Rle_trans; [apply scaled_lncosh_le_abs; exact Hs|apply Hz; exact Hi]. }
  assert (B : sum (N F) (fun i => sum (N F) (fun j => a F i j * scale * ln (cosh ((z i - z j) / scale))))
              <= 2 * r * sum (N F) (fun i => sum (N F) (fun j => a F i j))).
  { rewrite <- sum_scal_l. apply sum_le; intros i Hi. rewrite <- sum_scal_l. apply sum_le; intros j Hj.
    rewrite Rmult_assoc, (Rmult_comm (2 * r)).
    apply Rmult_le_compat_l; [apply (Ha i j Hi Hj)|].
    eapply Rle_trans; [apply scaled_lncosh_le_abs; exact Hs|].
    eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_Ropp.
    assert (C := Hz i Hi). assert (D := Hz j Hj). lra. }
  change (fun i => al F i) with (al F). lra.
Qed.

Lemma err_terms : forall F s r i, err F s <= r -> (i < N F)%nat ->
  Rabs (zx F s i) <= r /\ Rabs (zy F s i) <= r /\ Rabs (tha F s i) <= r /\ Rabs (v s i) <= r /\ Rabs (om s i) <= r.
Proof.
  intros F s r i H Hi. unfold err in H.
  assert (T := fun j => conj (Rabs_pos (zx F s j)) (conj (Rabs_pos (zy F s j)) (conj (Rabs_pos (tha F s j))
                 (conj (Rabs_pos (v s j)) (Rabs_pos (om s j)))))).
  assert (A := sum_term_le (N F) (fun j => Rabs (zx F s j) + Rabs (zy F s j) + Rabs (tha F s j)
                             + Rabs (v s j) + Rabs (om s j)) i).
  simpl in A. assert (B := A ltac:(intros j _; destruct (T j) as (? & ? & ? & ? & ?); lra) Hi).
  destruct (T i) as (? & ? & ? & ? & ?). repeat split; lra.
Qed.

Lemma kinetic_sum_le : forall n (M p x : nat -> R) r, (forall i, (i < n)%nat -> 0 < M i /\ 0 < p i) ->
  (forall i, (i < n)%nat -> Rabs (x i) <= r) ->
  sum n (fun i => M i / p i * (x i) ^ 2 / 2) <= r ^ 2 * sum n (fun i => M i / p i).
Proof.
  intros n M p x r H Hx. rewrite <- sum_scal_l. apply sum_le; intros i Hi. destruct (H i Hi) as [HM Hp].
  assert (C := div_pos _ _ HM Hp). assert (D := pow_maj_Rabs r (x i) 2 (Hx i Hi)).
  assert (E := pow2_ge_0 (x i)). nra.
Qed.

Lemma energies_le : forall F s r, A1 F -> A2 F -> err F s <= r ->
  V F s <= r ^ 2 * sum (N F) (fun i => m F i / pv F i) + 2 * r * sum (N F) (deg F) /\
  W F s <= r ^ 2 * sum (N F) (fun i => J F i / pw F i) + r * sum (N F) (deg F).
Proof.
  intros F s r H1 H2 H. assert (T := fun i Hi => err_terms F s r i H Hi). unfold V, W. split.
  - assert (A := kinetic_sum_le (N F) (m F) (pv F) (v s) r (travel_gains F H2) ltac:(intros i Hi; apply (T i Hi))).
    assert (B := potential_le F (ls F) (zx F s) r H1 (proj1 H2) ltac:(intros i Hi; apply (T i Hi))).
    assert (C := potential_le F (ls F) (zy F s) r H1 (proj1 H2) ltac:(intros i Hi; apply (T i Hi))). lra.
  - assert (A := kinetic_sum_le (N F) (J F) (pw F) (om s) r (turn_gains F H2) ltac:(intros i Hi; apply (T i Hi))).
    assert (B := potential_le F (rs F) (tha F s) r H1 (proj1 (proj2 H2)) ltac:(intros i Hi; apply (T i Hi))). lra.
Qed.

Lemma energies_bounded : forall F, A1 F -> A2 F -> forall r, exists B, forall s, err F s <= r -> V F s <= B /\ W F s <= B.
Proof.
  intros F H1 H2 r.
  set (x := r ^ 2 * sum (N F) (fun i => m F i / pv F i) + 2 * r * sum (N F) (deg F)).
  set (y := r ^ 2 * sum (N F) (fun i => J F i / pw F i) + r * sum (N F) (deg F)).
  exists (Rmax x y). intros s H. destruct (energies_le F s r H1 H2 H) as [A B]. fold x y in A, B.
  assert (C := Rmax_l x y). assert (D := Rmax_r x y). split; lra.
Qed.

Lemma ratio_sum_nonneg : forall n (M p : nat -> R), (forall i, (i < n)%nat -> 0 < M i /\ 0 < p i) ->
  0 <= sum n (fun i => M i / p i).
Proof.
  intros n M p H. apply sum_nonneg; intros i Hi. destruct (H i Hi) as [HM Hp]. apply Rlt_le, div_pos; assumption.
Qed.

Lemma energies_small : forall F, A1 F -> A2 F -> forall eps, 0 < eps -> exists d, 0 < d /\
  forall s, err F s <= d -> V F s <= eps /\ W F s <= eps.
Proof.
  intros F H1 H2 eps He.
  assert (A := ratio_sum_nonneg (N F) (m F) (pv F) (travel_gains F H2)).
  assert (B := ratio_sum_nonneg (N F) (J F) (pw F) (turn_gains F H2)).
  assert (C : 0 <= sum (N F) (deg F)) by (apply sum_nonneg; intros i Hi; apply deg_nonneg; assumption).
  assert (K0 := fun s d => energies_le F s d H1 H2).
  set (x := sum (N F) (fun i => m F i / pv F i)) in *. set (y := sum (N F) (fun i => J F i / pw F i)) in *.
  set (D := sum (N F) (deg F)) in *.
  set (S := x + y + 2 * D + 1). set (d := Rmin 1 (eps / S)).
  assert (Hd : 0 < d) by (apply Rmin_glb_lt; [lra|apply div_pos; unfold S; lra]).
  assert (Hd1 : d <= 1) by apply Rmin_l.
  assert (HdS : d * S <= eps).
  { replace eps with (eps / S * S) by (field; unfold S; lra).
    apply Rmult_le_compat_r; [unfold S; lra|apply Rmin_r]. }
  exists d; split; [exact Hd|]. intros s H. destruct (K0 s d H) as [E1 E2].
  assert (Q : d ^ 2 <= d) by nra. unfold S in HdS. split; nra.
Qed.

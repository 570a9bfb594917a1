(** * EnergyCoercive.v : small energies mean small errors, bounded energies bounded errors (second half of L8).
    Each leader link and each edge holds its share of the potential, so the error at a leader link and the difference
    along an edge are small (bounded) where the potential is.  A chain of edges ties every vehicle to the leader. *)
From Coq Require Import Reals Lra.
From Gaincert Require Import Statement Definitions Sums Saturations EnergyDerivatives Connectivity EnergyBounds.
Open Scope R_scope.

(** ** Shares of the potential *)
Lemma leader_share : forall F scale z i, A1 F -> 0 < scale -> (i < N F)%nat ->
  al F i * scale * lncosh (z i / scale) <= potential F scale z.
Proof.
  intros F scale z i H1 Hs Hi.
  assert (A := sum_term_le (N F) (fun i => al F i * scale * ln (cosh (z i / scale))) i
                 ltac:(intros j Hj; apply leader_term_nonneg; assumption) Hi).
  assert (B : 0 <= sum (N F) (fun i => sum (N F) (fun j => a F i j * scale * ln (cosh ((z i - z j) / scale))))).
  { apply sum_nonneg; intros p Hp. apply sum_nonneg; intros q Hq. apply edge_term_nonneg; assumption. }
  unfold potential, lncosh. simpl in A. lra.
Qed.

Lemma edge_share : forall F scale z i j, A1 F -> 0 < scale -> (i < N F)%nat -> (j < N F)%nat ->
  / 2 * (a F i j * scale * lncosh ((z i - z j) / scale)) <= potential F scale z.
Proof.
  intros F scale z i j H1 Hs Hi Hj.
  assert (A : 0 <= sum (N F) (fun i => al F i * scale * ln (cosh (z i / scale)))).
  { apply sum_nonneg; intros p Hp. apply leader_term_nonneg; assumption. }
  assert (B := sum_term_le (N F) (fun j => a F i j * scale * ln (cosh ((z i - z j) / scale))) j
                 ltac:(intros q Hq; apply edge_term_nonneg; assumption) Hj).
  assert (C := sum_term_le (N F) (fun i => sum (N F) (fun j => a F i j * scale * ln (cosh ((z i - z j) / scale)))) i
                 ltac:(intros p Hp; apply sum_nonneg; intros q Hq; apply edge_term_nonneg; assumption) Hi).
  unfold potential, lncosh. simpl in B, C. lra.
Qed.

(** One share c scale lncosh (x / scale): small means x small, bounded means x bounded. *)
Lemma share_small : forall c scale eps, 0 < c -> 0 < scale -> 0 < eps -> exists d, 0 < d /\
  forall x, c * scale * lncosh (x / scale) <= d -> Rabs x <= eps.
Proof.
  intros c scale eps Hc Hs He.
  assert (P : 0 < eps / scale) by (apply div_pos; assumption).
  assert (Q : 0 < lncosh (eps / scale)) by (apply lncosh_pos; lra).
  assert (Hcs : 0 < c * scale) by (apply Rmult_lt_0_compat; assumption).
  exists (c * scale * lncosh (eps / scale)); split; [apply Rmult_lt_0_compat; assumption|].
  intros x Hx. apply Rmult_le_reg_l in Hx; [|exact Hcs].
  apply lncosh_small in Hx; [|exact P]. rewrite abs_div_pos in Hx by exact Hs.
  replace (Rabs x) with (Rabs x / scale * scale) by (field; lra).
  replace eps with (eps / scale * scale) by (field; lra).
  apply Rmult_le_compat_r; lra.
Qed.

Lemma share_bounded : forall c scale B, 0 < c -> 0 < scale -> exists r,
  forall x, c * scale * lncosh (x / scale) <= B -> Rabs x <= r.
Proof.
  intros c scale B Hc Hs.
  assert (Hcs : 0 < c * scale) by (apply Rmult_lt_0_compat; assumption).
  exists ((B / (c * scale) + ln 2) * scale). intros x Hx.
  assert (A := lncosh_ge (x / scale)). rewrite abs_div_pos in A by exact Hs.
  assert (C : lncosh (x / scale) <= B / (c * scale)).
  { apply Rmult_le_reg_l with (1 := Hcs). replace (c * scale * (B / (c * scale))) with B by (field; lra). exact Hx. }
  replace (Rabs x) with (Rabs x / scale * scale) by (field; lra).
  apply Rmult_le_compat_r; lra.
Qed.

(** ** The potential along a chain to the leader *)
Lemma potential_small_one : forall F scale, A1 F -> 0 < scale -> forall i, (i < N F)%nat ->
  forall eps, 0 < eps -> exists d, 0 < d /\ forall z, potential F scale z <= d -> Rabs (z i) <= eps.
Proof.
  intros F scale H1 Hs.
  apply (leader_induction F (fun i => forall eps, 0 < eps -> exists d, 0 < d /\
           forall z, potential F scale z <= d -> Rabs (z i) <= eps)); [exact H1| |].
  - intros i Hi Hal eps He. destruct (share_small (al F i) scale eps Hal Hs He) as [d [Hd H]].
    exists d; split; [exact Hd|]. intros z Hz. apply H.
    eapply Rle_trans; [apply leader_share; assumption|exact Hz].
  - intros i j Hi Hj Ha IH eps He.
    destruct (IH (eps / 2) ltac:(lra)) as [d1 [Hd1 H']].
    destruct (share_small (a F i j) scale (eps / 2) Ha Hs ltac:(lra)) as [d2 [Hd2 H]].
    exists (Rmin d1 (d2 / 2)); split; [apply Rmin_glb_lt; lra|]. intros z Hz.
    assert (A := H' z (Rle_trans _ _ _ Hz (Rmin_l _ _))).
    assert (B : Rabs (z i - z j) <= eps / 2).
    { apply H. assert (S := edge_share F scale z i j H1 Hs Hi Hj). assert (M := Rmin_r d1 (d2 / 2)). lra. }
    replace (z i) with (z j + (z i - z j)) by ring. eapply Rle_trans; [apply Rabs_triang|lra].
Qed.

Lemma potential_bounded_one : forall F scale, A1 F -> 0 < scale -> forall i, (i < N F)%nat ->
  forall B, exists r, forall z, potential F scale z <= B -> Rabs (z i) <= r.
Proof.
  intros F scale H1 Hs i Hi B. revert i Hi.
  apply (leader_induction F (fun i => exists r, forall z, potential F scale z <= B -> Rabs (z i) <= r)); [exact H1| |].
  - intros i Hi Hal. destruct (share_bounded (al F i) scale B Hal Hs) as [r H].
    exists r. intros z Hz. apply H. eapply Rle_trans; [apply leader_share; assumption|exact Hz].
  - intros i j Hi Hj Ha [r1 H'].
    destruct (share_bounded (a F i j) scale (2 * B) Ha Hs) as [r2 H].
    exists (r1 + r2). intros z Hz. assert (A := H' z Hz).
    assert (C : Rabs (z i - z j) <= r2).
    { apply H. assert (S := edge_share F scale z i j H1 Hs Hi Hj). lra. }
    replace (z i) with (z j + (z i - z j)) by ring. eapply Rle_trans; [apply Rabs_triang|lra].
Qed.

Lemma potential_small : forall F scale eps, A1 F -> 0 < scale -> 0 < eps -> exists d, 0 < d /\
  forall z, potential F scale z <= d -> forall i, (i < N F)%nat -> Rabs (z i) <= eps.
Proof.
  intros F scale eps H1 Hs He.
  destruct (finite_common_small (N F) (fun i d => forall z, potential F scale z <= d -> Rabs (z i) <= eps)) as [d [Hd H]].
  - intros i x y _ _ Hxy H z Hz. apply H. lra.
  - intros i Hi. apply potential_small_one; assumption.
  - exists d; split; [exact Hd|]. intros z Hz i Hi. apply (H i Hi z Hz).
Qed.

Lemma potential_bounded : forall F scale B, A1 F -> 0 < scale -> exists r, 0 < r /\
  forall z, potential F scale z <= B -> forall i, (i < N F)%nat -> Rabs (z i) <= r.
Proof.
  intros F scale B H1 Hs.
  destruct (finite_common_large (N F) (fun i r => forall z, potential F scale z <= B -> Rabs (z i) <= r)) as [r [Hr H]].
  - intros i x y _ Hxy H z Hz. assert (A := H z Hz). lra.
  - intros i Hi. apply potential_bounded_one; assumption.
  - exists r; split; [exact Hr|]. intros z Hz i Hi. apply (H i Hi z Hz).
Qed.

(** ** The kinetic part *)
Lemma square_le_abs : forall x y, 0 <= y -> x ^ 2 <= y ^ 2 -> Rabs x <= y.
Proof.
  intros x y Hy H. rewrite <- (Rabs_pos_eq y Hy). apply Rsqr_le_abs_0. unfold Rsqr. lra.
Qed.

Lemma kinetic_small : forall n (M p : nat -> R) eps, (forall i, (i < n)%nat -> 0 < M i /\ 0 < p i) -> 0 < eps ->
  exists d, 0 < d /\ forall x : nat -> R, sum n (fun i => M i / p i * (x i) ^ 2 / 2) <= d ->
  forall i, (i < n)%nat -> Rabs (x i) <= eps.
Proof.
  intros n M p eps H He.
  destruct (finite_positive_lower_bound n (fun i => M i / p i)) as [c [Hc Hcl]].
  { intros i Hi. destruct (H i Hi). apply div_pos; assumption. }
  exists (c * eps ^ 2 / 2); split; [assert (A := pow_lt eps 2 He); nra|]. intros x Hx i Hi.
  assert (A := sum_term_le n (fun i => M i / p i * (x i) ^ 2 / 2) i
                 ltac:(intros j Hj; destruct (H j Hj); apply kinetic_nonneg, div_pos; assumption) Hi).
  simpl in A. assert (B := Rmult_le_compat_r _ _ _ (pow2_ge_0 (x i)) (Hcl i Hi)).
  apply square_le_abs; [lra|]. apply Rmult_le_reg_l with (1 := Hc). simpl in *. lra.
Qed.

Lemma kinetic_bounded : forall n (M p : nat -> R) B, (forall i, (i < n)%nat -> 0 < M i /\ 0 < p i) ->
  exists r, 0 < r /\ forall x : nat -> R, sum n (fun i => M i / p i * (x i) ^ 2 / 2) <= B ->
  forall i, (i < n)%nat -> Rabs (x i) <= r.
Proof.
  intros n M p B H.
  destruct (finite_positive_lower_bound n (fun i => M i / p i)) as [c [Hc Hcl]].
  { intros i Hi. destruct (H i Hi). apply div_pos; assumption. }
  (* r = 2 |B| / c + 1 is at least 1, so that r <= r^2 *)
  set (r := 2 * Rabs B / c + 1).
  assert (P : 0 <= 2 * Rabs B / c) by (apply div_nonneg; [assert (A := Rabs_pos B); lra|exact Hc]).
  assert (Hr : 1 <= r) by (unfold r; lra).
  exists r; split; [lra|]. intros x Hx i Hi.
  assert (A := sum_term_le n (fun i => M i / p i * (x i) ^ 2 / 2) i
                 ltac:(intros j Hj; destruct (H j Hj); apply kinetic_nonneg, div_pos; assumption) Hi).
  simpl in A. assert (Q := Rmult_le_compat_r _ _ _ (pow2_ge_0 (x i)) (Hcl i Hi)).
  assert (D : 2 * Rabs B <= c * r) by (unfold r; replace (c * (2 * Rabs B / c + 1)) with (2 * Rabs B + c) by (field; lra); lra).
  assert (E := Rle_abs B).
  apply square_le_abs; [lra|]. apply Rmult_le_reg_l with (1 := Hc).
  assert (G : c * r <= c * r ^ 2) by (apply Rmult_le_compat_l; nra).
  simpl in *. lra.
Qed.

(** ** The four statements *)
Lemma V_parts : forall F s d, A1 F -> A2 F -> V F s <= d ->
  sum (N F) (fun i => m F i / pv F i * (v s i) ^ 2 / 2) <= d /\
  potential F (ls F) (zx F s) <= d /\ potential F (ls F) (zy F s) <= d.
Proof.
  intros F s d H1 H2 H. unfold V in H.
  assert (A := kinetic_sum_nonneg (N F) (m F) (pv F) (v s) (travel_gains F H2)).
  assert (B := potential_nonneg F (ls F) (zx F s) H1 (proj1 H2)).
  assert (C := potential_nonneg F (ls F) (zy F s) H1 (proj1 H2)). lra.
Qed.

Lemma W_parts : forall F s d, A1 F -> A2 F -> W F s <= d ->
  sum (N F) (fun i => J F i / pw F i * (om s i) ^ 2 / 2) <= d /\ potential F (rs F) (tha F s) <= d.
Proof.
  intros F s d H1 H2 H. unfold W in H.
  assert (A := kinetic_sum_nonneg (N F) (J F) (pw F) (om s) (turn_gains F H2)).
  assert (B := potential_nonneg F (rs F) (tha F s) H1 (proj1 (proj2 H2))). lra.
Qed.

(** A sum of n terms, each at most e / (n + 1), is at most e. *)
Lemma sum_le_share : forall n f e, 0 <= e -> (forall i, (i < n)%nat -> f i <= e / (INR n + 1)) -> sum n f <= e.
Proof.
  intros n f e He H. assert (P := pos_INR n).
  apply Rle_trans with (INR n * (e / (INR n + 1))).
  - rewrite <- sum_const. apply sum_le; exact H.
  - apply Rle_trans with ((INR n + 1) * (e / (INR n + 1))); [|right; field; lra].
    apply Rmult_le_compat_r; [apply div_nonneg; lra|lra].
Qed.

Lemma V_small : forall F, A1 F -> A2 F -> forall eps, 0 < eps -> exists d, 0 < d /\ forall s, V F s <= d ->
  sum (N F) (fun i => Rabs (zx F s i) + Rabs (zy F s i) + Rabs (v s i)) <= eps.
Proof.
  intros F H1 H2 eps He. set (e := eps / (INR (N F) + 1) / 3). assert (P := pos_INR (N F)).
  assert (Hes : 0 < e) by (unfold e; apply div_pos; [apply div_pos|]; lra).
  destruct (kinetic_small (N F) (m F) (pv F) e (travel_gains F H2) Hes) as [d1 [Hd1 K1]].
  destruct (potential_small F (ls F) e H1 (proj1 H2) Hes) as [d2 [Hd2 K2]].
  exists (Rmin d1 d2); split; [apply Rmin_glb_lt; assumption|]. intros s Hs.
  destruct (V_parts F s _ H1 H2 Hs) as [A [B C]]. assert (L := Rmin_l d1 d2). assert (M := Rmin_r d1 d2).
  apply sum_le_share; [lra|]. intros i Hi.
  assert (X := K1 (v s) ltac:(lra) i Hi). assert (Y := K2 (zx F s) ltac:(lra) i Hi).
  assert (Z := K2 (zy F s) ltac:(lra) i Hi). unfold e in *. lra.
Qed.

Lemma W_small : forall F, A1 F -> A2 F -> forall eps, 0 < eps -> exists d, 0 < d /\ forall s, W F s <= d ->
  sum (N F) (fun i => Rabs (tha F s i) + Rabs (om s i)) <= eps.
Proof.
  intros F H1 H2 eps He. set (e := eps / (INR (N F) + 1) / 2). assert (P := pos_INR (N F)).
  assert (Hes : 0 < e) by (unfold e; apply div_pos; [apply div_pos|]; lra).
  destruct (kinetic_small (N F) (J F) (pw F) e (turn_gains F H2) Hes) as [d1 [Hd1 K1]].
  destruct (potential_small F (rs F) e H1 (proj1 (proj2 H2)) Hes) as [d2 [Hd2 K2]].
  exists (Rmin d1 d2); split; [apply Rmin_glb_lt; assumption|]. intros s Hs.
  destruct (W_parts F s _ H1 H2 Hs) as [A B]. assert (L := Rmin_l d1 d2). assert (M := Rmin_r d1 d2).
  apply sum_le_share; [lra|]. intros i Hi.
  assert (X := K1 (om s) ltac:(lra) i Hi). assert (Y := K2 (tha F s) ltac:(lra) i Hi). unfold e in *. lra.
Qed.

Lemma err_bounded : forall F, A1 F -> A2 F -> forall B, exists r, forall s, V F s <= B -> W F s <= B -> err F s <= r.
Proof.
  intros F H1 H2 B.
  destruct (kinetic_bounded (N F) (m F) (pv F) B (travel_gains F H2)) as [r1 [_ K1]].
  destruct (potential_bounded F (ls F) B H1 (proj1 H2)) as [r2 [_ K2]].
  destruct (kinetic_bounded (N F) (J F) (pw F) B (turn_gains F H2)) as [r3 [_ K3]].
  destruct (potential_bounded F (rs F) B H1 (proj1 (proj2 H2))) as [r4 [_ K4]].
  exists (INR (N F) * (r1 + 2 * r2 + r3 + r4)). intros s HV HW.
  destruct (V_parts F s _ H1 H2 HV) as [A1' [A2' A3']]. destruct (W_parts F s _ H1 H2 HW) as [A4' A5'].
  rewrite <- sum_const. apply sum_le; intros i Hi.
  assert (X1 := K1 (v s) A1' i Hi). assert (X2 := K2 (zx F s) A2' i Hi). assert (X3 := K2 (zy F s) A3' i Hi).
  assert (X4 := K3 (om s) A4' i Hi). assert (X5 := K4 (tha F s) A5' i Hi). lra.
Qed.

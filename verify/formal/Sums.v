(** * Sums.v : finite sums over the vehicles (and L2, the edge identity).
    The sum of Statement.v behaves like every finite sum: it is linear and monotone, double sums may be swapped,
    and finitely many numbers have a common bound.  L2: where every pull along an edge is odd and the weights are
    symmetric, a sum over vehicles is half a sum over edges. *)
From Coq Require Import Reals Lra Lia.
From Gaincert Require Import Statement.
Open Scope R_scope.

(** ** Equality and linearity *)
Lemma sum_ext : forall n f g, (forall i, (i < n)%nat -> f i = g i) -> sum n f = sum n g.
Proof.
  induction n as [|n IH]; intros f g H; simpl.
  - reflexivity.
  - rewrite (IH f g), (H n); auto with arith.
Qed.

Lemma sum_plus : forall n f g, sum n (fun i => f i + g i) = sum n f + sum n g.
Proof. induction n as [|n IH]; intros f g; simpl; [ring|rewrite IH; ring]. Qed.

Lemma sum_minus : forall n f g, sum n (fun i => f i - g i) = sum n f - sum n g.
Proof. induction n as [|n IH]; intros f g; simpl; [ring|rewrite IH; ring]. Qed.

Lemma sum_opp : forall n f, sum n (fun i => - f i) = - sum n f.
Proof. induction n as [|n IH]; intros f; simpl; [ring|rewrite IH; ring]. Qed.

Lemma sum_scal_l : forall n c f, sum n (fun i => c * f i) = c * sum n f.
Proof. induction n as [|n IH]; intros c f; simpl; [ring|rewrite IH; ring]. Qed.

Lemma sum_scal_r : forall n c f, sum n (fun i => f i * c) = sum n f * c.
Proof. induction n as [|n IH]; intros c f; simpl; [ring|rewrite IH; ring]. Qed.

Lemma sum_const : forall n c, sum n (fun _ => c) = INR n * c.
Proof. induction n as [|n IH]; intros c; [simpl; ring|]. rewrite S_INR; simpl; rewrite IH; ring. Qed.

Lemma sum_zero : forall n f, (forall i, (i < n)%nat -> f i = 0) -> sum n f = 0.
Proof.
  intros n f H. rewrite (sum_ext n f (fun _ => 0) H), sum_const; ring.
Qed.

(** ** Order *)
Lemma sum_le : forall n f g, (forall i, (i < n)%nat -> f i <= g i) -> sum n f <= sum n g.
Proof.
  induction n as [|n IH]; intros f g H; simpl.
  - lra.
  - assert (A := IH f g ltac:(auto with arith)). assert (B := H n ltac:(auto with arith)). lra.
Qed.

Lemma sum_nonneg : forall n f, (forall i, (i < n)%nat -> 0 <= f i) -> 0 <= sum n f.
Proof.
  intros n f H. rewrite <- (sum_zero n (fun _ => 0)) by reflexivity. apply sum_le; exact H.
Qed.

(** One term of a sum of nonnegative terms is at most the sum. *)
Lemma sum_term_le : forall n f i, (forall j, (j < n)%nat -> 0 <= f j) -> (i < n)%nat -> f i <= sum n f.
Proof.
  induction n as [|n IH]; intros f i H Hi; [lia|]. simpl.
  assert (A : 0 <= sum n f) by (apply sum_nonneg; auto with arith).
  assert (B := H n ltac:(lia)).
  destruct (PeanoNat.Nat.eq_dec i n) as [->|Hne]; [lra|].
  assert (C := IH f i ltac:(auto with arith) ltac:(lia)). lra.
Qed.

Lemma sum_pos_term : forall n f, 0 < sum n f -> exists i, (i < n)%nat /\ 0 < f i.
Proof.
  induction n as [|n IH]; intros f H; simpl in H; [lra|].
  destruct (Rlt_le_dec 0 (f n)) as [L|L].
  - exists n; split; [lia|exact L].
  - destruct (IH f) as [i [Hi Hf]]; [lra|]. exists i; split; [lia|exact Hf].
Qed.

Lemma sum_abs : forall n f, Rabs (sum n f) <= sum n (fun i => Rabs (f i)).
Proof.
  induction n as [|n IH]; intros f; simpl.
  - rewrite Rabs_R0; lra.
  - eapply Rle_trans; [apply Rabs_triang|]. assert (A := IH f). lra.
Qed.

Lemma sum_abs_le : forall n f g, (forall i, (i < n)%nat -> Rabs (f i) <= g i) -> Rabs (sum n f) <= sum n g.
Proof. intros n f g H. eapply Rle_trans; [apply sum_abs|apply sum_le; exact H]. Qed.

(** ** Double sums *)
Lemma sum_swap : forall n p (f : nat -> nat -> R),
  sum n (fun i => sum p (fun j => f i j)) = sum p (fun j => sum n (fun i => f i j)).
Proof.
  induction n as [|n IH]; intros p f; simpl.
  - symmetry; apply sum_zero; reflexivity.
  - rewrite IH, <- sum_plus. reflexivity.
Qed.

(** ** Finitely many numbers have a common bound; finitely many positive numbers a common positive one below *)
Lemma finite_upper_bound : forall n (f : nat -> R), exists B, 0 < B /\ forall i, (i < n)%nat -> f i <= B.
Proof.
  induction n as [|n IH]; intros f.
  - exists 1; split; [lra|intros i Hi; lia].
  - destruct (IH f) as [B [HB H]]. exists (Rmax B (f n)); split.
    + assert (A := Rmax_l B (f n)); lra.
    + intros i Hi. destruct (PeanoNat.Nat.eq_dec i n) as [->|Hne]; [apply Rmax_r|].
      eapply Rle_trans; [apply H; lia|apply Rmax_l].
Qed.

Lemma finite_positive_lower_bound : forall n (f : nat -> R), (forall i, (i < n)%nat -> 0 < f i) ->
  exists c, 0 < c /\ forall i, (i < n)%nat -> c <= f i.
Proof.
  induction n as [|n IH]; intros f Hf.
  - exists 1; split; [lra|intros i Hi; lia].
  - destruct (IH f ltac:(auto with arith)) as [c [Hc H]]. exists (Rmin c (f n)); split.
    + apply Rmin_glb_lt; [exact Hc|apply Hf; lia].
    + intros i Hi. destruct (PeanoNat.Nat.eq_dec i n) as [->|Hne]; [apply Rmin_r|].
      eapply Rle_trans; [apply Rmin_l|apply H; lia].
Qed.

(** Choose for each of finitely many indices at once: a common positive number below witnesses of a
    property that is inherited by smaller numbers. *)
Lemma finite_common_small : forall n (P : nat -> R -> Prop),
  (forall i x y, (i < n)%nat -> 0 < y -> y <= x -> P i x -> P i y) ->
  (forall i, (i < n)%nat -> exists x, 0 < x /\ P i x) ->
  exists x, 0 < x /\ forall i, (i < n)%nat -> P i x.
Proof.
  induction n as [|n IH]; intros P Hmono Hex.
  - exists 1; split; [lra|intros i Hi; lia].
  - destruct (IH P) as [x [Hx HP]].
    + intros i x y Hi; apply Hmono; lia.
    + intros i Hi; apply Hex; lia.
    + destruct (Hex n ltac:(lia)) as [y [Hy HPn]].
      assert (M : 0 < Rmin x y) by (apply Rmin_glb_lt; assumption).
      exists (Rmin x y); split; [exact M|]. intros i Hi.
      destruct (PeanoNat.Nat.eq_dec i n) as [->|Hne].
      * apply (Hmono n y); [lia|exact M|apply Rmin_r|exact HPn].
      * apply (Hmono i x); [lia|exact M|apply Rmin_l|apply HP; lia].
Qed.

(** The same for a large number. *)
Lemma finite_common_large : forall n (P : nat -> R -> Prop),
  (forall i x y, (i < n)%nat -> x <= y -> P i x -> P i y) ->
  (forall i, (i < n)%nat -> exists x, P i x) ->
  exists x, 0 < x /\ forall i, (i < n)%nat -> P i x.
Proof.
  induction n as [|n IH]; intros P Hmono Hex.
  - exists 1; split; [lra|intros i Hi; lia].
  - destruct (IH P) as [x [Hx HP]].
    + intros i x y Hi; apply Hmono; lia.
    + intros i Hi; apply Hex; lia.
    + destruct (Hex n ltac:(lia)) as [y HPn].
      exists (Rmax x y); split; [assert (A := Rmax_l x y); lra|]. intros i Hi.
      destruct (PeanoNat.Nat.eq_dec i n) as [->|Hne].
      * apply (Hmono n y); [lia|apply Rmax_r|exact HPn].
      * apply (Hmono i x); [lia|apply Rmax_l|apply HP; lia].
Qed.

(** ** L2: the edge identity *)
Lemma edge_identity : forall n (w : nat -> nat -> R) (g : R -> R) (x y : nat -> R),
  (forall i j, (i < n)%nat -> (j < n)%nat -> w i j = w j i) -> (forall r, g (- r) = - g r) ->
  sum n (fun i => y i * sum n (fun j => w i j * g (x i - x j)))
  = / 2 * sum n (fun i => sum n (fun j => w i j * ((y i - y j) * g (x i - x j)))).
Proof.
  intros n w g x y Hw Hg.
  set (S := sum n (fun i => sum n (fun j => y i * (w i j * g (x i - x j))))).
  set (S' := sum n (fun i => sum n (fun j => y j * (w i j * g (x i - x j))))).
  assert (E1 : sum n (fun i => y i * sum n (fun j => w i j * g (x i - x j))) = S).
  { apply sum_ext; intros i Hi. symmetry; apply sum_scal_l. }
  assert (E2 : S' = - S).
  { unfold S', S. rewrite sum_swap, <- sum_opp. apply sum_ext; intros i Hi.
    rewrite <- sum_opp. apply sum_ext; intros j Hj.
    rewrite (Hw j i Hj Hi). replace (x j - x i) with (- (x i - x j)) by ring. rewrite Hg; ring. }
  assert (E3 : sum n (fun i => sum n (fun j => w i j * ((y i - y j) * g (x i - x j)))) = S - S').
  { unfold S, S'. rewrite <- sum_minus. apply sum_ext; intros i Hi.
    rewrite <- sum_minus. apply sum_ext; intros j Hj. ring. }
  rewrite E1, E3, E2; field.
Qed.

(** * ShortHorizon.v : a start at e across the leader's heading, over a fixed horizon (for L17).
    The fleet starts at rest, with the leader's heading, every vehicle at e from its place, straight across that
    heading.  Idea: V starts at order e^2 and never grows, so speeds stay of order e; then so do places, alpha,
    turn rates (W grows at most like its own size plus e^2) and headings.  A vehicle drifts across at
    sin(heading error) * speed, of order e^2 only. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus EnergyDerivatives EnergyBounds Formation.
Open Scope R_scope.

Definition aside (F : fleet) (e : R) : state :=
  displaced F (fun _ => - sin (leadth F) * e) (fun _ => cos (leadth F) * e) (fun _ => leadth F) (fun _ => 0) (fun _ => 0).

(** ** Small tools *)
Lemma abs_le_of_square : forall x y, 0 <= y -> x ^ 2 <= y ^ 2 -> Rabs x <= y.
Proof.
  intros x y Hy H. rewrite <- (Rabs_pos_eq y Hy). apply Rsqr_le_abs_0. unfold Rsqr. lra.
Qed.

Lemma direction_abs : forall x e, 0 <= e -> Rabs (sin x * e) <= e /\ Rabs (cos x * e) <= e.
Proof.
  intros x e He. rewrite !Rabs_mult, (Rabs_pos_eq e He).
  assert (Rabs (sin x) <= 1) by apply Rabs_le, SIN_bound.
  assert (Rabs (cos x) <= 1) by apply Rabs_le, COS_bound. split; nra.
Qed.

Lemma sin_abs_le : forall x, Rabs (sin x) <= Rabs x.
Proof.
  intros x. destruct (Rle_dec 0 x) as [Hx | Hx].
  - replace (sin x) with (sin x - sin 0) by (rewrite sin_0; ring). rewrite (Rabs_pos_eq x Hx).
    replace x with (1 * (x - 0)) at 2 by ring. apply increment_abs; [exact Hx|].
    intros t _. exists (cos t). split; [apply is_derive_sin|apply Rabs_le, COS_bound].
  - rewrite <- (Rabs_Ropp (sin x)). replace (- sin x) with (sin 0 - sin x) by (rewrite sin_0; ring).
    rewrite (Rabs_left x) by lra. replace (- x) with (1 * (0 - x)) by ring. apply increment_abs; [lra|].
    intros t _. exists (cos t). split; [apply is_derive_sin|apply Rabs_le, COS_bound].
Qed.

(** A potential is at least 0, and of an agreed error x it is at most al/scale x^2 per vehicle. *)
Lemma potential_of_agreement : forall F scale x, A1 F -> 0 < scale ->
  potential F scale (fun _ => x) <= sum (N F) (al F) / scale * x ^ 2.
Proof.
  intros F scale x [_ [Hal _]] Hs. unfold potential.
  rewrite (sum_zero (N F) (fun i => sum (N F) (fun j => a F i j * scale * ln (cosh ((x - x) / scale))))).
  - rewrite Rmult_0_r, Rplus_0_r. unfold Rdiv at 2. rewrite !Rmult_assoc, <- sum_scal_r.
    apply sum_le. intros i Hi. rewrite Rmult_assoc. apply Rmult_le_compat_l; [apply Hal; exact Hi|].
    pose proof (lncosh_le_x_tanh (x / scale)) as Hln. unfold lncosh in Hln.
    pose proof (tanh_abs_le (x / scale)) as Htanh.
    assert (Hsquare : x / scale * tanh (x / scale) <= (x / scale) ^ 2).
    { eapply Rle_trans; [apply Rle_abs|]. rewrite Rabs_mult. replace ((x / scale) ^ 2) with (Rabs (x / scale) * Rabs (x / scale)).
      - apply Rmult_le_compat_l; [apply Rabs_pos|exact Htanh].
      - rewrite <- Rabs_mult, Rabs_pos_eq; [ring|]. pose proof (pow2_ge_0 (x / scale)). lra. }
    replace (/ scale * x ^ 2) with (scale * (x / scale) ^ 2) by (field; lra).
    apply Rmult_le_compat_l; lra.
  - intros i _. apply sum_zero. intros j _. rewrite Rminus_diag_eq by reflexivity.
    unfold Rdiv. rewrite Rmult_0_l. change (ln (cosh 0)) with (lncosh 0). rewrite lncosh_0. ring.
Qed.

Lemma potential_ext : forall F scale z z', (forall i, z i = z' i) -> potential F scale z = potential F scale z'.
Proof.
  intros F scale z z' Hz. unfold potential. f_equal.
  - apply sum_ext. intros i _. rewrite (Hz i). reflexivity.
  - f_equal. apply sum_ext. intros i _. apply sum_ext. intros j _. rewrite (Hz i), (Hz j). reflexivity.
Qed.

(** Small errors pull little. *)
Lemma coupling_small : forall F scale z r i, A1 F -> 0 < scale -> (i < N F)%nat ->
  (forall j, (j < N F)%nat -> Rabs (z j) <= r) -> Rabs (coupling F scale z i) <= 2 * deg F i / scale * r.
Proof.
  intros F scale z r i [Ha [Hal _]] Hs Hi Hz.
  assert (Htanh : forall x, Rabs x <= 2 * r -> Rabs (tanh (x / scale)) <= 2 * r / scale).
  { intros x Hx. eapply Rle_trans; [apply tanh_abs_le|]. rewrite abs_div_pos by exact Hs. apply div_le; assumption. }
  assert (Hr : 0 <= r) by (eapply Rle_trans; [apply Rabs_pos|apply (Hz i Hi)]).
  replace (2 * deg F i / scale * r) with (al F i * (2 * r / scale) + sum (N F) (fun j => a F i j * (2 * r / scale)))
    by (rewrite sum_scal_r; unfold deg; change (fun j => a F i j) with (a F i); field; lra).
  unfold coupling. eapply Rle_trans; [apply Rabs_triang|]. apply Rplus_le_compat.
  - rewrite Rabs_mult, (Rabs_pos_eq (al F i)) by (apply Hal; exact Hi).
    apply Rmult_le_compat_l; [apply Hal; exact Hi|]. apply Htanh. pose proof (Hz i Hi). lra.
  - apply sum_abs_le. intros j Hj. destruct (Ha i j Hi Hj) as [_ Haij].
    rewrite Rabs_mult, (Rabs_pos_eq (a F i j)) by exact Haij. apply Rmult_le_compat_l; [exact Haij|].
    apply Htanh. unfold Rminus. eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_Ropp.
    pose proof (Hz i Hi). pose proof (Hz j Hj). lra.
Qed.

(** Where every M/p x^2 / 2 is at most C e^2, every |x| is at most K e. *)
Lemma kinetic_to_speed : forall n (M p : nat -> R) C, 0 <= C -> (forall i, (i < n)%nat -> 0 < M i /\ 0 < p i) ->
  exists K, 0 < K /\ forall e x i, 0 <= e -> (i < n)%nat -> M i / p i * x ^ 2 / 2 <= C * e ^ 2 -> Rabs x <= K * e.
Proof.
  intros n M p C HC Hpos. destruct (finite_upper_bound n (fun i => 2 * C * p i / M i)) as [B [HB HBi]].
  exists (B + 1). split; [lra|]. intros e x i He Hi Hx. destruct (Hpos i Hi) as [HM Hp].
  assert (Hsquare : x ^ 2 <= B * e ^ 2).
  { replace (x ^ 2) with (2 * p i / M i * (M i / p i * x ^ 2 / 2)) by (field; lra).
    apply Rle_trans with (2 * p i / M i * (C * e ^ 2)).
    - apply Rmult_le_compat_l; [|exact Hx]. apply Rlt_le, div_pos; lra.
    - replace (2 * p i / M i * (C * e ^ 2)) with (2 * C * p i / M i * e ^ 2) by (field; lra).
      apply Rmult_le_compat_r; [apply pow2_ge_0|]. apply HBi. exact Hi. }
  pose proof (pow2_ge_0 e). apply abs_le_of_square; [nra|].
  apply Rle_trans with (B * e ^ 2); [exact Hsquare|].
  replace (((B + 1) * e) ^ 2) with ((B + 1) * (B + 1) * e ^ 2) by ring. nra.
Qed.

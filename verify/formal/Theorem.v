(** * Theorem.v : the corrected formation theorem (L15), put together.
    Reach brings the error below any level before a time known in advance, stability keeps it there: attractivity.
    Before that time the energies bound the error, after it stability does: boundedness.
    Torque, speed and turn-rate limits come from their own file. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Dichotomy Stability Torques.
Open Scope R_scope.

Lemma uniformly_attractive_holds : forall F, A1 F -> A2 F -> A3 F -> uniformly_attractive F.
Proof.
  intros F HA1 HA2 HA3 r eps Hr Heps.
  destruct (uniformly_stable_holds F HA1 HA2 HA3 eps Heps) as [delta [Hdelta Hstable]].
  destruct (uniform_reach F HA1 HA2 HA3 r delta Hdelta) as [tau [Htau Hreach]].
  exists tau. intros t0 X Ht0 HX Hstart t Ht.
  destruct (Hreach t0 X Ht0 HX Hstart) as [t1 [Ht1 Hsmall]].
  apply (Hstable t1 X); [lra | apply (solution_later F t0); [assumption | lra] | assumption | lra].
Qed.

Lemma uniformly_bounded_holds : forall F, A1 F -> A2 F -> A3 F -> uniformly_bounded F.
Proof.
  intros F HA1 HA2 HA3 r Hr.
  destruct (uniformly_attractive_holds F HA1 HA2 HA3 r 1 Hr Rlt_0_1) as [tau Hlate].
  destruct (bounded_meanwhile F HA1 HA2 HA3 r tau) as [B Hearly].
  exists (Rmax B 1). intros t0 X Ht0 HX Hstart t Ht.
  destruct (Rle_dec t (t0 + tau)) as [H | H].
  - apply Rle_trans with B; [| apply Rmax_l]. apply (Hearly t0 X Ht0 HX Hstart). lra.
  - apply Rle_trans with 1; [| apply Rmax_r]. apply (Hlate t0 X Ht0 HX Hstart). lra.
Qed.

Theorem corrected_theorem_holds : corrected_theorem.
Proof.
  intros F HA1 HA2 HA3.
  split; [apply uniformly_bounded_holds; assumption |].
  split; [apply uniformly_stable_holds; assumption |].
  split; [apply uniformly_attractive_holds; assumption |].
  split; [apply torque_bound_holds; assumption |].
  split; [apply speed_bound_holds; assumption | apply turn_rate_bound_holds; assumption].
Qed.

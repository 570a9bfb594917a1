(** * Connectivity.v : what the cut condition of (A1) gives.
    A property that every vehicle with a leader link has, and that passes along edges, holds for every vehicle.
    Otherwise the vehicles without it form a set that is tied neither to the leader nor to the others. *)
From Coq Require Import Reals Lra Lia Classical.
From Gaincert Require Import Statement Sums.
Open Scope R_scope.

(** A property of finitely many vehicles as a set in the sense of (A1). *)
Lemma set_of_property : forall n (P : nat -> Prop),
  exists S : nat -> bool, forall i, (i < n)%nat -> (S i = true <-> P i).
Proof.
  induction n as [|n IH]; intros P.
  - exists (fun _ => true). intros i Hi; lia.
  - destruct (IH P) as [S HS]. destruct (classic (P n)) as [HP|HP].
    + exists (fun i => if Nat.eqb i n then true else S i). intros i Hi.
      destruct (Nat.eqb_spec i n) as [->|Hne]; [split; auto|apply HS; lia].
    + exists (fun i => if Nat.eqb i n then false else S i). intros i Hi.
      destruct (Nat.eqb_spec i n) as [->|Hne]; [split; [discriminate|contradiction]|apply HS; lia].
Qed.

Lemma leader_induction : forall F (P : nat -> Prop), A1 F ->
  (forall i, (i < N F)%nat -> 0 < al F i -> P i) ->
  (forall i j, (i < N F)%nat -> (j < N F)%nat -> 0 < a F i j -> P j -> P i) ->
  forall i, (i < N F)%nat -> P i.
Proof.
  intros F P [_ [Hal Hcut]] Hleader Hedge i Hi.
  destruct (set_of_property (N F) (fun i => ~ P i)) as [S HS].
  apply NNPP; intros HP.
  assert (C := Hcut S (ex_intro _ i (conj Hi (proj2 (HS i Hi) HP)))).
  apply sum_pos_term in C. destruct C as [p [Hp C]].
  destruct (S p) eqn:Ep; [|lra].
  apply (proj1 (HS p Hp) Ep).
  destruct (Rlt_le_dec 0 (al F p)) as [L|L]; [apply Hleader; assumption|].
  assert (C' : 0 < sum (N F) (fun j => if S j then 0 else a F p j)) by lra.
  apply sum_pos_term in C'. destruct C' as [q [Hq C']].
  destruct (S q) eqn:Eq; [lra|].
  apply (Hedge p q Hp Hq C'). apply NNPP; intros HPq.
  apply (HS q Hq) in HPq. congruence.
Qed.

(** * Formation.v : the goal (3)-(4) is an equilibrium of the closed loop (13)-(14).
    Idea: in the formation every error is 0, so every tanh is tanh 0 = 0 and no vehicle is pushed or turned;
    a fleet that rests there stays there for all times.  Its distance to the formation is 0.  Then a way to write down
    states off the formation by their errors. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus.
Open Scope R_scope.

Lemma formation_zx : forall F i, zx F (formation F) i = 0.
Proof. intros F i. unfold zx, formation. simpl. ring. Qed.

Lemma formation_zy : forall F i, zy F (formation F) i = 0.
Proof. intros F i. unfold zy, formation. simpl. ring. Qed.

Lemma formation_tha : forall F i, tha F (formation F) i = 0.
Proof. intros F i. unfold tha, formation. simpl. ring. Qed.

Lemma coupling_of_zeros : forall F scale z, (forall i, z i = 0) -> forall i, coupling F scale z i = 0.
Proof.
  intros F scale z Hz i. unfold coupling. rewrite Hz.
  rewrite (sum_zero (N F)).
  - unfold Rdiv. rewrite Rmult_0_l, tanh_0. ring.
  - intros j _. rewrite (Hz j). unfold Rdiv. rewrite Rminus_0_r, Rmult_0_l, tanh_0. ring.
Qed.

Lemma formation_u_v : forall F i, u_v F (formation F) i = 0.
Proof.
  intros F i. unfold u_v, along, ex, ey.
  rewrite (coupling_of_zeros F (ls F) (zx F (formation F)) (formation_zx F) i).
  rewrite (coupling_of_zeros F (ls F) (zy F (formation F)) (formation_zy F) i).
  simpl. unfold Rdiv. rewrite Rmult_0_l, tanh_0. ring.
Qed.

Lemma formation_u_w : forall F t i, u_w F t (formation F) i = 0.
Proof.
  intros F t i. unfold u_w, across, ex, ey, eth.
  rewrite (coupling_of_zeros F (ls F) (zx F (formation F)) (formation_zx F) i).
  rewrite (coupling_of_zeros F (ls F) (zy F (formation F)) (formation_zy F) i).
  rewrite (coupling_of_zeros F (rs F) (tha F (formation F)) (formation_tha F) i).
  simpl. unfold Rdiv. rewrite Rmult_0_l, tanh_0. ring.
Qed.

(** A fleet at rest that nothing pushes or turns stays where it is. *)
Lemma rest_is_a_solution : forall F t0 s,
  (forall i, (i < N F)%nat -> v s i = 0 /\ om s i = 0 /\ u_v F s i = 0 /\ forall t, t0 <= t -> u_w F t s i = 0) ->
  solution F t0 (fun _ => s).
Proof.
  intros F t0 s Hrest i Hi t Ht. destruct (Hrest i Hi) as (Hv & Hom & Huv & Huw).
  rewrite Hv, Hom, Huv, (Huw t Ht). unfold Rdiv. rewrite !Rmult_0_l, !Rmult_0_r.
  split; [|split; [|split; [|split]]]; apply derive_const.
Qed.

Theorem formation_is_a_solution : forall F t0, solution F t0 (fun _ => formation F).
Proof.
  intros F t0. apply rest_is_a_solution. intros i _. split; [reflexivity|]. split; [reflexivity|].
  split; [apply formation_u_v|]. intros t _. apply formation_u_w.
Qed.

Theorem formation_has_no_error : forall F, err F (formation F) = 0.
Proof.
  intros F. unfold err. apply sum_zero. intros i _.
  rewrite formation_zx, formation_zy, formation_tha. simpl. rewrite Rabs_R0. ring.
Qed.

(** ** States off the formation *)
Lemma coupling_ext : forall F scale z z' i, (forall j, z j = z' j) -> coupling F scale z i = coupling F scale z' i.
Proof.
  intros F scale z z' i Hz. unfold coupling. rewrite (Hz i). f_equal.
  apply sum_ext. intros j _. rewrite (Hz j). reflexivity.
Qed.

Lemma displaced_zx : forall F dx dy heading speed turn i, zx F (displaced F dx dy heading speed turn) i = dx i.
Proof. intros F dx dy heading speed turn i. unfold zx, displaced. simpl. ring. Qed.

Lemma displaced_zy : forall F dx dy heading speed turn i, zy F (displaced F dx dy heading speed turn) i = dy i.
Proof. intros F dx dy heading speed turn i. unfold zy, displaced. simpl. ring. Qed.

Lemma displaced_ex : forall F dx dy heading speed turn i,
  ex F (displaced F dx dy heading speed turn) i = coupling F (ls F) dx i.
Proof.
  intros F dx dy heading speed turn i. unfold ex. apply coupling_ext. apply displaced_zx.
Qed.

Lemma displaced_ey : forall F dx dy heading speed turn i,
  ey F (displaced F dx dy heading speed turn) i = coupling F (ls F) dy i.
Proof.
  intros F dx dy heading speed turn i. unfold ey. apply coupling_ext. apply displaced_zy.
Qed.

(** Where all vehicles agree, only the leader pulls. *)
Lemma coupling_of_agreement : forall F x i, coupling F 1 (fun _ => x) i = al F i * tanh x.
Proof.
  intros F x i. unfold coupling. rewrite (sum_zero (N F)).
  - unfold Rdiv. rewrite Rinv_1, Rmult_1_r. ring.
  - intros j _. rewrite Rminus_diag_eq by reflexivity. unfold Rdiv. rewrite Rmult_0_l, tanh_0. ring.
Qed.

(** * PaperErrorTorque.v : the bound of u_w in the saturation paragraph is exceeded.
    There ubar_w omits sqrt2 k psibar a_il, which Proposition 1 has.  Idea: vehicle 2, led with weight 10, far off in
    place and heading and spinning at 40 rad/s: its u_w is above 180, the paragraph promises at most 146.02. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics Sums Torques Saturations Formation PaperFleet PaperWitness.
Open Scope R_scope.

Lemma paragraph_number : forall i, i = 1%nat \/ i = 3%nat ->
  14601 / 100 < ubar_w_of_the_paragraph paper_fleet i < 14602 / 100.
Proof.
  intros i Hi. unfold ubar_w_of_the_paragraph.
  destruct Hi as [-> | ->]; rewrite paper_degrees by repeat constructor; cbn; split; interval.
Qed.

Lemma proposition_1_number : forall i, i = 1%nat \/ i = 3%nat ->
  18041 / 100 < ubar_w paper_fleet i < 18042 / 100.
Proof.
  intros i Hi. unfold ubar_w.
  destruct Hi as [-> | ->]; rewrite paper_degrees by repeat constructor; cbn; split; interval.
Qed.

Definition only_vehicle (n : nat) (x other : R) (i : nat) : R := if Nat.eqb i n then x else other.

(** Place error (-40, 40) m, heading perpendicular to it and five half turns behind the leader's, w = -40 rad/s. *)
Definition spinning (n : nat) : state :=
  displaced paper_fleet (only_vehicle n (-40) 0) (only_vehicle n 40 0)
    (only_vehicle n (PI / 4 - 4 * PI) (5 * PI / 4)) (fun _ => 0) (only_vehicle n (-40) 0).

Lemma spinning_u_w : forall i, i = 1%nat \/ i = 3%nat -> 18041 / 100 < u_w paper_fleet (PI / 5) (spinning i) i.
Proof.
  intros i Hi. unfold u_w, across, spinning. rewrite displaced_ex, displaced_ey. unfold eth, coupling, tha.
  pose proof psi_at_its_peak as Hpsi. set (p := paper_psi (PI / 5)) in *.
  assert (Hturned : 8 <= 5 * PI) by interval.
  destruct Hi as [-> | ->]; unfold paper_fleet; cbn -[PI paper_psi]; fold p; clearbody p;
    rewrite <- (sin_period (PI / 4 - 4 * PI) 2), <- (cos_period (PI / 4 - 4 * PI) 2);
    replace (PI / 4 - 4 * PI + 2 * INR 2 * PI) with (PI / 4) by (simpl; ring);
    pose proof (far_is_saturated 40 ltac:(lra)) as Hfar; set (t := tanh 40) in *; tanh_of 40 t; clearbody t;
    pose proof (far_is_saturated (5 * PI) Hturned) as Hback; set (b := tanh (5 * PI)) in *; tanh_of (5 * PI) b; clearbody b;
    rewrite sin_PI4, cos_PI4; interval.
Qed.

(** Vehicles 2 and 4 of the paper: more than 34 N m above the paragraph's bound. *)
Theorem paragraph_bound_is_exceeded : forall i, i = 1%nat \/ i = 3%nat ->
  exists t s, 0 <= t /\ ubar_w_of_the_paragraph paper_fleet i + 34 < Rabs (u_w paper_fleet t s i).
Proof.
  intros i Hi. exists (PI / 5), (spinning i). pose proof PI_RGT_0.
  pose proof (paragraph_number i Hi). pose proof (spinning_u_w i Hi).
  pose proof (Rle_abs (u_w paper_fleet (PI / 5) (spinning i) i)). split; lra.
Qed.

(** Proposition 1's ubar_w is right, for every fleet: vehicles 2 and 4 of the paper have 180.42. *)
Theorem proposition_1_bound_holds : forall F t s i, A1 F -> A2 F -> A3 F -> (i < N F)%nat -> 0 <= t ->
  Rabs (u_w F t s i) < ubar_w F i.
Proof.
  intros F t s i HA1 HA2 HA3 Hi Ht.
  pose proof (turn_pull_bound F t s i HA1 HA2 HA3 Hi Ht) as Hpull.
  destruct HA2 as [_ [_ HA2]]. destruct (HA2 i Hi) as (_ & _ & _ & _ & _ & _ & _ & Hdw & _).
  assert (Hdamping : Rabs (dw F i * tanh (om s i / ws F i)) < dw F i).
  { rewrite Rabs_mult, (Rabs_pos_eq (dw F i)) by lra. pose proof (tanh_abs_lt_1 (om s i / ws F i)). nra. }
  unfold ubar_w, cmax in *. apply Rabs_le_between in Hpull.
  apply Rabs_def2 in Hdamping. apply Rabs_def1; unfold u_w; lra.
Qed.

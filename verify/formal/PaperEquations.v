(** * PaperEquations.v : the motions of Statement.v are those of the vehicles (1)-(2) under the torques (6), and with all
    scales 1 the controller is the paper's (7)-(11), word for word.
    Idea: (6) inverts (2); dividing by 1 changes nothing, and the leader's pose cancels in the difference of two errors.
    Here zbar = (xbar, ybar) is a vehicle's place less its place in the formation, as in the paper. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums.
Open Scope R_scope.

(** (6) inverts (2): what the torques of the controller do to the vehicles is the closed loop of the theorem. *)
Theorem equations_1_2 : forall F t0 X, A2 F -> (solution F t0 X <-> vehicles_under_torques F t0 X).
Proof.
  intros F t0 X [_ [_ HA2]].
  assert (E : forall t s i, (i < N F)%nat ->
    1 / wr F i * (torque_plus F t s i + torque_minus F t s i) = u_v F s i /\
    1 / wr F i * (arm F i * torque_plus F t s i - arm F i * torque_minus F t s i) = u_w F t s i).
  { intros t s i Hi. destruct (HA2 i Hi) as (_ & _ & Hwr & Harm & _).
    unfold torque_plus, torque_minus. split; field; split; lra. }
  split; intros H i Hi t Ht; specialize (H i Hi t Ht); cbv zeta in *;
    destruct (E t (X t) i Hi) as [Ev Ew]; rewrite Ev, Ew in *; exact H.
Qed.

Lemma coupling_unit : forall F z zbar zl i, (forall j, z j = zbar j - zl) ->
  coupling F 1 z i = al F i * tanh (zbar i - zl) + sum (N F) (fun j => a F i j * tanh (zbar i - zbar j)).
Proof.
  intros F z zbar zl i Hz. unfold coupling. f_equal.
  - rewrite Hz. f_equal. f_equal. field.
  - apply sum_ext. intros j _. rewrite (Hz i), (Hz j). f_equal. f_equal. field.
Qed.

(** (8), coordinate by coordinate. *)
Theorem equation_8_x : forall F s i, unit_scales F ->
  ex F s i = al F i * tanh (xbar F s i - leadx F) + sum (N F) (fun j => a F i j * tanh (xbar F s i - xbar F s j)).
Proof.
  intros F s i [Hls _]. unfold ex. rewrite Hls. apply coupling_unit. intros j. reflexivity.
Qed.

Theorem equation_8_y : forall F s i, unit_scales F ->
  ey F s i = al F i * tanh (ybar F s i - leady F) + sum (N F) (fun j => a F i j * tanh (ybar F s i - ybar F s j)).
Proof.
  intros F s i [Hls _]. unfold ey. rewrite Hls. apply coupling_unit. intros j. reflexivity.
Qed.

(** (10) *)
Theorem equation_10 : forall F s i, unit_scales F ->
  eth F s i = al F i * tanh (th s i - leadth F) + sum (N F) (fun j => a F i j * tanh (th s i - th s j)).
Proof.
  intros F s i [_ [Hrs _]]. unfold eth. rewrite Hrs. apply coupling_unit. intros j. reflexivity.
Qed.

(** (7): minus p_v times the error along the heading phi, minus damping. *)
Theorem equation_7 : forall F s i, unit_scales F -> (i < N F)%nat ->
  u_v F s i = - pv F i * (cos (th s i) * ex F s i + sin (th s i) * ey F s i) - dv F i * tanh (v s i).
Proof.
  intros F s i [_ [_ Hunit]] Hi. destruct (Hunit i Hi) as [Hss _].
  unfold u_v, along. rewrite Hss. unfold Rdiv. rewrite Rinv_1, Rmult_1_r. reflexivity.
Qed.

(** (9) with alpha of (11): k psi(t) times the error along phi_perp = (- sin, cos). *)
Theorem equation_9_11 : forall F t s i, unit_scales F -> (i < N F)%nat ->
  u_w F t s i = - pw F i * eth F s i - dw F i * tanh (om s i)
                + k F i * psi F i t * (- sin (th s i) * ex F s i + cos (th s i) * ey F s i).
Proof.
  intros F t s i [_ [_ Hunit]] Hi. destruct (Hunit i Hi) as [_ Hws].
  unfold u_w, across. rewrite Hws. unfold Rdiv. rewrite Rinv_1, Rmult_1_r. reflexivity.
Qed.

(** (6): the wheel torques; the lever arm is 2 R as printed. *)
Theorem equation_6 : forall F t s i R, arm F i = 2 * R ->
  torque_plus F t s i = wr F i / 2 * (u_v F s i + 1 / (2 * R) * u_w F t s i) /\
  torque_minus F t s i = wr F i / 2 * (u_v F s i - 1 / (2 * R) * u_w F t s i).
Proof.
  intros F t s i R Harm. unfold torque_plus, torque_minus. rewrite Harm.
  unfold Rdiv. rewrite !Rmult_1_l, !(Rmult_comm (/ (2 * R))). split; reflexivity.
Qed.

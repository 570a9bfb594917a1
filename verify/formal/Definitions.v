(** * Definitions.v : what the claims beside the theorem speak of; nothing is proved here.
    The formation itself, the paper's equations, energies, fleet and conditions, the printed formulas that are false, and the
    fleet with a constant psi.  The theorem needs none of it: Statement.v stands alone. *)
From Coq Require Import Reals.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement.
Open Scope R_scope.

(** ** The equilibrium, and states off it *)
(** Each vehicle at its place, with the leader's heading, at rest. *)
Definition formation (F : fleet) : state := {|
  px := fun i => offx F i + leadx F;  py := fun i => offy F i + leady F;
  th := fun _ => leadth F;  v := fun _ => 0;  om := fun _ => 0 |}.

(** The state with errors (dx_i, dy_i) of position, headings, speeds and turn rates as given. *)
Definition displaced (F : fleet) (dx dy heading speed turn : nat -> R) : state := {|
  px := fun i => offx F i + leadx F + dx i;  py := fun i => offy F i + leady F + dy i;
  th := heading;  v := speed;  om := turn |}.

(** ** The paper's equations *)
(** (1) and (2): the two wheel torques accelerate the vehicle by their sum and turn it by their difference. *)
Definition vehicles_under_torques (F : fleet) (t0 : R) (X : R -> state) : Prop :=
  forall i, (i < N F)%nat -> forall t, t0 <= t ->
    let plus := torque_plus F t (X t) i in let minus := torque_minus F t (X t) i in
    is_derive (fun t => px (X t) i) t (cos (th (X t) i) * v (X t) i) /\
    is_derive (fun t => py (X t) i) t (sin (th (X t) i) * v (X t) i) /\
    is_derive (fun t => th (X t) i) t (om (X t) i) /\
    is_derive (fun t => v  (X t) i) t (1 / wr F i * (plus + minus) / m F i) /\
    is_derive (fun t => om (X t) i) t (1 / wr F i * (arm F i * plus - arm F i * minus) / J F i).

(** All scales 1: the paper's own controller.  zbar = (xbar, ybar): a vehicle's place less its place in the formation. *)
Definition unit_scales (F : fleet) : Prop :=
  ls F = 1 /\ rs F = 1 /\ forall i, (i < N F)%nat -> ss F i = 1 /\ ws F i = 1.
Definition xbar (F : fleet) (s : state) i := px s i - offx F i.
Definition ybar (F : fleet) (s : state) i := py s i - offy F i.

(** ** The energies V of (17) and W of (19), with scales *)
(** The potential of errors z whose gradient is the coupling: sums of scale ln cosh (z / scale) over links. *)
Definition potential (F : fleet) (scale : R) (z : nat -> R) : R :=
  sum (N F) (fun i => al F i * scale * ln (cosh (z i / scale)))
  + / 2 * sum (N F) (fun i => sum (N F) (fun j => a F i j * scale * ln (cosh ((z i - z j) / scale)))).
Definition V (F : fleet) (s : state) : R :=
  sum (N F) (fun i => m F i / pv F i * (v s i) ^ 2 / 2)
  + potential F (ls F) (zx F s) + potential F (ls F) (zy F s).
Definition W (F : fleet) (s : state) : R :=
  sum (N F) (fun i => J F i / pw F i * (om s i) ^ 2 / 2) + potential F (rs F) (tha F s).

(** Torque of the excitation; and by how much the damping makes V and W fall: powers over p_v and p_omega. *)
Definition alpha (F : fleet) (t : R) (s : state) (i : nat) : R := k F i * psi F i t * across F s i.
Definition Pv (F : fleet) (s : state) : R := sum (N F) (fun i => dv F i / pv F i * (v s i * tanh (v s i / ss F i))).
Definition Pw (F : fleet) (s : state) : R := sum (N F) (fun i => dw F i / pw F i * (om s i * tanh (om s i / ws F i))).

(** The derivative of W according to (20), with the controller's own alpha. *)
Definition W_rate (F : fleet) (t : R) (s : state) : R :=
  - Pw F s + sum (N F) (fun i => om s i * alpha F t s i / pw F i).

(** ** The paper's own fleet *)
(** Two things are readings: psi has 4/((2k-1) pi) where the text prints 4/(2k-1) pi, with which (15) would fail; and Fig. 2,
    which is a picture, is taken as the ring 1-2-3-4-5-6-1 with chord 2-4, weights 1, and leader weight 10 to vehicles 2 and 4.
    Vehicle 1 of the paper is number 0 here. *)
Definition paper_psi (t : R) : R :=
  5 / 4 + 4 / PI * (sin (t / 2) + sin (3 * t / 2) / 3 + sin (5 * t / 2) / 5
                    + sin (7 * t / 2) / 7 + sin (9 * t / 2) / 9).
Definition paper_dpsi (t : R) : R :=
  2 / PI * (cos (t / 2) + cos (3 * t / 2) + cos (5 * t / 2) + cos (7 * t / 2) + cos (9 * t / 2)).
Definition paper_ddpsi (t : R) : R :=
  - (1 / PI) * (sin (t / 2) + 3 * sin (3 * t / 2) + 5 * sin (5 * t / 2)
                + 7 * sin (7 * t / 2) + 9 * sin (9 * t / 2)).
Definition paper_edge (i j : nat) : R :=
  match i, j with
  | 0, 1 | 1, 0 | 1, 2 | 2, 1 | 2, 3 | 3, 2 | 3, 4 | 4, 3 | 4, 5 | 5, 4 | 5, 0 | 0, 5 | 1, 3 | 3, 1 => 1%R
  | _, _ => 0%R
  end%nat.

(** One value for vehicles 1 and 2, one for 3 and 4, one for 5 and 6 (Table 1). *)
Definition by_pair (p q r : R) (i : nat) : R :=
  match i with 0%nat | 1%nat => p | 2%nat | 3%nat => q | _ => r end.

(** One value for the vehicles without a leader link, one for 2 and 4 that have it. *)
Definition by_link (p q : R) (i : nat) : R := match i with 1%nat | 3%nat => q | _ => p end.

(** The fleet of the paper with any excitation, its two derivatives, the bounds b0, b1, b2 of the three, and window and
    level of (12); then with the paper's own.  Tables 1 and 2, the gains of Section 4, arm = 2 R. *)
Definition paper_fleet_excited_by (p dp ddp : R -> R) (b0 b1 b2 window level : R) : fleet := {|
  N := 6;
  a := paper_edge;  al := by_link 0 10;
  offx := fun i => match i with 0%nat => -5 | 1%nat => - (5 / 2) | 2%nat => 0 | 3%nat => 5 / 2 | 4%nat => 5 | _ => 0 end;
  offy := fun i => match i with 1%nat | 3%nat => 2 | 2%nat => 7 | _ => -3 end;
  leadx := -25;  leady := -25;  leadth := 5 * PI / 4;
  m := by_pair 10 36 23;  J := by_pair 3 (15625 / 1000) (93125 / 10000);
  wr := by_pair (5 / 100) (15 / 100) (10 / 100);  arm := by_pair (2 * (3 / 10)) (2 * (35 / 100)) (2 * (225 / 1000));
  pv := fun _ => 56;  dv := fun _ => 840;
  pw := by_link (28 / 10) (59 / 10);  dw := by_link 28 59;  k := by_link 3 1;
  ls := 1;  rs := 1;  ss := fun _ => 1;  ws := fun _ => 1;
  psi := fun _ => p;  dpsi := fun _ => dp;  ddpsi := fun _ => ddp;
  psi0 := b0;  psi1 := b1;  psi2 := b2;  T := window;  mu := level
|}.
Definition paper_fleet : fleet := paper_fleet_excited_by paper_psi paper_dpsi paper_ddpsi
  (24323283 / 10000000) (10 / PI) (25 / PI) (2 * PI) (20 / PI).

(** Table 1, N m. *)
Definition paper_torque_limit : nat -> R := by_pair 55 160 56.

(** ** The conditions of Proposition 1, as printed (unit scales, arm = 2 R) *)
(** The maximum inputs of Proposition 1. *)
Definition ubar_v (F : fleet) (i : nat) : R := dv F i + sqrt 2 * pv F i * deg F i.
Definition ubar_w (F : fleet) (i : nat) : R := dw F i + pw F i * deg F i + sqrt 2 * k F i * psi0 F * deg F i.
Definition condition_15 (F : fleet) : Prop := forall i, (i < N F)%nat ->
  sqrt 2 * k F i * psi0 F * deg F i / tanh 1 <= dw F i.
Definition condition_16 (F : fleet) (limit : nat -> R) : Prop := forall i, (i < N F)%nat ->
  arm F i * ubar_v F i + ubar_w F i < 2 * arm F i / wr F i * limit i.

(** ** What the paper prints and is false *)
(** The right-hand side of the first inequality after (20), as printed. *)
Definition printed_bound_after_20 (F : fleet) (s : state) : R :=
  - sum (N F) (fun i => 1 / pw F i *
      (dw F i * om s i * tanh (om s i) - om s i * (sqrt 2 * k F i * psi0 F * deg F i))).

(** ubar_w as the saturation paragraph prints it; Proposition 1's is [ubar_w]. *)
Definition ubar_w_of_the_paragraph (F : fleet) (i : nat) : R :=
  dw F i + pw F i * al F i + (pw F i + sqrt 2 * k F i * psi0 F) * (deg F i - al F i).

(** ** A constant psi *)
(** The paper's fleet with psi replaced by its mean; window and level as in (12), the level for psi. *)
Definition constant_fleet : fleet :=
  paper_fleet_excited_by (fun _ => 5 / 4) (fun _ => 0) (fun _ => 0) (5 / 4) 0 0 (2 * PI) (25 * PI / 8).

(** (A3), but with psi in place of psi' in (12). *)
Definition A3_of_psi (F : fleet) : Prop :=
  0 < T F /\ 0 < mu F /\
  forall i, (i < N F)%nat -> forall t, 0 <= t ->
    is_derive (psi F i) t (dpsi F i t) /\ is_derive (dpsi F i) t (ddpsi F i t) /\
    Rabs (psi F i t) <= psi0 F /\ Rabs (dpsi F i t) <= psi1 F /\ Rabs (ddpsi F i t) <= psi2 F /\
    mu F <= RInt (fun s => (psi F i s) ^ 2) t (t + T F).

(** Inverse of tanh on (-1, 1). *)
Definition atanh (y : R) : R := ln ((1 + y) / (1 - y)) / 2.

(** The pull across the heading that holds vehicles 2 and 4 turned: p_omega tanh turn / (k psi).  The others have no leader
    link, and neighbours with the same errors: they feel no pull. *)
Definition false_pull (turn : R) : R := 59 / 10 * tanh turn / (5 / 4).

(** Everybody: heading turned by [turn], the same place error across that heading, at rest. *)
Definition false_formation (turn : R) : state :=
  displaced constant_fleet
    (fun _ => atanh (- false_pull turn * sin (5 * PI / 4 + turn)))
    (fun _ => atanh (false_pull turn * cos (5 * PI / 4 + turn)))
    (fun _ => 5 * PI / 4 + turn) (fun _ => 0) (fun _ => 0).

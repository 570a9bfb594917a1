(** * PaperErrorRotationalEnergy.v : "for all |w_i| >= 1 we have W' <= 0" is false although (15) holds.
    The paper's step adds up as if every vehicle turned at 1 rad/s or more; what follows it needs some vehicle that does,
    since it is to bound each turn rate.  Idea: vehicle 1 turns at 1 rad/s, where (15)
    lets the damping win; vehicle 2 turns at 0.5 rad/s only, where its alpha is stronger than tanh(0.5) of damping, and
    W rises.  The paper's gains, graph and psi, the controller's own alpha. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics Saturations EnergyDerivatives Formation PaperFleet PaperWitness.
Open Scope R_scope.

Definition vehicles_1_2 (x y other : R) (i : nat) : R := match i with 0%nat => x | 1%nat => y | _ => other end.

(** Place errors (40, -40) m of vehicle 1 and (-40, 40) m of vehicle 2, headings -3 pi/4 and pi/4, w = 1 and 0.5. *)
Definition turning_pair : state :=
  displaced paper_fleet (vehicles_1_2 40 (-40) 0) (vehicles_1_2 (-40) 40 0)
    (vehicles_1_2 (- 3 * PI / 4) (PI / 4) (5 * PI / 4)) (fun _ => 0) (vehicles_1_2 1 (5 / 10) 0).

Lemma turning_pair_W_rate : 1233 / 1000 < W_rate paper_fleet (PI / 5) turning_pair < 1235 / 1000.
Proof.
  unfold W_rate, Pw, turning_pair, paper_fleet. cbn [sum N paper_fleet_excited_by].
  rewrite !displaced_alpha. unfold coupling. cbn -[PI paper_psi]. rewrite !Rmult_0_l.
  replace (1 / 1) with 1 by field. replace (5 / 10 / 1) with (5 / 10) by field.
  assert (H1 : 76159 / 100000 <= tanh 1 <= 76160 / 100000) by (unfold tanh, sinh, cosh; split; interval).
  assert (H5 : 46211 / 100000 <= tanh (5 / 10) <= 46212 / 100000) by (unfold tanh, sinh, cosh; split; interval).
  pose proof psi_at_its_peak as Hpsi. pose proof (far_is_saturated 40 ltac:(lra)) as Hfar.
  set (t1 := tanh 1) in *. set (t5 := tanh (5 / 10)) in *. set (p := paper_psi (PI / 5)) in *. set (t := tanh 40) in *.
  clearbody t1 t5 p. tanh_of 40 t. clearbody t.
  pose proof (far_is_saturated 80 ltac:(lra)) as Hfarther. set (t' := tanh 80) in *. tanh_of 80 t'. clearbody t'.
  replace (-3 * PI / 4) with (- (3 * (PI / 4))) by field. rewrite sin_neg, cos_neg, sin_3PI4, cos_3PI4, sin_PI4, cos_PI4.
  split; interval.
Qed.

Theorem rotational_energy_can_rise :
  condition_15 paper_fleet /\ condition_16 paper_fleet paper_torque_limit /\
  exists t s i, 0 <= t /\ (i < N paper_fleet)%nat /\ 1 <= Rabs (om s i) /\ 0 < W_rate paper_fleet t s.
Proof.
  destruct paper_fleet_meets_conditions_15_16 as [H15 H16]. split; [exact H15|]. split; [exact H16|].
  exists (PI / 5), turning_pair, 0%nat. pose proof PI_RGT_0. pose proof turning_pair_W_rate.
  split; [lra|]. split; [repeat constructor|]. split; [|lra].
  simpl. rewrite Rabs_pos_eq; lra.
Qed.

(** The same of a motion of the fleet: from that state on there is one, and at its start W is rising. *)
Theorem rotational_energy_rises_on_a_solution :
  exists t0 X l, 0 <= t0 /\ solution paper_fleet t0 X /\ 1 <= Rabs (om (X t0) 0%nat) /\
    is_derive (fun t => W paper_fleet (X t)) t0 l /\ 12 / 10 < l.
Proof.
  destruct (motion_at_the_peak turning_pair) as [X [Hstart [HX HW]]].
  exists (PI / 5), X, (W_rate paper_fleet (PI / 5) turning_pair). pose proof PI_RGT_0.
  split; [lra|]. split; [exact HX|]. split; [rewrite Hstart; simpl; rewrite Rabs_pos_eq; lra|].
  split; [exact HW|]. pose proof turning_pair_W_rate. lra.
Qed.

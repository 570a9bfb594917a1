(** * PaperErrorAfter20.v : the inequality printed after (20) is false (docs/theory.md, section 6).
    The paper bounds w alpha by w sqrt2 k psibar D; that holds for |w| only.  Idea: let vehicle 2 of the paper's fleet
    turn with w = -1 while alpha is near its least value -c (its place error is (40, -40) m, its heading pi/4, and psi is
    at its peak at t = pi/5): W' is -0.037, the printed "upper bound" is -15.195. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics Saturations EnergyDerivatives Formation PaperFleet PaperWitness.
Open Scope R_scope.

Definition only_vehicle_2 (x other : R) (i : nat) : R := match i with 1%nat => x | _ => other end.

Definition turning_back : state :=
  displaced paper_fleet (only_vehicle_2 40 0) (only_vehicle_2 (-40) 0) (only_vehicle_2 (PI / 4) (5 * PI / 4))
    (fun _ => 0) (only_vehicle_2 (-1) 0).

Lemma turning_back_W_rate : - 4 / 100 < W_rate paper_fleet (PI / 5) turning_back < - 3 / 100.
Proof.
  unfold W_rate, Pw, turning_back, paper_fleet. cbn [sum N paper_fleet_excited_by].
  rewrite !displaced_alpha. unfold coupling. cbn -[PI paper_psi]. rewrite !Rmult_0_l.
  replace (-1 / 1) with (- (1)) by field. rewrite tanh_odd.
  assert (H1 : 76159 / 100000 <= tanh 1 <= 76160 / 100000) by (unfold tanh, sinh, cosh; split; interval).
  pose proof psi_at_its_peak as Hpsi. pose proof (far_is_saturated 40 ltac:(lra)) as Hfar.
  set (t1 := tanh 1) in *. set (p := paper_psi (PI / 5)) in *. set (t := tanh 40) in *.
  clearbody t1 p. tanh_of 40 t. clearbody t. rewrite sin_PI4, cos_PI4.
  split; interval.
Qed.

Lemma turning_back_printed : - 1520 / 100 < printed_bound_after_20 paper_fleet turning_back < - 1519 / 100.
Proof.
  unfold printed_bound_after_20. change (N paper_fleet) with 6%nat. cbn [sum].
  rewrite !paper_degrees by repeat constructor. cbn. rewrite !Rmult_0_l, !Rmult_0_r, !Rmult_0_l.
  replace (tanh (-1)) with (- tanh 1) by (rewrite <- tanh_odd; f_equal; ring).
  assert (H1 : 76159 / 100000 <= tanh 1 <= 76160 / 100000) by (unfold tanh, sinh, cosh; split; interval).
  set (t1 := tanh 1) in *. clearbody t1. split; interval.
Qed.

Theorem inequality_after_20_is_false :
  ~ (forall t s, 0 <= t -> W_rate paper_fleet t s <= printed_bound_after_20 paper_fleet s).
Proof.
  intros Hprinted. specialize (Hprinted (PI / 5) turning_back).
  pose proof turning_back_W_rate. pose proof turning_back_printed. pose proof PI_RGT_0.
  assert (0 <= PI / 5) by lra. lra.
Qed.

(** The same of a motion of the fleet: from that state on there is one, and at its start W' exceeds the bound by 15. *)
Theorem inequality_after_20_is_false_on_a_solution :
  exists t0 X l, 0 <= t0 /\ solution paper_fleet t0 X /\ is_derive (fun t => W paper_fleet (X t)) t0 l /\
    printed_bound_after_20 paper_fleet (X t0) + 15 < l.
Proof.
  destruct (motion_at_the_peak turning_back) as [X [Hstart [HX HW]]].
  exists (PI / 5), X, (W_rate paper_fleet (PI / 5) turning_back). pose proof PI_RGT_0.
  split; [lra|]. split; [exact HX|]. split; [exact HW|].
  rewrite Hstart. pose proof turning_back_W_rate. pose proof turning_back_printed. lra.
Qed.

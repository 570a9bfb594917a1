(** * ConstantExcitation.v : (12) must be asked of psi', as the paper does; of psi it is not enough.
    A constant psi is persistently exciting in the sense of the integral of psi^2.  Idea: with psi at its mean 5/4 the
    paper's fleet can rest off the formation: all six vehicles share one place error across a heading that is turned by a
    little angle, and the pull psi makes of that error holds the heading turned.  Such places begin at the goal itself.
    So attractivity is false without psi', although (15) and (16) hold. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics Sums Saturations Calculus Formation PaperFleet PaperWitness.
Open Scope R_scope.

Lemma constant_psi_is_exciting : A3_of_psi constant_fleet.
Proof.
  pose proof PI_RGT_0 as Hpi. split; [simpl; lra|]. split; [simpl; lra|].
  intros i Hi t Ht. cbn [psi dpsi ddpsi psi0 psi1 psi2 mu T constant_fleet paper_fleet_excited_by].
  split; [apply derive_const|]. split; [apply derive_const|].
  rewrite (Rabs_pos_eq (5 / 4)) by lra. rewrite Rabs_R0.
  split; [lra|]. split; [lra|]. split; [lra|].
  rewrite RInt_const. unfold scal. simpl. unfold mult. simpl. lra.
Qed.

Lemma false_formation_turn : forall turn i, eth constant_fleet (false_formation turn) i = by_link 0 10 i * tanh turn.
Proof.
  intros turn i. unfold eth. rewrite (coupling_ext _ _ _ (fun _ => turn)).
  - apply coupling_of_agreement.
  - intros j. unfold tha. simpl. ring.
Qed.

Lemma small_share : forall b x, Rabs b < 1 -> -1 <= x <= 1 -> -1 < b * x < 1.
Proof.
  intros b x Hb Hx. assert (Hx1 : Rabs x <= 1) by (apply Rabs_le; exact Hx).
  pose proof (Rabs_pos b). assert (Habs : Rabs (b * x) < 1) by (rewrite Rabs_mult; nra).
  apply Rabs_def2 in Habs. lra.
Qed.

Section FalseEquilibrium.
Variable turn : R.
Hypothesis little : Rabs (false_pull turn) < 1.

Lemma false_ex : forall i,
  ex constant_fleet (false_formation turn) i = by_link 0 10 i * (- false_pull turn * sin (5 * PI / 4 + turn)).
Proof.
  intros i. unfold false_formation. rewrite displaced_ex. change (ls constant_fleet) with 1.
  rewrite coupling_of_agreement. unfold atanh. rewrite tanh_onto; [reflexivity|].
  apply small_share; [rewrite Rabs_Ropp; exact little|apply SIN_bound].
Qed.

Lemma false_ey : forall i,
  ey constant_fleet (false_formation turn) i = by_link 0 10 i * (false_pull turn * cos (5 * PI / 4 + turn)).
Proof.
  intros i. unfold false_formation. rewrite displaced_ey. change (ls constant_fleet) with 1.
  rewrite coupling_of_agreement. unfold atanh. rewrite tanh_onto; [reflexivity|].
  apply small_share; [exact little|apply COS_bound].
Qed.

Lemma false_u_v : forall i, u_v constant_fleet (false_formation turn) i = 0.
Proof.
  intros i. unfold u_v, along. rewrite false_ex, false_ey. simpl.
  unfold Rdiv. rewrite Rmult_0_l, tanh_0. ring.
Qed.

Lemma false_u_w : forall t i, (i < 6)%nat -> u_w constant_fleet t (false_formation turn) i = 0.
Proof.
  intros t i Hi. unfold u_w, across. rewrite false_ex, false_ey, false_formation_turn.
  change (th (false_formation turn) i) with (5 * PI / 4 + turn). change (om (false_formation turn) i) with 0.
  replace (0 / ws constant_fleet i) with 0 by (unfold Rdiv; ring). rewrite tanh_0.
  pose proof (sin2_cos2 (5 * PI / 4 + turn)) as Hone. unfold Rsqr in Hone.
  set (x := sin (5 * PI / 4 + turn)) in *. set (y := cos (5 * PI / 4 + turn)) in *.
  replace (k constant_fleet i * psi constant_fleet i t *
    (- x * (by_link 0 10 i * (- false_pull turn * x)) + y * (by_link 0 10 i * (false_pull turn * y))))
    with (k constant_fleet i * psi constant_fleet i t * by_link 0 10 i * false_pull turn * (x * x + y * y)) by ring.
  rewrite Hone. unfold false_pull. revert i Hi.
  refine (six_cases _ _ _ _ _ _ _); cbn; field.
Qed.

Theorem false_formation_is_a_solution : forall t0, solution constant_fleet t0 (fun _ => false_formation turn).
Proof.
  intros t0. apply rest_is_a_solution. intros i Hi. split; [reflexivity|]. split; [reflexivity|].
  split; [apply false_u_v|]. intros t _. apply false_u_w. exact Hi.
Qed.
End FalseEquilibrium.

(** A turn of 0.2 rad is little enough; the six headings alone are an error of 1.2. *)
Lemma fifth_of_a_radian : Rabs (false_pull (2 / 10)) < 1.
Proof. unfold false_pull, tanh, sinh, cosh. apply Rabs_def1; interval. Qed.

Lemma false_formation_error : 12 / 10 <= err constant_fleet (false_formation (2 / 10)).
Proof.
  assert (Hterm : forall i, 2 / 10 <= Rabs (zx constant_fleet (false_formation (2 / 10)) i)
    + Rabs (zy constant_fleet (false_formation (2 / 10)) i) + Rabs (tha constant_fleet (false_formation (2 / 10)) i)
    + Rabs (v (false_formation (2 / 10)) i) + Rabs (om (false_formation (2 / 10)) i)).
  { intros i. set (s := false_formation (2 / 10)).
    replace (tha constant_fleet s i) with (2 / 10) by (unfold tha; simpl; ring).
    rewrite (Rabs_pos_eq (2 / 10)) by lra.
    pose proof (Rabs_pos (zx constant_fleet s i)). pose proof (Rabs_pos (zy constant_fleet s i)).
    pose proof (Rabs_pos (v s i)). pose proof (Rabs_pos (om s i)). lra. }
  apply Rle_trans with (sum 6 (fun _ => 2 / 10)); [simpl; lra|].
  unfold err. apply sum_le. intros i _. apply Hterm.
Qed.

(** Without a turn it is the formation: the false ones begin there. *)
Theorem false_formations_begin_at_the_goal : err constant_fleet (false_formation 0) = 0.
Proof.
  assert (Hpull : false_pull 0 = 0) by (unfold false_pull; rewrite tanh_0; field).
  assert (Hplace : atanh 0 = 0).
  { unfold atanh. replace ((1 + 0) / (1 - 0)) with 1 by field. rewrite ln_1. field. }
  unfold err. apply sum_zero. intros i _. unfold false_formation. rewrite displaced_zx, displaced_zy.
  rewrite Hpull, Ropp_0, !Rmult_0_l, Hplace. unfold tha. simpl.
  replace (5 * PI / 4 + 0 - 5 * PI / 4) with 0 by ring. rewrite Rabs_R0. ring.
Qed.

(** A constant psi, exciting in itself: the fleet can rest off the formation for ever, so the formation does not
    attract. *)
Theorem constant_psi_leaves_a_false_equilibrium : exists s, 0 < err constant_fleet s /\
  forall t0, solution constant_fleet t0 (fun _ => s).
Proof.
  exists (false_formation (2 / 10)). split.
  - pose proof false_formation_error. lra.
  - intros t0. apply false_formation_is_a_solution. exact fifth_of_a_radian.
Qed.

Theorem constant_psi_is_not_enough :
  A1 constant_fleet /\ A2 constant_fleet /\ A3_of_psi constant_fleet /\
  condition_15 constant_fleet /\ condition_16 constant_fleet paper_torque_limit /\ ~ uniformly_attractive constant_fleet.
Proof.
  split; [apply paper_graph|]. split; [apply paper_parameters|]. split; [exact constant_psi_is_exciting|].
  split; [apply paper_conditions; lra|]. split; [apply paper_conditions; lra|].
  intros Hattractive. destruct constant_psi_leaves_a_false_equilibrium as [s [Herror Hrest]].
  destruct (Hattractive (err constant_fleet s) (err constant_fleet s / 2)) as [tau Htau]; [lra|lra|].
  assert (Hsmall : err constant_fleet s <= err constant_fleet s / 2); [|lra].
  apply (Htau 0 (fun _ => s)) with (t := Rmax 0 (0 + tau)); [lra|apply Hrest|lra|apply Rmax_r].
Qed.

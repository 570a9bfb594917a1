(** * Claims.v : everything that is claimed, word for word, and what each theorem assumes.
    Coq refuses this file where a theorem does not say what stands here, and prints every axiom that the proofs use.
    Allowed are those of the standard real numbers, classical logic and functional extensionality: nothing else may appear.
    Nothing of the project is imported, so that every name below means what its file defines. *)
From Coq Require Import Reals.
From Coquelicot Require Import Coquelicot.
Require Gaincert.Statement Gaincert.Theorem Gaincert.Existence Gaincert.Uniqueness Gaincert.TorqueSharp
  Gaincert.NotExponential Gaincert.Definitions Gaincert.Formation Gaincert.PaperEquations Gaincert.PaperFleet
  Gaincert.PaperProposition1 Gaincert.PaperWitness Gaincert.PaperConclusion Gaincert.PaperErrorAfter20 Gaincert.PaperErrorRotationalEnergy
  Gaincert.PaperErrorTorque Gaincert.ConstantExcitation.
Module S := Gaincert.Statement. (* S.x is x of Statement.v *)
Module D := Gaincert.Definitions.
Open Scope R_scope.

(** ** The theorem, and what is stated beside it (Statement.v) *)
Definition corrected_theorem_holds : S.corrected_theorem
  := @Gaincert.Theorem.corrected_theorem_holds.
Print Assumptions corrected_theorem_holds.
Definition existence_holds : S.existence
  := @Gaincert.Existence.existence_holds.
Print Assumptions existence_holds.
Definition uniqueness_holds : S.uniqueness
  := @Gaincert.Uniqueness.uniqueness_holds.
Print Assumptions uniqueness_holds.
Definition torque_sharp_holds : S.torque_sharp
  := @Gaincert.TorqueSharp.torque_sharp_holds.
Print Assumptions torque_sharp_holds.
Definition not_exponential_holds : S.not_exponential
  := @Gaincert.NotExponential.not_exponential_holds.
Print Assumptions not_exponential_holds.

(** ** The formation is an equilibrium *)
Definition formation_is_a_solution : forall F t0, S.solution F t0 (fun _ => D.formation F)
  := @Gaincert.Formation.formation_is_a_solution.
Print Assumptions formation_is_a_solution.
Definition formation_has_no_error : forall F, S.err F (D.formation F) = 0
  := @Gaincert.Formation.formation_has_no_error.
Print Assumptions formation_has_no_error.

(** ** The equations are the paper's: (1), (2), (6), and at unit scales (7) to (11) *)
Definition equations_1_2 : forall F t0 X, S.A2 F -> (S.solution F t0 X <-> D.vehicles_under_torques F t0 X)
  := @Gaincert.PaperEquations.equations_1_2.
Print Assumptions equations_1_2.
Definition equation_6 : forall F t s i R, S.arm F i = 2 * R ->
  S.torque_plus F t s i = S.wr F i / 2 * (S.u_v F s i + 1 / (2 * R) * S.u_w F t s i) /\
  S.torque_minus F t s i = S.wr F i / 2 * (S.u_v F s i - 1 / (2 * R) * S.u_w F t s i)
  := @Gaincert.PaperEquations.equation_6.
Print Assumptions equation_6.
Definition equation_7 : forall F s i, D.unit_scales F -> (i < S.N F)%nat ->
  S.u_v F s i = - S.pv F i * (cos (S.th s i) * S.ex F s i + sin (S.th s i) * S.ey F s i) - S.dv F i * tanh (S.v s i)
  := @Gaincert.PaperEquations.equation_7.
Print Assumptions equation_7.
Definition equation_8_x : forall F s i, D.unit_scales F ->
  S.ex F s i = S.al F i * tanh (D.xbar F s i - S.leadx F)
                 + S.sum (S.N F) (fun j => S.a F i j * tanh (D.xbar F s i - D.xbar F s j))
  := @Gaincert.PaperEquations.equation_8_x.
Print Assumptions equation_8_x.
Definition equation_8_y : forall F s i, D.unit_scales F ->
  S.ey F s i = S.al F i * tanh (D.ybar F s i - S.leady F)
                 + S.sum (S.N F) (fun j => S.a F i j * tanh (D.ybar F s i - D.ybar F s j))
  := @Gaincert.PaperEquations.equation_8_y.
Print Assumptions equation_8_y.
Definition equation_9_11 : forall F t s i, D.unit_scales F -> (i < S.N F)%nat ->
  S.u_w F t s i = - S.pw F i * S.eth F s i - S.dw F i * tanh (S.om s i)
                  + S.k F i * S.psi F i t * (- sin (S.th s i) * S.ex F s i + cos (S.th s i) * S.ey F s i)
  := @Gaincert.PaperEquations.equation_9_11.
Print Assumptions equation_9_11.
Definition equation_10 : forall F s i, D.unit_scales F ->
  S.eth F s i = S.al F i * tanh (S.th s i - S.leadth F)
                + S.sum (S.N F) (fun j => S.a F i j * tanh (S.th s i - S.th s j))
  := @Gaincert.PaperEquations.equation_10.
Print Assumptions equation_10.

(** ** Proposition 1 of the paper *)
Definition proposition_1 : forall F limit, D.unit_scales F -> S.A1 F -> S.A2 F -> S.A3 F ->
  D.condition_15 F -> D.condition_16 F limit ->
  S.uniformly_bounded F /\ S.uniformly_stable F /\ S.uniformly_attractive F /\
  forall i t s, (i < S.N F)%nat -> 0 <= t ->
    Rabs (S.torque_plus F t s i) < limit i /\ Rabs (S.torque_minus F t s i) < limit i
  := @Gaincert.PaperProposition1.proposition_1.
Print Assumptions proposition_1.

(** ** The paper's own fleet *)
Definition paper_fleet_has_unit_scales : D.unit_scales D.paper_fleet
  := @Gaincert.PaperConclusion.paper_fleet_has_unit_scales.
Definition paper_fleet_meets_the_hypotheses : S.A1 D.paper_fleet /\ S.A2 D.paper_fleet /\ S.A3 D.paper_fleet
  := @Gaincert.PaperFleet.paper_fleet_meets_the_hypotheses.
Definition paper_fleet_meets_conditions_15_16 :
  D.condition_15 D.paper_fleet /\ D.condition_16 D.paper_fleet D.paper_torque_limit
  := @Gaincert.PaperWitness.paper_fleet_meets_conditions_15_16.
Definition paper_fleet_reaches_its_formation :
  S.uniformly_bounded D.paper_fleet /\ S.uniformly_stable D.paper_fleet /\ S.uniformly_attractive D.paper_fleet /\
  forall i t s, (i < 6)%nat -> 0 <= t ->
    Rabs (S.torque_plus D.paper_fleet t s i) < D.paper_torque_limit i /\
    Rabs (S.torque_minus D.paper_fleet t s i) < D.paper_torque_limit i
  := @Gaincert.PaperConclusion.paper_fleet_reaches_its_formation.

(** ** What the paper prints and is false, and what is true in its place *)
Definition inequality_after_20_is_false : ~ (forall t s, 0 <= t ->
  D.W_rate D.paper_fleet t s <= D.printed_bound_after_20 D.paper_fleet s)
  := @Gaincert.PaperErrorAfter20.inequality_after_20_is_false.
Definition inequality_after_20_is_false_on_a_solution : exists t0 X l, 0 <= t0 /\ S.solution D.paper_fleet t0 X /\
  is_derive (fun t => D.W D.paper_fleet (X t)) t0 l /\
  D.printed_bound_after_20 D.paper_fleet (X t0) + 15 < l
  := @Gaincert.PaperErrorAfter20.inequality_after_20_is_false_on_a_solution.
Definition rotational_energy_can_rise :
  D.condition_15 D.paper_fleet /\ D.condition_16 D.paper_fleet D.paper_torque_limit /\
  exists t s i, 0 <= t /\ (i < S.N D.paper_fleet)%nat /\ 1 <= Rabs (S.om s i) /\ 0 < D.W_rate D.paper_fleet t s
  := @Gaincert.PaperErrorRotationalEnergy.rotational_energy_can_rise.
Definition rotational_energy_rises_on_a_solution : exists t0 X l, 0 <= t0 /\ S.solution D.paper_fleet t0 X /\
  1 <= Rabs (S.om (X t0) 0%nat) /\
  is_derive (fun t => D.W D.paper_fleet (X t)) t0 l /\ 12 / 10 < l
  := @Gaincert.PaperErrorRotationalEnergy.rotational_energy_rises_on_a_solution.
Definition paragraph_bound_is_exceeded : forall i, i = 1%nat \/ i = 3%nat -> exists t s, 0 <= t /\
  D.ubar_w_of_the_paragraph D.paper_fleet i + 34 < Rabs (S.u_w D.paper_fleet t s i)
  := @Gaincert.PaperErrorTorque.paragraph_bound_is_exceeded.
Definition proposition_1_number : forall i, i = 1%nat \/ i = 3%nat ->
  18041 / 100 < D.ubar_w D.paper_fleet i < 18042 / 100
  := @Gaincert.PaperErrorTorque.proposition_1_number.
Definition proposition_1_bound_holds : forall F t s i, S.A1 F -> S.A2 F -> S.A3 F -> (i < S.N F)%nat -> 0 <= t ->
  Rabs (S.u_w F t s i) < D.ubar_w F i
  := @Gaincert.PaperErrorTorque.proposition_1_bound_holds.

(** ** (12) is needed of psi': with a constant psi the formation does not attract *)
Definition false_formations_begin_at_the_goal : S.err D.constant_fleet (D.false_formation 0) = 0
  := @Gaincert.ConstantExcitation.false_formations_begin_at_the_goal.
Definition false_formation_is_a_solution : forall turn, Rabs (D.false_pull turn) < 1 ->
  forall t0, S.solution D.constant_fleet t0 (fun _ => D.false_formation turn)
  := @Gaincert.ConstantExcitation.false_formation_is_a_solution.
Definition constant_psi_is_not_enough : let F := D.constant_fleet in
  S.A1 F /\ S.A2 F /\ D.A3_of_psi F /\
  D.condition_15 F /\ D.condition_16 F D.paper_torque_limit /\ ~ S.uniformly_attractive F
  := @Gaincert.ConstantExcitation.constant_psi_is_not_enough.

(** In one, since every print goes through the whole library of interval arithmetic. *)
Definition claims_of_the_paper :=
  (paper_fleet_has_unit_scales, paper_fleet_meets_the_hypotheses, paper_fleet_meets_conditions_15_16,
   paper_fleet_reaches_its_formation, inequality_after_20_is_false, inequality_after_20_is_false_on_a_solution,
   rotational_energy_can_rise, rotational_energy_rises_on_a_solution, paragraph_bound_is_exceeded,
   proposition_1_number, proposition_1_bound_holds, false_formations_begin_at_the_goal, false_formation_is_a_solution,
   constant_psi_is_not_enough).
Print Assumptions claims_of_the_paper.

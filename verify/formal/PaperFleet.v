(** * PaperFleet.v : sanity of the hypotheses (A1)-(A3): the paper's own fleet (Definitions.v) meets them.
    Idea: the 64 sets of vehicles are looked at one by one for (A1); psi is a polynomial in sin(t/2), which
    interval arithmetic bounds; the integral (12) is exactly 20/pi, because cos(n t) integrates to 0 over 2 pi. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Numerics.
Open Scope R_scope.

(** ** (A1): the graph *)
Lemma six_cases : forall (P : nat -> Prop),
  P 0%nat -> P 1%nat -> P 2%nat -> P 3%nat -> P 4%nat -> P 5%nat -> forall i, (i < 6)%nat -> P i.
Proof.
  intros P H0 H1 H2 H3 H4 H5 i Hi.
  destruct i as [|[|[|[|[|[|i]]]]]]; try assumption. lia.
Qed.

Lemma paper_weights : forall i j, (i < 6)%nat -> (j < 6)%nat ->
  paper_edge i j = paper_edge j i /\ 0 <= paper_edge i j.
Proof.
  intros i j Hi Hj. revert i Hi j Hj.
  refine (six_cases _ _ _ _ _ _ _); refine (six_cases _ _ _ _ _ _ _); simpl; split; lra.
Qed.

Lemma paper_cut : forall S : nat -> bool, (exists i, (i < 6)%nat /\ S i = true) ->
  0 < sum 6 (fun i => if S i then by_link 0 10 i + sum 6 (fun j => if S j then 0 else paper_edge i j) else 0).
Proof.
  intros S Hex.
  assert (Hsome : S 0%nat = true \/ S 1%nat = true \/ S 2%nat = true \/ S 3%nat = true \/ S 4%nat = true \/ S 5%nat = true).
  { destruct Hex as [i [Hi HS]]. destruct i as [|[|[|[|[|[|i]]]]]]; try tauto. lia. }
  clear Hex. cbn [sum paper_edge by_link].
  destruct (S 0%nat), (S 1%nat), (S 2%nat), (S 3%nat), (S 4%nat), (S 5%nat);
    solve [lra | exfalso; intuition discriminate].
Qed.

Lemma paper_graph : forall p dp ddp b0 b1 b2 window level,
  A1 (paper_fleet_excited_by p dp ddp b0 b1 b2 window level).
Proof.
  intros p dp ddp b0 b1 b2 window level.
  split; [|split].
  - exact paper_weights.
  - change (forall i, (i < 6)%nat -> 0 <= by_link 0 10 i). refine (six_cases _ _ _ _ _ _ _); simpl; lra.
  - exact paper_cut.
Qed.

(** ** (A2): everything that has to be positive is *)
Lemma paper_parameters : forall p dp ddp b0 b1 b2 window level,
  A2 (paper_fleet_excited_by p dp ddp b0 b1 b2 window level).
Proof.
  intros p dp ddp b0 b1 b2 window level.
  split; [simpl; lra|]. split; [simpl; lra|].
  change (N (paper_fleet_excited_by p dp ddp b0 b1 b2 window level)) with 6%nat.
  refine (six_cases _ _ _ _ _ _ _); simpl; repeat split; lra.
Qed.

(** ** (A3): derivatives, bounds and persistent excitation of psi *)
Lemma paper_psi_derivative : forall t, is_derive paper_psi t (paper_dpsi t).
Proof.
  intros t. unfold paper_psi, paper_dpsi. pose proof PI_RGT_0.
  auto_derive; [exact I|]. unfold Rdiv. field. lra.
Qed.

Lemma paper_dpsi_derivative : forall t, is_derive paper_dpsi t (paper_ddpsi t).
Proof.
  intros t. unfold paper_dpsi, paper_ddpsi. pose proof PI_RGT_0.
  auto_derive; [exact I|]. unfold Rdiv. field. lra.
Qed.

(** sin (n x) for n = 1, 3, 5, 7, 9 as a polynomial of sin x. *)
Lemma sin_step : forall p x, sin (p + 2 * x) = 2 * sin p * (1 - 2 * (sin x) ^ 2) - sin (p - 2 * x).
Proof.
  intros p x. rewrite sin_plus, sin_minus, cos_2a_sin. ring.
Qed.

Definition paper_wave (s : R) : R :=
  s + (3 * s - 4 * s ^ 3) / 3 + (5 * s - 20 * s ^ 3 + 16 * s ^ 5) / 5
  + (7 * s - 56 * s ^ 3 + 112 * s ^ 5 - 64 * s ^ 7) / 7
  + (9 * s - 120 * s ^ 3 + 432 * s ^ 5 - 576 * s ^ 7 + 256 * s ^ 9) / 9.

Lemma paper_psi_polynomial : forall t, paper_psi t = 5 / 4 + 4 / PI * paper_wave (sin (t / 2)).
Proof.
  intros t. unfold paper_psi, paper_wave. set (x := t / 2).
  assert (H1 : sin (- x) = - sin x) by apply sin_neg.
  assert (H3 : sin (3 * t / 2) = 3 * sin x - 4 * sin x ^ 3).
  { replace (3 * t / 2) with (x + 2 * x) by (unfold x; field).
    rewrite sin_step. replace (x - 2 * x) with (- x) by ring. rewrite H1. ring. }
  assert (H5 : sin (5 * t / 2) = 5 * sin x - 20 * sin x ^ 3 + 16 * sin x ^ 5).
  { replace (5 * t / 2) with (3 * t / 2 + 2 * x) by (unfold x; field).
    rewrite sin_step, H3. replace (3 * t / 2 - 2 * x) with x by (unfold x; field). ring. }
  assert (H7 : sin (7 * t / 2) = 7 * sin x - 56 * sin x ^ 3 + 112 * sin x ^ 5 - 64 * sin x ^ 7).
  { replace (7 * t / 2) with (5 * t / 2 + 2 * x) by (unfold x; field).
    rewrite sin_step, H5. replace (5 * t / 2 - 2 * x) with (3 * t / 2) by (unfold x; field). rewrite H3. ring. }
  assert (H9 : sin (9 * t / 2) = 9 * sin x - 120 * sin x ^ 3 + 432 * sin x ^ 5 - 576 * sin x ^ 7 + 256 * sin x ^ 9).
  { replace (9 * t / 2) with (7 * t / 2 + 2 * x) by (unfold x; field).
    rewrite sin_step, H7. replace (7 * t / 2 - 2 * x) with (5 * t / 2) by (unfold x; field). rewrite H5. ring. }
  rewrite H3, H5, H7, H9. reflexivity.
Qed.

Lemma paper_wave_bound : forall s, -1 <= s <= 1 ->
  -1 <= 5 / 4 + 4 / PI * paper_wave s <= 24323283 / 10000000.
Proof.
  intros s Hs. unfold paper_wave. split; interval_over s.
Qed.

Lemma paper_psi_bound : forall t, Rabs (paper_psi t) <= 24323283 / 10000000.
Proof.
  intros t. rewrite paper_psi_polynomial.
  destruct (paper_wave_bound (sin (t / 2)) (SIN_bound _)) as [Hlow Hup].
  apply Rabs_le. lra.
Qed.

(** The bound is tight: psi is within 1e-7 of it at t = pi/5. *)
Lemma paper_psi_peak : 24323282 / 10000000 < paper_psi (PI / 5).
Proof. unfold paper_psi. interval. Qed.

Lemma scaled_bound : forall c x b, 0 <= c -> - b <= x <= b -> Rabs (c * x) <= c * b.
Proof.
  intros c x b Hc Hx. rewrite Rabs_mult, (Rabs_pos_eq c Hc).
  apply Rmult_le_compat_l; [exact Hc|]. apply Rabs_le. exact Hx.
Qed.

Lemma paper_dpsi_bound : forall t, Rabs (paper_dpsi t) <= 10 / PI.
Proof.
  intros t. replace (10 / PI) with (2 / PI * 5) by (field; apply PI_neq0).
  apply scaled_bound.
  - pose proof PI_RGT_0. apply Rlt_le, Rdiv_lt_0_compat; lra.
  - pose proof (COS_bound (t / 2)). pose proof (COS_bound (3 * t / 2)). pose proof (COS_bound (5 * t / 2)).
    pose proof (COS_bound (7 * t / 2)). pose proof (COS_bound (9 * t / 2)). lra.
Qed.

Lemma paper_ddpsi_bound : forall t, Rabs (paper_ddpsi t) <= 25 / PI.
Proof.
  intros t. unfold paper_ddpsi. rewrite <- Ropp_mult_distr_l, Rabs_Ropp.
  replace (25 / PI) with (1 / PI * 25) by (field; apply PI_neq0).
  apply scaled_bound.
  - pose proof PI_RGT_0. apply Rlt_le, Rdiv_lt_0_compat; lra.
  - pose proof (SIN_bound (t / 2)). pose proof (SIN_bound (3 * t / 2)). pose proof (SIN_bound (5 * t / 2)).
    pose proof (SIN_bound (7 * t / 2)). pose proof (SIN_bound (9 * t / 2)). lra.
Qed.

(** The integral of psi'^2: the primitive is 10/pi^2 t plus waves of period 2 pi. *)
Definition paper_waves (t : R) : R :=
  9 / 2 * sin t + 4 * (sin (2 * t) / 2) + 7 / 2 * (sin (3 * t) / 3) + 3 * (sin (4 * t) / 4) + 5 / 2 * (sin (5 * t) / 5)
  + 2 * (sin (6 * t) / 6) + 3 / 2 * (sin (7 * t) / 7) + sin (8 * t) / 8 + 1 / 2 * (sin (9 * t) / 9).
Definition paper_power (t : R) : R := 4 / PI ^ 2 * (5 / 2 * t + paper_waves t).

Lemma cos_product : forall x y u w, y - x = u -> x + y = w -> cos x * cos y = (cos u + cos w) / 2.
Proof.
  intros x y u w Hu Hw. subst u w. rewrite cos_minus, cos_plus. field.
Qed.

Lemma paper_power_derivative : forall t, is_derive paper_power t (paper_dpsi t ^ 2).
Proof.
  intros t. pose proof PI_RGT_0.
  assert (Hsum : paper_dpsi t ^ 2 = 4 / PI ^ 2 * (5 / 2 + (9 / 2 * cos t + 4 * cos (2 * t) + 7 / 2 * cos (3 * t)
    + 3 * cos (4 * t) + 5 / 2 * cos (5 * t) + 2 * cos (6 * t) + 3 / 2 * cos (7 * t) + cos (8 * t) + 1 / 2 * cos (9 * t)))).
  { unfold paper_dpsi.
    pose proof cos_0 as H0.
    pose proof (cos_product (t / 2) (t / 2) 0 t ltac:(field) ltac:(field)) as H11.
    pose proof (cos_product (t / 2) (3 * t / 2) t (2 * t) ltac:(field) ltac:(field)) as H13.
    pose proof (cos_product (t / 2) (5 * t / 2) (2 * t) (3 * t) ltac:(field) ltac:(field)) as H15.
    pose proof (cos_product (t / 2) (7 * t / 2) (3 * t) (4 * t) ltac:(field) ltac:(field)) as H17.
    pose proof (cos_product (t / 2) (9 * t / 2) (4 * t) (5 * t) ltac:(field) ltac:(field)) as H19.
    pose proof (cos_product (3 * t / 2) (3 * t / 2) 0 (3 * t) ltac:(field) ltac:(field)) as H33.
    pose proof (cos_product (3 * t / 2) (5 * t / 2) t (4 * t) ltac:(field) ltac:(field)) as H35.
    pose proof (cos_product (3 * t / 2) (7 * t / 2) (2 * t) (5 * t) ltac:(field) ltac:(field)) as H37.
    pose proof (cos_product (3 * t / 2) (9 * t / 2) (3 * t) (6 * t) ltac:(field) ltac:(field)) as H39.
    pose proof (cos_product (5 * t / 2) (5 * t / 2) 0 (5 * t) ltac:(field) ltac:(field)) as H55.
    pose proof (cos_product (5 * t / 2) (7 * t / 2) t (6 * t) ltac:(field) ltac:(field)) as H57.
    pose proof (cos_product (5 * t / 2) (9 * t / 2) (2 * t) (7 * t) ltac:(field) ltac:(field)) as H59.
    pose proof (cos_product (7 * t / 2) (7 * t / 2) 0 (7 * t) ltac:(field) ltac:(field)) as H77.
    pose proof (cos_product (7 * t / 2) (9 * t / 2) t (8 * t) ltac:(field) ltac:(field)) as H79.
    pose proof (cos_product (9 * t / 2) (9 * t / 2) 0 (9 * t) ltac:(field) ltac:(field)) as H99.
    set (c1 := cos (t / 2)) in *. set (c3 := cos (3 * t / 2)) in *. set (c5 := cos (5 * t / 2)) in *.
    set (c7 := cos (7 * t / 2)) in *. set (c9 := cos (9 * t / 2)) in *.
    replace ((2 / PI * (c1 + c3 + c5 + c7 + c9)) ^ 2) with
      (4 / PI ^ 2 * (c1 * c1 + c3 * c3 + c5 * c5 + c7 * c7 + c9 * c9
        + 2 * (c1 * c3 + c1 * c5 + c1 * c7 + c1 * c9 + c3 * c5 + c3 * c7 + c3 * c9 + c5 * c7 + c5 * c9 + c7 * c9)))
      by (field; lra).
    apply Rmult_eq_compat_l. lra. }
  rewrite Hsum. unfold paper_power, paper_waves.
  auto_derive; [exact I|]. unfold Rdiv. field. lra.
Qed.

Lemma paper_waves_periodic : forall t, paper_waves (t + 2 * PI) = paper_waves t.
Proof.
  assert (Hn : forall (n : nat) t, sin (INR n * (t + 2 * PI)) = sin (INR n * t)).
  { intros n t. rewrite <- (sin_period (INR n * t) n). f_equal. ring. }
  assert (H1 : forall t, sin (t + 2 * PI) = sin t).
  { intros t. pose proof (Hn 1%nat t) as H. simpl in H. rewrite !Rmult_1_l in H. exact H. }
  assert (Hz : forall n t, sin (IZR (Z.of_nat n) * (t + 2 * PI)) = sin (IZR (Z.of_nat n) * t)).
  { intros n t. rewrite <- INR_IZR_INZ. apply Hn. }
  intros t. unfold paper_waves. rewrite (H1 t).
  rewrite (Hz 2%nat t : sin (2 * (t + 2 * PI)) = sin (2 * t)).
  rewrite (Hz 3%nat t : sin (3 * (t + 2 * PI)) = sin (3 * t)).
  rewrite (Hz 4%nat t : sin (4 * (t + 2 * PI)) = sin (4 * t)).
  rewrite (Hz 5%nat t : sin (5 * (t + 2 * PI)) = sin (5 * t)).
  rewrite (Hz 6%nat t : sin (6 * (t + 2 * PI)) = sin (6 * t)).
  rewrite (Hz 7%nat t : sin (7 * (t + 2 * PI)) = sin (7 * t)).
  rewrite (Hz 8%nat t : sin (8 * (t + 2 * PI)) = sin (8 * t)).
  rewrite (Hz 9%nat t : sin (9 * (t + 2 * PI)) = sin (9 * t)).
  reflexivity.
Qed.

(** (12), with equality: the integral of psi'^2 over any 2 pi is 20 / pi. *)
Lemma paper_excitation : forall t, RInt (fun s => paper_dpsi s ^ 2) t (t + 2 * PI) = 20 / PI.
Proof.
  intros t.
  assert (HI : is_RInt (fun s => paper_dpsi s ^ 2) t (t + 2 * PI) (minus (paper_power (t + 2 * PI)) (paper_power t))).
  { apply (is_RInt_derive (V := R_CompleteNormedModule) paper_power (fun s => paper_dpsi s ^ 2)).
    - intros x _. apply paper_power_derivative.
    - intros x _. apply (ex_derive_continuous (fun s => paper_dpsi s ^ 2)).
      exists (INR 2 * paper_ddpsi x * paper_dpsi x ^ 1).
      apply (is_derive_pow paper_dpsi 2 x). apply paper_dpsi_derivative. }
  rewrite (is_RInt_unique _ _ _ _ HI). unfold minus, plus, opp. simpl.
  unfold paper_power. rewrite paper_waves_periodic. field. apply PI_neq0.
Qed.

Lemma paper_A1 : A1 paper_fleet.
Proof. apply paper_graph. Qed.

Lemma paper_A2 : A2 paper_fleet.
Proof. apply paper_parameters. Qed.

Lemma paper_A3 : A3 paper_fleet.
Proof.
  pose proof PI_RGT_0 as Hpi.
  split; [|split].
  - simpl. lra.
  - simpl. apply Rdiv_lt_0_compat; lra.
  - intros i Hi t Ht. cbn [psi dpsi ddpsi psi0 psi1 psi2 mu T paper_fleet paper_fleet_excited_by].
    split; [apply paper_psi_derivative|]. split; [apply paper_dpsi_derivative|].
    split; [apply paper_psi_bound|]. split; [apply paper_dpsi_bound|]. split; [apply paper_ddpsi_bound|].
    right. symmetry. apply paper_excitation.
Qed.

Theorem paper_fleet_meets_the_hypotheses : A1 paper_fleet /\ A2 paper_fleet /\ A3 paper_fleet.
Proof. exact (conj paper_A1 (conj paper_A2 paper_A3)). Qed.

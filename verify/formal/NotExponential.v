(** * NotExponential.v : L17, the approach to the formation is not exponential.
    Idea: over any fixed horizon a start at e across the leader's heading loses only order e^2 of its e (ShortHorizon).
    An exponential approach would have to halve it, and more, over a horizon that does not depend on e; so take the
    horizon first and then e small.  It holds for every fleet and every gains. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus EnergyDerivatives EnergyBounds Formation ShortHorizon Existence.
Open Scope R_scope.

Section Horizon.
Variable F : fleet.
Hypothesis H1 : A1 F.
Hypothesis H2 : A2 F.
Hypothesis H3 : A3 F.
Variable tau : R.
Hypothesis Htau : 0 <= tau.

(** A solution that starts at e across the leader's heading. *)
Definition starts_aside (e : R) (X : R -> state) : Prop := 0 <= e /\ X 0 = aside F e /\ solution F 0 X.

Lemma speeds_stay_small : exists K, 0 < K /\ forall e X t i, starts_aside e X -> 0 <= t -> (i < N F)%nat ->
  Rabs (v (X t) i) <= K * e.
Proof.
  pose proof H1 as [_ [Hal _]]. pose proof H2 as [Hls _].
  set (C := sum (N F) (al F) / ls F).
  assert (HC : 0 <= C) by (apply div_nonneg; [apply sum_nonneg; exact Hal|exact Hls]).
  destruct (kinetic_to_speed (N F) (m F) (pv F) C HC (travel_gains F H2)) as [K [HK Hspeed]].
  exists K. split; [exact HK|]. intros e X t i [He [Hstart HX]] Ht Hi. apply Hspeed with i; [exact He|exact Hi|].
  assert (Hfall : V F (X t) <= V F (X 0)).
  { apply (decreasing_of_derivative (fun r => V F (X r)) 0 t Ht). intros r Hr. exists (- Pv F (X r)).
    split; [apply (V_derivative F 0 X r H1 H2 HX); lra|]. pose proof (Pv_nonneg F (X r) H1 H2). lra. }
  assert (Hat0 : V F (X 0) <= C * e ^ 2).
  { rewrite Hstart. unfold V. rewrite (sum_zero (N F)) by (intros j Hj; destruct (travel_gains F H2 j Hj); simpl; field; lra).
    rewrite (potential_ext F (ls F) (zx F (aside F e)) (fun _ => - sin (leadth F) * e)) by (intros j; apply displaced_zx).
    rewrite (potential_ext F (ls F) (zy F (aside F e)) (fun _ => cos (leadth F) * e)) by (intros j; apply displaced_zy).
    pose proof (potential_of_agreement F (ls F) (- sin (leadth F) * e) H1 Hls) as Hx.
    pose proof (potential_of_agreement F (ls F) (cos (leadth F) * e) H1 Hls) as Hy.
    fold C in Hx, Hy. pose proof (sin2_cos2 (leadth F)) as Hone. unfold Rsqr in Hone.
    replace (C * e ^ 2) with (C * (- sin (leadth F) * e) ^ 2 + C * (cos (leadth F) * e) ^ 2); [lra|].
    transitivity (C * e ^ 2 * (sin (leadth F) * sin (leadth F) + cos (leadth F) * cos (leadth F))); [ring|].
    rewrite Hone. ring. }
  assert (Hterm : m F i / pv F i * v (X t) i ^ 2 / 2 <= V F (X t)).
  { unfold V. pose proof (potential_nonneg F (ls F) (zx F (X t)) H1 Hls).
    pose proof (potential_nonneg F (ls F) (zy F (X t)) H1 Hls).
    assert (Hone : m F i / pv F i * v (X t) i ^ 2 / 2 <= sum (N F) (fun j => m F j / pv F j * v (X t) j ^ 2 / 2)).
    { apply (sum_term_le (N F) (fun j => m F j / pv F j * v (X t) j ^ 2 / 2)); [|exact Hi].
      intros j Hj. destruct (travel_gains F H2 j Hj). apply kinetic_nonneg, div_pos; assumption. }
    lra. }
  lra.
Qed.

Lemma places_stay_small : exists K, 0 < K /\ forall e X t i, starts_aside e X -> 0 <= t <= tau -> (i < N F)%nat ->
  Rabs (zx F (X t) i) <= K * e /\ Rabs (zy F (X t) i) <= K * e.
Proof.
  destruct speeds_stay_small as [K [HK Hspeed]]. exists (1 + K * tau). split; [nra|].
  intros e X t i HeX Ht Hi. pose proof HeX as [He [Hstart HX]].
  assert (Hmoved : forall f : R -> R, Rabs (f 0) <= e ->
    (forall r, 0 <= r <= t -> exists g, Rabs g <= 1 /\ is_derive f r (g * v (X r) i)) -> Rabs (f t) <= (1 + K * tau) * e).
  { intros f Hf0 Hf. assert (Hinc : Rabs (f t - f 0) <= K * e * (t - 0)).
    { apply increment_abs; [lra|]. intros r Hr. destruct (Hf r Hr) as [g [Hg Dg]].
      exists (g * v (X r) i). split; [exact Dg|]. rewrite Rabs_mult.
      pose proof (Hspeed e X r i HeX (proj1 Hr) Hi) as Hv. pose proof (Rabs_pos (v (X r) i)). nra. }
    replace (f t) with (f t - f 0 + f 0) by ring. eapply Rle_trans; [apply Rabs_triang|].
    assert (0 <= K * e) by nra. assert (K * e * (t - 0) <= K * e * tau) by (apply Rmult_le_compat_l; lra). lra. }
  destruct (direction_abs (leadth F) e He) as [Hsin Hcos].
  split.
  - apply (Hmoved (fun r => zx F (X r) i)).
    + rewrite Hstart. unfold aside. rewrite displaced_zx.
      replace (- sin (leadth F) * e) with (- (sin (leadth F) * e)) by ring. rewrite Rabs_Ropp. exact Hsin.
    + intros r Hr. exists (cos (th (X r) i)). split; [apply Rabs_le, COS_bound|].
      apply (zx_derivative F 0 X r i HX); [lra|exact Hi].
  - apply (Hmoved (fun r => zy F (X r) i)).
    + rewrite Hstart. unfold aside. rewrite displaced_zy. exact Hcos.
    + intros r Hr. exists (sin (th (X r) i)). split; [apply Rabs_le, SIN_bound|].
      apply (zy_derivative F 0 X r i HX); [lra|exact Hi].
Qed.

Lemma excitation_stays_small : exists K, 0 < K /\ forall e X t i, starts_aside e X -> 0 <= t <= tau -> (i < N F)%nat ->
  Rabs (alpha F t (X t) i) <= K * e.
Proof.
  destruct places_stay_small as [K [HK Hplace]]. pose proof H2 as [Hls [_ Hgains]]. pose proof H3 as [_ [_ Hpsi]].
  destruct (finite_upper_bound (N F) (fun i => k F i * psi0 F * (2 * (2 * deg F i / ls F * K)))) as [B [HB HBi]].
  exists B. split; [exact HB|]. intros e X t i HeX Ht Hi. pose proof HeX as [He _].
  destruct (Hgains i Hi) as (_ & _ & _ & _ & _ & _ & _ & _ & Hk & _).
  destruct (Hpsi i Hi t (proj1 Ht)) as (_ & _ & Hpsi0 & _).
  assert (Hx : Rabs (ex F (X t) i) <= 2 * deg F i / ls F * (K * e)).
  { apply coupling_small; [exact H1|exact Hls|exact Hi|]. intros j Hj. apply (Hplace e X t j HeX Ht Hj). }
  assert (Hy : Rabs (ey F (X t) i) <= 2 * deg F i / ls F * (K * e)).
  { apply coupling_small; [exact H1|exact Hls|exact Hi|]. intros j Hj. apply (Hplace e X t j HeX Ht Hj). }
  assert (Hacross : Rabs (across F (X t) i) <= 2 * (2 * deg F i / ls F * (K * e))).
  { unfold across. eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult, Rabs_Ropp.
    assert (Rabs (sin (th (X t) i)) <= 1) by apply Rabs_le, SIN_bound.
    assert (Rabs (cos (th (X t) i)) <= 1) by apply Rabs_le, COS_bound.
    pose proof (Rabs_pos (ex F (X t) i)). pose proof (Rabs_pos (ey F (X t) i)). nra. }
  unfold alpha. rewrite !Rabs_mult, (Rabs_pos_eq (k F i)) by lra.
  apply Rle_trans with (k F i * psi0 F * (2 * (2 * deg F i / ls F * K)) * e).
  - replace (k F i * psi0 F * (2 * (2 * deg F i / ls F * K)) * e)
      with (k F i * psi0 F * (2 * (2 * deg F i / ls F * (K * e)))) by ring.
    apply Rmult_le_compat; [|apply Rabs_pos| |exact Hacross].
    + apply Rmult_le_pos; [lra|apply Rabs_pos].
    + apply Rmult_le_compat_l; lra.
  - apply Rmult_le_compat_r; [exact He|]. apply HBi. exact Hi.
Qed.

(** W starts at 0 and its rate is at most W + K e^2: the square term of (20) goes to W, the rest is order e^2. *)
Lemma turn_rates_stay_small : exists K, 0 < K /\ forall e X t i, starts_aside e X -> 0 <= t <= tau -> (i < N F)%nat ->
  Rabs (om (X t) i) <= K * e.
Proof.
  destruct excitation_stays_small as [A [HA Halpha]]. pose proof H2 as [_ [Hrs _]].
  set (B := sum (N F) (fun i => A ^ 2 / (2 * J F i * pw F i))).
  assert (HB : 0 <= B).
  { apply sum_nonneg. intros i Hi. destruct (turn_gains F H2 i Hi) as [HJ Hp].
    apply div_nonneg; [apply pow2_ge_0|]. apply Rmult_lt_0_compat; lra. }
  assert (HBexp : 0 <= B * exp tau) by (apply Rmult_le_pos; [exact HB|apply Rlt_le, exp_pos]).
  destruct (kinetic_to_speed (N F) (J F) (pw F) (B * exp tau) HBexp (turn_gains F H2)) as [K [HK Hspeed]].
  exists K. split; [exact HK|]. intros e X t i HeX Ht Hi. pose proof HeX as [He [Hstart HX]].
  apply Hspeed with i; [exact He|exact Hi|].
  assert (Hat0 : W F (X 0) <= 0).
  { rewrite Hstart. unfold W. rewrite (sum_zero (N F)) by (intros j Hj; destruct (turn_gains F H2 j Hj); simpl; field; lra).
    rewrite (potential_ext F (rs F) (tha F (aside F e)) (fun _ => 0)) by (intros j; unfold tha; simpl; ring).
    pose proof (potential_of_agreement F (rs F) 0 H1 Hrs) as Hzero. rewrite pow_ne_zero in Hzero by discriminate. lra. }
  assert (Hkinetic : forall s, sum (N F) (fun j => J F j / pw F j * om s j ^ 2 / 2) <= W F s).
  { intros s. unfold W. pose proof (potential_nonneg F (rs F) (tha F s) H1 Hrs). lra. }
  assert (Hrate : forall r, 0 <= r <= t ->
    - Pw F (X r) + sum (N F) (fun j => om (X r) j * alpha F r (X r) j / pw F j) <= W F (X r) + B * e ^ 2).
  { intros r Hr. pose proof (Pw_nonneg F (X r) H1 H2). pose proof (Hkinetic (X r)).
    assert (Hsum : sum (N F) (fun j => om (X r) j * alpha F r (X r) j / pw F j)
      <= sum (N F) (fun j => J F j / pw F j * om (X r) j ^ 2 / 2) + B * e ^ 2).
    { unfold B. rewrite <- sum_scal_r, <- sum_plus. apply sum_le. intros j Hj.
      destruct (turn_gains F H2 j Hj) as [HJ Hp].
      assert (Hsmall : alpha F r (X r) j ^ 2 <= (A * e) ^ 2).
      { apply pow_maj_Rabs. apply (Halpha e X r j HeX); [lra|exact Hj]. }
      set (x := om (X r) j). set (y := alpha F r (X r) j) in *.
      apply Rle_trans with (J F j / pw F j * x ^ 2 / 2 + y ^ 2 / (2 * J F j * pw F j)).
      - apply Rminus_le. replace (x * y / pw F j - (J F j / pw F j * x ^ 2 / 2 + y ^ 2 / (2 * J F j * pw F j)))
          with (- ((J F j * x - y) ^ 2 / (2 * J F j * pw F j))) by (field; lra).
        assert (0 <= (J F j * x - y) ^ 2 / (2 * J F j * pw F j)); [|lra].
        apply div_nonneg; [apply pow2_ge_0|]. apply Rmult_lt_0_compat; lra.
      - apply Rplus_le_compat_l. replace (A ^ 2 / (2 * J F j * pw F j) * e ^ 2) with ((A * e) ^ 2 / (2 * J F j * pw F j))
          by (field; lra).
        apply div_le; [exact Hsmall|]. apply Rmult_lt_0_compat; lra. }
    lra. }
  assert (Hgrow : (W F (X t) + B * e ^ 2) * exp (- t) <= (W F (X 0) + B * e ^ 2) * exp (- 0)).
  { apply (decreasing_of_derivative (fun r => (W F (X r) + B * e ^ 2) * exp (- r)) 0 t (proj1 Ht)). intros r Hr.
    set (l := - Pw F (X r) + sum (N F) (fun j => om (X r) j * alpha F r (X r) j / pw F j)).
    exists ((l + 0) * exp (- r) + (W F (X r) + B * e ^ 2) * (exp (- r) * (- 1))). split.
    - apply (derive_mult (fun q => W F (X q) + B * e ^ 2) (fun q => exp (- q))).
      + apply derive_plus; [|apply derive_const]. apply (W_derivative F 0 X r H1 H2 HX). lra.
      + apply (derive_exp (fun q => - q)), derive_opp, derive_id.
    - pose proof (Hrate r Hr) as Hl. fold l in Hl. pose proof (exp_pos (- r)). nra. }
  assert (Hterm : J F i / pw F i * om (X t) i ^ 2 / 2 <= W F (X t)).
  { apply Rle_trans with (sum (N F) (fun j => J F j / pw F j * om (X t) j ^ 2 / 2)); [|apply Hkinetic].
    apply (sum_term_le (N F) (fun j => J F j / pw F j * om (X t) j ^ 2 / 2)); [|exact Hi].
    intros j Hj. destruct (turn_gains F H2 j Hj). apply kinetic_nonneg, div_pos; assumption. }
  rewrite Ropp_0, exp_0, Rmult_1_r in Hgrow.
  assert (Hexp : exp t * exp (- t) = 1) by (rewrite <- exp_plus, Rplus_opp_r; apply exp_0).
  assert (Hmono : exp t <= exp tau).
  { destruct (Req_dec t tau) as [-> | Hne]; [lra|]. apply Rlt_le, exp_increasing. lra. }
  pose proof (exp_pos t) as Hpos. pose proof (pow2_ge_0 e) as Hee.
  assert (HBee : 0 <= B * e ^ 2) by (apply Rmult_le_pos; assumption).
  assert (Hup : W F (X t) + B * e ^ 2 <= B * e ^ 2 * exp t).
  { replace (W F (X t) + B * e ^ 2) with ((W F (X t) + B * e ^ 2) * exp (- t) * exp t).
    - apply Rmult_le_compat_r; lra.
    - rewrite Rmult_assoc, (Rmult_comm (exp (- t))), Hexp. ring. }
  assert (Hup2 : B * e ^ 2 * exp t <= B * e ^ 2 * exp tau) by (apply Rmult_le_compat_l; assumption).
  replace (B * exp tau * e ^ 2) with (B * e ^ 2 * exp tau) by ring. lra.
Qed.

Lemma headings_stay_small : exists K, 0 < K /\ forall e X t i, starts_aside e X -> 0 <= t <= tau -> (i < N F)%nat ->
  Rabs (tha F (X t) i) <= K * e.
Proof.
  destruct turn_rates_stay_small as [K [HK Hturn]]. exists (K * (tau + 1)). split; [apply Rmult_lt_0_compat; lra|].
  intros e X t i HeX Ht Hi. pose proof HeX as [He [Hstart HX]].
  assert (Hinc : Rabs (tha F (X t) i - tha F (X 0) i) <= K * e * (t - 0)).
  { apply (increment_abs (fun r => tha F (X r) i)); [lra|]. intros r Hr. exists (om (X r) i).
    split; [apply (tha_derivative F 0 X r i HX); [lra|exact Hi]|]. apply (Hturn e X r i HeX); [lra|exact Hi]. }
  replace (tha F (X 0) i) with 0 in Hinc by (rewrite Hstart; unfold tha; simpl; ring). rewrite !Rminus_0_r in Hinc.
  assert (0 <= K * e) by (apply Rmult_le_pos; lra).
  assert (K * e * t <= K * e * (tau + 1)) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(** The distance across the leader's heading of vehicle i, and how little of it is lost by the horizon. *)
Definition cross_track (s : state) (i : nat) : R := - sin (leadth F) * zx F s i + cos (leadth F) * zy F s i.

Lemma cross_track_stays : exists K, 0 < K /\ forall e X i, starts_aside e X -> (i < N F)%nat ->
  e - K * e ^ 2 <= cross_track (X tau) i.
Proof.
  destruct speeds_stay_small as [Kv [HKv Hspeed]]. destruct headings_stay_small as [Kh [HKh Hheading]].
  exists (Kh * Kv * (tau + 1)). split; [apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat|]; lra|].
  intros e X i HeX Hi. pose proof HeX as [He [Hstart HX]].
  assert (Hinc : Rabs (cross_track (X tau) i - cross_track (X 0) i) <= Kh * Kv * e ^ 2 * (tau - 0)).
  { apply (increment_abs (fun r => cross_track (X r) i)); [exact Htau|]. intros r Hr.
    exists (- sin (leadth F) * (cos (th (X r) i) * v (X r) i) + cos (leadth F) * (sin (th (X r) i) * v (X r) i)). split.
    - apply derive_plus; apply derive_scal.
      + apply (zx_derivative F 0 X r i HX); [lra|exact Hi].
      + apply (zy_derivative F 0 X r i HX); [lra|exact Hi].
    - replace (- sin (leadth F) * (cos (th (X r) i) * v (X r) i) + cos (leadth F) * (sin (th (X r) i) * v (X r) i))
        with (sin (tha F (X r) i) * v (X r) i) by (unfold tha; rewrite sin_minus; ring).
      rewrite Rabs_mult. replace (Kh * Kv * e ^ 2) with (Kh * e * (Kv * e)) by ring.
      apply Rmult_le_compat; [apply Rabs_pos|apply Rabs_pos| |apply (Hspeed e X r i HeX); [lra|exact Hi]].
      eapply Rle_trans; [apply sin_abs_le|]. apply (Hheading e X r i HeX Hr Hi). }
  assert (Hat0 : cross_track (X 0) i = e).
  { rewrite Hstart. unfold cross_track, aside. rewrite displaced_zx, displaced_zy.
    transitivity (e * (Rsqr (sin (leadth F)) + Rsqr (cos (leadth F)))); [unfold Rsqr; ring|]. rewrite sin2_cos2. ring. }
  rewrite Hat0 in Hinc. apply Rabs_le_between in Hinc.
  assert (0 <= Kh * Kv * e ^ 2) by (apply Rmult_le_pos; [apply Rmult_le_pos; lra|apply pow2_ge_0]). nra.
Qed.
End Horizon.

Lemma aside_error : forall F e, 0 <= e -> err F (aside F e) <= 2 * INR (N F) * e.
Proof.
  intros F e He. replace (2 * INR (N F) * e) with (INR (N F) * (2 * e)) by ring. rewrite <- sum_const.
  apply sum_le. intros i _. unfold aside at 1 2. rewrite displaced_zx, displaced_zy.
  replace (tha F (aside F e) i) with 0 by (unfold tha; simpl; ring). simpl. rewrite Rabs_R0.
  destruct (direction_abs (leadth F) e He) as [Hsin Hcos].
  replace (- sin (leadth F) * e) with (- (sin (leadth F) * e)) by ring. rewrite Rabs_Ropp. lra.
Qed.

Lemma cross_track_error : forall F s i, (i < N F)%nat -> cross_track F s i <= err F s.
Proof.
  intros F s i Hi.
  apply Rle_trans with (Rabs (zx F s i) + Rabs (zy F s i) + Rabs (tha F s i) + Rabs (v s i) + Rabs (om s i)).
  - unfold cross_track. eapply Rle_trans; [apply Rle_abs|]. eapply Rle_trans; [apply Rabs_triang|].
    rewrite !Rabs_mult, Rabs_Ropp.
    assert (Rabs (sin (leadth F)) <= 1) by apply Rabs_le, SIN_bound.
    assert (Rabs (cos (leadth F)) <= 1) by apply Rabs_le, COS_bound.
    pose proof (Rabs_pos (zx F s i)). pose proof (Rabs_pos (zy F s i)). pose proof (Rabs_pos (tha F s i)).
    pose proof (Rabs_pos (v s i)). pose proof (Rabs_pos (om s i)). nra.
  - apply (sum_term_le (N F) (fun j => Rabs (zx F s j) + Rabs (zy F s j) + Rabs (tha F s j) + Rabs (v s j) + Rabs (om s j)));
      [|exact Hi].
    intros j _. pose proof (Rabs_pos (zx F s j)). pose proof (Rabs_pos (zy F s j)). pose proof (Rabs_pos (tha F s j)).
    pose proof (Rabs_pos (v s j)). pose proof (Rabs_pos (om s j)). lra.
Qed.

(** exp outgrows every line, so that any exponential rate falls below any level. *)
Lemma horizon_for_rate : forall c lam n, 0 < c -> 0 < lam -> 0 < n -> exists tau, 0 <= tau /\ c * exp (- lam * tau) * n < 1.
Proof.
  intros c lam n Hc Hlam Hn. assert (Hcn : 0 < c * n) by (apply Rmult_lt_0_compat; assumption).
  exists (c * n / lam). split; [apply Rlt_le, div_pos; assumption|].
  replace (- lam * (c * n / lam)) with (- (c * n)) by (field; lra).
  pose proof (exp_ineq1_le (c * n)) as Hgrow. pose proof (exp_pos (- (c * n))) as Hpos.
  assert (Hinv : exp (c * n) * exp (- (c * n)) = 1) by (rewrite <- exp_plus, Rplus_opp_r; apply exp_0).
  replace (c * exp (- (c * n)) * n) with (c * n * exp (- (c * n))) by ring. rewrite <- Hinv.
  apply Rmult_lt_compat_r; lra.
Qed.

Theorem not_exponential_holds : not_exponential.
Proof.
  intros F H1 H2 H3 HN [c [lam [del [Hc [Hlam [Hdel Hrate]]]]]].
  assert (Hn : 1 <= INR (N F)) by (apply (le_INR 1); exact HN).
  destruct (horizon_for_rate c lam (4 * INR (N F)) Hc Hlam) as [tau [Htau Hfast]]; [lra|].
  destruct (cross_track_stays F H1 H2 H3 tau Htau) as [K [HK Hstays]].
  set (e := Rmin (del / (2 * INR (N F))) (1 / (2 * K))).
  assert (He : 0 < e) by (apply Rmin_glb_lt; apply div_pos; lra).
  destruct (existence_holds F H1 H2 H3 0 (aside F e)) as [X [Hstart HX]]; [lra|].
  assert (Hlate : e - K * e ^ 2 <= err F (X tau)).
  { eapply Rle_trans; [|apply (cross_track_error F (X tau) 0%nat HN)].
    apply Hstays; [|exact HN]. split; [lra|]. split; [exact Hstart|exact HX]. }
  assert (Hearly : err F (X 0) <= 2 * INR (N F) * e) by (rewrite Hstart; apply aside_error; lra).
  assert (Hdel_e : 2 * INR (N F) * e <= del).
  { apply Rle_trans with (2 * INR (N F) * (del / (2 * INR (N F)))).
    - apply Rmult_le_compat_l; [lra|]. apply Rmin_l.
    - right. field. lra. }
  assert (Hhalf : K * e ^ 2 <= e / 2).
  { assert (HKe : K * e <= 1 / 2).
    { apply Rle_trans with (K * (1 / (2 * K))).
      - apply Rmult_le_compat_l; [lra|]. apply Rmin_r.
      - right. field. lra. }
    replace (K * e ^ 2) with (K * e * e) by ring. nra. }
  pose proof (Hrate 0 X (Rle_refl 0) HX ltac:(lra) tau Htau) as Hfall. rewrite Rminus_0_r in Hfall.
  pose proof (exp_pos (- lam * tau)) as Hexp.
  assert (Hcexp : 0 < c * exp (- lam * tau)) by (apply Rmult_lt_0_compat; assumption).
  assert (Hlast : c * exp (- lam * tau) * err F (X 0) <= c * exp (- lam * tau) * (2 * INR (N F) * e))
    by (apply Rmult_le_compat_l; lra).
  nra.
Qed.

(** * EnergyFamily.v : L5-L8, an energy that falls up to any prescribed rate.
    W alone may rise, since the excitation feeds energy into the turning.  Most of this is a total derivative:
    subtracted, what is left is at most a constant times the speeds, and enough of V pays for it.
    The subtracted terms are bounded by V and a constant, so the energy stays comparable to V and W. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus EnergyDerivatives CouplingRates Torques EnergyBounds.
Open Scope R_scope.

(** ** L5: the total derivative that is subtracted, and what it leaves *)
Definition correction (F : fleet) (t : R) (s : state) : R :=
  sum (N F) (fun i => k F i / pw F i * (psi F i t * along F s i + m F i / pv F i * (dpsi F i t * v s i))).

Definition leftover (F : fleet) (t : R) (s : state) : R :=
  sum (N F) (fun i => k F i / pw F i * (- psi F i t * along_rate F s i
    - m F i / pv F i * (ddpsi F i t * v s i) + dv F i / pv F i * (dpsi F i t * tanh (v s i / ss F i)))).

Lemma correction_derivative : forall F t0 X t, A2 F -> A3 F -> 0 <= t0 -> solution F t0 X -> t0 <= t ->
  is_derive (fun r => correction F r (X r)) t
    (sum (N F) (fun i => om (X t) i * alpha F t (X t) i / pw F i) - leftover F t (X t)).
Proof.
  intros F t0 X t [_ [_ HA2]] [_ [_ HA3]] Ht0 HX Ht.
  unfold leftover. rewrite <- sum_minus. unfold correction.
  apply (derive_sum (N F) (fun i r => k F i / pw F i * (psi F i r * along F (X r) i + m F i / pv F i * (dpsi F i r * v (X r) i)))).
  intros i Hi. destruct (HX i Hi t Ht) as [_ [_ [_ [Hv _]]]].
  destruct (HA3 i Hi t ltac:(lra)) as [Hpsi [Hdpsi _]].
  destruct (HA2 i Hi) as [Hm [_ [_ [_ [Hpv [_ [Hpw _]]]]]]].
  eapply derive_value.
  - apply derive_scal, derive_plus; [| apply derive_scal]; apply derive_mult;
      [exact Hpsi | apply (along_derivative F t0); assumption | exact Hdpsi | exact Hv].
  - unfold u_v, alpha. field. repeat split; lra.
Qed.

(** ** L6: the rest is at most a constant times the speeds *)
Lemma leftover_le : forall F, A1 F -> A2 F -> A3 F -> exists G, 0 < G /\
  forall t s, 0 <= t -> leftover F t s <= sum (N F) (fun i => G * Rabs (v s i)).
Proof.
  intros F HA1 HA2 HA3.
  set (g := fun i => k F i / pw F i * (psi0 F * (2 * deg F i / ls F) + m F i / pv F i * psi2 F
                                       + dv F i / pv F i * (psi1 F / ss F i))).
  destruct (finite_upper_bound (N F) g) as [B [HB Hg]].
  exists ((INR (N F) + 1) * B). split.
  { apply Rmult_lt_0_compat; [| assumption]. generalize (pos_INR (N F)). lra. }
  intros t s Ht. set (S := sum (N F) (fun j => Rabs (v s j))).
  assert (HS : 0 <= S) by (apply sum_nonneg; intros j _; apply Rabs_pos).
  rewrite sum_scal_l. fold S. unfold leftover.
  apply Rle_trans with (sum (N F) (fun _ => B * S)).
  2:{ rewrite sum_const. assert (0 <= B * S) by (apply Rmult_le_pos; lra). lra. }
  apply sum_le. intros i Hi.
  apply Rle_trans with (g i * S); [| apply Rmult_le_compat_r; [exact HS | apply Hg; exact Hi]].
  assert (Hv : forall j, (j < N F)%nat -> Rabs (v s j) <= S).
  { intros j Hj. apply (sum_term_le (N F) (fun j => Rabs (v s j)) j); [| exact Hj]. intros q _. apply Rabs_pos. }
  assert (Hpull : Rabs (along_rate F s i) <= 2 * deg F i * S / ls F).
  { apply Rle_trans with (speed_spread F s i); [apply along_rate_bound | apply speed_spread_le]; try assumption; apply HA2. }
  destruct HA3 as [_ [_ HA3]]. destruct (HA3 i Hi t Ht) as [_ [_ [H0 [H1 [H2 _]]]]].
  destruct HA2 as [_ [_ HA2]]. destruct (HA2 i Hi) as [Hm [_ [_ [_ [Hpv [Hdv [Hpw [_ [Hk [Hss _]]]]]]]]]].
  specialize (Hv i Hi).
  assert (T1 : - psi F i t * along_rate F s i <= psi0 F * (2 * deg F i * S / ls F)).
  { apply Rle_trans with (1 := Rle_abs _). rewrite Rabs_mult, Rabs_Ropp.
    apply Rmult_le_compat; try apply Rabs_pos; assumption. }
  assert (T2 : - (ddpsi F i t * v s i) <= psi2 F * S).
  { apply Rle_trans with (1 := Rle_abs _). rewrite Rabs_Ropp, Rabs_mult.
    apply Rmult_le_compat; try apply Rabs_pos; assumption. }
  assert (T3 : dpsi F i t * tanh (v s i / ss F i) <= psi1 F * (S / ss F i)).
  { apply Rle_trans with (1 := Rle_abs _). rewrite Rabs_mult.
    apply Rmult_le_compat; try apply Rabs_pos; [assumption |].
    apply Rle_trans with (1 := tanh_abs_le _). rewrite abs_div_pos by assumption. apply div_le; assumption. }
  unfold g. rewrite Rmult_assoc. apply Rmult_le_compat_l; [apply div_nonneg; lra |].
  assert (U2 : m F i / pv F i * - (ddpsi F i t * v s i) <= m F i / pv F i * (psi2 F * S)).
  { apply Rmult_le_compat_l; [apply div_nonneg; lra | exact T2]. }
  assert (U3 : dv F i / pv F i * (dpsi F i t * tanh (v s i / ss F i)) <= dv F i / pv F i * (psi1 F * (S / ss F i))).
  { apply Rmult_le_compat_l; [apply div_nonneg; lra | exact T3]. }
  replace ((psi0 F * (2 * deg F i / ls F) + m F i / pv F i * psi2 F + dv F i / pv F i * (psi1 F / ss F i)) * S)
    with (psi0 F * (2 * deg F i * S / ls F) + m F i / pv F i * (psi2 F * S) + dv F i / pv F i * (psi1 F * (S / ss F i)))
    by (unfold Rdiv; ring).
  lra.
Qed.

(** ** L7: enough of the travel damping pays for the speeds, up to a rate e *)
Lemma damping_pays : forall F, A2 F -> forall G e, 0 < G -> 0 < e -> exists K, 0 < K /\
  forall s, sum (N F) (fun i => G * Rabs (v s i)) <= K * Pv F s + e.
Proof.
  intros F [_ [_ HA2]] G e HG He.
  assert (HN : 0 < INR (N F) + 1) by (generalize (pos_INR (N F)); lra).
  set (e' := e / (INR (N F) + 1)).
  assert (He' : 0 < e') by (apply Rdiv_lt_0_compat; assumption).
  destruct (finite_common_large (N F)
    (fun i K => forall x, G * Rabs x <= K * (dv F i / pv F i * (x * tanh (x / ss F i))) + e')) as [K [HK H]].
  - intros i x y Hi Hxy Hx z. apply Rle_trans with (1 := Hx z). apply Rplus_le_compat_r.
    destruct (HA2 i Hi) as [_ [_ [_ [_ [Hpv [Hdv [_ [_ [_ [Hss _]]]]]]]]]].
    apply Rmult_le_compat_r; [| exact Hxy].
    apply Rmult_le_pos; [apply div_nonneg; lra | apply x_tanh_scaled_nonneg; exact Hss].
  - intros i Hi. destruct (HA2 i Hi) as [_ [_ [_ [_ [Hpv [Hdv [_ [_ [_ [Hss _]]]]]]]]]].
    set (h := e' / G). assert (Hh : 0 < h) by (apply Rdiv_lt_0_compat; assumption).
    assert (HGh : G * h = e') by (unfold h; field; lra).
    set (tt := tanh (h / ss F i)). assert (Htt : 0 < tt) by (apply tanh_pos, Rdiv_lt_0_compat; assumption).
    assert (Hc : 0 < dv F i / pv F i) by (apply Rdiv_lt_0_compat; assumption).
    set (c := dv F i / pv F i) in *.
    exists (G / (c * tt)). intros x.
    assert (Hct : 0 < c * tt) by (apply Rmult_lt_0_compat; assumption).
    assert (HK0 : 0 < G / (c * tt)) by (apply Rdiv_lt_0_compat; assumption).
    destruct (Rle_dec (Rabs x) h) as [Hx | Hx].
    + assert (G * Rabs x <= G * h) by (apply Rmult_le_compat_l; lra).
      assert (0 <= G / (c * tt) * (c * (x * tanh (x / ss F i)))).
      { apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [lra |]. apply x_tanh_scaled_nonneg; exact Hss. }
      lra.
    + destruct (x_tanh_scaled_ge x (ss F i) h Hss ltac:(lra) ltac:(lra)) as [Hge _]. fold tt in Hge.
      assert (G / (c * tt) * (c * (Rabs x * tt)) <= G / (c * tt) * (c * (x * tanh (x / ss F i)))).
      { apply Rmult_le_compat_l; [lra |]. apply Rmult_le_compat_l; [lra | exact Hge]. }
      replace (G / (c * tt) * (c * (Rabs x * tt))) with (G * Rabs x) in H by (field; lra). lra.
  - exists K. split; [exact HK |]. intros s. unfold Pv. rewrite <- sum_scal_l.
    apply Rle_trans with (sum (N F) (fun i => K * (dv F i / pv F i * (v s i * tanh (v s i / ss F i))) + e')).
    + apply sum_le. intros i Hi. apply (H i Hi).
    + rewrite sum_plus, sum_const. apply Rplus_le_compat_l.
      replace e with ((INR (N F) + 1) * e') by (unfold e'; field; lra). lra.
Qed.

(** ** L8: what is subtracted is at most V and a constant *)
Lemma correction_le : forall F, A1 F -> A2 F -> A3 F -> exists C0, 0 <= C0 /\
  forall t s, 0 <= t -> Rabs (correction F t s) <= V F s + C0.
Proof.
  intros F HA1 HA2 HA3.
  set (c := fun i => k F i / pw F i * (psi0 F * (sqrt 2 * deg F i)) + m F i / pv F i * (k F i / pw F i * psi1 F) ^ 2 / 2).
  destruct (finite_upper_bound (N F) c) as [B [HB Hc]].
  exists (INR (N F) * B). split; [apply Rmult_le_pos; [apply pos_INR | lra] |].
  intros t s Ht.
  assert (Hkin : sum (N F) (fun i => m F i / pv F i * (v s i) ^ 2 / 2) <= V F s).
  { assert (Hls : 0 < ls F) by apply HA2. unfold V.
    generalize (potential_nonneg F (ls F) (zx F s) HA1 Hls) (potential_nonneg F (ls F) (zy F s) HA1 Hls). lra. }
  apply Rle_trans with (sum (N F) (fun i => m F i / pv F i * (v s i) ^ 2 / 2) + INR (N F) * B); [| lra].
  rewrite <- sum_const, <- sum_plus. unfold correction. apply sum_abs_le. intros i Hi.
  assert (Hq := along_bound F s i HA1 Hi).
  destruct HA3 as [_ [_ HA3]]. destruct (HA3 i Hi t Ht) as [_ [_ [H0 [H1 _]]]].
  destruct HA2 as [_ [_ HA2]]. destruct (HA2 i Hi) as [Hm [_ [_ [_ [Hpv [_ [Hpw [_ [Hk _]]]]]]]]].
  apply Rle_trans with (m F i / pv F i * v s i ^ 2 / 2 + c i); [| generalize (Hc i Hi); lra].
  assert (Hkp : 0 < k F i / pw F i) by (apply Rdiv_lt_0_compat; assumption).
  assert (Hmp : 0 < m F i / pv F i) by (apply Rdiv_lt_0_compat; assumption).
  unfold c. set (g := k F i / pw F i) in *. set (mm := m F i / pv F i) in *.
  rewrite Rabs_mult, (Rabs_pos_eq g) by lra.
  assert (T1 : Rabs (psi F i t * along F s i) <= psi0 F * (sqrt 2 * deg F i)).
  { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; assumption. }
  assert (T2 : Rabs (mm * (dpsi F i t * v s i)) <= mm * (psi1 F * Rabs (v s i))).
  { rewrite !Rabs_mult, (Rabs_pos_eq mm) by lra. apply Rmult_le_compat_l; [lra |].
    apply Rmult_le_compat_r; [apply Rabs_pos | exact H1]. }
  assert (T3 : g * (mm * (psi1 F * Rabs (v s i))) <= mm * v s i ^ 2 / 2 + mm * (g * psi1 F) ^ 2 / 2).
  { rewrite <- (pow2_abs (v s i)). assert (0 <= mm * (Rabs (v s i) - g * psi1 F) ^ 2).
    { apply Rmult_le_pos; [lra | apply pow2_ge_0]. }
    nra. }
  apply Rle_trans with (g * (psi0 F * (sqrt 2 * deg F i) + mm * (psi1 F * Rabs (v s i)))).
  - apply Rmult_le_compat_l; [lra |]. apply Rle_trans with (1 := Rabs_triang _ _). lra.
  - lra.
Qed.

(** ** The family *)
Lemma energy_family : forall F, A1 F -> A2 F -> A3 F -> exists C0, 0 <= C0 /\ forall e, 0 < e ->
  exists K (Y : R -> state -> R), 0 <= K /\
    (forall t s, 0 <= t -> W F s + K * V F s - C0 <= Y t s <= W F s + (K + 2) * V F s + C0) /\
    (forall t0 X, 0 <= t0 -> solution F t0 X -> forall t, t0 <= t ->
       exists l, is_derive (fun r => Y r (X r)) t l /\ l <= - (Pw F (X t) + Pv F (X t)) + e).
Proof.
  intros F HA1 HA2 HA3.
  destruct (correction_le F HA1 HA2 HA3) as [C0 [HC0 Hcor]].
  destruct (leftover_le F HA1 HA2 HA3) as [G [HG Hleft]].
  exists C0. split; [exact HC0 |]. intros e He.
  destruct (damping_pays F HA2 G e HG He) as [K [HK Hpay]].
  exists K, (fun t s => W F s - correction F t s + (K + 1) * V F s).
  split; [lra | split].
  - intros t s Ht. assert (H := Hcor t s Ht). apply Rabs_le_between in H. lra.
  - intros t0 X Ht0 HX t Ht. eexists. split.
    + apply derive_plus; [apply derive_minus |].
      * apply (W_derivative F t0); assumption.
      * apply (correction_derivative F t0); assumption.
      * apply derive_scal, (V_derivative F t0); assumption.
    + assert (H1 := Hleft t (X t) ltac:(lra)). assert (H2 := Hpay (X t)). lra.
Qed.

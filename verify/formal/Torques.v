(** * Torques.v : L16 (the wheel torques never reach their limit) and L18 (certified speed and turn-rate limits).
    The pulls along and across the track share one vector, so their joint torque grows like the root of the sum of squares of the gains.
    Speed and turn rate: above the limit the damping outweighs all pulls, so the speed falls there;
    a quantity that falls wherever it lies above a level never rises above the larger of that level and its start. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus.
From Gaincert Require Export PullBounds.
Open Scope R_scope.

(** The pull of the speed channel and that of the excitation, added with either sign. *)
Lemma joint_pull_bound F s i q c : A1 F -> (i < N F)%nat -> Rabs q <= c ->
  Rabs (- pv F i * along F s i + q * across F s i) <= sqrt 2 * deg F i * sqrt (pv F i ^ 2 + c ^ 2).
Proof.
  intros HA Hi Hq. unfold along, across.
  replace (- pv F i * (cos (th s i) * ex F s i + sin (th s i) * ey F s i) + q * (- sin (th s i) * ex F s i + cos (th s i) * ey F s i))
    with ((- pv F i * cos (th s i) - q * sin (th s i)) * ex F s i + (- pv F i * sin (th s i) + q * cos (th s i)) * ey F s i) by ring.
  eapply Rle_trans.
  - apply pull_bound with (D := deg F i); [ apply deg_nonneg; assumption | apply coupling_bound; assumption | apply coupling_bound; assumption ].
  - apply Rmult_le_compat_l.
    + apply Rmult_le_pos; [ apply sqrt_pos | apply deg_nonneg; assumption ].
    + apply sqrt_le_1_alt.
      replace ((- pv F i * cos (th s i) - q * sin (th s i)) ^ 2 + (- pv F i * sin (th s i) + q * cos (th s i)) ^ 2)
        with ((pv F i ^ 2 + q ^ 2) * (cos (th s i) ^ 2 + sin (th s i) ^ 2)) by ring.
      rewrite unit_circle. pose proof (pow_maj_Rabs c q 2 Hq). lra.
Qed.

(** Everything beside the joint pull: damping of both channels and the pull of the heading. *)
Lemma damping_below F s i : A1 F -> A2 F -> (i < N F)%nat ->
  Rabs (dv F i * tanh (v s i / ss F i)) < dv F i /\
  Rabs ((pw F i * eth F s i + dw F i * tanh (om s i / ws F i)) / arm F i) < (dw F i + pw F i * deg F i) / arm F i.
Proof.
  intros HA [_ [_ H2]] Hi. destruct (H2 i Hi) as (_ & _ & _ & Harm & _ & Hdv & Hpw & Hdw & _).
  split.
  - rewrite Rabs_mult, (Rabs_pos_eq (dv F i)) by lra. pose proof (tanh_abs_lt_1 (v s i / ss F i)). nra.
  - unfold Rdiv at 1. rewrite Rabs_mult, (Rabs_pos_eq (/ arm F i)) by (left; apply Rinv_0_lt_compat; exact Harm).
    apply Rmult_lt_compat_r; [ apply Rinv_0_lt_compat; exact Harm |].
    eapply Rle_lt_trans; [ apply Rabs_triang |].
    rewrite !Rabs_mult, (Rabs_pos_eq (pw F i)), (Rabs_pos_eq (dw F i)) by lra.
    pose proof (tanh_abs_lt_1 (om s i / ws F i)) as H1.
    pose proof (coupling_bound F (rs F) (tha F s) i HA Hi) as H3. fold (eth F s i) in H3. nra.
Qed.

Theorem torque_bound_holds F : A1 F -> A2 F -> A3 F -> torque_bound F.
Proof.
  intros HA HA2 HA3 i t s Hi Ht.
  destruct (damping_below F s i HA HA2 Hi) as [Hv Hw].
  destruct HA2 as [_ [_ H2]]. destruct (H2 i Hi) as (_ & _ & Hwr & Harm & Hpv & _ & _ & _ & Hk & _).
  destruct HA3 as [_ [_ H3]]. destruct (H3 i Hi t Ht) as (_ & _ & Hpsi & _).
  assert (Hq : Rabs (k F i * psi F i t / arm F i) <= k F i * psi0 F / arm F i).
  { unfold Rdiv. rewrite !Rabs_mult, (Rabs_pos_eq (k F i)), (Rabs_pos_eq (/ arm F i)) by (try (left; apply Rinv_0_lt_compat); lra).
    apply Rmult_le_compat_r; [ left; apply Rinv_0_lt_compat; lra |]. apply Rmult_le_compat_l; lra. }
  assert (Hq' : Rabs (- (k F i * psi F i t / arm F i)) <= k F i * psi0 F / arm F i) by (rewrite Rabs_Ropp; exact Hq).
  pose proof (joint_pull_bound F s i _ _ HA Hi Hq) as Hp.
  pose proof (joint_pull_bound F s i _ _ HA Hi Hq') as Hm.
  unfold torque_plus, torque_minus, torque_limit.
  set (A := dv F i * tanh (v s i / ss F i)) in *.
  set (B := (pw F i * eth F s i + dw F i * tanh (om s i / ws F i)) / arm F i) in *.
  rewrite !(Rabs_mult (wr F i / 2)), (Rabs_pos_eq (wr F i / 2)) by lra.
  replace (u_v F s i + u_w F t s i / arm F i)
    with ((- pv F i * along F s i + k F i * psi F i t / arm F i * across F s i) + (- A) + (- B))
    by (unfold u_v, u_w, A, B; field; lra).
  replace (u_v F s i - u_w F t s i / arm F i)
    with ((- pv F i * along F s i + - (k F i * psi F i t / arm F i) * across F s i) + (- A) + B)
    by (unfold u_v, u_w, A, B; field; lra).
  split; (apply Rmult_lt_compat_l; [ lra |]; eapply Rle_lt_trans; [ apply Rabs_triang |];
          eapply Rle_lt_trans; [ apply Rplus_le_compat_r, Rabs_triang |]; rewrite ?Rabs_Ropp; lra).
Qed.

(** ** A quantity that falls wherever it lies above a level *)
Definition excess (c y : R) : R := Rmax (y - c) 0 ^ 2.

Lemma excess_derivative (c y : R) : is_derive (excess c) y (2 * Rmax (y - c) 0).
Proof.
  apply is_derive_Reals. intros eps He. exists (mkposreal eps He). intros h Hh Hb. simpl in Hb.
  assert (G : Rabs (excess c (y + h) - excess c y - 2 * Rmax (y - c) 0 * h) <= h ^ 2).
  { unfold excess, Rmax. destruct (Rle_dec (y + h - c) 0) as [H1 | H1], (Rle_dec (y - c) 0) as [H2 | H2];
      apply Rabs_le; split; nra. }
  replace ((excess c (y + h) - excess c y) / h - 2 * Rmax (y - c) 0)
    with ((excess c (y + h) - excess c y - 2 * Rmax (y - c) 0 * h) / h) by (field; exact Hh).
  unfold Rdiv. rewrite Rabs_mult, Rabs_inv. pose proof (Rabs_pos_lt h Hh) as Hp.
  apply Rle_lt_trans with (h ^ 2 * / Rabs h).
  - apply Rmult_le_compat_r; [ left; apply Rinv_0_lt_compat; exact Hp | exact G ].
  - rewrite <- (pow2_abs h).
    replace (Rabs h ^ 2 * / Rabs h) with (Rabs h) by (field; lra). exact Hb.
Qed.

Lemma stays_below (g dg : R -> R) (t0 c : R) :
  (forall t, t0 <= t -> is_derive g t (dg t)) -> (forall t, t0 <= t -> c <= g t -> dg t <= 0) ->
  forall t, t0 <= t -> g t <= Rmax (g t0) c.
Proof.
  intros Hd Hs t Ht. set (C := Rmax (g t0) c).
  assert (HC : c <= C /\ g t0 <= C) by (unfold C; split; [ apply Rmax_r | apply Rmax_l ]).
  assert (E : excess C (g t) <= excess C (g t0)).
  { apply (decreasing_of_derivative (fun x => excess C (g x)) t0 t Ht). intros x Hx.
    exists (2 * Rmax (g x - C) 0 * dg x). split.
    - apply (derive_comp (excess C) g); [ apply excess_derivative | apply Hd; lra ].
    - unfold Rmax. destruct (Rle_dec (g x - C) 0) as [H | H]; [ lra |].
      assert (dg x <= 0) by (apply Hs; lra). nra. }
  unfold excess in E. rewrite (Rmax_right (g t0 - C) 0) in E by lra.
  destruct (Rle_dec (g t) C) as [H | H]; [ exact H |]. rewrite Rmax_left in E by lra. nra.
Qed.

Lemma stays_within (g dg : R -> R) (t0 c : R) :
  (forall t, t0 <= t -> is_derive g t (dg t)) ->
  (forall t, t0 <= t -> c <= g t -> dg t <= 0) -> (forall t, t0 <= t -> g t <= - c -> 0 <= dg t) ->
  forall t, t0 <= t -> Rabs (g t) <= Rmax (Rabs (g t0)) c.
Proof.
  intros Hd Hs Hs' t Ht.
  pose proof (stays_below g dg t0 c Hd Hs t Ht) as H1.
  assert (H2 : - g t <= Rmax (- g t0) c).
  { apply (stays_below (fun x => - g x) (fun x => - dg x) t0 c); [ | | exact Ht ].
    - intros x Hx. apply derive_opp, Hd; exact Hx.
    - intros x Hx Hc. assert (0 <= dg x) by (apply Hs'; lra). lra. }
  pose proof (Rle_abs (g t0)) as H3. pose proof (Rle_abs (- g t0)) as H4. rewrite Rabs_Ropp in H4.
  apply Rabs_le. unfold Rmax in *.
  destruct (Rle_dec (g t0) c), (Rle_dec (- g t0) c), (Rle_dec (Rabs (g t0)) c); lra.
Qed.

(** ** L18 *)
Theorem speed_bound_holds F : A1 F -> A2 F -> A3 F -> speed_bound F.
Proof.
  intros HA [_ [_ H2]] _ i vmax t0 X Hi Ht0 HX Hv0 Hv.
  destruct (H2 i Hi) as (Hm & _ & _ & _ & Hpv & Hdv & _ & _ & _ & Hss & _).
  assert (Hpull : forall s, Rabs (pv F i * along F s i) <= dv F i * tanh (vmax / ss F i)).
  { intros s. rewrite Rabs_mult, (Rabs_pos_eq (pv F i)) by lra. pose proof (along_bound F s i HA Hi). nra. }
  assert (Hscale : forall x y, x <= y -> x / ss F i <= y / ss F i).
  { intros x y H. unfold Rdiv. apply Rmult_le_compat_r; [ left; apply Rinv_0_lt_compat; lra | exact H ]. }
  assert (Him : 0 < / m F i) by (apply Rinv_0_lt_compat; lra).
  apply (stays_within (fun t => v (X t) i) (fun t => u_v F (X t) i / m F i)).
  - intros t Ht. apply (HX i Hi t Ht).
  - intros t Ht Hc. pose proof (tanh_le _ _ (Hscale _ _ Hc)) as H3.
    pose proof (proj1 (Rabs_le_between _ _) (Hpull (X t))) as H4. unfold u_v, Rdiv at 1.
    assert (dv F i * tanh (vmax / ss F i) <= dv F i * tanh (v (X t) i / ss F i)) by nra. nra.
  - intros t Ht Hc. pose proof (tanh_le _ _ (Hscale _ _ Hc)) as H3.
    replace (- vmax / ss F i) with (- (vmax / ss F i)) in H3 by (field; lra). rewrite tanh_odd in H3.
    pose proof (proj1 (Rabs_le_between _ _) (Hpull (X t))) as H4. unfold u_v, Rdiv at 1.
    assert (dv F i * tanh (v (X t) i / ss F i) <= - (dv F i * tanh (vmax / ss F i))) by nra. nra.
Qed.

Theorem turn_rate_bound_holds F : A1 F -> A2 F -> A3 F -> turn_rate_bound F.
Proof.
  intros HA HA2 HA3 i wmax t0 X Hi Ht0 HX Hw0 Hw.
  assert (Hpull : forall t s, t0 <= t -> Rabs (pw F i * eth F s i - k F i * psi F i t * across F s i) <= dw F i * tanh (wmax / ws F i)).
  { intros t s Ht. eapply Rle_trans; [ apply turn_pull_bound; try assumption; lra | exact Hw ]. }
  destruct HA2 as [_ [_ H2]]. destruct (H2 i Hi) as (_ & HJ & _ & _ & _ & _ & _ & Hdw & _ & _ & Hws).
  assert (Hscale : forall x y, x <= y -> x / ws F i <= y / ws F i).
  { intros x y H. unfold Rdiv. apply Rmult_le_compat_r; [ left; apply Rinv_0_lt_compat; lra | exact H ]. }
  assert (Him : 0 < / J F i) by (apply Rinv_0_lt_compat; lra).
  apply (stays_within (fun t => om (X t) i) (fun t => u_w F t (X t) i / J F i)).
  - intros t Ht. apply (HX i Hi t Ht).
  - intros t Ht Hc. pose proof (tanh_le _ _ (Hscale _ _ Hc)) as H3.
    pose proof (proj1 (Rabs_le_between _ _) (Hpull t (X t) Ht)) as H4. unfold u_w, Rdiv at 1.
    assert (dw F i * tanh (wmax / ws F i) <= dw F i * tanh (om (X t) i / ws F i)) by nra. nra.
  - intros t Ht Hc. pose proof (tanh_le _ _ (Hscale _ _ Hc)) as H3.
    replace (- wmax / ws F i) with (- (wmax / ws F i)) in H3 by (field; lra). rewrite tanh_odd in H3.
    pose proof (proj1 (Rabs_le_between _ _) (Hpull t (X t) Ht)) as H4. unfold u_w, Rdiv at 1.
    assert (dw F i * tanh (om (X t) i / ws F i) <= - (dw F i * tanh (wmax / ws F i))) by nra. nra.
Qed.

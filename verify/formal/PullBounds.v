(** * PullBounds.v : L1, bounds on the pulls of the network and on the accelerations.
    Every tanh is below 1, so a pull is at most the sum of its weights.
    The pulls along and across a vehicle's heading share one vector, which Cauchy-Schwarz bounds.
    Accelerations are sums of bounded pulls and bounded damping, over mass or inertia. *)
From Coq Require Import Reals Lra Psatz.
From Gaincert Require Import Statement Sums Saturations.
Open Scope R_scope.

(** ** The coupling terms *)
Lemma coupling_bound F scale z i : A1 F -> (i < N F)%nat -> Rabs (coupling F scale z i) <= deg F i.
Proof.
  intros [Ha [Hal _]] Hi. unfold coupling, deg.
  assert (D : forall w x, 0 <= w -> Rabs (w * tanh x) <= w).
  { intros w x Hw. rewrite Rabs_mult, (Rabs_pos_eq w) by exact Hw. pose proof (tanh_abs_lt_1 x). nra. }
  eapply Rle_trans; [ apply Rabs_triang |]. apply Rplus_le_compat.
  - apply D. apply Hal; exact Hi.
  - apply sum_abs_le. intros j Hj. apply D. apply Ha; assumption.
Qed.

Lemma deg_nonneg F i : A1 F -> (i < N F)%nat -> 0 <= deg F i.
Proof.
  intros HA Hi. eapply Rle_trans; [ apply Rabs_pos | apply (coupling_bound F 1 (fun _ => 0) i HA Hi) ].
Qed.

(** Cauchy-Schwarz in the plane for a vector whose two parts are at most D. *)
Lemma pull_bound (p q x y D : R) : 0 <= D -> Rabs x <= D -> Rabs y <= D ->
  Rabs (p * x + q * y) <= sqrt 2 * D * sqrt (p ^ 2 + q ^ 2).
Proof.
  intros HD Hx Hy.
  assert (Hx2 : x ^ 2 <= D ^ 2) by (apply pow_maj_Rabs; exact Hx).
  assert (Hy2 : y ^ 2 <= D ^ 2) by (apply pow_maj_Rabs; exact Hy).
  rewrite <- (sqrt_pow2 D) by exact HD. rewrite <- !sqrt_mult_alt by nra.
  rewrite <- sqrt_Rsqr_abs. apply sqrt_le_1_alt. unfold Rsqr.
  assert (G : (p * x + q * y) * (p * x + q * y) <= (p ^ 2 + q ^ 2) * (x ^ 2 + y ^ 2)).
  { pose proof (Rle_0_sqr (p * y - q * x)) as H. unfold Rsqr in H. nra. }
  eapply Rle_trans; [ exact G |].
  assert (0 <= p ^ 2 + q ^ 2) by (pose proof (pow2_ge_0 p); pose proof (pow2_ge_0 q); lra). nra.
Qed.

Lemma unit_circle (t : R) : cos t ^ 2 + sin t ^ 2 = 1.
Proof. pose proof (sin2_cos2 t) as H. unfold Rsqr in H. lra. Qed.

Lemma along_bound F s i : A1 F -> (i < N F)%nat -> Rabs (along F s i) <= sqrt 2 * deg F i.
Proof.
  intros HA Hi. unfold along. eapply Rle_trans.
  - apply pull_bound with (D := deg F i); [ apply deg_nonneg; assumption | apply coupling_bound; assumption | apply coupling_bound; assumption ].
  - rewrite unit_circle, sqrt_1. lra.
Qed.

Lemma across_bound F s i : A1 F -> (i < N F)%nat -> Rabs (across F s i) <= sqrt 2 * deg F i.
Proof.
  intros HA Hi. unfold across. eapply Rle_trans.
  - apply pull_bound with (D := deg F i); [ apply deg_nonneg; assumption | apply coupling_bound; assumption | apply coupling_bound; assumption ].
  - replace ((- sin (th s i)) ^ 2 + cos (th s i) ^ 2) with (cos (th s i) ^ 2 + sin (th s i) ^ 2) by ring.
    rewrite unit_circle, sqrt_1. lra.
Qed.

(** ** Accelerations *)
(** Network and excitation together in the turning channel. *)
Lemma turn_pull_bound F t s i : A1 F -> A2 F -> A3 F -> (i < N F)%nat -> 0 <= t ->
  Rabs (pw F i * eth F s i - k F i * psi F i t * across F s i) <= pw F i * deg F i + cmax F i.
Proof.
  intros HA [_ [_ H2]] [_ [_ H3]] Hi Ht.
  destruct (H2 i Hi) as (_ & _ & _ & _ & _ & _ & Hpw & _ & Hk & _).
  destruct (H3 i Hi t Ht) as (_ & _ & Hpsi & _).
  eapply Rle_trans; [ apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult, (Rabs_pos_eq (pw F i)), (Rabs_pos_eq (k F i)) by lra.
  pose proof (coupling_bound F (rs F) (tha F s) i HA Hi) as H4. fold (eth F s i) in H4.
  pose proof (across_bound F s i HA Hi) as H5. unfold cmax.
  apply Rplus_le_compat; [ nra |].
  replace (sqrt 2 * k F i * psi0 F * deg F i) with (k F i * psi0 F * (sqrt 2 * deg F i)) by ring.
  pose proof (Rabs_pos (psi F i t)). apply Rmult_le_compat; [ nra | apply Rabs_pos | nra | exact H5 ].
Qed.

Lemma acceleration_bound : forall F s i, A1 F -> A2 F -> (i < N F)%nat ->
  Rabs (u_v F s i / m F i) <= (pv F i * (sqrt 2 * deg F i) + dv F i) / m F i.
Proof.
  intros F s i H1 [_ [_ H2]] Hi. destruct (H2 i Hi) as (Hm & _ & _ & _ & Hpv & Hdv & _).
  rewrite abs_div_pos by exact Hm. apply div_le; [|exact Hm].
  replace (u_v F s i) with (- (pv F i * along F s i) + - (dv F i * tanh (v s i / ss F i))) by (unfold u_v; ring).
  eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_Ropp, !Rabs_mult, (Rabs_pos_eq (pv F i)), (Rabs_pos_eq (dv F i)) by lra.
  assert (A := along_bound F s i H1 Hi). assert (B := tanh_abs_lt_1 (v s i / ss F i)). nra.
Qed.

Lemma turn_acceleration_bound : forall F t s i, A1 F -> A2 F -> A3 F -> 0 <= t -> (i < N F)%nat ->
  Rabs (u_w F t s i / J F i) <= (pw F i * deg F i + cmax F i + dw F i) / J F i.
Proof.
  intros F t s i H1 H2 H3 Ht Hi. assert (A := turn_pull_bound F t s i H1 H2 H3 Hi Ht).
  destruct H2 as [_ [_ H2]]. destruct (H2 i Hi) as (_ & HJ & _ & _ & _ & _ & Hpw & Hdw & _).
  rewrite abs_div_pos by exact HJ. apply div_le; [|exact HJ].
  replace (u_w F t s i) with (- (pw F i * eth F s i - k F i * psi F i t * across F s i)
                              + - (dw F i * tanh (om s i / ws F i))) by (unfold u_w; ring).
  eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_Ropp, (Rabs_mult (dw F i)), (Rabs_pos_eq (dw F i)) by lra.
  assert (B := tanh_abs_lt_1 (om s i / ws F i)). nra.
Qed.

(** One bound for all vehicles. *)
Lemma rates_bounded : forall F, A1 F -> A2 F -> A3 F -> exists B, 0 < B /\ forall t s i, 0 <= t -> (i < N F)%nat ->
  Rabs (u_v F s i / m F i) <= B /\ Rabs (u_w F t s i / J F i) <= B.
Proof.
  intros F H1 H2 H3.
  destruct (finite_upper_bound (N F) (fun i => (pv F i * (sqrt 2 * deg F i) + dv F i) / m F i)) as [B1 [P1 Q1]].
  destruct (finite_upper_bound (N F) (fun i => (pw F i * deg F i + cmax F i + dw F i) / J F i)) as [B2 [P2 Q2]].
  exists (B1 + B2); split; [lra|]. intros t s i Ht Hi. split.
  - assert (A := acceleration_bound F s i H1 H2 Hi). assert (B := Q1 i Hi). simpl in B. lra.
  - assert (A := turn_acceleration_bound F t s i H1 H2 H3 Ht Hi). assert (B := Q2 i Hi). simpl in B. lra.
Qed.

(** * TorqueSharp.v : the torque limit (16 star) cannot be lowered (L16).
    Send one vehicle far out along both axes, fast and fast turning, with its heading at the angle that makes both pulls add up,
    plus many full turns, so that the heading's own pull is full, too; all others stay in place.
    Every tanh is then as near to 1 as wanted, so the torque is as near to the limit as wanted. *)
From Coq Require Import Reals Lra Psatz Lia Arith.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations PullBounds.
Open Scope R_scope.

(** Only vehicle i is off by z: its coupling is the full weight times tanh. *)
Lemma lone_coupling F scale (z : nat -> R) i : a F i i = 0 -> (forall j, j <> i -> z j = 0) ->
  coupling F scale z i = deg F i * tanh (z i / scale).
Proof.
  intros Haii Hz. unfold coupling, deg. rewrite Rmult_plus_distr_r, <- sum_scal_r. f_equal.
  apply sum_ext. intros j _. destruct (Nat.eq_dec j i) as [E | E].
  - subst j. rewrite Haii. ring.
  - rewrite (Hz j E), Rminus_0_r. reflexivity.
Qed.

(** An angle beyond any given one at which p cos + q sin (taken against the diagonal) is at its largest. *)
Lemma best_angle (p q c : R) : 0 < p -> exists t, c <= t /\ p * (cos t + sin t) + q * (sin t - cos t) = sqrt 2 * sqrt (p ^ 2 + q ^ 2).
Proof.
  intros Hp. set (b := atan (q / p) + PI / 4).
  assert (Hpi := PI_RGT_0).
  destruct (archimed ((c - b) / (2 * PI))) as [Hup _].
  set (n := Z.to_nat (up ((c - b) / (2 * PI)))).
  assert (Hn : (c - b) / (2 * PI) <= INR n).
  { unfold n. destruct (Z_le_gt_dec 0 (up ((c - b) / (2 * PI)))) as [H | H].
    - rewrite INR_IZR_INZ, Z2Nat.id by exact H. lra.
    - assert (H1 : IZR (up ((c - b) / (2 * PI))) < 0) by (apply (IZR_lt _ 0); lia). pose proof (pos_INR (Z.to_nat (up ((c - b) / (2 * PI))))). lra. }
  exists (b + 2 * INR n * PI). split.
  - assert (H : (c - b) / (2 * PI) * (2 * PI) <= INR n * (2 * PI)) by (apply Rmult_le_compat_r; lra).
    replace ((c - b) / (2 * PI) * (2 * PI)) with (c - b) in H by (field; lra). lra.
  - rewrite cos_period, sin_period. unfold b. rewrite cos_plus, sin_plus, cos_PI4, sin_PI4, cos_atan, sin_atan.
    assert (H2 : 0 < sqrt 2) by (apply sqrt_lt_R0; lra).
    assert (Hq : 0 <= (q / p) ^ 2) by apply pow2_ge_0.
    assert (E : sqrt (p ^ 2 + q ^ 2) = p * sqrt (1 + (q / p)²)).
    { replace (p ^ 2 + q ^ 2) with (p ^ 2 * (1 + (q / p)²)) by (unfold Rsqr; field; lra).
      rewrite sqrt_mult_alt by apply pow2_ge_0. rewrite sqrt_pow2 by lra. reflexivity. }
    rewrite E. set (r := sqrt (1 + (q / p)²)).
    assert (Hr : 0 < r) by (apply sqrt_lt_R0; unfold Rsqr; nra).
    assert (Hr2 : r * r = 1 + (q / p) * (q / p)) by (unfold r; rewrite sqrt_sqrt; unfold Rsqr; nra).
    assert (Hs2 : sqrt 2 * sqrt 2 = 2) by (apply sqrt_sqrt; lra).
    assert (K : p * (r * r) = p + q * q / p) by (rewrite Hr2; field; lra).
    apply (Rmult_eq_reg_r (r * sqrt 2)); [| apply Rgt_not_eq, Rmult_lt_0_compat; assumption ].
    transitivity (2 * (p + q * q / p)); [ field; lra |].
    rewrite <- K. replace (sqrt 2 * (p * r) * (r * sqrt 2)) with (p * (r * r) * (sqrt 2 * sqrt 2)) by ring. rewrite Hs2. ring.
Qed.

Lemma near_one (M eps : R) : 0 <= M -> 0 < eps -> exists x, 0 < x /\ forall y, x <= y -> M - eps < M * tanh y.
Proof.
  intros HM He. destruct (tanh_tends_to_1 (1 - eps / (M + 1))) as [x [Hx H]].
  - assert (0 < eps / (M + 1)) by (apply Rdiv_lt_0_compat; lra). lra.
  - exists x. split; [ exact Hx |]. intros y Hy. specialize (H y Hy).
    assert (H1 : M * (1 - eps / (M + 1)) <= M * tanh y) by (apply Rmult_le_compat_l; lra).
    assert (H2 : M - eps < M * (1 - eps / (M + 1))).
    { replace (M * (1 - eps / (M + 1))) with (M - eps + eps / (M + 1)) by (field; lra).
      assert (0 < eps / (M + 1)) by (apply Rdiv_lt_0_compat; lra). lra. }
    lra.
Qed.

Theorem torque_sharp_holds : torque_sharp.
Proof.
  intros F HA1 HA2 i t Hi Haii Hpsi eps Heps.
  pose proof (deg_nonneg F i HA1 Hi) as HD.
  destruct HA2 as (Hls & Hrs & H2). destruct (H2 i Hi) as (_ & _ & Hwr & Harm & Hpv & Hdv & Hpw & Hdw & Hk & Hss & Hws). clear H2.
  set (D := deg F i) in *. set (kap := k F i * psi F i t / arm F i).
  assert (Hkap : (k F i * psi0 F / arm F i) ^ 2 = kap ^ 2).
  { unfold kap. rewrite <- Hpsi. unfold Rdiv. rewrite !Rpow_mult_distr, pow2_abs. reflexivity. }
  set (rho := sqrt (pv F i ^ 2 + kap ^ 2)).
  assert (Hlim : torque_limit F i = wr F i / 2 * (dv F i + sqrt 2 * D * rho + (dw F i + pw F i * D) / arm F i)).
  { unfold torque_limit, rho. rewrite Hkap. reflexivity. }
  assert (Hrho : 0 <= rho) by apply sqrt_pos. assert (Hs2 : 0 <= sqrt 2) by apply sqrt_pos.
  assert (Ha : 0 < / arm F i) by (apply Rinv_0_lt_compat; exact Harm).
  set (M := torque_limit F i) in *.
  assert (HM : 0 <= M).
  { rewrite Hlim. unfold Rdiv. apply Rmult_le_pos; [ lra |].
    assert (0 <= sqrt 2 * D * rho) by (repeat apply Rmult_le_pos; assumption).
    assert (0 <= (dw F i + pw F i * D) * / arm F i) by (apply Rmult_le_pos; [ nra | lra ]). lra. }
  destruct (near_one M eps HM Heps) as [x [Hx Hnear]].
  destruct (best_angle (pv F i) kap (leadth F + rs F * x) Hpv) as [h [Hh Hbest]]. fold rho in Hbest.
  set (far := fun j => if Nat.eq_dec j i then 1 else 0).
  assert (Fi : far i = 1) by (unfold far; destruct (Nat.eq_dec i i); [ reflexivity | contradiction ]).
  assert (Fj : forall j, j <> i -> far j = 0) by (intros j Hj; unfold far; destruct (Nat.eq_dec j i); [ contradiction | reflexivity ]).
  exists (State (fun j => offx F j + leadx F + far j * (ls F * x)) (fun j => offy F j + leady F + far j * (ls F * x))
    (fun j => leadth F + far j * (h - leadth F)) (fun _ => ss F i * x) (fun _ => ws F i * x)).
  left. set (s := State _ _ _ _ _).
  assert (Eth : th s i = h) by (simpl; rewrite Fi; ring).
  assert (Ex : ex F s i = D * tanh x).
  { unfold ex. rewrite lone_coupling; [| exact Haii | intros j Hj; unfold zx; simpl; rewrite (Fj j Hj); ring ].
    unfold zx. simpl. rewrite Fi. do 2 f_equal. field. lra. }
  assert (Ey : ey F s i = D * tanh x).
  { unfold ey. rewrite lone_coupling; [| exact Haii | intros j Hj; unfold zy; simpl; rewrite (Fj j Hj); ring ].
    unfold zy. simpl. rewrite Fi. do 2 f_equal. field. lra. }
  assert (Eh : D * tanh x <= eth F s i).
  { unfold eth. rewrite lone_coupling; [| exact Haii | intros j Hj; unfold tha; simpl; rewrite (Fj j Hj); ring ].
    fold D. apply Rmult_le_compat_l; [ exact HD |]. apply tanh_le. unfold tha. rewrite Eth.
    apply (Rmult_le_reg_r (rs F)); [ exact Hrs |]. replace ((h - leadth F) / rs F * rs F) with (h - leadth F) by (field; lra). lra. }
  assert (Ev : v s i / ss F i = x) by (simpl; field; lra).
  assert (Ew : om s i / ws F i = x) by (simpl; field; lra).
  assert (Etau : torque_plus F t s i = - (wr F i / 2 * (dv F i * tanh x + sqrt 2 * D * rho * tanh x + (dw F i * tanh x + pw F i * eth F s i) / arm F i))).
  { unfold torque_plus, u_v, u_w, along, across. rewrite Ex, Ey, Eth, Ev, Ew.
    replace (sqrt 2 * D * rho * tanh x) with (D * tanh x * (sqrt 2 * rho)) by ring. rewrite <- Hbest. unfold kap. field. lra. }
  apply Rlt_le_trans with (M * tanh x); [ apply Hnear; lra |].
  rewrite <- Rabs_Ropp. eapply Rle_trans; [| apply Rle_abs ]. rewrite Etau, Ropp_involutive, Hlim.
  rewrite Rmult_assoc. apply Rmult_le_compat_l; [ lra |].
  replace ((dv F i + sqrt 2 * D * rho + (dw F i + pw F i * D) / arm F i) * tanh x)
    with (dv F i * tanh x + sqrt 2 * D * rho * tanh x + (dw F i * tanh x + pw F i * (D * tanh x)) / arm F i) by (field; lra).
  apply Rplus_le_compat_l. unfold Rdiv. apply Rmult_le_compat_r; [ lra |]. apply Rplus_le_compat_l, Rmult_le_compat_l; lra.
Qed.

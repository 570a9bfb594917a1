(** * InverseBound.v : L9, small couplings mean small errors.
    If the coupling terms of all vehicles are small, the errors themselves are small.
    Idea: were some error large, then among the sorted errors there is a wide gap.  The vehicles above the
    gap pull against the leader and the others below; the forces among themselves cancel (tanh is odd), and
    what crosses the gap has the weight of a cut, which (A1) keeps away from zero. *)
From Coq Require Import Reals Lra Lia Bool.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations.
Open Scope R_scope.

(** ** Vehicles above a level, counted *)
Fixpoint count (n : nat) (P : nat -> bool) : nat :=
  match n with O => O | S p => (count p P + if P p then 1 else 0)%nat end.

Lemma count_at_most : forall n P, (count n P <= n)%nat.
Proof.
  intros n P. induction n as [| n IH]; simpl.
  - lia.
  - destruct (P n); lia.
Qed.

Lemma count_monotone : forall n P Q, (forall i, (i < n)%nat -> P i = true -> Q i = true) -> (count n P <= count n Q)%nat.
Proof.
  intros n P Q. induction n as [| n IH]; intros H; simpl.
  - lia.
  - assert (H1 := IH ltac:(intros i Hi; apply H; lia)).
    assert (H2 := H n ltac:(lia)).
    destruct (P n); destruct (Q n); try lia.
Qed.

Lemma count_positive : forall n P i, (i < n)%nat -> P i = true -> (1 <= count n P)%nat.
Proof.
  intros n P i. induction n as [| n IH]; intros Hi HP; simpl.
  - lia.
  - destruct (PeanoNat.Nat.eq_dec i n) as [E | E].
    + subst i. rewrite HP. lia.
    + assert (H := IH ltac:(lia) HP). lia.
Qed.

Lemma count_equal : forall n P Q, (forall i, (i < n)%nat -> P i = true -> Q i = true) -> count n P = count n Q ->
  forall i, (i < n)%nat -> P i = Q i.
Proof.
  intros n P Q. induction n as [| n IH]; intros H E i Hi; simpl in E.
  - lia.
  - assert (H1 := count_monotone n P Q ltac:(intros j Hj; apply H; lia)).
    assert (H2 := H n ltac:(lia)).
    assert (E2 : count n P = count n Q /\ P n = Q n).
    { destruct (P n); destruct (Q n); try (split; [lia | reflexivity]); lia. }
    destruct E2 as [E2 E3].
    destruct (PeanoNat.Nat.eq_dec i n) as [Ei | Ei].
    + subst i. exact E3.
    + apply IH; [intros j Hj; apply H; lia | exact E2 | lia].
Qed.

(** A count that starts at n or less and is still positive after n + 1 steps stands still once. *)
Lemma count_stands_still : forall n (c : nat -> nat), (forall l, (c (S l) <= c l)%nat) -> (c O <= n)%nat -> (1 <= c (S n))%nat ->
  exists l, (l <= n)%nat /\ c (S l) = c l.
Proof.
  intros n c Hdec H0 Hn.
  assert (H : forall p, (p <= S n)%nat -> (exists l, (l < p)%nat /\ c (S l) = c l) \/ (c p + p <= c O)%nat).
  { intros p. induction p as [| p IH]; intros Hp.
    - right. lia.
    - destruct (IH ltac:(lia)) as [[l [Hl E]] | Hle].
      + left. exists l. split; [lia | exact E].
      + assert (Hd := Hdec p).
        destruct (PeanoNat.Nat.eq_dec (c (S p)) (c p)) as [E | E].
        * left. exists p. split; [lia | exact E].
        * right. lia. }
  destruct (H (S n) ltac:(lia)) as [[l [Hl E]] | Hle].
  - exists l. split; [lia | exact E].
  - lia.
Qed.

(** A gap: if one of n numbers exceeds (n + 1) g, then some level has numbers above it,
    and those above the level lie more than g higher than the others and than 0. *)
Lemma gap : forall n (z : nat -> R) g i0, 0 < g -> (i0 < n)%nat -> INR (S n) * g < z i0 ->
  exists P : nat -> bool, P i0 = true /\
    (forall i, (i < n)%nat -> P i = true -> g < z i) /\
    (forall i j, (i < n)%nat -> (j < n)%nat -> P i = true -> P j = false -> g < z i - z j).
Proof.
  intros n z g i0 Hg Hi0 Hz.
  set (A := fun (l : nat) (i : nat) => if Rlt_dec (INR l * g) (z i) then true else false).
  assert (HA : forall l i, A l i = true -> INR l * g < z i).
  { intros l i. unfold A. destruct (Rlt_dec (INR l * g) (z i)) as [H | H]; [intros _; exact H | discriminate]. }
  assert (HA' : forall l i, A l i = false -> z i <= INR l * g).
  { intros l i. unfold A. destruct (Rlt_dec (INR l * g) (z i)) as [H | H]; [discriminate | intros _; lra]. }
  assert (HAi : forall l i, INR l * g < z i -> A l i = true).
  { intros l i H. unfold A. destruct (Rlt_dec (INR l * g) (z i)) as [K | K]; [reflexivity | contradiction]. }
  assert (Hsub : forall l i, A (S l) i = true -> A l i = true).
  { intros l i H. apply HAi. apply HA in H. rewrite S_INR in H. lra. }
  destruct (count_stands_still n (fun l => count n (A l))) as [l [Hl E]].
  - intros l. apply count_monotone. intros i _. apply Hsub.
  - apply count_at_most.
  - apply (count_positive n _ i0 Hi0). apply HAi. exact Hz.
  - exists (A (S l)).
    assert (Heq := count_equal n (A (S l)) (A l) ltac:(intros i _; apply Hsub) E).
    assert (Hpos := pos_INR l).
    split; [| split].
    + apply HAi. apply Rle_lt_trans with (2 := Hz). apply Rmult_le_compat_r; [lra |].
      apply le_INR. lia.
    + intros i Hi H. apply HA in H. rewrite S_INR in H. nra.
    + intros i j Hi Hj Pi Pj. rewrite (Heq j Hj) in Pj. apply HA in Pi. apply HA' in Pj.
      rewrite S_INR in Pi. lra.
Qed.

(** ** What holds for every set of vehicles holds with one constant *)
Lemma common_constant_of_sets : forall n (Q : (nat -> bool) -> R -> Prop),
  (forall P P' c, (forall i, (i < n)%nat -> P i = P' i) -> Q P c -> Q P' c) ->
  (forall P c c', 0 < c' -> c' <= c -> Q P c -> Q P c') ->
  (forall P, exists c, 0 < c /\ Q P c) ->
  exists c, 0 < c /\ forall P, Q P c.
Proof.
  intros n. induction n as [| n IH]; intros Q Hext Hdown Hall.
  - destruct (Hall (fun _ => true)) as [c [Hc HQ]].
    exists c. split; [exact Hc |]. intros P. apply (Hext (fun _ => true)); [intros i Hi; lia | exact HQ].
  - set (put := fun (P : nat -> bool) (b : bool) (i : nat) => if Nat.eqb i n then b else P i).
    destruct (IH (fun P c => Q (put P true) c /\ Q (put P false) c)) as [c [Hc HQ]].
    + intros P P' c HP [H1 H2].
      assert (Hput : forall b i, (i < S n)%nat -> put P b i = put P' b i).
      { intros b i Hi. unfold put. destruct (Nat.eqb i n) eqn:E; [reflexivity |].
        apply PeanoNat.Nat.eqb_neq in E. apply HP. lia. }
      split.
      * apply (Hext _ _ c (Hput true) H1).
      * apply (Hext _ _ c (Hput false) H2).
    + intros P c c' Hc' Hcc [H1 H2]. split.
      * apply (Hdown _ c c' Hc' Hcc H1).
      * apply (Hdown _ c c' Hc' Hcc H2).
    + intros P. destruct (Hall (put P true)) as [c1 [Hc1 H1]]. destruct (Hall (put P false)) as [c2 [Hc2 H2]].
      assert (Hm : 0 < Rmin c1 c2) by (apply Rmin_glb_lt; assumption).
      exists (Rmin c1 c2). split; [exact Hm | split].
      * apply (Hdown _ c1 _ Hm (Rmin_l c1 c2) H1).
      * apply (Hdown _ c2 _ Hm (Rmin_r c1 c2) H2).
    + exists c. split; [exact Hc |]. intros P. destruct (HQ P) as [H1 H2].
      destruct (P n) eqn:E.
      * apply (Hext (put P true)); [| exact H1]. intros i Hi. unfold put.
        destruct (Nat.eqb i n) eqn:Ei; [| reflexivity]. apply PeanoNat.Nat.eqb_eq in Ei. subst i. symmetry. exact E.
      * apply (Hext (put P false)); [| exact H2]. intros i Hi. unfold put.
        destruct (Nat.eqb i n) eqn:Ei; [| reflexivity]. apply PeanoNat.Nat.eqb_eq in Ei. subst i. symmetry. exact E.
Qed.

(** ** Cuts *)
Definition cut (F : fleet) (P : nat -> bool) : R :=
  sum (N F) (fun i => if P i then al F i + sum (N F) (fun j => if P j then 0 else a F i j) else 0).

Lemma cut_ext : forall F P P', (forall i, (i < N F)%nat -> P i = P' i) -> cut F P = cut F P'.
Proof.
  intros F P P' H. unfold cut. apply sum_ext. intros i Hi. rewrite (H i Hi).
  destruct (P' i); [| reflexivity]. f_equal. apply sum_ext. intros j Hj. rewrite (H j Hj). reflexivity.
Qed.

(** kappa_cut > 0: the weakest cut is positive. *)
Lemma weakest_cut : forall F, A1 F -> exists kappa, 0 < kappa /\
  forall P : nat -> bool, (exists i, (i < N F)%nat /\ P i = true) -> kappa <= cut F P.
Proof.
  intros F [_ [_ HA]].
  apply (common_constant_of_sets (N F) (fun P c => (exists i, (i < N F)%nat /\ P i = true) -> c <= cut F P)).
  - intros P P' c HP H [i [Hi Ht]]. rewrite <- (cut_ext F P P' HP). apply H.
    exists i. split; [exact Hi |]. rewrite (HP i Hi). exact Ht.
  - intros P c c' _ Hcc H Hne. apply Rle_trans with c; [exact Hcc | apply H; exact Hne].
  - intros P. destruct (Rlt_dec 0 (cut F P)) as [Hp | Hp].
    + exists (cut F P). split; [exact Hp |]. intros _. apply Rle_refl.
    + exists 1. split; [lra |]. intros Hne. exfalso. apply Hp. apply HA. exact Hne.
Qed.

(** Forces inside a set cancel. *)
Lemma antisymmetric_sum : forall n (f : nat -> nat -> R), (forall i j, (i < n)%nat -> (j < n)%nat -> f i j = - f j i) ->
  sum n (fun i => sum n (fun j => f i j)) = 0.
Proof.
  intros n f H.
  assert (E : sum n (fun i => sum n (fun j => f i j)) = - sum n (fun i => sum n (fun j => f i j))).
  { rewrite sum_swap at 1. rewrite <- sum_opp. apply sum_ext. intros i Hi.
    rewrite <- sum_opp. apply sum_ext. intros j Hj. apply H; assumption. }
  lra.
Qed.

(** The couplings of the vehicles above a gap add up to at least tanh of the gap times the cut. *)
Lemma cut_pull : forall F, A1 F -> forall scale, 0 < scale -> forall g z P, 0 < g ->
  (forall i, (i < N F)%nat -> P i = true -> g < z i) ->
  (forall i j, (i < N F)%nat -> (j < N F)%nat -> P i = true -> P j = false -> g < z i - z j) ->
  tanh (g / scale) * cut F P <= sum (N F) (fun i => if P i then coupling F scale z i else 0).
Proof.
  intros F [Ha [Hal _]] scale Hs g z P Hg Hup Hgap.
  assert (Hsc : forall x, g < x -> tanh (g / scale) <= tanh (x / scale)).
  { intros x Hx. apply tanh_le. apply Rmult_le_compat_r; [| lra].
    apply Rlt_le. apply Rinv_0_lt_compat. exact Hs. }
  set (e := fun i j => a F i j * tanh ((z i - z j) / scale)).
  set (inner := fun i j => if P i then (if P j then e i j else 0) else 0).
  assert (Hinner : sum (N F) (fun i => sum (N F) (fun j => inner i j)) = 0).
  { apply antisymmetric_sum. intros i j Hi Hj. unfold inner, e.
    destruct (P i); destruct (P j); try lra.
    rewrite (proj1 (Ha i j Hi Hj)).
    replace ((z i - z j) / scale) with (- ((z j - z i) / scale)) by (field; lra).
    rewrite tanh_odd. ring. }
  rewrite <- (Rplus_0_l (tanh (g / scale) * cut F P)). rewrite <- Hinner at 1.
  unfold cut. rewrite <- sum_scal_l. rewrite <- sum_plus.
  apply sum_le. intros i Hi. unfold inner.
  destruct (P i) eqn:Pi.
  - unfold coupling. rewrite Rmult_plus_distr_l. rewrite <- sum_scal_l.
    rewrite Rplus_comm. rewrite Rplus_assoc. rewrite <- sum_plus.
    apply Rplus_le_compat.
    + rewrite Rmult_comm. apply Rmult_le_compat_l; [apply Hal; exact Hi |].
      apply Hsc. apply Hup; assumption.
    + apply sum_le. intros j Hj. destruct (P j) eqn:Pj.
      * unfold e. lra.
      * rewrite Rplus_0_r. rewrite Rmult_comm. apply Rmult_le_compat_l; [apply (proj2 (Ha i j Hi Hj)) |].
        apply Hsc. apply Hgap; assumption.
  - rewrite sum_zero by (intros j Hj; reflexivity). lra.
Qed.

(** ** L9 *)
Lemma inverse_bound_above : forall F, A1 F -> forall scale, 0 < scale -> forall eps, 0 < eps ->
  exists chi, 0 < chi /\ forall z, (forall i, (i < N F)%nat -> Rabs (coupling F scale z i) <= chi) ->
    forall i, (i < N F)%nat -> z i <= eps.
Proof.
  intros F HA scale Hs eps Heps.
  destruct (weakest_cut F HA) as [kappa [Hk Hcut]].
  set (n1 := INR (S (N F))).
  assert (Hn1 : 0 < n1) by (apply lt_0_INR; lia).
  set (g := eps / n1 / 2).
  assert (Hen : 0 < eps / n1) by (apply Rdiv_lt_0_compat; lra).
  assert (Hg : 0 < g) by (unfold g; lra).
  assert (Htg : 0 < tanh (g / scale)) by (apply tanh_pos; apply Rdiv_lt_0_compat; lra).
  assert (Hkt : 0 < tanh (g / scale) * kappa) by (apply Rmult_lt_0_compat; lra).
  exists (tanh (g / scale) * kappa / n1 / 2).
  assert (Hchi : 0 < tanh (g / scale) * kappa / n1) by (apply Rdiv_lt_0_compat; lra).
  split; [lra |].
  intros z Hz i Hi. apply Rnot_lt_le. intros Hbig.
  destruct (gap (N F) z g i Hg Hi) as [P [HPi [Hup Hgap]]].
  { fold n1. apply Rlt_trans with eps; [| exact Hbig].
    unfold g. replace (n1 * (eps / n1 / 2)) with (eps / 2) by (field; lra). lra. }
  assert (H1 := cut_pull F HA scale Hs g z P Hg Hup Hgap).
  assert (H2 : tanh (g / scale) * kappa <= tanh (g / scale) * cut F P).
  { apply Rmult_le_compat_l; [lra |]. apply Hcut. exists i. split; assumption. }
  assert (H3 : sum (N F) (fun i => if P i then coupling F scale z i else 0)
               <= sum (N F) (fun _ => tanh (g / scale) * kappa / n1 / 2)).
  { apply sum_le. intros j Hj. destruct (P j).
    - apply Rle_trans with (1 := Rle_abs _). apply Hz. exact Hj.
    - lra. }
  rewrite sum_const in H3.
  assert (H4 : INR (N F) * (tanh (g / scale) * kappa / n1 / 2) <= n1 * (tanh (g / scale) * kappa / n1 / 2)).
  { apply Rmult_le_compat_r; [lra |]. apply le_INR. lia. }
  replace (n1 * (tanh (g / scale) * kappa / n1 / 2)) with (tanh (g / scale) * kappa / 2) in H4 by (field; lra).
  lra.
Qed.

Lemma coupling_opp : forall F scale z i, coupling F scale (fun j => - z j) i = - coupling F scale z i.
Proof.
  intros F scale z i. unfold coupling. rewrite Ropp_plus_distr. rewrite <- sum_opp. f_equal.
  - replace (- z i / scale) with (- (z i / scale)) by (unfold Rdiv; ring). rewrite tanh_odd. ring.
  - apply sum_ext. intros j _.
    replace ((- z i - - z j) / scale) with (- ((z i - z j) / scale)) by (unfold Rdiv; ring).
    rewrite tanh_odd. ring.
Qed.

Lemma inverse_bound : forall F, A1 F -> forall scale, 0 < scale -> forall eps, 0 < eps ->
  exists chi, 0 < chi /\ forall z, (forall i, (i < N F)%nat -> Rabs (coupling F scale z i) <= chi) ->
    forall i, (i < N F)%nat -> Rabs (z i) <= eps.
Proof.
  intros F HA scale Hs eps Heps.
  destruct (inverse_bound_above F HA scale Hs eps Heps) as [chi [Hchi H]].
  exists chi. split; [exact Hchi |]. intros z Hz i Hi. apply Rabs_le.
  assert (H1 := H z Hz i Hi).
  assert (H2 := H (fun j => - z j) ltac:(intros j Hj; rewrite coupling_opp; rewrite Rabs_Ropp; apply Hz; exact Hj) i Hi).
  simpl in H2. lra.
Qed.

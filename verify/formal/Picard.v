(** * Picard.v : existence and uniqueness of motions, for any law of motion x' = f(t, x) (theorem, part (a); L1).
    Two motions driven by states that differ by E exp(2 L (t - t0)) differ by half of that: the law halves the difference.
    So guesses, each driven by the one before it, close in on a motion; and two motions from one start are one and the same.
    The law need be Lipschitz only in a region P that the guesses cannot leave (here: speeds within what the torques allow). *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Calculus.
Open Scope R_scope.

(** ** Increments from derivatives *)
Lemma increment_below (g dg h dh : R -> R) (s t : R) : s <= t ->
  (forall x, s <= x <= t -> is_derive g x (dg x)) -> (forall x, s <= x <= t -> is_derive h x (dh x)) ->
  (forall x, s <= x <= t -> Rabs (dg x) <= dh x) -> Rabs (g t - g s) <= h t - h s.
Proof.
  intros Ht Hg Hh Hb. apply Rabs_le. split.
  - assert (H : - g t - - g s <= h t - h s); [| lra ].
    apply (compare_increments (fun x => - g x) h s t Ht). intros x Hx. exists (- dg x), (dh x).
    split; [ apply derive_opp, Hg; exact Hx | split; [ apply Hh; exact Hx |]].
    pose proof (Rle_abs (- dg x)) as H. rewrite Rabs_Ropp in H. specialize (Hb x Hx). lra.
  - apply (compare_increments g h s t Ht). intros x Hx. exists (dg x), (dh x).
    split; [ apply Hg; exact Hx | split; [ apply Hh; exact Hx |]]. pose proof (Rle_abs (dg x)). specialize (Hb x Hx). lra.
Qed.

Lemma exp_weight_derivative (K c s x : R) : is_derive (fun y => K * exp (c * (y - s))) x (K * c * exp (c * (x - s))).
Proof.
  apply derive_value with (K * (exp (c * (x - s)) * (c * (1 - 0)))); [| ring ].
  apply derive_scal, (derive_exp (fun y => c * (y - s))), derive_scal, derive_minus; [ apply derive_id | apply derive_const ].
Qed.

Lemma exp_weight_ge_1 (L s : R) : 0 < L -> 0 <= s -> 1 <= exp (2 * L * s).
Proof.
  intros HL Hs. rewrite <- exp_0. destruct Hs as [Hs | Hs].
  - left. apply exp_increasing. apply Rmult_lt_0_compat; lra.
  - rewrite <- Hs, Rmult_0_r. lra.
Qed.

Lemma halves (L E s t : R) (g dg : R -> R) : 0 < L -> 0 <= E -> s <= t -> g s = 0 ->
  (forall x, s <= x <= t -> is_derive g x (dg x)) ->
  (forall x, s <= x <= t -> Rabs (dg x) <= L * (E * exp (2 * L * (x - s)))) ->
  Rabs (g t) <= E / 2 * exp (2 * L * (t - s)).
Proof.
  intros HL HE Ht Hg0 Hg Hb.
  assert (H : Rabs (g t - g s) <= E / 2 * exp (2 * L * (t - s)) - E / 2 * exp (2 * L * (s - s))).
  { apply (increment_below g dg (fun x => E / 2 * exp (2 * L * (x - s))) (fun x => E / 2 * (2 * L) * exp (2 * L * (x - s)))); try assumption.
    - intros x _. apply exp_weight_derivative.
    - intros x Hx. specialize (Hb x Hx). lra. }
  rewrite Hg0, Rminus_0_r in H. pose proof (exp_pos (2 * L * (s - s))). nra.
Qed.

Lemma half_powers_vanish (K eps : R) : 0 <= K -> 0 < eps -> exists n, forall p, (n <= p)%nat -> K * (/ 2) ^ p < eps.
Proof.
  intros HK He.
  assert (H : is_lim_seq (fun n => K * (/ 2) ^ n) 0).
  { replace (Finite 0) with (Finite (K * 0)) by (f_equal; ring).
    apply is_lim_seq_mult'; [ apply is_lim_seq_const |].
    apply is_lim_seq_geom. rewrite Rabs_pos_eq; lra. }
  apply is_lim_seq_spec in H. destruct (H (mkposreal eps He)) as [n Hn]. exists n. intros p Hp.
  specialize (Hn p Hp). simpl in Hn. pose proof (Rle_abs (K * (/ 2) ^ p - 0)). lra.
Qed.

Lemma no_difference (x y : R) : Rabs (x - y) <= 0 -> x = y.
Proof.
  intros H. apply Rminus_diag_uniq. destruct (Req_dec (x - y) 0) as [H1 | H1]; [ exact H1 |]. apply Rabs_pos_lt in H1. lra.
Qed.

Lemma halving_all (e K : R) : 0 <= K -> (forall n : nat, e <= K * (/ 2) ^ n) -> e <= 0.
Proof.
  intros HK H. destruct (Rle_lt_dec e 0) as [H1 | H1]; [ exact H1 |].
  destruct (half_powers_vanish K e HK H1) as [n Hn]. specialize (Hn n (le_n n)). specialize (H n). lra.
Qed.

(** ** The law of motion *)
Section Picard.
Variables (Ix : Type) (ok : Ix -> Prop) (f : R -> (Ix -> R) -> Ix -> R) (t0 : R) (P : R -> (Ix -> R) -> Prop).

Definition inside (Y : R -> Ix -> R) := forall t, t0 <= t -> P t (Y t).
(** Z is driven by Y: its velocity is what the law says at Y. *)
Definition driven (Y Z : R -> Ix -> R) := forall c, ok c -> forall t, t0 <= t -> is_derive (fun s => Z s c) t (f t (Y t) c).

Definition lipschitz_until (S L : R) := 0 < L /\ forall t x y e, t0 <= t <= t0 + S -> P t x -> P t y ->
  (forall c, ok c -> Rabs (x c - y c) <= e) -> forall c, ok c -> Rabs (f t x c - f t y c) <= L * e.

Lemma law_halves S L Y Y' Z Z' E : lipschitz_until S L -> inside Y -> inside Y' -> driven Y Z -> driven Y' Z' ->
  (forall c, ok c -> Z t0 c = Z' t0 c) -> 0 <= E ->
  (forall t, t0 <= t <= t0 + S -> forall c, ok c -> Rabs (Y t c - Y' t c) <= E * exp (2 * L * (t - t0))) ->
  forall t, t0 <= t <= t0 + S -> forall c, ok c -> Rabs (Z t c - Z' t c) <= E / 2 * exp (2 * L * (t - t0)).
Proof.
  intros [HL Hlip] HY HY' HZ HZ' Hs HE Hd t Ht c Hc.
  apply (halves L E t0 t (fun s => Z s c - Z' s c) (fun s => f s (Y s) c - f s (Y' s) c)); try lra.
  - rewrite (Hs c Hc). ring.
  - intros x Hx. apply derive_minus.
    + apply HZ; [ exact Hc | lra ].
    + apply HZ'; [ exact Hc | lra ].
  - intros x Hx. apply Hlip; [ lra | apply HY; lra | apply HY'; lra | | exact Hc ].
    intros c' Hc'. apply Hd; [ lra | exact Hc' ].
Qed.

(** ** Uniqueness *)
Lemma one_motion S L X Y E : lipschitz_until S L -> inside X -> inside Y -> driven X X -> driven Y Y ->
  (forall c, ok c -> X t0 c = Y t0 c) -> 0 <= E ->
  (forall t, t0 <= t <= t0 + S -> forall c, ok c -> Rabs (X t c - Y t c) <= E) ->
  forall t, t0 <= t <= t0 + S -> forall c, ok c -> X t c = Y t c.
Proof.
  intros HL HX HY DX DY Hs HE Hb.
  assert (G : forall n t, t0 <= t <= t0 + S -> forall c, ok c -> Rabs (X t c - Y t c) <= E * (/ 2) ^ n * exp (2 * L * (t - t0))).
  { induction n as [| n IH]; intros t Ht c Hc.
    - specialize (Hb t Ht c Hc). simpl. assert (H : 1 <= exp (2 * L * (t - t0))) by (apply exp_weight_ge_1; [ apply HL | lra ]). nra.
    - replace (E * (/ 2) ^ Datatypes.S n) with (E * (/ 2) ^ n / 2) by (simpl; field).
      apply (law_halves S L X Y X Y); try assumption.
      apply Rmult_le_pos; [ exact HE | apply pow_le; lra ]. }
  intros t Ht c Hc.
  apply no_difference, (halving_all _ (E * exp (2 * L * (t - t0)))).
  - apply Rmult_le_pos; [ exact HE | left; apply exp_pos ].
  - intros n. specialize (G n t Ht c Hc). lra.
Qed.

(** ** Existence *)
Variable x0 : Ix -> R.
Hypothesis lipschitz : forall S, 0 <= S -> exists L, lipschitz_until S L.
Hypothesis bounded : forall S, 0 <= S -> exists M, 0 <= M /\ forall t x, t0 <= t <= t0 + S -> P t x -> forall c, ok c -> Rabs (f t x c) <= M.
Hypothesis start_inside : forall t, t0 <= t -> P t x0.
Hypothesis driven_inside : forall Y Z, inside Y -> (forall c, ok c -> Z t0 c = x0 c) -> driven Y Z -> inside Z.
Hypothesis limit_inside : forall t u x, (forall n : nat, P t (u n)) -> (forall c, ok c -> is_lim_seq (fun n => u n c) (Finite (x c))) -> P t x.
Hypothesis law_continuous : forall Y, inside Y -> (forall c, ok c -> forall t, continuous (fun s => Y s c) t) ->
  forall c, ok c -> forall t, continuous (fun s => f (Rmax t0 s) (Y (Rmax t0 s)) c) t.

(** The motion driven by Y from x0; before t0 it goes on along its tangent. *)
Definition drive (Y : R -> Ix -> R) (t : R) (c : Ix) : R := x0 c + RInt (fun s => f (Rmax t0 s) (Y (Rmax t0 s)) c) t0 t.
Definition smooth (Y : R -> Ix -> R) := forall c, ok c -> forall t, continuous (fun s => Y s c) t.

Lemma drive_starts Y c : drive Y t0 c = x0 c.
Proof. unfold drive. rewrite RInt_point. change (x0 c + 0 = x0 c). ring. Qed.

Lemma drive_derivative Y : inside Y -> smooth Y -> forall c, ok c -> forall t, is_derive (fun s => drive Y s c) t (f (Rmax t0 t) (Y (Rmax t0 t)) c).
Proof.
  intros HY CY c Hc t. pose proof (law_continuous Y HY CY c Hc) as C. unfold drive.
  set (g := fun s => f (Rmax t0 s) (Y (Rmax t0 s)) c) in *. change (is_derive (fun s => x0 c + RInt g t0 s) t (g t)).
  replace (g t) with (0 + g t) by ring.
  apply (is_derive_plus (fun _ => x0 c) (fun s => RInt g t0 s) t 0 (g t)); [ apply (is_derive_const (x0 c) t) |].
  apply (is_derive_RInt g (fun s => RInt g t0 s) t0 t); [| apply C ].
  apply filter_forall. intros s. apply (RInt_correct g t0 s). apply (ex_RInt_continuous g t0 s). intros z _. apply C.
Qed.

Lemma drive_driven Y : inside Y -> smooth Y -> driven Y (drive Y).
Proof. intros HY CY c Hc t Ht. pose proof (drive_derivative Y HY CY c Hc t) as H. rewrite Rmax_right in H by lra. exact H. Qed.

Lemma drive_smooth Y : inside Y -> smooth Y -> smooth (drive Y).
Proof. intros HY CY c Hc t. apply (ex_derive_continuous (fun s => drive Y s c) t). eexists. apply (drive_derivative Y HY CY c Hc t). Qed.

Lemma drive_inside Y : inside Y -> smooth Y -> inside (drive Y).
Proof. intros HY CY. apply (driven_inside Y); [ exact HY | intros c _; apply drive_starts | apply drive_driven; assumption ]. Qed.

Fixpoint guess (n : nat) : R -> Ix -> R := match n with O => fun _ => x0 | S p => drive (guess p) end.

Lemma guess_good n : inside (guess n) /\ smooth (guess n).
Proof.
  induction n as [| n [IH1 IH2]]; simpl.
  - split; [ exact start_inside |]. intros c Hc t. apply (continuous_const (x0 c) t).
  - split; [ apply drive_inside; assumption | apply drive_smooth; assumption ].
Qed.

Lemma guess_starts n c : guess n t0 c = x0 c.
Proof. destruct n; simpl; [ reflexivity | apply drive_starts ]. Qed.

Lemma guesses_close (S : R) : 0 <= S -> exists K, 0 <= K /\ forall n t c, t0 <= t <= t0 + S -> ok c ->
  Rabs (guess (Datatypes.S n) t c - guess n t c) <= K * (/ 2) ^ n.
Proof.
  intros HS. destruct (lipschitz S HS) as [L HL]. destruct (bounded S HS) as [M [HM HB]].
  assert (Hexp : forall t, t0 <= t <= t0 + S -> 1 <= exp (2 * L * (t - t0)) <= exp (2 * L * S)).
  { intros t Ht. destruct HL as [HL _]. split; [ apply exp_weight_ge_1; lra |].
    assert (H2 : 2 * L * (t - t0) <= 2 * L * S) by (apply Rmult_le_compat_l; lra).
    destruct H2 as [H2 | H2]; [ left; apply exp_increasing; exact H2 | rewrite H2; lra ]. }
  assert (G : forall n t, t0 <= t <= t0 + S -> forall c, ok c ->
    Rabs (guess (Datatypes.S n) t c - guess n t c) <= M * S * (/ 2) ^ n * exp (2 * L * (t - t0))).
  { induction n as [| n IH]; intros t Ht c Hc.
    - simpl guess. destruct (guess_good 0) as [G1 G2]. simpl in G1, G2.
      assert (H : Rabs (drive (fun _ => x0) t c - drive (fun _ => x0) t0 c) <= M * (t - t0)).
      { apply (increment_abs (fun s => drive (fun _ => x0) s c) t0 t M (proj1 Ht)). intros x Hx. exists (f x x0 c). split.
        - apply (drive_driven (fun _ => x0) G1 G2 c Hc x). lra.
        - apply HB; [ lra | apply start_inside; lra | exact Hc ]. }
      rewrite drive_starts in H. simpl pow.
      pose proof (proj1 (Hexp t Ht)) as H2.
      assert (M * (t - t0) <= M * S) by (apply Rmult_le_compat_l; lra).
      assert (0 <= M * S) by (apply Rmult_le_pos; lra). nra.
    - replace (M * S * (/ 2) ^ Datatypes.S n) with (M * S * (/ 2) ^ n / 2) by (simpl; field).
      destruct (guess_good n) as [G1 G2]. destruct (guess_good (Datatypes.S n)) as [G3 G4].
      apply (law_halves S L (guess (Datatypes.S n)) (guess n)); try assumption.
      + apply drive_driven; assumption.
      + apply drive_driven; assumption.
      + intros c' _. rewrite (guess_starts (Datatypes.S (Datatypes.S n))), (guess_starts (Datatypes.S n)). reflexivity.
      + apply Rmult_le_pos; [ apply Rmult_le_pos; assumption | apply pow_le; lra ]. }
  exists (M * S * exp (2 * L * S)). assert (0 <= M * S) by (apply Rmult_le_pos; assumption). split.
  - apply Rmult_le_pos; [ assumption | left; apply exp_pos ].
  - intros n t c Ht Hc. eapply Rle_trans; [ apply G; assumption |].
    assert (0 <= M * S * (/ 2) ^ n) by (apply Rmult_le_pos; [ assumption | apply pow_le; lra ]).
    pose proof (proj2 (Hexp t Ht)). nra.
Qed.

Definition motion (t : R) (c : Ix) : R := real (Lim_seq (fun n => guess n (Rmax t0 t) c)).

Lemma guesses_converge (S : R) : 0 <= S -> exists K, 0 <= K /\ forall t c, t0 <= t <= t0 + S -> ok c ->
  is_lim_seq (fun n => guess n t c) (Finite (motion t c)) /\ forall n, Rabs (motion t c - guess n t c) <= K * (/ 2) ^ n.
Proof.
  intros HS. destruct (guesses_close S HS) as [K [HK HG]]. exists (2 * K). split; [ lra |]. intros t c Ht Hc.
  assert (A : forall n p, Rabs (guess (n + p) t c - guess n t c) <= 2 * K * (/ 2) ^ n - 2 * K * (/ 2) ^ (n + p)).
  { intros n p. induction p as [| p IH].
    - rewrite Nat.add_0_r, !Rminus_diag_eq by reflexivity. rewrite Rabs_R0. lra.
    - rewrite Nat.add_succ_r. replace (guess (Datatypes.S (n + p)) t c - guess n t c)
        with ((guess (Datatypes.S (n + p)) t c - guess (n + p) t c) + (guess (n + p) t c - guess n t c)) by ring.
      eapply Rle_trans; [ apply Rabs_triang |]. specialize (HG (n + p)%nat t c Ht Hc).
      replace (2 * K * (/ 2) ^ Datatypes.S (n + p)) with (K * (/ 2) ^ (n + p)) by (simpl; field). lra. }
  assert (B : forall n p, (n <= p)%nat -> Rabs (guess p t c - guess n t c) <= 2 * K * (/ 2) ^ n).
  { intros n p Hp. replace p with (n + (p - n))%nat by (rewrite Nat.add_comm; apply Nat.sub_add; exact Hp).
    eapply Rle_trans; [ apply A |]. assert (0 <= 2 * K * (/ 2) ^ (n + (p - n))) by (apply Rmult_le_pos; [ lra | apply pow_le; lra ]). lra. }
  assert (C : is_lim_seq (fun n => guess n t c) (Finite (motion t c))).
  { unfold motion. rewrite Rmax_right by lra. apply Lim_seq_correct'. apply ex_lim_seq_cauchy_corr. intros eps.
    destruct (half_powers_vanish (2 * K) (eps / 2)) as [n Hn]; [ lra | destruct eps; simpl; lra |].
    exists n. intros p q Hp Hq. specialize (Hn n (le_n n)). pose proof (B n p Hp) as H1. pose proof (B n q Hq) as H2.
    replace (guess p t c - guess q t c) with ((guess p t c - guess n t c) - (guess q t c - guess n t c)) by ring.
    eapply Rle_lt_trans; [ apply Rabs_triang |]. rewrite Rabs_Ropp. lra. }
  split; [ exact C |]. intros n.
  assert (D : is_lim_seq (fun p => Rabs (guess p t c - guess n t c)) (Finite (Rabs (motion t c - guess n t c)))).
  { apply (is_lim_seq_abs (fun p => guess p t c - guess n t c) (Finite (motion t c - guess n t c))).
    apply is_lim_seq_minus'; [ exact C | apply is_lim_seq_const ]. }
  assert (E : Rbar_le (Finite (Rabs (motion t c - guess n t c))) (Finite (2 * K * (/ 2) ^ n))).
  { apply (is_lim_seq_le_loc (fun p => Rabs (guess p t c - guess n t c)) (fun _ => 2 * K * (/ 2) ^ n)); [| exact D | apply is_lim_seq_const ].
    exists n. intros p Hp. apply B; exact Hp. }
  exact E.
Qed.

Lemma motion_inside : inside motion.
Proof.
  intros t Ht. apply (limit_inside t (fun n => guess n t)).
  - intros n. apply (guess_good n). exact Ht.
  - intros c Hc. destruct (guesses_converge (t - t0)) as [K [_ H]]; [ lra |]. apply H; [ lra | exact Hc ].
Qed.

Lemma clamp_close (t s : R) : Rabs (Rmax t0 s - Rmax t0 t) <= Rabs (s - t).
Proof.
  unfold Rmax. destruct (Rle_dec t0 s), (Rle_dec t0 t); unfold Rabs; repeat destruct Rcase_abs; lra.
Qed.

Lemma clamp_continuous (t : R) : continuous (fun s => Rmax t0 s) t.
Proof.
  apply filterlim_locally. intros eps. exists eps. intros s Hs.
  change (Rabs (s - t) < eps) in Hs. change (Rabs (Rmax t0 s - Rmax t0 t) < eps). pose proof (clamp_close t s). lra.
Qed.

Lemma motion_smooth : smooth motion.
Proof.
  intros c Hc t. set (S := Rmax t0 t - t0 + 1).
  assert (HS : 0 <= S) by (unfold S; pose proof (Rmax_l t0 t); lra).
  destruct (guesses_converge S HS) as [K [HK HG]].
  apply filterlim_locally. intros eps. pose proof (cond_pos eps) as He.
  destruct (half_powers_vanish K (eps / 3)) as [n Hn]; [ exact HK | lra |]. specialize (Hn n (le_n n)).
  assert (C : continuous (fun s => guess n (Rmax t0 s) c) t).
  { apply (continuous_comp (fun s => Rmax t0 s) (fun s => guess n s c) t); [ apply clamp_continuous | apply (guess_good n); exact Hc ]. }
  assert (He3 : 0 < eps / 3) by lra.
  pose proof (proj1 (filterlim_locally _ _) C (mkposreal _ He3)) as [d Hd].
  assert (Hm : 0 < Rmin d 1) by (apply Rmin_pos; [ apply cond_pos | lra ]).
  exists (mkposreal _ Hm). intros s Hs. change (Rabs (s - t) < Rmin d 1) in Hs.
  assert (H1 : Rabs (s - t) < d) by (eapply Rlt_le_trans; [ exact Hs | apply Rmin_l ]).
  assert (H2 : Rabs (s - t) < 1) by (eapply Rlt_le_trans; [ exact Hs | apply Rmin_r ]).
  specialize (Hd s H1). change (Rabs (guess n (Rmax t0 s) c - guess n (Rmax t0 t) c) < eps / 3) in Hd.
  change (Rabs (motion s c - motion t c) < eps).
  assert (Ms : forall r, motion r c = motion (Rmax t0 r) c).
  { intros r. unfold motion. f_equal. f_equal. rewrite (Rmax_right t0 (Rmax t0 r)) by apply Rmax_l. reflexivity. }
  rewrite (Ms s), (Ms t).
  pose proof (clamp_close t s) as H3. apply Rabs_le_between in H3.
  assert (R1 : t0 <= Rmax t0 s <= t0 + S) by (unfold S; split; [ apply Rmax_l | lra ]).
  assert (R2 : t0 <= Rmax t0 t <= t0 + S) by (unfold S; split; [ apply Rmax_l | lra ]).
  pose proof (proj2 (HG _ c R1 Hc) n) as G1. pose proof (proj2 (HG _ c R2 Hc) n) as G2.
  replace (motion (Rmax t0 s) c - motion (Rmax t0 t) c)
    with ((motion (Rmax t0 s) c - guess n (Rmax t0 s) c) + (guess n (Rmax t0 s) c - guess n (Rmax t0 t) c) - (motion (Rmax t0 t) c - guess n (Rmax t0 t) c)) by ring.
  eapply Rle_lt_trans; [ apply Rabs_triang |]. rewrite Rabs_Ropp.
  eapply Rle_lt_trans; [ apply Rplus_le_compat_r, Rabs_triang |]. lra.
Qed.

Lemma motion_drives_itself t c : t0 <= t -> ok c -> drive motion t c = motion t c.
Proof.
  intros Ht Hc. set (S := t - t0). assert (HS : 0 <= S) by (unfold S; lra).
  destruct (guesses_converge S HS) as [K [HK HG]]. destruct (lipschitz S HS) as [L HL].
  apply no_difference, (halving_all _ (K * exp (2 * L * S) + K)).
  - assert (0 <= K * exp (2 * L * S)) by (apply Rmult_le_pos; [ exact HK | left; apply exp_pos ]). lra.
  - intros n. assert (Hn : 0 <= K * (/ 2) ^ n) by (apply Rmult_le_pos; [ exact HK | apply pow_le; lra ]).
    assert (Hr : t0 <= t <= t0 + S) by (unfold S; lra).
    pose proof (proj2 (HG t c Hr Hc) (Datatypes.S n)) as H1.
    destruct (guess_good n) as [G1 G2].
    assert (H2 : Rabs (drive motion t c - drive (guess n) t c) <= K * (/ 2) ^ n / 2 * exp (2 * L * (t - t0))).
    { apply (law_halves S L motion (guess n)); try assumption.
      - apply motion_inside.
      - apply drive_driven; [ apply motion_inside | apply motion_smooth ].
      - apply drive_driven; assumption.
      - intros c' _. rewrite !drive_starts. reflexivity.
      - intros r Hr' c' Hc'. pose proof (proj2 (HG r c' Hr' Hc') n) as H3.
        assert (H4 : 1 <= exp (2 * L * (r - t0))) by (apply exp_weight_ge_1; [ apply HL | lra ]). nra. }
    change (drive (guess n)) with (guess (Datatypes.S n)) in H2. fold S in H2.
    simpl pow in H1. pose proof (exp_pos (2 * L * S)) as H3.
    replace (drive motion t c - motion t c)
      with ((drive motion t c - guess (Datatypes.S n) t c) - (motion t c - guess (Datatypes.S n) t c)) by ring.
    eapply Rle_trans; [ apply Rabs_triang |]. rewrite Rabs_Ropp. nra.
Qed.

Theorem a_motion_exists : exists X : R -> Ix -> R, (forall c, X t0 c = x0 c) /\ inside X /\ driven X X.
Proof.
  exists (drive motion).
  assert (Hin : inside (drive motion)) by (apply drive_inside; [ apply motion_inside | apply motion_smooth ]).
  split; [ intros c; apply drive_starts | split; [ exact Hin |]].
  intros c Hc t Ht. pose proof (drive_driven motion motion_inside motion_smooth c Hc t Ht) as H.
  replace (f t (drive motion t) c) with (f t (motion t) c); [ exact H |].
  destruct (lipschitz (t - t0)) as [L [HL G]]; [ lra |].
  apply no_difference. rewrite <- (Rmult_0_r L).
  apply G; [ lra | apply motion_inside; exact Ht | apply Hin; exact Ht | | exact Hc ].
  intros c' Hc'. rewrite motion_drives_itself by assumption. rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. lra.
Qed.
End Picard.

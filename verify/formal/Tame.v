(** * Tame.v : terms that vary at a bounded rate with the state and continuously with time (for existence and uniqueness, L1).
    Sums, products, tanh, cos and sin of such terms are such terms, products as long as the factors are bounded.
    Speeds and turn rates change at a bounded rate, so over a bounded time they are bounded. *)
From Coq Require Import Reals Lra Psatz Lia FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus Picard.
Open Scope R_scope.

(** ** The state as one list of coordinates *)
Inductive part := X_part | Y_part | Heading | Speed | Turning.
Definition place := (part * nat)%type.

Definition coords (s : state) (c : place) : R :=
  match fst c with X_part => px s (snd c) | Y_part => py s (snd c) | Heading => th s (snd c) | Speed => v s (snd c) | Turning => om s (snd c) end.
Definition state_of (x : place -> R) : state :=
  State (fun i => x (X_part, i)) (fun i => x (Y_part, i)) (fun i => x (Heading, i)) (fun i => x (Speed, i)) (fun i => x (Turning, i)).

Lemma state_of_coords s : state_of (coords s) = s.
Proof. destruct s; reflexivity. Qed.

Definition vehicle (F : fleet) (c : place) : Prop := (snd c < N F)%nat.

Definition law (F : fleet) (t : R) (x : place -> R) (c : place) : R :=
  let s := state_of x in let i := snd c in
  match fst c with
  | X_part => cos (th s i) * v s i
  | Y_part => sin (th s i) * v s i
  | Heading => om s i
  | Speed => u_v F s i / m F i
  | Turning => u_w F t s i / J F i
  end.

(** Speeds and turn rates within C at t0, and changing at most at the rate B. *)
Definition region (F : fleet) (t0 C B : R) (t : R) (x : place -> R) : Prop :=
  forall i, (i < N F)%nat -> Rabs (x (Speed, i)) <= C + B * (t - t0) /\ Rabs (x (Turning, i)) <= C + B * (t - t0).

(** ** Terms that vary at a bounded rate with the state and continuously with time *)
Section Terms.
Variables (F : fleet) (t0 C B : R).
Hypothesis B_pos : 0 < B.
Local Notation P := (region F t0 C B).
Local Notation ok := (vehicle F).

Definition tame (g : R -> (place -> R) -> R) : Prop :=
  (forall S, 0 <= S -> exists L, 0 <= L /\ forall t x y e, t0 <= t <= t0 + S -> P t x -> P t y -> 0 <= e ->
     (forall c, ok c -> Rabs (x c - y c) <= e) -> Rabs (g t x - g t y) <= L * e) /\
  (forall Y, inside _ t0 P Y -> smooth _ ok Y -> forall t, continuous (fun s => g (Rmax t0 s) (Y (Rmax t0 s))) t).
Definition limited (g : R -> (place -> R) -> R) : Prop :=
  forall S, 0 <= S -> exists M, 0 <= M /\ forall t x, t0 <= t <= t0 + S -> P t x -> Rabs (g t x) <= M.

Lemma tame_const (a : R) : tame (fun _ _ => a).
Proof.
  split.
  - intros S _. exists 0. split; [ lra |]. intros t x y e _ _ _ _ _. rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. lra.
  - intros Y _ _ t. apply (continuous_const a t).
Qed.

Lemma tame_coordinate c : ok c -> tame (fun _ x => x c).
Proof.
  intros Hc. split.
  - intros S _. exists 1. split; [ lra |]. intros t x y e _ _ _ _ H. rewrite Rmult_1_l. apply H; exact Hc.
  - intros Y _ HY t. apply (continuous_comp (fun s => Rmax t0 s) (fun s => Y s c) t); [ apply clamp_continuous | apply HY; exact Hc ].
Qed.

Lemma tame_plus g h : tame g -> tame h -> tame (fun t x => g t x + h t x).
Proof.
  intros [Hg Cg] [Hh Ch]. split.
  - intros S HS. destruct (Hg S HS) as [L [HL G]]. destruct (Hh S HS) as [L' [HL' G']]. exists (L + L'). split; [ lra |].
    intros t x y e Ht Hx Hy He H. specialize (G t x y e Ht Hx Hy He H). specialize (G' t x y e Ht Hx Hy He H).
    replace (g t x + h t x - (g t y + h t y)) with ((g t x - g t y) + (h t x - h t y)) by ring.
    eapply Rle_trans; [ apply Rabs_triang |]. lra.
  - intros Y HY SY t. apply (continuous_plus (fun s => g (Rmax t0 s) (Y (Rmax t0 s))) (fun s => h (Rmax t0 s) (Y (Rmax t0 s))) t); [ apply Cg | apply Ch ]; assumption.
Qed.

Lemma tame_mult g h : tame g -> tame h -> limited g -> limited h -> tame (fun t x => g t x * h t x).
Proof.
  intros [Hg Cg] [Hh Ch] Bg Bh. split.
  - intros S HS. destruct (Hg S HS) as [L [HL G]]. destruct (Hh S HS) as [L' [HL' G']].
    destruct (Bg S HS) as [M [HM D]]. destruct (Bh S HS) as [M' [HM' D']].
    exists (M * L' + M' * L). split; [ apply Rplus_le_le_0_compat; apply Rmult_le_pos; assumption |].
    intros t x y e Ht Hx Hy He H. specialize (G t x y e Ht Hx Hy He H). specialize (G' t x y e Ht Hx Hy He H).
    specialize (D t x Ht Hx). specialize (D' t y Ht Hy).
    replace (g t x * h t x - g t y * h t y) with (g t x * (h t x - h t y) + h t y * (g t x - g t y)) by ring.
    eapply Rle_trans; [ apply Rabs_triang |]. rewrite !Rabs_mult.
    replace ((M * L' + M' * L) * e) with (M * (L' * e) + M' * (L * e)) by ring.
    apply Rplus_le_compat; apply Rmult_le_compat; try apply Rabs_pos; assumption.
  - intros Y HY SY t. apply (continuous_mult (fun s => g (Rmax t0 s) (Y (Rmax t0 s))) (fun s => h (Rmax t0 s) (Y (Rmax t0 s))) t); [ apply Cg | apply Ch ]; assumption.
Qed.

Lemma tame_scal a g : tame g -> tame (fun t x => a * g t x).
Proof.
  intros [Hg Cg]. split.
  - intros S HS. destruct (Hg S HS) as [L [HL G]]. exists (Rabs a * L). split; [ apply Rmult_le_pos; [ apply Rabs_pos | exact HL ] |].
    intros t x y e Ht Hx Hy He H. specialize (G t x y e Ht Hx Hy He H).
    rewrite <- Rmult_minus_distr_l, Rabs_mult, Rmult_assoc. apply Rmult_le_compat_l; [ apply Rabs_pos | exact G ].
  - intros Y HY SY t. apply (continuous_mult (fun _ => a) (fun s => g (Rmax t0 s) (Y (Rmax t0 s))) t); [ apply (continuous_const a t) | apply Cg; assumption ].
Qed.

(** cos, sin, tanh: functions with slopes in [-1, 1] and values in [-1, 1]. *)
Lemma tame_comp (w dw : R -> R) g : (forall r, is_derive w r (dw r)) -> (forall r, Rabs (dw r) <= 1) -> tame g -> tame (fun t x => w (g t x)).
Proof.
  intros Hw Hb [Hg Cg]. split.
  - intros S HS. destruct (Hg S HS) as [L [HL G]]. exists L. split; [ exact HL |].
    intros t x y e Ht Hx Hy He H. eapply Rle_trans; [| apply (G t x y e); assumption ].
    assert (Lip : forall p q, p <= q -> Rabs (w q - w p) <= Rabs (q - p)).
    { intros p q Hpq. rewrite (Rabs_pos_eq (q - p)) by lra. rewrite <- (Rmult_1_l (q - p)).
      apply (increment_abs w p q 1 Hpq). intros r _. exists (dw r). split; [ apply Hw | apply Hb ]. }
    destruct (Rle_lt_dec (g t x) (g t y)) as [Hl | Hl].
    + rewrite (Rabs_minus_sym (w (g t x))), (Rabs_minus_sym (g t x)). apply Lip; exact Hl.
    + apply Lip; lra.
  - intros Y HY SY t. apply (continuous_comp (fun s => g (Rmax t0 s) (Y (Rmax t0 s))) w t); [ apply Cg; assumption |].
    eapply derive_continuous. apply Hw.
Qed.

Lemma tame_sum n (g : nat -> R -> (place -> R) -> R) : (forall j, (j < n)%nat -> tame (g j)) -> tame (fun t x => sum n (fun j => g j t x)).
Proof.
  induction n as [| n IH]; intros H; simpl.
  - apply tame_const.
  - apply (tame_plus (fun t x => sum n (fun j => g j t x)) (g n)); [ apply IH; intros j Hj; apply H; lia | apply H; lia ].
Qed.

Lemma limited_by (M : R) g : (forall t x, t0 <= t -> P t x -> Rabs (g t x) <= M) -> limited g.
Proof.
  intros H S _. exists (Rmax M 0). split; [ apply Rmax_r |]. intros t x Ht Hx.
  eapply Rle_trans; [ apply H; [ lra | exact Hx ] | apply Rmax_l ].
Qed.

Lemma limited_mult g h : limited g -> limited h -> limited (fun t x => g t x * h t x).
Proof.
  intros Hg Hh S HS. destruct (Hg S HS) as [M [HM D]]. destruct (Hh S HS) as [M' [HM' D']].
  exists (M * M'). split; [ apply Rmult_le_pos; assumption |]. intros t x Ht Hx. rewrite Rabs_mult.
  apply Rmult_le_compat; try apply Rabs_pos; [ apply D | apply D' ]; assumption.
Qed.

Lemma limited_in_region q i : (i < N F)%nat -> q = Speed \/ q = Turning -> limited (fun _ x => x (q, i)).
Proof.
  intros Hi Hq S HS. exists (Rmax (C + B * S) 0). split; [ apply Rmax_r |]. intros t x Ht Hx.
  assert (H : C + B * (t - t0) <= C + B * S) by (apply Rplus_le_compat_l, Rmult_le_compat_l; lra).
  destruct (Hx i Hi) as [H1 H2]. eapply Rle_trans; [| apply Rmax_l ]. destruct Hq; subst q; lra.
Qed.

Lemma tame_tanh g : tame g -> tame (fun t x => tanh (g t x)).
Proof.
  apply (tame_comp tanh (fun r => 1 - tanh r ^ 2)); [ apply tanh_derive |].
  intros r. pose proof (tanh_slope_pos r). pose proof (tanh_slope_le_1 r). apply Rabs_le. lra.
Qed.

Lemma tame_cos g : tame g -> tame (fun t x => cos (g t x)).
Proof.
  apply (tame_comp cos (fun r => - sin r)).
  - intros r. apply is_derive_Reals, derivable_pt_lim_cos.
  - intros r. rewrite Rabs_Ropp. apply Rabs_le. apply SIN_bound.
Qed.

Lemma tame_sin g : tame g -> tame (fun t x => sin (g t x)).
Proof.
  apply (tame_comp sin cos).
  - intros r. apply is_derive_Reals, derivable_pt_lim_sin.
  - intros r. apply Rabs_le. apply COS_bound.
Qed.

Lemma tame_div g (a : R) : tame g -> tame (fun t x => g t x / a).
Proof.
  intros H. replace (fun t x => g t x / a) with (fun (t : R) (x : place -> R) => / a * g t x); [ apply tame_scal; exact H |].
  do 2 (apply functional_extensionality; intro). unfold Rdiv. ring.
Qed.

Lemma tame_minus g h : tame g -> tame h -> tame (fun t x => g t x - h t x).
Proof.
  intros Hg Hh. replace (fun t x => g t x - h t x) with (fun (t : R) (x : place -> R) => g t x + -1 * h t x); [ apply tame_plus; [ exact Hg | apply tame_scal; exact Hh ] |].
  do 2 (apply functional_extensionality; intro). ring.
Qed.

End Terms.

Arguments tame_plus {F t0 C B}.
Arguments tame_minus {F t0 C B}.
Arguments tame_mult {F t0 C B}.
Arguments tame_scal {F t0 C B}.
Arguments tame_div {F t0 C B}.
Arguments tame_comp {F t0 C B}.
Arguments tame_sum {F t0 C B}.
Arguments limited_by {F t0 C B}.
Arguments limited_mult {F t0 C B}.

(** * Calculus.v : derivative rules and mean-value estimates for functions of time.
    Each rule says how the derivative of a compound (sum, product, cos of, tanh of, ...) follows from its parts.
    A derivative of one sign makes a function monotone; a bounded derivative bounds the increment; the integral
    of a derivative is the increment. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations.
Open Scope R_scope.

(** ** Rules.  [derive_value]: replace the derivative by an equal one. *)
Lemma derive_value : forall (f : R -> R) (t l l' : R), is_derive f t l -> l = l' -> is_derive f t l'.
Proof. intros f t l l' H <-; exact H. Qed.

Lemma derive_ext : forall (f g : R -> R) (t l : R), (forall s, f s = g s) -> is_derive f t l -> is_derive g t l.
Proof. intros f g t l H D. apply (is_derive_ext f g t l H D). Qed.

Lemma derive_const : forall (c t : R), is_derive (fun _ : R => c) t 0.
Proof. intros c t. apply (@is_derive_const R_AbsRing R_NormedModule c t). Qed.

Lemma derive_id : forall t : R, is_derive (fun s : R => s) t 1.
Proof. intros t. apply (@is_derive_id R_AbsRing t). Qed.

Lemma derive_plus : forall (f g : R -> R) (t df dg : R), is_derive f t df -> is_derive g t dg ->
  is_derive (fun s => f s + g s) t (df + dg).
Proof. intros f g t df dg Hf Hg. apply (@is_derive_plus R_AbsRing R_NormedModule f g t df dg Hf Hg). Qed.

Lemma derive_minus : forall (f g : R -> R) (t df dg : R), is_derive f t df -> is_derive g t dg ->
  is_derive (fun s => f s - g s) t (df - dg).
Proof. intros f g t df dg Hf Hg. apply (@is_derive_minus R_AbsRing R_NormedModule f g t df dg Hf Hg). Qed.

Lemma derive_opp : forall (f : R -> R) (t df : R), is_derive f t df -> is_derive (fun s => - f s) t (- df).
Proof. intros f t df Hf. apply (@is_derive_opp R_AbsRing R_NormedModule f t df Hf). Qed.

Lemma derive_mult : forall (f g : R -> R) (t df dg : R), is_derive f t df -> is_derive g t dg ->
  is_derive (fun s => f s * g s) t (df * g t + f t * dg).
Proof.
  intros f g t df dg Hf Hg. apply is_derive_Reals. apply (derivable_pt_lim_mult f g t df dg).
  - apply is_derive_Reals; exact Hf.
  - apply is_derive_Reals; exact Hg.
Qed.

Lemma derive_scal : forall (c : R) (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => c * f s) t (c * df).
Proof. intros c f t df Hf. apply (is_derive_scal f t c df Hf). Qed.

Lemma derive_div : forall (c : R) (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => f s / c) t (df / c).
Proof.
  intros c f t df Hf. apply (derive_ext (fun s => / c * f s)); [intros s; unfold Rdiv; ring|].
  apply (derive_value _ t (/ c * df)); [apply derive_scal; exact Hf|unfold Rdiv; ring].
Qed.

Lemma derive_comp : forall (f g : R -> R) (t df dg : R), is_derive f (g t) df -> is_derive g t dg ->
  is_derive (fun s => f (g s)) t (df * dg).
Proof.
  intros f g t df dg Hf Hg. apply is_derive_Reals. apply (derivable_pt_lim_comp g f t dg df).
  - apply is_derive_Reals; exact Hg.
  - apply is_derive_Reals; exact Hf.
Qed.

Lemma derive_square : forall (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => f s ^ 2) t (2 * f t * df).
Proof.
  intros f t df Hf. apply (derive_ext (fun s => f s * f s)); [intros s; ring|].
  apply (derive_value _ t (df * f t + f t * df)); [apply derive_mult; exact Hf|ring].
Qed.

Lemma derive_cos : forall (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => cos (f s)) t (- sin (f t) * df).
Proof.
  intros f t df Hf. apply (derive_comp cos f); [|exact Hf].
  apply is_derive_Reals, derivable_pt_lim_cos.
Qed.

Lemma derive_sin : forall (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => sin (f s)) t (cos (f t) * df).
Proof.
  intros f t df Hf. apply (derive_comp sin f); [|exact Hf].
  apply is_derive_Reals, derivable_pt_lim_sin.
Qed.

Lemma derive_exp : forall (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => exp (f s)) t (exp (f t) * df).
Proof.
  intros f t df Hf. apply (derive_comp exp f); [|exact Hf].
  apply is_derive_Reals, derivable_pt_lim_exp.
Qed.

Lemma derive_tanh : forall (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => tanh (f s)) t ((1 - tanh (f t) ^ 2) * df).
Proof. intros f t df Hf. apply (derive_comp tanh f); [apply tanh_derive|exact Hf]. Qed.

Lemma derive_lncosh : forall (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun s => lncosh (f s)) t (tanh (f t) * df).
Proof. intros f t df Hf. apply (derive_comp lncosh f); [apply lncosh_derive|exact Hf]. Qed.

Lemma derive_sum : forall n (f : nat -> R -> R) (t : R) (df : nat -> R),
  (forall i, (i < n)%nat -> is_derive (f i) t (df i)) ->
  is_derive (fun s => sum n (fun i => f i s)) t (sum n df).
Proof.
  induction n as [|n IH]; intros f t df H; simpl.
  - apply derive_const.
  - apply derive_plus; [apply IH; intros i Hi; apply H; lia|apply H; lia].
Qed.

(** ** Continuity *)
Lemma derive_continuity_pt : forall (f : R -> R) (t l : R), is_derive f t l -> continuity_pt f t.
Proof. intros f t l H. apply derivable_continuous_pt. exists l. apply is_derive_Reals; exact H. Qed.

Lemma derive_continuous : forall (f : R -> R) (t l : R), is_derive f t l -> continuous f t.
Proof. intros f t l H. apply (@ex_derive_continuous R_AbsRing R_NormedModule f t). exists l; exact H. Qed.

(** ** Mean value theorem and its uses *)
Lemma mean_value : forall (f df : R -> R) (a b : R), a <= b ->
  (forall t, a <= t <= b -> is_derive f t (df t)) ->
  exists c, a <= c <= b /\ f b - f a = df c * (b - a).
Proof.
  intros f df a b Hab H. destruct (MVT_gen f a b df) as [c [Hc E]].
  - intros t Ht. rewrite Rmin_left, Rmax_right in Ht by exact Hab. apply H; lra.
  - intros t Ht. rewrite Rmin_left, Rmax_right in Ht by exact Hab.
    apply (derive_continuity_pt f t (df t)), H; lra.
  - rewrite Rmin_left, Rmax_right in Hc by exact Hab. exists c; split; [exact Hc|exact E].
Qed.

(** The same where the derivative is only known to exist and to have a property. *)
Lemma mean_value_property : forall (f : R -> R) (P : R -> R -> Prop) (a b : R), a <= b ->
  (forall t, a <= t <= b -> exists l, is_derive f t l /\ P t l) ->
  exists c l, a <= c <= b /\ P c l /\ f b - f a = l * (b - a).
Proof.
  intros f P a b Hab H. destruct (mean_value f (Derive f) a b Hab) as [c [Hc E]].
  - intros t Ht. destruct (H t Ht) as [l [D _]]. apply Derive_correct. exists l; exact D.
  - destruct (H c Hc) as [l [D HP]]. exists c, l. split; [exact Hc|]. split; [exact HP|].
    rewrite (is_derive_unique f c l D) in E. exact E.
Qed.

Lemma increment_le : forall (f : R -> R) (a b B : R), a <= b ->
  (forall t, a <= t <= b -> exists l, is_derive f t l /\ l <= B) -> f b - f a <= B * (b - a).
Proof.
  intros f a b B Hab H. destruct (mean_value_property f (fun _ l => l <= B) a b Hab H) as [c [l [_ [Hl E]]]].
  rewrite E. apply Rmult_le_compat_r; lra.
Qed.

Lemma increment_abs : forall (f : R -> R) (a b B : R), a <= b ->
  (forall t, a <= t <= b -> exists l, is_derive f t l /\ Rabs l <= B) -> Rabs (f b - f a) <= B * (b - a).
Proof.
  intros f a b B Hab H. destruct (mean_value_property f (fun _ l => Rabs l <= B) a b Hab H) as [c [l [_ [Hl E]]]].
  rewrite E, Rabs_mult, (Rabs_pos_eq (b - a)) by lra. apply Rmult_le_compat_r; lra.
Qed.

Lemma decreasing_of_derivative : forall (f : R -> R) (a b : R), a <= b ->
  (forall t, a <= t <= b -> exists l, is_derive f t l /\ l <= 0) -> f b <= f a.
Proof. intros f a b Hab H. assert (A := increment_le f a b 0 Hab H). lra. Qed.

(** If f falls at least as fast as g grows (f' <= - g'), then f + g does not grow. *)
Lemma compare_increments : forall (f g : R -> R) (a b : R), a <= b ->
  (forall t, a <= t <= b -> exists l l', is_derive f t l /\ is_derive g t l' /\ l <= l') -> f b - f a <= g b - g a.
Proof.
  intros f g a b Hab H.
  assert (A : f b - g b <= f a - g a).
  { apply (decreasing_of_derivative (fun t => f t - g t) a b Hab).
    intros t Ht. destruct (H t Ht) as [l [l' [D [D' L]]]].
    exists (l - l'); split; [apply derive_minus; assumption|lra]. }
  lra.
Qed.

(** ** The integral of a continuous derivative is the increment *)

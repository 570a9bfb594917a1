(** * EnergyDerivatives.v : the two energies and how they change along a motion (L3, L4).
    V holds the kinetic energy of travel and the potential of the position errors, W that of turning and of the heading errors.
    Along every motion V only loses the power Pv that the speed damping takes out.
    W loses Pw and gains what the excitation alpha feeds into the turning. *)
From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Definitions Sums Saturations Calculus.
Open Scope R_scope.

(** ** The errors move with the vehicles *)
Lemma zx_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => zx F (X r) i) t (cos (th (X t) i) * v (X t) i).
Proof.
  intros F t0 X t i H Ht Hi. destruct (H i Hi t Ht) as [D _].
  apply (derive_ext (fun r => px (X r) i - (offx F i + leadx F))); [intros r; unfold zx; ring|].
  apply (derive_value _ t (cos (th (X t) i) * v (X t) i - 0)); [|ring].
  apply derive_minus; [exact D|apply derive_const].
Qed.

Lemma zy_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => zy F (X r) i) t (sin (th (X t) i) * v (X t) i).
Proof.
  intros F t0 X t i H Ht Hi. destruct (H i Hi t Ht) as [_ [D _]].
  apply (derive_ext (fun r => py (X r) i - (offy F i + leady F))); [intros r; unfold zy; ring|].
  apply (derive_value _ t (sin (th (X t) i) * v (X t) i - 0)); [|ring].
  apply derive_minus; [exact D|apply derive_const].
Qed.

Lemma tha_derivative : forall F t0 X t i, solution F t0 X -> t0 <= t -> (i < N F)%nat ->
  is_derive (fun r => tha F (X r) i) t (om (X t) i).
Proof.
  intros F t0 X t i H Ht Hi. destruct (H i Hi t Ht) as [_ [_ [D _]]].
  apply (derive_value _ t (om (X t) i - 0)); [|ring].
  apply derive_minus; [exact D|apply derive_const].
Qed.

(** ** Potentials: their gradient is the coupling *)
Lemma scaled_lncosh_derive : forall (scale : R) (f : R -> R) (t df : R), 0 < scale -> is_derive f t df ->
  is_derive (fun r => scale * ln (cosh (f r / scale))) t (df * tanh (f t / scale)).
Proof.
  intros scale f t df Hs D.
  apply (derive_value _ t (scale * (tanh (f t / scale) * (df / scale)))); [|field; lra].
  apply derive_scal, (derive_lncosh (fun r => f r / scale)), derive_div; exact D.
Qed.

Lemma potential_derivative : forall F scale (Z : R -> nat -> R) t (dz : nat -> R), A1 F -> 0 < scale ->
  (forall i, (i < N F)%nat -> is_derive (fun r => Z r i) t (dz i)) ->
  is_derive (fun r => potential F scale (Z r)) t (sum (N F) (fun i => dz i * coupling F scale (Z t) i)).
Proof.
  intros F scale Z t dz [Hsym _] Hs D. unfold potential.
  apply (derive_value _ t
    (sum (N F) (fun i => al F i * (dz i * tanh (Z t i / scale)))
     + / 2 * sum (N F) (fun i => sum (N F) (fun j => a F i j * ((dz i - dz j) * tanh ((Z t i - Z t j) / scale)))))).
  - apply derive_plus.
    + apply (derive_sum (N F) (fun i r => al F i * scale * ln (cosh (Z r i / scale)))). intros i Hi.
      apply (derive_ext (fun r => al F i * (scale * ln (cosh (Z r i / scale))))); [intros r; ring|].
      apply derive_scal, (scaled_lncosh_derive scale (fun r => Z r i)); [exact Hs|apply D; exact Hi].
    + apply derive_scal.
      apply (derive_sum (N F) (fun i r => sum (N F) (fun j => a F i j * scale * ln (cosh ((Z r i - Z r j) / scale))))).
      intros i Hi.
      apply (derive_sum (N F) (fun j r => a F i j * scale * ln (cosh ((Z r i - Z r j) / scale)))). intros j Hj.
      apply (derive_ext (fun r => a F i j * (scale * ln (cosh ((Z r i - Z r j) / scale))))); [intros r; ring|].
      apply derive_scal, (scaled_lncosh_derive scale (fun r => Z r i - Z r j)); [exact Hs|].
      apply derive_minus; apply D; assumption.
  - rewrite <- (edge_identity (N F) (a F) (fun r => tanh (r / scale)) (Z t) dz).
    + rewrite <- sum_plus. apply sum_ext; intros i Hi. unfold coupling. ring.
    + intros i j Hi Hj. apply (Hsym i j Hi Hj).
    + intros r. replace (- r / scale) with (- (r / scale)) by (field; lra). apply tanh_odd.
Qed.

Lemma kinetic_derivative : forall (c : R) (f : R -> R) (t df : R), is_derive f t df ->
  is_derive (fun r => c * (f r) ^ 2 / 2) t (c * (f t * df)).
Proof.
  intros c f t df D. apply (derive_value _ t (c * (2 * f t * df) / 2)); [|field].
  apply derive_div, derive_scal, derive_square; exact D.
Qed.

(** ** L3: V' = - Pv *)
Lemma V_derivative : forall F t0 X t, A1 F -> A2 F -> solution F t0 X -> t0 <= t ->
  is_derive (fun r => V F (X r)) t (- Pv F (X t)).
Proof.
  intros F t0 X t H1 [Hls [Hrs H2]] HX Ht. unfold V.
  apply (derive_value _ t
    (sum (N F) (fun i => m F i / pv F i * (v (X t) i * (u_v F (X t) i / m F i)))
     + sum (N F) (fun i => cos (th (X t) i) * v (X t) i * coupling F (ls F) (zx F (X t)) i)
     + sum (N F) (fun i => sin (th (X t) i) * v (X t) i * coupling F (ls F) (zy F (X t)) i))).
  - apply derive_plus; [apply derive_plus|].
    + apply (derive_sum (N F) (fun i r => m F i / pv F i * (v (X r) i) ^ 2 / 2)). intros i Hi.
      apply (kinetic_derivative _ (fun r => v (X r) i)). apply (HX i Hi t Ht).
    + apply (potential_derivative F (ls F) (fun r => zx F (X r))); [exact H1|exact Hls|].
      intros i Hi. apply (zx_derivative F t0); assumption.
    + apply (potential_derivative F (ls F) (fun r => zy F (X r))); [exact H1|exact Hls|].
      intros i Hi. apply (zy_derivative F t0); assumption.
  - unfold Pv. rewrite <- sum_opp, <- !sum_plus. apply sum_ext; intros i Hi.
    destruct (H2 i Hi) as [Hm [_ [_ [_ [Hpv _]]]]].
    unfold u_v, along, ex, ey. field. split; lra.
Qed.

(** ** L4: W' = - Pw + sum of w alpha / pw *)
Lemma W_derivative : forall F t0 X t, A1 F -> A2 F -> solution F t0 X -> t0 <= t ->
  is_derive (fun r => W F (X r)) t
    (- Pw F (X t) + sum (N F) (fun i => om (X t) i * alpha F t (X t) i / pw F i)).
Proof.
  intros F t0 X t H1 [Hls [Hrs H2]] HX Ht. unfold W.
  apply (derive_value _ t
    (sum (N F) (fun i => J F i / pw F i * (om (X t) i * (u_w F t (X t) i / J F i)))
     + sum (N F) (fun i => om (X t) i * coupling F (rs F) (tha F (X t)) i))).
  - apply derive_plus.
    + apply (derive_sum (N F) (fun i r => J F i / pw F i * (om (X r) i) ^ 2 / 2)). intros i Hi.
      apply (kinetic_derivative _ (fun r => om (X r) i)). apply (HX i Hi t Ht).
    + apply (potential_derivative F (rs F) (fun r => tha F (X r))); [exact H1|exact Hrs|].
      intros i Hi. apply (tha_derivative F t0); assumption.
  - unfold Pw. rewrite <- sum_opp, <- !sum_plus. apply sum_ext; intros i Hi.
    destruct (H2 i Hi) as [_ [HJ [_ [_ [_ [_ [Hpw _]]]]]]].
    unfold u_w, alpha, eth. field. split; lra.
Qed.

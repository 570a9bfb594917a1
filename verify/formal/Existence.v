(** * Existence.v : from every state the fleet has a motion for all time (theorem, part (a)).
    Torques are bounded, so speeds grow at most at a fixed rate and cannot run away in finite time;
    as long as speeds are bounded the law of motion is Lipschitz, and guesses that drive each other close in on a motion (Picard.v).
    Before t0 the motion is continued along its tangent. *)
From Coq Require Import Reals Lra Psatz Lia FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Calculus PullBounds Picard Tame Law Uniqueness.
Open Scope R_scope.

Lemma limit_in_region F t0 C B t (u : nat -> place -> R) x : (forall n, region F t0 C B t (u n)) ->
  (forall c, vehicle F c -> is_lim_seq (fun n => u n c) (Finite (x c))) -> region F t0 C B t x.
Proof.
  intros Hu Hl i Hi.
  assert (G : forall c, vehicle F c -> (forall n, Rabs (u n c) <= C + B * (t - t0)) -> Rabs (x c) <= C + B * (t - t0)).
  { intros c Hc H. change (Rbar_le (Finite (Rabs (x c))) (Finite (C + B * (t - t0)))).
    apply (is_lim_seq_le (fun n => Rabs (u n c)) (fun _ => C + B * (t - t0))).
    - exact H.
    - apply (is_lim_seq_abs (fun n => u n c) (Finite (x c))). apply Hl; exact Hc.
    - apply is_lim_seq_const. }
  split; (apply G; [ exact Hi | intros n; apply (Hu n i Hi) ]).
Qed.

Theorem existence_holds : existence.
Proof.
  intros F HA1 HA2 HA3 t0 s0 Ht0.
  destruct (rates_bounded F HA1 HA2 HA3) as [B [HB Hr]].
  destruct (start_speeds F s0) as [C [HC Hv]].
  destruct (a_motion_exists place (vehicle F) (law F) t0 (region F t0 C B) (coords s0)) as [X [Hs [_ HX]]].
  - intros S HS. apply law_lipschitz; assumption.
  - intros S HS. apply law_bounded; assumption.
  - intros t Ht i Hi. assert (0 <= B * (t - t0)) by (apply Rmult_le_pos; lra). destruct (Hv i Hi) as [H1 H2].
    split; [ change (Rabs (v s0 i) <= C + B * (t - t0)) | change (Rabs (om s0 i) <= C + B * (t - t0)) ]; lra.
  - intros Y Z _ Hz HZ. apply (driven_in_region F t0 C B Ht0 Y); [ exact Hr | | exact HZ ].
    intros i Hi. rewrite (Hz (Speed, i) Hi), (Hz (Turning, i) Hi). apply Hv; exact Hi.
  - intros t u x. apply limit_in_region.
  - intros Y IY SY c Hc t. apply (law_tame F t0 C B HB HA1 HA3 Ht0 c Hc); assumption.
  - exists (fun t => state_of (X t)). split.
    + rewrite <- (state_of_coords s0). f_equal. apply functional_extensionality. exact Hs.
    + intros i Hi t Ht. split; [| split; [| split; [| split ] ] ].
      * apply (HX (X_part, i) Hi t Ht).
      * apply (HX (Y_part, i) Hi t Ht).
      * apply (HX (Heading, i) Hi t Ht).
      * apply (HX (Speed, i) Hi t Ht).
      * apply (HX (Turning, i) Hi t Ht).
Qed.

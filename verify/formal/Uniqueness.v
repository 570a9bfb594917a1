(** * Uniqueness.v : the motion from a start is the only one (theorem, part (a)).
    Two motions of the closed loop from the same start stay within a fixed distance over any bounded time;
    the law of motion halves that distance again and again; so it is zero. *)
From Coq Require Import Reals Lra Psatz Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Calculus PullBounds Picard Tame Law.
Open Scope R_scope.

Lemma solution_driven F t0 X : solution F t0 X -> driven _ (vehicle F) (law F) t0 (fun t => coords (X t)) (fun t => coords (X t)).
Proof.
  intros HX [q i] Hi t Ht. destruct (HX i Hi t Ht) as (H1 & H2 & H3 & H4 & H5).
  unfold law. rewrite state_of_coords. destruct q; assumption.
Qed.

Lemma start_speeds F s : exists C, 0 < C /\ forall i, (i < N F)%nat -> Rabs (v s i) <= C /\ Rabs (om s i) <= C.
Proof.
  apply finite_common_large.
  - intros i x y _ Hxy [H1 H2]. split; lra.
  - intros i _. exists (Rmax (Rabs (v s i)) (Rabs (om s i))). split; [ apply Rmax_l | apply Rmax_r ].
Qed.

Theorem uniqueness_holds : uniqueness.
Proof.
  intros F HA1 HA2 HA3 t0 X Y Ht0 HX HY Hs t i Ht Hi.
  destruct (rates_bounded F HA1 HA2 HA3) as [B [HB Hr]].
  destruct (start_speeds F (X t0)) as [C [HC Hv]].
  pose proof (solution_driven F t0 X HX) as DX. pose proof (solution_driven F t0 Y HY) as DY.
  assert (IX : inside _ t0 (region F t0 C B) (fun s => coords (X s))).
  { apply (driven_in_region F t0 C B Ht0 (fun s => coords (X s))); [ exact Hr | exact Hv | exact DX ]. }
  assert (IY : inside _ t0 (region F t0 C B) (fun s => coords (Y s))).
  { apply (driven_in_region F t0 C B Ht0 (fun s => coords (Y s))); [ exact Hr | rewrite <- Hs; exact Hv | exact DY ]. }
  assert (HS : 0 <= t - t0) by lra.
  destruct (law_lipschitz F t0 C B HB HA1 HA3 Ht0 (t - t0) HS) as [L HL].
  destruct (law_bounded F t0 C B HB Ht0 Hr (t - t0) HS) as [M [HM Hb]].
  assert (G : forall Z, inside _ t0 (region F t0 C B) Z -> driven _ (vehicle F) (law F) t0 Z Z ->
    forall s, t0 <= s <= t0 + (t - t0) -> forall c, vehicle F c -> Rabs (Z s c - Z t0 c) <= M * (t - t0)).
  { intros Z IZ DZ s Hst c Hc. apply Rle_trans with (M * (s - t0)).
    - apply (increment_abs (fun r => Z r c) t0 s M (proj1 Hst)). intros r Hrs. eexists. split.
      + apply DZ; [ exact Hc | lra ].
      + apply Hb; [ lra | apply IZ; lra | exact Hc ].
    - apply Rmult_le_compat_l; lra. }
  assert (E : forall c, vehicle F c -> coords (X t) c = coords (Y t) c).
  { intros c Hc. apply (one_motion _ (vehicle F) (law F) t0 (region F t0 C B) (t - t0) L (fun s => coords (X s)) (fun s => coords (Y s)) (2 * (M * (t - t0)))); try assumption.
    - intros c' _. rewrite Hs. reflexivity.
    - apply Rmult_le_pos; [ lra | apply Rmult_le_pos; assumption ].
    - intros s Hst c' Hc'. pose proof (G _ IX DX s Hst c' Hc') as G1. pose proof (G _ IY DY s Hst c' Hc') as G2. simpl in G1, G2. rewrite Hs in G1.
      replace (coords (X s) c' - coords (Y s) c') with ((coords (X s) c' - coords (Y t0) c') - (coords (Y s) c' - coords (Y t0) c')) by ring.
      eapply Rle_trans; [ apply Rabs_triang |]. rewrite Rabs_Ropp. lra.
    - lra. }
  split; [ apply (E (X_part, i) Hi) | split; [ apply (E (Y_part, i) Hi) | split; [ apply (E (Heading, i) Hi) | split; [ apply (E (Speed, i) Hi) | apply (E (Turning, i) Hi) ] ] ] ].
Qed.

(** * WindowSpeed.v : L12, the pull along the heading.
    If every speed and turn rate is small over one window, then so is the pull along the heading at its start.
    Idea: a speed that stays small over a window has at some moment a small acceleration, so the pull is small then;
    positions and headings hardly move in that window, so it is small at the window's start. *)
From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Gaincert Require Import Statement Sums Saturations Calculus WindowIncrements WindowHeading.
Open Scope R_scope.

Lemma along_small : forall F, A1 F -> A2 F -> A3 F -> forall i, (i < N F)%nat -> exists c,
  forall t0 X t eta, t0 <= t -> solution F t0 X -> slow F X t eta -> Rabs (along F (X t) i) <= c * eta.
Proof.
  intros F HA1 HA2 HA3 i Hi.
  assert (HT : 0 < T F) by apply HA3.
  destruct (proj2 (proj2 HA2) i Hi) as [Hm [_ [_ [_ [Hpv [Hdv [_ [_ [_ [Hss _]]]]]]]]]].
  exists ((m F i * (2 / T F) + dv F i / ss F i + 0) / pv F i + pull_change F i).
  intros t0 X t eta Ht HX Hq.
  destruct (small_rate_somewhere (fun s => v (X s) i) (fun s => u_v F (X s) i / m F i) t (T F) eta HT) as [c [Hc Hrate]].
  - intros s Hs. destruct (HX i Hi s ltac:(lra)) as [_ [_ [_ [H _]]]]. exact H.
  - intros s Hs. apply (Hq s i Hs Hi).
  - assert (Huv : Rabs (u_v F (X c) i) <= m F i * (2 * eta / T F)).
    { replace (u_v F (X c) i) with (m F i * (u_v F (X c) i / m F i)) by (field; lra).
      rewrite Rabs_mult, (Rabs_pos_eq (m F i)) by lra. apply Rmult_le_compat_l; lra. }
    assert (Hdamp := damping_small (dv F i) _ (ss F i) eta Hdv Hss (proj1 (Hq c i Hc Hi))).
    assert (Hpull := restoring_small (pv F i * along F (X c) i) (dv F i * tanh (v (X c) i / ss F i)) 0 (u_v F (X c) i) _ _ 0
      ltac:(unfold u_v; ring) Huv Hdamp ltac:(rewrite Rabs_R0; lra)).
    apply (abs_of_scaled _ _ _ Hpv) in Hpull.
    destruct (pull_increment F HA1 HA2 t0 X t eta HX Ht Hq i c t Hi Hc ltac:(lra)) as [Hinc _].
    replace (along F (X t) i) with (along F (X c) i + (along F (X t) i - along F (X c) i)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _).
    rewrite Rmult_plus_distr_r. apply Rplus_le_compat; [| exact Hinc].
    apply Rle_trans with (1 := Hpull). right. field. lra.
Qed.

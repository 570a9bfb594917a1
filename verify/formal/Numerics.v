(** * Numerics.v : proved bounds of numbers, by interval arithmetic.
    The tactics of coq-interval, computed with Coq's own whole numbers.  The library's ready-made instance computes with
    the processor's integers and floating-point numbers, which would add the behaviour of those to the axioms; this one
    is slower and adds nothing.  [interval] bounds a closed number; [interval_over x] a function of x over its range, by
    Taylor polynomials on ever smaller pieces of it. *)
From Coq Require Import Reals.
From Interval Require Import Float.Specific_stdz Float.Specific_ops Interval.Float_full Tactics.Interval_helper.

Module Whole_floats := SpecificFloat StdZRadix2.
Module Whole_intervals := FloatIntervalFull Whole_floats.
Module Whole_tactic := IntervalTacticAux Whole_intervals.

(** 60 binary digits. *)
Ltac with_precision tac := let p := eval vm_compute in (Whole_floats.PtoP 60) in tac p.

Ltac interval := with_precision ltac:(fun p =>
  Whole_tactic.do_interval (@None R) (@nil R) p 10%nat 15%nat false false itm_naive).
Ltac interval_over x := with_precision ltac:(fun p =>
  Whole_tactic.do_interval (Some x) (cons x nil) p 4%nat 30%nat false false itm_taylor).

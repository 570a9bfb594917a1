(** * Assumptions.v : what the main theorems rest on.
    Coq prints every axiom that a proof uses.  Allowed are those of the standard real numbers,
    classical logic and functional extensionality: nothing else may appear in the list. *)
From Gaincert Require Import Statement Existence Uniqueness TorqueSharp NotExponential.
Require Import Gaincert.Theorem. (* in full, since Theorem alone is a keyword *)

Print Assumptions corrected_theorem_holds.
Print Assumptions existence_holds.
Print Assumptions uniqueness_holds.
Print Assumptions torque_sharp_holds.
Print Assumptions not_exponential_holds.

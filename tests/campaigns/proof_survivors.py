"""The mutants of the proof check that may survive `proof_mutation.py`, each with its reason."""

from __future__ import annotations

# A call that may be left out wherever nothing notices: its name -> reason.
ALIKE = {
    "tuple": "a sequence serves as well as the tuple of it",
    "float": "the number serves as well as the float of it",
    "bool": "SymPy compares to True or False",
}
SHOWN = "how a formula is written: in states it is the same"
WEAKER = "a weaker statement, true as well, and the report prints it"
INNER = "a letter that no formula shows"
ONE_EDGE = "there is one edge: its first is its last"
WORK = "a bound of the work, not of the truth: any near it serves"
# What else: (file, function, what stood there, what stands there now) -> reason.
_ARGUED = {
    ("lemmas/bounds.py", "_place_rates", "('il', i)", "('ilX', i)"): INNER,
    ("lemmas/theorem.py", "cross_track_rate", "fleet[0]", "fleet[1]"): "the identity is that of any vehicle",
    ("method/ball.py", "arb_ops", "s.cosh", "o.cosh"): "no energy is evaluated in balls",
    (
        "printed/boundedness.py",
        "after_20_b",
        "ordered(0, '<=', sech2(1 + s), (tanh_below_1(1 + s),))",
        "ordered(-1, '<=', sech2(1 + s), (tanh_below_1(1 + s),))",
    ): WEAKER,
    ("lemmas/bounds.py", "l6", "normal_form(rate.right + damping)", "rate.right + damping"): SHOWN,
    ("lemmas/windows.py", "l11", "fleet[0].o", "fleet[0].s"): "one positive scale is as good as another",
    (
        "method/fleet_balls.py",
        "BallFleet.plant",
        "balls((v.mass for v in vehicles))",
        "(v.mass for v in vehicles)",
    ): "nothing that is evaluated in balls has a mass in it",
    (
        "printed/boundedness.py",
        "after_20_c",
        "ordered(-(D * TANH_1 - C) * SIZE / P, '<=', 0, where)",
        "ordered(-(D * TANH_1 - C) * SIZE / P, '<=', 1, where)",
    ): WEAKER,
    (
        "printed/boundedness.py",
        "broken_cuts",
        "sum((push[i] for i in chosen), arb(0)) > room",
        "sum((push[i] for i in chosen), arb(0)) >= room",
    ): "no cut of the paper's graph is on the edge",
    ("printed/convergence.py", "_barbalat", "symbol('S')", "symbol('SX')"): INNER,
    ("printed/convergence.py", "second_rate", "i_b.left", "i_b.right"): SHOWN,
    ("printed/saturation.py", "printed_ubar_omega", "U.graph.weight[0]", "U.graph.weight[-1]"): ONE_EDGE,
    ("printed/section_4.py", "eq_12", "(Fraction(0), 0)", "(Fraction(0), -1)"): "either refutes (12)",
    (
        "this_fleet/gains.py",
        "lemma_constants",
        "len(fleet) <= EXACT_VEHICLES",
        "len(fleet) < EXACT_VEHICLES",
    ): WORK,
}
ARGUED = {(f"verify/proof/{file}", where, f"{old} -> {new}"): why for (file, where, old, new), why in _ARGUED.items()}

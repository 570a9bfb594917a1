"""The mutants of the proof check that may survive `proof_mutation.py`, each with its reason."""

from __future__ import annotations

# A call that may be left out wherever nothing notices: its name -> reason.
ALIKE = {
    "tuple": "a sequence serves as well as the tuple of it",
    "float": "the number serves as well as the float of it",
    "bool": "SymPy compares to True or False",
    "Fraction": "a whole number serves as well as the fraction of it",
    "set": "a sequence has the same members",
}
SHOWN = "how a formula is written: in states it is the same"
WEAKER = "a weaker statement, true as well, and the report prints it"
INNER = "a letter that no formula shows"
ONE_EDGE = "there is one edge: its first is its last"
LESS = "less is recognised, nothing more: what is claimed is proved all the same"
SEARCH = "where a witness is looked for: one that is found is evaluated"
SAID = "words that the report prints"
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
    ("method/normal_form.py", "_canonical", "(sp.sin, sp.cos)", "(sp.sin,)"): LESS,
    ("method/normal_form.py", "_root_of_primitive", "sp.expand(root.base)", "root.base"): LESS,
    (
        "printed/convergence.py",
        "omega_not_to_0",
        "(Relation(VI.w * VI.b, '->', sp.S.Zero), Relation(VI.w, '-/>', sp.S.Zero))",
        "(Relation(VI.w, '-/>', sp.S.Zero),)",
    ): "with one premise less it is false all the more, and the report prints it",
    (
        "method/fleet_balls.py",
        "_angle",
        "arb.pi() * ball(leader.heading_deg) / 180",
        "arb.pi() * ball(leader.heading_deg) / 181",
    ): "states are laid out around the leader's heading, whatever it is",
    (
        "printed/boundedness.py",
        "after_20_c",
        "-(D * TANH_1 - C) * SIZE",
        "-(D * TANH_1 - C) / SIZE",
    ): WEAKER,
    (
        "method/signs.py",
        "Case.counterexample",
        "all((value > 0 for s, value in values.items() if s.is_positive))",
        "(value > 0 for s, value in values.items() if s.is_positive)",
    ): "a gap that is negative where a letter is 0 is negative near by",
    ("method/signs.py", "Case.counterexample", "value > 0", "value >= 0"): (
        "a gap that is negative where a letter is 0 is negative near by"
    ),
    ("method/signs.py", "_grid", "number >= _MAX_TRIES", "number > _MAX_TRIES"): WORK,
    ("method/signs.py", "_grid", "1::2", "1::1"): SEARCH,
    ("printed/convergence.py", "_barbalat", "parameter('omega_max')", "parameter('omega_maxX')"): INNER,
    ("printed/convergence.py", "_slow_error", "parameter('T')", "parameter('TX')"): INNER,
    ("lemmas/bounds.py", "l8", "fleet.column('A')", "fleet.column('AX')"): INNER,
    (
        "method/fleet_balls.py",
        "BallFleet.worst_state",
        "self.fleet.arm[i] * (1, -1)[wheel]",
        "self.fleet.arm[i] / (1, -1)[wheel]",
    ): "times 1 or -1 is divided by 1 or -1",
    ("printed/convergence.py", "", "VI.q", "VI.b"): "both tend to 0, and the report prints which does",
    ("printed/convergence.py", "second_rate", "i_b.right", "i_b.left"): SHOWN,
    (
        "this_fleet/gains.py",
        "_peak_time",
        "2 * np.pi / float(psi.frequency)",
        "2 * np.pi * float(psi.frequency)",
    ): "half a period of these psi has a peak as well",
    ("checker.py", "this_fleet", "gains and psi", "gains or psi"): "who gives gains gives psi",
    (
        "printed/convergence.py",
        "",
        "Quotation(\"Barbalat's lemma\", 'Khalil, Nonlinear Systems, Lemma 8.2', \"f -> 0 where the integral of f "
        "converges and f' is bounded\")",
        "Quotation(\"not Barbalat's lemma\", 'Khalil, Nonlinear Systems, Lemma 8.2', \"f -> 0 where the integral of f "
        "converges and f' is bounded\")",
    ): SAID,
    ("method/ball.py", "_power", "2 * exponent", "2 / exponent"): "a root is taken, or the power by its logarithm",
    ("printed/boundedness.py", "_subsets", "n + 1", "n + 2"): "n things have no more than n of them",
    ("method/rules.py", "_separating_point", "right.free_symbols", "left.free_symbols"): (
        "where the sides are given, the right one has no letters of its own"
    ),
    ("this_fleet/excitation.py", "window_number", "period / 2", "period / 1"): "the steep stretch is the shorter",
    (
        "this_fleet/gains.py",
        "lemma_constants",
        "len(fleet) <= EXACT_VEHICLES",
        "len(fleet) < EXACT_VEHICLES",
    ): WORK,
}
ARGUED = {(f"verify/proof/{file}", where, f"{old} -> {new}"): why for (file, where, old, new), why in _ARGUED.items()}

"""The words of the proof report: where each claim stands in the paper, what it says, and why a false one matters.

The order is that of the report: the paper's, then the lemmas, then the fleet. Nothing here is a verdict.
"""

from __future__ import annotations

from typing import NamedTuple

from ...verify.proof.claim import Claim, Fact, Method


class Words(NamedTuple):
    """What is said of a claim besides its formulas."""

    place: str  # in the paper, or the name of the lemma
    note: str  # one line: what the formulas say
    effect: str = ""  # of a false statement: what it changes for the gains


PAPER: dict[str, Words] = {
    "eq-1": Words("(1)", "The kinematics of a wheel pair that rolls without slip."),
    "nonholonomic": Words("constraint after (1)", "A vehicle moves along its heading only."),
    "eq-2": Words("(2)", "A convention: lever arm 2R, left minus right. The model has it with drive = paper."),
    "eq-2-physical": Words(
        "(2), R the half distance of the wheels",
        "Wheel forces tau/r at +-R across the heading have the moment (R/r)(tau_R - tau_L).",
        "On a real robot use drive = physical, the default: lever arm R, right minus left.",
    ),
    "eq-5": Words(
        "(5)", "L is symmetric, and its quadratic form a sum of squares over the edges: 0 only where all y agree."
    ),
    "lemma-1": Words("Lemma 1", "L_l is positive definite: the squares bound every y down a tree from the leader."),
    "eq-6": Words("(6)", "The exact inverse of (2) as printed."),
    "eq-6-physical": Words(
        "(6) on a physical drive",
        "As printed it gives the turn channel the gain -1/2: positive feedback.",
        "Never run the printed (6) on a real robot; drive = physical has its own inverse.",
    ),
    "eq-7": Words("(7)", "The force. Identical to the function that is simulated and shipped, as are (8)-(11)."),
    "eq-8": Words("(8)", "The position error."),
    "eq-9": Words("(9)", "The moment."),
    "eq-10": Words("(10)", "The heading error."),
    "eq-11": Words("(11)", "The excitation term; the text has phi_perp without its transpose."),
    "eq-12": Words("(12)", "psi' is persistently exciting: its square integrates to 20/pi over any 2 pi."),
    "annihilator": Words("text after (12)", "phi_perp sees of a vector only what is across the heading."),
    "pe-of-psi": Words(
        "(12) with psi for psi'", "Not enough: with a constant psi the fleet can rest off the formation."
    ),
    "eq-13": Words("(13)", "The closed loop of the speed, through (6) and (2)."),
    "eq-14": Words("(14)", "The closed loop of the turn rate."),
    "prop-1": Words("Proposition 1", "True, although its proof has the false steps below."),
    "eq-15": Words(
        "(15)",
        "It does not bound omega: out with alpha = c to any angle L, then back with alpha = -c ever faster.",
        "(15) is no bound of a turn rate; (15') gives one. The result needs neither, and without (15) k_alpha may be "
        "much larger.",
    ),
    "eq-16": Words("(16)", "Sufficient for Constraint 1, through (16*), which is exact."),
    "remark-1": Words("Remark 1", "The sum is one of terms x tanh x, each 0 only where its difference is."),
    "remark-1-limit": Words(
        "Remark 1, used for limits",
        "An error map that is 0 only at 0 may still vanish at infinity; L9 excludes that here.",
        "None.",
    ),
    "eq-17": Words("(17)", "V is 0 at the formation, positive elsewhere and large far away; each edge counts once."),
    "eq-18": Words("(18)", "V never rises: the pulls and the potential cancel edge by edge."),
    "v-in-L2": Words("text after (18)", "v is square integrable, and v' is bounded."),
    "eq-19": Words("(19)", "W is the same of the headings."),
    "eq-20": Words("(20)", "All that can make W rise is the excitation."),
    "alpha-bound": Words("bound of alpha", "Two components smaller than D each."),
    "after-20": Words(
        "inequality after (20)",
        "omega alpha <= |omega| c, and |omega| is not omega where omega < 0.",
        "It is the step that (15) serves.",
    ),
    "after-20-b": Words("second inequality after (20)", "Holds where every |omega_i| >= 1, h = tanh|omega| >= tanh 1."),
    "after-20-c": Words("(15) gives W' <= 0", "For all |omega_i| >= 1 at once; nothing where one |omega_j| < 1."),
    "boundedness-of-omega": Words(
        '"|omega_i| >= 1 gives W\' <= 0, hence omega_i is bounded"',
        "Neighbours with |omega_j| < 1 are not damped enough: W rises although |omega_1| >= 1. The witness has the "
        "paper's graph and gains.",
        "The turn rate has no bound from here. The corrected theorem bounds it, (15') by a number.",
    ),
    "eq-21": Words(
        "(21)",
        "Differentiating (13): v'' on the left, phi_perp for phi, and the last term keeps its minus. Signs like these "
        "may have been lost in the text at hand.",
        "None: a step of the proof.",
    ),
    "eq-22": Words("(22)", "True by the theorem; the paper's own route needs omega bounded first."),
    "eq-23": Words(
        "(23)",
        "What is left of (21) when v'', v' and e_z' vanish has phi_perp. That may have been lost in the text at hand.",
        "None: a step of the proof.",
    ),
    "omega-not-to-0": Words(
        '"omega does not tend to 0, so e_z -> 0"',
        "Not to tend to 0 is not to be bounded away from 0.",
        "None: the conclusion is true.",
    ),
    "eq-24": Words("(24)", "Differentiating (14)."),
    "eq-25": Words("(25)", "Differentiating (11); the text has phi_perp without its transpose."),
    "alpha-rate": Words(
        '"alpha\' -> 0"',
        "e_theta' contains the neighbours' omega_j. The neighbour swings: theta_j = theta_i + sin t.",
        "None: the conclusion is true.",
    ),
    "psi-rate-not-to-0": Words(
        '"psi\' does not tend to 0, so phi_perp^T e_z -> 0"',
        "b may live where psi' vanishes. True because b' -> 0 there, so that b hardly changes over a window of (12).",
        "psi must have (12) over windows; that psi' does not fade is not enough.",
    ),
    "orientation": Words(
        "orientation paragraph",
        "Barbalat's lemma needs the next derivative: read W'' for W' and omega'' for omega'. A dot may have been lost "
        "in the text at hand.",
        "None: a step of the proof.",
    ),
    "any-bounded-alpha": Words(
        '"uniformly bounded under any bounded alpha"',
        "A constant push alpha_1 = c_1 > p_omega D, which no heading error can hold, turns vehicle 1 for ever.",
        "Do not add disturbances of the size of alpha: nothing bounds the headings then.",
    ),
    "cuts": Words("boundedness under any alpha", "What it needs, and how many cuts of the paper's graph break it."),
    "cascade": Words("cascade argument", "Its conclusion is part (c) of the theorem."),
    "eq-3-4": Words("(3), (4)", "The control goal, by part (c) of the theorem."),
    "ubar-v": Words("saturation paragraph, u_bar_v", "The supremum; no state attains it."),
    "ubar-omega": Words(
        "saturation paragraph, u_bar_omega",
        "sqrt2 k psi_bar a_il is missing where a vehicle hears the leader; Proposition 1 has it right. The second "
        "witness has the paper's gains.",
        "Motors must not be sized by this paragraph: its bound of the turning input is too small.",
    ),
    "ubar-omega-prop": Words("Proposition 1, u_bar_omega", "The supremum; no state attains it."),
    "max-torque": Words("saturation paragraph, torques", "The triangle inequality in (6)."),
    "psi-section-4": Words(
        "psi of Section 4", "4/((2k-1) pi): with pi beside the fraction (15) fails for all six vehicles."
    ),
    "psi-bar": Words(
        "psi of Section 4, its bound", "All zeros of psi' are known, so that the maximum compares few numbers."
    ),
    "fig-2": Words("Fig. 2", "Not in the text at hand. This graph makes (15) and (16) tight for every vehicle."),
    "lemma-1-paper": Words("Lemma 1 on the paper's graph", "The pivots of exact elimination."),
    "table-1": Words("Table 1", "By (2) tau/r is a force.", "Torque limits are in N m."),
    "table-2": Words("Table 2", "Vehicles 2, 4, 6 are the midpoints of the triangle 1, 3, 5."),
    "eq-15-paper": Words("(15) on the paper's gains", "Met by less than 4 % for every vehicle."),
    "eq-16-paper": Words("(16) on the paper's gains", "Met."),
    "conservatism": Words("(16) against (16*)", "What (16) asks beyond need on the paper's data, in per cent."),
    "unit-scales": Words("saturation scales, all 1", "The paper's equations (8), (10), (13), (14)."),
    "other-units": Words(
        "saturation scales rho = 1, s = l o",
        "The paper's controller in other units: lengths in l, times in 1/o, mass m l o^2, inertia I o^2.",
    ),
}

LEMMAS: dict[str, Words] = {
    "L0": Words("L0", "tanh, its slope and its integral."),
    "L1": Words("L1", "Bounds of the errors, of their rates and of the accelerations; beta is any direction."),
    "L2": Words(
        "L2",
        "Edge by edge; deg is the degree in the weights. What is affine in them on two vehicles holds on every graph.",
    ),
    "L3": Words("L3", "V never rises."),
    "L4": Words("L4", "W, and the errors along and across the heading."),
    "L5": Words("L5", "The key: the excitation is a total derivative up to terms in the speeds."),
    "L6": Words("L6", "The triangle inequality on L5."),
    "L7": Words("L7", "Damping of the speeds pays for L6 up to e, in two cases of |v| against e/(N g)."),
    "L8": Words("L8", "Young's inequality: the modified energy is W up to V and a constant."),
    "L9": Words("L9", "Small errors e_i mean small states, for |e_i| at most kappa_cut/N tanh(M/(N rho))."),
    "L10": Words("L10", "psi differs from every constant on every window."),
    "L11": Words("L11", "A speed that is large once dissipates a fixed energy."),
    "L12": Words("L12", "Where nothing moves for a window, every error is small."),
    "L13": Words("L13", "Over a window either the energy falls by gamma/2 or every error is small."),
    "L14": Words("L14", "Near the formation the fleet stays near."),
    "L15": Words("L15", "From every start the fleet gets there, within a time known in advance."),
    "L16": Words("L16", "(16*) is the supremum of both torques, for both drives; no state attains it."),
    "L16b": Words("L16, (16)", "(16) implies (16*)."),
    "L17": Words("L17", "The cross-track error moves at second order, so that no rate is exponential."),
    "L18": Words("L18", "Where damping outweighs all pulls, speed and turn rate fall."),
    "conditions": Words(
        "models/conditions.py",
        "What the tool computes is what is proved: the margin of each condition as models/conditions.py computes it, "
        "and as L16 and L18 give it.",
    ),
    "thm-a": Words("(a)", "From every state at every time there is exactly one solution, for all later time."),
    "thm-b": Words("(b)", "Solutions are bounded, uniformly over starts in a bounded set and over starting times."),
    "thm-c": Words("(c)", "The formation is uniformly globally asymptotically stable."),
    "thm-d": Words("(d)", "Torques stay below T of (16*), and no lower limit holds where |psi_i| attains its bound."),
    "thm-e": Words("(e)", "The approach is not exponential, whatever the gains."),
    "thm-f": Words("(f)", "Where damping outweighs all pulls, speeds and turn rates stay within their limits."),
    "theorem": Words(
        "corrected theorem",
        "Under (A1)-(A3), for every fleet and graph: solutions are bounded, the formation is uniformly stable and "
        "attracts from everywhere, and torques, speeds and turn rates keep their bounds.",
    ),
}

FLEET: dict[str, Words] = {
    "A1": Words("(A1)", "Weights are positive and every vehicle hears the leader over some path."),
    "kappa-cut": Words("kappa_cut", "By maximal flows, and again by the cut and the flows themselves."),
    "A2": Words("(A2)", "Gains and scales are positive."),
    "A3": Words("(A3)", "psi and two derivatives are bounded, and psi' is exciting; each number twice."),
    "nu": Words("nu", "The least variance of psi over a period; twice, and against L10."),
    "torques": Words("(16*) here", "The vehicle that uses most of its torque limit."),
    "speed-limits": Words(
        "limits here", "Vehicles whose gains certify a speed and a turn rate, and the limits asked for."
    ),
    "constants": Words("constants of the lemmas", "They prove; they do not predict how long a fleet takes."),
    "fleet": Words("this fleet", "The theorem applies."),
}

ALL: dict[str, Words] = {**PAPER, **LEMMAS, **FLEET}

LETTERS_NOTE = (
    "phi_i = (cos theta_i, sin theta_i) is the heading of vehicle i and phi_perp = (-sin theta_i, cos theta_i). The "
    "index min or max is over all vehicles or links."
)

METHODS: dict[Method, str] = {
    Method.ASSUMED: "hypothesis",
    Method.INSTANCE: "a special case",
    Method.NORMAL_FORM: "polynomial normal form of the difference",
    Method.TRIANGLE: "triangle inequality",
    Method.CAUCHY_SCHWARZ: "Cauchy-Schwarz inequality",
    Method.SIGNS: "every sign is + in nonnegative slacks",
    Method.POSITIVE: "the gap is a product of positive factors",
    Method.SQUARES: "a sum of squares",
    Method.GROWTH: "equal at 0, and the derivative of the gap is not negative",
    Method.PARITY: "even and odd functions",
    Method.SATURATED: "the limit of saturated terms",
    Method.WINDOW: "the equation of motion, integrated over a window",
    Method.ENVELOPE: "an envelope that tends to 0",
    Method.RETURNS: "values that return for ever",
    Method.COMPARISON: "comparison of rates",
    Method.COUNTEREXAMPLE: "a counterexample",
    Method.CONSEQUENCE: "it is 0 at the formation and continuous",
    Method.BALLS: "ball arithmetic",
    Method.EXACT: "exact arithmetic",
    Method.COQ: "checked by Coq",
    Method.CITED: "a textbook theorem",
}


def place_of(claim: Claim) -> str:
    """Where a claim stands in the paper, or what it is called."""
    return ALL[claim.id].place


def note_of(claim: Claim) -> str:
    """What a claim says in words."""
    return ALL[claim.id].note


def method_of(fact: Fact) -> str:
    """How a fact was checked."""
    return METHODS[fact.method]

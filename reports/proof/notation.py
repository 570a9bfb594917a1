# ruff: noqa: RUF001 -- Greek letters are what this table is for
"""How the symbols of the proof are typeset: one table for LaTeX and MathML."""

from __future__ import annotations

from typing import Any

# base name -> (LaTeX letter, its subscript, Unicode letter, its subscript); the vehicle's index follows the subscript
_PLAIN = {name: (name, "", name, "") for name in ("x", "y", "v", "m", "I", "r", "R", "a", "V", "W")}
_GREEK = {
    name: (f"\\{name}", "", letter, "")
    for name, letter in (
        ("theta", "θ"), ("omega", "ω"), ("psi", "ψ"), ("alpha", "α"), ("delta", "δ"), ("tau", "τ"), ("lambda", "λ"),
        ("beta", "β"), ("eta", "η"), ("kappa", "κ"), ("mu", "μ"), ("nu", "ν"), ("chi", "χ"), ("rho", "ρ"),
        ("sigma", "σ"), ("gamma", "γ"),
    )
}  # fmt: skip
_COMPOUND = {
    "p_v": ("p", "v", "p", "v"),
    "d_v": ("d", "v", "d", "v"),
    "p_omega": ("p", "\\omega", "p", "ω"),
    "d_omega": ("d", "\\omega", "d", "ω"),
    "k_alpha": ("k", "\\alpha", "k", "α"),
    "e_x": ("e", "x", "e", "x"),
    "e_y": ("e", "y", "e", "y"),
    "e_theta": ("e", "\\theta", "e", "θ"),
    "e_x_dot": ("\\dot e", "x", "ė", "x"),
    "e_y_dot": ("\\dot e", "y", "ė", "y"),
    "e_theta_dot": ("\\dot e", "\\theta", "ė", "θ"),
    "x_dot": ("\\dot x", "", "ẋ", ""),
    "v_dot": ("\\dot v", "", "v̇", ""),
    "v_ddot": ("\\ddot v", "", "v̈", ""),
    "omega_dot": ("\\dot\\omega", "", "ω̇", ""),
    "omega_ddot": ("\\ddot\\omega", "", "ω̈", ""),
    "alpha_dot": ("\\dot\\alpha", "", "α̇", ""),
    "psi_dot": ("\\dot\\psi", "", "ψ̇", ""),
    "psi_ddot": ("\\ddot\\psi", "", "ψ̈", ""),
    "psi_bar": ("\\bar\\psi", "", "ψ̄", ""),
    "tau_l": ("\\tau", "\\ell", "τ", "ℓ"),
    "tau_r": ("\\tau", "r", "τ", "r"),
    "u_v": ("u", "v", "u", "v"),
    "u_omega": ("u", "\\omega", "u", "ω"),
    "u_bar_v": ("\\bar u", "v", "ū", "v"),
    "u_bar_omega": ("\\bar u", "\\omega", "ū", "ω"),
    "delta_x": ("\\delta", "x", "δ", "x"),
    "delta_y": ("\\delta", "y", "δ", "y"),
    "psi0": ("\\psi", "0", "ψ", "0"),
    "psi1": ("\\psi", "1", "ψ", "1"),
    "psi2": ("\\psi", "2", "ψ", "2"),
    "V_dot": ("\\dot V", "", "V̇", ""),
    "y^T L y": ("y^{\\top} L\\, y", "", "yᵀLy", ""),
    "|e_z|^2": ("|e_z|^2", "", "|e_z|²", ""),
    "W_dot": ("\\dot W", "", "Ẇ", ""),
}
_TABLE = _PLAIN | _GREEK | _COMPOUND


def _parts(name: str) -> tuple[tuple[str, str, str, str], str] | None:
    if name in _COMPOUND or name in _GREEK:
        return _TABLE[name], ""
    base, _, index = name.rpartition("_")
    return (_TABLE[base], index) if base in _TABLE else None


def latex(expression: Any) -> str:
    """LaTeX of a SymPy expression of the proof."""
    import sympy as sp

    shown = _logarithms(expression)
    names = {s: _latex_symbol(s.name) for s in shown.free_symbols}
    return str(sp.latex(shown, symbol_names=names, mul_symbol="\\,"))


def _latex_symbol(name: str) -> str:
    found = _parts(name)
    if found is None:
        return f"\\text{{{_escaped(name)}}}" if len(name) > 1 else name
    (letter, sub, _, _), index = found
    lower = " ".join(part for part in (sub, index.replace("l", "\\ell")) if part)
    return f"{letter}_{{{lower}}}" if lower else letter


def _escaped(name: str) -> str:
    return name.replace("_", "\\_").replace("^", "\\textasciicircum{}")


def mathml(expression: Any) -> str:
    """Presentation MathML of a SymPy expression of the proof, one <math> element."""
    from sympy.printing.mathml import MathMLPresentationPrinter

    class Printer(MathMLPresentationPrinter):  # type: ignore[misc]
        def _print_Symbol(self, symbol: Any, style: str = "plain") -> Any:  # noqa: ARG002, N802
            return _mathml_symbol(self.dom, symbol.name)

    printer = Printer()
    body = printer._print(_logarithms(expression))
    return f'<math display="inline" displaystyle="true"><mrow>{body.toxml()}</mrow></math>'


def _mathml_symbol(dom: Any, name: str) -> Any:
    def leaf(tag: str, content: str) -> Any:
        node = dom.createElement(tag)
        node.appendChild(dom.createTextNode(content))
        return node

    found = _parts(name)
    if found is None:
        return leaf("mi", name)
    (_, _, letter, sub), index = found
    if not sub + index:
        return leaf("mi", letter)
    node, lower = dom.createElement("msub"), dom.createElement("mrow")
    node.appendChild(leaf("mi", letter))
    for part in (sub, index.replace("l", "ℓ")):
        if part:
            lower.appendChild(leaf("mi", part))
    node.appendChild(lower)
    return node


def _logarithms(expression: Any) -> Any:
    import sympy as sp

    from ...models.algebra.log_cosh import log_cosh

    return sp.sympify(expression).replace(log_cosh, lambda s: sp.log(sp.cosh(s)))

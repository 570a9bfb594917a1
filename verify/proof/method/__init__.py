"""How statements are checked: symbols, normal form, signs, balls and the rules that make facts."""

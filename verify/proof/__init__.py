"""The proof checker: the printed claims of the paper and the corrected theorem, lemma by lemma."""

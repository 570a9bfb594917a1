"""The paper, line by line, at unit scales: each formula as it is printed against what the model's functions give."""

"""What the theorem needs of one fleet and gives for it, computed twice where it is a number."""

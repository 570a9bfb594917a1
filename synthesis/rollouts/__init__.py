"""Many closed loops side by side in compiled code: equations, Runge-Kutta steps, settling, tails."""

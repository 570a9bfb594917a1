"""Tables, figures and documents."""

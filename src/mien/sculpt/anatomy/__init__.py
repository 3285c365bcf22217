"""What a head is made of, at rest."""

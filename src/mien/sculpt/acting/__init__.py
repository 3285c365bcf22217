"""What a head does: movements, expressions, visemes."""

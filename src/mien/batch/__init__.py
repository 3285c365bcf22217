"""Many takes by many characters, on one machine or on many."""

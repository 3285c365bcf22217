"""Small files that people write and correct by hand."""

"""The studio: a page in the browser on which a face is filmed and characters follow."""

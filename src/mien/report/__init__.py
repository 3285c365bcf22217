"""The truth about one retargeting, on a page."""

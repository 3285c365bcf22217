"""Any performance drives any face."""

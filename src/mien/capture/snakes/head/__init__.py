"""Where the head is and how it is turned."""

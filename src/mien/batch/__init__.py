"""Many takes by many characters, on one machine or on many.

    batch(["takes/"], order(characters=["man"]), "out")

is what ``mien batch`` does. Takes and the output folder are files that all workers see.
"""

"""A page on which a mission is played again."""

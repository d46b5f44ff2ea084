"""What a robot is: one description, from which every node's parameters follow, on robots and in virtual time."""

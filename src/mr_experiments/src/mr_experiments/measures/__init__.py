"""What is computed from worlds and maps: bounds, visibility, drift, truth."""

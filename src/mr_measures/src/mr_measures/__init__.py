"""What missions are measured by: the true world, figures of maps and motion, references, bounds, the mission record."""

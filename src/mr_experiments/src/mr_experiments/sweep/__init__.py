"""Many trials: each in a process, their records, clusters, references of maps."""

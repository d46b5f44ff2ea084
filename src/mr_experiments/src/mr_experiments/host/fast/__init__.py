"""Fast mode: what takes the place of SLAM, navigation, merging and the radio."""

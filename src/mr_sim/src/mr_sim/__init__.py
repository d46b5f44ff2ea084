"""Stage worlds without Stage: simulator, local SLAM and navigation for one robot or a team."""
